//! The ladder's program on the host.

use super::LadderError;
use crepitus_ladder::exchange::{
    BEGIN, COMMAND, Exchange, Input, Output, PLAN, READY, RUN, STATE, STEP_WORDS, STEPS,
};
use crepitus_ladder::{Plan, serve};
use std::sync::atomic::AtomicU32;

/// Outputs of a plan's steps on the host.
///
/// # Errors
/// [`LadderError::Refused`].
pub fn native(plan: &Plan, inputs: &[Input]) -> Result<Vec<Output>, LadderError> {
    let words = STEPS + STEP_WORDS * inputs.len();
    let words: Vec<AtomicU32> = (0..words).map(|_| AtomicU32::new(0)).collect();
    let exchange = Exchange::new(&words);
    let set = |first: usize, values: &[u32]| {
        for (word, value) in (first..).zip(values) {
            exchange.set(word, *value);
        }
    };
    let steps = u32::try_from(inputs.len()).unwrap_or(u32::MAX);
    set(PLAN, &Plan { steps, ..*plan }.encode());
    for (n, input) in inputs.iter().enumerate() {
        set(STEPS + STEP_WORDS * n, &input.encode());
    }
    set(COMMAND, &[BEGIN | RUN]);
    serve(&exchange, &mut || false);
    if exchange.get(STATE) != READY {
        return Err(LadderError::Refused);
    }
    let output = |n| exchange.input(n).words;
    Ok((0..inputs.len()).map(output).collect())
}
