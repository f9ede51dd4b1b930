//! Telemetry: the drive's samples, in blocks.
//!
//! A block holds 20 ticks, one millisecond: first the samples, then the phases of
//! the device's effects in the same ticks. Both are of fixed width:
//!
//! ```text
//! block  = head ‖ 4 currents of the coil ‖ 20 samples ‖ 20 phases of effects
//! sample = count i32 ‖ model torque f32 ‖ torque f32 ‖ current i16 ‖ flags u16     16 bytes, little endian
//! phases = u16                                                                      2 bytes, little endian
//! coil   = i16, the mean of 5 ticks in mA                                           2 bytes, little endian
//!
//! flags    15 14 13    12     11     10     9       8 7 6 5   4          3      2         1 0
//!          held back   chirp  late   stick  break   limited   energised  lost   settling  phase
//! ```
//!
//! Angles and speeds follow from the counts: an encoder's count is
//! 2π/(4·lines·gear ratio) of the joint.
//!
//! **Accounting.** `dropped` counts the samples that were not sent so far, at
//! any stage and for any reason, also because nobody had subscribed; it begins at
//! 0 with the drive's first block after a restart. A subscription's answer has its
//! value at the subscription's first tick. So at any point of the chain, for every
//! block of a subscription,
//!
//! ```text
//! first_tick + 20 − first tick of the subscription = samples received so far + (dropped − dropped before it)
//! ```

use crate::revision::Revision;
use crate::state::{LimitReason, State};
use crepitus_model::render::effects::Phases;
use postcard::experimental::max_size::MaxSize;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Samples of a block.
pub const BLOCK_SAMPLES: usize = 20;

/// Ticks of a block, as `u32`.
pub const BLOCK_TICKS: u32 = 20;

/// Bytes of a sample.
pub const SAMPLE_BYTES: usize = 16;

/// Bytes of the phases of the effects in a tick.
pub const EFFECT_PHASES_BYTES: usize = 2;

/// Currents of the vibration actuator's coil in a block.
pub const COIL_CURRENTS: usize = 4;

/// Ticks of each.
pub const COIL_TICKS: usize = BLOCK_SAMPLES / COIL_CURRENTS;
const _: () = assert!(COIL_CURRENTS * COIL_TICKS == BLOCK_SAMPLES);

/// Bytes of a block's currents of the coil.
pub const COIL_BYTES: usize = COIL_CURRENTS * 2;

/// Bytes of a block's ticks.
pub const TICKS_BYTES: usize = BLOCK_SAMPLES * (SAMPLE_BYTES + EFFECT_PHASES_BYTES) + COIL_BYTES;

/// One tick of the drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Sample {
    /// Encoder count; wraps.
    #[serde(with = "postcard::fixint::le")]
    pub count: i32,
    /// Torque of the model before guard, limits and compensation, N·m: T > 0
    /// opposes growing angle.
    pub model_torque_nm: f32,
    /// Torque setpoint of the motor, N·m.
    pub torque_nm: f32,
    /// Measured current of the motor, mA; positive drives towards growing
    /// angle. −32768: no measurement.
    #[serde(with = "postcard::fixint::le")]
    pub current_ma: i16,
    /// Flags.
    pub flags: SampleFlags,
}

impl Sample {
    /// Encodes the sample as postcard would.
    #[inline]
    pub fn bytes(&self) -> [u8; SAMPLE_BYTES] {
        let [c0, c1, c2, c3] = self.count.to_le_bytes();
        let [m0, m1, m2, m3] = self.model_torque_nm.to_le_bytes();
        let [t0, t1, t2, t3] = self.torque_nm.to_le_bytes();
        let [a0, a1] = self.current_ma.to_le_bytes();
        let [f0, f1] = self.flags.0.to_le_bytes();
        [
            c0, c1, c2, c3, m0, m1, m2, m3, t0, t1, t2, t3, a0, a1, f0, f1,
        ]
    }
}

/// Value of `current_ma` without a measurement.
pub const NO_CURRENT: i16 = i16::MIN;

