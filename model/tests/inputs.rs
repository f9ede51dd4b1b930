//! Invalid input: whatever the sensor delivers, the joint stays valid, and its
//! torque is held and then released.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "small numbers, and f32 is what is tested"
)]

use crepitus_model::render::input_check::{CATCH_UP_TICKS, InputLimits};
use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{
    Convention, EVENTS_PER_STEP, Event, Guarded, Phase, Real, Sample, Settings, ShaftStep,
    StickSlip,
};

const TICK_S: f64 = 5e-5;
const OMEGA: f64 = 0.9;

fn step<F: Real>(delta_phi: f64, start: f64, end: f64) -> ShaftStep<F> {
    ShaftStep {
        delta_phi_rad: F::from_f64(delta_phi),
        omega_start_rad_s: F::from_f64(start),
        omega_end_rad_s: F::from_f64(end),
    }
}

fn good<F: Real>() -> Sample<F> {
    Sample::Taken(step(OMEGA * TICK_S, OMEGA, OMEGA))
}

/// Samples of what no shaft can have done.
fn impossible<F: Real>() -> Vec<Sample<F>> {
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    let d = OMEGA * TICK_S;
    [
        step(nan, OMEGA, OMEGA),
        step(inf, OMEGA, OMEGA),
        step(-inf, OMEGA, OMEGA),
        step(d, nan, OMEGA),
        step(d, OMEGA, nan),
        step(d, inf, OMEGA),
        step(d, OMEGA, -inf),
        step(d, nan, nan),
        // A radian, or 20,000 rad/s, in one tick.
        step(1.0, OMEGA, OMEGA),
        step(-1.0, OMEGA, OMEGA),
        step(d, 60.0, 60.0),
        step(d, OMEGA, -60.0),
        step(d, OMEGA, OMEGA + 11.0),
    ]
    .map(Sample::Taken)
    .to_vec()
}

/// Takes events that a test does not look at. A function and not closures: every rung is compiled
/// for each type that it is stepped with.
fn ignored<F>(_: Event<F>) {}

/// Takes events where there must be none.
fn none<F>(_: Event<F>) {
    panic!("an event without a step of the shaft");
}

/// Something to do with a guarded joint of every rung.
trait Trial {
    fn run<F: Real, J: StickSlip<F>>(&self, name: &str, joint: Guarded<F, J>);
}

struct Start<'a, T>(&'a T, String);

impl<F: Real, T: Trial> JointVisitor<F> for Start<'_, T> {
    type Output = ();

    fn visit<J: StickSlip<F>>(self, joint: J) {
        let guarded = Guarded::new(joint, InputLimits::device(TICK_S), F::from_f64(OMEGA));
        self.0.run(&self.1, guarded);
    }
}

fn on_every_rung(trial: &impl Trial) {
    for convention in Convention::ALL {
        for solver in Solver::ALL {
            if solver.refusal(convention).is_some() {
                continue;
            }
            let settings = Settings {
                convention,
                ..Settings::default()
            };
            let valid = settings.validate().unwrap();
            let name = format!("{} {}", convention.name(), solver.name());
            let (single, double) = (
                Start(trial, format!("{name} f32")),
                Start(trial, format!("{name} f64")),
            );
            if solver.refusal_in::<f32>(convention).is_none() {
                with_joint::<f32, _>(&valid, solver, TICK_S, OMEGA as f32, single).unwrap();
            }
            with_joint::<f64, _>(&valid, solver, TICK_S, OMEGA, double).unwrap();
        }
    }
}

#[test]
fn a_bad_sample_is_counted_held_and_leaves_no_trace() {
    struct OneBadSample;
    impl Trial for OneBadSample {
        fn run<F: Real, J: StickSlip<F>>(&self, name: &str, mut joint: Guarded<F, J>) {
            for bad in impossible::<F>() {
                // In stick, in slip, and near the events between them.
                for _ in 0..7 {
                    joint.tick(&good(), ignored);
                }
                assert!(!joint.is_holding());
                let before = joint.counters();
                let (torque, theta) = (joint.torque_nm(), joint.joint().theta_rad());
                joint.tick(&bad, none);
                assert_eq!(joint.torque_nm(), torque, "{name} {bad:?}");
                assert_eq!(joint.joint().theta_rad(), theta, "{name} {bad:?}");
                assert_eq!(joint.counters().refused, before.refused + 1, "{bad:?}");
                assert!(joint.is_holding());
            }
            for _ in 0..50_000 {
                joint.tick(&good(), ignored);
                assert!(joint.torque_nm().is_finite() && joint.joint().theta_rad().is_finite());
            }
            assert_eq!(joint.counters().lost, 0);
            assert_eq!(joint.counters().restarts, 0);
        }
    }
    on_every_rung(&OneBadSample);
}

