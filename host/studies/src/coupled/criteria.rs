//! Theory for a cell: the largest stiffness, N·m/rad, by criteria that include
//! less than a simulation, and by the linear system without dry friction.
//!
//! | | criterion | includes |
//! |---|---|---|
//! | Colgate and Schenkel 1997 | kr < b/τ | damping b and lag τ, any hand |
//! | Abbott and Okamura 2005 | kr < min(2b/h, 2F/Δ) | a count Δ and dry friction F, no lag beyond the hold |
//! | Diolaiti et al. 2006 | kr < J·(F/(Ts·τ))² | dry friction against the speed of the swing |
//! | linear | the stiffness at which an oscillation neither grows nor dies | this hand, this cuff, no friction, no counts |
//!
//! The first is the original's form for τ = h/2, with lag added as in
//! Diolaiti's. The third is their observation, that dry friction dissipates more
//! than a late spring generates up to a certain speed, for this joint:
//! F·|Ω| ≥ kr·τ·Ω² holds up to F/(kr·τ), and a stick loaded to Ts cannot move a
//! rotor of inertia J faster than Ts/√(kr·J).

use super::setting::{Lag, Setting, TICK_S};
use crepitus_model::Parameters;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::render::effects::friction_compensation::least_left_nm;
use crepitus_plant::effect::Effect;
use crepitus_plant::effects::{cuff, drivetrain, hand};
use crepitus_plant::spectrum::Complex;
use std::f64::consts::TAU;

/// Largest stiffness by each criterion, N·m/rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criteria {
    /// Colgate and Schenkel.
    pub colgate_schenkel: f64,
    /// Abbott and Okamura.
    pub abbott_okamura: f64,
    /// Diolaiti et al.: dry friction.
    pub diolaiti: f64,
    /// The linear system; infinite without a limit in the searched range.
    pub linear: f64,
}

impl Criteria {
    /// The criteria for a cell, independent of its stiffness.
    pub fn of(setting: &Setting) -> Self {
        let b = setting.damping_nms_per_rad;
        let tau_s = setting.lag.mean_s();
        let friction_nm = setting.gear.left_nm().max(0.0);
        let count_rad = EncoderSettings::default().rad_per_count();
        let limit_nm = setting.preset.parameters.static_torque_nm;
        Self {
            colgate_schenkel: b / tau_s,
            abbott_okamura: (2.0 * b / TICK_S).min(2.0 * friction_nm / count_rad),
            diolaiti: shaft_inertia_kg_m2() * (friction_nm / (limit_nm * tau_s)).powi(2),
            linear: linear_onset(setting.lag, b),
        }
    }
}

/// The largest share of a gear's friction that may be compensated: the rest is
/// [`least_left_nm`].
pub fn most_share(setting: &Setting, friction_nm: f64) -> f64 {
    let joint = Parameters {
        stiffness_nm_per_rad: setting.stiffness_nm_per_rad,
        ..setting.preset.parameters
    };
    1.0 - least_left_nm(&joint, setting.lag.mean_s(), shaft_inertia_kg_m2()) / friction_nm
}

/// A default of an effect.
fn default(effect: &Effect, key: &str) -> f64 {
    let parameter = effect.parameters.iter().find(|p| p.key == key);
    parameter.map_or(f64::NAN, |p| p.default)
}

/// Inertia of rotor and brace, which are rigid, kg·m².
fn shaft_inertia_kg_m2() -> f64 {
    default(&drivetrain::EFFECT, "inertia_kg_m2") + default(&cuff::EFFECT, "brace_inertia_kg_m2")
}

/// Torque at the shaft for an angle there, of everything but the device, at an
/// angular frequency: rotor and brace, cuff, arm.
fn mechanics(w: f64, damping: f64) -> Complex<f64> {
    let square = default(&hand::EFFECT, "lever_m").powi(2);
    let of_hand = |key| default(&hand::EFFECT, key) * square;
    let arm = Complex::new(
        of_hand("stiffness_n_per_m") - of_hand("mass_kg") * w * w,
        of_hand("damping_ns_per_m") * w,
    );
    let link = Complex::new(default(&cuff::EFFECT, "stiffness_nm_per_rad"), damping * w);
    let through = link * arm / (link + arm);
    through + Complex::new(-shaft_inertia_kg_m2() * w * w, 0.0)
}

/// Transfer function from commanded to acting torque: held for a tick, and
/// behind a current loop that reduces its error by the share g in each.
fn device(w: f64, lag: Lag) -> Complex<f64> {
    let half = w * TICK_S / 2.0;
    let turned = |radians: f64| Complex::new(radians.cos(), radians.sin());
    let held = turned(-half) * Complex::new(half.sin() / half, 0.0);
    if lag == Lag::Ideal {
        return held;
    }
    let gain = lag.gain();
    let tick = turned(-w * TICK_S);
    let behind = Complex::new(1.0, 0.0) + tick * Complex::new(gain - 1.0, 0.0);
    held * (tick * Complex::new(gain, 0.0) / behind)
}

