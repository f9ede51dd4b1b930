//! Planted faults as they are listed, and how they are tried: see each module.

mod apply;
mod mutants;
mod page;
mod trial;

use std::fs;
use std::path::Path;

/// Writes a workspace with one crate, `small`.
fn write_crate(root: &Path, source: &str) {
    let folder = root.join("small/src");
    fs::create_dir_all(&folder).expect("a folder");
    let workspace = "[workspace]\nmembers = [\"small\"]\nresolver = \"3\"\n";
    fs::write(root.join("Cargo.toml"), workspace).expect("a file");
    let package = "[package]\nname = \"small\"\nversion = \"0.1.0\"\nedition = \"2024\"\n";
    fs::write(root.join("small/Cargo.toml"), package).expect("a file");
    let lock = "version = 4\n\n[[package]]\nname = \"small\"\nversion = \"0.1.0\"\n";
    fs::write(root.join("Cargo.lock"), lock).expect("a file");
    fs::write(folder.join("lib.rs"), source).expect("a file");
}
