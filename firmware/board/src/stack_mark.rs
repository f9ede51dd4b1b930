//! High-water mark of the stack, which is painted before the tasks start.

use crate::raw::{self, PAINT, STACK};

/// Bytes, and words, that are read at a time: with a reading a tick all of the stack in 0.1 s.
const STEP: u32 = 32;
const WORDS: usize = STEP as usize / size_of::<u32>();

/// Bytes of the stack.
pub const BYTES: u32 = STACK.end - STACK.start;

/// Looks for the lowest word that was ever written, some words at a time, again and again.
pub struct StackMark {
    /// Address at which it reads on.
    next: u32,
    used: u32,
}

impl StackMark {
    /// Paints the stack below the caller's frame.
    pub fn paint() -> Self {
        raw::paint_stack();
        Self {
            next: STACK.start,
            used: 0,
        }
    }

    /// Reads on; from the bottom again once the lowest word is found.
    pub fn advance(&mut self) {
        let words: [u32; WORDS] = raw::stack(self.next);
        let painted = words.iter().take_while(|word| **word == PAINT).count();
        if painted < WORDS || self.next >= STACK.end - STEP {
            // Cannot fail: at most 8.
            let painted = u32::try_from(painted).unwrap_or_default();
            self.used = STACK.end - self.next - 4 * painted;
            self.next = STACK.start;
        } else {
            self.next += STEP;
        }
    }

    /// Most bytes in use, as of the last time the lowest word was found; 0 before.
    pub fn used(&self) -> u32 {
        self.used
    }
}
