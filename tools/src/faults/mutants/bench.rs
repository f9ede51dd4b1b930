//! The copy with all mutants in it, and one at a time in force.

use crate::faults::mutants::plant::{SWITCH, plant};
use crate::faults::mutants::{MODULE, MOST, Mutant};
use crate::faults::process::{End, run};
use crate::faults::tree::copy;
use crate::faults::trial::{TrialError, io};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

/// Timeout of a build: every operator is a function with branches.
const BUILD: Duration = Duration::from_hours(2);

/// The most builds: each leaves out the mutants that did not compile in the one before.
const BUILDS: u32 = 20;

/// Few random cases, and without the longest tests: a mutant that survives waits for all.
const CASES: (&str, &str) = ("PROPTEST_CASES", "16");
const LONGEST: [&str; 2] = ["--skip=frequency_converges", "--skip=a_hand_that_shakes"];

/// Timeout of a program: so many times what it takes without a mutant, and so much more.
const TIMEOUT: (u32, Duration) = (8, Duration::from_secs(8));

/// A test program.
#[derive(Clone, Debug)]
pub struct Program {
    /// Crate and program, for people.
    pub name: String,
    path: PathBuf,
    folder: PathBuf,
    takes: Duration,
    reaches: HashSet<u32>,
}

/// Outcome of a mutant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fate {
    /// This program failed, or hung.
    Noticed(String),
    /// All programs that reach it passed.
    Missed,
    /// No program reaches it.
    Unreached,
}

/// Planted mutants and the programs that may notice them.
#[derive(Debug)]
pub struct Bench {
    scratch: PathBuf,
    programs: Vec<Program>,
    /// Numbers of the mutants that are in the programs.
    pub placed: BTreeSet<u32>,
    /// Numbers of those that do not compile.
    pub unviable: BTreeSet<u32>,
}

#[derive(Deserialize)]
struct Line {
    reason: String,
    executable: Option<PathBuf>,
    manifest_path: Option<PathBuf>,
    target: Option<Target>,
    message: Option<Message>,
}

#[derive(Deserialize)]
struct Target {
    name: String,
}

#[derive(Deserialize)]
struct Message {
    level: String,
    spans: Vec<Place>,
}

#[derive(Deserialize)]
struct Place {
    file_name: PathBuf,
    byte_start: usize,
    byte_end: usize,
    is_primary: bool,
}

impl Bench {
    /// Plants the mutants of the crate in `folder` in a copy, and builds the programs of
    /// these arguments of `cargo test`.
    ///
    /// # Errors
    /// [`TrialError`] if the copy does not build without them, or a test fails without
    /// one in force.
    pub fn open(
        root: &Path,
        scratch: &Path,
        folder: &str,
        mutants: &[Mutant],
        tests: &[String],
    ) -> Result<Self, TrialError> {
        if mutants.len() > MOST {
            return Err(TrialError::Baseline(format!("{} mutants", mutants.len())));
        }
        let mut bench = Self {
            scratch: scratch.to_owned(),
            programs: Vec::new(),
            placed: BTreeSet::new(),
            unviable: BTreeSet::new(),
        };
        for _ in 0..BUILDS {
            bench.plant(root, folder, mutants)?;
            match bench.build(tests)? {
                Ok(programs) => {
                    bench.programs = programs;
                    bench.reach()?;
                    return Ok(bench);
                }
                Err(broken) if broken.is_empty() => break,
                Err(broken) => {
                    eprintln!("{} more do not compile", broken.len());
                    bench.unviable.extend(broken);
                }
            }
        }
        Err(TrialError::Build(bench.scratch.join("build.txt")))
    }

