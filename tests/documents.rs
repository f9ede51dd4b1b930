//! The documents keep their promises: links lead somewhere, the README's
//! commands are where the gate looks for them.

mod support;

use pulldown_cmark::{Event, Options, Parser, Tag};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use support::repository;

/// Every document of the repository.
fn documents() -> Vec<PathBuf> {
    let root = repository();
    let mut found = Vec::new();
    for folder in ["", "docs", "tests/reference-cases"] {
        for entry in fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "md") {
                found.push(path);
            }
        }
    }
    assert!(found.len() >= 9, "{found:?}");
    found
}

/// The anchors that the headings of a document make.
fn anchors(text: &str) -> BTreeSet<String> {
    text.lines()
        .filter(|line| line.starts_with('#'))
        .map(|line| {
            line.trim_start_matches('#')
                .trim()
                .to_lowercase()
                .chars()
                .filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-')
                .map(|c| if c == ' ' { '-' } else { c })
                .collect()
        })
        .collect()
}

#[test]
fn every_link_leads_somewhere() {
    let mut broken = Vec::new();
    for document in documents() {
        let text = fs::read_to_string(&document).unwrap();
        for event in Parser::new_ext(&text, Options::all()) {
            let Event::Start(
                Tag::Link {
                    dest_url: target, ..
                }
                | Tag::Image {
                    dest_url: target, ..
                },
            ) = event
            else {
                continue;
            };
            if target.starts_with("https://") {
                continue;
            }
            let (file, anchor) = target.split_once('#').unwrap_or((&target, ""));
            let path = if file.is_empty() {
                document.clone()
            } else {
                document.parent().unwrap_or(Path::new(".")).join(file)
            };
            let content = fs::read_to_string(&path).unwrap_or_default();
            if !path.exists() || !(anchor.is_empty() || anchors(&content).contains(anchor)) {
                broken.push(format!("{}: {target}", document.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn every_page_is_in_the_summary() {
    let docs = repository().join("docs");
    let summary = fs::read_to_string(docs.join("SUMMARY.md")).unwrap();
    for page in documents()
        .iter()
        .filter(|d| d.parent() == Some(docs.as_path()))
    {
        let name = page.file_name().unwrap().to_str().unwrap();
        assert!(name == "SUMMARY.md" || summary.contains(name), "{name}");
    }
}

#[test]
fn the_readme_names_the_main_job_and_the_tests_first() {
    let readme = fs::read_to_string(repository().join("README.md")).unwrap();
    let commands: Vec<_> = readme.lines().filter(|l| l.starts_with("cargo ")).collect();
    assert_eq!(commands[0], "cargo run --release -- demo");
    assert_eq!(commands[1], "cargo test --workspace");
}

#[test]
fn every_dependency_has_its_reason() {
    let manifest = fs::read_to_string(repository().join("Cargo.toml")).unwrap();
    let reasons = fs::read_to_string(repository().join("docs/dependencies.md")).unwrap();
    let (_, dependencies) = manifest.split_once("[workspace.dependencies]").unwrap();
    let (dependencies, _) = dependencies.split_once("\n[").unwrap();
    for line in dependencies
        .lines()
        .filter(|l| l.contains('=') && !l.starts_with('#'))
    {
        let name = line.split(' ').next().unwrap();
        assert!(
            name.starts_with("crepitus-") || reasons.contains(&format!("`{name}`")),
            "{name} has no line in docs/dependencies.md"
        );
    }
}
