//! The speed by back-EMF against that by the encoder, over four ticks.
//!
//! ```text
//! ω = (V̄ − R·ī − L·Δi/T)/K        and        ω = Δφ/T
//! ```
//!
//! Voltage, current and motion have to fit each other, whichever of their
//! sensors is wrong, also both of the current in the same way. Counts over a
//! window show the motion without the lag of an estimate, so this is quick: what
//! is beyond the slack in two windows in a row, the same way, is a contradiction.
//! A single disturbed sample at their border pulls them apart. A tick of which something is
//! not known begins another window; what the one before it said stays. A window needs five
//! known ticks in a row; where more than one in nine lacks a value, or more than one in six
//! is late, [`plausibility`](crate::drive::plausibility) ends torque.

use crate::drive::prepare::MotorPlan;
use crepitus_protocol::TICK_S;
use crepitus_protocol::telemetry::BLOCK_SAMPLES;

/// Ticks of a window. A block of telemetry is several.
pub(crate) const TICKS: u8 = 4;
const _: () = assert!(BLOCK_SAMPLES.is_multiple_of(TICKS as usize));
const SHARE: f32 = 1.0 / TICKS as f32;

/// Slack, rad/s: 0.18 are a count of the encoder.
const SLACK_RAD_S: f32 = 0.28;

/// Slack as a share of the speed that the voltage drives: a supply that is 10 %
/// off, a winding that is 80 K (31 %) warmer than assumed.
const SLACK_SHARE: f32 = 0.25;

/// One tick.
#[derive(Clone, Copy, Debug)]
pub struct Tick {
    /// Mean voltage since the last tick, V.
    pub volts: f32,
    /// The current now, A.
    pub current_a: f32,
    /// The encoder's count; wraps.
    pub count: i32,
}

/// A window, and which way the one before was beyond the slack.
#[derive(Clone, Copy, Debug, Default)]
pub struct EmfCheck {
    /// Ticks of the window so far; `None` without the tick before its first.
    ticks: Option<u8>,
    first_a: f32,
    first_count: i32,
    last_a: f32,
    volts_sum: f32,
    current_sum_a: f32,
    was_beyond: i8,
}

impl EmfCheck {
    /// Adds a tick; true if two windows contradict. `None`, if a value of the tick is not
    /// known, begins another window. After one that ends where the next `is_unhandy`, that
    /// begins a tick later: windows that end with blocks of telemetry would do so for ever, in
    /// the most expensive tick that there is.
    pub fn contradicts(
        &mut self,
        tick: Option<Tick>,
        motor: &MotorPlan,
        rad_per_count: f32,
        is_unhandy: impl FnOnce() -> bool,
    ) -> bool {
        let Some(tick) = tick else {
            self.ticks = None;
            return false;
        };
        let Some(ticks) = self.ticks else {
            self.begin(&tick);
            return false;
        };
        let ticks = ticks.saturating_add(1);
        self.ticks = Some(ticks);
        self.volts_sum += tick.volts;
        self.current_sum_a += 0.5 * (tick.current_a + self.last_a);
        self.last_a = tick.current_a;
        if ticks < TICKS {
            return false;
        }
        let beyond = self.beyond(&tick, motor, rad_per_count);
        let contradicts = beyond != 0 && beyond == self.was_beyond;
        if is_unhandy() {
            self.ticks = None;
        } else {
            self.begin(&tick);
        }
        self.was_beyond = beyond;
        contradicts
    }

    /// A commit takes effect: another window begins, and what the one before it said stays.
    pub fn restart(&mut self) {
        self.ticks = None;
    }

    fn begin(&mut self, tick: &Tick) {
        self.ticks = Some(0);
        (self.first_a, self.last_a) = (tick.current_a, tick.current_a);
        self.first_count = tick.count;
        (self.volts_sum, self.current_sum_a) = (0.0, 0.0);
    }

