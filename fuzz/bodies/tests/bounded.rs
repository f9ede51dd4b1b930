//! Every target, for a few seconds, on stable: all files of its corpus, and
//! inputs that are nearly one of them. They are the same in every run.

use crepitus_fuzz_bodies::TARGETS;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

/// Changed inputs of one target.
const CHANGED: u64 = 10_000;

/// Changed inputs of the whole chain, which takes twenty times as long.
const CHANGED_CHAINS: u64 = 2_000;

/// The longest of them, in bytes.
const LONGEST: usize = 4096;

/// The corpus of a target, in the order of its names.
fn corpus(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../corpus")
        .join(target);
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

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From 0 up to, and without, `end`.
    fn below(&mut self, end: usize) -> usize {
        usize::try_from(self.next() % (end.max(1) as u64)).expect("a small number")
    }

    fn byte(&mut self) -> u8 {
        self.next().to_le_bytes()[0]
    }

    /// Up to 16 bytes of `length`.
    fn stretch(&mut self, length: usize) -> std::ops::Range<usize> {
        let start = self.below(length + 1);
        start..length.min(start + 1 + self.below(16))
    }
}

/// An input that `seed` makes of the corpus.
fn changed(corpus: &[(PathBuf, Vec<u8>)], seed: u64) -> Vec<u8> {
    let mut random = Random(seed);
    let mut data = corpus[random.below(corpus.len())].1.clone();
    for _ in 0..=random.below(8) {
        let at = random.below(data.len() + 1);
        match random.below(6) {
            0 => {
                if let Some(byte) = data.get_mut(at) {
                    *byte ^= 1 << random.below(8);
                }
            }
            1 => {
                if let Some(byte) = data.get_mut(at) {
                    *byte = [0, 1, 0x7f, 0x80, 0xff, random.byte()][random.below(6)];
                }
            }
            2 => data.insert(at, random.byte()),
            3 => {
                let gone = random.stretch(data.len());
                data.drain(gone);
            }
            4 => {
                let again = random.stretch(data.len());
                let again = data[again].to_vec();
                data.splice(at..at, again);
            }
            _ => {
                let other = &corpus[random.below(corpus.len())].1;
                let from = random.below(other.len() + 1);
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
    for seed in 0..count {
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
    let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
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
