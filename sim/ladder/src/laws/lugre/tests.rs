use super::*;
use crate::laws::motion::{
    contact, creep, difference, drift, drift_of_bristles, runge_kutta, steady, swung,
};

const STEP: f64 = 5e-5;

fn explicit(damping: f64) -> LuGre<f64> {
    LuGre::new(&contact(damping), STEP)
}

fn exponential(damping: f64) -> LuGreExponential<f64> {
    LuGreExponential::new(&contact(damping), STEP)
}

/// σ1(v), with a vd of 2·Tk/σ1.
fn limited(damping: f64, omega: f64) -> f64 {
    damping / (1.0 + (damping * omega / (2.0 * 0.2)).powi(2))
}

/// Steady torque after many steps.
fn settled<L: FrictionLaw<f64>>(mut law: L, omega: f64, step_s: f64) -> f64 {
    for _ in 0..5000 {
        steady(&mut law, omega, step_s);
    }
    steady(&mut law, omega, step_s)
}

#[test]
fn steady_sliding_is_on_the_stribeck_curve() {
    for damping in [0.0, 1.7] {
        for omega in [1e-3, 5e-3, 0.01, 0.02, 0.5, 3.0] {
            let level = contact(damping).sliding_nm(omega);
            // Steps of a twentieth of the bristles' travel, and of many.
            let step_s = 0.05 * level / (400.0 * omega);
            for torque in [
                settled(explicit(damping), omega, step_s),
                settled(exponential(damping), omega, step_s),
                settled(exponential(damping), omega, 1e3 * step_s),
                -settled(exponential(damping), -omega, step_s),
            ] {
                assert!((torque / level - 1.0).abs() < 1e-14, "{omega}: {torque}");
            }
        }
    }
}

#[test]
fn presliding_is_as_stiff_as_stated() {
    for stiffness in [
        creep(&mut explicit(0.0), 1e-12) / 1e-12,
        creep(&mut exponential(0.0), 1e-12) / 1e-12,
        creep(&mut LuGreExponential::<f32>::new(&contact(0.0), STEP), 1e-9) / 1e-9,
    ] {
        assert!((stiffness / 400.0 - 1.0).abs() < 2e-6, "{stiffness}");
    }
    // The damping adds σ1·v.
    let still = steady(&mut exponential(0.0), 1e-6, STEP);
    let damped = steady(&mut exponential(1.7), 1e-6, STEP);
    assert!(((damped - still) / 1.7e-6 - 1.0).abs() < 1e-6);
}

#[test]
fn the_exponential_step_is_exact_at_constant_velocity() {
    for damping in [0.0, 1.7] {
        for (step_s, omega) in [
            (1e-7, 0.02),
            (STEP, 0.02),
            (1e-3, 0.02),
            (STEP, -2.0),
            (0.1, 0.5),
        ] {
            let mut law = exponential(damping);
            let level = contact(damping).sliding_nm(omega).copysign(omega);
            let lag = limited(damping, omega) * omega;
            for i in 1..=40 {
                let travel = f64::from(i) * step_s * omega;
                let left = (-400.0 * (travel / level)).exp();
                let wanted = level * (1.0 - left) + lag * left;
                let torque = steady(&mut law, omega, step_s);
                assert!(
                    (torque - wanted).abs() < 2e-15,
                    "{step_s} {i}: {torque} {wanted}"
                );
            }
        }
    }
}

/// LuGre as an equation of time, by another method: the torque after each of 600 steps.
fn by_runge_and_kutta(damping: f64) -> std::vec::Vec<f64> {
    let level = |v: f64| 0.2 + 0.2 * (-(v / 0.01).powi(2)).exp();
    let rate = move |v: f64, z: f64| v - 400.0 * v.abs() / level(v) * z;
    runge_kutta(600, 400, |v, [z]: [f64; 1]| [rate(v, z)])
        .iter()
        .map(|&(v, [z])| 400.0 * z + limited(damping, v) * rate(v, z))
        .collect()
}

/// Errors of both forms in 600, 1200, 2400 … steps.
fn errors<L: FrictionLaw<f64>>(law: L, damping: f64) -> [f64; 5] {
    let reference = by_runge_and_kutta(damping);
    core::array::from_fn(|i| {
        let every = 1 << i;
        let steps = 600 * i32::try_from(every).unwrap();
        let torque = swung(&mut law.clone(), steps);
        let at: std::vec::Vec<f64> = torque.into_iter().skip(every - 1).step_by(every).collect();
        difference(&at, &reference)
    })
}

#[test]
fn both_converge_to_what_runge_and_kutta_find() {
    let order = |errors: [f64; 5]| (errors[0] / errors[4]).log2() / 4.0;
    for damping in [0.0, 0.3] {
        let errors = errors(explicit(damping), damping);
        assert!(
            (order(errors) - 1.0).abs() < 0.05 && errors[0] < 2e-3,
            "{errors:?}"
        );
    }
    let undamped = errors(exponential(0.0), 0.0);
    assert!(order(undamped) > 1.8 && undamped[0] < 2e-5, "{undamped:?}");
    // The damping is that of the mean velocity of the step: half a step late.
    let damped = errors(exponential(0.3), 0.3);
    assert!(
        (order(damped) - 1.0).abs() < 0.05 && damped[0] < 3e-4,
        "{damped:?}"
    );
}

