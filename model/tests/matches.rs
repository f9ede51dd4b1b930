//! End of a slip under `paper` and `physical`: in stick where the static
//! limit can hold the object, in a slip of the other sense where it cannot.

use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{Convention, Event, EventKind, Phase, Sense, Settings, ShaftStep, StickSlip};

const TICK_S: f64 = 5e-5;

/// The paper's numbers: J, kr, ωn, Tk and its angle.
const INERTIA: f64 = 0.01;
const STIFFNESS: f64 = 400.0;
const NATURAL_RAD_S: f64 = 200.0;
const CENTRE_RAD: f64 = 5e-4;

const MATCHING: [Convention; 2] = [Convention::Paper, Convention::Physical];

/// A hand at 1 rad/s, which breaks the stick after 1 ms.
const BREAK_S: f64 = 1e-3;

/// (θ, θ̇) of the object in its slip.
fn swing(time_s: f64) -> (f64, f64) {
    let (sin, cos) = (NATURAL_RAD_S * (time_s - BREAK_S)).sin_cos();
    (
        CENTRE_RAD * (1.0 + cos) + sin / NATURAL_RAD_S,
        cos - CENTRE_RAD * NATURAL_RAD_S * sin,
    )
}

/// A velocity that is linear between these places: (s, rad/s).
#[derive(Clone, Copy)]
struct Hand<'a> {
    knots: &'a [(f64, f64)],
    sign: f64,
}

impl Hand<'_> {
    fn omega(&self, time_s: f64) -> f64 {
        let mut pieces = self.knots.windows(2);
        let piece = pieces.find(|k| time_s <= k[1].0 + 1e-12);
        let &[(t0, a), (t1, b)] = piece.unwrap() else {
            unreachable!()
        };
        self.sign * (a + (b - a) * (time_s - t0) / (t1 - t0))
    }

    fn steps(&self) -> impl Iterator<Item = ShaftStep<f64>> {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "small"
        )]
        let ticks = (self.knots.last().unwrap().0 / TICK_S).round() as u32;
        (0..ticks).map(|n| {
            let (start, end) = (
                self.omega(f64::from(n) * TICK_S),
                self.omega(f64::from(n + 1) * TICK_S),
            );
            ShaftStep {
                delta_phi_rad: f64::midpoint(start, end) * TICK_S,
                omega_start_rad_s: start,
                omega_end_rad_s: end,
            }
        })
    }
}

/// The events, and where the object was seen at the ends of steps.
struct Followed {
    events: Vec<(f64, Event<f64>)>,
    object: Vec<(Phase, f64, f64)>,
}

impl JointVisitor<f64> for Hand<'_> {
    type Output = Followed;

    fn visit<J: StickSlip<f64>>(self, mut joint: J) -> Followed {
        let (mut events, mut object) = (Vec::new(), Vec::new());
        for (n, step) in (0_u32..).zip(self.steps()) {
            joint.step(&step, |e| {
                events.push(((f64::from(n) + e.fraction) * TICK_S, e));
            });
            object.push((joint.phase(), joint.theta_rad(), joint.theta_dot_rad_s()));
        }
        Followed { events, object }
    }
}

fn run(convention: Convention, knots: &[(f64, f64)], sign: f64) -> Followed {
    let settings = Settings {
        convention,
        ..Settings::default()
    };
    let hand = Hand { knots, sign };
    let valid = settings.validate().unwrap();
    let start = sign * knots[0].1;
    with_joint(&valid, Solver::ExactEvents, TICK_S, start, hand).unwrap()
}

#[test]
fn in_a_slip_the_object_swings_freely_from_where_it_broke() {
    for convention in MATCHING {
        for sign in [1.0, -1.0] {
            let seen = run(convention, &[(0.0, 1.0), (0.03, 1.0)], sign);
            for (n, (phase, theta, theta_dot)) in (1_u32..).zip(seen.object) {
                if n <= 20 {
                    continue;
                }
                assert_eq!(f64::from(phase.sign()), sign);
                let (expected, velocity) = swing(f64::from(n) * TICK_S);
                assert!((theta - sign * expected).abs() < 1e-12, "{n}: {theta}");
                assert!((theta_dot - sign * velocity).abs() < 1e-9);
            }
        }
    }
}

