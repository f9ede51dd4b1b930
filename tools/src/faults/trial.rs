//! The copy with all faults in it, built once, and one fault at a time in
//! force.

use crate::faults::fault::{Fault, FaultError, plant};
use crate::faults::outcome::{CaseOutcome, Outcome, failed_test, read_cases};
use crate::faults::process::{End, run};
use crate::faults::tree::copy;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Timeout of a build, waiting for others included.
const BUILD: Duration = Duration::from_hours(1);

/// Timeout of a program: many times that of the slowest on a slow machine.
const RUN: Duration = Duration::from_mins(3);

/// The variable with the number of the active fault; 0 is none.
const SWITCH: &str = "CREPITUS_FAULT";

/// The crate of all faults.
const CRATE: &str = "model/src/lib.rs";

/// Code added to the copy's model for the faults.
const PLANTED: &str = "
/// The planted fault that is in force.
#[allow(missing_docs)]
pub mod planted {
    extern crate std;

    #[inline]
    pub fn is(number: u32) -> bool {
        static NOW: std::sync::OnceLock<u32> = std::sync::OnceLock::new();
        let now = NOW.get_or_init(|| {
            let given = std::env::var(\"CREPITUS_FAULT\").ok();
            given.and_then(|text| text.parse().ok()).unwrap_or(0)
        });
        *now == number
    }
}
";

/// Reason why a fault could not be tried.
#[derive(Debug, thiserror::Error)]
pub enum TrialError {
    /// The fault does not apply.
    #[error(transparent)]
    Fault(#[from] FaultError),
    /// A file or a program failed.
    #[error("{what}: {source}")]
    Io {
        /// The file or program.
        what: String,
        /// The cause.
        source: io::Error,
    },
    /// The sources with the faults do not build.
    #[error("the sources with the faults do not build: see {}", .0.display())]
    Build(PathBuf),
    /// A fault of the firmware does not apply.
    #[error("{0}")]
    Firmware(String),
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

/// The programs that detect faults.
#[derive(Clone, Debug)]
pub struct Workshop {
    scratch: PathBuf,
    tree: PathBuf,
    cases: PathBuf,
    tests: Vec<Program>,
    /// Every case, in the order of the catalogue.
    all: Vec<String>,
}

/// A built program.
#[derive(Clone, Debug)]
pub(crate) struct Program {
    pub(crate) name: String,
    pub(crate) path: PathBuf,
}

/// Builds programs from the sources, or from a copy of them with faults.
pub(crate) struct Builder<'a> {
    pub(crate) scratch: &'a Path,
    pub(crate) tree: &'a Path,
    pub(crate) cargo: &'a str,
    pub(crate) has_faults: bool,
}

#[derive(Deserialize)]
struct Message {
    executable: Option<PathBuf>,
    target: Option<Target>,
}

#[derive(Deserialize)]
struct Target {
    name: String,
}

impl Workshop {
    /// Copies the sources in `root`, plants all faults, builds the hard cases
    /// and, `with_tests`, the model's tests, and makes sure that everything
    /// holds while none is in force.
    ///
    /// # Errors
    /// [`TrialError`] if a fault does not apply, the copy does not build, or
    /// something fails without a fault.
    pub fn open(
        root: &Path,
        scratch: &Path,
        cargo: &str,
        faults: &[Fault],
        with_tests: bool,
    ) -> Result<Self, TrialError> {
        let tree = scratch.join("tree");
        let mut planted: BTreeMap<PathBuf, String> = BTreeMap::new();
        let mut by_file: BTreeMap<&str, Vec<(usize, &Fault)>> = BTreeMap::new();
        for (n, fault) in faults.iter().enumerate() {
            by_file.entry(&fault.file).or_default().push((n + 1, fault));
        }
        for (file, here) in by_file {
            let path = root.join(file);
            let source = fs::read_to_string(&path).map_err(io(&path))?;
            planted.insert(PathBuf::from(file), plant(&source, &here)?);
        }
        let path = root.join(CRATE);
        let source = fs::read_to_string(&path).map_err(io(&path))?;
        planted.insert(PathBuf::from(CRATE), source + PLANTED);
        copy(root, &tree, &planted).map_err(io(&tree))?;

        let mut workshop = Self {
            scratch: scratch.to_owned(),
            tree,
            cases: PathBuf::new(),
            tests: Vec::new(),
            all: Vec::new(),
        };
        let example = [
            "build",
            "-p",
            "crepitus-studies",
            "--example",
            "broken_cases",
        ];
        let builder = Builder {
            scratch,
            tree: &workshop.tree,
            cargo,
            has_faults: true,
        };
        let built = builder.build(&example)?;
        workshop.cases = match built.into_iter().find(|b| b.name == "broken_cases") {
            Some(program) => program.path,
            None => return Err(TrialError::Build(workshop.scratch.join("build.txt"))),
        };
        if with_tests {
            workshop.tests = builder.build(&["test", "-p", "crepitus-model", "--no-run"])?;
        }
        workshop.baseline()?;
        Ok(workshop)
    }

