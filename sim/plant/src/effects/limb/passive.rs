//! The passive moment of muscles and ligaments, after Riener and Edrich.

use super::anchored::{self, Series};
use super::{AngleTorque, NAME};
use crate::energy_balance::{Account, EnergyBalance};

/// The passive moment.
#[derive(Clone, Copy, Debug)]
pub struct Passive {
    /// N·m at 0°, and growth per degree, of the three exponentials.
    terms: [(f64, f64); 3],
}

impl Passive {
    /// Riener's and Edrich's constant term, N·m.
    const CONSTANT_NM: f64 = -4.820;
    /// Ends of its range, deg.
    pub(super) const RANGE_DEG: (f64, f64) = (-20.0, 160.0);

    /// The passive moment for a hip bent by `hip_deg`, and the ankle at 0°.
    pub fn for_hip_deg(hip_deg: f64) -> Self {
        Self {
            terms: [
                ((1.800 + 0.0217 * hip_deg).exp(), -0.0352),
                (-(-3.971 - 0.0128 * hip_deg).exp(), 0.0495),
                (2.220_f64.exp(), -0.150),
            ],
        }
    }

    /// The moment, N·m, at a flexion of the knee.
    pub fn moment_nm(&self, angle_rad: f64) -> f64 {
        self.expand(angle_rad)[0]
    }

    /// The energy that it stores, J, against that at 0°.
    pub fn stored_j(&self, angle_rad: f64) -> f64 {
        let (low, high) = Self::RANGE_DEG;
        let within_rad = angle_rad.clamp(low.to_radians(), high.to_radians());
        let deg = within_rad.to_degrees();
        let mut stored = -Self::CONSTANT_NM * within_rad;
        for (at_zero, growth) in self.terms {
            stored -= at_zero * (growth * deg).exp_m1() / growth.to_degrees();
        }
        let [moment, slope, _] = self.expand(within_rad);
        let beyond = angle_rad - within_rad;
        stored - moment * beyond - 0.5 * slope * beyond * beyond
    }
}

impl AngleTorque for Passive {
    #[inline]
    fn expand(&self, angle_rad: f64) -> [f64; 3] {
        let (low, high) = Self::RANGE_DEG;
        let deg = angle_rad.to_degrees();
        let within = deg.clamp(low, high);
        let (mut moment, mut slope, mut bend) = (Self::CONSTANT_NM, 0.0, 0.0);
        for (at_zero, growth) in self.terms {
            let term = at_zero * (growth * within).exp();
            moment += term;
            slope += growth * term;
            bend += growth * growth * term;
        }
        let per_rad = 1.0_f64.to_degrees();
        let beyond = deg - within;
        [
            moment + slope * beyond,
            slope * per_rad,
            if beyond == 0.0 {
                bend * per_rad * per_rad
            } else {
                0.0
            },
        ]
    }

    fn series(&self, angle_rad: f64) -> Series {
        let mut series = [0.0; anchored::TERMS];
        series[0] = Self::CONSTANT_NM;
        for (at_zero, growth) in self.terms {
            let mut share = at_zero * (growth * angle_rad.to_degrees()).exp();
            for (k, sum) in series.iter_mut().enumerate() {
                *sum += anchored::term(k, &mut share, growth.to_degrees());
            }
        }
        series
    }

    fn energy(&self, angle_rad: f64, balance: &mut EnergyBalance) {
        balance.add(NAME, "passive", Account::Stored, self.stored_j(angle_rad));
    }

    fn range_rad(&self) -> (f64, f64) {
        let (low, high) = Self::RANGE_DEG;
        (low.to_radians(), high.to_radians())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of the domain report: hip, and the moment at seven flexions.
    #[test]
    fn the_passive_moment_is_that_of_riener_and_edrich() {
        const KNEE_DEG: [f64; 8] = [0.0, 10.0, 20.0, 40.0, 60.0, 90.0, 120.0, 140.0];
        for (hip, moments) in [
            (0.0, [10.4, 1.5, -1.4, -3.5, -4.5, -6.2, -11.9, -24.1]),
            (30.0, [16.0, 5.4, 1.3, -2.1, -3.7, -5.4, -9.5, -17.9]),
            (90.0, [47.0, 27.2, 16.7, 5.6, 0.2, -3.5, -6.5, -10.6]),
        ] {
            let passive = Passive::for_hip_deg(hip);
            for (knee, moment) in KNEE_DEG.into_iter().zip(moments) {
                let found = passive.moment_nm(knee.to_radians());
                assert!(
                    (found - moment).abs() < 0.051,
                    "{found} at {knee}, hip {hip}"
                );
            }
        }
        for (hip, zero) in [(0.0_f64, 13.9_f64), (30.0, 25.8), (90.0, 61.2)] {
            let passive = Passive::for_hip_deg(hip);
            let at = |deg: f64| passive.moment_nm(deg.to_radians());
            assert!(at(zero - 0.1) > 0.0 && at(zero + 0.1) < 0.0, "hip {hip}");
        }
    }

    #[test]
    fn what_the_passive_moment_stores_is_its_integral() {
        let passive = Passive::for_hip_deg(30.0);
        let mut integral = 0.0;
        let (from, to, n) = (-0.8_f64, 3.2_f64, 40_000);
        let h = (to - from) / f64::from(n);
        for i in 0..n {
            let at = from + (f64::from(i) + 0.5) * h;
            integral -= h * passive.moment_nm(at);
            let (low, high) = (at - 1e-6, at + 1e-6);
            let (low, high, [_, slope, bend]) = (
                passive.expand(low),
                passive.expand(high),
                passive.expand(at),
            );
            let differs = |i: usize, known: f64| {
                let found = (high[i] - low[i]) / 2e-6;
                (found - known).abs() > 1e-3 * (1.0 + known.abs())
            };
            assert!(!differs(0, slope) && !differs(1, bend), "at {at}");
        }
        let stored = passive.stored_j(to) - passive.stored_j(from);
        assert!(
            (stored - integral).abs() < 1e-5 * integral.abs(),
            "{stored} {integral}"
        );
        assert_eq!(passive.stored_j(0.0), 0.0);
    }
}
