//! Measured accuracy of each rung: orders of convergence at a constant
//! 0.988 rad/s under `physical`, the floor of f32, and the loss of the effect
//! under implicit Euler.

use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{Convention, EventKind, Real, Settings, ShaftStep, StickSlip};

const OMEGA: f64 = 0.988;
const SECONDS: f64 = 10.0;

/// Times of breaks and of sticks.
struct Times {
    breaks: Vec<f64>,
    sticks: Vec<f64>,
}

struct Run {
    omega: f64,
    step_s: f64,
}

impl<F: Real> JointVisitor<F> for Run {
    type Output = Times;

    fn visit<J: StickSlip<F>>(self, mut joint: J) -> Times {
        let step = ShaftStep {
            delta_phi_rad: F::from_f64(self.omega * self.step_s),
            omega_start_rad_s: F::from_f64(self.omega),
            omega_end_rad_s: F::from_f64(self.omega),
        };
        let mut times = Times {
            breaks: Vec::new(),
            sticks: Vec::new(),
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "small"
        )]
        let steps = (SECONDS / self.step_s) as u32;
        for n in 0..steps {
            joint.step(&step, |e| {
                let time = (f64::from(n) + e.fraction.to_f64()) * self.step_s;
                match e.kind {
                    EventKind::Break => times.breaks.push(time),
                    _ => times.sticks.push(time),
                }
            });
        }
        times
    }
}

fn run<F: Real>(solver: Solver, omega: f64, step_s: f64) -> Times {
    let settings = Settings {
        convention: Convention::Physical,
        ..Settings::default()
    };
    let settings = settings.validate().unwrap();
    with_joint::<F, _>(
        &settings,
        solver,
        step_s,
        F::from_f64(omega),
        Run { omega, step_s },
    )
    .unwrap()
}

/// Length of a cycle, s.
fn cycle(omega: f64) -> f64 {
    let lambda = 0.2 / (omega * 2.0);
    (std::f64::consts::TAU + 2.0 * (lambda - lambda.atan())) / 200.0
}

/// Relative error of the cycle frequency.
fn frequency_error(times: &Times, omega: f64) -> f64 {
    let (first, last) = (times.breaks[0], *times.breaks.last().unwrap());
    let cycles = f64::from(u32::try_from(times.breaks.len() - 1).unwrap());
    (cycles * cycle(omega) / (last - first) - 1.0).abs()
}

/// Worst error of an event's time, s; `None` if the sequence is not right.
fn event_error(times: &Times, omega: f64) -> Option<f64> {
    let first = 0.4 / (400.0 * omega);
    let slip = 2.0 * (std::f64::consts::PI - (0.1 / omega).atan()) / 200.0;
    let expected = ((SECONDS - 0.1 - first) / cycle(omega)).floor();
    let at = |list: &[f64], offset: f64| {
        let mut worst = 0.0_f64;
        let mut start = first + offset;
        let mut seen = 0.0;
        for time in list {
            worst = worst.max((time - start).abs());
            start += cycle(omega);
            seen += 1.0;
        }
        (seen >= expected && worst < cycle(omega) / 2.0).then_some(worst)
    };
    Some(at(&times.breaks, 0.0)?.max(at(&times.sticks, slip)?))
}

/// Steps from `longest` down, not commensurate with each other or the cycle.
fn steps(longest: f64, count: i32) -> Vec<f64> {
    (0..count).map(|i| longest * 0.83_f64.powi(i)).collect()
}

