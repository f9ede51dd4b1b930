//! Tests that every law passes.

use super::*;
use crate::laws::motion::{STEP_S, at, swing};
use crepitus_model::ShaftStep;
use std::vec::Vec;

/// Runs a law over steps, with the torque after each; `change` gives it the same joint again now
/// and then.
struct Run<'a, F> {
    steps: &'a [ShaftStep<F>],
    change: bool,
}

impl<F: Real> LawVisitor<F> for Run<'_, F> {
    type Output = Vec<F>;

    fn visit<M: Mounted<F>>(self, mut law: M) -> Vec<F> {
        let mut torques = Vec::new();
        for (n, shaft) in self.steps.iter().enumerate() {
            if self.change && n % 97 == 96 {
                law.change(&Parameters::default(), STEP_S).unwrap();
            }
            torques.push(law.step(shaft));
        }
        torques
    }
}

fn run<F: Real>(entry: &Entry, steps: &[ShaftStep<F>]) -> Vec<F> {
    changed(entry, steps, false)
}

fn changed<F: Real>(entry: &Entry, steps: &[ShaftStep<F>], change: bool) -> Vec<F> {
    let omega = steps[0].omega_start_rad_s;
    let visitor = Run { steps, change };
    let torques = entry.with(&Parameters::default(), STEP_S, omega, visitor);
    torques.unwrap()
}

/// Two seconds of a hand: 1 Hz over 0.2 rad.
fn hand<F: Real>() -> Vec<ShaftStep<F>> {
    let rate = core::f64::consts::TAU;
    (0..40_000).map(|n| swing(0.1, rate, n, STEP_S)).collect()
}

/// Steps to and fro of all sizes up to 5 rad/s.
fn restless<F: Real>() -> Vec<ShaftStep<F>> {
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let steps = (0..40_000).map(|_| {
        let size = (1e-5_f64).powf(random()) * 5.0;
        let omega = if random() < 0.4 { -size } else { size };
        at(omega * STEP_S, omega)
    });
    steps.collect()
}

/// The law that does not bear steps of 50 µs.
fn diverges(entry: &Entry) -> bool {
    entry.name == "lugre-object"
}

/// The largest torque beside Ts.
fn largest(entry: &Entry) -> f64 {
    match entry.kind {
        // Bristles with a damping: Ts + Tk. The last in a reversal: 2·Ts − Tk.
        Kind::ElastoPlasticObject
        | Kind::MaxwellSlip4Object
        | Kind::MaxwellSlip10Object
        | Kind::BlimanSorine => 1.5,
        _ => 1.0,
    }
}

fn a_law_starts_without_torque<F: Real>() {
    for entry in ENTRIES {
        let torques = run::<F>(entry, &[at(0.0, 0.0); 3]);
        assert!(torques.iter().all(|t| *t == F::ZERO), "{}", entry.name);
        // On a shaft that moves, a law with presliding, too: what it moved by.
        let [first] = run::<F>(entry, &[at(0.1 * STEP_S, 0.1)])[..] else {
            panic!("one step");
        };
        let elastic_nm = 400.0 * 0.1 * STEP_S;
        let of_rest = first.to_f64() / elastic_nm;
        let has_presliding = entry.file != "coulomb";
        let is_bounded = (0.0..1.02).contains(&of_rest) || entry.is_on_object();
        assert!(!has_presliding || is_bounded, "{}: {of_rest}", entry.name);
    }
}

fn it_is_finite_and_bounded<F: Real>() {
    for motion in [hand::<F>(), restless::<F>()] {
        for entry in ENTRIES {
            let torques = run(entry, &motion);
            let limit = 0.4 * largest(entry) * (1.0 + 4.0 * F::LIMIT_SLACK.to_f64());
            let is_bounded = |t: &F| t.is_finite() && t.to_f64().abs() <= limit;
            let most = torques
                .iter()
                .fold(0.0, |a: f64, t| a.max(t.to_f64().abs()));
            let all = torques.iter().all(is_bounded);
            assert_eq!(all, !diverges(entry), "{}: {most} {limit}", entry.name);
        }
    }
}

fn a_mirrored_motion_mirrors_the_torque<F: Real>() {
    for motion in [hand::<F>(), restless::<F>()] {
        let mirrored: Vec<_> = motion
            .iter()
            .map(|shaft| ShaftStep {
                delta_phi_rad: -shaft.delta_phi_rad,
                omega_start_rad_s: -shaft.omega_start_rad_s,
                omega_end_rad_s: -shaft.omega_end_rad_s,
            })
            .collect();
        for entry in ENTRIES.iter().filter(|entry| !diverges(entry)) {
            let pairs = run(entry, &motion).into_iter().zip(run(entry, &mirrored));
            for (n, (there, back)) in pairs.enumerate() {
                assert!(there == -back, "{} {n}: {there:?} {back:?}", entry.name);
            }
        }
    }
}

