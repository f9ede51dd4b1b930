//! Parameters that change while the joint runs: one commit, then a ramp that
//! never raises the energy stored in the object, never moves a torque faster
//! than the slew limit, and never exceeds the active static limit.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "small numbers, and f32 is what is tested"
)]

mod support;

use crepitus_model::render::input_check::InputLimits;
use crepitus_model::render::ramp::Ramp;
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{
    Frozen, Parameters, Phase, Real, Renderer, Restart, Sample, Settings, ShaftStep,
    StepCoefficients, StickSlip,
};
use proptest::prelude::*;

const TICK_S: f64 = 5e-5;
const SLEW_NM_PER_S: f64 = 100.0;

fn coefficients<F: Real>(parameters: Parameters, restart: Restart) -> StepCoefficients<F> {
    let settings = Settings {
        parameters,
        restart,
        ..Settings::default()
    };
    StepCoefficients::new(&settings.validate().unwrap(), TICK_S).unwrap()
}

/// The energy that the object stores: its spring's, and in a slip, where it
/// moves by itself, its motion's.
fn stored_j<F: Real>(joint: &Frozen<F, ExactEvents>) -> f64 {
    let (a, theta) = (joint.coefficients(), joint.theta_rad().to_f64());
    let spring = 0.5 * a.stiffness.to_f64() * theta * theta;
    match joint.phase() {
        Phase::Stick => spring,
        Phase::Slip(_) => {
            spring + 0.5 * a.inertia.to_f64() * joint.theta_dot_rad_s().to_f64().powi(2)
        }
    }
}

/// Worst values of a run.
#[derive(Debug, Default)]
struct Worst {
    /// Largest rise of the stored energy in one adjustment, relative.
    energy_rise: f64,
    /// Largest change of torque without an event, beyond what the shaft's
    /// travel explains, as a part of the slew limit.
    slew: f64,
    /// Largest |T| relative to the active static limit.
    limit: f64,
    /// Events seen.
    events: u32,
}

/// Moves a joint by these speeds, 40 ticks each, and commits the numbers of
/// each change at its tick.
fn run<F: Real>(
    first: StepCoefficients<F>,
    changes: &[(usize, StepCoefficients<F>)],
    speeds_rad_s: &[f64],
) -> (Worst, StepCoefficients<F>) {
    let mut joint = Frozen::<F, ExactEvents>::new(first, F::ZERO);
    let mut ramp = Ramp::at(first);
    let mut worst = Worst::default();
    let mut changes = changes.iter().peekable();
    for tick in 0..speeds_rad_s.len() * 40 {
        while let Some((_, next)) = changes.next_if(|(at, _)| *at <= tick) {
            ramp = Ramp::new(*joint.coefficients(), *next, SLEW_NM_PER_S);
        }
        let torque = joint.torque_nm().to_f64();
        if let Some(next) = ramp.advance() {
            let before = stored_j(&joint);
            joint.adjust(next);
            let after = stored_j(&joint);
            worst.energy_rise = worst.energy_rise.max((after - before) / before.max(1e-12));
        }
        let omega = F::from_f64(speeds_rad_s[tick / 40]);
        let shaft = ShaftStep {
            delta_phi_rad: omega * F::from_f64(TICK_S),
            omega_start_rad_s: omega,
            omega_end_rad_s: omega,
        };
        let mut events = 0;
        joint.step(&shaft, |_| events += 1);
        worst.events += events;
        let a = joint.coefficients();
        let shown = joint.torque_nm().to_f64();
        worst.limit = worst.limit.max(shown.abs() - a.static_nm.to_f64());
        if events == 0 {
            let explained = match joint.phase() {
                Phase::Stick => (a.stiffness * shaft.delta_phi_rad).abs().to_f64(),
                Phase::Slip(_) => 0.0,
            };
            let moved = (shown - torque).abs() - explained;
            worst.slew = worst.slew.max(moved / (SLEW_NM_PER_S * TICK_S));
        }
    }
    (worst, *joint.coefficients())
}

fn check<F: Real>(worst: &Worst) {
    let eps = F::EPSILON.to_f64();
    assert!(worst.energy_rise <= 64.0 * eps, "{worst:?}");
    // A ramp may be a millionth too short, and torques of a few N·m are
    // rounded against 5 mN·m.
    assert!(worst.slew <= 1.0 + 1.1e-6 + 1e5 * eps, "{worst:?}");
    assert!(worst.limit <= 0.0, "{worst:?}");
}

#[test]
fn a_spring_made_forty_times_stiffer_in_mid_stick_injects_nothing() {
    // The shaft has wound a soft spring to 0.4 N·m; done naively, the stiffer
    // one would hold 0.32 J and show 16 N·m.
    let soft = Parameters {
        stiffness_nm_per_rad: 10.0,
        ..Parameters::default()
    };
    let stiff = coefficients::<f32>(Parameters::default(), Restart::Elastic);
    let soft = coefficients::<f32>(soft, Restart::Elastic);
    let (worst, last) = run(soft, &[(700, stiff)], &[1.1; 200]);
    check::<f32>(&worst);
    assert_eq!(last, stiff);
    assert!(worst.events > 10, "{worst:?}");
    let (worst, last) = run(stiff, &[(10, soft), (50, stiff)], &[1.1; 200]);
    check::<f32>(&worst);
    assert_eq!(last, stiff);
}

