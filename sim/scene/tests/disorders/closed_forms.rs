//! What is known in closed form of every law.

use crate::support::{
    constant, events, given, jumps, knots, near, symptom, times, torque_at, words,
};
use crepitus_plant::Motion;
use crepitus_scene::reference::symptoms::SymptomEventKind as Kind;
use std::f64::consts::{PI, TAU};

const TIME_S: f64 = 1e-9;
const TORQUE_NM: f64 = 1e-9;

/// ∫T dφ over a motion at constant speeds between the given times, by Simpson's
/// rule on parts between which the torque is smooth.
fn work_j(name: &str, keys: &crate::support::Given, motion: &Motion, marks: &[f64]) -> f64 {
    const PARTS: u32 = 200;
    let mut symptom = symptom(name, keys, motion);
    let mut work = 0.0;
    for span in marks.windows(2) {
        let (from_s, to_s) = (span[0], span[1]);
        let step_s = (to_s - from_s) / f64::from(2 * PARTS);
        // Just inside the span, so that a jump at its ends is not seen.
        let inside_s = 1e-12 * (to_s - from_s);
        for i in 0..=2 * PARTS {
            let time_s = (from_s + step_s * f64::from(i)).clamp(from_s + inside_s, to_s - inside_s);
            symptom.advance(time_s);
            let weight = match i {
                0 => 1.0,
                i if i == 2 * PARTS => 1.0,
                i if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let omega = motion.at(time_s).omega_rad_s;
            work += weight * step_s / 3.0 * symptom.torque_nm() * omega;
        }
    }
    work
}

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
fn lead_pipe_loses_four_tc_a_minus_delta_a_cycle() {
    let keys = given(&[("torque_nm", 1.2), ("presliding_deg", 1.5)], &[]);
    let motion = jumps(
        45.0,
        &[
            (0.0, 60.0, 60.0),
            (0.5, 60.0, -60.0),
            (1.5, -60.0, 60.0),
            (2.5, 60.0, -60.0),
        ],
    );
    let found = events("lead-pipe", &keys, &motion, 2.5);
    assert_eq!(
        words(&found),
        ["flow", "turn", "flow", "turn", "flow", "turn"]
    );
    // A reversal takes 2δ.
    near(found[2].time_s - found[1].time_s, 3.0 / 60.0, TIME_S);
    let loop_j = work_j(
        "lead-pipe",
        &keys,
        &motion,
        &[0.5, found[2].time_s, 1.5, found[4].time_s, 2.5],
    );
    let (a, delta) = (30.0_f64.to_radians(), 1.5_f64.to_radians());
    near(loop_j, 4.0 * 1.2 * (a - delta), 1e-8);
    near(loop_j, 2.3876, 1e-4);
}

#[test]
fn lead_pipe_does_not_depend_on_speed() {
    let keys = given(&[("elastic_nm_per_rad", 2.0), ("neutral_deg", 30.0)], &[]);
    for speed in [0.5, 60.0, 350.0] {
        let motion = constant(45.0, speed);
        for turned_deg in [0.4_f64, 1.2, 20.0] {
            let play = (1.2 * turned_deg / 1.5).min(1.2);
            let spring = 2.0 * (15.0 + turned_deg).to_radians();
            let torque = torque_at("lead-pipe", &keys, &motion, turned_deg / speed);
            near(torque, play + spring, TORQUE_NM);
        }
    }
}

/// The mean and the highest torque of cogwheel over whole cycles at a speed.
fn cogwheel_at(speed: f64) -> (f64, f64) {
    let keys = given(&[], &[]);
    let motion = constant(0.0, speed);
    let (from, cycles) = (10, 4);
    let mut marks: Vec<_> = (0..2 * cycles)
        .map(|half| f64::from(from) * 0.16 + 0.08 * f64::from(half))
        .chain([f64::from(from + cycles) * 0.16])
        .collect();
    let found = events("cogwheel", &keys, &motion, 3.0);
    let within = marks[0]..marks[marks.len() - 1];
    marks.extend(
        times(&found, Kind::Flow)
            .into_iter()
            .filter(|t| within.contains(t)),
    );
    marks.sort_by(f64::total_cmp);
    marks.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
    let span = marks[marks.len() - 1] - marks[0];
    let mean = work_j("cogwheel", &keys, &motion, &marks) / (speed.to_radians() * span);
    let peak = found.iter().map(|e| e.torque_before_nm).fold(0.0, f64::max);
    (mean, peak)
}

#[test]
fn cogwheel_has_its_mean_and_its_height() {
    let (mean, peak) = cogwheel_at(60.0);
    near(mean, 1.34375, 1e-9);
    near(peak, 2.0, TORQUE_NM);
    // (1 − ρ)δf/D = 11.25 deg/s is what the full height takes.
    near(cogwheel_at(11.26).1, 2.0, TORQUE_NM);
    assert!(cogwheel_at(11.24).1 < 2.0 - 1e-4);
    let found = events("cogwheel", &given(&[], &[]), &constant(0.0, 5.0), 3.0);
    let peak = found[2..]
        .iter()
        .map(|e| e.torque_before_nm)
        .fold(0.0, f64::max);
    near(peak, 0.8 + 2.0 / 1.5 * 5.0 * 0.08, TORQUE_NM);
    near(peak, 1.3333, 1e-4);
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

/// MAS 2.
fn mas(lambda: f64, b: f64, r: f64, k: f64) -> crate::support::Given {
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

fn reflex(numbers: &[(&str, f64)]) -> crate::support::Given {
    given(numbers, &[("form", "reflex")])
}

#[test]
fn a_reflex_lags_a_ramp_by_its_delay_and_its_activation() {
    let keys = reflex(&[("velocity_shift_s", 0.1)]);
    let motion = constant(20.0, 40.0);
    let found = events("spasticity", &keys, &motion, 3.0);
    assert_eq!(words(&found), ["onset"]);
    near(found[0].angle_rad.to_degrees(), 71.0, 1e-9);
    let at = |t: f64| 2.43 * (20.0 + 40.0 * t - 75.0 + 40.0 * (0.1 - 0.06)).to_radians();
    for time_s in [2.0, 2.7] {
        let torque = torque_at("spasticity", &keys, &motion, time_s);
        near(torque, at(time_s), TORQUE_NM);
    }
    // Its transient, from τd after the onset on.
    let onset_s = found[0].time_s;
    near(
        torque_at("spasticity", &keys, &motion, onset_s + 0.05),
        0.0,
        1e-12,
    );
    let t = 0.013;
    let rate = 2.43 * 40.0_f64.to_radians();
    let y = rate * (t - 0.01 + 0.01 * (-t / 0.01_f64).exp());
    near(
        torque_at("spasticity", &keys, &motion, onset_s + 0.05 + t),
        y,
        TORQUE_NM,
    );
}

#[test]
fn a_reflex_on_a_sine_has_its_gain_and_phase() {
    let (mu, delay, activation, k) = (0.25, 0.05, 0.01, 1.7);
    let keys = reflex(&[
        ("threshold_deg", -150.0),
        ("velocity_shift_s", mu),
        ("delay_s", delay),
        ("activation_s", activation),
        ("gain_nm_per_rad", k),
        ("torque_nm", 20.0),
    ]);
    let (amplitude, f) = (0.3, 1.3);
    let motion = Motion::sine(amplitude, f, 40.0);
    let w = TAU * f;
    let gain = k * (1.0 + (mu * w).powi(2)).sqrt() / (1.0 + (activation * w).powi(2)).sqrt();
    let phase = (mu * w).atan() - w * delay - (activation * w).atan() + 40.0_f64.to_radians();
    assert_eq!(words(&events("spasticity", &keys, &motion, 3.0)), ["onset"]);
    for time_s in [0.9, 1.23, 2.9] {
        let y = k * 150.0_f64.to_radians() + gain * amplitude * (w * time_s + phase).sin();
        near(torque_at("spasticity", &keys, &motion, time_s), y, 1e-12);
    }
    // It gives energy above 3.73 Hz.
    for (f, gives) in [(3.70, false), (3.76, true)] {
        let w = TAU * f;
        let lead: f64 = (mu * w).atan() - w * delay - (activation * w).atan();
        assert_eq!(lead < 0.0, gives);
        let motion = Motion::sine(0.05, f, 0.0);
        let keys = reflex(&[
            ("threshold_deg", -150.0),
            ("velocity_shift_s", mu),
            ("gain_nm_per_rad", k),
            ("torque_nm", 20.0),
        ]);
        let work = work_j(
            "spasticity",
            &keys,
            &motion,
            &[10.0 / f, 10.5 / f, 11.0 / f],
        );
        assert_eq!(work < 0.0, gives, "{f} Hz: {work} J");
    }
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
fn clasp_knife_builds_and_falls() {
    let keys = given(&[], &[]);
    let motion = constant(10.0, 60.0);
    let found = events("clasp-knife", &keys, &motion, 1.5);
    assert_eq!(words(&found), ["onset", "flow", "release"]);
    let release = &found[2];
    near(release.angle_rad.to_degrees(), 75.0, 1e-9);
    near(release.torque_before_nm, 0.8 + 3.0 * PI / 4.0, TORQUE_NM);
    near(release.torque_before_nm, 3.156, 5e-4);
    let later = torque_at("clasp-knife", &keys, &motion, release.time_s + 0.085);
    let left = 0.15 + 0.85 * (-0.085_f64 / 0.03).exp();
    near(later / release.torque_before_nm, left, 1e-12);
    near(left, 0.2, 1e-3);
}

#[test]
fn clasp_knife_is_released_by_torque_too() {
    let keys = given(&[], &[("trigger", "torque")]);
    let found = events("clasp-knife", &keys, &constant(10.0, 60.0), 1.5);
    assert_eq!(words(&found), ["onset", "flow", "release"]);
    near(found[2].torque_before_nm, 2.5, TORQUE_NM);
    near(found[2].angle_rad, 30.0_f64.to_radians() + 1.7 / 3.0, 1e-12);
}

#[test]
fn clonus_beats_at_its_intervals() {
    let motion = knots(20.0, &[(0.0, 200.0), (0.4, 200.0), (0.5, 0.0)]);
    let keys = given(&[], &[]);
    let found = events("clonus", &keys, &motion, 2.0);
    let beats = times(&found, Kind::Beat);
    near(found[0].time_s, 0.2, TIME_S);
    near(beats[0], 0.25, TIME_S);
    let table = [216.7, 191.7, 179.2, 172.9, 169.8];
    for (n, (pair, expected)) in (0_i32..).zip(beats.windows(2).zip(table)) {
        let interval = pair[1] - pair[0];
        near(1e3 * interval, expected, 0.05);
        near(interval, (1.0 + 0.3 * 0.5_f64.powi(n)) / 6.0, 1e-12);
        // Its height, its end, and 2·A·D·P/π of impulse.
        let peak_s = pair[0] + 0.225 * interval;
        near(torque_at("clonus", &keys, &motion, peak_s), 1.5, TORQUE_NM);
        let end_s = pair[0] + 0.4501 * interval;
        near(torque_at("clonus", &keys, &motion, end_s), 0.0, 0.0);
    }
    let interval = beats[1] - beats[0];
    let mut clonus = symptom("clonus", &keys, &motion);
    let step_s = 0.45 * interval / 400.0;
    let impulse: f64 = (0..400)
        .map(|i| {
            clonus.advance(beats[0] + step_s * (f64::from(i) + 0.5));
            step_s * clonus.torque_nm()
        })
        .sum();
    near(impulse, 2.0 * 1.5 * 0.45 * interval / PI, 1e-6);
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