#[test]
fn explicit_euler_diverges_beyond_its_limit_and_not_below() {
    let omega = 3.0;
    let limit_s = 2.0 * contact(0.0).sliding_nm(omega) / (400.0 * omega);
    let below = settled(explicit(0.0), omega, 0.995 * limit_s);
    assert!((below / 0.2 - 1.0).abs() < 1e-9, "{below}");
    let beyond = settled(explicit(0.0), omega, 1.005 * limit_s);
    assert!(beyond.is_nan() || beyond.abs() > 1e6, "{beyond}");
    let exponential = settled(exponential(0.0), omega, 1.005 * limit_s);
    assert!((exponential / 0.2 - 1.0).abs() < 1e-14, "{exponential}");
}

/// The drift that P. Dupont, B. Armstrong and V. Hayward (*Elasto-plastic friction model: contact
/// compliance and stiction*, American Control Conference, 2000) describe.
#[test]
fn a_varying_load_below_break_away_creeps() {
    for (low, high) in [(0.28, 0.36), (0.34, 0.36), (-0.1, 0.36)] {
        let wanted = drift_of_bristles(400.0, 0.4, low, high);
        assert!(wanted > 1e-5);
        for found in [
            drift(&mut explicit(0.0), low, high, 20),
            drift(&mut exponential(0.0), low, high, 20),
        ] {
            assert!((found / wanted - 1.0).abs() < 2e-3, "{found} {wanted}");
        }
    }
}

/// Torque at which a mass breaks away under a load that grows by `rate` N·m/s.
fn break_away_nm(rate: f64) -> f64 {
    let mut law = exponential(0.1);
    let (inertia, step_s) = (1e-3, 1e-5);
    let (mut omega, mut load, mut largest) = (0.0, 0.0, 0.0_f64);
    while load < 0.5 {
        load += rate * step_s;
        let torque = steady(&mut law, omega, step_s);
        omega += step_s / inertia * (load - torque);
        largest = largest.max(torque);
    }
    largest
}

/// As the authors describe: it falls with the rate of the load, from Ts.
#[test]
fn break_away_falls_with_the_rate_of_the_load() {
    let found = [0.05, 0.5, 5.0, 50.0].map(break_away_nm);
    for (found, wanted) in found.into_iter().zip([0.37, 0.275, 0.2, 0.2]) {
        assert!((found - wanted).abs() < 2e-3, "{found}");
    }
}

/// Steps of all sizes, from crawling to far beyond vs, turning at random.
fn restless(mut each: impl FnMut(f64)) {
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    for _ in 0..200_000 {
        let size = (1e-5_f64).powf(random()) * 5.0;
        each(if random() < 0.4 { -size } else { size });
    }
}

#[test]
fn no_motion_shows_more_than_the_static_torque_or_gives_energy() {
    for damping in [0.0, 0.3, 10.0, 1e4] {
        let mut law = exponential(damping);
        let mut stored = 0.0;
        restless(|omega| {
            let torque = steady(&mut law, omega, STEP);
            assert!(torque.abs() <= 0.4 * (1.0 + 1e-15), "{torque}");
            let before = stored;
            stored = law.0.torque_nm * law.0.torque_nm / 800.0;
            let given = stored - before - torque * omega * STEP;
            assert!(given < 1e-18, "{damping} {omega}: {given}");
        });
    }
}

#[test]
fn a_change_keeps_the_torque_or_saturates_it() {
    fn changed<L: FrictionLaw<f64, Parameters = Contact>>(mut law: L) {
        let before = (0..20).fold(0.0, |_, _| creep(&mut law, 1e-4));
        let mut other = Contact {
            stiffness_nm_per_rad: 9e3,
            static_torque_nm: 0.6,
            ..contact(3.0)
        };
        law.change(&other, STEP);
        assert_eq!(creep(&mut law, 0.0), before);
        other.static_torque_nm = 0.25;
        law.change(&other, STEP);
        assert_eq!(creep(&mut law, 0.0), 0.25);
        (other.static_torque_nm, other.kinetic_torque_nm) = (0.0, 0.0);
        law.change(&other, STEP);
        assert!(creep(&mut law, 0.0).abs() < 2e-12);
    }
    changed(explicit(0.0));
    changed(exponential(0.0));
    let mut other = Contact {
        kinetic_torque_nm: 0.0,
        ..contact(1.0)
    };
    let mut law = exponential(0.0);
    law.change(&other, STEP);
    restless(|omega| assert!(steady(&mut law, omega, STEP).abs() <= 0.4));
    // A millionth of Ts stands for a Tk of zero.
    assert!((steady(&mut law, 1.0, STEP) - 0.4e-6).abs() < 1e-15);
    other.static_torque_nm = 0.0;
    law.change(&other, STEP);
    restless(|omega| assert!(steady(&mut law, omega, STEP).abs() < 2e-12));
}
