use super::*;
use crate::laws::motion::{
    SLOW_RAD_S, STEP_S, at, bears_extremes, direct, on, on_object, rate_independent, run, sudden,
    swing, travel,
};

type Law<const N: usize> = MaxwellSlip<f64, N>;

/// Break angles and stiffness of N equal springs that are 400 N·m/rad together and bear 0.4 N·m.
fn elements<const N: usize>() -> ([f64; N], f64) {
    let count = [1.0; N].iter().sum::<f64>();
    let mut place = 0.0;
    let angles = [(); N].map(|()| {
        place += 1.0;
        place * 2e-3 / (count + 1.0)
    });
    (angles, 400.0 / count)
}

fn first_loading<const N: usize>() {
    let (angles, stiffness) = elements::<N>();
    let strength_nm: f64 = angles.iter().map(|angle| stiffness * angle).sum();
    assert!((strength_nm - 0.4).abs() < 1e-15);
    for contact in [direct(), rate_independent()] {
        for sense in [1.0, -1.0] {
            let mut law: Law<N> = on(&contact, STEP_S);
            let torque_nm = travel(&mut law, sense * 1e-6, 10);
            assert!((torque_nm / (sense * 4e-4) - 1.0).abs() < 1e-12);
            // A polygon with its corners at the break angles, and flat beyond the last.
            let corners = angles.iter().map(|angle| angle / 1e-3);
            for x in (1..40).map(|n| 0.05 * f64::from(n)).chain(corners) {
                let expected_nm: f64 = angles.iter().map(|a| stiffness * a.min(1e-3 * x)).sum();
                let mut law: Law<N> = on(&contact, STEP_S);
                let torque_nm = travel(&mut law, sense * 1e-3 * x, 97);
                assert!((torque_nm - sense * expected_nm).abs() < 1e-12, "{x}");
            }
            let break_away_nm = travel(&mut law, sense * 2e-3, 1000);
            assert!((break_away_nm - sense * 0.4).abs() < 1e-12);
        }
    }
}

#[test]
fn the_first_loading_is_a_polygon_of_the_stated_corners() {
    first_loading::<4>();
    first_loading::<10>();
}

#[test]
fn an_inner_loop_closes_and_the_outer_one_goes_on() {
    let turns = [1.1e-3, -1.3e-3, 0.9e-3, -0.5e-3, 0.3e-3];
    let mut with: Law<10> = on(&rate_independent(), STEP_S);
    let mut without = with;
    let outer_nm = turns.map(|turn| travel(&mut with, turn, 31));
    // The last stroke is given back: its loop closes. A smaller one from there closes too.
    let [_, _, _, low_nm, _] = outer_nm;
    for stroke in [-0.3e-3, 0.2e-3, -0.2e-3] {
        let torque_nm = travel(&mut with, stroke, 7);
        let closes = stroke > 0.0 || (torque_nm - low_nm).abs() < 1e-14;
        assert!(closes, "{torque_nm} {low_nm}");
    }
    // From the point of return on, as without them.
    for turn in [1.1e-3, -1.3e-3, 0.9e-3, -0.5e-3] {
        travel(&mut without, turn, 31);
    }
    for _ in 0..30 {
        let difference_nm = travel(&mut with, 1e-4, 3) - travel(&mut without, 1e-4, 3);
        assert!(difference_nm.abs() < 1e-14, "{difference_nm}");
    }
}

#[test]
fn a_loop_dissipates_what_its_sliders_do() {
    let (angles, stiffness) = elements::<10>();
    for half_rad in [1e-4, 2e-4, 7e-4, 1.5e-3, 4e-3] {
        let mut law: Law<10> = on(&rate_independent(), STEP_S);
        let steps = 20_000;
        let mut last_nm = travel(&mut law, half_rad, steps);
        let mut work_j = 0.0;
        for sense in [-1.0, 1.0] {
            let one = sense * 2.0 * half_rad / f64::from(steps);
            for _ in 0..steps {
                let torque_nm = travel(&mut law, one, 1);
                work_j += 0.5 * (last_nm + torque_nm) * one;
                last_nm = torque_nm;
            }
        }
        let slides = angles
            .iter()
            .map(|a| 4.0 * stiffness * a * (half_rad - a).max(0.0));
        let expected_j: f64 = slides.sum();
        assert!(
            (work_j - expected_j).abs() < 1e-8 * (1e-4 + expected_j),
            "{work_j} {expected_j}"
        );
    }
}

