//! The copy of the sources with one fault at a time, and the test that has to notice it.
//!
//! A test of images is built without the fault and runs an image with it: registers, locks and
//! the linker script are not in the test itself, and what it compares with is sound.

use crate::faults::outcome::{Outcome, failed_test, has_passed};
use crate::faults::patch::{Change, Fault, PatchError, Program};
use crate::faults::process::{End, run};
use crate::faults::tree::copy;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

/// Timeout of a build, waiting for others included.
const BUILD: Duration = Duration::from_hours(1);

/// Timeout of a test program: many times that of the slowest on a slow machine.
const RUN: Duration = Duration::from_mins(15);

/// Shorter timeout with a fault: so many times what the tests take without one, and so much more.
const WITH_A_FAULT: (u32, Duration) = (10, Duration::from_mins(1));

/// Name of the logs of what runs without a fault.
const SOUND: &str = "without-a-fault";

/// Reason why a fault could not be tried.
#[derive(Debug, thiserror::Error)]
pub enum TrialError {
    /// The fault does not apply.
    #[error(transparent)]
    Patch(#[from] PatchError),
    /// A file or a program failed.
    #[error("{what}: {source}")]
    Io {
        /// The file or program.
        what: String,
        /// The cause.
        source: io::Error,
    },
    /// The copy of the sources does not build.
    #[error("the copy of the sources does not build: see {}", .0.display())]
    Build(PathBuf),
    /// Something fails without any fault.
    #[error("without a fault this fails: {0}")]
    Baseline(String),
}

/// Adds the file to an error of the file system.
pub(crate) fn io(what: &Path) -> impl FnOnce(io::Error) -> TrialError + '_ {
    move |source| TrialError::Io {
        what: what.display().to_string(),
        source,
    }
}

/// The copy of the sources, and programs built from it.
#[derive(Debug)]
pub struct Workshop {
    scratch: PathBuf,
    tree: PathBuf,
    cargo: String,
    /// Images without a fault; empty until a test needs them.
    sound: BTreeMap<Program, Vec<u8>>,
    /// Arguments of tests that pass without a fault, whether they run images, and what they take.
    passed: BTreeMap<(String, bool), Duration>,
}

/// A built test program.
struct TestProgram {
    name: String,
    path: PathBuf,
    /// Folder of its package.
    folder: PathBuf,
}

/// End of tests.
enum Ran {
    Passed(Duration),
    /// No test has this name.
    Nothing,
    Failed(String),
    NotBuilt,
}

#[derive(Deserialize)]
struct Message {
    executable: Option<PathBuf>,
    manifest_path: Option<PathBuf>,
    profile: Option<Profile>,
    target: Option<Target>,
}

#[derive(Deserialize)]
struct Profile {
    test: bool,
}

#[derive(Deserialize)]
struct Target {
    name: String,
}

impl Workshop {
    /// Copies the sources in `root`.
    ///
    /// # Errors
    /// [`TrialError::Io`] if they cannot be copied.
    pub fn open(root: &Path, scratch: &Path, cargo: &str) -> Result<Self, TrialError> {
        let scratch = std::path::absolute(scratch).map_err(io(scratch))?;
        let tree = scratch.join("tree");
        copy(root, &tree, &BTreeMap::new()).map_err(io(&tree))?;
        for folder in ["logs", "images"] {
            let folder = scratch.join(folder);
            fs::create_dir_all(&folder).map_err(io(&folder))?;
        }
        Ok(Self {
            scratch,
            tree,
            cargo: cargo.to_owned(),
            sound: BTreeMap::new(),
            passed: BTreeMap::new(),
        })
    }

