//! The stepping joint against the closed forms of constant speed.
//!
//! With Ω constant and c = 0 a cycle is known exactly: the stick lasts
//! 2(Ts − Tk)/(kr·Ω), the slip 2(π − atan λ)/ωn with
//! λ = (Ts − Tk)/(Ω·√(J·kr)), and the cycle frequency is
//! ωn/(2π + 2(λ − atan λ)).

use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{Convention, EventKind, Phase, Real, Restart, Settings, ShaftStep, StickSlip};

/// Events of one run: (time, kind, torque after).
type Events = Vec<(f64, EventKind, f64)>;

struct ConstantSpeed {
    omega: f64,
    step_s: f64,
    steps: u32,
}

impl<F: Real> JointVisitor<F> for ConstantSpeed {
    type Output = Events;

    fn visit<J: StickSlip<F>>(self, mut joint: J) -> Events {
        let omega = F::from_f64(self.omega);
        let step = ShaftStep {
            delta_phi_rad: F::from_f64(self.omega * self.step_s),
            omega_start_rad_s: omega,
            omega_end_rad_s: omega,
        };
        let mut events = Events::new();
        for n in 0..self.steps {
            joint.step(&step, |e| {
                let time_s = (f64::from(n) + e.fraction.to_f64()) * self.step_s;
                events.push((time_s, e.kind, e.torque_after_nm.to_f64()));
            });
            assert!(
                joint.torque_nm().abs()
                    <= F::from_f64(Settings::default().parameters.static_torque_nm)
            );
        }
        events
    }
}

fn run<F: Real>(convention: Convention, solver: Solver, omega: f64, seconds: f64) -> Events {
    let settings = Settings {
        convention,
        ..Settings::default()
    };
    run_with::<F>(settings, solver, omega, seconds)
}

fn run_with<F: Real>(settings: Settings, solver: Solver, omega: f64, seconds: f64) -> Events {
    let step_s = 5e-5;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "small"
    )]
    let steps = (seconds / step_s).round() as u32;
    with_joint::<F, _>(
        &settings.validate().unwrap(),
        solver,
        step_s,
        F::from_f64(omega),
        ConstantSpeed {
            omega,
            step_s,
            steps,
        },
    )
    .unwrap()
}

/// Break and stick times in order, from the closed forms.
fn expected(omega: f64, seconds: f64) -> Vec<f64> {
    let p = Settings::default().parameters;
    let drop = p.static_torque_nm - p.kinetic_torque_nm;
    let lambda = drop / (omega.abs() * p.impedance_nms_per_rad());
    let stick = 2.0 * drop / (p.stiffness_nm_per_rad * omega.abs());
    let slip = 2.0 * (std::f64::consts::PI - lambda.atan()) / p.natural_rad_s();
    let first = p.static_torque_nm / (p.stiffness_nm_per_rad * omega.abs());
    (0..100_000)
        .flat_map(|cycle| {
            let start = first + f64::from(cycle) * (stick + slip);
            [start, start + slip]
        })
        .take_while(|t| *t < seconds)
        .collect()
}

fn worst_error(events: &Events, omega: f64, seconds: f64) -> f64 {
    let expected = expected(omega, seconds);
    assert_eq!(events.len(), expected.len(), "event count at {omega} rad/s");
    events
        .iter()
        .zip(&expected)
        .map(|((t, ..), e)| (t - e).abs())
        .fold(0.0, f64::max)
}

const SPEEDS: [f64; 7] = [0.05, 0.1, 0.3, 0.5, 1.0, 2.0, 3.0];

#[test]
fn exact_events_find_every_event_in_double_precision() {
    for convention in Convention::ALL {
        for omega in SPEEDS {
            let events = run::<f64>(convention, Solver::ExactEvents, omega, 10.0);
            let worst = worst_error(&events, omega, 10.0);
            println!("{convention:?} {omega} rad/s: worst event error {worst:.1e} s (f64)");
            assert!(worst <= 1e-12, "{convention:?} {omega} rad/s: {worst:e} s");
        }
    }
}

