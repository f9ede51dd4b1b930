//! Plausibility checks while armed.
//!
//! Each check is debounced: a single disturbed sample is no fault. The table below has
//! the ticks, by which [`FAULTS`](crepitus_protocol::fault::FAULTS) gives its
//! times.
//!
//! **Current** is judged by three opinions: the sensor, the monitor
//! with a shunt and an amplifier of its own, and what voltage and motion say
//! ([`emf_check`](crate::drive::emf_check)). The monitor's amplifier also feeds the
//! comparator, which needs no program.

use crate::board::TRIP_A;
use crate::drive::motor::{CURRENT_SLACK_A, Motor};
use crate::drive::sampler::LOST_TICKS;
use crepitus_model::Real;
use crepitus_protocol::{Fault, TICK_US};

/// Largest difference of the two current sensors, A: 2 × 1 % of the range, and
/// the noise of two conversions.
const SENSORS_SLACK_A: f32 = 0.2;

/// Duty beyond which the half that switches later does so less than 5 µs before the first sample, and what its
/// amplifier may be off by more for a larger one, A: 0.2 A at the largest.
const UNSETTLED_DUTY: f32 = 0.5;
const UNSETTLED_A: f32 = 0.6;

/// Largest deviation of the time between two ticks, µs.
const INTERVAL_SLACK_US: u32 = 5;

/// Largest difference of back-EMF speed and encoder speed, rad/s, and as a
/// share of the larger: copper 80 K warmer than assumed.
const SPEED_SLACK_RAD_S: f32 = 0.5;
const SPEED_SLACK_SHARE: f32 = 0.25;

/// Largest sum of what is beyond the slack, rad/s times ticks: 10 mrad.
const SPEED_EXCESS: f32 = 200.0;

/// Late ticks that are too many, and what share of one a tick in time makes up
/// for.
const LATE_TICKS: f32 = 20.0;
const LATE_SHARE: f32 = 0.2;

/// A condition that is a fault when it has held for so many consecutive ticks.
#[derive(Clone, Copy, Debug)]
struct Check {
    fault: Fault,
    /// The ticks times [`TICK`].
    most: u16,
    /// Made up for by a tick without the condition.
    forgets: u16,
}

/// A tick in which a condition holds, in the unit of its counter.
const TICK: u16 = 8;

/// A condition of which a single tick without it forgets all.
const fn check(fault: Fault, ticks: u16) -> Check {
    Check {
        fault,
        most: ticks.saturating_mul(TICK),
        forgets: u16::MAX,
    }
}

/// A condition that is also a fault if it is intermittent: in more than one tick of nine.
const fn recurring(fault: Fault, ticks: u16) -> Check {
    Check {
        fault,
        most: ticks.saturating_mul(TICK),
        forgets: 1,
    }
}

/// Number of the checks.
const CHECKS: usize = 12;

/// The checks, the most urgent first; [`Conditions`] has a bit for each.
const TABLE: [Check; CHECKS] = [
    check(Fault::Overcurrent, 1),
    check(Fault::NotANumber, 1),
    check(Fault::Overcurrent, 2),
    recurring(Fault::CurrentDisagreement, 2),
    check(Fault::SpeedMismatch, 1),
    recurring(Fault::CurrentMissing, 3),
    check(Fault::TickIrregular, 3),
    recurring(Fault::EnableStuckOff, 9),
    recurring(Fault::EncoderLost, 20),
    check(Fault::Overspeed, 20),
    check(Fault::CurrentMismatch, 100),
    check(Fault::SpeedMismatch, 400),
];

const _: () = assert!(TABLE[8].most as u32 == LOST_TICKS * TICK as u32);

/// Place of the current mismatch in the table.
const MISMATCH: usize = 10;

/// The conditions that hold in a tick, a bit each, in the order of [`TABLE`]; the highest
/// bit is set if nothing can be said of [`MISMATCH`], whose counter then stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Conditions(u16);

impl Conditions {
    #[inline]
    fn of(holds: [bool; CHECKS]) -> Self {
        let bits = holds.into_iter().rev();
        Self(bits.fold(0, |bits, holds| bits << 1 | u16::from(holds)))
    }

    const UNKNOWN: u16 = 1 << 15;
}

/// Sums an excess from tick to tick; below zero it forgets. What is far off trips
/// soon, and what comes and goes trips as well.
#[derive(Clone, Copy, Debug, Default)]
struct Excess(f32);

impl Excess {
    /// Adds an excess; true once the sum has reached `most`.
    fn trips(&mut self, excess: f32, most: f32) -> bool {
        self.0 = (self.0 + excess).at_least(0.0);
        // A NaN trips.
        self.0.is_nan() || self.0 >= most
    }
}

