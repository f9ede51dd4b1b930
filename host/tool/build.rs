//! The commit that the program is built from, for the summaries of runs.

use std::path::Path;
use std::process::Command;

fn main() {
    // Each commit and each checkout adds a line to this file.
    let log = "../../.git/logs/HEAD";
    if Path::new(log).exists() {
        println!("cargo::rerun-if-changed={log}");
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
