//! Catches: the resistance rises all at once while the leg is moved fast.
//!
//! ```text
//! resistance     │       ╭╮  rise ≥ 0.25 N·m
//!                │ ······││··········· the most of 50 to 300 ms ago
//!                │╮      │╰───
//!                │╰─∿∿∿──╯
//!                └────────────────> angle
//!                   6°   catch
//! ```
//!
//! Sources: the catch of a stretch at speed V3 is R1 of the modified Tardieu scale (Boyd and Graham,
//! Eur J Neurol 6 Suppl 4:S23–S35, 1999); its angle is where the resistance rises fastest (Wu et al.,
//! Dev Med Child Neurol 52:563–569, 2010). The numbers are estimates: grating and cogwheels, which
//! have risen as high before, are no catch, nor is rigidity, which builds up within the first degrees.

use super::FAST_RAD_S;

/// Rise that is a catch, N·m: somewhat more than a hand tells apart.
const RISE_NM: f64 = 0.25;

/// Way from a turn on which resistance may build up, rad: 6°.
const SETTLING_RAD: f64 = 6.0 * core::f64::consts::PI / 180.0;

/// Length of a slot of time, s, and slots that are remembered.
const SLOT_S: f64 = 0.025;
const SLOTS: usize = 12;

/// A catch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Catch {
    /// Angle at which it was felt, rad.
    pub(super) angle_rad: f64,
    /// Speed with which the leg came there, rad/s.
    pub(super) speed_rad_s: f64,
    /// Sense of the stretch: 1 in flexion, −1 in extension.
    pub(super) sense: f64,
}

/// Looks for catches.
#[derive(Clone, Debug, Default)]
pub(super) struct Catches {
    stage: Stage,
    /// Highest resistance of the slots that are over, newest first, N·m.
    highest_nm: [f64; SLOTS],
    /// That of the slot at hand, and its end, s.
    slot_nm: f64,
    slot_end_s: f64,
    /// Highest speed of the stroke so far, rad/s.
    fastest_rad_s: f64,
    /// Catch of the fastest stretch so far.
    found: Option<Catch>,
}

/// Stage of a stroke.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Stage {
    /// Resistance builds up after the turn.
    #[default]
    Settles,
    /// There was no catch yet.
    Waits,
    /// There was one.
    Caught,
}

/// A sample of a stroke.
#[derive(Clone, Copy, Debug)]
pub(super) struct Felt {
    /// Time, s.
    pub(super) time_s: f64,
    /// Angle, rad.
    pub(super) angle_rad: f64,
    /// Sense of the stroke.
    pub(super) sense: f64,
    /// Way since the turn, rad.
    pub(super) along_rad: f64,
    /// Speed, rad/s.
    pub(super) speed_rad_s: f64,
    /// Torque against the movement, N·m.
    pub(super) resistance_nm: f64,
}

impl Catches {
    /// Catch of the fastest stretch.
    pub(super) fn found(&self) -> Option<Catch> {
        self.found
    }

    /// The leg has turned, or samples are missing.
    pub(super) fn turn(&mut self) {
        self.stage = Stage::Settles;
        (self.fastest_rad_s, self.slot_nm) = (0.0, 0.0);
    }

