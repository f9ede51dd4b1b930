//! Walls, rigidity and texture where they are easily got wrong: grazes,
//! reversals, rests, and events that meet a knot of the motion.

use crate::support::{
    Given, TIME_S, TORQUE_NM, constant, events, given, jumps, knots, near, symptom, words,
};
use crepitus_scene::reference::symptoms::Word as Kind;

fn wall(k1: f64, k2: f64, loss: f64) -> Given {
    given(
        &[
            ("flexion_limit_deg", 100.0),
            ("stiffness_nm_per_rad", k1),
            ("stiffening_nm_per_rad2", k2),
            ("loss", loss),
        ],
        &[],
    )
}

#[test]
fn a_graze_of_a_wall_is_seen_however_short() {
    // φ = 100° + depth at t = 0.5, by a parabola of 40 deg/s per 0.5 s.
    for depth in [1e-5, 1e-7, 1e-9] {
        let from = (100.0_f64 - 10.0).to_radians() + depth;
        let motion = knots(from.to_degrees(), &[(0.0, 40.0), (1.0, -40.0)]);
        let found = events("range-limit", &wall(300.0, 0.0, 0.25), &motion, 1.0);
        assert_eq!(
            words(&found),
            ["contact", "turn", "slack", "leave"],
            "{depth}"
        );
        let half_s = (2.0 * depth / 80.0_f64.to_radians()).sqrt();
        // A graze knows its time to the rounding of the angle over its speed.
        near(found[0].time_s, 0.5 - half_s, 1e-15 / depth.sqrt());
        near(found[1].time_s, 0.5, 1e-12);
        near(found[1].torque_before_nm, 300.0 * depth, 1e-12);
        near(found[3].time_s, 0.5 + half_s, 1e-15 / depth.sqrt());
    }
    let motion = knots(90.0 - 1e-9, &[(0.0, 40.0), (1.0, -40.0)]);
    assert!(events("range-limit", &wall(300.0, 0.0, 0.25), &motion, 1.0).is_empty());
}

#[test]
fn a_slow_drift_onto_a_wall() {
    let motion = constant(99.99, 0.05);
    let found = events("range-limit", &wall(300.0, 0.0, 0.25), &motion, 30.0);
    assert_eq!(words(&found), ["contact", "cap"]);
    near(found[0].time_s, 0.2, TIME_S);
    near(
        found[1].time_s,
        0.2 + (4.0 / 300.0_f64).to_degrees() / 0.05,
        1e-8,
    );
}

#[test]
fn rest_on_a_wall_is_silent() {
    let motion = jumps(
        98.0,
        &[
            (0.0, 40.0, 40.0),
            (0.06, 40.0, 0.0),
            (1.0, 0.0, 40.0),
            (1.1, 40.0, 0.0),
            (2.0, 0.0, 0.0),
        ],
    );
    let found = events("range-limit", &wall(60.0, 400.0, 0.3), &motion, 3.0);
    assert_eq!(words(&found), ["contact", "cap"]);
    // At the wall itself, for as long as it is not passed.
    let motion = jumps(
        98.0,
        &[(0.0, 40.0, 40.0), (0.05, 40.0, 0.0), (1.0, 0.0, -40.0)],
    );
    assert!(events("range-limit", &wall(60.0, 400.0, 0.3), &motion, 2.0).is_empty());
}

#[test]
fn armed_inside_a_wall_there_is_no_push() {
    let motion = jumps(103.0, &[(0.0, 20.0, 20.0), (0.1, 20.0, -20.0)]);
    let mut limit = symptom("range-limit", &wall(60.0, 400.0, 0.3), &motion);
    near(limit.torque_nm(), 0.0, 0.0);
    let found = limit.advance(0.5);
    // The torque rises along σ to the cap, and goes back along σ.
    assert_eq!(words(&found), ["cap", "turn", "slack", "leave"]);
    let sigma = (60.0_f64 * 60.0 + 1600.0 * 4.0).sqrt() / 0.7;
    near(
        found[0].angle_rad,
        103.0_f64.to_radians() + 4.0 / sigma,
        1e-12,
    );
    near(
        found[2].angle_rad,
        105.0_f64.to_radians() - 4.0 / sigma,
        1e-12,
    );
    // Moved out at once it is slack without having had torque.
    let motion = constant(103.0, -20.0);
    let found = events("range-limit", &wall(60.0, 400.0, 0.3), &motion, 0.5);
    assert_eq!(words(&found), ["leave"]);
    near(found[0].torque_before_nm, 0.0, 0.0);
}

#[test]
fn beyond_the_cap_and_in_again_without_leaving() {
    let motion = jumps(
        99.0,
        &[
            (0.0, 50.0, 50.0),
            (0.2, 50.0, -50.0),
            (0.28, -50.0, 50.0),
            (0.5, 50.0, -50.0),
        ],
    );
    let found = events("range-limit", &wall(60.0, 400.0, 0.3), &motion, 1.0);
    let expected = [
        "contact", "cap", "turn", "slack", "take", "cap", "turn", "slack", "leave",
    ];
    assert_eq!(words(&found), expected);
    near(found[4].time_s, 0.28, TIME_S);
}

#[test]
fn both_limits_in_one_stroke() {
    let mut keys = wall(300.0, 0.0, 0.25);
    keys.numbers.push(("extension_limit_deg".to_owned(), 95.0));
    keys.numbers
        .push(("extension_stiffness_nm_per_rad".to_owned(), 100.0));
    let motion = jumps(94.0, &[(0.0, 30.0, 30.0), (0.25, 30.0, -30.0)]);
    let found = events("range-limit", &keys, &motion, 0.6);
    assert_eq!(
        words(&found),
        [
            "leave", "contact", "cap", "turn", "slack", "leave", "contact", "cap"
        ]
    );
    near(found[7].torque_after_nm, -4.0, TORQUE_NM);
    let p = (95.0_f64.to_radians() - found[7].angle_rad) * 100.0;
    near(p, 4.0, TORQUE_NM);
}

