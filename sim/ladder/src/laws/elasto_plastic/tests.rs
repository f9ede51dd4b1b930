use super::*;
use crate::laws::motion::{
    SLOW_RAD_S, STEP_S, at, bears_extremes, direct, on, on_object, rate_independent, run,
    runge_kutta_step, sudden, swing, travel,
};

type Law = ElastoPlastic<f64>;

#[test]
fn presliding_is_a_spring_up_to_its_share_of_the_static_torque() {
    let contact = direct();
    for sense in [1.0, -1.0] {
        let mut law: Law = on(&contact, STEP_S);
        let torque_nm = travel(&mut law, sense * 1e-6, 10);
        assert!(
            (torque_nm / (sense * 4e-4) - 1.0).abs() < 1e-12,
            "{torque_nm}"
        );
        let torque_nm = travel(&mut law, sense * (8.999e-4 - 1e-6), 999);
        assert!((torque_nm - sense * 0.35996).abs() < 1e-12, "{torque_nm}");
        assert!(travel(&mut law, -sense * 8.999e-4, 77).abs() < 1e-12);
    }
}

#[test]
fn break_away_is_at_the_static_torque_if_slow_and_at_the_kinetic_one_if_quick() {
    let contact = direct();
    let mut law: Law = on(&contact, STEP_S);
    let mut last_nm = 0.0;
    for _ in 0..25_000 {
        let torque_nm = travel(&mut law, 1e-6, 1);
        assert!(torque_nm >= last_nm && torque_nm <= 0.4, "{torque_nm}");
        last_nm = torque_nm;
    }
    assert!((last_nm - 0.4).abs() < 1e-8, "{last_nm}");
    let mut law: Law = on(&contact, STEP_S);
    for n in 0..4000 {
        let torque_nm = run(&mut law, 0.2, 1);
        assert!(torque_nm <= 0.2 + 1e-15, "{n}: {torque_nm}");
    }
}

#[test]
fn one_step_of_any_travel_ends_at_most_at_the_sliding_torque() {
    for (first_nm, travel_rad) in [(0.0, 5e-3), (0.3, 1e-3), (0.38, 1e-4), (-0.4, 0.1)] {
        let mut law: Law = on(&direct(), STEP_S);
        travel(&mut law, first_nm / 400.0, 100);
        let torque_nm = travel(&mut law, travel_rad, 1);
        assert!(torque_nm <= 0.4 && torque_nm > 0.38, "{torque_nm}");
    }
}

#[test]
fn a_deflection_that_is_too_large_decays_over_a_travel() {
    let mut law: Law = on(&direct(), STEP_S);
    travel(&mut law, 0.1, 10_000);
    // At 0.2 rad/s the curve has dropped to Tk: z_ss is 5e-4 rad.
    for n in 1..1000 {
        let torque_nm = run(&mut law, 0.2, 1);
        let expected_nm = 0.2 + 0.2 * Real::exp(-1e-5 * f64::from(n) / 5e-4);
        assert!(
            (torque_nm - expected_nm).abs() < 1e-12,
            "{n}: {torque_nm} {expected_nm}"
        );
    }
}

#[test]
fn steady_sliding_is_the_stribeck_curve() {
    for contact in [direct(), sudden(), on_object()] {
        for omega in [1e-5, 3e-4, 1e-3, 2e-3, 0.01, 0.3, 3.0, 20.0] {
            for sense in [1.0, -1.0] {
                let mut law: Law = on(&contact, STEP_S);
                travel(&mut law, sense * 0.1, 1000);
                for _ in 0..40 {
                    law.step(&at(sense * 1e-3, sense * omega));
                }
                let torque_nm = law.step(&at(sense * 1e-3, sense * omega));
                let expected_nm = sense * contact.sliding_nm(omega);
                assert!(
                    (torque_nm / expected_nm - 1.0).abs() < 1e-9,
                    "{omega}: {torque_nm}"
                );
            }
        }
    }
}