/// Slope of log error on log step, by least squares.
fn order(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<_> = points.iter().map(|(h, e)| (h.ln(), e.ln())).collect();
    let n = f64::from(u32::try_from(logs.len()).unwrap());
    let mean = |f: fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let cov: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    cov / logs.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

fn frequency_order(solver: Solver, longest: f64, count: i32) -> f64 {
    let points: Vec<_> = steps(longest, count)
        .into_iter()
        .map(|h| (h, frequency_error(&run::<f64>(solver, OMEGA, h), OMEGA)))
        .collect();
    order(&points)
}

fn event_order(solver: Solver, longest: f64, count: i32) -> f64 {
    let points: Vec<_> = steps(longest, count)
        .into_iter()
        .filter_map(|h| Some((h, event_error(&run::<f64>(solver, OMEGA, h), OMEGA)?)))
        .collect();
    assert!(points.len() >= 8, "{solver:?}: too few right sequences");
    order(&points)
}

#[test]
fn frequency_converges_with_the_order_that_location_allows() {
    for (solver, longest, count, expected, tolerance) in [
        // Without location every method is of first order, RK4 too.
        (Solver::Euler, 2e-6, 8, 1.0, 0.3),
        (Solver::Verlet, 1e-4, 22, 1.0, 0.4),
        (Solver::Rk4, 1e-4, 22, 1.0, 0.4),
        (Solver::Exact, 1e-4, 22, 1.0, 0.4),
        // The break alone buys the second, interpolation or RK4 the fourth.
        (Solver::ExactBreak, 4e-4, 14, 2.0, 0.3),
        (Solver::ExactInterpolated, 8e-4, 10, 4.0, 0.5),
        (Solver::Rk4Events, 8e-4, 10, 4.0, 0.3),
    ] {
        let order = frequency_order(solver, longest, count);
        println!("{:20} frequency order {order:.2}", solver.name());
        assert!(
            (order - expected).abs() < tolerance,
            "{solver:?}: {order:.2}, not {expected}"
        );
    }
}

#[test]
fn event_times_converge_with_orders_one_one_two() {
    for (solver, expected) in [
        (Solver::Exact, 1.0),
        (Solver::ExactBreak, 1.0),
        (Solver::ExactInterpolated, 2.0),
    ] {
        let order = event_order(solver, 4e-4, 12);
        println!("{:20} event-time order {order:.2}", solver.name());
        assert!(
            (order - expected).abs() < 0.35,
            "{solver:?}: {order:.2}, not {expected}"
        );
    }
}

#[test]
fn exact_events_are_exact_at_every_step() {
    for step_s in steps(1e-3, 12) {
        let times = run::<f64>(Solver::ExactEvents, OMEGA, step_s);
        assert!(frequency_error(&times, OMEGA) < 1e-14);
        assert!(event_error(&times, OMEGA).unwrap() < 1e-13);
    }
}

#[test]
fn semi_implicit_euler_is_erratic() {
    // Good and bad steps alternate: the scatter about any line is large.
    let errors: Vec<_> = steps(2e-4, 16)
        .into_iter()
        .map(|h| frequency_error(&run::<f64>(Solver::SemiImplicitEuler, OMEGA, h), OMEGA))
        .collect();
    let scatter = errors.windows(2).filter(|w| w[1] > w[0]).count();
    println!("semi-implicit-euler: {scatter} of 15 shorter steps are worse: {errors:?}");
    assert!(scatter >= 3);
}

#[test]
fn single_precision_keeps_its_digits_at_short_steps() {
    // With C in place of C − 1 the swing would be off by 1e-5 at 1 µs, where
    // C rounds to 1 (see `oscillator`).
    for step_s in [5e-5, 2e-5, 5e-6, 1e-6] {
        let error = frequency_error(&run::<f32>(Solver::ExactEvents, OMEGA, step_s), OMEGA);
        println!("exact-events in f32: {error:.1e} at {step_s:e} s");
        assert!(error < 1e-7, "{step_s}: {error:e}");
    }
}

#[test]
fn location_buys_digits_at_the_devices_tick() {
    // At 1 and 2 rad/s a stick lasts a whole number of ticks, and a method
    // without location is right by luck.
    for omega in [0.5, 0.7, 0.988, 1.3, 1.97] {
        let digits = |solver| -frequency_error(&run::<f64>(solver, omega, 5e-5), omega).log10();
        let none = digits(Solver::Exact);
        let (with_break, with_both) = (
            digits(Solver::ExactBreak),
            digits(Solver::ExactInterpolated),
        );
        println!(
            "{omega} rad/s: {none:.1} digits, break {with_break:.1}, interpolated {with_both:.1}"
        );
        assert!(with_break - none >= 1.5, "{omega}");
        assert!(with_both - none >= 4.0, "{omega}");
    }
}

#[test]
fn implicit_euler_loses_the_effect_where_its_damping_is_critical() {
    for omega in [0.2_f64, 0.5, 1.0] {
        let lambda = 0.1 / omega;
        // ωn·h/2 = λ²/4π.
        let critical_s = lambda * lambda / (2.0 * std::f64::consts::PI) / 200.0;
        let breaks = |factor: f64| {
            run::<f64>(Solver::ImplicitEuler, omega, critical_s * factor)
                .breaks
                .len()
        };
        let (below, above) = (breaks(0.8), breaks(1.25));
        println!(
            "{omega} rad/s: critical step {:.1} µs, {below} breaks below, {above} above",
            critical_s * 1e6
        );
        assert!(below > 200, "{omega}: {below}");
        assert!(above <= 2, "{omega}: {above}");
    }
}
