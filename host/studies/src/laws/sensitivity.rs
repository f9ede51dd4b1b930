//! A planted error in a law is noticed by a task.
//!
//! Every law is broken in turn, in the way of a slip of the pen, and run beside the whole one: at least
//! one number must move by more than it would by chance.

use super::contestant::Contestant;
use super::row::Row;
use super::study::{Plan, run_with};
use super::task::Extent;
use crate::watcher::{Cancelled, Watcher};
use crepitus_ladder::laws::stepped::Stepped;
use crepitus_ladder::laws::{ENTRIES, Entry};
use crepitus_model::{Parameters, SettingsError, ShaftStep};
use crepitus_scene::scene::Precision;
use std::collections::BTreeMap;

struct Nobody;

impl Watcher for Nobody {
    fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
        Ok(())
    }
}

/// An error in a law.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Planted {
    /// The velocity has the wrong sign where it is negative.
    VelocityInReversal,
    /// The travel has.
    TravelInReversal,
    /// The stiffness is 5 % too high.
    Stiffness,
    /// Ts is 3 % too high.
    Static,
    /// Tk is 3 % too high.
    Kinetic,
    /// The inertia is 10 % too high: on ground it is in the Stribeck velocity alone.
    Inertia,
    /// The torque grows by 1e-7 of Ts in each step.
    Drift,
    /// Every hundredth torque is off by 2 % of Ts.
    Noise,
    /// The torque is a step late.
    Late,
    /// The travel is rounded to 1e-6 rad.
    Rounded,
    /// A change of parameters is not taken.
    NoChange,
    /// The torque is off by 5 % of Ts where the velocity is near zero.
    AtRest,
}

const PLANTED: [Planted; 12] = [
    Planted::VelocityInReversal,
    Planted::TravelInReversal,
    Planted::Stiffness,
    Planted::Static,
    Planted::Kinetic,
    Planted::Inertia,
    Planted::Drift,
    Planted::Noise,
    Planted::Late,
    Planted::Rounded,
    Planted::NoChange,
    Planted::AtRest,
];

struct Broken(&'static Entry, Planted);

impl Contestant for Broken {
    fn name(&self) -> &'static str {
        self.0.name
    }

    fn title(&self) -> &'static str {
        self.0.title
    }

    fn start(
        &self,
        joint: &Parameters,
        step_s: f64,
        precision: Precision,
        omega_rad_s: f64,
    ) -> Result<Box<dyn Stepped>, SettingsError> {
        let joint = self.1.joint(joint);
        Ok(Box::new(BrokenLaw {
            law: self.0.start(&joint, step_s, precision, omega_rad_s)?,
            planted: self.1,
            static_nm: joint.static_torque_nm,
            steps: 0,
            late_nm: 0.0,
        }))
    }
}

impl Planted {
    fn joint(self, joint: &Parameters) -> Parameters {
        let mut joint = *joint;
        match self {
            Self::Stiffness => joint.stiffness_nm_per_rad *= 1.05,
            Self::Static => joint.static_torque_nm *= 1.03,
            Self::Kinetic => joint.kinetic_torque_nm *= 1.03,
            Self::Inertia => joint.inertia_kg_m2 *= 1.1,
            _ => {}
        }
        joint
    }
}

struct BrokenLaw {
    law: Box<dyn Stepped>,
    planted: Planted,
    static_nm: f64,
    steps: u32,
    late_nm: f64,
}

impl Stepped for BrokenLaw {
    fn change(&mut self, joint: &Parameters, step_s: f64) -> Result<(), SettingsError> {
        if self.planted == Planted::NoChange {
            return Ok(());
        }
        self.law.change(&self.planted.joint(joint), step_s)
    }

    fn step(&mut self, shaft: &ShaftStep<f64>) -> f64 {
        let mut shaft = *shaft;
        self.steps += 1;
        match self.planted {
            Planted::VelocityInReversal => {
                shaft.omega_start_rad_s = shaft.omega_start_rad_s.abs();
                shaft.omega_end_rad_s = shaft.omega_end_rad_s.abs();
            }
            Planted::TravelInReversal => shaft.delta_phi_rad = shaft.delta_phi_rad.abs(),
            Planted::Rounded => shaft.delta_phi_rad = (shaft.delta_phi_rad * 1e6).round() * 1e-6,
            _ => {}
        }
        let torque_nm = self.law.step(&shaft);
        match self.planted {
            Planted::Drift => torque_nm + 1e-7 * self.static_nm * f64::from(self.steps),
            Planted::Noise if self.steps.is_multiple_of(100) => torque_nm + 0.02 * self.static_nm,
            Planted::AtRest if shaft.omega_end_rad_s.abs() < 1e-3 => {
                torque_nm + 0.05 * self.static_nm
            }
            Planted::Late => std::mem::replace(&mut self.late_nm, torque_nm),
            _ => torque_nm,
        }
    }