#[test]
fn without_a_shaft_the_torque_is_held_for_a_millisecond_and_then_released() {
    struct Silence;
    impl Trial for Silence {
        fn run<F: Real, J: StickSlip<F>>(&self, name: &str, mut joint: Guarded<F, J>) {
            for _ in 0..10 {
                joint.tick(&good(), ignored);
            }
            let held = joint.torque_nm().to_f64();
            assert!(held > 0.05, "{name}: {held}");
            for tick in 1..=200 {
                joint.tick(&Sample::Lost, ignored);
                let expected = (held - 5e-3 * f64::from((tick - 20).max(0))).max(0.0);
                let shown = joint.torque_nm().to_f64();
                assert!(
                    (shown - expected).abs() < 1e-6,
                    "{name} tick {tick}: {shown}"
                );
            }
            assert_eq!(joint.torque_nm(), F::ZERO);
            assert_eq!(joint.counters().lost, 200);
            // Samples resume far away: a new stick, from the present torque.
            joint.tick(&good(), ignored);
            assert_eq!(joint.joint().phase(), Phase::Stick, "{name}");
            assert!(joint.torque_nm().abs().to_f64() < 1e-6, "{name}");
            assert_eq!(joint.counters().restarts, 1);
            let mut last = joint.torque_nm().to_f64();
            for _ in 0..5 {
                joint.tick(&good(), ignored);
                let now = joint.torque_nm().to_f64();
                assert!((now - last - 0.018).abs() < 2e-3, "{name}: {last} {now}");
                last = now;
            }
        }
    }
    on_every_rung(&Silence);
}

struct Negative;
impl JointVisitor<f32> for Negative {
    type Output = ();
    fn visit<J: StickSlip<f32>>(self, joint: J) {
        let mut joint = Guarded::new(joint, InputLimits::device(TICK_S), -0.9);
        for _ in 0..10 {
            joint.tick(&Sample::Taken(step(-0.9 * TICK_S, -0.9, -0.9)), ignored);
        }
        let held = joint.torque_nm();
        for _ in 0..30 {
            joint.tick(&Sample::Lost, ignored);
        }
        assert!((joint.torque_nm() - (held + 0.05)).abs() < 1e-6);
        joint.release();
        assert_eq!(joint.torque_nm(), 0.0);
    }
}

#[test]
fn a_negative_torque_is_released_upwards() {
    let valid = Settings::default().validate().unwrap();
    with_joint::<f32, _>(&valid, Solver::ExactEvents, TICK_S, -0.9, Negative).unwrap();
}

#[test]
fn a_few_missing_samples_are_made_up_for() {
    // A lost sample is a step of double length: angle and time are exact.
    struct Gaps {
        missing: u32,
    }
    impl JointVisitor<f64> for Gaps {
        type Output = Vec<f64>;
        fn visit<J: StickSlip<f64>>(self, joint: J) -> Vec<f64> {
            let mut joint = Guarded::new(joint, InputLimits::device(TICK_S), OMEGA);
            let (mut times, mut seen) = (Vec::new(), 0_u32);
            for tick in 1..=40_000_u32 {
                if self.missing > 0 && tick % 7 < self.missing {
                    joint.tick(&Sample::Lost, none);
                    continue;
                }
                let ticks = f64::from(tick - seen);
                let shaft = step(OMEGA * TICK_S * ticks, OMEGA, OMEGA);
                joint.tick(&Sample::Taken(shaft), |event| {
                    times.push((f64::from(seen) + event.fraction * ticks) * TICK_S);
                });
                seen = tick;
            }
            assert_eq!(joint.counters().restarts, 0);
            times
        }
    }
    for convention in Convention::ALL {
        let settings = Settings {
            convention,
            ..Settings::default()
        };
        let valid = settings.validate().unwrap();
        let run = |missing| {
            with_joint::<f64, _>(&valid, Solver::ExactEvents, TICK_S, OMEGA, Gaps { missing })
                .unwrap()
        };
        let whole = run(0);
        assert!(whole.len() > 120);
        for missing in 1..=CATCH_UP_TICKS {
            let with_gaps = run(missing);
            assert_eq!(with_gaps.len(), whole.len());
            for (a, b) in with_gaps.iter().zip(&whole) {
                assert!((a - b).abs() < 1e-12, "{convention:?} {missing}: {a} {b}");
            }
        }
    }
}

