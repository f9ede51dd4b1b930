//! The laws in small steps, for random motions and numbers: a state that ends
//! is seen at the next step, so all agrees within some steps.

use crate::support::{Given, given, jumps, symptom};
use crepitus_plant::Motion;
use crepitus_scene::reference::symptoms::SymptomEvent;

const STEP_S: f64 = 2e-6;
const END_S: f64 = 1.2;

/// Within what the torques agree, N·m: the stiffest rise over two steps.
const TORQUE_NM: f64 = 6e-3;

/// Runs of each law.
const RUNS: u64 = 40;

/// Numbers that look random.
struct Random(u64);

impl Random {
    fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        x ^= x >> 31;
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let share = (x >> 11) as f64 / (1_u64 << 53) as f64;
        share
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    fn happens(&mut self, share: f64) -> bool {
        self.share() < share
    }

    /// Strokes, rests and jumps about the middle of the joint's range.
    fn motion(&mut self) -> Motion {
        if self.happens(0.15) {
            let amplitude = self.between(0.3, 2.0);
            let frequency_hz = self.between(0.3, 4.0);
            return Motion::sine(amplitude, frequency_hz, self.between(-180.0, 180.0));
        }
        let from_deg = self.between(0.0, 120.0);
        let (mut angle, mut time, mut speed) = (from_deg, 0.0, 0.0);
        let mut knots = Vec::new();
        while time < END_S {
            let left = speed;
            let pull = 2.0 * (60.0 - angle);
            if self.happens(0.3) {
                speed = if self.happens(0.3) {
                    0.0
                } else {
                    pull + self.between(-250.0, 250.0)
                };
            }
            knots.push((time, left, speed));
            let length = self.between(0.03, 0.3);
            let next = if self.happens(0.4) {
                speed
            } else {
                pull + self.between(-250.0, 250.0)
            };
            angle += 0.5 * (speed + next) * length;
            time += length;
            speed = next;
        }
        jumps(from_deg, &knots)
    }
}

/// A law in steps: the torque at the end of a step, and what happened in it.
type Stepped<'a> = Box<dyn FnMut(f64, f64, f64, &mut Vec<&'static str>) -> f64 + 'a>;

/// The stop operator.
#[derive(Clone, Copy)]
struct Stop {
    sigma: f64,
    a: f64,
}

impl Stop {
    fn clip(&mut self, x: f64, upper: f64, lower: f64) -> f64 {
        let torque = self.sigma * (x - self.a);
        let clipped = torque.min(upper).max(lower);
        if clipped != torque {
            self.a = x - clipped / self.sigma;
        }
        clipped
    }
}