/// Loss of a load's torque after 100,000 cycles of tremor on it.
fn drift<F: Real>(elastic_share: f64, load_nm: f64, tremor_nm: f64, omega_rad_s: f64) -> f64 {
    let parameters = ElastoPlasticParameters {
        contact: direct(),
        elastic_share,
    };
    let mut law = ElastoPlastic::<F>::new(&parameters, STEP_S);
    let start_nm = law.step(&at(load_nm / 400.0, SLOW_RAD_S)).to_f64();
    let mut end_nm = F::ZERO;
    for _ in 0..100_000 {
        for part in [0.3, 0.7, -1.2, -0.8, 0.6, 0.4] {
            end_nm = law.step(&at(part * tremor_nm / 400.0, omega_rad_s * part));
        }
    }
    (start_nm - end_nm.to_f64()).abs()
}

#[test]
fn no_load_drifts_under_a_tremor_below_break_away() {
    // Slowly: up to 0.9·Ts. The travels of a cycle sum to their rounding only.
    assert!(drift::<f64>(ELASTIC_SHARE, 0.25, 0.1, SLOW_RAD_S) < 1e-11);
    // Quickly: up to 0.9·Tk.
    assert!(drift::<f64>(ELASTIC_SHARE, 0.1, 0.07, 1.0) < 1e-11);
    for (load_nm, tremor_nm) in [(0.25, 0.1), (0.29, 0.024), (0.2, 0.077), (0.13, 0.0095)] {
        let single_nm = drift::<f32>(ELASTIC_SHARE, load_nm, tremor_nm, SLOW_RAD_S);
        assert!(single_nm < 3e-4, "{single_nm}");
    }
    // Without the elastic part, nearly as in the LuGre law, nothing remains of the load.
    let plastic_nm = drift::<f64>(0.0, 0.25, 0.1, SLOW_RAD_S);
    assert!(plastic_nm > 0.2, "{plastic_nm}");
    // The known trap: above 0.9·Tk a quick tremor takes part of the load.
    assert!(drift::<f64>(ELASTIC_SHARE, 0.25, 0.1, 1.0) > 0.1);
}

/// Bristle torque by the classical Runge–Kutta method on the equations as published, in time.
struct Published {
    z_rad: f64,
    contact: Contact,
}

impl Published {
    fn rate(&self, z_rad: f64, omega: f64) -> f64 {
        let z_ss = self.contact.sliding_nm(omega) / self.contact.stiffness_nm_per_rad;
        let (z_ba, z_max, size) = (0.9 * z_ss, z_ss, z_rad.abs());
        let alpha = if z_rad * omega <= 0.0 || size <= z_ba {
            0.0
        } else if size >= z_max {
            1.0
        } else {
            let turn = core::f64::consts::PI * (size - 0.5 * (z_max + z_ba)) / (z_max - z_ba);
            0.5 + 0.5 * Real::sin_cos(turn).0
        };
        omega * (1.0 - alpha * z_rad / z_ss.copysign(omega))
    }

    /// A step of the motion, in `parts`.
    fn step(&mut self, omega_at: impl Fn(f64) -> f64, step_s: f64, parts: u32) {
        let h = step_s / f64::from(parts);
        for n in (0..parts).map(f64::from) {
            let rate = |t: f64, [z]: [f64; 1]| [self.rate(z, omega_at(t))];
            [self.z_rad] = runge_kutta_step(n * h, h, [self.z_rad], rate);
        }
    }
}

