//! An image with a fault in it, and the emulator's tests run on it.

use crate::faults::firmware::{FirmwareError, FirmwareFault, Program};
use crate::faults::process::{End, run};
use crate::faults::tree::{copy, write_if_changed};
use crate::faults::trial::{Builder, TrialError, io};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Tests of the drive's image that look at registers, locks, outputs, tasks, protected
/// memory, the post-mortem record and the coil.
const FIRST: [&str; 9] = [
    "registers::",
    "locks::",
    "outputs::",
    "killed::",
    "mpu::",
    "crash::",
    "commits::",
    "actuator::it",
    "actuator::what",
];

/// Some tests of a test program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Suite {
    test: &'static str,
    /// Those that are run; all, if empty.
    only: &'static [&'static str],
    /// Those that are not.
    not: &'static [&'static str],
}

const fn suite(
    test: &'static str,
    only: &'static [&'static str],
    not: &'static [&'static str],
) -> Suite {
    Suite { test, only, not }
}

/// Suites that are run on an image with a fault; a later one only if those before notice
/// nothing.
fn suites(program: Program) -> [Suite; 2] {
    match program {
        Program::Drive => [
            suite("drive_image", &FIRST, &[]),
            suite("drive_image", &[], &FIRST),
        ],
        Program::Comms => [
            suite("drive_image", &["registers::", "mpu::comms"], &[]),
            suite("pair", &[], &[]),
        ],
    }
}

/// Timeout of a run of tests: many times that of the slowest on a slow machine.
const TESTS: Duration = Duration::from_mins(15);

/// Timeout of a build.
const BUILD: Duration = Duration::from_hours(1);

/// Outcome of a fault of the firmware: what noticed it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FirmwareOutcome {
    /// The fault.
    pub name: String,
    /// Fingerprint of the sources and the fault.
    pub fingerprint: u64,
    /// The tests that failed by themselves.
    pub tests: Vec<String>,
    /// Message of the emulated board, which ends every test that runs it.
    pub board: Option<String>,
}

impl FirmwareOutcome {
    /// Returns whether anything has noticed the fault.
    pub fn is_noticed(&self) -> bool {
        !self.tests.is_empty() || self.board.is_some()
    }

    /// The outcome of a fault in an earlier run on the same sources.
    pub fn load(folder: &Path, name: &str, fingerprint: u64) -> Option<Self> {
        let text = fs::read_to_string(folder.join(format!("{name}.json"))).ok()?;
        let known: Self = serde_json::from_str(&text).ok()?;
        (known.fingerprint == fingerprint).then_some(known)
    }

    /// Stores it.
    ///
    /// # Errors
    /// The file system's error.
    pub fn save(&self, folder: &Path) -> std::io::Result<()> {
        let text = serde_json::to_string_pretty(self)?;
        write_if_changed(&folder.join(format!("{}.json", self.name)), text.as_bytes())
    }
}

/// A number that changes with the sources and with the fault.
pub fn fingerprint(sources: u64, fault: &FirmwareFault) -> u64 {
    let mut hasher = DefaultHasher::new();
    (sources, fault).hash(&mut hasher);
    hasher.finish()
}

/// The copy of the sources that faults are planted in, and the emulator's tests
/// built from the sources themselves.
pub struct FirmwareWorkshop {
    root: PathBuf,
    tree: PathBuf,
    scratch: PathBuf,
    cargo: String,
    /// The images without a fault.
    sound: BTreeMap<Program, Vec<u8>>,
    /// Suites that hold on them.
    holds: BTreeSet<Suite>,
}