/// Mean current of the vibration actuator's coil over [`COIL_TICKS`] ticks, mA;
/// positive pushes the shell towards growing angle. −32768 while it is not driven, and
/// without a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema)]
pub struct CoilCurrent(#[serde(with = "postcard::fixint::le")] pub i16);

impl Default for CoilCurrent {
    fn default() -> Self {
        Self::NONE
    }
}

impl CoilCurrent {
    /// None was measured.
    pub const NONE: Self = Self(NO_CURRENT);

    /// Returns the current, A; `None` if none was measured.
    pub fn amperes(self) -> Option<f32> {
        (self != Self::NONE).then(|| f32::from(self.0) * 1e-3)
    }
}

/// Per-sample flags, 16 bits.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema,
)]
pub struct SampleFlags(#[serde(with = "postcard::fixint::le")] pub u16);

impl SampleFlags {
    /// Phase: 0 stick, 1 slip towards growing angle, 2 towards falling.
    pub const PHASE: u16 = 0b11;
    /// Parameters are ramping to those of the last commit.
    pub const SETTLING: u16 = 1 << 2;
    /// The encoder's count was implausible.
    pub const LOST: u16 = 1 << 3;
    /// The motor is driven with the torque of the sample. Not while arming pushes,
    /// and not in a tick in which the bridge floats: without a measured current, or
    /// without the enable line of comms.
    pub const ENERGISED: u16 = 1 << 4;
    /// Lowest bit of the [`LimitReason`].
    pub const LIMIT_SHIFT: u32 = 5;
    /// A stick broke in this tick.
    pub const BREAK: u16 = 1 << 9;
    /// A slip ended in this tick.
    pub const STICK: u16 = 1 << 10;
    /// Rendering was late: the torque is that of the previous tick.
    pub const LATE: u16 = 1 << 11;
    /// The coil of the vibration actuator plays a chirp; the first such tick is its first.
    pub const CHIRP: u16 = 1 << 12;
    /// The [share](Self::held_back) that the energy tank holds back.
    pub const HELD_BACK: u16 = 0b111 << Self::HELD_BACK_SHIFT;
    /// Lowest bit of that share.
    pub const HELD_BACK_SHIFT: u32 = 13;

    /// Returns the flags with these bits set or cleared.
    #[must_use]
    pub fn with(self, bits: u16, set: bool) -> Self {
        Self(if set { self.0 | bits } else { self.0 & !bits })
    }

    /// Returns whether one of these bits is set.
    pub fn has(self, bits: u16) -> bool {
        self.0 & bits != 0
    }

    /// Returns the flags with the phase of this sign: 0, +1, −1.
    #[must_use]
    pub fn with_phase(self, sign: i8) -> Self {
        let number = match sign {
            0 => 0,
            1.. => 1,
            _ => 2,
        };
        Self(self.0 & !Self::PHASE | number)
    }

    /// The phase's sign: 0 in stick, +1 or −1 in a slip.
    pub fn phase_sign(self) -> i8 {
        match self.0 & Self::PHASE {
            1 => 1,
            2 => -1,
            _ => 0,
        }
    }

    /// Returns the flags with this reason.
    #[must_use]
    pub fn with_limit(self, reason: LimitReason) -> Self {
        let place = 0b1111 << Self::LIMIT_SHIFT;
        Self(self.0 & !place | reason.number() << Self::LIMIT_SHIFT)
    }

    /// Returns the flags with this share, 0 to 1, of the torque of clonus and of a reflex that the
    /// energy tank holds back. It is rounded up to eighths, and 7 stands for all above 6/8.
    #[inline]
    #[must_use]
    pub fn with_held_back(self, share: f32) -> Self {
        if share > 0.0 {
            self.with_eighths(share)
        } else {
            Self(self.0 & !Self::HELD_BACK)
        }
    }

    #[cold]
    fn with_eighths(self, share: f32) -> Self {
        let eighths = share * 8.0;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share; saturates"
        )]
        let whole = eighths as u16;
        let number = whole
            .saturating_add(u16::from(f32::from(whole) < eighths))
            .min(7);
        Self(self.0 & !Self::HELD_BACK | number << Self::HELD_BACK_SHIFT)
    }

    /// Eighths of the torque of clonus and of a reflex that the energy tank holds back, rounded
    /// up; 7 for more than six.
    pub fn held_back(self) -> u16 {
        self.0 >> Self::HELD_BACK_SHIFT
    }

    /// Reason why the torque differs from the model's.
    pub fn limit(self) -> LimitReason {
        let number = self.0 >> Self::LIMIT_SHIFT & 0b1111;
        LimitReason::ALL
            .into_iter()
            .find(|reason| reason.number() == number)
            .unwrap_or_default()
    }
}

