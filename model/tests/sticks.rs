//! Torque that a stick shows, and time of its break: the spring alone under `frozen` and
//! `paper`, with the object's inertia and damping under `physical`.

use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{
    Convention, Event, EventKind, Parameters, Phase, Settings, ShaftStep, StickSlip, Validated,
};

const TICK_S: f64 = 5e-5;

/// The conventions under which the object has its own velocity.
const MATCHING: [Convention; 2] = [Convention::Paper, Convention::Physical];

fn settings(convention: Convention, parameters: Parameters) -> Validated<Settings> {
    let settings = Settings {
        parameters,
        convention,
        ..Settings::default()
    };
    settings.validate().unwrap()
}

fn damped(damping_nms_per_rad: f64) -> Parameters {
    Parameters {
        damping_nms_per_rad,
        ..Parameters::default()
    }
}

/// J·Ω̇ + c·Ω where the convention has it.
fn inertial(settings: &Settings, omega: f64, omega_dot: f64) -> f64 {
    let p = &settings.parameters;
    match settings.convention {
        Convention::Physical => p.inertia_kg_m2 * omega_dot + p.damping_nms_per_rad * omega,
        _ => 0.0,
    }
}

/// State of a joint after a step: phase, torque, angle, velocity.
type Row = (Phase, f64, f64, f64);

/// Steps a joint, or restarts it first, with this torque and velocity.
struct Run<'a> {
    steps: &'a [ShaftStep<f64>],
    step_s: f64,
    put_down: Option<(f64, f64)>,
}

impl JointVisitor<f64> for Run<'_> {
    type Output = (Vec<Row>, Vec<(f64, Event<f64>)>);

    fn visit<J: StickSlip<f64>>(self, mut joint: J) -> Self::Output {
        if let Some((torque, omega)) = self.put_down {
            joint.restart(torque, omega);
        }
        let (mut rows, mut events) = (Vec::new(), Vec::new());
        for (n, step) in (0_u32..).zip(self.steps) {
            joint.step(step, |e| {
                events.push(((f64::from(n) + e.fraction) * self.step_s, e));
            });
            rows.push((
                joint.phase(),
                joint.torque_nm(),
                joint.theta_rad(),
                joint.theta_dot_rad_s(),
            ));
        }
        (rows, events)
    }
}

fn run(
    settings: &Validated<Settings>,
    solver: Solver,
    step_s: f64,
    steps: &[ShaftStep<f64>],
    put_down: Option<(f64, f64)>,
) -> (Vec<Row>, Vec<(f64, Event<f64>)>) {
    let run = Run {
        steps,
        step_s,
        put_down,
    };
    let omega = steps[0].omega_start_rad_s;
    with_joint(settings, solver, step_s, omega, run).unwrap()
}

fn rungs(convention: Convention) -> impl Iterator<Item = Solver> {
    let has_meaning = move |solver: &Solver| solver.refusal(convention).is_none();
    Solver::ALL.into_iter().filter(has_meaning)
}

/// Steps of a shaft from this velocity with this acceleration.
fn accelerating(omega: f64, omega_dot: f64, step_s: f64, steps: u32) -> Vec<ShaftStep<f64>> {
    (0..steps)
        .map(|n| {
            let at = |n: u32| omega + omega_dot * f64::from(n) * step_s;
            ShaftStep {
                delta_phi_rad: f64::midpoint(at(n), at(n + 1)) * step_s,
                omega_start_rad_s: at(n),
                omega_end_rad_s: at(n + 1),
            }
        })
        .collect()
}

#[test]
fn a_stick_shows_its_spring_and_under_physical_what_moves_the_object() {
    for convention in MATCHING {
        let s = settings(convention, damped(0.3));
        for solver in rungs(convention) {
            for sign in [1.0, -1.0] {
                let steps = accelerating(sign * 0.1, sign * 5.0, TICK_S, 100);
                let (rows, events) = run(&s, solver, TICK_S, &steps, None);
                assert!(events.is_empty(), "{convention:?} {solver:?}: {events:?}");
                let mut phi = 0.0;
                for (step, (phase, torque, theta, theta_dot)) in steps.iter().zip(rows) {
                    phi += step.delta_phi_rad;
                    let omega = step.omega_end_rad_s;
                    let expected = 400.0 * phi + inertial(&s, omega, sign * 5.0);
                    assert_eq!(phase, Phase::Stick);
                    assert!(
                        (torque - expected).abs() < 1e-12,
                        "{convention:?} {solver:?}"
                    );
                    assert!((theta - phi).abs() < 1e-15);
                    assert_eq!(theta_dot, omega);
                }
            }
        }
    }
}

