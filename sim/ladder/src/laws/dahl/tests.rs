use super::*;
use crate::laws::motion::{
    contact, creep, difference, drift, drift_of_bristles, runge_kutta, steady, swung,
};

const STIFFNESS: f64 = 400.0;
const SLIDING: f64 = 0.2;

fn law<F: Real>() -> Dahl<F> {
    Dahl::new(&<Dahl<F> as FrictionLaw<F>>::fitted(&contact(0.0)), 5e-5)
}

#[test]
fn a_stroke_is_the_closed_form() {
    let mut law = law::<f64>();
    let (mut at, mut from, mut torque) = (0.0, 0.0, 0.0);
    for (n, turn) in [(900, 1.0), (700, -1.0), (1100, 1.0)] {
        for i in 0..n {
            let travel = turn * 1e-6 * f64::from(1 + i % 7);
            torque = creep(&mut law, travel);
            at += travel;
            let level = turn * SLIDING;
            let left = (-STIFFNESS * (at * turn) / SLIDING).exp();
            let wanted = level + (from - level) * left;
            assert!((torque - wanted).abs() < 1e-13 * SLIDING, "{torque}");
        }
        (at, from) = (0.0, torque);
    }
}

#[test]
fn presliding_is_as_stiff_as_stated_and_sliding_is_at_its_level() {
    assert!((creep(&mut law::<f64>(), 1e-12) / 1e-12 / STIFFNESS - 1.0).abs() < 2e-9);
    assert!((creep(&mut law::<f32>(), 1e-9) / 1e-9 / STIFFNESS - 1.0).abs() < 2e-6);
    for omega in [1e-3, 1.0, -7.0] {
        let mut law = law::<f64>();
        let sliding = SLIDING.copysign(omega);
        for _ in 0..20 {
            steady(&mut law, omega, 1.0);
        }
        assert!((steady(&mut law, omega, 1.0) - sliding).abs() < 1e-16);
    }
}

/// Energy of a steady loop over the travel X: 2·Tc·(X − 2·Tc/σ0·tanh(σ0·X/(2·Tc))).
#[test]
fn the_loop_encloses_its_closed_form() {
    for end_to_end in [2e-5, 4e-4, 3e-3] {
        let mut law = law::<f64>();
        let n = 2000;
        let travel = end_to_end / f64::from(n);
        let mut before = 0.0;
        let mut energy = 0.0;
        // The first loops are not yet closed: each has exp(−2·σ0·X/Tc) of the gap of the one before.
        for round in 0..400 {
            energy = 0.0;
            for turn in [1.0, -1.0] {
                // Simpson's rule over pairs of steps.
                for _ in 0..n / 2 {
                    let middle = creep(&mut law, turn * travel);
                    let after = creep(&mut law, turn * travel);
                    energy += turn * travel / 3.0 * (before + 4.0 * middle + after);
                    before = after;
                }
            }
            if round == 20 && end_to_end > 1e-3 {
                break;
            }
        }
        let length = SLIDING / STIFFNESS;
        let tanh = (0.5 * end_to_end / length).tanh();
        let wanted = 2.0 * SLIDING * (end_to_end - 2.0 * length * tanh);
        assert!((energy / wanted - 1.0).abs() < 1e-9, "{end_to_end}");
    }
}

#[test]
fn runge_and_kutta_find_the_same() {
    let rate = |v: f64, [torque]: [f64; 1]| {
        let towards = if v < 0.0 { -torque } else { torque };
        [STIFFNESS * v * (1.0 - towards / SLIDING)]
    };
    let fine = runge_kutta(600, 400, rate);
    let fine: std::vec::Vec<f64> = fine.iter().map(|(_, [torque])| *torque).collect();
    // A step in which the shaft turns counts as its net travel: an error of second order.
    let gaps = [600, 2400].map(|steps: i32| {
        let every = usize::try_from(steps / 600).unwrap();
        let torque = swung(&mut law::<f64>(), steps);
        let at: std::vec::Vec<f64> = torque.into_iter().skip(every - 1).step_by(every).collect();
        difference(&at, &fine)
    });
    assert!(gaps[0] < 4e-4 && gaps[1] < 3e-5, "{gaps:?}");
}

#[test]
fn velocity_and_step_do_not_enter() {
    let (mut slow, mut fast) = (law::<f32>(), law::<f32>());
    fast.change(
        &DahlParameters {
            stiffness_nm_per_rad: STIFFNESS,
            sliding_nm: SLIDING,
        },
        1.0,
    );
    for i in 0..500 {
        let travel = 1e-5 * (f64::from(i) * 0.1).sin();
        let shaft = ShaftStep {
            delta_phi_rad: f32::from_f64(travel),
            omega_start_rad_s: -3.0,
            omega_end_rad_s: 1e6,
        };
        assert_eq!(
            creep(&mut slow, travel).to_bits(),
            fast.step(&shaft).to_f64().to_bits()
        );
    }
}

#[test]
fn a_varying_load_below_the_level_creeps() {
    let (low, high) = (0.6 * SLIDING, 0.9 * SLIDING);
    let found = drift(&mut law::<f64>(), low, high, 20);
    let wanted = drift_of_bristles(STIFFNESS, SLIDING, low, high);
    assert!((found / wanted - 1.0).abs() < 1e-3, "{found} {wanted}");
}

#[test]
fn a_change_keeps_the_torque_or_saturates_it() {
    let mut law = law::<f64>();
    let before = creep(&mut law, 5e-4);
    let other = |sliding_nm| DahlParameters {
        stiffness_nm_per_rad: 70.0,
        sliding_nm,
    };
    law.change(&other(0.5), 1e-4);
    assert_eq!(creep(&mut law, 0.0), before);
    law.change(&other(0.1), 1e-4);
    assert_eq!(creep(&mut law, 0.0), 0.1);
    law.change(&other(0.0), 1e-4);
    assert_eq!((creep(&mut law, 0.0), creep(&mut law, 1.0)), (0.0, 0.0));
    law.change(&other(0.5), 1e-4);
    assert!((creep(&mut law, 1e-9) / 70e-9 - 1.0).abs() < 1e-6);
}