/// Largest and mean difference from the published equations on two swings, N·m.
fn difference(contact: &Contact, amplitude_rad: f64, rad_s: f64, step_s: f64) -> (f64, f64) {
    let mut law: Law = on(contact, step_s);
    let mut published = Published {
        z_rad: 0.0,
        contact: *contact,
    };
    let (mut largest, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
    for n in 0.. {
        let start = rad_s * step_s * f64::from(n);
        if start > 4.0 * core::f64::consts::PI {
            break;
        }
        let omega_at = |t: f64| amplitude_rad * rad_s * Real::sin_cos(start + rad_s * t).0;
        published.step(omega_at, step_s, 50);
        let torque_nm = law.step(&swing(amplitude_rad, rad_s, n, step_s));
        let error = (torque_nm - contact.stiffness_nm_per_rad * published.z_rad).abs();
        largest = largest.max(error);
        sum += error;
        count += 1.0;
    }
    (largest, sum / count)
}

#[test]
fn the_step_converges_to_the_published_equations() {
    // A swing over 6 Ts/σ0, with constant and with falling friction.
    for contact in [rate_independent(), direct()] {
        let errors = [4.0, 2.0, 1.0].map(|n| difference(&contact, 3e-3, 60.0, n * STEP_S / 4.0));
        let [coarse, _, fine] = errors;
        assert!(coarse.0 < 1e-4 && fine.0 < 6e-6, "{errors:?}");
        // Second order: a sixteenth at a quarter of the step.
        assert!(fine.1 < coarse.1 / 12.0, "{errors:?}");
    }
}

#[test]
fn the_torque_is_bounded_and_single_precision_follows() {
    for contact in [direct(), sudden(), on_object()] {
        for (amplitude_rad, rad_s) in [(1e-4, 100.0), (0.01, 50.0), (1.0, 20.0), (10.0, 2.0)] {
            let mut law: Law = on(&contact, STEP_S);
            let mut single: ElastoPlastic<f32> = on(&contact, STEP_S);
            for n in 0..40_000 {
                let torque_nm = law.step(&swing(amplitude_rad, rad_s, n, STEP_S));
                let single_nm = single
                    .step(&swing(amplitude_rad, rad_s, n, STEP_S))
                    .to_f64();
                assert!(torque_nm.abs() <= 0.6, "{torque_nm}");
                assert!(
                    (single_nm - torque_nm).abs() < 1e-5,
                    "{n}: {single_nm} {torque_nm}"
                );
            }
        }
        let mut law: Law = on(&contact, STEP_S);
        assert!((run(&mut law, 20.0, 100) - 0.2).abs() < 1e-12);
        assert!((run(&mut law, -20.0, 100) + 0.2).abs() < 1e-12);
    }
}

#[test]
fn damping_is_felt_while_the_deflection_changes() {
    let contact = sudden();
    let mut law: Law = on(&contact, STEP_S);
    let torque_nm = run(&mut law, 1e-3, 100);
    let vd = 2.0 * 0.2 / contact.damping_nms_per_rad;
    let damping = contact.damping_nms_per_rad / (1.0 + (1e-3 / vd).powi(2));
    let expected_nm = contact.stiffness_nm_per_rad * 5e-6 + damping * 1e-3;
    assert!(
        (torque_nm / expected_nm - 1.0).abs() < 1e-12,
        "{torque_nm} {expected_nm}"
    );
}

#[test]
fn other_parameters_keep_the_torque() {
    let mut law: Law = on(&direct(), STEP_S);
    let before_nm = travel(&mut law, 3e-4, 10);
    let contact = Contact {
        stiffness_nm_per_rad: 900.0,
        ..direct()
    };
    law.change(&<Law as FrictionLaw<f64>>::fitted(&contact), 1e-4);
    assert_eq!(law.step(&at(0.0, 0.0)), before_nm);
    let after_nm = law.step(&at(1e-5, SLOW_RAD_S));
    assert!((after_nm - before_nm - 900e-5).abs() < 1e-15);
}

#[test]
fn extreme_contacts_are_borne() {
    assert!(bears_extremes::<f64, ElastoPlastic<f64>>());
    assert!(bears_extremes::<f32, ElastoPlastic<f32>>());
}
