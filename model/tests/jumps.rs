//! A shaft whose velocity jumps at the start of a step: under `paper` and
//! `physical` the object keeps its own.

use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{
    Convention, Event, EventKind, Parameters, Phase, Sense, Settings, ShaftStep, StickSlip,
};

const TICK_S: f64 = 5e-5;

/// Velocities of successive stretches, each of this many ticks.
struct Stretches(&'static [(f64, u32)]);

impl JointVisitor<f64> for Stretches {
    type Output = Vec<(f64, Event<f64>)>;

    fn visit<J: StickSlip<f64>>(self, mut joint: J) -> Self::Output {
        let (mut events, mut tick) = (Vec::new(), 0_u32);
        for &(omega, ticks) in self.0 {
            for _ in 0..ticks {
                let step = ShaftStep {
                    delta_phi_rad: omega * TICK_S,
                    omega_start_rad_s: omega,
                    omega_end_rad_s: omega,
                };
                joint.step(&step, |e| {
                    events.push(((f64::from(tick) + e.fraction) * TICK_S, e));
                });
                tick += 1;
            }
        }
        events
    }
}

fn events(convention: Convention, stretches: &'static [(f64, u32)]) -> Vec<(f64, Event<f64>)> {
    damped_events(convention, 0.0, stretches)
}

fn damped_events(
    convention: Convention,
    damping_nms_per_rad: f64,
    stretches: &'static [(f64, u32)],
) -> Vec<(f64, Event<f64>)> {
    let settings = Settings {
        parameters: Parameters {
            damping_nms_per_rad,
            ..Parameters::default()
        },
        convention,
        ..Settings::default()
    };
    let valid = settings.validate().unwrap();
    let start = stretches[0].0;
    with_joint(
        &valid,
        Solver::ExactEvents,
        TICK_S,
        start,
        Stretches(stretches),
    )
    .unwrap()
}

#[test]
fn a_jump_tears_a_stick_loose_in_its_sense() {
    for convention in [Convention::Paper, Convention::Physical] {
        for (stretches, sense) in [
            (&[(0.1, 10), (0.6, 10)][..], Sense::Positive),
            (&[(0.1, 10), (-0.4, 10)][..], Sense::Negative),
            // Slower in the same direction: the object overtakes.
            (&[(0.1, 10), (0.04, 10)][..], Sense::Negative),
        ] {
            let events = events(convention, stretches);
            let (time_s, e) = events[0];
            assert!((time_s - 5e-4).abs() < 1e-15);
            assert_eq!((e.kind, e.to), (EventKind::Break, Phase::Slip(sense)));
            // The object has neither moved nor changed its velocity.
            assert!((e.theta_rad - 5e-5).abs() < 1e-15);
            assert_eq!((e.theta_dot_rad_s, e.omega_rad_s), (0.1, stretches[1].0));
            assert!((e.torque_before_nm - 0.02).abs() < 1e-12);
            assert_eq!(e.torque_after_nm, sense.of_signed(0.2));
        }
    }
}

#[test]
fn a_jump_past_the_object_turns_a_slip_round_and_one_towards_it_does_not() {
    for convention in [Convention::Paper, Convention::Physical] {
        // Breaks after 1 ms; 1 ms later the object still moves with 0.98 rad/s.
        let turned = events(convention, &[(1.0, 40), (-1.0, 5)]);
        let (time_s, e) = turned[1];
        assert!((time_s - 2e-3).abs() < 1e-15);
        assert_eq!(e.kind, EventKind::Reverse);
        assert_eq!(e.from, Phase::Slip(Sense::Positive));
        assert_eq!(e.to, Phase::Slip(Sense::Negative));
        assert_eq!((e.torque_before_nm, e.torque_after_nm), (0.2, -0.2));
        // Where it has swung to: about 0.5 mrad, at 200 rad/s, for 0.2 rad.
        let (sin, cos) = 0.2_f64.sin_cos();
        assert!((e.theta_rad - (5e-4 + 5e-4 * cos + 5e-3 * sin)).abs() < 1e-14);
        assert!((e.theta_dot_rad_s - (cos - 0.1 * sin)).abs() < 1e-12);
        let on = events(convention, &[(1.0, 40), (1.5, 5)]);
        assert_eq!(on.len(), 1, "{on:?}");
    }
}

#[test]
fn a_frozen_joint_does_not_notice_a_jump() {
    let events = events(Convention::Frozen, &[(0.1, 10), (0.6, 10)]);
    assert!(events.is_empty(), "{events:?}");
}

#[test]
fn a_jump_reports_the_torque_that_was_shown_with_all_that_is_in_it() {
    // kr·θ, and under `physical` c·Ω.
    for (convention, shown) in [(Convention::Paper, 0.02), (Convention::Physical, 0.03)] {
        for stretches in [&[(0.1, 10), (0.6, 1)][..], &[(-0.1, 10), (-0.6, 1)][..]] {
            let (_, e) = damped_events(convention, 0.1, stretches)[0];
            assert_eq!(e.kind, EventKind::Break);
            let expected = stretches[0].0.signum() * shown;
            assert!((e.torque_before_nm - expected).abs() < 1e-12, "{e:?}");
        }
    }
}
