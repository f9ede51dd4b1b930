use super::*;
use crate::laws::Mounted;
use crate::laws::motion::{contact, creep, difference, runge_kutta, swung};
use crate::laws::object::OnObject;

type Law<F> = BlimanSorine<F>;

fn fitted(static_nm: f64, kinetic_nm: f64) -> BlimanSorineParameters {
    <Law<f64> as FrictionLaw<f64>>::fitted(&Contact {
        static_torque_nm: static_nm,
        kinetic_torque_nm: kinetic_nm,
        ..contact(0.0)
    })
}

fn law<F: Real>(static_nm: f64, kinetic_nm: f64) -> Law<F> {
    Law::new(&fitted(static_nm, kinetic_nm), 5e-5)
}

/// Largest torque over a travel that is long beside the bristles.
fn peak(law: &mut Law<f64>, travel: f64) -> f64 {
    (0..400_000)
        .map(|_| creep(law, travel).abs())
        .fold(0.0, f64::max)
}

const JOINTS: [(f64, f64); 6] = [
    (0.4, 0.2),
    (1.0, 0.99),
    (0.3, 0.01),
    (0.5, 0.0),
    (7.0, 3.0),
    (0.2, 0.2),
];

#[test]
fn the_peak_is_the_static_torque_and_sliding_the_kinetic_one() {
    for (static_nm, kinetic_nm) in JOINTS {
        let mut law = law::<f64>(static_nm, kinetic_nm);
        let slope = creep(&mut law, 1e-12) / 1e-12;
        assert!((slope / 400.0 - 1.0).abs() < 1e-8, "{slope}");
        let travel = 2e-4 * static_nm / 400.0;
        let found = peak(&mut law, travel);
        assert!(
            (found / static_nm - 1.0).abs() < 1e-6,
            "{found} {static_nm}"
        );
        let sliding = creep(&mut law, travel);
        assert!((sliding - kinetic_nm).abs() < 1e-6 * static_nm, "{sliding}");
        // In a reversal the peak is as far above Tk again.
        let largest = 2.0 * static_nm - kinetic_nm;
        let found = peak(&mut law, -travel);
        assert!((found / largest - 1.0).abs() < 1e-6, "{found} {largest}");
        let stated = fitted(static_nm, kinetic_nm).largest_nm();
        assert!((stated / largest - 1.0).abs() < 1e-12, "{stated}");
    }
}

#[test]
fn the_peak_comes_at_the_stated_travel() {
    let p = fitted(0.4, 0.2);
    let at = 2.0 * (2.0 * p.fast_nm / p.slow_nm).ln() / p.per_rad;
    assert!((at * 400.0 / 0.4 - 3.0).abs() < 0.05, "{at}");
    assert!((creep(&mut law::<f64>(0.4, 0.2), at) - 0.4).abs() < 1e-15);
    // In f32, and in many steps.
    let mut single = law::<f32>(0.4, 0.2);
    let torque = (0..10_000).fold(0.0, |_, _| creep(&mut single, at / 1e4));
    assert!((torque - 0.4).abs() < 2e-5, "{torque}");
}

#[test]
fn runge_and_kutta_find_the_same() {
    let p = fitted(0.4, 0.2);
    let rate = |v: f64, [fast, slow]: [f64; 2]| {
        let sign = if v < 0.0 { -1.0 } else { 1.0 };
        let ds = v.abs() * p.per_rad;
        [
            ds * (sign * p.fast_nm - fast),
            0.5 * ds * (-sign * p.slow_nm - slow),
        ]
    };
    let fine = runge_kutta(600, 400, rate);
    let fine: std::vec::Vec<f64> = fine.iter().map(|(_, [a, b])| a + b).collect();
    let gap = difference(&swung(&mut law::<f64>(0.4, 0.2), 600), &fine);
    // A step in which the shaft turns counts as its net travel.
    assert!(gap < 2e-4, "{gap}");
}

#[test]
fn velocity_and_step_do_not_enter() {
    let (mut slow, mut fast) = (law::<f32>(0.4, 0.2), law::<f32>(0.4, 0.2));
    fast.change(&fitted(0.4, 0.2), 1.0);
    for i in 0..500 {
        let travel = 1e-5 * (f64::from(i) * 0.1).sin();
        let shaft = ShaftStep {
            delta_phi_rad: f32::from_f64(travel),
            omega_start_rad_s: -3.0,
            omega_end_rad_s: 1e6,
        };
        let (a, b) = (creep(&mut slow, travel), fast.step(&shaft).to_f64());
        assert_eq!(a.to_bits(), b.to_bits());
    }
}

#[test]
fn a_change_keeps_the_torque_or_saturates_it() {
    let mut law = law::<f64>(0.4, 0.2);
    let before = creep(&mut law, 3e-3);
    assert!(before > 0.38);
    law.change(&fitted(0.9, 0.1), 5e-5);
    assert_eq!(creep(&mut law, 0.0), before);
    // No motion of this one shows more than 0.3 N·m.
    law.change(&fitted(0.2, 0.1), 5e-5);
    assert!((creep(&mut law, 0.0) - 0.3).abs() < 1e-15);
    law.change(&fitted(0.0, 0.0), 5e-5);
    assert_eq!((creep(&mut law, 0.0), creep(&mut law, 1.0)), (0.0, 0.0));
}

#[test]
fn on_an_object_it_comes_to_rest() {
    let joint = crepitus_model::Parameters::default();
    for omega in [0.01, 0.1, 0.5] {
        let mut object = OnObject::<f64, Law<f64>>::fitted(&joint, 5e-5, 0.0);
        let (mut start, mut largest) = (0.0, 0.0_f64);
        for i in 1..=100_000 {
            let end = omega * (f64::from(i) * 2.5e-5).min(1.0);
            let torque = object.step(&ShaftStep {
                delta_phi_rad: 0.5 * (start + end) * 5e-5,
                omega_start_rad_s: start,
                omega_end_rad_s: end,
            });
            start = end;
            largest = largest.max(torque);
            assert!(i < 60_000 || (torque - 0.2).abs() < 1e-6, "{torque}");
        }
        assert!(largest > 0.39, "{largest}");
    }
}
