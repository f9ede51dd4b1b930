//! The random number generator: after each reset of the chip other numbers, and the same ones in
//! each run. The library's begins again with its seed, so no program could prove that two starts
//! differ.

use crate::chip::part::{Peripheral, lock, registers};
use rsemu::core::device::Device as _;
use rsemu::core::space::{AccessConstraints, MemAttrs, MemOps, MemResult};
use rsemu::dev::stm32::rng::{Fault, Rng};
use std::fmt;
use std::sync::{Arc, Mutex};

/// Clocks of 48 MHz that a word takes.
const CLOCKS: u64 = 40;

struct State {
    rng: Arc<Rng>,
    registers: Arc<dyn MemOps>,
    /// Seed of its numbers: the number of the chip's start.
    seed: u64,
    /// Last tick of its clock, which a reset does not turn back.
    tick: u64,
}

impl State {
    fn new(seed: u64, tick: u64) -> Self {
        let rng = Arc::new(Rng::build(seed, CLOCKS, false, Fault::None));
        rng.advance_to(tick);
        Self {
            registers: registers(&*rng),
            rng,
            seed,
            tick,
        }
    }
}

/// The generator. Its interrupt is not wired.
pub(crate) struct Random(Mutex<State>);

impl Random {
    pub(crate) fn new() -> Self {
        Self(Mutex::new(State::new(0, 0)))
    }

    fn registers(&self) -> Arc<dyn MemOps> {
        lock(&self.0).registers.clone()
    }
}

impl Peripheral for Random {
    fn advance_to(&self, tick: u64) {
        let mut state = lock(&self.0);
        state.tick = tick;
        state.rng.advance_to(tick);
    }

    fn next_event(&self) -> Option<u64> {
        lock(&self.0).rng.next_event_tick()
    }

    fn reset(&self) {
        let mut state = lock(&self.0);
        *state = State::new(state.seed + 1, state.tick);
    }
}

impl fmt::Debug for Random {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("random number generator")
    }
}

impl MemOps for Random {
    fn read(&self, offset: u64, into: &mut [u8], attrs: MemAttrs) -> MemResult {
        self.registers().read(offset, into, attrs)
    }

    fn write(&self, offset: u64, from: &[u8], attrs: MemAttrs) -> MemResult {
        self.registers().write(offset, from, attrs)
    }

    fn constraints(&self) -> AccessConstraints {
        self.registers().constraints()
    }
}
