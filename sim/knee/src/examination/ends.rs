//! Ends of the range: where the resistance of a stroke begins to rise, and the stroke ends.
//!
//! A stroke has met an end if, at its furthest, the leg resists by 0.8 N·m more than 3 to 10° before. The
//! end's angle is where that was reached first, as a goniometer is read: from straight, which is 0°
//! (Norkin and White, *Measurement of Joint Motion*). Its rise is an estimate.

use super::passages::place;

/// Rise that is an end, N·m, and what may be lost of it again while the leg is pressed on.
const RISE_NM: f64 = 0.8;
const LOST_NM: f64 = 0.4;

/// Way from a turn on which resistance may build up, °.
const SETTLING: usize = 5;

/// Degrees whose resistance is remembered, and the newest of them, which may be of the end.
const KEPT: usize = 10;
const NEWEST: usize = 3;

/// Fewer degrees before are no measure.
const LEAST: usize = 5;

/// Looks for the end of a stroke.
#[derive(Clone, Debug, Default)]
pub(super) struct Ends {
    /// Resistance at the last whole degrees of the way, newest first, N·m.
    at_degrees_nm: [f64; KEPT],
    /// Whole degrees of the way.
    degrees: usize,
    /// Furthest way, rad.
    furthest_rad: f64,
    met: Option<Met>,
}

/// An end that was met.
#[derive(Clone, Copy, Debug)]
struct Met {
    angle_rad: f64,
    /// Resistance before it, N·m.
    before_nm: f64,
}

impl Ends {
    /// The leg has turned: returns the angle at which it had met an end, rad.
    pub(super) fn turn(&mut self) -> Option<f64> {
        let met = self.met.take();
        (self.degrees, self.furthest_rad) = (0, 0.0);
        met.map(|met| met.angle_rad)
    }

    /// Takes a sample: way since the turn, angle, and torque against the movement.
    pub(super) fn take(&mut self, along_rad: f64, angle_rad: f64, resistance_nm: f64) {
        if along_rad <= self.furthest_rad {
            return;
        }
        self.furthest_rad = along_rad;
        let degrees = place(along_rad.to_degrees());
        if degrees > self.degrees {
            self.degrees = degrees;
            self.at_degrees_nm.rotate_right(1);
            if let Some(newest_nm) = self.at_degrees_nm.first_mut() {
                *newest_nm = resistance_nm;
            }
        }
        match self.met {
            None => {
                let before_nm = self.before_nm();
                self.met = before_nm
                    .filter(|before_nm| resistance_nm - before_nm >= RISE_NM)
                    .map(|before_nm| Met {
                        angle_rad,
                        before_nm,
                    });
            }
            // It was no end: it gave way.
            Some(met) if resistance_nm - met.before_nm < RISE_NM - LOST_NM => self.met = None,
            Some(_) => {}
        }
    }

    /// Mean resistance before the newest degrees, N·m.
    fn before_nm(&self) -> Option<f64> {
        let known = self.degrees.saturating_sub(SETTLING).min(KEPT);
        if known < LEAST {
            return None;
        }
        let before = self.at_degrees_nm.get(NEWEST..known)?;
        let (count, sum) = before
            .iter()
            .fold((0.0, 0.0), |(count, sum), nm| (count + 1.0, sum + nm));
        Some(sum / count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stroke to this angle and back, °, against this resistance; the angle of its end, °.
    fn end(to_deg: u32, nm: impl Fn(f64) -> f64) -> Option<f64> {
        let mut ends = Ends::default();
        let steps = 0..100 * to_deg;
        for step in steps.clone().chain(steps.rev().take(200)) {
            let deg = f64::from(step) * 0.01;
            ends.take(deg.to_radians(), deg.to_radians(), nm(deg));
        }
        ends.turn().map(f64::to_degrees)
    }

    /// As a contracture's: 60 N·m/rad from 70° on.
    fn wall(deg: f64) -> f64 {
        (60.0 * (deg - 70.0).to_radians()).clamp(0.0, 4.0)
    }

    #[test]
    fn an_end_is_where_its_resistance_is_met() {
        let found = end(74, wall).unwrap();
        // 0.8 N·m are 0.76° within.
        assert!((found - 70.76).abs() < 0.1, "{found}");
        let rigid = end(74, |deg| wall(deg) + (deg / 3.0).min(1.0) * 1.2).unwrap();
        assert!((rigid - 70.76).abs() < 0.1, "{rigid}");
        assert_eq!(end(70, wall), None);
    }

    #[test]
    fn what_gives_way_is_no_end() {
        assert_eq!(end(80, |_| 2.0), None);
        let blade = |deg: f64| if (deg - 50.0).abs() < 20.0 { 1.5 } else { 0.2 };
        assert_eq!(end(80, blade), None);
        let grating = |deg: f64| 0.6 + 0.5 * (deg * 7.0).sin();
        assert_eq!(end(80, grating), None);
    }
}
