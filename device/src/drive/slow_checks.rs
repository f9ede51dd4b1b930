//! Checks of what changes slowly: supply, temperature of the motor, and the joint's
//! own angle. One is read in a tick, all of them in three.

use crepitus_model::Real;
use crepitus_protocol::Fault;
use crepitus_protocol::measured::MOTOR_C;

/// Consecutive bad readings until the fault: 3 ms, 100 ms, 3 ms.
const LOW_READINGS: u32 = 20;
const HOT_READINGS: u32 = 667;
const OFF_READINGS: u32 = 20;

/// Consecutive readings of a voltage that is too high until the fault.
const HIGH_READINGS: u32 = 4;

/// Ticks without any reading until the fault.
const MISSING_TICKS: u32 = 60;

/// A reading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SlowInput {
    /// No reading: the converter has no result.
    #[default]
    None,
    /// Voltage of the motor's supply, V.
    SupplyV(f32),
    /// Temperature of the motor, °C.
    MotorC(f32),
    /// The joint's sensor, as a share of its turn, growing in flexion.
    JointTurns(f32),
}

impl SlowInput {
    /// The reading of a tick, of the three in turn.
    pub fn in_turn(tick: u64, supply_v: f32, motor_c: f32, joint_turns: f32) -> Self {
        match tick % 3 {
            0 => Self::SupplyV(supply_v),
            1 => Self::MotorC(motor_c),
            _ => Self::JointTurns(joint_turns),
        }
    }
}

/// Coefficients of the checks.
#[derive(Clone, Copy, Debug)]
pub struct SlowPlan {
    /// The supply's voltage as it is set, V.
    pub nominal_v: f32,
    /// Speed up to which a volt of it holds a current of zero, rad/s/V.
    pub held_rad_s_per_volt: f32,
    /// Least and largest voltage of the supply, V.
    pub supply_v: (f32, f32),
    /// The joint's sensor, if it is fitted.
    pub joint: Option<JointSensorPlan>,
}

/// Coefficients of the joint's sensor.
#[derive(Clone, Copy, Debug)]
pub struct JointSensorPlan {
    /// Share of a turn in a count of the encoder.
    pub turns_per_count: f32,
    /// Largest deviation of sensor and encoder, share of a turn.
    pub tolerance: f32,
}

/// The last readings.
#[derive(Clone, Copy, Debug, Default)]
pub struct SlowReadings {
    /// Voltage of the supply, V.
    pub supply_v: f32,
    /// Temperature of the motor, °C.
    pub motor_c: f32,
    /// Span of the movement of the joint's sensor and the encoder against each other
    /// since the zero, share of a turn: backlash is not more. `None` without a sensor
    /// or a zero.
    pub joint_span: Option<f32>,
}

/// The checks.
#[derive(Clone, Copy, Debug)]
pub struct SlowChecks {
    plan: SlowPlan,
    readings: SlowReadings,
    /// Speed up to which the supply holds a current of zero, rad/s.
    held_rad_s: f32,
    missing_ticks: u32,
    /// Consecutive bad readings.
    low: u32,
    high: u32,
    hot: u32,
    off: u32,
    /// Last reading of the joint's sensor, and its reading at the angle's zero.
    joint: Option<f32>,
    joint_zero: Option<f32>,
    /// Smallest and largest deviation since the zero, share of a turn.
    deviations: (f32, f32),
}

impl SlowChecks {
    /// Returns the checks before the first reading.
    pub fn new(plan: &SlowPlan) -> Self {
        Self {
            plan: *plan,
            readings: SlowReadings::default(),
            held_rad_s: plan.held_rad_s_per_volt * plan.nominal_v,
            missing_ticks: 0,
            low: 0,
            high: 0,
            hot: 0,
            off: 0,
            joint: None,
            joint_zero: None,
            deviations: (0.0, 0.0),
        }
    }

    /// Replaces the coefficients.
    pub fn change(&mut self, plan: &SlowPlan) {
        self.plan = *plan;
    }

    /// The angle's zero is here.
    pub fn zero(&mut self) {
        self.joint_zero = self.joint;
        self.deviations = (0.0, 0.0);
    }

    /// The speed up to which the supply holds a current of zero, rad/s. A motor that is faster
    /// has a back-EMF beyond the largest voltage.
    pub fn held_rad_s(&self) -> f32 {
        self.held_rad_s
    }

