//! Spasticity, clasp-knife and clonus where they are easily got wrong.

use crate::support::{
    Given, TIME_S, TORQUE_NM, constant, events, given, jumps, knots, near, symptom, times, words,
};
use crepitus_plant::Motion;
use crepitus_scene::reference::symptoms::Word as Kind;

fn catch(numbers: &[(&str, f64)]) -> Given {
    given(numbers, &[("form", "catch")])
}

#[test]
fn dither_about_the_threshold_is_one_catch() {
    let mut all = vec![(0.0, 38.0)];
    all.extend((1..100_u32).map(|i| {
        (
            0.02 * f64::from(i),
            if i.is_multiple_of(2) { 38.0 } else { 42.0 },
        )
    }));
    let found = events("spasticity", &catch(&[]), &knots(20.0, &all), 1.9);
    assert_eq!(times(&found, Kind::Catch).len(), 1);
    assert!(times(&found, Kind::Rearm).is_empty());
    // The first time that both hold: at 40 deg/s within a rise, or on the line.
    let speed = found[0].omega_rad_s.to_degrees();
    let lead = found[0].angle_rad.to_degrees() + 0.25 * speed;
    assert!(
        speed >= 40.0 - 1e-9 && lead >= 75.0 - 1e-9,
        "{speed} {lead}"
    );
}

#[test]
fn what_comes_last_decides_a_catch() {
    // Slow beyond λ, then faster: the velocity.
    let motion = knots(60.0, &[(0.0, 20.0), (1.0, 20.0), (2.0, 60.0)]);
    let found = events("spasticity", &catch(&[]), &motion, 2.0);
    near(found[0].time_s, 1.5, TIME_S);
    near(
        found[0].peak_nm.unwrap(),
        0.67 * 40.0_f64.to_radians(),
        TORQUE_NM,
    );
    // A jump of the velocity, to exactly the threshold.
    let motion = jumps(60.0, &[(0.0, 20.0, 20.0), (1.0, 20.0, 40.0)]);
    let found = events("spasticity", &catch(&[]), &motion, 1.1);
    near(found[0].time_s, 1.0, 0.0);
    near(found[0].omega_rad_s.to_degrees(), 40.0, 1e-12);
    // The angle, at a constant velocity.
    let found = events("spasticity", &catch(&[]), &constant(20.0, 90.0), 1.0);
    near(found[0].time_s, 32.5 / 90.0, TIME_S);
    // Fast enough only where it is not stretched enough: none.
    let motion = knots(0.0, &[(0.0, 45.0), (0.4, 45.0), (0.5, 35.0), (2.0, 35.0)]);
    assert!(events("spasticity", &catch(&[]), &motion, 2.0).is_empty());
}

#[test]
fn a_short_visit_to_the_threshold_velocity_is_a_catch() {
    // The peak of a parabola of Ω is not on hand: of a knot it is, and of a sine.
    let peak = 40.0_f64.to_radians();
    for (excess, count) in [(1e-9, 1), (-1e-9, 0)] {
        let amplitude = peak * (1.0 + excess) / std::f64::consts::TAU;
        let keys = catch(&[("threshold_deg", -30.0)]);
        let motion = Motion::sine(amplitude, 1.0, 180.0);
        let found = events("spasticity", &keys, &motion, 1.0);
        assert_eq!(times(&found, Kind::Catch).len(), count, "{excess}");
    }
}

#[test]
fn a_retreat_short_of_the_rearming_is_no_second_catch() {
    for (back_s, count) in [(0.099, 1), (0.101, 2)] {
        // Catches at 32.5 + 15 = 47.5°… then back by 10° less or more.
        let up_s = 0.3;
        let motion = jumps(
            30.0,
            &[
                (0.0, 100.0, 100.0),
                (up_s, 100.0, -100.0),
                (up_s + 0.1 + back_s, -100.0, 100.0),
            ],
        );
        let found = events("spasticity", &catch(&[]), &motion, 1.0);
        near(found[0].angle_rad.to_degrees(), 50.0, 1e-9);
        assert_eq!(times(&found, Kind::Catch).len(), count, "{back_s}");
    }
}

#[test]
fn a_jump_through_the_whole_reflex_is_two_events() {
    let keys = given(
        &[("gain_nm_per_rad", 20.0), ("torque_nm", 1.0)],
        &[("form", "reflex")],
    );
    let motion = jumps(
        60.0,
        &[(0.0, 0.0, 0.0), (0.3, 0.0, 100.0), (0.4, 100.0, -100.0)],
    );
    let found = events("spasticity", &keys, &motion, 1.0);
    assert_eq!(words(&found), ["onset", "cap", "uncap", "offset"]);
    let expected = [0.3, 0.3, 0.4, 0.4];
    for (e, time_s) in found.iter().zip(expected) {
        near(e.time_s, time_s, 0.0);
    }
    // y rises to the cap from 0.35 on and falls from 0.45 on.
    let mut reflex = symptom("spasticity", &keys, &motion);
    for (time_s, y) in [
        (0.35, 0.0),
        (0.38, 1.0 - (-3.0_f64).exp()),
        (0.45, 1.0 - (-10.0_f64).exp()),
        (0.47, (1.0 - (-10.0_f64).exp()) * (-2.0_f64).exp()),
    ] {
        reflex.advance(time_s);
        near(reflex.torque_nm(), y, 1e-12);
    }
}

