//! Sizes, load addresses and the vector table, and the program as it is run.

use crate::common::*;
use crepitus_tools::image::{Image, ImageError};
use std::path::Path;
use std::process::{Command, Output};

fn innocent() -> Maker {
    Maker::new(calls("IRQ0", &[]), vec![])
}

/// The budget with these sizes on record.
fn recorded(flash: u32, ram: u32, stack: u32) -> String {
    budget("")
        .replace("flash = 100_000", &format!("flash = {flash}"))
        .replace("ram = 100_000", &format!("ram = {ram}"))
        .replace("stack = 100_000", &format!("stack = {stack}"))
}

#[test]
fn sizes_may_grow_by_two_percent() {
    let mut maker = innocent();
    maker.bss = 1_000;
    let report = examined(&maker.image(), &recorded(1, 1, 1));
    let [flash, ram, stack] = [0, 1, 2].map(|n| report.sizes[n].used);
    assert_eq!((ram, stack), (1_000, 8 + 36));
    assert_eq!(report.sizes[2].available, 16 * 1024 - 1_000);
    assert_eq!(failures(&report).len(), 3);

    let grown = |bytes| {
        maker.bss = bytes;
        examined(&maker.image(), &recorded(flash, 1_000, stack))
    };
    let mut grown = grown;
    assert!(grown(1_020).passes());
    let report = grown(1_021);
    assert_eq!(
        failures(&report),
        ["record: ram has grown from 1,000 to 1,021 bytes (+2.1 %)"]
    );
    assert!(grown(950).hints.is_empty());
    assert_eq!(grown(949).hints.len(), 1);
}

#[test]
fn a_stack_without_room_fails() {
    let mut maker = innocent();
    maker.bss = 16 * 1024 - 40;
    let found = failures(&maker.report(""));
    assert_eq!(found, ["room: stack needs 44 bytes, there are 40"]);
}

#[test]
fn nothing_is_loaded_where_it_must_not_be() {
    let mut maker = innocent();
    maker.load = FLASH + 0xFE00;
    let found = failures(&maker.report(""));
    assert!(
        found
            .iter()
            .any(|f| f.contains("outside the flash memories")),
        "{found:?}"
    );

    let reserved = |from: u32, to: u32| {
        let more = format!("[[images.it.reserved]]\nfrom = {from}\nto = {to}\nwhat = \"the log\"");
        failures(&innocent().report(&more))
    };
    let code = Maker::address(0);
    assert_eq!(reserved(code - 0x100, code), [""; 0]);
    let found = reserved(code - 0x100, code + 1);
    assert!(
        found[0].ends_with("are where the log has its place"),
        "{found:?}"
    );
}

#[test]
fn the_vector_table_decides_what_an_interrupt_is() {
    let other = function("OTHER", &[BX_LR]);
    let mut maker = Maker::new(calls("IRQ0", &[]), vec![other]);
    maker.handlers = vec![3, 2];
    let found = failures(&maker.report(""));
    assert_eq!(
        found,
        [
            "vectors: interrupt 0 starts OTHER, not IRQ0",
            "vectors: interrupt 1 starts IRQ0, which the budget does not know",
        ]
    );
    maker.handlers = vec![1];
    let found = failures(&maker.report(""));
    assert_eq!(
        found,
        ["vectors: interrupt 0 starts the default handler, not IRQ0"]
    );
}

#[test]
fn other_files_are_refused() {
    assert!(matches!(
        Image::parse(b"no ELF at all"),
        Err(ImageError::Elf(_))
    ));
    let mut elf = innocent().elf();
    elf[18] = 62;
    assert!(matches!(Image::parse(&elf), Err(ImageError::Machine)));
    let elf = innocent().elf();
    for length in 0..elf.len() {
        // Whatever is missing: an error or a part of the image, never a panic.
        let _ = Image::parse(&elf[..length]);
    }
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_crepitus-image");
    let output = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .output();
    output.unwrap()
}

#[test]
fn the_program_checks_and_blesses() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("it.elf"), innocent().elf()).unwrap();
    std::fs::write(at("memory.x"), MEMORY).unwrap();
    std::fs::write(at("budget.toml"), recorded(1, 100_000, 1)).unwrap();
    let check = ["check", "--budget", "budget.toml"];

    let before = run(folder.path(), &check);
    let text = String::from_utf8(before.stdout).unwrap();
    assert_eq!(before.status.code(), Some(1), "{text}");
    assert!(
        text.contains("check --bless") && text.contains("IRQ0"),
        "{text}"
    );

    let blessed = run(folder.path(), &[&check[..], &["--bless"]].concat());
    assert_eq!(blessed.status.code(), Some(0));
    let budget = std::fs::read_to_string(at("budget.toml")).unwrap();
    assert!(
        budget.contains("ram = 64\n") && budget.contains(" # bytes\n"),
        "{budget}"
    );

    let after = run(folder.path(), &[&check[..], &["--json"]].concat());
    assert_eq!(after.status.code(), Some(0));
    let json: serde_json::Value = serde_json::from_slice(&after.stdout).unwrap();
    assert_eq!(json[0]["sizes"][1]["used"], 64);

    let look = run(folder.path(), &["look", "it.elf", "--root", "IRQ0"]);
    assert!(
        String::from_utf8(look.stdout)
            .unwrap()
            .contains("cannot panic")
    );
    for bad in [
        &["look", "it.elf", "--root", "irq"][..],
        &["check", "other", "--budget", "budget.toml"],
        &["check", "--budget", "budget.toml", "--elf", "it=gone.elf"],
        &["check", "--budget", "gone.toml"],
    ] {
        let output = run(folder.path(), bad);
        assert_eq!(output.status.code(), Some(2), "{bad:?}");
        assert!(
            String::from_utf8(output.stderr)
                .unwrap()
                .starts_with("error: ")
        );
    }
}