    fn bytes(&self) -> usize {
        self.law.bytes()
    }
}

fn plan() -> Plan {
    Plan {
        repeats: 0,
        is_refined: false,
        // The hour costs most, and sees what others see.
        tasks: super::TASKS
            .iter()
            .map(|task| task.name().to_owned())
            .filter(|name| name != "hour")
            .collect(),
        ..Plan::of(Extent::Quick)
    }
}

/// The quantity that moves most, and by how much of its scale; infinite if the law now fails.
fn noticed(whole: &[Row], broken: &[Row]) -> (&'static str, f64) {
    let pairs = whole.iter().zip(broken);
    let moved = pairs.map(|(whole, broken)| {
        assert_eq!((whole.law, whole.quantity), (broken.law, broken.quantity));
        let by = match (whole.value, broken.value) {
            (Some(a), Some(b)) => (a - b).abs() / whole.scale,
            (None, None) => 0.0,
            _ => f64::INFINITY,
        };
        (whole.quantity, by)
    });
    moved.fold(
        ("", 0.0),
        |most, now| if now.1 > most.1 { now } else { most },
    )
}

/// Returns whether a law has what is broken: a law on ground has no inertia, and a function of velocity no
/// travel.
fn concerns(planted: Planted, entry: &Entry) -> bool {
    let joint = Parameters::default();
    let torques = |joint: &Parameters, planted: Option<Planted>| -> Vec<f64> {
        let whole: &dyn Contestant = entry;
        let broken = planted.map(|planted| {
            Broken(
                ENTRIES.iter().find(|e| e.name == entry.name).unwrap(),
                planted,
            )
        });
        let contestant = broken.as_ref().map_or(whole, |b| b as &dyn Contestant);
        let mut law = contestant.start(joint, 5e-5, Precision::F64, 0.0).unwrap();
        // To and fro in 0.2 s, 0.02 rad far.
        let angle = |n: i32| 0.02 * (f64::from(n) * 5e-5 * 31.4).sin();
        let omega = |n: i32| 0.02 * 31.4 * (f64::from(n) * 5e-5 * 31.4).cos();
        let torques = (0..8_000).map(|n| {
            law.step(&ShaftStep {
                delta_phi_rad: angle(n + 1) - angle(n),
                omega_start_rad_s: omega(n),
                omega_end_rad_s: omega(n + 1),
            })
        });
        torques.collect()
    };
    match planted {
        Planted::NoChange | Planted::AtRest => true,
        _ => {
            let (whole, broken) = (torques(&joint, None), torques(&joint, Some(planted)));
            let mut pairs = whole.iter().zip(&broken);
            pairs.any(|(a, b)| (a - b).abs() > 1e-3 * joint.static_torque_nm)
        }
    }
}

#[test]
fn an_error_in_any_law_moves_a_number() {
    let whole: Vec<&dyn Contestant> = ENTRIES.iter().map(|e| e as &dyn Contestant).collect();
    let whole = run_with(&plan(), &whole, &mut Nobody).unwrap();
    let (mut unnoticed, mut tried) = (Vec::new(), BTreeMap::<_, u32>::new());
    for planted in PLANTED {
        let broken: Vec<Broken> = ENTRIES.iter().map(|entry| Broken(entry, planted)).collect();
        let broken: Vec<&dyn Contestant> = broken.iter().map(|b| b as &dyn Contestant).collect();
        let broken = run_with(&plan(), &broken, &mut Nobody).unwrap();
        for entry in ENTRIES {
            let of = |rows: &[Row]| -> Vec<Row> {
                let own = rows.iter().filter(|row| row.law == entry.name);
                own.cloned().collect()
            };
            let (quantity, by) = noticed(&of(&whole), &of(&broken));
            println!(
                "{planted:?} in {}: {quantity} moves by {by:.1e}",
                entry.name
            );
            if concerns(planted, entry) {
                *tried.entry(entry.name).or_default() += 1;
                if by < 1e-3 {
                    unnoticed.push((planted, entry.name, quantity, by));
                }
            }
        }
    }
    assert!(unnoticed.is_empty(), "{unnoticed:#?}");
    // Most errors can be made in every law.
    assert_eq!(tried.len(), ENTRIES.len());
    assert!(tried.values().all(|errors| *errors >= 7), "{tried:?}");
}