/// Inputs of the checks in a tick.
#[derive(Clone, Copy, Debug)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a line or a fact by itself"
)]
pub struct Observation {
    /// Consecutive ticks without a plausible count.
    pub lost_ticks: u32,
    /// Speed of the joint by the encoder, rad/s.
    pub omega_rad_s: f32,
    /// The torque is that of the previous tick.
    pub is_late: bool,
    /// The rendered torque is finite.
    pub torque_is_finite: bool,
    /// The current of the loop, A.
    pub current_a: Option<f32>,
    /// Current of the sensor without its offset, A.
    pub sensor_a: Option<f32>,
    /// Current of the monitor without its offset, A.
    pub monitor_a: Option<f32>,
    /// Voltage, current and motion contradict each other over some ticks.
    pub emf_contradicts: bool,
    /// Time since the tick before, by another timer, µs.
    pub interval_us: u32,
    /// The enable line, as read back.
    pub enable_is_on: bool,
    /// The hardware's break input has tripped.
    pub has_tripped: bool,
}

/// The checks' debounce counters.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plausibility {
    /// Time for which each condition has held, in [`TICK`]s.
    held: [u16; CHECKS],
    late: Excess,
    speeds: Excess,
    /// One of the above is not zero.
    remembers: bool,
}

impl Plausibility {
    /// Returns the most urgent fault of a tick with torque. `motor` is in the
    /// state after the previous tick.
    pub fn check(
        &mut self,
        observed: &Observation,
        motor: &Motor,
        speed_limit_rad_s: f32,
    ) -> Option<Fault> {
        let (emf, encoder) = (motor.emf_rad_s(), observed.omega_rad_s);
        let slack = SPEED_SLACK_RAD_S + SPEED_SLACK_SHARE * emf.abs().at_least(encoder.abs());
        let speeds_excess = (emf - encoder).abs() - slack;
        let holds = conditions(observed, motor, speed_limit_rad_s, speeds_excess);
        // Mostly there is nothing, and was nothing.
        if holds.0 == 0 && !observed.is_late && !self.remembers {
            return None;
        }
        self.count(holds, observed.is_late, speeds_excess)
    }

    #[inline(never)]
    fn count(
        &mut self,
        Conditions(mut bits): Conditions,
        is_late: bool,
        speeds_excess: f32,
    ) -> Option<Fault> {
        let mut fault = None;
        let mismatch = self.held[MISMATCH];
        let stays = bits & Conditions::UNKNOWN != 0;
        let mut any = 0;
        for (held, check) in self.held.iter_mut().zip(&TABLE) {
            *held = if bits & 1 == 0 {
                held.saturating_sub(check.forgets)
            } else {
                held.saturating_add(TICK)
            };
            if fault.is_none() && *held >= check.most {
                fault = Some(check.fault);
            }
            any |= *held;
            bits >>= 1;
        }
        if stays {
            self.held[MISMATCH] = mismatch;
            any |= mismatch;
        }
        self.remembers = any != 0;
        let late = self
            .late
            .trips(if is_late { 1.0 } else { -LATE_SHARE }, LATE_TICKS);
        let speeds = self.speeds.trips(speeds_excess, SPEED_EXCESS);
        self.remembers |= self.late.0 != 0.0 || self.speeds.0 != 0.0;
        fault
            .or(late.then_some(Fault::RenderingLate))
            .or(speeds.then_some(Fault::SpeedMismatch))
    }
}

