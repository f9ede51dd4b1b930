//! The block of memory between the program and its emulator.
//!
//! | word | written by | |
//! |---|---|---|
//! | 0 | both | command: [`BEGIN`], [`RUN`], or both; 0 once it is done |
//! | 1 | program | [`IDLE`], [`READY`] or [`REFUSED`] |
//! | 2 | program | address of the function whose calls are the steps |
//! | 3 to 31 | the other | the [`Plan`](crate::Plan) |
//! | 32 on | both | the steps, four words each |
//!
//! A step's words are its input; the program replaces them by its output.
//!
//! | | words of an input | words of an output |
//! |---|---|---|
//! | joints, laws, symptoms | Δφ, Ω at its begin, Ω at its end, [kind](Kind) | torque, [events](crate::measured) of a joint, fraction of the last |
//! | encoder | count, –, –, kind | Δφ, Ω |
//! | friction compensation | Ω | torque |
//! | bone shaping | Δφ, jump of the torque | torque |
//! | current loop | A commanded, A measured | V |

use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::{Acquire, Relaxed, Release};

/// Address of the block on the target: from the 48th kilobyte of RAM on. Below is the
/// stack: a reflex remembers 8 KB, and is moved while it is set up.
pub const ADDRESS: u32 = 0x2000_c000;

/// Words of the block on the target: 80 KB.
pub const WORDS: usize = 20 << 10;

/// Command: read the plan.
pub const BEGIN: u32 = 1;
/// Command: run the steps.
pub const RUN: u32 = 2;

/// State: no plan yet.
pub const IDLE: u32 = 0;
/// State: the plan is accepted.
pub const READY: u32 = 1;
/// State: the plan or its settings are invalid.
pub const REFUSED: u32 = 2;

/// The word of the command.
pub const COMMAND: usize = 0;
/// The word of the state.
pub const STATE: usize = 1;
/// The word of the function's address.
pub const ENTRY: usize = 2;
/// The first word of the plan.
pub const PLAN: usize = 3;
/// The first word of the steps.
pub const STEPS: usize = 32;
/// Words of a step.
pub const STEP_WORDS: usize = 4;

/// The most steps at a time on the target.
pub const MOST_STEPS: usize = (WORDS - STEPS) / STEP_WORDS;

/// Kind of an input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A sample.
    #[default]
    Taken,
    /// A tick without one.
    Lost,
    /// A sample; just before it the other parameters of the plan are committed.
    Commit,
}

/// Input of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Input {
    /// Three numbers, as bits.
    pub words: [u32; 3],
    /// Their kind.
    pub kind: Kind,
}

/// Output of a step, as bits.
pub type Output = [u32; 3];

/// The block.
#[derive(Clone, Copy, Debug)]
pub struct Exchange<'a>(&'a [AtomicU32]);

impl<'a> Exchange<'a> {
    /// An exchange in memory shared by both sides.
    pub fn new(words: &'a [AtomicU32]) -> Self {
        Self(words)
    }

    /// A word; 0 outside the block.
    pub fn get(&self, word: usize) -> u32 {
        self.0.get(word).map_or(0, |word| word.load(Relaxed))
    }

    /// Sets a word within the block.
    pub fn set(&self, word: usize, value: u32) {
        if let Some(word) = self.0.get(word) {
            word.store(value, Relaxed);
        }
    }

    /// Reads the command; acquires all that was written before it.
    pub fn command(&self) -> u32 {
        self.0.first().map_or(0, |word| word.load(Acquire))
    }

    /// Marks the command as done; releases all that was written for it.
    pub fn done(&self) {
        if let Some(word) = self.0.first() {
            word.store(0, Release);
        }
    }

    /// The input of step `n`.
    pub fn input(&self, n: usize) -> Input {
        let at = STEPS + STEP_WORDS * n;
        Input {
            words: [self.get(at), self.get(at + 1), self.get(at + 2)],
            kind: match self.get(at + 3) {
                1 => Kind::Lost,
                2 => Kind::Commit,
                _ => Kind::Taken,
            },
        }
    }

    /// Sets the output of step `n`.
    pub fn set_output(&self, n: usize, output: &Output) {
        let at = STEPS + STEP_WORDS * n;
        for (word, value) in (at..).zip(output) {
            self.set(word, *value);
        }
    }
}

impl Input {
    /// Encodes the input as words of the block.
    pub fn encode(&self) -> [u32; STEP_WORDS] {
        let [a, b, c] = self.words;
        let kind = match self.kind {
            Kind::Taken => 0,
            Kind::Lost => 1,
            Kind::Commit => 2,
        };
        [a, b, c, kind]
    }
}
