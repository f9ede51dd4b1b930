//! The verbs: files in, reports out.

use crate::{CheckArguments, LookArguments};
use crepitus_tools::image::budget::{Budget, ImageBudget, bless};
use crepitus_tools::image::lines::Lines;
use crepitus_tools::image::report::Report;
use crepitus_tools::image::{
    Image, ImageError, Subject, examine, look, memory, needless_loops, text,
};
use std::io::Write;
use std::path::{Path, PathBuf};

/// `check`: whether every image passes.
pub(crate) fn check(arguments: &CheckArguments, json: bool) -> Result<bool, String> {
    let path = &arguments.budget;
    let source = read_text(path)?;
    let budget = Budget::parse(path, &source).map_err(|e| e.to_string())?;
    let known: Vec<&str> = budget.images.keys().map(String::as_str).collect();
    let named = arguments.elves.iter().map(|(image, _)| image);
    for name in arguments.images.iter().chain(named) {
        if !known.contains(&name.as_str()) {
            let (path, known) = (path.display(), known.join(", "));
            return Err(format!("{path} has no image {name}; it has {known}"));
        }
    }
    let mut reports = Vec::new();
    let mut changes = Vec::new();
    for (name, image) in &budget.images {
        if !arguments.images.is_empty() && !arguments.images.contains(name) {
            continue;
        }
        let report = examined(name, image, &budget, arguments)?;
        for size in &report.sizes {
            let record = match size.what {
                "flash" => &image.recorded.flash,
                "ram" => &image.recorded.ram,
                _ => &image.recorded.stack,
            };
            changes.push((record, size.used));
        }
        reports.push(report);
    }
    if arguments.images.is_empty() {
        // Known only after the last image.
        let needless = needless_loops(&budget.loops, &reports);
        if let Some(last) = reports.last_mut() {
            last.failures.extend(needless);
        }
    }
    if arguments.bless {
        let blessed = bless(&source, &changes);
        std::fs::write(path, blessed).map_err(|e| at(path, e))?;
        // Only failures that a new record cannot resolve remain.
        for report in &mut reports {
            report.take_record();
        }
    }
    let passes = reports.iter().all(Report::passes);
    if json {
        print_json(&reports)?;
    } else {
        let texts: Vec<String> = reports.iter().map(text::render).collect();
        print(&texts.join("\n"))?;
    }
    Ok(passes)
}

fn examined(
    name: &str,
    image: &ImageBudget,
    budget: &Budget,
    arguments: &CheckArguments,
) -> Result<Report, String> {
    let from = arguments.budget.parent().unwrap_or(Path::new("."));
    let elsewhere = arguments.elves.iter().rev().find(|(n, _)| n == name);
    let elf: PathBuf = elsewhere.map_or_else(|| from.join(&image.elf), |(_, elf)| elf.clone());
    let layout = from.join(&image.memory);
    let memory = memory::parse(&read_text(&layout)?);
    let memory = memory.map_err(|e| format!("{}: {e}", layout.display()))?;
    let parsed = read_image(&elf)?;
    let subject = Subject {
        image: &parsed,
        lines: &Lines::of(&elf),
        memory: &memory,
        budget: image,
        shared_loops: &budget.loops,
        tolerance_percent: budget.tolerance_percent,
    };
    examine(name, subject).map_err(|e| format!("{}: {e}", elf.display()))
}

/// `look`: succeeds unless something cannot be read.
pub(crate) fn look(arguments: &LookArguments, json: bool) -> Result<bool, String> {
    let image = read_image(&arguments.elf)?;
    let looks = look::look(&image, &arguments.roots);
    let looks = looks.map_err(|e| format!("{}: {e}", arguments.elf.display()))?;
    if json {
        print_json(&looks)?;
    } else {
        print(&look::render(&looks))?;
    }
    Ok(true)
}

fn read_image(path: &Path) -> Result<Image, String> {
    let bytes = std::fs::read(path).map_err(|e| {
        let hint = if e.kind() == std::io::ErrorKind::NotFound {
            " (build the image first, or name it with --elf)"
        } else {
            ""
        };
        format!("{}{hint}", at(path, e))
    })?;
    Image::parse(&bytes).map_err(|e| format!("{}: {e}", path.display()))
}

fn read_text(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|e| at(path, e))
}

fn at(path: &Path, source: std::io::Error) -> String {
    let path = path.to_owned();
    ImageError::File { path, source }.to_string()
}

fn print_json(value: &impl serde::Serialize) -> Result<(), String> {
    let text = serde_json::to_string_pretty(value).map_err(|e| e.to_string())?;
    print(&(text + "\n"))
}

fn print(text: &str) -> Result<(), String> {
    let mut out = std::io::stdout().lock();
    let done = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    done.map_err(|e| format!("standard output: {e}"))
}
