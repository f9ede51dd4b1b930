//! The documents keep their promises: links lead somewhere, the README's
//! commands are where the gate looks for them, every risk names tests that exist.

mod support;

use crepitus_protocol::fault::FAULTS;
use pulldown_cmark::{Event, Options, Parser, Tag};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use support::repository;

/// Every document of the repository.
fn documents() -> Vec<PathBuf> {
    let root = repository();
    let mut found = Vec::new();
    for folder in ["", "docs", "docs/generated", "tests/reference-cases"] {
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
fn every_source_file_that_is_named_exists() {
    let root = repository();
    let mut files = Vec::new();
    for folder in [
        "model", "protocol", "device", "firmware", "sim", "host", "tests", "tools", "fuzz",
        "python",
    ] {
        rust_files(&root.join(folder), &mut files);
    }
    let mut missing = Vec::new();
    for document in documents() {
        let text = fs::read_to_string(&document).unwrap();
        for event in Parser::new_ext(&text, Options::all()) {
            // `NAME.rs` stands for any file.
            if let Event::Code(name) = event
                && name.ends_with(".rs")
                && !name.contains(['*', ' ', '{'])
                && !name.contains("NAME")
                && !files.iter().any(|file| file.ends_with(name.as_ref()))
            {
                missing.push(format!("{}: {name}", document.display()));
            }
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
}

#[test]
fn every_page_that_a_source_names_exists() {
    let (root, mut all) = (repository(), String::new());
    sources(&root, &mut all);
    let ends = |c: char| !(c.is_ascii_alphanumeric() || "-_/.".contains(c));
    let rests = all.split("docs/").skip(1);
    let names = rests.map(|rest| rest.split(ends).next().unwrap().trim_end_matches('.'));
    let is_page = |name: &&str| Path::new(name).extension().is_some_and(|e| e == "md");
    let pages: BTreeSet<&str> = names.filter(is_page).collect();
    let is_missing = |page: &&&str| !root.join("docs").join(page).is_file();
    let missing: Vec<_> = pages.iter().filter(is_missing).collect();
    assert!(pages.len() > 20 && missing.is_empty(), "{missing:?}");
}

#[test]
fn every_page_is_in_the_summary() {
    let docs = repository().join("docs");
    let summary = fs::read_to_string(docs.join("SUMMARY.md")).unwrap();
    let folders = [docs.clone(), docs.join("generated")];
    for page in documents()
        .iter()
        .filter(|d| folders.iter().any(|folder| d.parent() == Some(folder)))
    {
        let name = page.strip_prefix(&docs).unwrap().to_str().unwrap();
        // Of its own: other names end alike.
        let is_linked = summary.contains(&format!("({name})"));
        assert!(name == "SUMMARY.md" || is_linked, "{name}");
    }
}

#[test]
fn the_readme_names_the_main_job_and_the_tests_first() {
    let readme = fs::read_to_string(repository().join("README.md")).unwrap();
    let commands: Vec<_> = readme.lines().filter(|l| l.starts_with("cargo ")).collect();
    assert_eq!(commands[0], "cargo run --release -- demo");
    assert_eq!(commands[1], "cargo test --workspace");
}

/// The simulated device begins without a zero, and arming it is refused until it has one.
#[test]
fn commands_that_arm_the_simulated_device_set_its_zero() {
    let mut armed = 0;
    for document in documents() {
        let text = fs::read_to_string(&document).unwrap();
        let commands = text.split(['`', '\n']);
        for command in
            commands.filter(|words| words.contains("crepitus ") && words.contains("--device sim"))
        {
            let mut words = command.split(' ').take_while(|word| !word.starts_with('#'));
            if words.clone().any(|word| word == "--arm") {
                armed += 1;
                let is_set = words.any(|word| word == "--zero");
                assert!(is_set, "{}: {command}", document.display());
            }
        }
    }
    assert!(armed >= 3, "{armed}");
}

/// A page of the book.
fn page(name: &str) -> String {
    fs::read_to_string(repository().join("docs").join(name)).unwrap()
}

/// Tardieu's V3, 350 °/s, is faster than a device follows.
#[test]
fn pages_for_teachers_say_from_where_on_the_device_lets_go() {
    let limit = 5.73_f64;
    assert!(page("generated/faults.md").contains(&format!("({limit} rad/s at 24 V)")));
    let lets_go = format!("from {:.0} °/s on", limit.to_degrees());
    for name in ["disorders.md", "symptoms.md", "lesson.md", "panel.md"] {
        assert!(
            page(name).to_lowercase().contains(&lets_go),
            "{name}: {lets_go}"
        );
    }
    let lessons = fs::read_dir(repository().join("lessons")).unwrap();
    let mut texts: Vec<_> = lessons
        .map(|lesson| fs::read_to_string(lesson.unwrap().path()).unwrap())
        .collect();
    texts.push(page("lesson.md"));
    for text in texts {
        assert!(!text.contains("as fast as you can"), "{text}");
    }
}

/// A first test of the actuator costs no more than 30 €, which was asked for.
#[test]
fn the_parts_of_a_first_test_cost_what_the_page_says() {
    let hardware = page("hardware.md");
    let (_, table) = hardware
        .split_once("| part | for a first test, about 25 € |")
        .expect("the table");
    let rows = table
        .lines()
        .skip(1)
        .take_while(|line| line.starts_with('|'));
    let prices: Vec<f64> = rows
        .filter_map(|row| {
            let (before, _) = row.split('|').nth(2)?.rsplit_once(" €")?;
            before.rsplit(' ').next()?.parse().ok()
        })
        .collect();
    let sum: f64 = prices.iter().sum();
    assert!(
        prices.len() >= 6 && (20.0..=25.0).contains(&sum),
        "{prices:?}"
    );
}

/// The page states by how much the required share of 90 % is exceeded at each speed.
#[test]
fn the_vibration_actuators_page_says_how_far_what_was_asked_for_is_met() {
    assert!(
        page("vibration.md")
            .contains("are 90, 94 and 94 % of them (`crepitus vibration --draws 200`)")
    );
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

/// The names of this project's packages that a package is built from, without `crepitus-`.
fn uses(manifest: &str) -> BTreeSet<String> {
    let mut is_in_dependencies = false;
    let mut used = BTreeSet::new();
    for line in manifest.lines() {
        if line.starts_with('[') {
            is_in_dependencies = line.ends_with("dependencies]") && !line.contains("dev-");
        }
        let name = line.split(['.', ' ', '=']).next().unwrap_or_default();
        if let (true, Some(name)) = (is_in_dependencies, name.strip_prefix("crepitus-")) {
            used.insert(name.trim_start_matches("firmware-").to_owned());
        }
    }
    used
}

#[test]
fn packages_use_those_that_the_architecture_names() {
    let root = repository();
    let page = page("architecture.md");
    let (_, table) = page.split_once("| folder | what it is | uses |\n").unwrap();
    let mut folders = BTreeSet::new();
    for row in table
        .lines()
        .skip(1)
        .take_while(|line| line.starts_with('|'))
    {
        let cells: Vec<_> = row.split('|').map(str::trim).collect();
        let [_, which, _, used, _] = cells[..] else {
            panic!("{row}");
        };
        let named: BTreeSet<_> = (used.split(", ").filter(|name| !name.is_empty()))
            .map(str::to_owned)
            .collect();
        for folder in which.split('`').skip(1).step_by(2) {
            let manifest = fs::read_to_string(root.join(folder).join("Cargo.toml")).unwrap();
            assert_eq!(uses(&manifest), named, "{folder}");
            folders.insert(folder.to_owned());
        }
    }
    let manifest = fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let (_, members) = manifest.split_once("members = [").unwrap();
    let (members, _) = members.split_once(']').unwrap();
    for member in members.split('"').skip(1).step_by(2) {
        assert!(folders.contains(member), "{member}");
    }
}

/// The folder of a package of the workspace.
fn folder_of(package: &str) -> Option<PathBuf> {
    let root = repository();
    let manifest = fs::read_to_string(root.join("Cargo.toml")).unwrap();
    let (_, members) = manifest.split_once("members = [").unwrap();
    let (members, _) = members.split_once(']').unwrap();
    let name = format!("name = \"{package}\"");
    (members.split('"').skip(1).step_by(2))
        .map(|member| root.join(member))
        .find(|folder| {
            let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
            manifest.lines().any(|line| line == name)
        })
}

/// Collects the Rust sources below a folder, but for builds, or the file itself.
fn rust_files(path: &Path, found: &mut Vec<PathBuf>) {
    if path.is_dir() && path.ends_with("target") && path.join("CACHEDIR.TAG").is_file() {
        return;
    }
    if path.is_dir() {
        for entry in fs::read_dir(path).unwrap() {
            rust_files(&entry.unwrap().path(), found);
        }
    } else if path.is_file() && path.extension().is_some_and(|e| e == "rs") {
        found.push(path.to_owned());
    }
}

/// Appends all sources below a folder or of a file.
fn sources(path: &Path, all: &mut String) {
    let mut files = Vec::new();
    rust_files(path, &mut files);
    for file in files {
        all.push_str(&file.to_string_lossy());
        all.push_str(&fs::read_to_string(file).unwrap());
    }
}

/// Reason why `cargo test -p PACKAGE [--features NAME] [--lib | --bin NAME | --test NAME] [FILTER]`
/// would run nothing.
fn runs_nothing(command: &str) -> Option<String> {
    let mut words = command.strip_prefix("cargo test -p ")?.split(' ');
    let Some(folder) = words.next().and_then(folder_of) else {
        return Some(format!("{command}: no such package"));
    };
    // The program's tests lie at the root.
    let tests = if folder.ends_with("host/crepitus") {
        repository().join("tests")
    } else {
        folder.join("tests")
    };
    let (mut code, mut filter) = (String::new(), None);
    while let Some(word) = words.next() {
        match word {
            "--" => {}
            "--features" => {
                words.next();
            }
            "--lib" => sources(&folder.join("src"), &mut code),
            "--bin" => {
                words.next();
                sources(&folder.join("src"), &mut code);
            }
            "--test" => {
                let name = words.next().unwrap_or_default();
                sources(&tests.join(format!("{name}.rs")), &mut code);
                // The laws of the fuzz targets lie in their package.
                let parts = match name {
                    "fuzz" => repository().join("fuzz/src"),
                    _ => tests.join(name),
                };
                if parts.is_dir() {
                    sources(&parts, &mut code);
                }
            }
            other => filter = other.trim_end_matches("::").rsplit("::").next(),
        }
    }
    if code.is_empty() {
        return Some(format!("{command}: no such tests"));
    }
    let filter = filter.filter(|filter| !code.contains(filter));
    filter.map(|filter| format!("{command}: no {filter}"))
}

#[test]
fn every_risk_names_tests_that_exist_or_says_that_it_is_open() {
    let page = fs::read_to_string(repository().join("docs/risks.md")).unwrap();
    let mut risks = 0;
    for row in page.lines().filter(|line| line.starts_with("| **R")) {
        risks += 1;
        assert!(row.starts_with(&format!("| **R{risks}** ")), "{row}");
        let cells: Vec<_> = row.split('|').map(str::trim).collect();
        let [_, _, before, measures, shown_by, after, _] = cells[..] else {
            panic!("{row}");
        };
        // Nothing is left that is not acceptable, unless the risk is open.
        let is_open = measures.contains("**Open**");
        assert!(is_open || !["3c", "3d", "4b", "4c", "4d"].contains(&after));
        assert!(after <= before, "{row}");
        let is_by_hand = shown_by.contains("by hand");
        let commands: Vec<_> = (shown_by.split('`').skip(1).step_by(2)).collect();
        assert!(is_open || is_by_hand || !commands.is_empty(), "{row}");
        for command in commands {
            assert_eq!(runs_nothing(command), None);
        }
    }
    assert!(risks >= 20, "{risks}");
    for fault in &FAULTS {
        let name = format!("`{}`", fault.name);
        assert!(page.contains(&name), "{name} answers no risk");
    }
    for wrong in [
        "cargo test -p crepitus-nobody",
        "cargo test -p crepitus-virtual-device --test nothing",
        "cargo test -p crepitus-virtual-device --test fault_table nothing_of_the_kind",
    ] {
        assert!(runs_nothing(wrong).is_some(), "{wrong}");
    }
}

#[test]
fn every_planted_fault_names_a_test_that_exists() {
    let mut named = 0;
    for area in fs::read_dir(repository().join("tools/faults")).unwrap() {
        for patch in fs::read_dir(area.unwrap().path()).unwrap() {
            let path = patch.unwrap().path();
            let text = fs::read_to_string(&path).unwrap();
            for test in text.lines().filter_map(|l| l.strip_prefix("Noticed-by: ")) {
                named += 1;
                let wrong = runs_nothing(&format!("cargo test {test}"));
                assert_eq!(wrong, None, "{}", path.display());
            }
        }
    }
    assert!(named >= 220, "{named}");
}

#[test]
fn what_runs_where_names_tests_that_exist() {
    let page = fs::read_to_string(repository().join("docs/where.md")).unwrap();
    let claims: Vec<_> = (page.lines())
        .skip_while(|line| !line.starts_with("| claim |"))
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .collect();
    assert!(claims.len() >= 20, "{}", claims.len());
    for claim in claims {
        let cells: Vec<_> = claim.split('|').map(str::trim).collect();
        let [_, _, _, _, _, linux, board, commands, _] = cells[..] else {
            panic!("{claim}");
        };
        // No board exists.
        assert_eq!(board, "–", "{claim}");
        let commands: Vec<_> = (commands.split('`').skip(1).step_by(2)).collect();
        assert!(!commands.is_empty(), "{claim}");
        let has_guest = commands
            .iter()
            .any(|c| c.starts_with("tools/linux-guest/run"));
        assert!(
            linux == "–" || has_guest || claim.contains("tshark"),
            "{claim}"
        );
        for command in commands.iter().filter(|c| c.starts_with("cargo ")) {
            assert_eq!(runs_nothing(command), None);
        }
    }
}

/// First words of a clause, which a doc comment does not begin with.
const CLAUSES: [&str; 7] = ["What", "Whatever", "Who", "Whoever", "How", "Where", "Why"];

/// The text of a line that is a doc comment.
fn doc_text(line: &str) -> Option<&str> {
    let line = line.trim_start();
    line.strip_prefix("///")
        .or_else(|| line.strip_prefix("//!"))
}

#[test]
fn doc_comments_begin_with_a_noun_phrase_or_a_verb() {
    let mut files = Vec::new();
    rust_files(&repository(), &mut files);
    assert!(files.len() > 1_000, "{} files", files.len());
    let (mut read, mut wrong) = (0, Vec::new());
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let mut is_first = true;
        for (number, line) in (1..).zip(text.lines()) {
            let doc = doc_text(line);
            if let Some(doc) = doc.filter(|_| is_first) {
                read += 1;
                let word = doc.split_whitespace().next().unwrap_or_default();
                if CLAUSES.contains(&word.trim_end_matches(['.', ',', ':'])) {
                    wrong.push(format!("{}:{number}:{doc}", file.display()));
                }
            }
            is_first = doc.is_none();
        }
    }
    assert!(read > 5_000, "{read} doc comments");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