    /// Tries the hard cases on fault `number`, counted from 1.
    ///
    /// # Errors
    /// [`TrialError::Io`] if the program cannot be run.
    pub fn try_cases(
        &self,
        number: usize,
        fault: &Fault,
        fingerprint: u64,
    ) -> Result<Outcome, TrialError> {
        let (end, text) = self.run_cases(number)?;
        Ok(Outcome {
            name: fault.name.clone(),
            fingerprint,
            cases: self.read(&text, end),
            tested: false,
            test: None,
        })
    }

    /// Tries the model's tests on fault `number`.
    ///
    /// # Errors
    /// [`TrialError::Io`] if a program cannot be run.
    pub fn try_tests(&self, number: usize, outcome: &mut Outcome) -> Result<(), TrialError> {
        outcome.test = self.run_tests(number)?;
        outcome.tested = true;
        Ok(())
    }

    fn read(&self, text: &str, end: End) -> Vec<CaseOutcome> {
        read_cases(text, end == End::Success, &self.all)
    }

    fn baseline(&mut self) -> Result<(), TrialError> {
        let (end, text) = self.run_cases(0)?;
        let line = text.lines().find(|line| !line.ends_with(" holds"));
        if let Some(line) = line {
            return Err(TrialError::Baseline(line.to_owned()));
        }
        let ids = text.lines().filter_map(|line| line.split_once(' '));
        self.all = ids.map(|(id, _)| id.to_owned()).collect();
        if end != End::Success || self.all.is_empty() {
            return Err(TrialError::Baseline("broken_cases".to_owned()));
        }
        match self.run_tests(0)? {
            Some(test) => Err(TrialError::Baseline(test)),
            None => Ok(()),
        }
    }

    /// The hard cases with fault `number` in force.
    fn run_cases(&self, number: usize) -> Result<(End, String), TrialError> {
        let mut command = Command::new(&self.cases);
        self.run(&mut command, number)
    }

    /// The model's tests, program by program, until one fails: its name.
    fn run_tests(&self, number: usize) -> Result<Option<String>, TrialError> {
        for Program { name, path } in &self.tests {
            let mut command = Command::new(path);
            command
                .current_dir(self.tree.join("model"))
                .env("PROPTEST_RNG_SEED", "1")
                .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1");
            let (end, text) = self.run(&mut command, number)?;
            let which = match end {
                End::Success => continue,
                End::Timeout => "hangs",
                End::Failure => failed_test(&text).unwrap_or("ends early"),
            };
            return Ok(Some(format!(
                "{}: {which}",
                name.trim_start_matches("crepitus_")
            )));
        }
        Ok(None)
    }

    fn run(&self, command: &mut Command, number: usize) -> Result<(End, String), TrialError> {
        let log = self.scratch.join("run.txt");
        command.env(SWITCH, number.to_string());
        let end = run(command, &log, RUN).map_err(io(&log))?;
        Ok((end, fs::read_to_string(&log).map_err(io(&log))?))
    }
}

impl Builder<'_> {
    /// Builds, and returns the programs.
    pub(crate) fn build(&self, arguments: &[&str]) -> Result<Vec<Program>, TrialError> {
        let log = self.scratch.join("build.txt");
        let mut command = Command::new(self.cargo);
        command
            .args(arguments)
            .args(["--quiet", "--message-format", "json"])
            .current_dir(self.tree);
        if self.has_faults {
            command
                // Each fault is in brackets, some of which are not needed.
                .env("RUSTFLAGS", "--cap-lints allow")
                // Never that of the work tree: to Cargo the copy's crates are the
                // same, and their faults would remain there.
                .env("CARGO_TARGET_DIR", self.scratch.join("target"));
        }
        let end = run(&mut command, &log, BUILD).map_err(io(Path::new(self.cargo)))?;
        let text = fs::read_to_string(&log).map_err(io(&log))?;
        if end != End::Success {
            return Err(TrialError::Build(log));
        }
        Ok(text
            .lines()
            .filter_map(|line| serde_json::from_str::<Message>(line).ok())
            .filter_map(|message| {
                Some(Program {
                    name: message.target?.name,
                    path: message.executable?,
                })
            })
            .collect())
    }
}