/// The conditions of a tick.
fn conditions(
    observed: &Observation,
    motor: &Motor,
    speed_limit_rad_s: f32,
    speeds_excess: f32,
) -> Conditions {
    let (current_a, sensor_a) = (observed.current_a, observed.sensor_a);
    let monitor_a = observed.monitor_a;
    let encoder = observed.omega_rad_s;
    let is_over = |a: Option<f32>| a.is_some_and(|a| a.abs() > TRIP_A);
    let unsettled_a = UNSETTLED_A * (motor.duty_now().abs() - UNSETTLED_DUTY).at_least(0.0);
    let sensors_differ = (sensor_a.zip(monitor_a))
        .is_some_and(|(sensor, monitor)| (sensor - monitor).abs() > SENSORS_SLACK_A + unsettled_a);
    let deviates = current_a.is_some_and(|a| (a - motor.setpoint_a()).abs() > CURRENT_SLACK_A);
    let is_excused = deviates && motor.is_out_of_voltage(encoder);
    let is_irregular = observed.interval_us.abs_diff(TICK_US) > INTERVAL_SLACK_US;
    let conditions = Conditions::of([
        observed.has_tripped,
        !observed.torque_is_finite,
        is_over(sensor_a) || is_over(monitor_a),
        sensors_differ,
        observed.emf_contradicts,
        sensor_a.is_none() || monitor_a.is_none(),
        is_irregular,
        !observed.enable_is_on,
        observed.lost_ticks > 0,
        encoder.abs() > speed_limit_rad_s,
        deviates && !is_excused,
        speeds_excess > 0.0,
    ]);
    if is_excused || current_a.is_none() {
        Conditions(conditions.0 | Conditions::UNKNOWN)
    } else {
        conditions
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::prepare::Preparation;

    fn holds(place: usize) -> Conditions {
        let mut holds = [false; CHECKS];
        holds[place] = true;
        Conditions::of(holds)
    }

    const NONE: Conditions = Conditions(0);

    #[test]
    fn a_condition_counts_while_it_holds_and_the_most_urgent_is_reported() {
        for (n, check) in TABLE.iter().enumerate() {
            let ticks = check.most / TICK;
            let mut plausibility = Plausibility::default();
            let mut run = |conditions| plausibility.count(conditions, false, -1.0);
            for n_ticks in 1..ticks {
                assert_eq!(run(holds(n)), None, "{n} after {n_ticks}");
            }
            if ticks > 1 {
                // All is forgotten: at once, or eight times as slowly as it came.
                let forgotten = (TICK * ticks).div_ceil(check.forgets);
                for _ in 0..forgotten {
                    assert_eq!(run(NONE), None);
                }
                for _ in 1..ticks {
                    assert_eq!(run(holds(n)), None, "{n} starts over");
                }
            }
            assert_eq!(run(holds(n)), Some(check.fault));
        }
        let mut plausibility = Plausibility::default();
        let all = Conditions::of([true; CHECKS]);
        for _ in 0..500 {
            assert_eq!(plausibility.count(all, true, 1.0), Some(Fault::Overcurrent));
        }
        assert!(plausibility.remembers);
        for _ in 0..5_000 {
            plausibility.count(NONE, false, -1.0);
        }
        assert!(!plausibility.remembers);
    }

    /// An intermittent condition does not stay below its debounce for ever.
    #[test]
    fn what_recurs_in_more_than_one_tick_of_nine_is_a_fault() {
        let recurring = [
            Fault::CurrentDisagreement,
            Fault::CurrentMissing,
            Fault::EnableStuckOff,
            Fault::EncoderLost,
        ];
        for (place, check) in TABLE.iter().enumerate() {
            for period in 2..12 {
                let mut plausibility = Plausibility::default();
                let fault = (0..6_000).find_map(|n| {
                    let conditions = if n % period == 0 { holds(place) } else { NONE };
                    plausibility.count(conditions, false, -1.0)
                });
                let ends = check.most == TICK || recurring.contains(&check.fault) && period < 9;
                assert_eq!(fault, ends.then_some(check.fault), "one in {period}");
            }
        }
    }

    #[test]
    fn a_tick_that_says_nothing_of_the_current_neither_counts_nor_makes_up() {
        let mut plausibility = Plausibility::default();
        let mut run = |conditions| plausibility.count(conditions, false, -1.0);
        for _ in 0..99 {
            assert_eq!(run(holds(MISMATCH)), None);
            assert_eq!(run(Conditions(Conditions::UNKNOWN)), None);
        }
        assert_eq!(run(holds(MISMATCH)), Some(Fault::CurrentMismatch));
        assert_eq!(run(NONE), None);
        assert_eq!(run(holds(MISMATCH)), None);
    }

    #[test]
    fn one_late_tick_in_five_is_too_many_and_one_in_six_is_not() {
        for (period, faults) in [(1, true), (2, true), (5, true), (6, false)] {
            let mut plausibility = Plausibility::default();
            let fault = (0..6_000).find_map(|n| plausibility.count(NONE, n % period == 0, -1.0));
            let expected = faults.then_some(Fault::RenderingLate);
            assert_eq!(fault, expected, "one in {period}");
        }
    }

    #[test]
    fn either_sensor_of_the_current_trips() {
        let motor = Motor::new(&Preparation::new().unwrap().1.motor);
        for (current_a, monitor_a, holds) in [
            (1.9, 1.9, false),
            (2.0, 1.9, true),
            (1.9, 2.0, true),
            (-1.9, -2.0, true),
        ] {
            let observed = Observation {
                lost_ticks: 0,
                omega_rad_s: 0.0,
                is_late: false,
                torque_is_finite: true,
                current_a: Some(current_a),
                sensor_a: Some(current_a),
                monitor_a: Some(monitor_a),
                emf_contradicts: false,
                interval_us: TICK_US,
                enable_is_on: true,
                has_tripped: false,
            };
            let mut plausibility = Plausibility::default();
            let faults = [(); 2].map(|()| plausibility.check(&observed, &motor, 7.0));
            assert_eq!(faults, [None, holds.then_some(Fault::Overcurrent)]);
        }
    }

    #[test]
    fn an_excess_adds_up_and_is_forgotten() {
        let mut excess = Excess::default();
        let mut run = |values: &[f32]| values.iter().any(|value| excess.trips(*value, 20.0));
        assert!(!run(&[1.0; 19]));
        assert!(!run(&[-1.0; 100]));
        // One in three is late: never. Every other: soon.
        assert!(!run(&[1.0, -0.5, -0.5].repeat(100)));
        assert!(!run(&[1.0, -0.25].repeat(26)));
        assert!(run(&[1.0, -0.25].repeat(2)));
    }
}
