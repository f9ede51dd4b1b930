//! Compiler and options of this crate, whose loops are timed: a study names them beside its times.

use std::env;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let of = |name: &str| env::var(name).unwrap_or_else(|_| "unknown".to_owned());
    let compiler = Command::new(of("RUSTC")).arg("-V").output().ok();
    let compiler = compiler.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    let compiler = compiler.as_deref().map_or("unknown", str::trim);
    for (name, value) in [
        ("CREPITUS_COMPILER", compiler),
        ("CREPITUS_OPT_LEVEL", &of("OPT_LEVEL")),
        ("CREPITUS_TARGET", &of("TARGET")),
        ("CREPITUS_TARGET_FEATURES", &of("CARGO_CFG_TARGET_FEATURE")),
    ] {
        println!("cargo::rustc-env={name}={value}");
    }
}
