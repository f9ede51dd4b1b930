//! Cost of steps.

/// The cost of one call of the step function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Call {
    /// Modelled cycles, 0 wait states.
    pub cycles: u32,
    /// Instructions.
    pub instructions: u32,
    /// Hash of the executed addresses, in order.
    pub path: u64,
}

/// The cost of many calls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Number of calls.
    pub calls: u64,
    /// All cycles.
    pub cycles: u64,
    /// Cycles of the worst call.
    pub worst_cycles: u32,
    /// All instructions.
    pub instructions: u64,
    /// Instructions of the longest call.
    pub worst_instructions: u32,
}

impl Call {
    /// Adds an instruction at `pc` with its cycles.
    pub fn add(&mut self, pc: u32, cycles: u32) {
        const PRIME: u64 = 0x0000_0100_0000_01b3;
        self.cycles += cycles;
        self.instructions += 1;
        self.path = (self.path ^ u64::from(pc)).wrapping_mul(PRIME);
    }
}

impl Cost {
    /// Cost of these calls.
    pub fn of(calls: &[Call]) -> Self {
        let mut cost = Self::default();
        for call in calls {
            cost.add(&Self {
                calls: 1,
                cycles: call.cycles.into(),
                worst_cycles: call.cycles,
                instructions: call.instructions.into(),
                worst_instructions: call.instructions,
            });
        }
        cost
    }

    /// Adds further calls.
    pub fn add(&mut self, other: &Self) {
        self.calls += other.calls;
        self.cycles += other.cycles;
        self.worst_cycles = self.worst_cycles.max(other.worst_cycles);
        self.instructions += other.instructions;
        self.worst_instructions = self.worst_instructions.max(other.worst_instructions);
    }

    /// Mean cycles of a call; NaN without any.
    pub fn mean_cycles(&self) -> f64 {
        mean(self.cycles, self.calls)
    }

    /// Mean instructions of a call; NaN without any.
    pub fn mean_instructions(&self) -> f64 {
        mean(self.instructions, self.calls)
    }
}

#[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
fn mean(sum: u64, count: u64) -> f64 {
    sum as f64 / count as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_add_up_and_the_worst_stays() {
        let calls = [(7, 3), (9, 2), (8, 5)].map(|(cycles, instructions)| Call {
            cycles,
            instructions,
            path: 0,
        });
        let mut cost = Cost::of(&calls[..2]);
        cost.add(&Cost::of(&calls[2..]));
        assert_eq!(cost, Cost::of(&calls));
        assert_eq!((cost.worst_cycles, cost.worst_instructions), (9, 5));
        assert_eq!((cost.mean_cycles(), cost.calls), (8.0, 3));
        assert!(Cost::default().mean_cycles().is_nan());
    }

    #[test]
    fn a_path_is_its_addresses_in_their_order() {
        let path = |addresses: [u32; 2]| {
            let mut call = Call::default();
            for pc in addresses {
                call.add(pc, 1);
            }
            call.path
        };
        assert_ne!(path([2, 4]), path([4, 2]));
        assert_eq!(path([2, 4]), path([2, 4]));
    }
}
