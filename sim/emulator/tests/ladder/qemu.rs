//! QEMU as a second opinion: the same file, the same block of memory.
//!
//! One instruction a translation block, each logged as it is executed; once
//! all steps are made, its monitor writes down the memory.

use crepitus_emulator::ladder::Calls;
use crepitus_ladder::exchange::{
    ADDRESS, BEGIN, COMMAND, Input, Output, PLAN, RUN, STEP_WORDS, STEPS,
};
use crepitus_ladder::{Call, Plan};
use std::env;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};

const QEMU: &str = "qemu-system-arm";

/// Returns whether it is there; if not, a line about it.
///
/// # Panics
/// If it is not although `CREPITUS_NEEDS_QEMU` is set.
pub(crate) fn is_there() -> bool {
    let version = Command::new(QEMU).arg("--version").output();
    let is_there = version.is_ok_and(|output| output.status.success());
    if !is_there {
        assert!(
            env::var_os("CREPITUS_NEEDS_QEMU").is_none(),
            "{QEMU} is not installed"
        );
        println!("left out: {QEMU} is not installed");
    }
    is_there
}

/// Arguments for one instruction a block, as this version expects them.
fn one_instruction_a_block() -> &'static [&'static str] {
    let version = Command::new(QEMU).arg("--version").output().unwrap();
    let version = String::from_utf8_lossy(&version.stdout).into_owned();
    let numbers = version.split("version ").nth(1).unwrap_or_default();
    let mut numbers = numbers.split('.').map_while(|n| n.parse::<u32>().ok());
    if (numbers.next(), numbers.next()) >= (Some(8), Some(1)) {
        &["-accel", "tcg,one-insn-per-tb=on"]
    } else {
        &["-accel", "tcg", "-singlestep"]
    }
}

/// Runs a plan; its outputs and its calls, of which only instructions and path
/// are known. `entry` is where its step function is.
pub(crate) fn run(
    image: &Path,
    folder: &Path,
    plan: &Plan,
    inputs: &[Input],
    entry: u32,
) -> (Vec<Output>, Vec<Call>) {
    let words = words(plan, inputs);
    let (before, after) = (folder.join("before"), folder.join("after"));
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    fs::write(&before, &bytes).unwrap();
    let mut command = Command::new(QEMU);
    command
        .args(["-M", "netduinoplus2", "-display", "none", "-serial", "none"])
        .args(["-monitor", "stdio", "-d", "exec,nochain"])
        .args(one_instruction_a_block())
        .arg("-kernel")
        .arg(image)
        .arg("-device")
        .arg(format!(
            "loader,file={},addr={ADDRESS:#x},force-raw=on",
            before.display()
        ));
    let mut qemu = command
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut log = BufReader::new(qemu.stderr.take().unwrap());
    let mut monitor = qemu.stdin.take().unwrap();
    let mut calls = Calls::new(entry);
    let mut line = String::new();
    // What is logged may be put off: the next line says so.
    let mut pending = None;
    let mut is_asked = false;
    while log.read_line(&mut line).unwrap() > 0 {
        if let Some(pc) = address(&line) {
            if let Some(pc) = pending.replace(pc) {
                calls.instruction(pc, 0);
            }
        } else if line.starts_with("Stopped execution") {
            pending = None;
        }
        line.clear();
        if calls.count() == inputs.len() && !is_asked {
            is_asked = true;
            // The last output is on its way still: some more instructions.
            for _ in 0..100 {
                log.read_line(&mut line).unwrap();
                line.clear();
            }
            let (size, file) = (bytes.len(), after.display());
            let save = format!("pmemsave {ADDRESS:#x} {size} \"{file}\"");
            writeln!(monitor, "stop\n{save}\nquit").unwrap();
        }
    }
    assert!(qemu.wait().unwrap().success());
    let bytes = fs::read(&after).unwrap();
    let word = |n: usize| u32::from_le_bytes(bytes[4 * n..4 * n + 4].try_into().unwrap());
    let first = |n: usize| STEPS + STEP_WORDS * n;
    let outputs = (0..inputs.len()).map(|n| [0, 1, 2].map(|place| word(first(n) + place)));
    (outputs.collect(), calls.finish())
}

/// The block with a plan that is run at once.
fn words(plan: &Plan, inputs: &[Input]) -> Vec<u32> {
    let steps = u32::try_from(inputs.len()).unwrap();
    let mut words = vec![0; STEPS];
    words[COMMAND] = BEGIN | RUN;
    let encoded = Plan { steps, ..*plan }.encode();
    words[PLAN..PLAN + encoded.len()].copy_from_slice(&encoded);
    words.extend(inputs.iter().flat_map(Input::encode));
    words
}

/// Address of the instruction of a line of the log:
/// `Trace 0: 0x7f12 [00000000/08000418/00000110/ff000001] name`.
fn address(line: &str) -> Option<u32> {
    let inside = line.strip_prefix("Trace ")?.split('[').nth(1)?;
    let pc = inside.split('/').nth(1)?;
    u32::from_str_radix(pc, 16).ok()
}

#[test]
fn the_log_is_understood() {
    let line = "Trace 0: 0x7f5a04000100 [00000000/0800041c/00000110/ff000001] main\n";
    assert_eq!(address(line), Some(0x0800_041c));
    assert_eq!(address("qemu: something else\n"), None);
}
