//! The laws of muscles, in small steps.

use crate::stepped::{STEP_S, Stop, compare, deg, get};

#[test]
fn catch() {
    for (muscles, s) in [("extensors", 1.0), ("flexors", -1.0)] {
        compare(
            "spasticity",
            &[("form", "catch"), ("muscles", muscles)],
            &["catch", "rearm"],
            |r| {
                vec![
                    ("threshold_deg", r.between(0.0, 120.0)),
                    ("velocity_shift_s", r.or(0.0, 0.5, &[0.0])),
                    ("threshold_velocity_deg_s", r.between(5.0, 150.0)),
                    ("velocity_torque_nms_per_rad", r.or(0.01, 2.0, &[0.0])),
                    ("torque_nm", r.or(0.1, 6.0, &[0.0])),
                    ("residual_share", r.or(0.0, 1.0, &[0.0, 1.0])),
                    ("stiffness_nm_per_rad", r.or(0.0, 10.0, &[0.0, 10.0])),
                    ("release_s", r.between(0.01, 0.3)),
                    (
                        "catch_stiffness_nm_per_rad",
                        r.or(11.0, 300.0, &[10.0, 10.0]),
                    ),
                    ("rearm_deg", r.between(2.0, 30.0)),
                ]
            },
            |n, _| {
                let lambda = deg(n, "threshold_deg");
                let mut caught: Option<(f64, f64, f64)> = None;
                let sigma = get(n, "catch_stiffness_nm_per_rad");
                let mut play = Stop { sigma, a: 0.0 };
                Box::new(move |t, phi, omega, own| {
                    let (x, v) = (s * phi, s * omega);
                    if let Some((x_c, _, _)) = caught
                        && x_c - x >= deg(n, "rearm_deg")
                    {
                        caught = None;
                        own.push("rearm");
                    }
                    if caught.is_none()
                        && x - s * lambda + get(n, "velocity_shift_s") * v >= 0.0
                        && v >= deg(n, "threshold_velocity_deg_s")
                    {
                        let peak =
                            get(n, "torque_nm").min(get(n, "velocity_torque_nms_per_rad") * v);
                        caught = Some((x, t, peak));
                        play.a = x;
                        own.push("catch");
                    }
                    let Some((x_c, t_c, peak)) = caught else {
                        return 0.0;
                    };
                    let r = get(n, "residual_share");
                    let left = (-(t - t_c) / get(n, "release_s")).exp();
                    let upper = peak * (r + (1.0 - r) * left)
                        + get(n, "stiffness_nm_per_rad") * (x - x_c).max(0.0);
                    s * play.clip(x, upper, 0.0)
                })
            },
        );
    }
}

#[test]
fn reflex() {
    for (muscles, s) in [("extensors", 1.0), ("flexors", -1.0)] {
        compare(
            "spasticity",
            &[("form", "reflex"), ("muscles", muscles)],
            &["onset", "offset", "cap", "uncap"],
            |r| {
                vec![
                    ("threshold_deg", r.between(0.0, 120.0)),
                    ("velocity_shift_s", r.or(0.0, 0.5, &[0.0])),
                    ("gain_nm_per_rad", r.or(0.1, 20.0, &[0.0])),
                    (
                        "delay_s",
                        STEP_S * (r.or(0.0, 0.1, &[0.0]) / STEP_S).round(),
                    ),
                    ("activation_s", r.between(0.002, 0.1)),
                    ("torque_nm", r.between(0.1, 6.0)),
                ]
            },
            |n, _| {
                let (k, cap) = (get(n, "gain_nm_per_rad"), get(n, "torque_nm"));
                let mut inputs = Vec::new();
                let (mut y, mut was) = (0.0, 0);
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "small"
                )]
                let delay = (get(n, "delay_s") / STEP_S).round() as usize;
                let decay = (-STEP_S / get(n, "activation_s")).exp();
                Box::new(move |_, phi, omega, own| {
                    let lead = s * (phi - deg(n, "threshold_deg"));
                    let u = k * (lead + s * get(n, "velocity_shift_s") * omega);
                    let state = i32::from(u > 0.0) + i32::from(u > cap);
                    while was != state {
                        let up = state > was;
                        own.push(match (was, up) {
                            (0, _) => "onset",
                            (1, false) => "offset",
                            (1, true) => "cap",
                            _ => "uncap",
                        });
                        was += if up { 1 } else { -1 };
                    }
                    inputs.push(u.clamp(0.0, cap));
                    let now = inputs.len() - 1;
                    let past = now.checked_sub(delay).map_or(0.0, |i| inputs[i]);
                    y = past + (y - past) * decay;
                    s * y
                })
            },
        );
    }
}