#[test]
fn a_torque_that_only_touches_its_limit_does_not_flow() {
    // To δ, rest, back; then to δ and on.
    let motion = jumps(
        40.0,
        &[
            (0.0, 10.0, 10.0),
            (0.15, 10.0, 0.0),
            (0.3, 0.0, -10.0),
            (0.4, -10.0, 10.0),
            (0.6, 10.0, 0.0),
        ],
    );
    let found = events("lead-pipe", &given(&[], &[]), &motion, 1.0);
    assert_eq!(words(&found), ["flow"]);
    near(found[0].time_s, 0.5, TIME_S);
}

#[test]
fn a_reversal_with_a_rest_is_one_turn_at_its_end() {
    let motion = knots(
        40.0,
        &[
            (0.0, 50.0),
            (0.2, 50.0),
            (0.3, 0.0),
            (0.7, 0.0),
            (0.8, -50.0),
            (1.2, -50.0),
        ],
    );
    let found = events("lead-pipe", &given(&[], &[]), &motion, 1.2);
    assert_eq!(words(&found), ["flow", "turn", "flow"]);
    near(found[1].time_s, 0.7, TIME_S);
    near(found[1].omega_rad_s, 0.0, 1e-12);
}

#[test]
fn cogwheel_at_rest_gives_once() {
    let motion = jumps(
        40.0,
        &[(0.0, 50.0, 50.0), (0.06, 50.0, 0.0), (0.6, 0.0, 50.0)],
    );
    let found = events("cogwheel", &given(&[], &[]), &motion, 0.62);
    assert_eq!(words(&found), ["flow", "give"]);
    near(found[1].time_s, 0.08, TIME_S);
    near(found[1].torque_after_nm, 0.8, TORQUE_NM);
    // The clock has gone on: 0.64 is a catch.
    let found = events("cogwheel", &given(&[], &[]), &motion, 0.65);
    assert_eq!(words(&found), ["flow", "give", "catch"]);
}

#[test]
fn cogwheel_without_a_low_phase_and_without_a_difference() {
    let motion = knots(40.0, &[(0.0, 50.0), (0.3, -80.0), (0.6, 50.0)]);
    let none = given(&[("low_share", 0.0)], &[]);
    let found = events("cogwheel", &none, &motion, 0.6);
    for e in found.iter().filter(|e| e.kind == Kind::Give) {
        near(e.torque_after_nm, 0.0, 0.0);
    }
    let all = given(&[("low_share", 1.0)], &[]);
    let found = events("cogwheel", &all, &motion, 0.6);
    let play: Vec<_> = found
        .iter()
        .filter(|e| matches!(e.kind, Kind::Flow | Kind::Turn))
        .copied()
        .collect();
    let pipe = given(&[("torque_nm", 2.0)], &[]);
    assert_eq!(
        words(&play),
        words(&events("lead-pipe", &pipe, &motion, 0.6))
    );
}

#[test]
fn tremble_across_a_tooth_does_not_jump() {
    // 7.5° is an edge from low to high, 11.25° one from high to low.
    let knot = |i: u32| {
        let side = if i.is_multiple_of(2) { 4.0 } else { -4.0 };
        (0.1 + 0.05 * f64::from(i), -side, side)
    };
    let mut all = vec![(0.0, 22.0, 22.0)];
    all.extend((1..8).map(knot));
    all[1].1 = 22.0;
    let motion = jumps(8.0, &all);
    let keys = given(&[], &[("mode", "space")]);
    let found = events("cogwheel", &keys, &motion, 0.5);
    let gives: Vec<_> = found.iter().filter(|e| e.kind == Kind::Give).collect();
    assert!(gives.len() > 2, "{:?}", words(&found));
    assert!(gives[0].torque_before_nm > 1.9 && gives[0].torque_after_nm < 0.81);
    for e in &found[2..] {
        near(e.torque_before_nm, e.torque_after_nm, TORQUE_NM);
    }
}

#[test]
fn tremble_on_an_asperity_is_one_snap() {
    let keys = given(&[("irregularity", 0.0)], &[]);
    let mut all = vec![(0.0, 10.0, 10.0)];
    // 1.5° is passed at 0.05 s; ±0.1° about it from then on.
    for i in 1..40_u32 {
        let side = if i.is_multiple_of(2) { 10.0 } else { -10.0 };
        all.push((0.04 + 0.02 * f64::from(i), -side, side));
    }
    let found = events("texture", &keys, &jumps(1.0, &all), 0.8);
    assert_eq!(words(&found), ["snap"]);
    near(found[0].time_s, 0.05, TIME_S);
}

#[test]
fn an_asperity_that_is_met_exactly_counts_once() {
    let keys = given(&[("irregularity", 0.0)], &[]);
    // Stops on 1.5°, rests, and goes on, or back.
    for (on, count) in [(10.0, 1), (-10.0, 0)] {
        let motion = jumps(
            1.0,
            &[
                (0.0, 10.0, 10.0),
                (0.05, 10.0, 0.0),
                (0.1, 0.0, on),
                (0.15, on, on),
            ],
        );
        assert_eq!(events("texture", &keys, &motion, 0.2).len(), count);
    }
    // A knot, or the end of the run, on it.
    let motion = knots(1.0, &[(0.0, 10.0), (0.05, 10.0), (0.1, 10.0)]);
    let mut texture = symptom("texture", &keys, &motion);
    let met = texture.advance(0.05).len();
    assert_eq!(met + texture.advance(0.15).len(), 1);
}
