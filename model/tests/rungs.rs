//! Every rung of the ladder is a way to the same motion: with a short step all
//! of them find the events of `exact-events`, at rest, through reversals, and
//! with damping.

#![allow(clippy::cast_precision_loss, reason = "small numbers")]

use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{
    Convention, EventKind, Parameters, Phase, Real, Settings, ShaftStep, StickSlip, Validated,
};

const STEP_S: f64 = 1e-5;
const STEPS: u32 = 120_000;

/// The shaft's velocity at a time, rad/s.
type Velocity = fn(f64) -> f64;

/// Slow enough that numerical damping of a short step does no harm: λ ≥ 0.3.
const MOTIONS: [(&str, Velocity); 3] = [
    ("steady", |_| -0.2),
    ("to and fro", |t| 0.25 * (1.9 * t).cos()),
    ("dwelling", |t| {
        if t < 0.4 {
            0.15
        } else if t < 0.5 {
            0.15 * (0.5 - t) * 10.0
        } else if t < 0.7 {
            0.0
        } else {
            -0.3 * (t - 0.7)
        }
    }),
];

#[derive(Debug, Default)]
struct Outcome {
    /// Times of events, and the phases before and after.
    events: Vec<(f64, i8, i8)>,
    /// ∫T dt, N·m·s, and ∫θ̇ dt of the object, rad.
    impulse: f64,
    travelled: f64,
    /// θ at the end, rad.
    theta: f64,
    worst_nm: f64,
}

struct Run(Velocity);

impl<F: Real> JointVisitor<F> for Run {
    type Output = Outcome;

    fn visit<J: StickSlip<F>>(self, mut joint: J) -> Outcome {
        let mut seen = Outcome::default();
        for n in 0..STEPS {
            let (from_s, to_s) = (f64::from(n) * STEP_S, f64::from(n + 1) * STEP_S);
            let (a, b) = ((self.0)(from_s), (self.0)(to_s));
            let step = ShaftStep {
                delta_phi_rad: F::from_f64(f64::midpoint(a, b) * STEP_S),
                omega_start_rad_s: F::from_f64(a),
                omega_end_rad_s: F::from_f64(b),
            };
            joint.step(&step, |e| {
                let time_s = from_s + e.fraction.to_f64() * STEP_S;
                seen.events.push((time_s, e.from.sign(), e.to.sign()));
                let kind = match (e.from, e.to) {
                    (Phase::Stick, _) => EventKind::Break,
                    (_, Phase::Stick) => EventKind::Stick,
                    _ => EventKind::Reverse,
                };
                assert_eq!(e.kind, kind);
                // An event's own torques are those of the phases beside it.
                let kinetic = |phase: Phase| f64::from(phase.sign()) * 0.2;
                if e.to != Phase::Stick {
                    assert!((e.torque_after_nm.to_f64() - kinetic(e.to)).abs() < 1e-6);
                }
                if e.from != Phase::Stick {
                    assert!((e.torque_before_nm.to_f64() - kinetic(e.from)).abs() < 1e-6);
                }
            });
            seen.impulse += joint.torque_nm().to_f64() * STEP_S;
            seen.travelled += joint.theta_dot_rad_s().to_f64() * STEP_S;
            seen.worst_nm = seen.worst_nm.max(joint.torque_nm().abs().to_f64());
        }
        seen.theta = joint.theta_rad().to_f64();
        seen
    }
}

fn run(settings: &Validated<Settings>, solver: Solver, velocity: Velocity) -> Outcome {
    with_joint::<f64, _>(settings, solver, STEP_S, velocity(0.0), Run(velocity)).unwrap()
}

/// Allowed error of an event of a rung after a second, in steps.
fn steps_off(solver: Solver) -> f64 {
    match solver {
        // Their damping, or its opposite, shifts every match.
        Solver::Euler | Solver::ImplicitEuler => 300.0,
        Solver::ExactEvents | Solver::ExactBreak => 1.1,
        Solver::ExactInterpolated => 1e-2,
        Solver::Rk4Events | Solver::ExactHermite => 1e-6,
        _ => 40.0,
    }
}

#[test]
fn every_rung_finds_the_events_of_the_exact_one() {
    for convention in Convention::ALL {
        for damping_nms_per_rad in [0.0, 0.02] {
            let settings = Settings {
                parameters: Parameters {
                    damping_nms_per_rad,
                    ..Parameters::default()
                },
                convention,
                ..Settings::default()
            };
            let Ok(settings) = settings.validate() else {
                assert_eq!(convention, Convention::Frozen);
                continue;
            };
            for (name, velocity) in MOTIONS {
                let exact = run(&settings, Solver::ExactEvents, velocity);
                assert!(exact.events.len() > 8, "{name}: {}", exact.events.len());
                for solver in Solver::ALL {
                    if solver.refusal(convention).is_none() {
                        let seen = run(&settings, solver, velocity);
                        let what = format!(
                            "{} {} c = {damping_nms_per_rad} {name}",
                            convention.name(),
                            solver.name()
                        );
                        compare(&what, solver, &seen, &exact);
                    }
                }
            }
        }
    }
}

fn compare(what: &str, solver: Solver, seen: &Outcome, exact: &Outcome) {
    let within_s = steps_off(solver) * STEP_S;
    // The last event may fall beyond the end.
    let both = seen.events.len().min(exact.events.len());
    let end_s = f64::from(STEPS) * STEP_S;
    let beyond = seen.events.len().abs_diff(exact.events.len());
    let all = seen.events.iter().chain(&exact.events);
    let last_s = all.map(|e| e.0).fold(0.0, f64::max);
    assert!(
        beyond == 0 || (beyond == 1 && last_s > end_s - within_s),
        "{what}: {} events for {}",
        seen.events.len(),
        exact.events.len()
    );
    let phases = |s: &Outcome| {
        s.events
            .iter()
            .take(both)
            .map(|e| (e.1, e.2))
            .collect::<Vec<_>>()
    };
    assert_eq!(phases(seen), phases(exact), "{what}");
    let mut worst_s = 0.0_f64;
    for (a, b) in seen.events.iter().zip(&exact.events) {
        worst_s = worst_s.max((a.0 - b.0).abs());
    }
    println!("{what}: events within {:.1e} steps", worst_s / STEP_S);
    assert!(worst_s <= within_s, "{what}: {worst_s:e} s");
    // The object swings by at most 2 mrad, so it has gone where the shaft has.
    assert!(
        (seen.travelled - exact.travelled).abs() < 4e-3,
        "{what}: {seen:?}"
    );
    assert!(
        (seen.impulse - exact.impulse).abs() < 0.4 * exact.events.len() as f64 * within_s + 1e-5,
        "{what}"
    );
    assert!(
        seen.theta.abs() < 4e-3 && seen.worst_nm <= 0.4,
        "{what}: {seen:?}"
    );
}
