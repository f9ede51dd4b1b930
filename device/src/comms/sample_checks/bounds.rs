//! Limits of torque, current, speed and range for the checks of samples, computed from parameters.

use super::{CURRENT_SLACK_A, DEVIATING_SAMPLES, DEVIATION_A};
use crate::board::LARGEST_DUTY;
use crate::drive::prepare::held_rad_s_per_volt;
use crepitus_model::Real;
use crepitus_protocol::telemetry::{BLOCK_TICKS, Sample};
use crepitus_protocol::{DeviceSettings, LimitReason, TICK_S};

/// Overspeed threshold as a share of the speed limit: the drive's estimate lags.
const FAST_SHARE: f64 = 1.15;

/// Resistance of a winding over that which is assumed, with a margin for a speed that is a
/// block's mean: 80 K warmer is 1.31, and the drive takes 1.5.
const WARM: f64 = 2.0;

/// A ramp of the joint takes as long as the slew limit for Ts·ln(kr/kr′), and a stiffness may be
/// from 10⁻⁶ to 10⁹ N·m/rad: ln 10¹⁵ is 34.6.
const SOFTEST: f32 = 36.0;

/// Margin for rounding of a torque, N·m.
const ROUNDING_NM: f32 = 1e-3;

/// Bounds that follow from parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Upper bound of the torque of any model of these symptoms, N·m.
    pub(super) model_torque_nm: f32,
    /// Upper bound of the motor's torque, N·m.
    pub(super) torque_nm: f32,
    /// Most torque that friction compensation and bone shaping add to the model's, N·m.
    pub(super) added_nm: f32,
    /// Least by which the slew limit fades that torque in a block, N·m.
    pub(super) fade_nm: f32,
    /// Upper bound of the torque of the joint alone, N·m.
    pub(super) joint_nm: f32,
    /// Counts of the encoder in a block.
    pub(super) counts: f32,
    /// Current for a torque, A/(N·m), and its largest setpoint, A.
    pub(super) amperes_per_nm: f32,
    pub(super) setpoint_a: f32,
    /// Sum of deviations of the current, A times samples.
    pub(super) deviation: f32,
    /// Counts in a block at which the back-EMF is the largest voltage, and counts for
    /// the voltage of an ampere.
    pub(super) emf_counts: f32,
    pub(super) counts_per_ampere: f32,
    /// Ends of the range of motion, counts from the angle's zero.
    pub(super) range: (i32, i32),
}

#[expect(clippy::cast_possible_truncation, reason = "rounded to f32, once")]
fn single(value: f64) -> f32 {
    value as f32
}

impl Bounds {
    /// Bounds that allow nothing.
    pub const NONE: Self = Self {
        model_torque_nm: 0.0,
        torque_nm: 0.0,
        added_nm: 0.0,
        fade_nm: 0.0,
        joint_nm: 0.0,
        counts: 0.0,
        amperes_per_nm: 0.0,
        setpoint_a: 0.0,
        deviation: 0.0,
        emf_counts: f32::INFINITY,
        counts_per_ampere: 0.0,
        range: (i32::MAX, i32::MIN),
    };

    /// Returns the bounds that follow from settings.
    pub fn of(settings: &DeviceSettings) -> Self {
        /// Margin for rounding, a factor.
        const MARGIN: f64 = 1.001;
        let joint = settings.crepitus.as_ref().map(|joint| &joint.parameters);
        let joint_nm = joint.map_or(0.0, |joint| joint.static_torque_nm);
        let most_nm = settings.effects.torque_bound_nm(joint);
        let added_nm = settings.effects.added_bound_nm();
        let block_s = TICK_S * f64::from(BLOCK_TICKS);
        let counts_per_rad_s = block_s / settings.encoder.rad_per_count();
        let motor = &settings.current_loop;
        let held_rad_s = held_rad_s_per_volt(settings) * motor.supply_v;
        let speed_rad_s = settings.limits.speed_rad_s.at_most(held_rad_s);
        let constant = settings.joint_constant();
        let emf_rad_s = f64::from(LARGEST_DUTY) * motor.supply_v / constant;
        // The deviations of a loop of first order sum up to what its setpoint has moved, times
        // its lag in ticks, 1/(1 − e^(−x)) < 1 + 1/x: here 11 A. One that is slower has more.
        let lag_ticks = 1.0 + 1.0 / (core::f64::consts::TAU * motor.bandwidth_hz * TICK_S);
        let deviation = DEVIATING_SAMPLES * f64::from(DEVIATION_A);
        Self {
            model_torque_nm: single(most_nm * MARGIN),
            torque_nm: single(settings.limits.torque_nm * MARGIN),
            added_nm: single(added_nm * MARGIN),
            fade_nm: single(settings.limits.slew_nm_per_s * block_s),
            joint_nm: single(joint_nm * MARGIN),
            counts: single(FAST_SHARE * speed_rad_s * counts_per_rad_s + 2.0),
            amperes_per_nm: single(1.0 / constant),
            setpoint_a: single(motor.current_limit_a),
            deviation: single(deviation.at_least(2.0 * motor.current_limit_a * lag_ticks)),
            emf_counts: single(emf_rad_s * counts_per_rad_s - 2.0),
            counts_per_ampere: single(WARM * motor.resistance_ohm / constant * counts_per_rad_s),
            range: settings.range_counts(),
        }
    }