    /// Runs the test that has to notice a fault, without it.
    ///
    /// # Errors
    /// [`TrialError::Baseline`] if it fails, or if there is no such test.
    pub fn baseline(&mut self, fault: &Fault) -> Result<(), TrialError> {
        let Some(arguments) = &fault.noticed_by else {
            return Ok(());
        };
        let on_images = fault.program.is_some();
        let test = (arguments.clone(), on_images);
        if self.passed.contains_key(&test) {
            return Ok(());
        }
        if on_images && self.sound.is_empty() {
            for program in Program::ALL {
                let image = self.build_image(program, SOUND)?;
                let image = image.ok_or_else(|| TrialError::Build(self.log(SOUND, "image")))?;
                self.place_image(program, &image)?;
                self.sound.insert(program, image);
            }
        }
        match self.run_tests(arguments, on_images, SOUND)? {
            Ran::Passed(took) => {
                self.passed.insert(test, took);
                Ok(())
            }
            Ran::Nothing => Err(TrialError::Baseline(format!(
                "`cargo test {arguments}` runs no test"
            ))),
            Ran::Failed(test) => Err(TrialError::Baseline(test)),
            Ran::NotBuilt => Err(TrialError::Build(self.log(SOUND, "build"))),
        }
    }

    /// Plants a fault, runs the test that has to notice it, and restores the sources. `None` if
    /// they do not build with the fault.
    ///
    /// # Errors
    /// [`TrialError`] if the fault does not apply, or if the test fails without it.
    pub fn attempt(&mut self, fault: &Fault) -> Result<Option<Outcome>, TrialError> {
        self.baseline(fault)?;
        let (name, changes) = (&fault.name, fault.apply(&self.tree)?);
        let Some(arguments) = &fault.noticed_by else {
            return Ok(Some(Outcome::NotNoticed));
        };
        let ran = if let Some(program) = fault.program {
            let image = self.with(&changes, || self.build_image(program, name))?;
            let Some(mut image) = image else {
                return Ok(None);
            };
            fault.edit_image(&mut image)?;
            self.place_image(program, &image)?;
            let ran = self.run_tests(arguments, true, name);
            if let Some(sound) = self.sound.get(&program) {
                self.place_image(program, sound)?;
            }
            ran?
        } else {
            self.with(&changes, || self.run_tests(arguments, false, name))?
        };
        Ok(match ran {
            Ran::Passed(_) | Ran::Nothing => Some(Outcome::NotNoticed),
            Ran::Failed(test) => Some(Outcome::Noticed(test)),
            Ran::NotBuilt => None,
        })
    }

    /// Does something while the copy has these changes.
    fn with<T>(
        &self,
        changes: &BTreeMap<PathBuf, Change>,
        work: impl FnOnce() -> Result<T, TrialError>,
    ) -> Result<T, TrialError> {
        for (file, change) in changes {
            self.write(file, &change.now)?;
        }
        let done = work();
        for (file, change) in changes {
            self.write(file, &change.was)?;
        }
        done
    }

    fn write(&self, file: &Path, text: &str) -> Result<(), TrialError> {
        let path = self.tree.join(file);
        fs::write(&path, text).map_err(io(&path))
    }

    /// Builds test programs and runs them until one fails.
    fn run_tests(&self, arguments: &str, on_images: bool, name: &str) -> Result<Ran, TrialError> {
        let (cargo, own) = arguments.split_once(" -- ").unwrap_or((arguments, ""));
        let Some(programs) = self.build_tests(cargo, name)? else {
            return Ok(Ran::NotBuilt);
        };
        let took = self.passed.get(&(arguments.to_owned(), on_images));
        let (times, more) = WITH_A_FAULT;
        let most = took.map_or(RUN, |took| RUN.min(*took * times + more));
        let log = self.log(name, "run");
        let mut ran = Ran::Nothing;
        let begun = Instant::now();
        for program in programs {
            let mut command = Command::new(&program.path);
            command
                .args(own.split_whitespace())
                .current_dir(&program.folder)
                .env("PROPTEST_RNG_SEED", "1")
                .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1")
                .env_remove("CREPITUS_BLESS")
                .env_remove("CREPITUS_LONG")
                .env_remove("CREPITUS_IMAGES");
            if on_images {
                command.env("CREPITUS_IMAGES", self.scratch.join("images"));
            }
            let end = run(&mut command, &log, most).map_err(io(&log))?;
            let text = fs::read_to_string(&log).map_err(io(&log))?;
            let which = match end {
                End::Success => {
                    if has_passed(&text) {
                        ran = Ran::Passed(begun.elapsed());
                    }
                    continue;
                }
                End::Timeout => "hangs",
                End::Failure => failed_test(&text).unwrap_or("ends early"),
            };
            let program = program.name.trim_start_matches("crepitus_");
            return Ok(Ran::Failed(format!("{program}: {which}")));
        }
        Ok(ran)
    }