#[test]
fn a_clasp_knife_turned_back_does_not_fall() {
    let keys = given(&[], &[]);
    let motion = jumps(
        20.0,
        &[
            (0.0, 60.0, 60.0),
            (0.9, 60.0, -60.0),
            (1.2, -60.0, 60.0),
            (2.0, 60.0, 60.0),
        ],
    );
    // Turned back at 74°, and on again.
    let found = events("clasp-knife", &keys, &motion, 1.6);
    assert_eq!(
        words(&found),
        ["onset", "flow", "turn", "slack", "take", "flow", "release"]
    );
    near(found[6].angle_rad.to_degrees(), 75.0, 1e-9);
    // A creep through it.
    let motion = jumps(29.0, &[(0.0, 60.0, 60.0), (0.75, 60.0, 0.5)]);
    let found = events("clasp-knife", &keys, &motion, 3.0);
    assert_eq!(words(&found), ["onset", "flow", "release"]);
    near(found[2].time_s, 2.75, TIME_S);
    // No second blade after a retreat of 30°; one after 56° to 19°.
    for (back_s, words_after) in [(0.5, 1), (0.95, 2)] {
        let motion = jumps(
            20.0,
            &[
                (0.0, 60.0, 60.0),
                (1.0, 60.0, -60.0),
                (1.0 + back_s + 0.1, -60.0, 60.0),
            ],
        );
        let found = events("clasp-knife", &keys, &motion, 4.0);
        assert_eq!(times(&found, Kind::Release).len(), words_after);
    }
}

#[test]
fn a_clasp_knife_released_on_its_rise_meets_the_falling_limit() {
    let keys = given(
        &[
            ("catch_stiffness_nm_per_rad", 10.0),
            ("release_deg", 33.0),
            ("onset_torque_nm", 0.8),
        ],
        &[],
    );
    let motion = constant(29.0, 60.0);
    let found = events("clasp-knife", &keys, &motion, 0.5);
    assert_eq!(words(&found), ["onset", "release", "flow"]);
    let release_nm = 10.0 * 3.0_f64.to_radians();
    near(found[1].torque_after_nm, release_nm, TORQUE_NM);
    let level_nm = 0.8 + 3.0 * 3.0_f64.to_radians();
    let left = 0.15 + 0.85 * (-(found[2].time_s - found[1].time_s) / 0.03).exp();
    near(found[2].torque_after_nm, level_nm * left, TORQUE_NM);
    // Turned back before it has flowed: back where it began.
    let motion = jumps(29.0, &[(0.0, 20.0, 20.0), (0.075, 20.0, -20.0)]);
    let found = events("clasp-knife", &keys, &motion, 0.3);
    assert_eq!(words(&found), ["onset", "back"]);
}

#[test]
fn clonus_passes_over_a_slow_crossing() {
    let keys = given(&[], &[]);
    // Slow through 60°, fast beyond it, back to 56°, fast again; then to 54°.
    let motion = knots(
        55.5,
        &[
            (0.0, 50.0),
            (0.2, 50.0),
            (0.3, 200.0),
            (0.4, 0.0),
            (0.5, -200.0),
            (0.6, -200.0),
            (0.61, 0.0),
            (0.8, 200.0),
            (1.2, 200.0),
        ],
    );
    let angle = motion.at(0.61).phi_rad.to_degrees();
    assert!(angle > 55.0, "{angle}");
    assert!(events("clonus", &keys, &motion, 1.2).is_empty());
    // A touch of 60° is no crossing, and the stretch after it starts.
    let motion = jumps(
        56.0,
        &[
            (0.0, 200.0, 200.0),
            (0.02, 200.0, -10.0),
            (0.12, -10.0, 200.0),
            (0.5, 200.0, 0.0),
        ],
    );
    let found = events("clonus", &keys, &motion, 0.2);
    assert_eq!(words(&found), ["start", "beat"]);
    near(found[0].time_s, 0.125, TIME_S);
}

#[test]
fn a_beat_under_way_runs_out_after_the_stop() {
    let keys = given(&[], &[]);
    let motion = jumps(
        50.0,
        &[
            (0.0, 200.0, 200.0),
            (0.1, 200.0, -250.0),
            (0.3, -250.0, 0.0),
        ],
    );
    let found = events("clonus", &keys, &motion, 2.0);
    assert_eq!(words(&found), ["start", "beat", "stop"]);
    let (beat_s, push_s) = (found[1].time_s, 0.45 * 1.3 / 6.0);
    assert!(found[2].time_s < beat_s + push_s);
    let mut clonus = symptom("clonus", &keys, &motion);
    for share in [0.99, 1.01] {
        clonus.advance(beat_s + share * push_s);
        assert_eq!(clonus.torque_nm() > 0.0, share < 1.0);
    }
}
