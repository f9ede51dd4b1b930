//! The block of memory between the program and whoever runs it.
//!
//! | word | written by | |
//! |---|---|---|
//! | 0 | both | what to do: [`BEGIN`], [`RUN`], or both; 0 once it is done |
//! | 1 | program | [`IDLE`], [`READY`] or [`REFUSED`] |
//! | 2 | program | address of the function whose calls are the steps |
//! | 3 to 31 | the other | the [`Plan`](crate::Plan) |
//! | 32 on | both | the steps, four words each |
//!
//! A step's words are its input; the program puts its output in their place.
//!
//! | | words of an input | words of an output |
//! |---|---|---|
//! | joints | Δφ, Ω at its begin, Ω at its end, [kind](Kind) | torque, [events](crate::measured), fraction of the last |
//! | encoder | count, –, –, kind | Δφ, Ω |
//! | friction compensation | Ω | torque |
//! | bone shaping | Δφ, jump of the torque | torque |
//! | current loop | A wanted, A measured | V |

use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::{Acquire, Relaxed, Release};

/// Where the block is on the target: from the sixteenth kilobyte of RAM on.
pub const ADDRESS: u32 = 0x2000_4000;

/// Its words on the target: 96 KB.
pub const WORDS: usize = 24 << 10;

/// Command: take the plan.
pub const BEGIN: u32 = 1;
/// Command: make the steps.
pub const RUN: u32 = 2;

/// State: there was no plan yet.
pub const IDLE: u32 = 0;
/// State: the plan stands.
pub const READY: u32 = 1;
/// State: the plan is none, or its settings are not allowed.
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

/// What an input is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A sample.
    #[default]
    Taken,
    /// A tick without one.
    Lost,
    /// A sample; just before it the other numbers of the plan are committed.
    Commit,
}

/// What goes into a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Input {
    /// Three numbers, as bits.
    pub words: [u32; 3],
    /// What they are.
    pub kind: Kind,
}

/// What comes out of it: as bits.
pub type Output = [u32; 3];

/// The block.
#[derive(Clone, Copy, Debug)]
pub struct Exchange<'a>(&'a [AtomicU32]);

impl<'a> Exchange<'a> {
    /// Around memory that both sides see.
    pub fn new(words: &'a [AtomicU32]) -> Self {
        Self(words)
    }

    /// A word; 0 where there is none.
    pub fn get(&self, word: usize) -> u32 {
        self.0.get(word).map_or(0, |word| word.load(Relaxed))
    }

    /// Sets a word, where there is one.
    pub fn set(&self, word: usize, value: u32) {
        if let Some(word) = self.0.get(word) {
            word.store(value, Relaxed);
        }
    }

    /// The command, and all that was written before it.
    pub fn command(&self) -> u32 {
        self.0.first().map_or(0, |word| word.load(Acquire))
    }

    /// The command is done, with all that was written for it.
    pub(crate) fn done(&self) {
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
    pub(crate) fn set_output(&self, n: usize, output: &Output) {
        let at = STEPS + STEP_WORDS * n;
        for (word, value) in (at..).zip(output) {
            self.set(word, *value);
        }
    }
}

impl Input {
    /// As the words of the block.
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