fn a_change_to_the_same_joint_changes_nothing<F: Real>() {
    for motion in [hand::<F>(), restless::<F>()] {
        // Our joint is put in stick.
        for entry in ENTRIES.iter().filter(|e| !diverges(e) && !e.is_ours()) {
            let pairs = run(entry, &motion)
                .into_iter()
                .zip(changed(entry, &motion, true));
            for (n, (kept, changed)) in pairs.enumerate() {
                assert!(kept == changed, "{} {n}: {kept:?} {changed:?}", entry.name);
            }
        }
    }
}

/// The promise of the fit. A thousandth of the travel to Ts, at 10 µrad/s.
fn presliding_is_as_stiff_as_the_joint<F: Real>() {
    let steps = [at::<F>(1e-5 * STEP_S, 1e-5); 2_000];
    for entry in ENTRIES.iter().filter(|entry| entry.file != "coulomb") {
        let torques = run(entry, &steps);
        let stiffness = torques[1_999].to_f64() / 1e-6;
        assert!(
            (stiffness / 400.0 - 1.0).abs() < 3e-3,
            "{}: {stiffness}",
            entry.name
        );
    }
}

/// Gives a law a wrong joint, and wrong steps.
struct Refuse;

impl LawVisitor<f64> for Refuse {
    type Output = ();

    fn visit<M: Mounted<f64>>(self, mut law: M) {
        let above = Parameters {
            kinetic_torque_nm: 0.5,
            ..Parameters::default()
        };
        assert!(law.change(&above, STEP_S).is_err());
        for step_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(law.change(&Parameters::default(), step_s).is_err());
        }
        assert_eq!(law.step(&at(0.0, 0.0)), 0.0);
    }
}

#[test]
fn a_wrong_joint_or_step_is_refused() {
    for entry in ENTRIES {
        entry
            .with(&Parameters::default(), STEP_S, 0.0, Refuse)
            .unwrap();
        let above = Parameters {
            kinetic_torque_nm: 0.5,
            ..Parameters::default()
        };
        assert!(entry.with(&above, STEP_S, 0.0, Refuse).is_err());
        assert!(
            entry
                .with(&Parameters::default(), 0.0, 0.0, Refuse)
                .is_err()
        );
    }
}

#[test]
fn every_law_keeps_the_contract_in_double_precision() {
    a_law_starts_without_torque::<f64>();
    it_is_finite_and_bounded::<f64>();
    a_mirrored_motion_mirrors_the_torque::<f64>();
    a_change_to_the_same_joint_changes_nothing::<f64>();
    presliding_is_as_stiff_as_the_joint::<f64>();
}

#[test]
fn every_law_keeps_the_contract_in_single_precision() {
    a_law_starts_without_torque::<f32>();
    it_is_finite_and_bounded::<f32>();
    a_mirrored_motion_mirrors_the_torque::<f32>();
    a_change_to_the_same_joint_changes_nothing::<f32>();
    presliding_is_as_stiff_as_the_joint::<f32>();
}

/// Bytes of a law.
struct Size;

impl<F: Real> LawVisitor<F> for Size {
    type Output = usize;

    fn visit<M: Mounted<F>>(self, _: M) -> usize {
        size_of::<M>()
    }
}

/// The controller has it on its stack.
#[test]
fn every_law_takes_less_than_a_quarter_of_a_kilobyte() {
    for entry in ENTRIES {
        let bytes = entry.with::<f32, _>(&Parameters::default(), STEP_S, 0.0, Size);
        let bytes = bytes.unwrap();
        std::println!("{:26} {bytes}", entry.name);
        assert!(bytes < 256, "{}: {bytes}", entry.name);
    }
}

#[test]
fn names_are_unique_and_say_what_is_on_an_object() {
    for (n, entry) in ENTRIES.iter().enumerate() {
        let others = &ENTRIES[n + 1..];
        assert!(
            others
                .iter()
                .all(|o| o.name != entry.name && o.title != entry.title)
        );
        let has_object_in_it = entry.is_ours() || entry.name == "karnopp";
        let says = entry.name.ends_with("-object");
        assert_eq!(
            entry.is_on_object(),
            says || has_object_in_it,
            "{}",
            entry.name
        );
        assert_eq!(
            entry.title.ends_with(", on an object"),
            says,
            "{}",
            entry.name
        );
        assert!(
            !entry.file.is_empty() && entry.title.len() < 80,
            "{}",
            entry.name
        );
    }
}