impl FirmwareWorkshop {
    /// Copies the sources in `root`, and builds the tests and both images.
    ///
    /// # Errors
    /// [`TrialError`] if something does not build.
    pub fn open(root: &Path, scratch: &Path, cargo: &str) -> Result<Self, TrialError> {
        let tree = scratch.join("firmware-tree");
        copy(root, &tree, &BTreeMap::new()).map_err(io(&tree))?;
        // The tests themselves have no fault.
        let builder = Builder {
            scratch,
            tree: root,
            cargo,
            has_faults: false,
        };
        for test in ["drive_image", "pair"] {
            let arguments = [
                "test",
                "-p",
                "crepitus-emulator",
                "--test",
                test,
                "--no-run",
            ];
            let built = builder.build(&arguments)?;
            let program = built.into_iter().find(|program| program.name == test);
            let program = program.ok_or_else(|| TrialError::Build(scratch.join("build.txt")))?;
            // A copy, which no other build replaces meanwhile.
            let own = scratch.join(test);
            fs::copy(&program.path, &own).map_err(io(&own))?;
        }
        let mut workshop = Self {
            root: root.to_owned(),
            tree,
            scratch: scratch.to_owned(),
            cargo: cargo.to_owned(),
            sound: BTreeMap::new(),
            holds: BTreeSet::new(),
        };
        let images = workshop.images();
        fs::create_dir_all(&images).map_err(io(&images))?;
        for program in Program::ALL {
            let image = workshop.build_image(program)?;
            workshop.place_image(program, &image)?;
            workshop.sound.insert(program, image);
        }
        Ok(workshop)
    }

    /// Fails if a test fails without a fault; no fault must be in place.
    fn baseline(&mut self, suite: Suite) -> Result<(), TrialError> {
        if self.holds.contains(&suite) {
            return Ok(());
        }
        let (failed, board) = self.run_tests(suite)?;
        if let Some(test) = failed.into_iter().next().or(board) {
            return Err(TrialError::Baseline(test));
        }
        self.holds.insert(suite);
        Ok(())
    }

    fn place_image(&self, program: Program, image: &[u8]) -> Result<(), TrialError> {
        let place = self.images().join(program.name());
        fs::write(&place, image).map_err(io(&place))
    }

    fn images(&self) -> PathBuf {
        self.scratch.join("images")
    }

    /// Builds an image with a fault, and runs tests on it until one suite notices it.
    ///
    /// # Errors
    /// [`TrialError`] if the fault does not apply or does not build, or if a test
    /// fails without it.
    pub fn try_fault(
        &mut self,
        fault: &FirmwareFault,
        fingerprint: u64,
    ) -> Result<FirmwareOutcome, TrialError> {
        let image = self.planted(fault)?;
        let (mut tests, mut board) = (Vec::new(), None);
        for suite in suites(fault.program) {
            self.baseline(suite)?;
            self.place_image(fault.program, &image)?;
            let noticed = self.run_tests(suite);
            let sound = self
                .sound
                .get(&fault.program)
                .map_or(&[][..], Vec::as_slice);
            self.place_image(fault.program, sound)?;
            (tests, board) = noticed?;
            if !tests.is_empty() || board.is_some() {
                break;
            }
        }
        Ok(FirmwareOutcome {
            name: fault.name.clone(),
            fingerprint,
            tests,
            board,
        })
    }

    /// The image with a fault.
    fn planted(&self, fault: &FirmwareFault) -> Result<Vec<u8>, TrialError> {
        let sources = fault.sources(&self.root).map_err(|error| planted(&error))?;
        for (file, text) in &sources {
            let path = self.tree.join(file);
            write_if_changed(&path, text.as_bytes()).map_err(io(&path))?;
        }
        let built = self.build_image(fault.program);
        for file in sources.keys() {
            let (from, to) = (self.root.join(file), self.tree.join(file));
            let text = fs::read(&from).map_err(io(&from))?;
            write_if_changed(&to, &text).map_err(io(&to))?;
        }
        let mut image = built?;
        let edited = fault.edit_image(&mut image);
        edited.map_err(|error| planted(&error))?;
        Ok(image)
    }

