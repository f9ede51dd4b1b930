//! The solver ladder on the emulated core: outputs to the bit, and cycles and
//! instructions of every step.
//!
//! ```text
//! plan, inputs ──poke──> exchange ──> firmware/ladder ──peek──> outputs
//!                                          │ every instruction
//!                                          └──> calls of the step function
//! ```
//!
//! A call is counted from the first instruction of the function to the one that
//! returns from it, with all that it calls. The branch to it and the copying
//! of inputs and outputs are excluded.

mod calls;
mod native;

pub use calls::Calls;
pub use native::native;

use crate::Image;
use crate::mcu::Watch;
use crate::stm32f405::Stm32f405;
use crate::time::Time;
use crepitus_ladder::exchange::{
    ADDRESS, BEGIN, COMMAND, ENTRY, Input, MOST_STEPS, Output, PLAN, READY, RUN, STATE, STEP_WORDS,
    STEPS,
};
use crepitus_ladder::{Call, Plan};

/// Timeout of a command, in time of the core's 16 MHz.
const TIMEOUT: Time = Time::from_us(60_000_000);

/// Interval between two polls of the command.
const POLL_INTERVAL: Time = Time::from_us(200);

/// Reason why there is no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LadderError {
    /// The program refuses the plan.
    #[error("the program on the target refuses the plan")]
    Refused,
    /// The program timed out.
    #[error("the program on the target does not answer: the core is at {pc:#x}")]
    NoAnswer {
        /// Program counter of the core.
        pc: u32,
    },
    /// A step gives other bits than on the host.
    #[error(
        "step {step} of {subject} gives {target:08x?} on the target and {host:08x?} on the host"
    )]
    Differs {
        /// The subject.
        subject: &'static str,
        /// Index of the step.
        step: usize,
        /// The target's output.
        target: Output,
        /// The host's output.
        host: Output,
    },
    /// The program has used a feature that is not modelled.
    #[error("the program on the target uses features that are not modelled: {0}")]
    NotModelled(String),
}

/// Results of the steps of a plan.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Run {
    /// Output of each step.
    pub outputs: Vec<Output>,
    /// Cost of each step.
    pub calls: Vec<Call>,
    /// Address of the step function.
    pub entry: u32,
}

/// A core with the program.
pub struct Ladder {
    mcu: Stm32f405,
}

impl Ladder {
    /// A core with the image of [`Program::Ladder`](crate::firmware::Program::Ladder).
    pub fn new(image: &Image) -> Self {
        let mut mcu = Stm32f405::new(image);
        mcu.poke(at(COMMAND), 0);
        Self { mcu }
    }

    /// Runs a plan over its inputs; `plan.steps` is ignored.
    ///
    /// # Errors
    /// [`LadderError`].
    pub fn run(&mut self, plan: &Plan, inputs: &[Input]) -> Result<Run, LadderError> {
        let mut run = Run {
            entry: self.begin(plan)?,
            ..Run::default()
        };
        let mut calls = Calls::new(run.entry);
        for part in inputs.chunks(MOST_STEPS) {
            let steps = u32::try_from(part.len()).unwrap_or(u32::MAX);
            self.poke(PLAN, &Plan { steps, ..*plan }.encode());
            for (n, input) in part.iter().enumerate() {
                self.poke(STEPS + STEP_WORDS * n, &input.encode());
            }
            self.command(RUN, Some(&mut calls))?;
            let outputs = (0..part.len()).map(|n| self.output(n));
            run.outputs.extend(outputs);
        }
        run.calls = calls.finish();
        match self.mcu.not_modelled().as_slice() {
            [] => Ok(run),
            used => Err(LadderError::NotModelled(used.join(", "))),
        }
    }

    /// Runs as [`Self::run`] does, and compares every output with the host's. A friction law
    /// that diverges has to do so on both; the sign of a NaN is that of the core.
    ///
    /// # Errors
    /// [`LadderError`]; [`LadderError::Differs`] at the first other bit.
    pub fn run_and_compare(&mut self, plan: &Plan, inputs: &[Input]) -> Result<Run, LadderError> {
        let run = self.run(plan, inputs)?;
        let host = native(plan, inputs)?;
        let pairs = run.outputs.iter().zip(&host);
        let is_law = plan.subject.law().is_some();
        let differs = |(target, host): (&Output, &Output)| {
            target != host && !(is_law && diverged(target) && diverged(host))
        };
        match pairs.enumerate().find(|(_, pair)| differs(*pair)) {
            None => Ok(run),
            Some((step, (target, host))) => Err(LadderError::Differs {
                subject: plan.subject.name(),
                step,
                target: *target,
                host: *host,
            }),
        }
    }

    /// Sets the subject up; returns the address of its step function.
    fn begin(&mut self, plan: &Plan) -> Result<u32, LadderError> {
        self.poke(PLAN, &plan.encode());
        self.command(BEGIN, None)?;
        if self.peek(STATE) == READY {
            Ok(self.peek(ENTRY))
        } else {
            Err(LadderError::Refused)
        }
    }

    /// Gives a command, and waits until it is done.
    fn command(&mut self, command: u32, calls: Option<&mut Calls>) -> Result<(), LadderError> {
        self.poke(COMMAND, &[command]);
        let end = self.mcu.now() + TIMEOUT;
        let mut watch = calls.map(|calls| calls as &mut dyn Watch);
        while self.peek(COMMAND) != 0 {
            if self.mcu.now() > end || self.mcu.is_locked_up() {
                let pc = self.mcu.program_counter();
                return Err(LadderError::NoAnswer { pc });
            }
            let until = self.mcu.now() + POLL_INTERVAL;
            match &mut watch {
                Some(watch) => self.mcu.watch_until(until, &mut **watch),
                None => self.mcu.run_until(until),
            }
        }
        Ok(())
    }

    fn output(&self, n: usize) -> Output {
        let first = STEPS + STEP_WORDS * n;
        [first, first + 1, first + 2].map(|word| self.peek(word))
    }

    fn peek(&self, word: usize) -> u32 {
        self.mcu.peek(at(word)).unwrap_or(0)
    }

    fn poke(&mut self, first: usize, words: &[u32]) {
        for (word, value) in (first..).zip(words) {
            self.mcu.poke(at(word), *value);
        }
    }
}

/// The address of a word of the exchange.
fn at(word: usize) -> u32 {
    ADDRESS + 4 * u32::try_from(word).unwrap_or(u32::MAX / 8)
}

/// Returns whether the torque of a law is a NaN.
fn diverged([torque, ..]: &Output) -> bool {
    f32::from_bits(*torque).is_nan()
}