#[test]
fn exact_events_find_every_event_in_single_precision() {
    for (convention, allowed) in [
        (Convention::Frozen, 2e-6),
        (Convention::Paper, 5e-5),
        (Convention::Physical, 5e-5),
    ] {
        for omega in SPEEDS {
            let events = run::<f32>(convention, Solver::ExactEvents, omega, 10.0);
            let worst = worst_error(&events, omega, 10.0);
            println!("{convention:?} {omega} rad/s: worst event error {worst:.1e} s (f32)");
            assert!(
                worst <= allowed,
                "{convention:?} {omega} rad/s: {worst:e} s"
            );
        }
    }
}

#[test]
fn switching_at_the_end_of_the_step_finds_every_cycle_but_late() {
    for convention in Convention::ALL {
        let events = run::<f64>(convention, Solver::Exact, 0.988, 10.0);
        let exact = expected(0.988, 10.0);
        // The last cycle may have drifted beyond the end of the run.
        assert!(events.len() + 2 >= exact.len(), "{convention:?}");
        let rate = |times: &mut dyn Iterator<Item = f64>| {
            let times: Vec<f64> = times.collect();
            f64::from(u32::try_from(times.len() - 1).unwrap()) / (times.last().unwrap() - times[0])
        };
        let seen = rate(
            &mut events
                .iter()
                .filter(|e| e.1 == EventKind::Break)
                .map(|e| e.0),
        );
        let truth = rate(&mut exact.iter().step_by(2).copied());
        let error = (seen / truth - 1.0).abs();
        assert!(error > 1e-6 && error < 2e-3, "{convention:?}: {error:e}");
    }
}

#[test]
fn torque_restarts_where_the_rule_says() {
    for (restart, expected) in [(Restart::Elastic, 0.0), (Restart::FromKinetic, 0.2)] {
        let settings = Settings {
            restart,
            ..Settings::default()
        };
        let events = run_with::<f64>(settings, Solver::ExactEvents, 1.0, 0.5);
        for (_, kind, after) in events {
            let wanted = if kind == EventKind::Stick {
                expected
            } else {
                0.2
            };
            assert!(
                (after - wanted).abs() < 1e-15,
                "{restart:?} {kind:?}: {after}"
            );
        }
    }
}

/// A joint's complete output for a sequence of steps.
struct Record<'a> {
    steps: &'a [ShaftStep<f64>],
}

type Row = (Phase, f64, f64, f64);

impl<F: Real> JointVisitor<F> for Record<'_> {
    type Output = (Vec<Row>, Vec<(EventKind, f64, f64)>);

    fn visit<J: StickSlip<F>>(self, mut joint: J) -> Self::Output {
        let (mut rows, mut events) = (Vec::new(), Vec::new());
        for s in self.steps {
            let step = ShaftStep {
                delta_phi_rad: F::from_f64(s.delta_phi_rad),
                omega_start_rad_s: F::from_f64(s.omega_start_rad_s),
                omega_end_rad_s: F::from_f64(s.omega_end_rad_s),
            };
            joint.step(&step, |e| {
                events.push((e.kind, e.fraction.to_f64(), e.theta_rad.to_f64()));
            });
            rows.push((
                joint.phase(),
                joint.torque_nm().to_f64(),
                joint.theta_rad().to_f64(),
                joint.theta_dot_rad_s().to_f64(),
            ));
        }
        (rows, events)
    }
}

/// A lively motion: speeds up, turns back inside sticks and slips, rests.
fn lively() -> Vec<ShaftStep<f64>> {
    let (h, n) = (5e-5, 40_000_u32);
    let phi = |t: f64| 0.02 * (17.0 * t).sin() + 0.3 * (1.7 * t).sin();
    let omega = |t: f64| 0.34 * (17.0 * t).cos() + 0.51 * (1.7 * t).cos();
    (0..n)
        .map(|i| {
            let (a, b) = (f64::from(i) * h, f64::from(i + 1) * h);
            ShaftStep {
                delta_phi_rad: phi(b) - phi(a),
                omega_start_rad_s: omega(a),
                omega_end_rad_s: omega(b),
            }
        })
        .collect()
}

