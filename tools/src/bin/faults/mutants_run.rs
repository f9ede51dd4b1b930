//! The mutants of a crate, on all cores.

use crate::Arguments;
use crepitus_tools::faults::mutants::bench::{Bench, Fate, known, line};
use crepitus_tools::faults::mutants::{self, Mutant};
use std::collections::HashMap;
use std::error::Error;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::process::{Command, ExitCode};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The tests that are to notice a crate's mutants, as arguments of `cargo test`: its own,
/// and those of others that compare what it does.
const TESTS: [(&str, &[&str]); 3] = [
    (
        "model",
        &[
            "-p crepitus-model",
            "-p crepitus-scene --lib --test symptom_agreement --test symptom_promises \
             --test symptom_scenes --test reference_cases --test runs",
            "-p crepitus-studies --lib",
            "-p crepitus-device --lib",
            "-p crepitus-client --test fuzz",
        ],
    ),
    (
        "device",
        &[
            "-p crepitus-device --tests",
            "-p crepitus-virtual-device --tests",
        ],
    ),
    (
        "protocol",
        &[
            "-p crepitus-protocol --tests",
            "-p crepitus-device --tests",
            "-p crepitus-virtual-device --test commits --test hosts",
        ],
    ),
];

/// Tries all mutants that no earlier run has noticed, and lists what no test notices.
pub(crate) fn work(arguments: &Arguments, folder: &str) -> Result<ExitCode, Box<dyn Error>> {
    let Some((_, tests)) = TESTS.iter().find(|(name, _)| *name == folder) else {
        let names = TESTS.map(|(name, _)| name).join(", ");
        eprintln!(
            "crepitus-faults: no crate `{folder}` whose mutants can be tried; there are {names}"
        );
        return Ok(ExitCode::from(2));
    };
    let tests = if arguments.tests.is_empty() {
        tests.iter().map(ToString::to_string).collect()
    } else {
        arguments.tests.clone()
    };
    let all = listed(&arguments.root, folder)?;
    let scratch = std::path::absolute(&arguments.scratch)?.join(format!("mutants-{folder}"));
    std::fs::create_dir_all(&scratch)?;
    eprintln!(
        "building with {} mutants: this takes some ten minutes",
        all.len()
    );
    let bench = Bench::open(&arguments.root, &scratch, folder, &all, &tests)?;
    let results = scratch.join("results.tsv");
    let before = std::fs::read_to_string(&results).unwrap_or_default();
    let before = known(&before);
    let file = OpenOptions::new()
        .append(true)
        .create(true)
        .open(&results)?;
    let fates = judge(&bench, &all, &before, &file)?;
    for (number, mutant) in (1..).zip(&all) {
        match fates.get(&number) {
            Some(Fate::Missed) => println!("missed     {}", mutant.name),
            Some(Fate::Unreached) => println!("unreached  {}", mutant.name),
            _ => {}
        }
    }
    let count = |is: fn(&Fate) -> bool| fates.values().filter(|fate| is(fate)).count();
    let noticed = count(|fate| matches!(fate, Fate::Noticed(_)));
    println!(
        "{} mutants, {} of them do not compile and {} cannot be switched; of {} noticed {noticed}, {:.1} %: \
         missed {}, not reached {}",
        all.len(),
        bench.unviable.len(),
        all.len() - bench.unviable.len() - bench.placed.len(),
        fates.len(),
        percent(noticed, fates.len()),
        count(|fate| *fate == Fate::Missed),
        count(|fate| *fate == Fate::Unreached),
    );
    println!("{}", results.display());
    Ok(ExitCode::SUCCESS)
}

/// Mutants that `cargo mutants` would try.
fn listed(root: &Path, folder: &str) -> Result<Vec<Mutant>, Box<dyn Error>> {
    let output = Command::new("cargo-mutants")
        .args(["mutants", "--list", "--json", "-d", folder])
        .current_dir(root)
        .output()
        .map_err(|error| {
            format!("cargo-mutants: {error}; `cargo install cargo-mutants` installs it")
        })?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    Ok(mutants::read(&String::from_utf8(output.stdout)?)?)
}

fn judge(
    bench: &Bench,
    all: &[Mutant],
    before: &HashMap<&str, Fate>,
    file: &File,
) -> Result<HashMap<u32, Fate>, Box<dyn Error>> {
    let numbers: Vec<u32> = bench.placed.iter().copied().collect();
    let (next, fates, file) = (
        AtomicUsize::new(0),
        Mutex::new(HashMap::new()),
        Mutex::new(file),
    );
    let work = |worker: usize| -> Result<(), String> {
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(number) = numbers.get(at) else {
                return Ok(());
            };
            let name = &all[*number as usize - 1].name;
            let fate = if let Some(fate) = before.get(name.as_str()) {
                fate.clone()
            } else {
                let fate = bench
                    .judge(*number, worker)
                    .map_err(|error| error.to_string())?;
                let mut file = file.lock().map_err(|error| error.to_string())?;
                file.write_all(line(name, &fate).as_bytes())
                    .map_err(|error| error.to_string())?;
                fate
            };
            let mut fates = fates.lock().map_err(|error| error.to_string())?;
            fates.insert(*number, fate);
            if fates.len() % 100 == 0 {
                eprintln!("{} of {}", fates.len(), numbers.len());
            }
        }
    };
    let cores = std::thread::available_parallelism()?.get();
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..cores)
            .map(|worker| scope.spawn(move || work(worker)))
            .collect();
        workers
            .into_iter()
            .try_for_each(|worker| worker.join().map_err(|_| "a worker panicked".to_owned())?)
    })?;
    Ok(fates.into_inner()?)
}

#[expect(clippy::cast_precision_loss, reason = "for people")]
fn percent(part: usize, of: usize) -> f64 {
    part as f64 / of.max(1) as f64 * 100.0
}