/// Steps through a motion and compares.
fn compare(
    name: &str,
    choices: &[(&str, &str)],
    words: &[&str],
    numbers: impl Fn(&mut Random) -> Vec<(&'static str, f64)>,
    law: impl for<'a> Fn(&'a [(&'static str, f64)], f64) -> Stepped<'a>,
) {
    let mut seen = 0;
    for seed in 0..RUNS {
        let mut random = Random(seed.wrapping_mul(0x1234_5678_9ABC) ^ name.len() as u64);
        let numbers = numbers(&mut random);
        let motion = random.motion();
        let given: Given = given(&numbers, choices);
        let mut reference = symptom(name, &given, &motion);
        let mut all: Vec<SymptomEvent> = Vec::new();
        let mut stepped = law(&numbers, motion.at(0.0).phi_rad);
        let mut happened: Vec<(f64, &'static str)> = Vec::new();
        let mut own = Vec::new();
        let mut place = 0;
        let mut piece = motion.piece(0.0);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "small"
        )]
        let steps = (END_S / STEP_S) as u32;
        // A torque is compared a few steps after the last event at the earliest.
        let mut pending: Option<(f64, f64)> = None;
        for n in 0..=steps {
            let time_s = f64::from(n) * STEP_S;
            while piece.end_s <= time_s {
                piece = motion.piece_from(piece.end_s, &mut place);
            }
            let (phi, omega) = piece.angle_and_velocity(time_s);
            let torque = stepped(time_s, phi, omega, &mut own);
            happened.extend(own.drain(..).map(|word| (time_s, word)));
            if let Some((at_s, nm)) = pending.take_if(|_| n % 500 == 5) {
                let quiet = |e: &SymptomEvent| (e.time_s - at_s).abs() > 4.0 * STEP_S;
                all.extend(reference.advance(at_s));
                let found = reference.torque_nm();
                let (before, calm) = (all.len(), all.iter().rev().take(3).all(quiet));
                if n % 50_000 == 5 {
                    // Now and then from the start, to be sure that nothing hangs on the rows.
                    let mut later = symptom(name, &given, &motion);
                    later.advance(at_s);
                    assert_eq!(later.torque_nm().to_bits(), found.to_bits());
                }
                all.extend(reference.advance(time_s));
                if calm && all.len() == before {
                    assert!(
                        (found - nm).abs() < TORQUE_NM,
                        "{name} {choices:?} {seed}: {found} for {nm} at {at_s}, {numbers:?}"
                    );
                    seen += 1;
                }
            }
            if n % 500 == 0 {
                pending = Some((time_s, torque));
            }
        }
        all.extend(reference.advance(END_S));
        let listed: Vec<_> = all
            .iter()
            .filter(|e| words.contains(&e.kind.name()))
            .map(|e| (e.time_s, e.kind.name()))
            .collect();
        let sequence = |events: &[(f64, &'static str)]| -> Vec<_> {
            events.iter().map(|(_, word)| *word).collect()
        };
        assert_eq!(
            sequence(&listed),
            sequence(&happened),
            "{name} {choices:?} {seed}: {listed:?} for {happened:?}, {numbers:?}"
        );
        for ((found, word), (stepped, _)) in listed.iter().zip(&happened) {
            assert!(
                (found - stepped).abs() < 3.0 * STEP_S,
                "{name} {choices:?} {seed}: {word} at {found} for {stepped}, {numbers:?}"
            );
        }
    }
    println!("{name} {choices:?}: {seen} torques");
    assert!(seen > 10_000, "{name}: {seen}");
}

fn get(numbers: &[(&'static str, f64)], key: &str) -> f64 {
    let found = numbers.iter().find(|(k, _)| *k == key);
    found.map(|(_, x)| *x).expect("a number of the case")
}

fn deg(numbers: &[(&'static str, f64)], key: &str) -> f64 {
    get(numbers, key).to_radians()
}

#[test]
fn range_limit() {
    compare(
        "range-limit",
        &[],
        &["contact", "leave"],
        |r| {
            let low = r.between(-10.0, 60.0);
            vec![
                ("extension_limit_deg", low),
                ("flexion_limit_deg", low + r.between(5.0, 80.0)),
                ("stiffness_nm_per_rad", r.between(1.0, 400.0)),
                ("flexion_stiffness_nm_per_rad", r.between(1.0, 400.0)),
                ("stiffening_nm_per_rad2", r.between(0.0, 2000.0)),
                ("loss", r.between(0.02, 0.6)),
                ("extension_loss", r.between(0.02, 0.6)),
                ("torque_nm", r.between(0.2, 6.0)),
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
                ("torque_nm", r.between(0.1, 4.5)),
                ("presliding_deg", r.between(0.5, 10.0)),
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
        ("torque_nm", r.between(0.1, 4.5)),
        ("low_share", r.share()),
        ("frequency_hz", r.between(3.0, 12.0)),
        ("duty", r.between(0.1, 0.9)),
        ("pitch_deg", r.between(1.0, 30.0)),
        ("presliding_deg", r.between(0.5, 10.0)),
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
fn catch() {
    for (muscles, s) in [("extensors", 1.0), ("flexors", -1.0)] {
        compare(
            "spasticity",
            &[("form", "catch"), ("muscles", muscles)],
            &["catch", "rearm"],
            |r| {
                vec![
                    ("threshold_deg", r.between(0.0, 120.0)),
                    ("velocity_shift_s", r.between(0.0, 0.5)),
                    ("threshold_velocity_deg_s", r.between(5.0, 150.0)),
                    ("velocity_torque_nms_per_rad", r.between(0.01, 2.0)),
                    ("torque_nm", r.between(0.1, 6.0)),
                    ("residual_share", r.share()),
                    ("stiffness_nm_per_rad", r.between(0.0, 10.0)),
                    ("release_s", r.between(0.01, 0.3)),
                    ("catch_stiffness_nm_per_rad", r.between(11.0, 300.0)),
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
                    ("velocity_shift_s", r.between(0.0, 0.5)),
                    ("gain_nm_per_rad", r.between(0.1, 20.0)),
                    ("delay_s", r.between(0.0, 0.1)),
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
                        ("onset_torque_nm", r.between(0.05, 3.0)),
                        ("slope_nm_per_rad", r.between(0.0, 10.0)),
                        ("residual_share", r.between(0.0, 0.9)),
                        ("collapse_s", r.between(0.005, 0.3)),
                        ("rearm_deg", r.between(2.0, 30.0)),
                        ("catch_stiffness_nm_per_rad", r.between(11.0, 300.0)),
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
                    ("first_stretch", r.share()),
                    ("amplitude_nm", r.between(0.1, 4.5)),
                    ("delay_s", r.between(0.0, 0.2)),
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
                let mut state = if before > hold { 1 } else { 0 };
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

#[test]
fn texture() {
    compare(
        "texture",
        &[],
        &[],
        |r| {
            let (base, height) = (r.between(0.0, 1.0), r.between(0.05, 1.0));
            let (pitch, width) = (r.between(1.0, 20.0), r.between(0.3, 1.0));
            let least = 2.0 * height / (width * pitch.to_radians());
            vec![
                ("base_nm", base),
                ("peak_nm", base + height),
                ("pitch_deg", pitch),
                ("width_share", width),
                ("irregularity", r.between(0.0, 0.9)),
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
            Box::new(move |_, phi, _, _| {
                while place(last + 1) <= phi {
                    last += 1;
                }
                while place(last) > phi {
                    last -= 1;
                }
                let (base, width) = (get(n, "base_nm"), get(n, "width_share") * pitch);
                let ramp = |k: i32, away: f64| base + height(k) * (1.0 - away / width).max(0.0);
                let upper = ramp(last + 1, place(last + 1) - phi);
                play.clip(phi, upper, -ramp(last, phi - place(last)))
            })
        },
    );
}
