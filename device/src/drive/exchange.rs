//! The exchange between the three tasks of a tick, without a lock.
//!
//! ```text
//! sample_encoder (5)     render_torque (3)                                command_motor (4)
//!   count ─────────────>   Rendered ──> the slot that is not the newest ──> the newest slot
//!                          tick, block, armed <──────────────────────────── after its tick
//! ```
//!
//! `command_motor` interrupts `render_torque`, never the other way round, so a
//! result is either whole or not yet the newest. All run on one core, where
//! the order of the program is the order of memory: a fence for the compiler is
//! enough.
//!
//! A commit passes through, too: `idle` stores the two halves of a plan,
//! `render_torque` applies its half after the last tick of a block, `command_motor`
//! applies the other in the tick that follows, the first of the next block.

use core::sync::atomic::Ordering::Relaxed;
use core::sync::atomic::{
    AtomicBool, AtomicI32, AtomicU8, AtomicU32, AtomicUsize, Ordering, compiler_fence,
};
use crepitus_model::render::effects::Phases;
use crepitus_protocol::telemetry::SampleFlags;

/// The result of a tick of `render_torque`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rendered {
    /// Number of the tick, its lowest 32 bits.
    pub tick: u32,
    /// The encoder's last plausible count; wraps.
    pub count: i32,
    /// Estimated velocity, rad/s.
    pub omega_rad_s: f32,
    /// Consecutive ticks without a plausible count, this one included.
    pub lost_ticks: u32,
    /// Torque setpoint of the motor, N·m.
    pub torque_nm: f32,
    /// The model's torque before limits, N·m.
    pub model_torque_nm: f32,
    /// Voltage at the coil of the vibration actuator, V.
    pub coil_v: f32,
    /// Sample flags, without those of the motor.
    pub flags: SampleFlags,
    /// Phases of the effects.
    pub phases: Phases,
}

/// Words of a [`Rendered`].
const WORDS: usize = 8;

impl Rendered {
    fn words(&self) -> [u32; WORDS] {
        [
            self.tick,
            self.count.cast_unsigned(),
            self.omega_rad_s.to_bits(),
            self.lost_ticks,
            self.torque_nm.to_bits(),
            self.model_torque_nm.to_bits(),
            self.coil_v.to_bits(),
            u32::from(self.phases.0) << 16 | u32::from(self.flags.0),
        ]
    }

    fn of(words: [u32; WORDS]) -> Self {
        let [
            tick,
            count,
            omega,
            lost_ticks,
            torque,
            model_torque,
            coil,
            last,
        ] = words;
        let [f0, f1, p0, p1] = last.to_le_bytes();
        Self {
            tick,
            count: count.cast_signed(),
            omega_rad_s: f32::from_bits(omega),
            lost_ticks,
            torque_nm: f32::from_bits(torque),
            model_torque_nm: f32::from_bits(model_torque),
            coil_v: f32::from_bits(coil),
            flags: SampleFlags(u16::from_le_bytes([f0, f1])),
            phases: Phases(u16::from_le_bytes([p0, p1])),
        }
    }
}

/// Inputs of `render_torque` from `command_motor`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Turn {
    /// Number of the tick, its lowest 32 bits.
    pub tick: u32,
    /// The tick ends a block of telemetry: after it is the time to apply parameters.
    pub ends_block: bool,
    /// Torque is applied.
    pub is_armed: bool,
    /// The count of the angle's zero.
    pub zero: i32,
}

/// Value of `newest` before the first result.
const NONE: usize = 2;

/// There is no plan, or both tasks have applied it.
const NO_PLAN: u8 = 0;
/// Both halves are stored.
const STORED: u8 = 1;
/// `render_torque` has applied its half.
const HALF_APPLIED: u8 = 2;

/// The exchange of the three tasks.
#[derive(Debug)]
pub struct Exchange {
    counter: AtomicU32,
    slots: [[AtomicU32; WORDS]; 2],
    /// The slot of the newest result.
    newest: AtomicUsize,
    tick: AtomicU32,
    ends_block: AtomicBool,
    is_armed: AtomicBool,
    zero: AtomicI32,
    plan: AtomicU8,
    is_settling: AtomicBool,
}

impl Exchange {
    /// No result yet; the first tick has this number.
    #[expect(clippy::cast_possible_truncation, reason = "the lowest bits")]
    pub const fn new(tick: u64) -> Self {
        Self {
            counter: AtomicU32::new(0),
            slots: [const { [const { AtomicU32::new(0) }; WORDS] }; 2],
            newest: AtomicUsize::new(NONE),
            tick: AtomicU32::new(tick as u32),
            ends_block: AtomicBool::new(false),
            is_armed: AtomicBool::new(false),
            zero: AtomicI32::new(0),
            plan: AtomicU8::new(NO_PLAN),
            is_settling: AtomicBool::new(false),
        }
    }

    /// `sample_encoder`: stores the encoder's counter as the tick begins.
    pub fn sample(&self, counter: u32) {
        self.counter.store(counter, Relaxed);
    }

    /// `render_torque`: the counter as the tick began.
    pub fn counter(&self) -> u32 {
        self.counter.load(Relaxed)
    }