    /// The last readings.
    pub fn readings(&self) -> SlowReadings {
        let (least, most) = self.deviations;
        SlowReadings {
            joint_span: (self.plan.joint.and(self.joint_zero)).map(|_| most - least),
            ..self.readings
        }
    }

    /// Runs one tick, with the count from the angle's zero. What only matters under
    /// torque is no fault without.
    pub fn tick(&mut self, input: SlowInput, count: i32, is_live: bool) -> Option<Fault> {
        if input == SlowInput::None {
            self.missing_ticks = self.missing_ticks.saturating_add(1);
            let is_missing = is_live && self.missing_ticks > MISSING_TICKS;
            return is_missing.then_some(Fault::SupplyLow);
        }
        self.missing_ticks = 0;
        match input {
            SlowInput::None => None,
            SlowInput::SupplyV(volts) => self.supply(volts, is_live),
            SlowInput::MotorC(celsius) => {
                self.readings.motor_c = celsius;
                let (coldest_c, hottest_c) = MOTOR_C;
                let is_good = celsius > coldest_c && celsius < hottest_c;
                let is_fault = held(&mut self.hot, !is_good) >= HOT_READINGS;
                (is_live && is_fault).then_some(Fault::MotorHot)
            }
            SlowInput::JointTurns(turns) => {
                let is_fault = self.joint(turns, count);
                (is_live && is_fault).then_some(Fault::JointMismatch)
            }
        }
    }

    fn supply(&mut self, volts: f32, is_live: bool) -> Option<Fault> {
        self.readings.supply_v = volts;
        let (least, most) = self.plan.supply_v;
        // Duties are of the voltage that is set: with more than that no more is held.
        let held_v = least.at_least(volts).at_most(self.plan.nominal_v);
        self.held_rad_s = self.plan.held_rad_s_per_volt * held_v;
        let is_enough = volts >= least;
        let is_low = held(&mut self.low, !is_enough) >= LOW_READINGS;
        if held(&mut self.high, volts > most) >= HIGH_READINGS {
            return Some(Fault::SupplyHigh);
        }
        (is_live && is_low).then_some(Fault::SupplyLow)
    }

    fn joint(&mut self, turns: f32, count: i32) -> bool {
        self.joint = Some(turns);
        let Some(plan) = self.plan.joint else {
            return false;
        };
        let deviation = self.joint_zero.map_or(f32::NAN, |zero| {
            #[expect(clippy::cast_precision_loss, reason = "rounded to less than a count")]
            let turned = count as f32 * plan.turns_per_count;
            let off = turns - zero - turned;
            off - nearest(off)
        });
        let (least, most) = self.deviations;
        self.deviations = (least.at_most(deviation), most.at_least(deviation));
        let is_good = deviation.abs() <= plan.tolerance;
        held(&mut self.off, !is_good) >= OFF_READINGS
    }
}

/// Counts for how many times in a row a condition holds.
fn held(count: &mut u32, condition: bool) -> u32 {
    *count = if condition {
        count.saturating_add(1)
    } else {
        0
    };
    *count
}