#[test]
fn a_static_limit_lowered_below_the_torque_breaks_the_stick() {
    let base = coefficients::<f32>(Parameters::default(), Restart::Elastic);
    let weak = Parameters {
        kinetic_torque_nm: 0.1,
        static_torque_nm: 0.2,
        ..Parameters::default()
    };
    let mut renderer =
        Renderer::<f32, ExactEvents>::of(base, InputLimits::device(TICK_S), 3.6e-5, 0.0);
    let move_by = |omega: f32| {
        Sample::Taken(ShaftStep {
            delta_phi_rad: omega * 5e-5,
            omega_start_rad_s: omega,
            omega_end_rad_s: omega,
        })
    };
    for _ in 0..18 {
        renderer.render(&move_by(1.0), |_| {});
    }
    let shown = renderer.render(&move_by(0.0), |_| {});
    assert!((shown.torque_nm - 0.36).abs() < 1e-5 && !shown.settling);
    renderer.commit(coefficients(weak, Restart::Elastic), SLEW_NM_PER_S);
    let mut breaks_at = None;
    for tick in 1..=60 {
        let mut events = Vec::new();
        let shown = renderer.render(&move_by(0.0), |e| events.push(e.to));
        assert!(shown.torque_nm.abs() <= renderer.joint().coefficients().static_nm);
        // 0.2 N·m at 5 mN·m a tick.
        assert_eq!(shown.settling, tick < 40, "{tick}");
        if !events.is_empty() {
            breaks_at.get_or_insert(tick);
        }
    }
    // Ts falls by 5 mN·m a tick and passes 0.36 N·m in the eighth or ninth.
    assert!(matches!(breaks_at, Some(8..=10)), "{breaks_at:?}");
}

#[test]
fn a_commit_leaves_a_slip_its_end() {
    let base = Parameters::default();
    let heavy = Parameters {
        inertia_kg_m2: 0.04,
        ..base
    };
    let ends_at = |change: Option<Parameters>| {
        let mut joint = Frozen::<f64, ExactEvents>::new(coefficients(base, Restart::Elastic), 1.0);
        let mut ends = Vec::new();
        for tick in 0..2000_u32 {
            if let Some(p) = change.filter(|_| tick == 100) {
                assert!(matches!(joint.phase(), Phase::Slip(_)));
                joint.adjust(coefficients(p, Restart::Elastic));
            }
            let shaft = ShaftStep {
                delta_phi_rad: TICK_S,
                omega_start_rad_s: 1.0,
                omega_end_rad_s: 1.0,
            };
            joint.step(&shaft, |e| {
                if e.to == Phase::Stick {
                    ends.push(f64::from(tick) + e.fraction);
                }
            });
        }
        ends
    };
    let (plain, changed) = (ends_at(None), ends_at(Some(heavy)));
    assert!((plain[0] - changed[0]).abs() < 1e-9);
    // The next one lasts as long as the heavier object swings: about twice.
    let (short, long) = (plain[1] - plain[0], changed[1] - changed[0]);
    assert!(long > 1.9 * short, "{short} {long}");
}

#[test]
fn a_slip_never_ends_with_more_than_its_spring_held_at_the_break() {
    // From a soft break at 0.4 N·m to numbers whose stick begins at 1 N·m.
    let base = coefficients::<f64>(Parameters::default(), Restart::Elastic);
    let strong = Parameters {
        kinetic_torque_nm: 1.0,
        static_torque_nm: 1.0 + 1e-3,
        ..Parameters::default()
    };
    let mut joint = Frozen::<f64, ExactEvents>::new(base, 1.0);
    let shaft = ShaftStep {
        delta_phi_rad: TICK_S,
        omega_start_rad_s: 1.0,
        omega_end_rad_s: 1.0,
    };
    let mut sticks = Vec::new();
    for tick in 0..2000 {
        if tick == 100 {
            joint.adjust(coefficients(strong, Restart::Elastic));
        }
        joint.step(&shaft, |e| {
            if e.to == Phase::Stick {
                sticks.push(e.torque_after_nm);
            }
        });
    }
    assert!((sticks[0] - 0.4).abs() < 1e-12, "{sticks:?}");
    assert!((sticks[1] - 0.999).abs() < 1e-12, "{sticks:?}");
}

fn parameters() -> impl Strategy<Value = (Parameters, Restart)> {
    (
        -5.0..-0.5_f64,
        0.5..4.0_f64,
        0.0..=1.0_f64,
        -2.0..0.7_f64,
        any::<bool>(),
    )
        .prop_map(|(j, kr, ratio, ts, elastic)| {
            let static_torque_nm = 10_f64.powf(ts);
            let parameters = Parameters {
                inertia_kg_m2: 10_f64.powf(j),
                stiffness_nm_per_rad: 10_f64.powf(kr),
                damping_nms_per_rad: 0.0,
                kinetic_torque_nm: ratio * static_torque_nm,
                static_torque_nm,
            };
            let restart = if elastic {
                Restart::Elastic
            } else {
                Restart::FromKinetic
            };
            (parameters, restart)
        })
}

proptest! {
    #![proptest_config(support::cases(1500))]

    #[test]
    fn any_change_at_any_time_keeps_the_laws(
        first in parameters(),
        changes in prop::collection::vec((0..2000_usize, parameters()), 1..5),
        speeds in prop::collection::vec(prop_oneof![Just(0.0), -6.0..6.0_f64], 20..80),
    ) {
        let mut changes = changes;
        changes.sort_by_key(|(at, _)| *at);
        let of = |(p, r): (Parameters, Restart)| coefficients::<f32>(p, r);
        let single: Vec<_> = changes.iter().map(|&(at, c)| (at, of(c))).collect();
        check::<f32>(&run(of(first), &single, &speeds).0);
        let of = |(p, r): (Parameters, Restart)| coefficients::<f64>(p, r);
        let double: Vec<_> = changes.iter().map(|&(at, c)| (at, of(c))).collect();
        check::<f64>(&run(of(first), &double, &speeds).0);
    }
}
