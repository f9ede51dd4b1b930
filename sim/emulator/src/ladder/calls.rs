//! The calls of one function among all instructions of a run.

use crate::mcu::{Step, Watch};
use crepitus_ladder::Call;

/// Finds the calls of a function.
#[derive(Clone, Debug)]
pub struct Calls {
    entry: u32,
    last_pc: u32,
    current: Option<(Call, u32)>,
    done: Vec<Call>,
}

impl Calls {
    /// Calls of the function at `entry`.
    pub fn new(entry: u32) -> Self {
        Self {
            entry,
            last_pc: 0,
            current: None,
            done: Vec::new(),
        }
    }

    /// Records an executed instruction and its cycles.
    pub fn instruction(&mut self, pc: u32, cycles: u32) {
        /// Length of `blx` with a register, which is how an unknown function is
        /// called.
        const CALL_BYTES: u32 = 2;
        if let Some((call, back)) = &mut self.current {
            if pc != *back {
                call.add(pc, cycles);
                return;
            }
            self.done.push(*call);
            self.current = None;
        } else if pc == self.entry {
            let mut call = Call::default();
            call.add(pc, cycles);
            self.current = Some((call, self.last_pc + CALL_BYTES));
        }
        self.last_pc = pc;
    }

    /// Calls that have ended so far.
    pub fn count(&self) -> usize {
        self.done.len()
    }

    /// All calls that have ended.
    pub fn finish(self) -> Vec<Call> {
        self.done
    }
}

impl Watch for Calls {
    fn step(&mut self, step: &Step) {
        self.instruction(step.pc, step.cycles);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_is_from_entry_to_return_with_all_that_it_calls() {
        let mut calls = Calls::new(0x100);
        for (pc, cycles) in [
            (0x40, 1),
            (0x42, 3),
            // The call, within it another function, and the way back.
            (0x100, 2),
            (0x200, 14),
            (0x102, 5),
            (0x44, 1),
            (0x42, 3),
            (0x100, 7),
            (0x44, 1),
            // Not ended.
            (0x42, 3),
            (0x100, 7),
        ] {
            calls.instruction(pc, cycles);
        }
        let costs: Vec<_> = calls
            .finish()
            .iter()
            .map(|call| (call.cycles, call.instructions))
            .collect();
        assert_eq!(costs, [(21, 3), (7, 1)]);
    }
}