/// The nearest whole number; of what is no turn or two away, none.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "a cast from float saturates"
)]
fn nearest(turns: f32) -> f32 {
    (turns + 0.5_f32.copysign(turns)) as i32 as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNTS: f32 = 1e-5;

    fn checks() -> SlowChecks {
        SlowChecks::new(&SlowPlan {
            nominal_v: 24.0,
            held_rad_s_per_volt: 0.25,
            supply_v: (18.0, 30.0),
            joint: Some(JointSensorPlan {
                turns_per_count: COUNTS,
                tolerance: 0.01,
            }),
        })
    }

    /// Ticks of a live device, from a good start, until a fault.
    fn until(inputs: [SlowInput; 3], count: i32) -> Option<(Fault, u32)> {
        let good = [
            SlowInput::SupplyV(24.0),
            SlowInput::MotorC(25.0),
            SlowInput::JointTurns(0.4),
        ];
        let mut checks = checks();
        for input in good {
            assert_eq!(checks.tick(input, 0, false), None);
        }
        checks.zero();
        for input in good {
            let _ = checks.tick(input, 0, false);
        }
        let mut next = inputs.into_iter().cycle();
        (1..3_000).find_map(|tick| Some((checks.tick(next.next()?, count, true)?, tick)))
    }

    const SUPPLY: SlowInput = SlowInput::SupplyV(24.0);
    const MOTOR: SlowInput = SlowInput::MotorC(25.0);

    fn joint(turns: f32) -> SlowInput {
        SlowInput::JointTurns(turns)
    }

    #[test]
    fn the_speed_that_is_held_follows_the_supply() {
        let mut checks = checks();
        assert_eq!(checks.held_rad_s(), 6.0);
        for (volts, held_rad_s) in [
            (20.0, 5.0),
            (24.0, 6.0),
            (29.0, 6.0),
            (0.0, 4.5),
            (f32::NAN, 4.5),
        ] {
            let _ = checks.tick(SlowInput::SupplyV(volts), 0, false);
            assert_eq!(checks.held_rad_s(), held_rad_s, "{volts} V");
        }
    }

    #[test]
    fn good_readings_are_no_fault() {
        for volts in [18.0, 30.0] {
            let inputs = [SlowInput::SupplyV(volts), MOTOR, joint(0.4)];
            assert_eq!(until(inputs, 0), None);
        }
        for celsius in [-19.0, 69.0] {
            let inputs = [SUPPLY, SlowInput::MotorC(celsius), joint(0.4)];
            assert_eq!(until(inputs, 0), None);
        }
        // A whole turn further, and through the sensor's end.
        for (turns, count) in [(0.4, 100_000), (0.409, 0), (0.991, 60_000), (0.0, -40_000)] {
            assert_eq!(until([SUPPLY, MOTOR, joint(turns)], count), None, "{turns}");
        }
    }

    #[test]
    fn bad_readings_are_a_fault_in_time() {
        let good = joint(0.4);
        for (inputs, count, fault, most) in [
            (
                [SlowInput::SupplyV(17.9), MOTOR, good],
                0,
                Fault::SupplyLow,
                61,
            ),
            (
                [SlowInput::SupplyV(f32::NAN), MOTOR, good],
                0,
                Fault::SupplyLow,
                61,
            ),
            (
                [SlowInput::SupplyV(30.1), MOTOR, good],
                0,
                Fault::SupplyHigh,
                12,
            ),
            (
                [SUPPLY, SlowInput::MotorC(70.1), good],
                0,
                Fault::MotorHot,
                2_001,
            ),
            (
                [SUPPLY, SlowInput::MotorC(-50.0), good],
                0,
                Fault::MotorHot,
                2_001,
            ),
            ([SUPPLY, MOTOR, joint(0.42)], 0, Fault::JointMismatch, 61),
            ([SUPPLY, MOTOR, good], 2_000, Fault::JointMismatch, 61),
            (
                [SUPPLY, MOTOR, joint(f32::NAN)],
                0,
                Fault::JointMismatch,
                61,
            ),
            ([SlowInput::None; 3], 0, Fault::SupplyLow, 61),
        ] {
            let (found, ticks) = until(inputs, count).unwrap();
            assert_eq!(found, fault, "{inputs:?}");
            assert!(ticks <= most, "{inputs:?}: {ticks}");
        }
    }

    #[test]
    fn without_torque_only_a_high_supply_is_a_fault() {
        let mut checks = checks();
        let bad = [
            SlowInput::SupplyV(0.0),
            SlowInput::MotorC(300.0),
            SlowInput::JointTurns(0.9),
        ];
        let mut tick = |input| checks.tick(input, 0, false);
        assert!(
            bad.into_iter()
                .cycle()
                .take(9_000)
                .all(|input| tick(input).is_none())
        );
        let high = (0..20).find_map(|_| tick(SlowInput::SupplyV(31.0)));
        assert_eq!(high, Some(Fault::SupplyHigh));
    }

    #[test]
    fn backlash_shows_as_a_span() {
        let mut checks = checks();
        assert_eq!(checks.readings().joint_span, None);
        let _ = checks.tick(joint(0.4), 0, false);
        checks.zero();
        for (turns, count) in [(0.402, 0), (0.5, 10_000), (0.597, 20_000)] {
            let _ = checks.tick(joint(turns), count, true);
        }
        let span = checks.readings().joint_span.unwrap();
        assert!((span - 0.005).abs() < 1e-5, "{span}");
    }
}