/// Play operators: a spring's foot is dragged along where it would be longer than its break angle.
fn play<const N: usize>(feet_rad: &mut [f64; N], phi_rad: f64) -> f64 {
    let (angles, stiffness) = elements::<N>();
    let pairs = feet_rad.iter_mut().zip(angles);
    let springs = pairs.map(|(foot, angle)| {
        *foot = foot.clamp(phi_rad - angle, phi_rad + angle);
        stiffness * (phi_rad - *foot)
    });
    springs.sum()
}

#[test]
fn it_is_a_sum_of_play_operators_if_the_friction_is_constant() {
    let mut law: Law<10> = on(&rate_independent(), STEP_S);
    let mut feet = [0.0; 10];
    let (mut phi, mut random) = (0.0, 1_u32);
    for _ in 0..3000 {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let next = 4e-3 * (f64::from(random >> 8) / f64::from(1 << 24) - 0.5);
        // The operators see the turning points only.
        let torque_nm = travel(&mut law, next - phi, 1 + (random >> 28));
        phi = next;
        let expected_nm = play(&mut feet, phi);
        assert!(
            (torque_nm - expected_nm).abs() < 1e-12,
            "{torque_nm} {expected_nm}"
        );
    }
}

#[test]
fn steady_sliding_is_the_stribeck_curve_and_it_is_reached_by_attraction() {
    for contact in [direct(), sudden(), on_object()] {
        let parameters = <Law<4> as FrictionLaw<f64>>::fitted(&contact);
        for sense in [1.0, -1.0] {
            for omega in [1e-5, 3e-4, 1e-3, 2e-3, 0.01, 0.3, 20.0] {
                let mut law: Law<4> = on(&contact, STEP_S);
                travel(&mut law, sense * 0.1, 1000);
                for (target_omega, start_nm) in [(omega, 0.4), (0.0, contact.sliding_nm(omega))] {
                    let sliding_nm = contact.sliding_nm(target_omega);
                    let rate = parameters.attraction_nm_per_s / sliding_nm;
                    for n in 1..=20_000 {
                        let travel_rad = sense * 1e-9;
                        let torque_nm = law.step(&at(travel_rad, sense * target_omega));
                        let left = Real::exp(-rate * STEP_S * f64::from(n));
                        let expected_nm = sliding_nm + (start_nm - sliding_nm) * left;
                        let error_nm = (sense * torque_nm - expected_nm).abs();
                        assert!(error_nm < 1e-9, "{omega} {n}: {torque_nm} {expected_nm}");
                    }
                }
            }
        }
    }
}

#[test]
fn damping_is_felt_of_the_elements_in_stick() {
    let contact = Contact {
        damping_nms_per_rad: 0.5,
        ..rate_independent()
    };
    let (angles, stiffness) = elements::<4>();
    let elastic_nm = |x: f64| angles.iter().map(|a| stiffness * x.min(*a)).sum::<f64>();
    let mut law: Law<4> = on(&contact, STEP_S);
    let (omega, vd) = (0.7, 2.0 * 0.4 / 0.5);
    let damping = 0.5 / (1.0 + omega * omega / (vd * vd));
    for n in (0..100).map(f64::from) {
        let [from_nm, to_nm] = [n, n + 1.0].map(|n| elastic_nm(omega * STEP_S * n));
        let torque_nm = run(&mut law, omega, 1);
        let expected_nm = to_nm + damping * (to_nm - from_nm) / (400.0 * STEP_S);
        assert!(
            (torque_nm - expected_nm).abs() < 1e-12,
            "{n}: {torque_nm} {expected_nm}"
        );
    }
}