/// Stiffness at which an oscillation of this angular frequency is sustained;
/// only a real one exists.
fn balancing(w: f64, lag: Lag, damping: f64) -> Complex<f64> {
    -(mechanics(w, damping) / device(w, lag))
}

/// The lowest stiffness of a sustained oscillation, N·m/rad.
fn linear_onset(lag: Lag, damping: f64) -> f64 {
    // From an arm's own frequency to a tenth of the sampling rate.
    let (from, to, steps) = (1.0 * TAU, 2000.0 * TAU, 4000);
    let at = |n: u32| from * (to / from).powf(f64::from(n) / f64::from(steps));
    let mut least = f64::INFINITY;
    for n in 0..steps {
        let (mut low, mut high) = (at(n), at(n + 1));
        let rises = balancing(low, lag, damping).im < 0.0;
        if rises == (balancing(high, lag, damping).im < 0.0) {
            continue;
        }
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            if (balancing(middle, lag, damping).im < 0.0) == rises {
                low = middle;
            } else {
                high = middle;
            }
        }
        let stiffness = balancing(low, lag, damping).re;
        if stiffness > 0.0 {
            least = least.min(stiffness);
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::super::setting::{GEARS, LAGS};
    use super::*;

    /// The coupled system in the time domain: the exact mechanics would need a
    /// matrix exponential; semi-implicit Euler with steps of a hundredth of a
    /// tick is enough. Returns by how much its swing grows from the second half
    /// second to the fourth.
    fn growth(kr: f64, lag: Lag, damping: f64) -> f64 {
        let square = default(&hand::EFFECT, "lever_m").powi(2);
        let of_hand = |key| default(&hand::EFFECT, key) * square;
        let (m, c, k) = (
            of_hand("mass_kg"),
            of_hand("damping_ns_per_m"),
            of_hand("stiffness_n_per_m"),
        );
        let link = default(&cuff::EFFECT, "stiffness_nm_per_rad");
        let (mut x, mut v, mut y, mut u) = (1.0, 0.0, 0.0, 0.0);
        let (mut wanted, mut acting) = (0.0, 0.0);
        let mut widest = [0.0_f64; 4];
        let ticks = 40_000_u32;
        for n in 0..ticks {
            acting = match lag {
                Lag::Ideal => kr * x,
                Lag::Motor(_) => acting + lag.gain() * (wanted - acting),
            };
            wanted = kr * x;
            for _ in 0..100 {
                let h = TICK_S / 100.0;
                let cuff = link * (x - y) + damping * (v - u);
                v += h * (-acting - cuff) / shaft_inertia_kg_m2();
                u += h * (cuff - k * y - c * u) / m;
                x += h * v;
                y += h * u;
            }
            let quarter = usize::try_from(4 * n / ticks).unwrap();
            widest[quarter] = widest[quarter].max(x.abs());
        }
        widest[3] / widest[1]
    }

    #[test]
    fn at_the_linear_onset_a_swing_begins_to_grow() {
        for lag in LAGS {
            for damping in [0.0, 0.1] {
                let onset = linear_onset(lag, damping);
                assert!((5.0..1e4).contains(&onset), "{lag:?} {damping}: {onset}");
                let (below, above) = (
                    growth(0.9 * onset, lag, damping),
                    growth(1.1 * onset, lag, damping),
                );
                assert!(
                    below < 1.0 && above > 1.0,
                    "{lag:?} {damping}: {onset}, {below}, {above}"
                );
            }
        }
    }

    #[test]
    fn criteria_of_the_paper_s_joint() {
        let setting = Setting {
            gear: GEARS[0],
            ..Setting::shipped()
        };
        let criteria = Criteria::of(&setting);
        // Mean lag: half a tick and 3.71 ticks.
        assert!((setting.lag.mean_s() - 4.21 * TICK_S).abs() < 0.01 * TICK_S);
        assert!((criteria.colgate_schenkel - 1.0 / setting.lag.mean_s()).abs() < 1e-9);
        // 2·0.5/35.67e-6; of a damping of 1 it would be 40,000.
        assert!(
            (criteria.abbott_okamura - 28_030.0).abs() < 20.0,
            "{criteria:?}"
        );
        assert!(criteria.diolaiti > 1e6, "{criteria:?}");
        // 0.4 N·m · 210 µs · 81 rad/s are 6.8 mN·m.
        let share = most_share(&setting, 0.5);
        assert!((0.98..0.99).contains(&share), "{share}");
    }
}