/// Phases of the device's effects in a tick, 16 bits: in the order of the effects, the
/// first lowest, each in as many bits as its phases need.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema,
)]
pub struct EffectPhases(#[serde(with = "postcard::fixint::le")] pub u16);

const _: () = assert!(u16::BITS.checked_sub(Phases::BITS).is_some());

impl EffectPhases {
    /// Encodes them as postcard would.
    #[inline]
    pub fn bytes(self) -> [u8; EFFECT_PHASES_BYTES] {
        self.0.to_le_bytes()
    }
}

impl From<Phases> for EffectPhases {
    fn from(Phases(bits): Phases) -> Self {
        Self(bits)
    }
}

impl From<EffectPhases> for Phases {
    fn from(EffectPhases(bits): EffectPhases) -> Self {
        Self(bits)
    }
}

/// Per-block flags, 8 bits.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, MaxSize, Schema,
)]
pub struct BlockFlags(pub u8);

impl BlockFlags {
    /// The angle's zero was set.
    pub const ZEROED: u8 = 1 << 2;
    /// Lowest bit of the drive's boot counter.
    pub const START_SHIFT: u32 = 3;

    /// Flags of this state and the lowest bits of the drive's boot counter.
    pub fn new(state: State, zeroed: bool, start: u16) -> Self {
        let [low, _] = start.to_le_bytes();
        let zeroed = if zeroed { Self::ZEROED } else { 0 };
        Self(state.number() | zeroed | low << Self::START_SHIFT)
    }

    /// The lowest five bits of the drive's boot counter; ticks restart when it
    /// changes.
    pub fn start(self) -> u8 {
        self.0 >> Self::START_SHIFT
    }

    /// The drive's state at the end of the block.
    pub fn state(self) -> State {
        State::ALL
            .into_iter()
            .find(|state| state.number() == self.0 & 0b11)
            .unwrap_or_default()
    }

    /// Returns whether counts are relative to a zero that was set.
    pub fn is_zeroed(self) -> bool {
        self.0 & Self::ZEROED != 0
    }
}

/// Block of twenty samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, MaxSize, Schema)]
pub struct Block {
    /// Sequence number of the block; wraps.
    pub sequence: u16,
    /// Tick of the first sample, counted from the drive's boot.
    pub first_tick: u64,
    /// Revision of the parameters active throughout the block.
    pub revision: Revision,
    /// Samples that were not sent so far; wraps.
    pub dropped: u32,
    /// Flags.
    pub flags: BlockFlags,
    /// Currents of the vibration actuator's coil.
    pub coil_currents: [CoilCurrent; COIL_CURRENTS],
    /// The samples.
    pub samples: [Sample; BLOCK_SAMPLES],
    /// Phases of the device's effects, in the ticks of the samples.
    pub phases: [EffectPhases; BLOCK_SAMPLES],
}

/// The fields of a block before its samples.
pub type BlockHead = (
    u16,
    u64,
    Revision,
    u32,
    (BlockFlags, [CoilCurrent; COIL_CURRENTS]),
);

impl Block {
    /// Bytes of [`Self::head`], at most.
    pub const HEAD_BYTES: usize = BlockHead::POSTCARD_MAX_SIZE;

    /// The fields before the samples, for an incremental encoder.
    pub fn head(&self) -> BlockHead {
        (
            self.sequence,
            self.first_tick,
            self.revision,
            self.dropped,
            (self.flags, self.coil_currents),
        )
    }

    /// The ticks: number, sample, phases of the effects.
    pub fn ticks(&self) -> impl Iterator<Item = (u64, &Sample, Phases)> {
        (0..)
            .zip(self.samples.iter().zip(&self.phases))
            .map(|(n, (sample, phases))| {
                (self.first_tick.wrapping_add(n), sample, (*phases).into())
            })
    }

    /// Tick after the last sample.
    pub fn end_tick(&self) -> u64 {
        self.first_tick.saturating_add(BLOCK_SAMPLES as u64)
    }
}

#[cfg(test)]
mod tests;
