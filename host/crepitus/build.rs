//! The commit that the program is built from, for the summaries of runs, with compiler and target.

use std::path::Path;
use std::process::Command;

/// Inputs that the name depends on: each commit and each checkout adds a line to the log of `HEAD`, and an
/// edit of what the program is built from makes it dirty. The index is left out: `git describe`
/// itself writes it, so that every second build would be done twice.
const INPUTS: [&str; 15] = [
    ".git/logs/HEAD",
    "Cargo.lock",
    "Cargo.toml",
    "device",
    "docs/faults.md",
    "docs/generated/faults.md",
    "firmware/seal",
    "host",
    "lessons",
    "model",
    "presets",
    "protocol",
    "scenes",
    "sim",
    "tools",
];

fn main() {
    for input in INPUTS {
        let path = Path::new("../..").join(input);
        // One that is missing would run this in every build.
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    if let Ok(target) = std::env::var("TARGET") {
        println!("cargo::rustc-env=CREPITUS_TARGET={target}");
    }
    let compiler = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    if let Ok(output) = Command::new(compiler).arg("--version").output() {
        let version = String::from_utf8_lossy(&output.stdout);
        println!("cargo::rustc-env=CREPITUS_RUSTC={}", version.trim());
    }
    let described = Command::new("git")
        .args([
            "describe",
            "--always",
            "--dirty",
            "--abbrev=12",
            "--exclude=*",
        ])
        .output();
    // A copy without its history is built all the same.
    let Ok(output) = described else { return };
    let commit = String::from_utf8_lossy(&output.stdout);
    if output.status.success() {
        println!("cargo::rustc-env=CREPITUS_COMMIT={}", commit.trim());
    }
}