#[test]
fn a_hand_that_accelerates_breaks_it_when_the_whole_torque_is_at_the_limit() {
    // kr·α·t²/2 + c·α·t + J·α = Ts
    let (c, alpha) = (0.3, 5.0);
    for convention in MATCHING {
        let s = settings(convention, damped(c));
        let (a, b) = (400.0 * alpha / 2.0, inertial(&s, alpha, 0.0));
        let left = 0.4 - inertial(&s, 0.0, alpha);
        let expected = ((b * b + 4.0 * a * left).sqrt() - b) / (2.0 * a);
        for solver in [Solver::ExactBreak, Solver::ExactEvents, Solver::Rk4Events] {
            for sign in [1.0, -1.0] {
                for (step_s, n) in [(TICK_S, 600), (7e-3, 4), (0.03, 1)] {
                    let steps = accelerating(0.0, sign * alpha, step_s, n);
                    let (_, events) = run(&s, solver, step_s, &steps, None);
                    let (time_s, e) = events[0];
                    assert!(
                        (time_s - expected).abs() < 1e-12,
                        "{convention:?} {step_s}: {time_s}"
                    );
                    assert_eq!(e.kind, EventKind::Break);
                    assert!((e.torque_before_nm - sign * 0.4).abs() < 1e-12);
                    assert!((e.theta_rad - sign * alpha * expected * expected / 2.0).abs() < 1e-12);
                    assert!((e.omega_rad_s - sign * alpha * expected).abs() < 1e-10);
                    assert_eq!(e.torque_after_nm, sign * 0.2);
                }
            }
        }
    }
}

#[test]
fn a_jerk_breaks_a_physical_stick_from_the_torque_that_it_showed() {
    // 0.2 N·m of the spring, and then 1 N·m more for the object.
    let s = settings(Convention::Physical, Parameters::default());
    for sign in [1.0, -1.0] {
        let mut steps = accelerating(sign, 0.0, TICK_S, 10);
        steps.extend(accelerating(sign, sign * 100.0, TICK_S, 1));
        let (_, events) = run(&s, Solver::ExactEvents, TICK_S, &steps, None);
        let (time_s, e) = events[0];
        assert!((time_s - 10.0 * TICK_S).abs() < 1e-15, "{time_s}");
        assert!((e.torque_before_nm - sign * 0.2).abs() < 1e-12, "{e:?}");
        assert_eq!(e.torque_after_nm, sign * 0.2);
    }
}