    /// Bounds while either may be in force, and what is left of the other besides: symptoms
    /// that leave and others that appear act together. What changes only while disarmed is
    /// that of the other.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            model_torque_nm: self.model_torque_nm + other.model_torque_nm,
            torque_nm: self.torque_nm.at_least(other.torque_nm),
            added_nm: self.added_nm + other.added_nm,
            fade_nm: self.fade_nm.at_most(other.fade_nm),
            joint_nm: self.joint_nm.at_least(other.joint_nm),
            counts: self.counts.at_least(other.counts),
            range: (
                self.range.0.min(other.range.0),
                self.range.1.max(other.range.1),
            ),
            ..other
        }
    }

    /// Returns whether `added_nm` has faded to zero after this number of blocks. The drive does not
    /// report a fade.
    pub fn has_faded(&self, blocks: u32) -> bool {
        #[expect(clippy::cast_precision_loss, reason = "some thousands")]
        let blocks = blocks as f32;
        blocks * self.fade_nm >= self.added_nm
    }

    /// Returns whether this many blocks are enough for a change of parameters to settle: twice the time of
    /// the longest ramp at the slew limit that these bounds allow, as one ramp may begin where
    /// another ends. Does not depend on what the drive reports.
    pub fn has_settled(&self, blocks: u32) -> bool {
        let moved_nm = self.model_torque_nm + self.added_nm + self.torque_nm;
        #[expect(
            clippy::cast_precision_loss,
            reason = "more blocks than f32 counts are hours"
        )]
        let blocks = blocks as f32;
        blocks * self.fade_nm >= 2.0 * (SOFTEST * self.joint_nm + moved_nm)
    }

    /// Returns whether a sample's torque is within the limit, and between zero and its model torque,
    /// give or take `added_nm`. Where the reported limit reason says that the joint's torque is
    /// withheld or held, by up to `joint_nm` more: a false reason gains no more than that.
    pub(super) fn allow(&self, sample: &Sample) -> bool {
        let (torque_nm, model_nm) = (sample.torque_nm, sample.model_torque_nm);
        let joint_nm = match sample.flags.limit() {
            LimitReason::None
            | LimitReason::Voltage
            | LimitReason::Current
            | LimitReason::Range
            | LimitReason::Tank => 0.0,
            _ => self.joint_nm,
        };
        let beside_nm = self.added_nm + joint_nm + ROUNDING_NM;
        let (least_nm, most_nm) = (model_nm.at_most(0.0), model_nm.at_least(0.0));
        // A NaN is beyond every bound.
        torque_nm.abs() <= self.torque_nm
            && model_nm.abs() <= self.model_torque_nm
            && (least_nm - beside_nm..=most_nm + beside_nm).contains(&torque_nm)
    }

    /// Returns whether back-EMF at this speed, counts in a block, may leave too little voltage for the
    /// setpoint in a [warm](WARM) winding. At lower speeds no voltage limit is believed.
    pub(super) fn lacks_voltage(&self, counts: f32, setpoint_a: f32) -> bool {
        let needed_a = setpoint_a.abs() + CURRENT_SLACK_A;
        counts >= self.emf_counts - self.counts_per_ampere * needed_a
    }
}
