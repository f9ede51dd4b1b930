//! Images from the real compiler.
//!
//! Needs the target `thumbv7em-none-eabihf`; without it the tests say so and
//! pass, unless `CREPITUS_NEEDS_TARGET` is set.

use crepitus_tools::image::budget::Budget;
use crepitus_tools::image::lines::Lines;
use crepitus_tools::image::{Image, Report, Subject, examine, memory};
use std::path::Path;
use std::process::Command;

const TARGET: &str = "thumbv7em-none-eabihf";

const MEMORY: &str = "MEMORY { FLASH : ORIGIN = 0x08000000, LENGTH = 64K
                               RAM : ORIGIN = 0x20000000, LENGTH = 16K }";

const SECTIONS: &str = "
SECTIONS {
  .vector_table ORIGIN(FLASH) : { KEEP(*(.vector_table)) } > FLASH
  .text : { *(.text .text.*) } > FLASH
  .rodata : { *(.rodata .rodata.*) } > FLASH
  .data : { *(.data .data.*) } > RAM AT > FLASH
  .bss (NOLOAD) : { *(.bss .bss.*) } > RAM
  /DISCARD/ : { *(.ARM.exidx .ARM.exidx.*) }
}";

/// Compiles a program; nothing if the target is not installed.
pub(crate) fn compile(folder: &Path, program: &str) -> Option<Vec<u8>> {
    let at = |name: &str| folder.join(name);
    std::fs::write(at("it.rs"), program).unwrap();
    std::fs::write(at("it.x"), format!("{MEMORY}{SECTIONS}")).unwrap();
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc)
        .args([
            "--edition",
            "2024",
            "--target",
            TARGET,
            "--crate-name",
            "it",
        ])
        .args([
            "-C",
            "opt-level=2",
            "-C",
            "debuginfo=1",
            "-C",
            "panic=abort",
        ])
        .args([
            "-C",
            "link-arg=-Tit.x",
            "-C",
            "link-arg=--nmagic",
            "-o",
            "it.elf",
            "it.rs",
        ])
        .current_dir(folder)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    if said.contains("target may not be installed") {
        assert!(
            std::env::var_os("CREPITUS_NEEDS_TARGET").is_none(),
            "the target {TARGET} is not installed"
        );
        println!("left out: the target {TARGET} is not installed");
        return None;
    }
    assert!(output.status.success(), "{said}");
    Some(std::fs::read(at("it.elf")).unwrap())
}

/// The report against the text of a budget for the image `it`.
pub(crate) fn report(bytes: &[u8], lines: &Lines, budget: &str) -> Report {
    let budget = Budget::parse(Path::new("budget.toml"), budget).unwrap();
    let subject = Subject {
        image: &Image::parse(bytes).unwrap(),
        lines,
        memory: &memory::parse(MEMORY).unwrap(),
        budget: &budget.images["it"],
        shared_loops: &budget.loops,
        tolerance_percent: 2.0,
    };
    examine("it", subject).unwrap()
}