/// The equations as published, by explicit steps: torques and slips of N elements.
struct Published<const N: usize> {
    elements: [(f64, bool); N],
    contact: Contact,
    is_forward: bool,
}

impl<const N: usize> Published<N> {
    fn step(&mut self, omega: f64, h: f64) -> f64 {
        let (angles, stiffness) = elements::<N>();
        // σ0 and the swing of the object.
        let attraction = 400.0 * 0.1;
        let s = self.contact.sliding_nm(omega);
        let reverses = (omega > 0.0) != self.is_forward;
        self.is_forward = omega > 0.0;
        for ((torque_nm, slips), angle) in self.elements.iter_mut().zip(angles) {
            let share = stiffness * angle / 0.4;
            *slips &= !reverses;
            *slips |= *torque_nm * omega.signum() >= share * s;
            *torque_nm += h * if *slips {
                omega.signum() * attraction * (share - torque_nm.abs() / s)
            } else {
                stiffness * omega
            };
        }
        self.elements.iter().map(|(torque_nm, _)| torque_nm).sum()
    }
}

#[test]
fn the_step_follows_the_published_equations_while_friction_falls() {
    let contact = direct();
    let mut errors = [0.0_f64; 2];
    for (error, step_s) in errors.iter_mut().zip([STEP_S, STEP_S / 8.0]) {
        let mut law: Law<4> = on(&contact, step_s);
        let mut published = Published {
            elements: [(0.0, false); 4],
            contact,
            is_forward: true,
        };
        for n in 0..(0.2 / step_s).whole().try_into().unwrap() {
            let mut expected_nm = 0.0;
            for part in 0..40 {
                let time_s = step_s * (f64::from(n) + (f64::from(part) + 0.5) / 40.0);
                let omega = 3e-3 * 60.0 * Real::sin_cos(60.0 * time_s).0;
                expected_nm = published.step(omega, step_s / 40.0);
            }
            let torque_nm = law.step(&swing(3e-3, 60.0, n, step_s));
            *error = error.max((torque_nm - expected_nm).abs());
        }
    }
    let [coarse, fine] = errors;
    assert!(coarse < 5e-4 && fine < coarse / 4.0, "{errors:?}");
}

fn bounded<const N: usize>() {
    for contact in [direct(), sudden(), on_object()] {
        for (amplitude_rad, rad_s) in [(1e-4, 100.0), (0.01, 50.0), (1.0, 20.0), (10.0, 2.0)] {
            let mut law: Law<N> = on(&contact, STEP_S);
            let mut single: MaxwellSlip<f32, N> = on(&contact, STEP_S);
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
        let mut law: Law<N> = on(&contact, STEP_S);
        assert!((run(&mut law, 20.0, 10_000) - 0.2).abs() < 1e-12);
        assert!((run(&mut law, -20.0, 10_000) + 0.2).abs() < 1e-12);
    }
}

#[test]
fn the_torque_is_bounded_and_single_precision_follows() {
    bounded::<4>();
    bounded::<10>();
}

#[test]
fn other_parameters_keep_the_torque() {
    let mut law: Law<10> = on(&direct(), STEP_S);
    let before_nm = travel(&mut law, 1.5e-4, 10);
    let contact = Contact {
        stiffness_nm_per_rad: 900.0,
        ..direct()
    };
    law.change(&<Law<10> as FrictionLaw<f64>>::fitted(&contact), 1e-4);
    assert_eq!(law.step(&at(0.0, 0.0)), before_nm);
    let after_nm = law.step(&at(1e-6, SLOW_RAD_S));
    assert!((after_nm - before_nm - 900e-6).abs() < 1e-15);
}

#[test]
fn extreme_contacts_are_borne() {
    assert!(bears_extremes::<f64, MaxwellSlip<f64, 10>>());
    assert!(bears_extremes::<f32, MaxwellSlip<f32, 10>>());
}
