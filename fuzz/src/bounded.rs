//! Every target, for a few seconds, on stable: all files of its corpus, and
//! inputs that are nearly one of them. They are the same in every run.

use crate::TARGETS;
use fastrand::Rng;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

/// Changed inputs of one target; three times as many with `CREPITUS_LONG=1`.
const CHANGED: u64 = 3_000;

/// Changed inputs of the whole chain, which takes twenty times as long.
const CHANGED_CHAINS: u64 = 600;

/// The longest of them, in bytes.
const LONGEST: usize = 4096;

/// The folder of the targets. The program of these tests is that of another package.
fn fuzz() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let mut folders = package.map(|folder| folder.join("fuzz"));
    folders
        .find(|fuzz| fuzz.join("corpus").is_dir())
        .expect("the folder of the targets")
}

/// The corpus of a target, in the order of its names.
fn corpus(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = fuzz().join("corpus").join(target);
    let mut files: Vec<_> = fs::read_dir(&folder)
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
        .map(|entry| entry.expect("an entry of the corpus").path())
        .collect();
    files.sort();
    files
        .into_iter()
        .map(|path| {
            let data = fs::read(&path).expect("a file of the corpus");
            (path, data)
        })
        .collect()
}

/// Up to 16 bytes of `length`.
fn stretch(random: &mut Rng, length: usize) -> std::ops::Range<usize> {
    let start = random.usize(..=length);
    start..length.min(start + 1 + random.usize(..16))
}

/// An input that `seed` makes of the corpus.
fn changed(corpus: &[(PathBuf, Vec<u8>)], seed: u64) -> Vec<u8> {
    let mut random = Rng::with_seed(seed);
    let mut data = corpus[random.usize(..corpus.len())].1.clone();
    for _ in 0..=random.usize(..8) {
        let at = random.usize(..=data.len());
        match random.usize(..6) {
            0 => {
                if let Some(byte) = data.get_mut(at) {
                    *byte ^= 1 << random.usize(..8);
                }
            }
            1 => {
                if let Some(byte) = data.get_mut(at) {
                    *byte = [0, 1, 0x7f, 0x80, 0xff, random.u8(..)][random.usize(..6)];
                }
            }
            2 => data.insert(at, random.u8(..)),
            3 => {
                let gone = stretch(&mut random, data.len());
                data.drain(gone);
            }
            4 => {
                let again = stretch(&mut random, data.len());
                let again = data[again].to_vec();
                data.splice(at..at, again);
            }
            _ => {
                let other = &corpus[random.usize(..corpus.len())].1;
                let from = random.usize(..=other.len());
                let cut = other[from..].to_vec();
                data.splice(at.., cut);
            }
        }
    }
    data.truncate(LONGEST);
    data
}

/// Runs a target over everything and names what fails.
fn hold(target: &str) {
    let (_, body) = TARGETS
        .iter()
        .find(|(name, _)| *name == target)
        .expect("a target");
    let corpus = corpus(target);
    assert!(!corpus.is_empty(), "{target} has no corpus");
    let holds = |data: &[u8]| catch_unwind(AssertUnwindSafe(|| body(data))).is_ok();
    let files = corpus
        .iter()
        .filter(|(_, data)| !holds(data))
        .map(|(path, _)| path.display().to_string());
    let mut failed: Vec<_> = files.collect();
    let count = if target == "chain" {
        CHANGED_CHAINS
    } else {
        CHANGED
    };
    let times = if std::env::var_os("CREPITUS_LONG").is_some() {
        3
    } else {
        1
    };
    for seed in 0..times * count {
        let data = changed(&corpus, seed);
        if !holds(&data) {
            failed.push(format!("seed {seed}: {}", data.escape_ascii()));
            break;
        }
    }
    assert!(failed.is_empty(), "{target} fails for {failed:#?}");
}

#[test]
fn every_target_has_its_folder_and_its_fuzz_target() {
    let fuzz = fuzz();
    let manifest = fs::read_to_string(fuzz.join("Cargo.toml")).expect("the manifest");
    for (name, _) in TARGETS {
        assert!(fuzz.join("corpus").join(name).is_dir(), "{name}");
        assert!(fuzz.join(format!("fuzz_targets/{name}.rs")).is_file());
        assert!(manifest.contains(&format!("name = \"{name}\"")), "{name}");
    }
}

#[test]
fn no_input_breaks_the_laws_of_the_whole_chain() {
    hold("chain");
}

#[test]
fn no_input_breaks_the_laws_of_comms() {
    hold("comms");
}

#[test]
fn no_input_breaks_the_laws_of_the_drive() {
    hold("drive");
}

#[test]
fn no_bytes_confuse_the_decoder_of_frames() {
    hold("frames");
}

#[test]
fn no_counts_confuse_the_encoder() {
    hold("encoder");
}

#[test]
fn no_sample_poisons_a_guarded_joint() {
    hold("guarded");
}

#[test]
fn no_file_upsets_the_readers_of_recordings() {
    hold("recording");
}

#[test]
fn no_change_of_parameters_breaks_the_renderer() {
    hold("renderer");
}

#[test]
fn no_text_upsets_the_reader_of_scenes() {
    hold("scene");
}

#[test]
fn no_motion_breaks_a_step() {
    hold("step");
}

#[test]
fn no_commit_and_no_gap_lets_a_symptom_push() {
    hold("symptoms");
}
