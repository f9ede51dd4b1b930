//! Both images of the firmware against `firmware/budget.toml`.

use crepitus_emulator::firmware::{self, Program};
use crepitus_tools::image::Image;
use crepitus_tools::image::lines::Lines;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

#[test]
fn both_images_are_within_their_budget() {
    let mut command = Command::new(env!("CARGO_BIN_EXE_crepitus-image"));
    command
        .arg("check")
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."));
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

/// On both wires: what the compiler inlined is found by the lines of the code.
#[test]
fn both_images_frame_with_the_crate_cobs() {
    for program in [Program::Drive, Program::Comms] {
        if firmware::image_for_test(program).is_none() {
            return;
        }
        let elf = firmware::path(program).unwrap();
        let (image, lines) = (
            Image::parse(&std::fs::read(&elf).unwrap()).unwrap(),
            Lines::of(&elf),
        );
        let code = image.sections.iter().filter(|section| section.executable);
        let addresses = code.flat_map(|section| (section.address..section.end()).step_by(2));
        let functions: BTreeSet<String> = addresses
            .flat_map(|address| lines.frames(address))
            .map(|frame| frame.function)
            .filter(|function| function.starts_with("cobs::"))
            .collect();
        println!("{}: {functions:?}", program.name());
        for function in [
            "cobs::enc::EncoderState::push",
            "cobs::dec::DecoderState::feed",
        ] {
            assert!(
                functions.contains(function),
                "{}: {functions:?}",
                program.name()
            );
        }
    }
}
