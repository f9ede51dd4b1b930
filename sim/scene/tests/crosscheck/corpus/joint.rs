//! The joint of a case, with a suitable speed and duration.

use super::{MotionKind, log_uniform, uniform};
use crepitus_model::parameters::Tabled;
use crepitus_model::{Convention, Parameters, Restart, Settings, Validated};
use fastrand::Rng;
use std::f64::consts::{PI, TAU};

/// One case in so many is drawn from the whole ranges.
const EXTREME: u32 = 7;
/// The most that the object may swing in a case, rad, which limits its cost.
const MOST_SWING_RAD: f64 = 1e4;

/// Speed and duration of a case.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Typical highest speed, rad/s.
    pub(super) speed_rad_s: f64,
    /// Duration, s.
    pub(super) duration_s: f64,
}

pub(super) fn draw(
    rng: &mut Rng,
    convention: Convention,
    kind: MotionKind,
) -> Option<(Validated<Settings>, Scale)> {
    let [
        inertia_range,
        stiffness_range,
        damping_range,
        _,
        static_range,
    ] = Parameters::TABLE;
    let extreme = rng.u32(0..EXTREME) == 0;
    let (inertia, stiffness, limit) = if extreme {
        (
            log_uniform(rng, inertia_range.min, inertia_range.max),
            log_uniform(rng, stiffness_range.min, stiffness_range.max),
            // From 0 on; a logarithm needs a lower end.
            log_uniform(rng, 1e-9, static_range.max),
        )
    } else {
        (
            log_uniform(rng, 1e-6, 1.0),
            log_uniform(rng, 1.0, 1e5),
            log_uniform(rng, 1e-3, 1e2),
        )
    };
    let limit = if rng.u32(0..200) == 0 { 0.0 } else { limit };
    let kinetic = kinetic(rng, limit);
    let impedance = (inertia * stiffness).sqrt();
    let natural = (stiffness / inertia).sqrt();
    let drop = limit - kinetic;

    let speed_rad_s = if extreme {
        drop.max(0.1 * limit).max(1e-9) / (impedance * log_uniform(rng, 1e-6, 1e4))
    } else if rng.u32(0..10) < 7 {
        drop.max(0.1 * limit).max(1e-3) / (impedance * log_uniform(rng, 1e-3, 30.0))
    } else {
        log_uniform(rng, 1e-3, 10.0)
    };
    if !(1e-12..=1e6).contains(&speed_rad_s) {
        return None;
    }
    let lambda = drop / (speed_rad_s * impedance);
    let damping = match convention {
        Convention::Frozen => 0.0,
        _ => 2.0 * impedance * damping_ratio(rng, lambda, kind),
    };
    let cycle_s = (TAU + 2.0 * lambda) / natural;
    let cycles = log_uniform(rng, 2.0, 80.0);
    let duration_s = (cycles * cycle_s).min(MOST_SWING_RAD / natural);
    if !(1e-12..=1e7).contains(&duration_s) || damping > damping_range.max {
        return None;
    }
    let settings = Settings {
        parameters: Parameters {
            inertia_kg_m2: inertia,
            stiffness_nm_per_rad: stiffness,
            damping_nms_per_rad: damping,
            kinetic_torque_nm: kinetic,
            static_torque_nm: limit,
        },
        convention,
        restart: if convention == Convention::Frozen && rng.bool() {
            Restart::FromKinetic
        } else {
            Restart::Elastic
        },
    };
    let scale = Scale {
        speed_rad_s,
        duration_s,
    };
    settings.validate().ok().map(|settings| (settings, scale))
}

/// Tk between 0 and Ts, both ends and their neighbourhood included.
fn kinetic(rng: &mut Rng, limit: f64) -> f64 {
    match rng.u32(0..100) {
        0..12 => 0.0,
        12..20 => limit,
        20..28 => limit * (1.0 - 10.0_f64.powf(uniform(rng, -9.0, -2.0))),
        28..33 => 0.5 * limit,
        33..36 => limit * 10.0_f64.powf(uniform(rng, -9.0, -2.0)),
        _ => limit * rng.f64(),
    }
}

/// The damping ratio.
fn damping_ratio(rng: &mut Rng, lambda: f64, kind: MotionKind) -> f64 {
    match rng.u32(0..20) {
        0..9 => 0.0,
        // As near to critical damping as 16 digits go.
        9 => {
            1.0 + rng
                .choice([0.0, 1e-6, -1e-6, 1e-10, -1e-10, 1e-14, -1e-14])
                .unwrap_or(0.0)
        }
        // Near the value at which stick-slip ceases at constant speed.
        10 | 11 if kind == MotionKind::Constant && lambda < 0.3 => {
            let side = if rng.bool() { 1.0 } else { -1.0 };
            lambda * lambda / (4.0 * PI) * (1.0 + side * log_uniform(rng, 1e-8, 0.1))
        }
        _ => log_uniform(rng, 1e-5, 5.0),
    }
}
