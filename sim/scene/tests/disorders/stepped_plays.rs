//! The laws that are plays, in small steps.

use crate::stepped::{Random, Stepped, Stop, compare, deg, get};

#[test]
fn range_limit() {
    compare(
        "range-limit",
        &[],
        &["contact", "leave"],
        |r| {
            let low = r.or(-10.0, 60.0, &[0.0, 10.0, 40.0]);
            vec![
                ("extension_limit_deg", low),
                (
                    "flexion_limit_deg",
                    low + r.or(5.0, 80.0, &[5.0, 20.0, 40.0]),
                ),
                ("stiffness_nm_per_rad", r.or(1.0, 400.0, &[60.0])),
                ("flexion_stiffness_nm_per_rad", r.or(1.0, 400.0, &[60.0])),
                ("stiffening_nm_per_rad2", r.or(0.0, 2000.0, &[0.0, 0.0])),
                ("loss", r.or(0.02, 0.6, &[0.0, 0.5])),
                ("extension_loss", r.or(0.02, 0.6, &[0.0, 0.5])),
                ("torque_nm", r.or(0.2, 6.0, &[0.0, 1.0])),
            ]
        },
        |n, phi| {
            let side = |s: f64, wall: f64, k1: f64, loss: f64| {
                let (k2, cap) = (get(n, "stiffening_nm_per_rad2"), get(n, "torque_nm"));
                let sigma = (k1 * k1 + 4.0 * k2 * cap).sqrt() / (1.0 - loss);
                let mut is_in = s * (phi - wall) > 0.0;
                let mut play = Stop { sigma, a: s * phi };
                move |phi: f64, own: &mut Vec<&'static str>| {
                    let (x, p) = (s * phi, s * (phi - wall));
                    if is_in != (p > 0.0) {
                        is_in = !is_in;
                        own.push(if is_in { "contact" } else { "leave" });
                        play.a = s * wall;
                    }
                    if is_in {
                        s * play.clip(x, (k1 * p + k2 * p * p).min(cap), 0.0)
                    } else {
                        0.0
                    }
                }
            };
            let mut low = side(
                -1.0,
                deg(n, "extension_limit_deg"),
                get(n, "stiffness_nm_per_rad"),
                get(n, "extension_loss"),
            );
            let mut high = side(
                1.0,
                deg(n, "flexion_limit_deg"),
                get(n, "flexion_stiffness_nm_per_rad"),
                get(n, "loss"),
            );
            Box::new(move |_, phi, _, own| low(phi, own) + high(phi, own))
        },
    );
}

#[test]
fn lead_pipe() {
    compare(
        "lead-pipe",
        &[],
        &[],
        |r| {
            vec![
                ("torque_nm", r.or(0.1, 4.5, &[0.0, 1.0])),
                ("presliding_deg", r.or(0.5, 10.0, &[1.0, 2.5])),
                ("elastic_nm_per_rad", r.between(0.0, 10.0)),
                ("neutral_deg", r.between(0.0, 140.0)),
            ]
        },
        |n, phi| {
            let limit = get(n, "torque_nm");
            let sigma = limit / deg(n, "presliding_deg");
            let mut play = Stop { sigma, a: phi };
            let (k, neutral) = (get(n, "elastic_nm_per_rad"), deg(n, "neutral_deg"));
            Box::new(move |_, phi, _, _| play.clip(phi, limit, -limit) + k * (phi - neutral))
        },
    );
}

fn cogwheel_numbers(r: &mut Random) -> Vec<(&'static str, f64)> {
    vec![
        ("torque_nm", r.or(0.1, 4.5, &[0.0, 1.0])),
        ("low_share", r.or(0.0, 1.0, &[0.0, 1.0, 0.5])),
        ("frequency_hz", r.or(3.0, 12.0, &[5.0, 10.0])),
        ("duty", r.or(0.1, 0.9, &[0.5, 0.25])),
        ("pitch_deg", r.or(1.0, 30.0, &[2.0, 5.0])),
        ("presliding_deg", r.or(0.5, 10.0, &[1.0, 2.5])),
    ]
}

