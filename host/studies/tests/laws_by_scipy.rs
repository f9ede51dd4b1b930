//! Friction laws against a second implementation: the equations of the papers, solved by SciPy.
//!
//! `laws_by_scipy/laws.py` made `laws_by_scipy/laws.csv`. It has another method (DOP853 and Radau of
//! adaptive step, not one step a tick) and no code of ours; it shares the rule of the fit. On an object it
//! checks the coupling, too: its equations are solved together.

use crepitus_ladder::laws::ENTRIES;
use crepitus_model::{Parameters, ShaftStep};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

const TABLE: &str = include_str!("laws_by_scipy/laws.csv");

/// The motions of the script: three break angles at 2 Hz from rest, and 0.2 rad/s.
const AMPLITUDE_RAD: f64 = 3e-3;
const HZ: f64 = 2.0;
const DRAG_RAD_S: f64 = 0.2;

/// Times and torques by law.
fn table() -> BTreeMap<&'static str, Vec<(f64, f64)>> {
    let mut laws: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for line in TABLE.lines().skip(1) {
        let [law, t_s, torque_nm] = line.split(',').collect::<Vec<_>>()[..] else {
            panic!("{line}");
        };
        let point = (t_s.parse().unwrap(), torque_nm.parse().unwrap());
        laws.entry(law).or_default().push(point);
    }
    laws
}

fn pose(is_dragged: bool, t_s: f64) -> (f64, f64) {
    if is_dragged {
        return (DRAG_RAD_S * t_s, DRAG_RAD_S);
    }
    let (sin, cos) = (TAU * HZ * t_s).sin_cos();
    (AMPLITUDE_RAD * (1.0 - cos), AMPLITUDE_RAD * TAU * HZ * sin)
}

/// Root mean square and largest difference of a law from its table in steps of `step_s`, N·m.
fn differences(name: &str, points: &[(f64, f64)], step_s: f64) -> (f64, f64) {
    let is_dragged = name.ends_with("-object");
    let entry = ENTRIES.iter().find(|entry| entry.name == name).unwrap();
    let (mut from, mut n) = (pose(is_dragged, 0.0), 0_u32);
    let joint = Parameters::default();
    let mut law = entry.double(&joint, step_s, from.1).unwrap();
    let (mut squares, mut largest, mut torque_nm) = (0.0, 0.0_f64, 0.0);
    for (t_s, wanted_nm) in points {
        while f64::from(n) * step_s < t_s - 0.5 * step_s {
            n += 1;
            let to = pose(is_dragged, f64::from(n) * step_s);
            torque_nm = law.step(&ShaftStep {
                delta_phi_rad: to.0 - from.0,
                omega_start_rad_s: from.1,
                omega_end_rad_s: to.1,
            });
            from = to;
        }
        let off = torque_nm - wanted_nm;
        squares += off * off;
        largest = largest.max(off.abs());
    }
    let count: f64 = points.iter().map(|_| 1.0).sum();
    (f64::sqrt(squares / count), largest)
}

#[test]
fn laws_converge_to_what_scipy_finds() {
    let table = table();
    // Largest difference in steps of 50 µs and of a 64th of it, beside Ts.
    let known = [
        ("dahl", "dahl", 1e-8, 1e-8),
        ("elasto-plastic", "elasto-plastic", 2e-6, 1e-8),
        ("elasto-plastic-object", "elasto-plastic-object", 0.3, 5e-3),
        ("lugre", "lugre-exponential", 1e-3, 1e-5),
        ("lugre-exponential", "lugre-exponential", 1e-7, 1e-8),
        (
            "lugre-exponential-object",
            "lugre-exponential-object",
            0.1,
            2e-3,
        ),
        // Diverges at 50 µs.
        (
            "lugre-object",
            "lugre-exponential-object",
            f64::INFINITY,
            1e-3,
        ),
        // A torque that falls by Ts within a millisecond is a tick late.
        ("tanh-object", "tanh-object", 1.0, 2e-2),
    ];
    let mut wrong = Vec::new();
    for (name, solved, coarse_most, fine_most) in known {
        let points = &table[solved];
        assert_eq!(points.len(), 100);
        let [coarse, middle, fine] = [1.0, 16.0, 64.0].map(|n| differences(name, points, 5e-5 / n));
        let order = 0.5 * (middle.0 / fine.0).log2();
        println!(
            "{name}: {:.1e}, {:.1e}, {:.1e} N·m rms, {:.1e} and {:.1e} N·m at most, order {order:.2}",
            coarse.0, middle.0, fine.0, coarse.1, fine.1
        );
        let ts = Parameters::default().static_torque_nm;
        // The table has nine digits after the point.
        let converges = order > 0.9 || fine.1 < 1e-9;
        if !(converges && fine.1 < fine_most * ts && coarse.1 < coarse_most * ts) {
            wrong.push(name);
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}
