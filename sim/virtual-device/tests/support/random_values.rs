//! Parameters that somebody might set, and some that nobody may.

use crate::support::set;
use crepitus_protocol::Values;
use crepitus_protocol::parameters::PARAMETERS;
use fastrand::Rng;

/// A set that is allowed: joints from fine to heavy, effects on and off.
pub(crate) fn allowed(rng: &mut Rng, base: &Values) -> Values {
    let mut values = *base;
    let between = |rng: &mut Rng, low: f64, high: f64| low + (high - low) * rng.f64();
    let switch = |rng: &mut Rng| f64::from(u8::from(rng.bool()));
    let static_nm = between(rng, 0.2, 2.0);
    let stiffness = between(rng, 100.0, 800.0);
    let mut share = between(rng, 0.5, 0.999);
    let numbers = [
        ("crepitus.render", f64::from(u8::from(rng.u8(0..8) > 0))),
        ("crepitus.inertia_kg_m2", between(rng, 5e-4, 0.05)),
        ("crepitus.stiffness_nm_per_rad", stiffness),
        ("crepitus.static_torque_nm", static_nm),
        ("crepitus.kinetic_torque_nm", static_nm * share),
        ("crepitus.restart", switch(rng)),
        ("friction-compensation.render", switch(rng)),
        ("friction-compensation.share", 0.9 * rng.f64()),
        ("bone-shaping.render", switch(rng)),
        ("bone-shaping.gain", between(rng, 0.0, 2.0)),
        ("limits.torque_nm", between(rng, static_nm, 4.5)),
        ("limits.slew_nm_per_s", between(rng, 50.0, 100.0)),
    ];
    for (name, value) in numbers {
        set(&mut values, name, value);
    }
    // As near to Ts as the turn-back guard allows.
    while values.rad_per_count() > values.guarded_rad_per_count() {
        share = 0.5 + 0.9 * (share - 0.5);
        set(&mut values, "crepitus.kinetic_torque_nm", static_nm * share);
    }
    values
}

/// A set with one thing wrong.
pub(crate) fn forbidden(rng: &mut Rng, base: &Values) -> Values {
    let mut values = allowed(rng, base);
    match rng.u8(0..4) {
        0 => {
            let id = PARAMETERS[rng.usize(0..PARAMETERS.len())].id;
            let bad = [f64::NAN, f64::INFINITY, -1e5, 1e300];
            values.set(id, bad[rng.usize(0..bad.len())]);
        }
        1 => set(&mut values, "crepitus.kinetic_torque_nm", 2.5),
        2 => set(&mut values, "limits.torque_nm", 0.01),
        _ => set(&mut values, "crepitus.restart", 0.5),
    }
    values
}