    /// `render_torque`: shows a result.
    pub fn show(&self, rendered: &Rendered) {
        let place = usize::from(self.newest.load(Relaxed) == 0);
        if let Some(slot) = self.slots.get(place) {
            for (word, value) in slot.iter().zip(rendered.words()) {
                word.store(value, Relaxed);
            }
            compiler_fence(Ordering::Release);
            self.newest.store(place, Relaxed);
        }
    }

    /// `command_motor`: the newest result.
    pub fn rendered(&self) -> Option<Rendered> {
        let slot = self.slots.get(self.newest.load(Relaxed))?;
        compiler_fence(Ordering::Acquire);
        Some(Rendered::of(slot.each_ref().map(|word| word.load(Relaxed))))
    }

    /// `command_motor`: announces the next tick.
    pub fn announce(&self, turn: Turn) {
        self.tick.store(turn.tick, Relaxed);
        self.ends_block.store(turn.ends_block, Relaxed);
        self.is_armed.store(turn.is_armed, Relaxed);
        self.zero.store(turn.zero, Relaxed);
    }

    /// `render_torque`: the tick that begins.
    pub fn turn(&self) -> Turn {
        Turn {
            tick: self.tick.load(Relaxed),
            ends_block: self.ends_block.load(Relaxed),
            is_armed: self.is_armed.load(Relaxed),
            zero: self.zero.load(Relaxed),
        }
    }

    /// `render_torque`: reports a ramp of parameters in progress.
    pub fn set_settling(&self, is_settling: bool) {
        self.is_settling.store(is_settling, Relaxed);
    }
}

/// A commit on its way.
impl Exchange {
    /// True while the last plan is on its way or settling: the next one waits.
    pub fn is_busy(&self) -> bool {
        self.has_plan() || self.is_settling.load(Relaxed)
    }

    /// True while a plan is on its way.
    pub fn has_plan(&self) -> bool {
        self.plan.load(Relaxed) != NO_PLAN
    }

    /// `idle`: both halves are stored.
    pub fn plan_stored(&self) {
        compiler_fence(Ordering::Release);
        self.plan.store(STORED, Relaxed);
    }

    /// `render_torque`: true if its half is due.
    pub fn render_takes_plan(&self) -> bool {
        self.ends_block.load(Relaxed) && self.plan.load(Relaxed) == STORED
    }

    /// `render_torque`: its half is applied.
    pub fn render_took_plan(&self) {
        self.plan.store(HALF_APPLIED, Relaxed);
    }

    /// `command_motor`: true if its half is due. Not in the tick in which the other
    /// was applied, which belongs to the block before.
    pub fn command_takes_plan(&self, begins_block: bool) -> bool {
        begins_block && self.plan.load(Relaxed) == HALF_APPLIED
    }

    /// `command_motor`: its half is applied.
    pub fn command_took_plan(&self) {
        self.plan.store(NO_PLAN, Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rendered(n: u32) -> Rendered {
        Rendered {
            tick: n,
            count: -1,
            omega_rad_s: -0.0,
            lost_ticks: 3,
            torque_nm: f32::MIN_POSITIVE,
            model_torque_nm: 2.0,
            coil_v: -4.5,
            flags: SampleFlags(0xfedc),
            phases: Phases(0x8123),
        }
    }

    #[test]
    fn the_newest_result_arrives_whole() {
        let exchange = Exchange::new(0);
        assert_eq!(exchange.rendered(), None);
        for n in 0..5 {
            exchange.show(&rendered(n));
            assert_eq!(exchange.rendered(), Some(rendered(n)));
            assert_eq!(exchange.rendered(), Some(rendered(n)));
        }
    }

    /// `command_motor` may come at any point of `show`: it sees the result of
    /// before until the new one is whole.
    #[test]
    fn a_result_that_is_being_written_is_not_seen() {
        let exchange = Exchange::new(0);
        exchange.show(&rendered(1));
        exchange.show(&rendered(2));
        let next = usize::from(exchange.newest.load(Relaxed) == 0);
        for (word, value) in exchange.slots[next].iter().zip(rendered(3).words()) {
            word.store(value, Relaxed);
            assert_eq!(exchange.rendered(), Some(rendered(2)));
        }
    }

    /// The next result is written where `command_motor` does not read.
    #[test]
    fn the_result_before_stays_whole_while_the_next_is_shown() {
        let exchange = Exchange::new(0);
        for n in 0..5 {
            exchange.show(&rendered(n));
            let shown = exchange.newest.load(Relaxed);
            exchange.show(&rendered(n + 1));
            let before = exchange.slots[shown].each_ref().map(|w| w.load(Relaxed));
            assert_eq!(Rendered::of(before), rendered(n));
        }
    }

    #[test]
    fn a_plan_is_applied_by_both_between_two_blocks() {
        let exchange = Exchange::new(7);
        let next = |ends_block| {
            exchange.announce(Turn {
                ends_block,
                ..Turn::default()
            });
        };
        assert!(!exchange.is_busy());
        next(false);
        exchange.plan_stored();
        assert!(exchange.is_busy() && !exchange.render_takes_plan());
        next(true);
        assert!(exchange.render_takes_plan() && !exchange.command_takes_plan(true));
        exchange.render_took_plan();
        assert!(!exchange.render_takes_plan() && !exchange.command_takes_plan(false));
        assert!(exchange.command_takes_plan(true));
        exchange.set_settling(true);
        exchange.command_took_plan();
        assert!(!exchange.has_plan() && exchange.is_busy());
    }
}
