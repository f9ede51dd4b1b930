//! Properties of walls, rigidity and texture that are known in closed form.

use crate::support::{
    TIME_S, TORQUE_NM, constant, events, given, jumps, near, times, words, work_j,
};
use crepitus_scene::reference::symptoms::Word as Kind;

#[test]
fn a_wall_is_met_at_its_angle_and_takes_what_its_envelope_says() {
    let keys = given(
        &[
            ("flexion_limit_deg", 100.0),
            ("stiffness_nm_per_rad", 60.0),
            ("stiffening_nm_per_rad2", 400.0),
            ("loss", 0.3),
        ],
        &[],
    );
    let motion = constant(90.0, 50.0);
    let found = events("range-limit", &keys, &motion, 1.0);
    assert_eq!(words(&found), ["contact", "cap"]);
    near(found[0].time_s, 0.2, TIME_S);
    let (k1, k2, cap) = (60.0_f64, 400.0, 4.0);
    let p_c = 2.0 * cap / (k1 + (k1 * k1 + 4.0 * k2 * cap).sqrt());
    near(p_c.to_degrees(), 2.9, 0.05);
    let speed = 50.0_f64.to_radians();
    near(found[1].time_s, 0.2 + p_c / speed, TIME_S);
    near(found[1].torque_before_nm, cap, TORQUE_NM);
    let work = work_j("range-limit", &keys, &motion, &[0.2, found[1].time_s, 0.5]);
    let envelope = k1 * p_c * p_c / 2.0 + k2 * p_c.powi(3) / 3.0 + cap * (0.3 * speed - p_c);
    near(work, envelope, 1e-8);
}

#[test]
fn a_wall_of_one_stiffness_keeps_its_share_of_the_work() {
    for loss in [0.0, 0.25, 0.6] {
        let keys = given(
            &[
                ("flexion_limit_deg", 100.0),
                ("stiffness_nm_per_rad", 300.0),
                ("stiffening_nm_per_rad2", 0.0),
                ("loss", loss),
            ],
            &[],
        );
        // In by 0.5°, and out.
        let motion = jumps(99.0, &[(0.0, 10.0, 10.0), (0.15, 10.0, -10.0)]);
        let found = events("range-limit", &keys, &motion, 0.5);
        let mut marks = vec![0.0, 0.15];
        if loss > 0.0 {
            assert_eq!(words(&found), ["contact", "turn", "slack", "leave"]);
            let p = 0.5_f64.to_radians();
            let sigma = 300.0 / (1.0 - loss);
            let back = 300.0 * p / sigma;
            near(found[2].angle_rad, 100.5_f64.to_radians() - back, 1e-12);
            marks.push(found[2].time_s);
        } else {
            assert_eq!(words(&found), ["contact", "leave"]);
        }
        marks.insert(1, found[0].time_s);
        marks.push(found[found.len() - 1].time_s);
        let p = 0.5_f64.to_radians();
        let work = work_j("range-limit", &keys, &motion, &marks);
        near(work, loss * 300.0 * p * p / 2.0, 1e-8);
    }
}

#[test]
fn end_feels_return_no_more_than_their_cap_allows() {
    for (k1, k2, loss, sigma, at_deg, most_mj) in [
        (15.0, 150.0, 0.4, 85.0, 6.9, 94.0),
        (60.0, 400.0, 0.3, 143.0, 2.9, 56.0),
        (300.0, 0.0, 0.25, 400.0, 0.76, 20.0),
        (60.0, 0.0, 0.0, 60.0, 3.8, 133.0),
    ] {
        let keys = given(
            &[
                ("flexion_limit_deg", 100.0),
                ("stiffness_nm_per_rad", k1),
                ("stiffening_nm_per_rad2", k2),
                ("loss", loss),
            ],
            &[],
        );
        let motion = jumps(90.0, &[(0.0, 100.0, 100.0), (0.3, 100.0, -100.0)]);
        let found = events("range-limit", &keys, &motion, 1.0);
        assert_eq!(words(&found), ["contact", "cap", "turn", "slack", "leave"]);
        near((found[1].angle_rad).to_degrees() - 100.0, at_deg, 0.06);
        near(4.0 / (found[2].angle_rad - found[3].angle_rad), sigma, 0.6);
        let returned = -work_j("range-limit", &keys, &motion, &[0.3, found[3].time_s]);
        near(1e3 * returned, most_mj, 0.6);
    }
}

#[test]
fn cogwheel_of_space_gives_where_its_teeth_are() {
    let keys = given(&[("pitch_deg", 7.5)], &[("mode", "space")]);
    let found = events("cogwheel", &keys, &constant(1.0, 60.0), 1.0);
    let gives = times(&found, Kind::Give);
    assert_eq!(gives.len(), 8);
    for (n, time_s) in (0_u32..).zip(gives) {
        near(60.0 * time_s + 1.0, 7.5 * (f64::from(n) + 0.5), 1e-9);
    }
    // Back over the same teeth: high where it was high.
    let found = events("cogwheel", &keys, &constant(61.0, -60.0), 1.0);
    for time_s in times(&found, Kind::Give) {
        let turns = (61.0 - 60.0 * time_s) / 7.5;
        near(turns, turns.round(), 1e-9);
    }
}

#[test]
fn texture_snaps_by_angle() {
    let keys = given(&[("irregularity", 0.0)], &[]);
    for (speed, count) in [(60.0, 40), (15.0, 10), (-60.0, 40)] {
        let motion = constant(0.7, speed);
        let found = events("texture", &keys, &motion, 1.0);
        assert_eq!(found.len(), count);
        assert!(found.iter().all(|e| e.kind == Kind::Snap));
    }
    // Mean Tb + w(Tp − Tb)/2, over four pitches, past the first rise.
    let motion = constant(0.7, 60.0);
    let snaps = times(&events("texture", &keys, &motion, 1.0), Kind::Snap);
    let mut marks = Vec::new();
    for pair in snaps[3..8].windows(2) {
        marks.extend([pair[0], pair[1] - 0.6 * 1.5 / 60.0]);
    }
    marks.push(snaps[7]);
    let turned = 60.0_f64.to_radians() * (marks[marks.len() - 1] - marks[0]);
    near(
        work_j("texture", &keys, &motion, &marks) / turned,
        0.19,
        1e-9,
    );
    // Seeds and irregularity: there and back the same asperities.
    let keys = given(&[("irregularity", 0.7), ("seed", 12345.0)], &[]);
    let there = events("texture", &keys, &constant(0.0, 60.0), 1.0);
    let back = events("texture", &keys, &constant(60.0, -60.0), 1.0);
    assert_eq!(there.len(), back.len());
    for (a, b) in there.iter().zip(back.iter().rev()) {
        near(a.angle_rad, b.angle_rad, 1e-12);
        near(a.torque_before_nm, -b.torque_before_nm, 1e-12);
    }
}