#[test]
fn clasp_knife() {
    for (muscles, s) in [("extensors", 1.0), ("flexors", -1.0)] {
        for trigger in ["angle", "torque"] {
            compare(
                "clasp-knife",
                &[("trigger", trigger), ("muscles", muscles)],
                &["onset", "back", "release", "rearm"],
                |r| {
                    let onset = r.between(30.0, 90.0);
                    vec![
                        ("onset_deg", onset),
                        ("release_deg", onset + s * r.between(5.0, 60.0)),
                        ("onset_torque_nm", r.or(0.05, 3.0, &[0.0, 0.0])),
                        ("slope_nm_per_rad", r.or(0.0, 10.0, &[0.0, 10.0])),
                        ("residual_share", r.or(0.0, 0.9, &[0.0])),
                        ("collapse_s", r.between(0.005, 0.3)),
                        ("rearm_deg", r.between(2.0, 30.0)),
                        (
                            "catch_stiffness_nm_per_rad",
                            r.or(11.0, 300.0, &[10.0, 10.0]),
                        ),
                        ("release_torque_nm", r.between(0.2, 4.5)),
                    ]
                },
                |n, phi| {
                    let on = s * deg(n, "onset_deg");
                    let sigma = get(n, "catch_stiffness_nm_per_rad");
                    let mut play = Stop { sigma, a: s * phi };
                    let (mut state, mut level, mut since) = (0, 0.0, 0.0);
                    let mut first = true;
                    Box::new(move |t, phi, _, own| {
                        let x = s * phi;
                        if state == 0 && x >= on {
                            state = 1;
                            own.push("onset");
                            play.a = if first { x } else { on };
                        }
                        first = false;
                        let build =
                            get(n, "onset_torque_nm") + get(n, "slope_nm_per_rad") * (x - on);
                        if state == 1 && x < on {
                            state = 0;
                            own.push("back");
                        } else if state == 1 {
                            let torque = (sigma * (x - play.a)).min(build);
                            let released = if trigger == "angle" {
                                x >= s * deg(n, "release_deg")
                            } else {
                                torque >= get(n, "release_torque_nm")
                            };
                            if released {
                                (state, level, since) = (2, build, t);
                                own.push("release");
                            }
                        } else if state == 2 && on - x >= deg(n, "rearm_deg") {
                            state = 0;
                            own.push("rearm");
                        }
                        let r = get(n, "residual_share");
                        let left = (-(t - since) / get(n, "collapse_s")).exp();
                        let upper = match state {
                            0 => 0.0,
                            1 => build,
                            _ => level * (r + (1.0 - r) * left),
                        };
                        s * play.clip(x, upper, 0.0)
                    })
                },
            );
        }
    }
}

#[test]
fn clonus() {
    for (muscles, s) in [("extensors", 1.0), ("flexors", -1.0)] {
        compare(
            "clonus",
            &[("muscles", muscles)],
            &["start", "beat", "stop", "done"],
            |r| {
                vec![
                    ("hold_deg", r.between(20.0, 100.0)),
                    ("hysteresis_deg", r.between(1.0, 30.0)),
                    ("start_velocity_deg_s", r.between(20.0, 150.0)),
                    ("frequency_hz", r.between(3.0, 10.0)),
                    ("push_share", r.between(0.2, 0.8)),
                    ("first_stretch", r.or(0.0, 1.0, &[0.0, 1.0])),
                    ("amplitude_nm", r.between(0.1, 4.5)),
                    ("delay_s", r.or(0.0, 0.2, &[0.0])),
                    ("beats", r.between(0.0, 5.0).floor()),
                ]
            },
            |n, phi| {
                let hold = s * deg(n, "hold_deg");
                let period = 1.0 / get(n, "frequency_hz");
                let interval =
                    move |k: i32| period * (1.0 + get(n, "first_stretch") * 0.5_f64.powi(k));
                let mut before = s * phi;
                // Idle, passed over, beating, done.
                let mut state = i32::from(before > hold);
                let (mut next, mut count) = (0.0, 0);
                let mut beat: Option<(f64, f64)> = None;
                Box::new(move |t, phi, omega, own| {
                    let x = s * phi;
                    if hold - x >= deg(n, "hysteresis_deg") {
                        if state > 1 {
                            own.push("stop");
                        }
                        state = 0;
                    }
                    if state == 0 && before <= hold && x > hold {
                        state = 1;
                        if s * omega >= deg(n, "start_velocity_deg_s") {
                            (state, next, count) = (2, t + get(n, "delay_s"), 0);
                            own.push("start");
                        }
                    }
                    if state == 2 && t >= next {
                        if f64::from(count) == get(n, "beats") && count > 0 {
                            state = 3;
                            own.push("done");
                        } else {
                            beat = Some((next, interval(count)));
                            next += interval(count);
                            count += 1;
                            own.push("beat");
                        }
                    }
                    before = x;
                    beat.map_or(0.0, |(start, interval)| {
                        let share = (t - start) / (get(n, "push_share") * interval);
                        let pushes = share < 1.0;
                        let height = (std::f64::consts::PI * share).sin();
                        if pushes {
                            s * get(n, "amplitude_nm") * height
                        } else {
                            0.0
                        }
                    })
                })
            },
        );
    }
}
