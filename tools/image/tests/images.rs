//! Both images of the firmware against `firmware/budget.toml`.

use crepitus_emulator::firmware::{self, Program};
use std::path::Path;
use std::process::Command;

#[test]
fn both_images_are_within_their_budget() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_crepitus-image"));
    command
        .arg("check")
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."));
    for program in [Program::Drive, Program::Comms] {
        if firmware::image_for_test(program).is_none() {
            return;
        }
        let (name, elf) = (program.name(), firmware::path(program).unwrap());
        command
            .arg("--elf")
            .arg(format!("{name}={}", elf.display()));
    }
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}");
    println!("{said}");
}