#[test]
fn a_restarted_joint_resumes_from_its_torque() {
    for convention in Convention::ALL {
        let c = if convention == Convention::Frozen {
            0.0
        } else {
            0.1
        };
        let s = settings(convention, damped(c));
        for solver in rungs(convention) {
            for omega in [0.3, -0.3] {
                let steps = accelerating(omega, 0.0, TICK_S, 5);
                let (rows, _) = run(&s, solver, TICK_S, &steps, Some((0.15, omega)));
                for (n, (phase, torque, ..)) in (1_u32..).zip(rows) {
                    let expected = 0.15 + 400.0 * omega * TICK_S * f64::from(n);
                    assert_eq!(phase, Phase::Stick);
                    assert!(
                        (torque - expected).abs() < 1e-12,
                        "{convention:?} {solver:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_spring_that_just_holds_holds() {
    // Numbers that are exact: Ts = 1/2, θ = 2^−10.
    let p = Parameters {
        stiffness_nm_per_rad: 512.0,
        static_torque_nm: 0.5,
        kinetic_torque_nm: 0.25,
        ..Parameters::default()
    };
    for convention in Convention::ALL {
        for solver in rungs(convention) {
            for torque in [0.5, -0.5] {
                let s = settings(convention, p);
                let steps = [ShaftStep::default(); 100];
                let (rows, events) = run(&s, solver, TICK_S, &steps, Some((torque, 0.0)));
                assert!(events.is_empty(), "{convention:?} {solver:?}");
                assert!(
                    rows.iter()
                        .all(|row| row.0 == Phase::Stick && row.1 == torque)
                );
            }
        }
    }
}

/// A `paper` stick as its definition has it: it breaks where the spring is at
/// Ts and the torque with all that is hidden from it at Tk, in one sense, and
/// is held at the limit until then. By looking at very many places.
struct Definition {
    settings: Validated<Settings>,
    step_s: f64,
}

/// A motion that only just breaks a stick, or only just does not.
struct Unclear;

/// Time and sense of a break.
struct Break {
    time_s: f64,
    sign: f64,
}

impl Definition {
    /// Torque by which a break in this sense is still missed, N·m, at `time_s`
    /// into a step that began with the spring at `theta`.
    fn missing(&self, step: &ShaftStep<f64>, theta: f64, time_s: f64, sign: f64) -> f64 {
        let p = &self.settings.parameters;
        let h = self.step_s;
        let omega_dot = (step.omega_end_rad_s - step.omega_start_rad_s) / h;
        let omega = step.omega_start_rad_s + omega_dot * time_s;
        let spring = p.stiffness_nm_per_rad * (theta + step.travel(time_s / h, h));
        let truth = spring + p.inertia_kg_m2 * omega_dot + p.damping_nms_per_rad * omega;
        (p.static_torque_nm - sign * spring).max(p.kinetic_torque_nm - sign * truth)
    }

    /// The first break, if there is one.
    fn first_break(&self, steps: &[ShaftStep<f64>]) -> Result<Option<Break>, Unclear> {
        let mut theta = 0.0;
        for (n, step) in (0_u32..).zip(steps) {
            let begins_s = f64::from(n) * self.step_s;
            let mut first: Option<Break> = None;
            for sign in [1.0, -1.0] {
                if let Some(after_s) = self.in_a_step(step, theta, sign)? {
                    let time_s = begins_s + after_s;
                    if first.as_ref().is_none_or(|f| time_s < f.time_s) {
                        first = Some(Break { time_s, sign });
                    }
                }
            }
            if first.is_some() {
                return Ok(first);
            }
            theta += step.delta_phi_rad;
        }
        Ok(None)
    }

    /// The first break of a step in one sense, s after its beginning.
    fn in_a_step(
        &self,
        step: &ShaftStep<f64>,
        theta: f64,
        sign: f64,
    ) -> Result<Option<f64>, Unclear> {
        const PLACES: u32 = 400;
        let missing = |time_s| self.missing(step, theta, time_s, sign);
        let at = |i: u32| f64::from(i) / f64::from(PLACES) * self.step_s;
        let values: Vec<_> = (0..=PLACES).map(|i| missing(at(i))).collect();
        let first = (0..=PLACES).zip(&values).find(|(_, m)| **m <= 0.0);
        // Between two places before it, there may have been another.
        let before = first.map_or(values.len(), |(i, _)| i as usize);
        let dips = |m: &[f64]| m[1] <= m[0].min(m[2]) && m[1] < 2.0 * m[0].max(m[2]) - 2.0 * m[1];
        if values[..before].windows(3).any(dips) {
            return Err(Unclear);
        }
        let Some((i, _)) = first else { return Ok(None) };
        let (mut low, mut high) = (at(i.saturating_sub(1)), at(i));
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            *(if missing(middle) > 0.0 {
                &mut low
            } else {
                &mut high
            }) = middle;
        }
        // The torque must go on outwards, and not only for rounding.
        if missing(high + 1e-3 * self.step_s) < -1e-9 {
            Ok(Some(if i == 0 { 0.0 } else { high }))
        } else {
            Err(Unclear)
        }
    }
}

/// Compares the first break of a `paper` stick with its definition: `None` if
/// that is not clear, or whether the stick was held at its limit on the way.
fn held_as_defined(parameters: Parameters, step_s: f64, steps: &[ShaftStep<f64>]) -> Option<bool> {
    let settings = settings(Convention::Paper, parameters);
    let definition = Definition { settings, step_s };
    let expected = definition.first_break(steps).ok()?;
    let (rows, events) = run(&settings, Solver::ExactEvents, step_s, steps, None);
    let what = || format!("{parameters:?} {steps:?}");
    match (&expected, events.first()) {
        (None, None) => {}
        (Some(expected), Some((time_s, e))) => {
            assert_eq!(e.kind, EventKind::Break);
            assert_eq!(f64::from(e.to.sign()), expected.sign, "{}", what());
            let off = time_s - expected.time_s;
            assert!(off.abs() < 1e-9 * step_s.max(1e-3), "{off:e} s: {}", what());
        }
        (expected, found) => {
            let expected = expected.as_ref().map(|f| (f.time_s, f.sign));
            panic!("{expected:?}, not {found:?}: {}", what())
        }
    }
    let until = expected.map_or(f64::INFINITY, |f| f.time_s);
    let (mut theta, mut held) = (0.0, false);
    for (n, (step, row)) in (1_u32..).zip(steps.iter().zip(rows)) {
        if f64::from(n) * step_s >= until {
            break;
        }
        theta += step.delta_phi_rad;
        let spring = parameters.stiffness_nm_per_rad * theta;
        let limit = parameters.static_torque_nm;
        held |= spring.abs() > limit;
        assert!(
            (row.1 - spring.clamp(-limit, limit)).abs() < 1e-12,
            "{}",
            what()
        );
    }
    Some(held)
}

#[test]
fn a_paper_stick_that_cannot_slip_yet_is_held_at_its_limit() {
    let mut random = fastrand::Rng::with_seed(1);
    let mut between = |low: f64, high: f64| low + (high - low) * random.f64();
    let (mut clear, mut held) = (0, 0);
    for _ in 0..2000 {
        let parameters = Parameters {
            inertia_kg_m2: 10_f64.powf(between(-4.0, -1.5)),
            stiffness_nm_per_rad: 400.0,
            damping_nms_per_rad: between(-1.0, 2.0).max(0.0),
            kinetic_torque_nm: between(0.1, 0.4),
            static_torque_nm: 0.4,
        };
        let step_s = 10_f64.powf(between(-4.0, -2.0));
        // About as far as a stick goes; the speed may be known badly.
        let reach = 1.5e-3 / step_s;
        let mut omega = between(0.0, reach);
        let badly = between(-2.0, 1.0).max(0.0) * reach;
        let steps: Vec<_> = (0..6)
            .map(|_| {
                let (a, b) = (omega, between(-reach, reach));
                omega = b;
                ShaftStep {
                    delta_phi_rad: (f64::midpoint(a, b) + between(-badly, badly)) * step_s,
                    omega_start_rad_s: a,
                    omega_end_rad_s: b,
                }
            })
            .collect();
        if let Some(was_held) = held_as_defined(parameters, step_s, &steps) {
            clear += 1;
            held += u32::from(was_held);
        }
    }
    println!("{clear} clear, {held} held");
    assert!(clear > 1900 && held > 200, "{clear}, {held}");
}

#[test]
fn a_stick_is_held_twice_in_one_step() {
    // (Δφ in mrad, Ω at both ends): in the fourth step the spring falls below
    // its limit before the object can slip, and the torque with all that is
    // hidden passes Tk where the spring is below it.
    let steps = [
        (0.2, 0.6, -0.41),
        (-1.14, -0.41, -0.66),
        (-0.084, -0.66, 0.58),
        (0.51, 0.58, -0.1),
    ]
    .map(|(mrad, omega_start_rad_s, omega_end_rad_s)| ShaftStep {
        delta_phi_rad: mrad * 1e-3,
        omega_start_rad_s,
        omega_end_rad_s,
    });
    let parameters = Parameters {
        inertia_kg_m2: 1.3e-3,
        damping_nms_per_rad: 1.05,
        kinetic_torque_nm: 0.34,
        ..Parameters::default()
    };
    assert_eq!(held_as_defined(parameters, 2.13e-3, &steps), Some(true));
}