    fn plant(&mut self, root: &Path, folder: &str, mutants: &[Mutant]) -> Result<(), TrialError> {
        let mut by_file: BTreeMap<&Path, Vec<(u32, &Mutant)>> = BTreeMap::new();
        for (number, mutant) in (1..).zip(mutants) {
            let here = by_file.entry(&mutant.file).or_default();
            if !self.unviable.contains(&number) {
                here.push((number, mutant));
            }
        }
        self.placed.clear();
        let mut texts = BTreeMap::new();
        for (file, here) in by_file {
            let source = fs::read_to_string(root.join(file)).map_err(io(file))?;
            let (text, placed) = plant(&source, &here)
                .map_err(|error| TrialError::Baseline(format!("{}: {error}", file.display())))?;
            self.placed.extend(placed);
            texts.insert(file.to_owned(), text);
        }
        let lib = Path::new(folder).join("src/lib.rs");
        let text = match texts.remove(&lib) {
            Some(text) => text,
            None => fs::read_to_string(root.join(&lib)).map_err(io(&lib))?,
        };
        texts.insert(lib, text + MODULE);
        let tree = self.tree();
        copy(root, &tree, &texts).map_err(io(&tree))
    }

    fn tree(&self) -> PathBuf {
        self.scratch.join("tree")
    }

    /// The programs, or the mutants that do not compile.
    fn build(&self, tests: &[String]) -> Result<Result<Vec<Program>, BTreeSet<u32>>, TrialError> {
        let log = self.scratch.join("build.txt");
        let cargo = std::env::var("CREPITUS_CARGO").unwrap_or_else(|_| "cargo".to_owned());
        let (mut programs, mut broken) = (Vec::new(), BTreeSet::new());
        for arguments in tests {
            let mut command = Command::new(&cargo);
            command
                .args([
                    "test",
                    "--locked",
                    "--no-run",
                    "--quiet",
                    "--message-format",
                    "json",
                ])
                .args(arguments.split_whitespace())
                .current_dir(self.tree())
                .env("CARGO_PROFILE_DEV_DEBUG", "false")
                .env("RUSTFLAGS", "--cap-lints allow")
                .env("CARGO_TARGET_DIR", self.scratch.join("target"));
            let end = run(&mut command, &log, BUILD).map_err(io(Path::new(&cargo)))?;
            let text = fs::read_to_string(&log).map_err(io(&log))?;
            let lines = text
                .lines()
                .filter_map(|line| serde_json::from_str::<Line>(line).ok());
            for line in lines {
                match line {
                    Line {
                        message: Some(message),
                        ..
                    } if message.level == "error" => {
                        broken.extend(self.at_fault(&message));
                    }
                    Line {
                        reason,
                        executable: Some(path),
                        manifest_path: Some(manifest),
                        target: Some(target),
                        ..
                    } if reason == "compiler-artifact" => {
                        programs.extend(program(&path, &manifest, &target.name));
                    }
                    _ => {}
                }
            }
            if end != End::Success {
                return Ok(Err(broken));
            }
        }
        Ok(Ok(programs))
    }

    /// The mutants that an error of the compiler points at: within its place, or the
    /// one before it on the line.
    fn at_fault(&self, message: &Message) -> BTreeSet<u32> {
        let mut found = BTreeSet::new();
        for place in message.spans.iter().filter(|place| place.is_primary) {
            let Ok(text) = fs::read_to_string(self.tree().join(&place.file_name)) else {
                continue;
            };
            let before = text[..place.byte_start]
                .rsplit('\n')
                .next()
                .unwrap_or_default();
            match numbers(before).last() {
                Some(number) => found.extend([number]),
                None => found.extend(numbers(&text[place.byte_start..place.byte_end])),
            }
        }
        found
    }