struct Crowd;
impl JointVisitor<f64> for Crowd {
    type Output = u32;
    fn visit<J: StickSlip<f64>>(self, joint: J) -> u32 {
        let mut joint = Guarded::new(joint, InputLimits::device(TICK_S), 20.0);
        let mut full = 0;
        for n in 0..10 {
            let mut events = 0;
            // Every other step begins with a jump to the opposite velocity.
            let omega = if n / 2 % 2 == 0 { 20.0 } else { -20.0 };
            let shaft = step(omega * TICK_S, omega, omega);
            joint.tick(&Sample::Taken(shaft), |_| events += 1);
            assert!(events <= EVENTS_PER_STEP);
            full += u32::from(events == EVENTS_PER_STEP);
        }
        assert_eq!(joint.counters().crowded_steps, full);
        full
    }
}

#[test]
fn a_step_longer_than_a_stick_and_a_crowded_step_are_counted() {
    struct Fast;
    impl Trial for Fast {
        fn run<F: Real, J: StickSlip<F>>(&self, name: &str, mut joint: Guarded<F, J>) {
            // A stick lasts 1 mrad: 20 rad/s at this tick, and not 19.
            let at = |omega: f64| Sample::Taken(step::<F>(omega * TICK_S, omega, omega));
            joint.tick(&at(9.0), ignored);
            joint.tick(&at(18.9), ignored);
            assert_eq!(joint.counters().long_steps, 0, "{name}");
            joint.tick(&at(20.1), ignored);
            assert_eq!(joint.counters().long_steps, 1, "{name}");
            assert_eq!(joint.counters().crowded_steps, 0, "{name}");
        }
    }
    on_every_rung(&Fast);

    // A light, stiff object: more cycles in a tick than a step reports.
    for convention in Convention::ALL {
        let mut settings = Settings {
            convention,
            ..Settings::default()
        };
        settings.parameters.inertia_kg_m2 = 1e-9;
        settings.parameters.stiffness_nm_per_rad = 4e5;
        let valid = settings.validate().unwrap();
        let crowded = with_joint::<f64, _>(&valid, Solver::ExactEvents, TICK_S, 20.0, Crowd);
        assert!(crowded.unwrap() >= 8, "{convention:?}");
    }
}

#[test]
fn subnormal_numbers_are_rest() {
    struct Subnormal;
    impl Trial for Subnormal {
        fn run<F: Real, J: StickSlip<F>>(&self, name: &str, mut joint: Guarded<F, J>) {
            for _ in 0..20 {
                joint.tick(&Sample::Taken(step(0.0, 0.0, 0.0)), ignored);
            }
            let (torque, phase) = (joint.torque_nm(), joint.joint().phase());
            let tiny = F::HALF * F::AT_REST;
            let crawl = ShaftStep {
                delta_phi_rad: tiny,
                omega_start_rad_s: tiny,
                omega_end_rad_s: -tiny,
            };
            for _ in 0..1000 {
                joint.tick(&Sample::Taken(crawl), ignored);
            }
            if phase == Phase::Stick {
                assert_eq!(joint.torque_nm(), torque, "{name}");
            }
        }
    }
    on_every_rung(&Subnormal);
}

#[test]
fn every_rung_can_be_restarted() {
    struct PutDown;
    impl Trial for PutDown {
        fn run<F: Real, J: StickSlip<F>>(&self, name: &str, mut joint: Guarded<F, J>) {
            for _ in 0..100 {
                joint.tick(&good(), ignored);
            }
            joint
                .joint_mut()
                .restart(F::from_f64(0.15), F::from_f64(0.3));
            let joint = joint.joint();
            assert_eq!(joint.phase(), Phase::Stick, "{name}");
            assert_eq!(joint.theta_dot_rad_s(), F::from_f64(0.3), "{name}");
            let (torque, theta) = (joint.torque_nm().to_f64(), joint.theta_rad().to_f64());
            assert!((torque - 0.15).abs() < 1e-7, "{name}: {torque}");
            assert!((theta - 0.15 / 400.0).abs() < 1e-10, "{name}: {theta}");
        }
    }
    on_every_rung(&PutDown);
}
