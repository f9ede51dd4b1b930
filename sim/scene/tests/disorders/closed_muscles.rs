//! Properties of spasticity, clasp-knife and clonus that are known in closed form.

use crate::any_symptom::motions;
use crate::support::{
    Given, TIME_S, TORQUE_NM, constant, events, given, jumps, near, symptom, torque_at, words,
};

/// MAS 2.
fn mas(lambda: f64, b: f64, r: f64, k: f64) -> Given {
    given(
        &[
            ("threshold_deg", lambda),
            ("velocity_torque_nms_per_rad", b),
            ("residual_share", r),
            ("stiffness_nm_per_rad", k),
        ],
        &[("form", "catch")],
    )
}

#[test]
fn catches_come_earlier_and_stronger_the_faster_the_stretch() {
    for (keys, table) in [
        (
            mas(110.0, 0.385, 0.0, 0.0),
            [(90.0, 87.5, 0.60), (130.0, 77.5, 0.87), (350.0, 22.5, 2.35)],
        ),
        (
            mas(95.0, 0.527, 0.25, 0.5),
            [(90.0, 72.5, 0.83), (130.0, 62.5, 1.20), (350.0, 7.5, 3.22)],
        ),
        (
            mas(75.0, 0.67, 0.5, 1.0),
            [(90.0, 52.5, 1.05), (130.0, 42.5, 1.52), (350.0, 5.0, 4.09)],
        ),
        (
            mas(50.0, 0.956, 0.7, 2.0),
            [(90.0, 27.5, 1.50), (130.0, 17.5, 2.17), (350.0, 5.0, 4.50)],
        ),
    ] {
        for (speed, angle, peak) in table {
            let motion = constant(5.0, speed);
            let found = events("spasticity", &keys, &motion, 1.2);
            assert_eq!(words(&found)[0], "catch");
            near(found[0].angle_rad.to_degrees(), angle, 1e-9);
            near(found[0].peak_nm.unwrap(), peak, 0.005);
        }
        assert!(events("spasticity", &keys, &constant(5.0, 30.0), 4.0).is_empty());
    }
}

#[test]
fn a_catch_decays_to_its_residual() {
    let keys = mas(75.0, 0.67, 0.5, 1.0);
    let motion = constant(5.0, 90.0);
    let found = events("spasticity", &keys, &motion, 1.2);
    assert_eq!(words(&found), ["catch", "flow"]);
    let peak = 0.67 * 90.0_f64.to_radians();
    let after = found[1].time_s - found[0].time_s;
    let travel = 90.0_f64.to_radians() * after;
    near(60.0 * travel, found[1].torque_before_nm, TORQUE_NM);
    for later in [after, 0.05, 0.3, 0.6] {
        let u = peak * (0.5 + 0.5 * (-later / 0.06).exp()) + 90.0_f64.to_radians() * later;
        let torque = torque_at("spasticity", &keys, &motion, found[0].time_s + later);
        near(torque, u, TORQUE_NM);
    }
}

fn reflex(numbers: &[(&str, f64)]) -> Given {
    given(numbers, &[("form", "reflex")])
}

/// y = ∫u(t − τ_d − x)·e^(−x/τ_a)/τ_a dx, by Gauss's rule with four points on
/// parts between the knots and the events, where u is smooth.
#[test]
fn a_reflex_is_the_convolution_of_its_input() {
    const PARTS: u32 = 400;
    const POINTS: [(f64, f64); 4] = [
        (-0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
        (-0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
    ];
    let (k, mu, lambda) = (6.0, 0.2, 35.0_f64);
    let (delay_s, activation_s, cap) = (0.037, 0.021, 2.5);
    let keys = reflex(&[
        ("threshold_deg", lambda),
        ("velocity_shift_s", mu),
        ("gain_nm_per_rad", k),
        ("delay_s", delay_s),
        ("activation_s", activation_s),
        ("torque_nm", cap),
    ]);
    let mut events_seen = 0;
    for motion in &motions() {
        for end_s in [0.2, 0.55, 0.9, 1.3, 1.71, 2.6] {
            let input_s = end_s - delay_s;
            let mut reflex = symptom("spasticity", &keys, motion);
            let found = reflex.advance(end_s);
            events_seen += found.len();
            let mut marks: Vec<_> = found.iter().map(|e| e.time_s).collect();
            let mut time_s = 0.0;
            while time_s < input_s {
                marks.push(time_s);
                time_s = motion.piece(time_s).end_s;
            }
            marks.push(input_s);
            marks.retain(|t| *t <= input_s);
            marks.sort_by(f64::total_cmp);
            let mut y = 0.0;
            for span in marks.windows(2) {
                let part_s = (span[1] - span[0]) / f64::from(PARTS);
                for i in 0..PARTS {
                    for (place, weight) in POINTS {
                        let t = span[0] + part_s * (f64::from(i) + 0.5 + 0.5 * place);
                        let shaft = motion.at(t);
                        let lead = shaft.phi_rad - lambda.to_radians() + mu * shaft.omega_rad_s;
                        let left = (-(input_s - t) / activation_s).exp() / activation_s;
                        y += 0.5 * part_s * weight * left * (k * lead).clamp(0.0, cap);
                    }
                }
            }
            near(reflex.torque_nm(), y, 1e-11);
        }
    }
    assert!(events_seen > 50, "{events_seen}");
}

#[test]
fn a_reflex_reaches_and_leaves_its_cap_at_known_angles() {
    let keys = reflex(&[("gain_nm_per_rad", 10.0), ("torque_nm", 4.5)]);
    let motion = jumps(30.0, &[(0.0, 100.0, 100.0), (0.9, 100.0, -100.0)]);
    let found = events("spasticity", &keys, &motion, 1.5);
    // 27° of shift at 100 deg/s; on the way back it is the other way.
    assert_eq!(words(&found), ["onset", "cap", "uncap", "offset"]);
    let lead = 0.45_f64.to_degrees();
    near(found[0].angle_rad.to_degrees(), 48.0, 1e-9);
    near(found[1].angle_rad.to_degrees(), 48.0 + lead, 1e-9);
    near(found[2].time_s, 0.9, TIME_S);
    near(found[3].angle_rad.to_degrees(), 102.0, 1e-9);
}

#[test]
fn clasp_knife_is_released_by_torque_too() {
    let keys = given(&[], &[("trigger", "torque")]);
    let found = events("clasp-knife", &keys, &constant(10.0, 60.0), 1.5);
    assert_eq!(words(&found), ["onset", "flow", "release"]);
    near(found[2].torque_before_nm, 2.5, TORQUE_NM);
    near(found[2].angle_rad, 30.0_f64.to_radians() + 1.7 / 3.0, 1e-12);
}