    /// Runs each program without a mutant, and once more for what it reaches.
    fn reach(&mut self) -> Result<(), TrialError> {
        let (reached, log) = (
            self.scratch.join("reached.txt"),
            self.scratch.join("run.txt"),
        );
        for program in &mut self.programs {
            let begun = Instant::now();
            if run(&mut program.command(), &log, BUILD).map_err(io(&program.path))? != End::Success
            {
                return Err(TrialError::Baseline(program.name.clone()));
            }
            program.takes = begun.elapsed();
            let _ = fs::remove_file(&reached);
            let mut command = program.command();
            command.env("CREPITUS_REACHED", &reached);
            run(&mut command, &log, BUILD).map_err(io(&program.path))?;
            let text = fs::read_to_string(&reached).unwrap_or_default();
            program.reaches = text.lines().filter_map(|line| line.parse().ok()).collect();
            let (name, takes, reaches) = (
                &program.name,
                program.takes.as_secs_f64(),
                program.reaches.len(),
            );
            eprintln!("{name}: {takes:.2} s, reaches {reaches}");
        }
        self.programs.sort_by_key(|program| program.takes);
        Ok(())
    }

    /// Puts a mutant in force, and runs what reaches it until a program fails.
    ///
    /// # Errors
    /// If a program cannot be run.
    pub fn judge(&self, number: u32, worker: usize) -> Result<Fate, TrialError> {
        let log = self.scratch.join(format!("run-{worker}.txt"));
        let mut fate = Fate::Unreached;
        for program in self
            .programs
            .iter()
            .filter(|program| program.reaches.contains(&number))
        {
            let mut command = program.command();
            command.env("CREPITUS_MUTANT", number.to_string());
            let most = program.takes * TIMEOUT.0 + TIMEOUT.1;
            if run(&mut command, &log, most).map_err(io(&program.path))? != End::Success {
                return Ok(Fate::Noticed(program.name.clone()));
            }
            fate = Fate::Missed;
        }
        Ok(fate)
    }
}

impl Program {
    fn command(&self) -> Command {
        let mut command = Command::new(&self.path);
        command
            .current_dir(&self.folder)
            .args(LONGEST)
            .env(CASES.0, CASES.1)
            .env("PROPTEST_RNG_SEED", "1")
            .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1");
        command
    }
}

fn program(path: &Path, manifest: &Path, name: &str) -> Option<Program> {
    let folder = manifest.parent()?.to_owned();
    let package = folder.file_name()?.to_string_lossy().into_owned();
    Some(Program {
        name: format!("{package}: {name}"),
        path: path.to_owned(),
        folder,
        takes: Duration::ZERO,
        reaches: HashSet::new(),
    })
}

/// The numbers of the mutants that a text switches.
fn numbers(text: &str) -> impl Iterator<Item = u32> {
    text.split(SWITCH)
        .skip(1)
        .filter_map(|rest| rest.split(')').next()?.parse().ok())
}

/// Mutants that earlier runs have noticed, by their name; the rest is tried again, as there
/// may be other tests now.
pub fn known(text: &str) -> HashMap<&str, Fate> {
    text.lines()
        .filter_map(|line| {
            let mut parts = line.split('\t');
            let (name, fate, by) = (parts.next()?, parts.next()?, parts.next()?);
            (fate == "noticed").then(|| (name, Fate::Noticed(by.to_owned())))
        })
        .collect()
}

/// A mutant's line in the file of results, which [`known`] reads.
pub fn line(name: &str, fate: &Fate) -> String {
    let (fate, by) = match fate {
        Fate::Noticed(by) => ("noticed", by.as_str()),
        Fate::Missed => ("missed", ""),
        Fate::Unreached => ("unreached", ""),
    };
    format!("{name}\t{fate}\t{by}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_noticed_is_known_and_the_rest_is_tried_again() {
        let noticed = Fate::Noticed("model: laws".to_owned());
        let text = line("a.rs:1:2: replace + with -", &noticed)
            + &line("b", &Fate::Missed)
            + &line("c", &Fate::Unreached)
            + "half a li";
        assert_eq!(
            known(&text),
            HashMap::from([("a.rs:1:2: replace + with -", noticed)])
        );
    }

    #[test]
    fn an_error_names_the_mutants_before_its_place() {
        let found: Vec<u32> =
            numbers("if crate::mutant::is(12) { a } else if crate::mutant::is(7) { b").collect();
        assert_eq!(found, [12, 7]);
        assert_eq!(numbers("nothing here").count(), 0);
    }
}
