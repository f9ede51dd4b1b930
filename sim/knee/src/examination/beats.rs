//! Beats of clonus: torque that comes and goes while the leg is held.
//!
//! A beat is a torque that rises to 0.4 N·m or more from less than a third of its height, and falls below a third
//! of it again. Those of one train follow each other within 80 to 400 ms, and the leg moves by less than 5° from one to the next: the
//! teeth of a cogwheel do not fall so low, and need a moving leg.
//!
//! Sources: 5 to 8 Hz, 3.8 to 5.8 under load (see the law of clonus in the model); SCATS counts how long
//! it lasts (Benz et al., Arch Phys Med Rehabil 86:52–59, 2005). Limits are estimates.

/// Least height, N·m, and the share of it from which a beat rises, and below which it is over.
const HEIGHT_NM: f64 = 0.4;
const OVER_SHARE: f64 = 1.0 / 3.0;

/// Times from beat to beat, s.
const INTERVAL_S: core::ops::RangeInclusive<f64> = 0.08..=0.4;

/// Angle by which the leg may move from one to the next, rad: 5°. The first beat comes before it rests.
const HELD_RAD: f64 = 5.0 * core::f64::consts::PI / 180.0;

/// Fewer beats are no train.
const LEAST: u32 = 3;

/// Beats in a row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Train {
    /// Their number.
    pub(super) beats: u32,
    first_s: f64,
    last: Peak,
}

impl Train {
    /// Beats a second, once they are three.
    pub(super) fn rate_hz(&self) -> Option<f64> {
        let intervals = f64::from(self.beats.saturating_sub(1));
        (self.beats >= LEAST).then(|| intervals / (self.last.time_s - self.first_s))
    }
}

/// Height of a beat.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Peak {
    time_s: f64,
    angle_rad: f64,
    nm: f64,
}

/// Counts beats.
#[derive(Clone, Debug, Default)]
pub(super) struct Beats {
    /// The beat under way.
    open: Option<Peak>,
    /// Least torque since the last beat, N·m.
    least_nm: f64,
    train: Train,
    longest: Train,
}

impl Beats {
    /// The longest train so far, if there is one.
    pub(super) fn longest(&self) -> Option<Train> {
        Some(self.longest).filter(|train| train.beats >= LEAST)
    }

    /// Samples are missing.
    pub(super) fn pause(&mut self) {
        self.open = None;
        self.least_nm = 0.0;
        self.train = Train::default();
    }

    /// Takes the next sample.
    pub(super) fn take(&mut self, time_s: f64, angle_rad: f64, torque_nm: f64) {
        let nm = torque_nm.abs();
        let now = Peak {
            time_s,
            angle_rad,
            nm,
        };
        match self.open {
            None if nm >= HEIGHT_NM && OVER_SHARE * nm > self.least_nm => self.open = Some(now),
            None => self.least_nm = self.least_nm.min(nm),
            Some(peak) if nm > peak.nm => self.open = Some(now),
            Some(peak) if nm < OVER_SHARE * peak.nm => {
                self.open = None;
                self.least_nm = nm;
                self.add(peak);
            }
            Some(_) => {}
        }
    }

    fn add(&mut self, peak: Peak) {
        let last = self.train.last;
        let is_next = INTERVAL_S.contains(&(peak.time_s - last.time_s))
            && (peak.angle_rad - last.angle_rad).abs() <= HELD_RAD;
        self.train = if self.train.beats > 0 && is_next {
            Train {
                beats: self.train.beats.saturating_add(1),
                last: peak,
                ..self.train
            }
        } else {
            Train {
                beats: 1,
                first_s: peak.time_s,
                last: peak,
            }
        };
        if self.train.beats > self.longest.beats {
            self.longest = self.train;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The longest train of a torque by time, with the leg at an angle by time, °.
    fn train(deg: impl Fn(f64) -> f64, nm: impl Fn(f64) -> f64) -> Option<Train> {
        let mut beats = Beats::default();
        for tick in 0..40_000 {
            let time_s = f64::from(tick) * 5e-5;
            beats.take(time_s, deg(time_s).to_radians(), nm(time_s));
        }
        beats.longest()
    }

    /// Pushes for 45 % of each sixth of a second.
    fn clonus(t: f64) -> f64 {
        let share = (6.0 * t).fract() / 0.45;
        1.5 * (PI * share.min(1.0)).sin().max(0.0)
    }

    #[test]
    fn beats_are_counted_while_the_leg_is_held() {
        for sense in [1.0, -1.0] {
            let found = train(|t| 75.0 + (6.0 * t).sin(), |t| sense * clonus(t)).unwrap();
            assert_eq!(found.beats, 12);
            assert!((found.rate_hz().unwrap() - 6.0).abs() < 1e-3);
        }
        assert_eq!(train(|t| 60.0 * t, clonus), None);
    }

    #[test]
    fn teeth_grating_and_single_pushes_are_none() {
        let cogs = |t: f64| if (6.25 * t).fract() < 0.5 { 1.8 } else { 0.7 };
        assert_eq!(train(|_| 75.0, cogs), None);
        let grating = |t: f64| 0.6 + 0.6 * (30.0 * 2.0 * PI * t).sin();
        assert_eq!(train(|_| 75.0, grating), None);
        let pushes = |t: f64| if t.fract() < 0.3 { 2.0 } else { 0.0 };
        assert_eq!(train(|_| 75.0, pushes), None);
    }
}