    /// Takes the next sample of a stroke.
    pub(super) fn take(&mut self, felt: &Felt) {
        let nm = felt.resistance_nm;
        self.fastest_rad_s = self.fastest_rad_s.max(felt.speed_rad_s);
        if self.stage == Stage::Settles {
            self.slot_nm = self.slot_nm.max(nm);
            if felt.along_rad >= SETTLING_RAD {
                self.stage = Stage::Waits;
                // It has risen so high before.
                self.highest_nm = [self.slot_nm; SLOTS];
                (self.slot_nm, self.slot_end_s) = (nm, felt.time_s + SLOT_S);
            }
            return;
        }
        if felt.time_s >= self.slot_end_s {
            self.highest_nm.rotate_right(1);
            if let Some(newest_nm) = self.highest_nm.first_mut() {
                *newest_nm = self.slot_nm;
            }
            (self.slot_nm, self.slot_end_s) = (nm, felt.time_s + SLOT_S);
        }
        self.slot_nm = self.slot_nm.max(nm);
        // The rise may have begun in the slot that is just over.
        let before = self.highest_nm.iter().skip(1);
        let before_nm = before.fold(f64::NEG_INFINITY, |most, nm| most.max(*nm));
        let is_fast = self.fastest_rad_s >= FAST_RAD_S;
        if self.stage == Stage::Waits && is_fast && nm - before_nm >= RISE_NM {
            self.stage = Stage::Caught;
            let fastest_rad_s = self.found.map_or(0.0, |found| found.speed_rad_s);
            if felt.speed_rad_s >= fastest_rad_s {
                self.found = Some(Catch {
                    angle_rad: felt.angle_rad,
                    speed_rad_s: felt.speed_rad_s,
                    sense: felt.sense,
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A stroke at this speed, °/s, against this resistance by angle, °, and time, s.
    fn caught(deg_s: f64, nm: impl Fn(f64, f64) -> f64) -> Option<f64> {
        let mut catches = Catches::default();
        for tick in 0..60_000 {
            let time_s = f64::from(tick) * 5e-5;
            let deg = deg_s * time_s;
            if deg > 100.0 {
                break;
            }
            catches.take(&Felt {
                time_s,
                angle_rad: deg.to_radians(),
                sense: 1.0,
                along_rad: deg.to_radians(),
                speed_rad_s: deg_s.to_radians(),
                resistance_nm: nm(deg, time_s),
            });
        }
        catches.found().map(|catch| catch.angle_rad.to_degrees())
    }

    #[test]
    fn a_sudden_rise_is_a_catch_if_the_leg_is_fast() {
        let rise = |deg: f64, _: f64| ((deg - 50.0) / 2.0).clamp(0.0, 1.0);
        let found = caught(150.0, rise).unwrap();
        assert!((found - 50.5).abs() < 0.1, "{found}");
        assert_eq!(caught(40.0, rise), None);
    }

    #[test]
    fn rigidity_grating_and_cogwheels_are_no_catch() {
        let built = |deg: f64, _: f64| (deg / 3.0).min(1.0) * 3.0;
        assert_eq!(caught(200.0, built), None);
        let grating = |_: f64, t: f64| 0.6 + 0.5 * (TAU * 20.0 * t).sin();
        assert_eq!(caught(150.0, grating), None);
        let cogs = |_: f64, t: f64| if (6.25 * t).fract() < 0.5 { 1.8 } else { 0.7 };
        assert_eq!(caught(90.0, cogs), None);
        let slowly = |deg: f64, _: f64| 2.0 * deg / 100.0;
        assert_eq!(caught(200.0, slowly), None);
    }

    /// R1 is that of the fastest stretch, whichever came last.
    #[test]
    fn of_several_catches_that_of_the_fastest_stretch_counts() {
        let mut catches = Catches::default();
        let mut begin_s = 0.0;
        for (deg_s, at_deg) in [(120.0_f64, 70.0), (200.0, 50.0), (150.0, 60.0)] {
            catches.turn();
            for tick in 0..20_000 {
                let passed_s = f64::from(tick) * 5e-5;
                let deg = deg_s * passed_s;
                if deg > 100.0 {
                    break;
                }
                catches.take(&Felt {
                    time_s: begin_s + passed_s,
                    angle_rad: deg.to_radians(),
                    sense: 1.0,
                    along_rad: deg.to_radians(),
                    speed_rad_s: deg_s.to_radians(),
                    resistance_nm: ((deg - at_deg) / 2.0).clamp(0.0, 1.0),
                });
            }
            begin_s += 1.0;
        }
        // Of the second: 0.25 N·m are half a degree.
        let found = catches.found().unwrap().angle_rad.to_degrees();
        assert!((found - 50.5).abs() < 0.1, "{found}");
    }
}