    /// Returns the sense in which the window that ends now is beyond the slack; 0 if it is not.
    #[inline(never)]
    fn beyond(&self, last: &Tick, motor: &MotorPlan, rad_per_count: f32) -> i8 {
        let mean_v = SHARE * self.volts_sum;
        let counts = last.count.wrapping_sub(self.first_count);
        #[expect(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            reason = "a window has few counts"
        )]
        let encoder_rad_s = counts as f32 * rad_per_count * (SHARE / TICK_S as f32);
        let resistive_v = motor.resistance_ohm * SHARE * self.current_sum_a;
        let inductive_v = motor.inductance_per_tick_ohm * SHARE * (last.current_a - self.first_a);
        let rad_s_per_volt = motor.per_joint_constant;
        let emf_rad_s = (mean_v - resistive_v - inductive_v) * rad_s_per_volt;
        let slack_rad_s = SLACK_RAD_S + SLACK_SHARE * mean_v.abs() * rad_s_per_volt;
        let off_rad_s = emf_rad_s - encoder_rad_s;
        if off_rad_s > slack_rad_s {
            1
        } else if off_rad_s < -slack_rad_s {
            -1
        } else {
            0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::prepare::Preparation;

    const RAD_PER_COUNT: f32 = 3.57e-5;

    fn motor() -> MotorPlan {
        Preparation::new().unwrap().1.motor
    }

    /// A motor that turns, with a current; what the sensors make of both.
    fn ticks_until(omega_rad_s: f32, current_a: f32, shows: fn(Tick) -> Tick) -> Option<usize> {
        let motor = motor();
        let mut check = EmfCheck::default();
        (0..100_u16).map(f32::from).position(|n| {
            let angle_rad = omega_rad_s * n * 5e-5;
            let tick = shows(Tick {
                volts: motor.joint_constant * omega_rad_s + motor.resistance_ohm * current_a,
                current_a,
                count: i32::MAX.wrapping_add((angle_rad / RAD_PER_COUNT).floor() as i32),
            });
            check.contradicts(Some(tick), &motor, RAD_PER_COUNT, || false)
        })
    }

    #[test]
    fn what_fits_is_no_contradiction() {
        for n in (-14_i16..=14).step_by(4) {
            let omega_rad_s = 0.5 * f32::from(n);
            for current_a in [-1.4, -0.3, 0.0, 0.7, 1.4] {
                assert_eq!(ticks_until(omega_rad_s, current_a, |tick| tick), None);
                let warm = |tick: Tick| Tick {
                    volts: tick.volts + 0.31 * 1.23 * tick.current_a,
                    ..tick
                };
                assert_eq!(ticks_until(omega_rad_s, current_a, warm), None);
                let weak = |tick: Tick| Tick {
                    volts: 0.9 * tick.volts,
                    ..tick
                };
                assert_eq!(ticks_until(omega_rad_s, current_a, weak), None);
            }
        }
    }

    #[test]
    fn a_wrong_sensor_contradicts_within_eight_ticks() {
        let stands = |tick: Tick| Tick { count: 0, ..tick };
        let swapped = |tick: Tick| Tick {
            count: tick.count.wrapping_neg(),
            ..tick
        };
        let dead = |tick: Tick| Tick {
            current_a: 0.0,
            ..tick
        };
        assert_eq!(ticks_until(0.6, 0.0, stands), Some(8));
        assert_eq!(ticks_until(-0.6, 1.0, stands), Some(8));
        assert_eq!(ticks_until(0.5, 0.2, swapped), Some(8));
        assert_eq!(ticks_until(0.0, 1.4, dead), Some(8));
    }

    /// A commit takes effect between two windows.
    #[test]
    fn a_commit_hides_no_contradiction() {
        let motor = motor();
        let stands = Tick {
            volts: motor.joint_constant,
            current_a: 0.0,
            count: 0,
        };
        for committed_at in 0..20 {
            let mut check = EmfCheck::default();
            let found = (0..20).find(|n| {
                if *n == committed_at {
                    check.restart();
                }
                check.contradicts(Some(stands), &motor, RAD_PER_COUNT, || false)
            });
            // At most one window is started again.
            assert!(found.is_some_and(|n| n <= 12), "{committed_at}: {found:?}");
        }
    }

    /// Values that are missing now and then hide nothing.
    #[test]
    fn a_wrong_sensor_contradicts_though_values_are_missing_now_and_then() {
        let motor = motor();
        let fits = |n: u16| Tick {
            volts: motor.joint_constant,
            current_a: 0.0,
            count: (f32::from(n) * 5e-5 / RAD_PER_COUNT).floor() as i32,
        };
        for (period, place) in (2..=12).flat_map(|period| [0, 1, 2, 3].map(|place| (period, place)))
        {
            let known = |n: u16, tick: Tick| (!n.is_multiple_of(period)).then_some(tick);
            let mut check = EmfCheck::default();
            let found = (0..200).find(|n| {
                let stands = Tick {
                    count: 0,
                    ..fits(*n)
                };
                let is_unhandy = || n % u16::from(TICKS) == place;
                check.contradicts(known(*n, stands), &motor, RAD_PER_COUNT, is_unhandy)
            });
            // A window needs five ticks in a row.
            assert_eq!(found.is_none(), period < 6, "one in {period}: {found:?}");
            assert!(found.is_none_or(|n| n <= 18), "one in {period}: {found:?}");
            let mut check = EmfCheck::default();
            for n in 0..400 {
                let tick = known(n, fits(n));
                assert!(
                    !check.contradicts(tick, &motor, RAD_PER_COUNT, || false),
                    "{period}"
                );
            }
        }
    }

    /// After the first, no window ends where it would be unhandy.
    #[test]
    fn windows_end_beside_the_place_that_is_unhandy() {
        let motor = motor();
        for place in 0..4 {
            let (mut check, mut before) = (EmfCheck::default(), None);
            for n in 0..60_u16 {
                let tick = Tick {
                    volts: 0.0,
                    current_a: 0.0,
                    count: 0,
                };
                let is_unhandy = || n % u16::from(TICKS) == place;
                check.contradicts(Some(tick), &motor, RAD_PER_COUNT, is_unhandy);
                let has_ended = before == Some(TICKS - 1) && check.ticks != Some(TICKS);
                assert!(!has_ended || n < 8 || !is_unhandy(), "{n}");
                before = check.ticks;
            }
        }
    }

    #[test]
    fn a_disturbed_sample_is_no_contradiction() {
        let motor = motor();
        for at in 0..20 {
            let mut check = EmfCheck::default();
            for n in 0..40 {
                let tick = Tick {
                    volts: 0.0,
                    current_a: if n == at { 2.5 } else { 0.0 },
                    count: 0,
                };
                assert!(
                    !check.contradicts(Some(tick), &motor, RAD_PER_COUNT, || false),
                    "{at}"
                );
            }
        }
    }
}