#[test]
fn the_mirrored_motion_gives_the_mirrored_torque_to_the_bit() {
    fn check<F: Real>() {
        let steps = lively();
        let mirrored: Vec<_> = steps
            .iter()
            .map(|s| ShaftStep {
                delta_phi_rad: -s.delta_phi_rad,
                omega_start_rad_s: -s.omega_start_rad_s,
                omega_end_rad_s: -s.omega_end_rad_s,
            })
            .collect();
        for convention in Convention::ALL {
            for solver in Solver::ALL {
                if solver.refusal_in::<F>(convention).is_some() {
                    continue;
                }
                let settings = Settings {
                    convention,
                    ..Settings::default()
                }
                .validate()
                .unwrap();
                let of = |steps: &[ShaftStep<f64>]| {
                    with_joint::<F, _>(
                        &settings,
                        solver,
                        5e-5,
                        F::from_f64(steps[0].omega_start_rad_s),
                        Record { steps },
                    )
                    .unwrap()
                };
                let ((rows, events), (mirror_rows, mirror_events)) = (of(&steps), of(&mirrored));
                assert!(
                    events.len() > 10,
                    "{convention:?} {solver:?}: {}",
                    events.len()
                );
                for (a, b) in rows.iter().zip(&mirror_rows) {
                    assert_eq!(a.0.sign(), -b.0.sign());
                    for (x, y) in [(a.1, b.1), (a.2, b.2), (a.3, b.3)] {
                        // Zero has two signs and one meaning.
                        assert!(x.to_bits() == (-y).to_bits() || (x == 0.0 && y == 0.0));
                    }
                }
                for (a, b) in events.iter().zip(&mirror_events) {
                    assert_eq!((a.0, a.1.to_bits()), (b.0, b.1.to_bits()));
                    assert_eq!(a.2, -b.2);
                }
            }
        }
    }
    check::<f64>();
    check::<f32>();
}

/// Slips that begin and end within one step, of a light object and of one that
/// is as heavy as allowed: 16 µs in 50 µs, 0.3 s in 1 s.
#[test]
fn slips_shorter_than_a_step_are_found() {
    // Ts − Tk = Tk = 0.2 N·m, λ = 100 and 20.
    for (inertia, stiffness, omega, step_s, lambda) in [
        (1e-8, 400.0, 1.0, 5e-5, 100.0_f64),
        (100.0, 1e4, 1e-5, 1.0, 20.0),
    ] {
        let slip_s = 2.0 * (std::f64::consts::PI - lambda.atan()) * f64::sqrt(inertia / stiffness);
        let stick_s = 0.4 / (stiffness * omega);
        for convention in Convention::ALL {
            let mut settings = Settings {
                convention,
                ..Settings::default()
            };
            settings.parameters.inertia_kg_m2 = inertia;
            settings.parameters.stiffness_nm_per_rad = stiffness;
            let valid = settings.validate().unwrap();
            for sign in [1.0, -1.0] {
                let run = |solver| {
                    let steady = ConstantSpeed {
                        omega: sign * omega,
                        step_s,
                        steps: 1000,
                    };
                    with_joint::<f64, _>(&valid, solver, step_s, sign * omega, steady).unwrap()
                };
                let events = run(Solver::ExactEvents);
                assert!(events.len() > 80, "{convention:?}: {}", events.len());
                let mut within_a_step = 0;
                let mut expected = stick_s;
                for pair in events.chunks_exact(2) {
                    let (begins, ends) = (pair[0].0, pair[1].0);
                    assert!(
                        (begins - expected).abs() < 1e-9 * step_s,
                        "{convention:?}: {begins}"
                    );
                    assert!(
                        (ends - begins - slip_s).abs() < 1e-9 * step_s,
                        "{convention:?}: {ends}"
                    );
                    within_a_step +=
                        u32::from((begins / step_s).floor() == (ends / step_s).floor());
                    expected = ends + stick_s;
                }
                assert!(within_a_step > 20);
                // With one chord a step, such a slip lasts to the end of its step.
                let events = run(Solver::ExactInterpolated);
                assert!(events.len() > 80, "{convention:?}: {}", events.len());
                assert!(
                    events
                        .windows(2)
                        .all(|e| e[1].0 > e[0].0 && e[1].1 != e[0].1)
                );
            }
        }
    }
}