/// Required end of a slip whose hand falls to rest within 10 ms, and from 24 ms
/// on, just before the object has swung back as far as it can, accelerates.
struct End {
    acceleration: f64,
    convention: Convention,
    kind: EventKind,
    /// J·Ω̇ in the torque shown, as part of the whole of it.
    shown: f64,
}

#[test]
fn what_the_static_limit_cannot_hold_slips_the_other_way() {
    use Convention::{Paper, Physical};
    use EventKind::{Reverse, Stick};
    // The spring pulls with −1.8 N·m, J·Ω̇ holds against it.
    for (acceleration, convention, kind, shown) in [
        (0.0, Paper, Reverse, 0.0),
        (0.0, Physical, Reverse, 0.0),
        // −0.8 N·m in all.
        (100.0, Paper, Reverse, 0.0),
        (100.0, Physical, Reverse, 0.0),
        // −0.3 N·m: `physical` shows that, `paper` only the spring; but
        // it must slip, for −0.3 N·m is beyond Tk.
        (150.0, Paper, Reverse, 0.0),
        (150.0, Physical, Stick, 1.0),
        // −0.1 N·m: held at its limit.
        (170.0, Paper, Stick, 0.0),
        (170.0, Physical, Stick, 1.0),
    ] {
        let end = End {
            acceleration,
            convention,
            kind,
            shown,
        };
        for sign in [1.0, -1.0] {
            check(&end, sign);
        }
    }
}

fn check(end: &End, sign: f64) {
    let what = format!("{:?} at {} rad/s²", end.convention, end.acceleration);
    let (rest_s, end_s) = (0.024, 0.028);
    let knots = [
        (0.0, 1.0),
        (0.002, 1.0),
        (0.012, 0.0),
        (rest_s, 0.0),
        (end_s, end.acceleration * (end_s - rest_s)),
    ];
    // Where the velocities meet, by halving.
    let lead = |t: f64| end.acceleration * (t - rest_s) - swing(t).1;
    let (mut low, mut high) = (rest_s, end_s - 1e-3);
    assert!(lead(low) > 0.0 && lead(high) < 0.0, "{what}");
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        *(if lead(middle) > 0.0 {
            &mut low
        } else {
            &mut high
        }) = middle;
    }
    let (theta, velocity) = swing(low);
    let seen = run(end.convention, &knots, sign);
    let (time_s, e) = seen.events[1];
    assert_eq!(e.kind, end.kind, "{what}: {e:?}");
    assert!((time_s - low).abs() < 1e-12, "{what}: {time_s}, not {low}");
    assert!((e.theta_rad - sign * theta).abs() < 1e-12, "{what}");
    assert!((e.theta_dot_rad_s - sign * velocity).abs() < 1e-9, "{what}");
    assert!((e.torque_before_nm - sign * 0.2).abs() < 1e-15, "{what}");
    let sense = |s: f64| Sense::of(s).unwrap();
    assert_eq!(e.from, Phase::Slip(sense(sign)), "{what}");
    if end.kind == EventKind::Reverse {
        assert_eq!(e.to, Phase::Slip(sense(-sign)), "{what}");
        assert!((e.torque_after_nm + sign * 0.2).abs() < 1e-15, "{what}");
        assert_eq!(e.theta_dot_rad_s, e.omega_rad_s);
    } else {
        assert_eq!(e.to, Phase::Stick, "{what}");
        let torque = STIFFNESS * theta + end.shown * INERTIA * end.acceleration;
        let expected = sign * torque.max(-0.4);
        assert!((e.torque_after_nm - expected).abs() < 1e-9, "{what}: {e:?}");
        // And that is where it stays for a while.
        assert!(
            seen.events.len() == 2 || seen.events[2].0 > time_s + 1e-4,
            "{what}"
        );
    }
}