fn cogwheel_law<'a>(n: &'a [(&'static str, f64)], phi: f64, by_space: bool) -> Stepped<'a> {
    let (limit, low) = (get(n, "torque_nm"), get(n, "low_share"));
    let sigma = limit / deg(n, "presliding_deg");
    let mut play = Stop { sigma, a: phi };
    let mut was = None;
    Box::new(move |t, phi, omega, own| {
        let turns = if by_space {
            phi / deg(n, "pitch_deg")
        } else {
            t * get(n, "frequency_hz")
        };
        let high = turns - turns.floor() < get(n, "duty");
        let limit = if high { limit } else { low * limit };
        let before = play.sigma * (phi - play.a);
        let torque = play.clip(phi, limit, -limit);
        if was.replace(high).is_some_and(|was| was != high)
            && (omega != 0.0 || before.abs() > limit + 1e-9)
        {
            own.push(if high { "catch" } else { "give" });
        }
        torque
    })
}

#[test]
fn cogwheel_by_time() {
    let words = &["give", "catch"];
    compare("cogwheel", &[], words, cogwheel_numbers, |n, phi| {
        cogwheel_law(n, phi, false)
    });
}

#[test]
fn cogwheel_by_space() {
    let (choices, words) = (&[("mode", "space")], &["give", "catch"]);
    compare("cogwheel", choices, words, cogwheel_numbers, |n, phi| {
        cogwheel_law(n, phi, true)
    });
}

#[test]
fn texture() {
    compare(
        "texture",
        &[],
        &["snap"],
        |r| {
            let (base, height) = (r.or(0.0, 1.0, &[0.0]), r.or(0.05, 1.0, &[0.0]));
            let (pitch, width) = (r.or(1.0, 20.0, &[1.0, 5.0]), r.or(0.3, 1.0, &[1.0, 0.5]));
            let least = (2.0 * height / (width * pitch.to_radians())).max(1.0);
            vec![
                ("base_nm", base),
                ("peak_nm", base + height),
                ("pitch_deg", pitch),
                ("width_share", width),
                ("irregularity", r.or(0.0, 0.9, &[0.0, 0.9])),
                ("stiffness_nm_per_rad", least * r.between(1.0, 2.0)),
                ("seed", r.between(0.0, 4e9).floor()),
            ]
        },
        |n, phi| {
            let sigma = get(n, "stiffness_nm_per_rad");
            let mut play = Stop { sigma, a: phi };
            let (pitch, j) = (deg(n, "pitch_deg"), get(n, "irregularity"));
            let h = move |k: i32| {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a seed"
                )]
                let seed = get(n, "seed") as u32;
                let mut x = k.cast_unsigned() ^ seed.wrapping_mul(0x9E37_79B9);
                x ^= x >> 16;
                x = x.wrapping_mul(0x7FEB_352D);
                x ^= x >> 15;
                x = x.wrapping_mul(0x846C_A68B);
                x ^= x >> 16;
                f64::from(x >> 8) / 16_777_216.0
            };
            let place = move |k: i32| pitch * (f64::from(k) + j * (h(2 * k) - 0.5));
            let height =
                move |k: i32| (get(n, "peak_nm") - get(n, "base_nm")) * (1.0 - j * h(2 * k + 1));
            let mut last = -1000;
            while place(last + 1) <= phi {
                last += 1;
            }
            // At the upper, or the lower limit.
            let mut at_limit = 0;
            Box::new(move |_, phi, _, own| {
                if place(last + 1) <= phi {
                    last += 1;
                    own.extend((at_limit == 1).then_some("snap"));
                } else if place(last) > phi {
                    last -= 1;
                    own.extend((at_limit == -1).then_some("snap"));
                }
                let (base, width) = (get(n, "base_nm"), get(n, "width_share") * pitch);
                let ramp = |k: i32, away: f64| base + height(k) * (1.0 - away / width).max(0.0);
                let upper = ramp(last + 1, place(last + 1) - phi);
                let lower = -ramp(last, phi - place(last));
                let elastic = play.sigma * (phi - play.a);
                at_limit = i32::from(elastic > upper) - i32::from(elastic < lower);
                play.clip(phi, upper, lower)
            })
        },
    );
}