    /// The bytes of a program's file.
    fn build_image(&self, program: Program) -> Result<Vec<u8>, TrialError> {
        let program = program.name();
        let log = self.scratch.join("image.txt");
        let target = std::path::absolute(self.scratch.join("firmware-target")).map_err(io(&log))?;
        let package = format!("crepitus-firmware-{program}");
        let mut command = Command::new(&self.cargo);
        command
            .args(["build", "--release", "--locked", "--package", &package])
            .current_dir(self.tree.join("firmware"))
            .env_remove("RUSTFLAGS")
            .env("CARGO_TARGET_DIR", &target);
        let end = run(&mut command, &log, BUILD).map_err(io(Path::new(&self.cargo)))?;
        if end != End::Success {
            return Err(TrialError::Build(log));
        }
        let file = target.join("thumbv7em-none-eabihf/release").join(program);
        fs::read(&file).map_err(io(&file))
    }

    /// The tests that fail by themselves, and what the board says.
    fn run_tests(&self, suite: Suite) -> Result<(Vec<String>, Option<String>), TrialError> {
        let log = self.scratch.join("tests.txt");
        let images = std::path::absolute(self.images()).map_err(io(&log))?;
        let program = std::path::absolute(self.scratch.join(suite.test)).map_err(io(&log))?;
        let mut command = Command::new(program);
        command
            .args(suite.only)
            .args(suite.not.iter().flat_map(|name| ["--skip", name]))
            .current_dir(self.root.join("sim/emulator"))
            .env("CREPITUS_IMAGES", images)
            .env_remove("CREPITUS_BLESS");
        let end = run(&mut command, &log, TESTS).map_err(io(&log))?;
        let text = fs::read_to_string(&log).map_err(io(&log))?;
        let failed = failed_tests(&text);
        if failed.is_empty() && end != End::Success {
            return Ok((vec!["the tests hang or end early".to_owned()], None));
        }
        let board = failed.values().find_map(|message| mismatch(message));
        let by_themselves = failed
            .iter()
            .filter(|(_, message)| mismatch(message).is_none());
        let tests = by_themselves.map(|(name, _)| name.clone()).collect();
        Ok((tests, board.map(str::to_owned)))
    }
}

fn planted(error: &FirmwareError) -> TrialError {
    TrialError::Firmware(error.to_string())
}

/// The failed tests in the output of a test program, by name, each with the
/// first line of its message.
fn failed_tests(text: &str) -> BTreeMap<String, String> {
    let names = text.lines().filter_map(|line| {
        let name = line.strip_prefix("test ")?.strip_suffix(" ... FAILED")?;
        Some((name.to_owned(), String::new()))
    });
    let mut failed: BTreeMap<String, String> = names.collect();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let name = line
            .strip_prefix("thread '")
            .and_then(|rest| rest.split_once('\''));
        let Some((name, rest)) = name else { continue };
        if let (true, Some(failed)) = (rest.contains(" panicked at "), failed.get_mut(name)) {
            lines.next().unwrap_or_default().clone_into(failed);
        }
    }
    failed
}

/// The board's message, if that is the message of a failed test: `tick 3: PA0
/// is …`.
fn mismatch(message: &str) -> Option<&str> {
    let (tick, what) = message.strip_prefix("tick ")?.split_once(": ")?;
    tick.parse::<u64>().ok().map(|_| what)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_and_mismatches_are_found_in_the_output() {
        let text = "test b::c ... FAILED\ntest a ... ok\ntest a::b ... FAILED\n\n\
                    ---- a::b stdout ----\n\nthread 'a::b' (7) panicked at host.rs:1:2:\n\
                    tick 3: shoot-through: both\ntick 4: other\n";
        let failed = failed_tests(text);
        let names: Vec<&str> = failed.keys().map(String::as_str).collect();
        assert_eq!(names, ["a::b", "b::c"]);
        assert_eq!(mismatch(&failed["a::b"]), Some("shoot-through: both"));
        assert_eq!(mismatch(&failed["b::c"]), None);
        assert_eq!(mismatch("tick tock: x"), None);
    }
}