    /// The test programs of these arguments of `cargo test`; `None` if they do not build.
    fn build_tests(
        &self,
        arguments: &str,
        name: &str,
    ) -> Result<Option<Vec<TestProgram>>, TrialError> {
        let log = self.log(name, "build");
        let mut command = Command::new(&self.cargo);
        command
            .args(["test", "--locked", "--no-run", "--quiet"])
            .args(["--message-format", "json"])
            .args(arguments.split_whitespace())
            .current_dir(&self.tree)
            .env("CARGO_PROFILE_DEV_DEBUG", "false")
            // Each fault changes a few lines; the gate switches this off.
            .env("CARGO_INCREMENTAL", "1")
            // A fault may leave something unused.
            .env("RUSTFLAGS", "--cap-lints allow")
            // Never that of the work tree: to Cargo the copy's crates are the
            // same, and their faults would remain there.
            .env("CARGO_TARGET_DIR", self.scratch.join("target"));
        let end = run(&mut command, &log, BUILD).map_err(io(Path::new(&self.cargo)))?;
        if end != End::Success {
            return Ok(None);
        }
        let text = fs::read_to_string(&log).map_err(io(&log))?;
        Ok(Some(text.lines().filter_map(test_program).collect()))
    }

    /// The bytes of a program's image; `None` if it does not build.
    fn build_image(&self, program: Program, name: &str) -> Result<Option<Vec<u8>>, TrialError> {
        let (log, program) = (self.log(name, "image"), program.name());
        let target = self.scratch.join("firmware-target");
        let mut command = Command::new(&self.cargo);
        command
            .args(["build", "--release", "--locked", "--package"])
            .arg(format!("crepitus-firmware-{program}"))
            .current_dir(self.tree.join("firmware"))
            .env_remove("RUSTFLAGS")
            .env("CARGO_TARGET_DIR", &target);
        let end = run(&mut command, &log, BUILD).map_err(io(Path::new(&self.cargo)))?;
        if end != End::Success {
            return Ok(None);
        }
        let file = target.join("thumbv7em-none-eabihf/release").join(program);
        fs::read(&file).map(Some).map_err(io(&file))
    }

    fn place_image(&self, program: Program, image: &[u8]) -> Result<(), TrialError> {
        let place = self.scratch.join("images").join(program.name());
        fs::write(&place, image).map_err(io(&place))
    }

    fn log(&self, name: &str, part: &str) -> PathBuf {
        self.scratch.join(format!("logs/{name}-{part}.txt"))
    }
}

/// The test program that a line of Cargo's output names.
fn test_program(line: &str) -> Option<TestProgram> {
    let message: Message = serde_json::from_str(line).ok()?;
    let is_test = message.profile?.test;
    let program = TestProgram {
        name: message.target?.name,
        path: message.executable?,
        folder: message.manifest_path?.parent()?.to_owned(),
    };
    is_test.then_some(program)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_test_programs_are_run() {
        let line = |test: bool| {
            format!(
                r#"{{"reason": "compiler-artifact", "manifest_path": "/a/model/Cargo.toml", "target": {{"name": "laws"}},
                    "profile": {{"opt_level": "1", "test": {test}}}, "executable": "/a/target/laws-1"}}"#
            )
        };
        let program = test_program(&line(true)).unwrap();
        assert_eq!(program.name, "laws");
        assert_eq!(program.folder, Path::new("/a/model"));
        assert!(test_program(&line(false)).is_none());
        assert!(test_program(r#"{"reason": "build-finished", "success": true}"#).is_none());
    }
}
