//! Ticks in one go against the same ticks one by one.

use super::super::watch::watched;
use super::super::{Observer, summary};
use super::*;
use crate::scene::{Overrides, Precision, SolverChoice};
use crate::trace::{EventRecord, SymptomEvent};
use std::convert::Infallible;
use std::path::Path;

/// All bits of a run.
#[derive(Default)]
struct Bits {
    all: Vec<u64>,
    events: usize,
}

impl Bits {
    fn add(&mut self, numbers: &[f64]) {
        self.all.extend(numbers.iter().map(|x| x.to_bits()));
    }
}

impl Observer for Bits {
    type Error = Infallible;

    fn row(&mut self, row: &[f64]) -> Result<(), Infallible> {
        self.add(row);
        Ok(())
    }

    fn event(&mut self, event: &EventRecord) -> Result<(), Infallible> {
        self.events += 1;
        self.add(&[event.time_s, event.theta_rad, event.torque_after_nm]);
        Ok(())
    }

    fn symptom(&mut self, event: &SymptomEvent) -> Result<(), Infallible> {
        self.events += 1;
        self.add(&[event.time_s, event.angle_rad, event.torque_after_nm]);
        Ok(())
    }
}

/// A rigid shaft that does not say that it is one: it has every tick of its own.
struct Plain(RigidShaft<Ideal>);

impl Mechanics for Plain {
    const IS_RIGID: bool = false;

    fn advance(&mut self, motion: &MotionStep) {
        self.0.advance(motion);
    }

    fn jump(&mut self, omega_rad_s: f64) {
        self.0.jump(omega_rad_s);
    }

    fn shaft(&self) -> Body {
        self.0.shaft()
    }

    fn felt_nms(&self) -> f64 {
        self.0.felt_nms()
    }

    fn struck_nms(&self) -> f64 {
        self.0.struck_nms()
    }

    fn impacts(&self) -> Option<Impacts> {
        self.0.impacts()
    }

    fn absorbed_j(&self) -> f64 {
        self.0.absorbed_j()
    }

    fn balance(&self) -> EnergyBalance {
        self.0.balance()
    }

    fn write(&self, row: &mut Vec<f64>) {
        self.0.write(row);
    }

    fn warnings(&self) -> Vec<String> {
        self.0.warnings()
    }
}

impl Driven for Plain {
    fn command(&mut self, torque_nm: f64, coil_v: f64) {
        self.0.command(torque_nm, coil_v);
    }
}

/// Bits and summary of a run of a joint with symptoms.
fn run<F: Precise>(scene: &Scene, in_one_go: bool) -> (Bits, String) {
    let SolverChoice::Ladder { solver, .. } = scene.solver else {
        unreachable!("a solver with steps")
    };
    let mut bits = Bits::default();
    let totals = watched(&mut bits, |watch| {
        let shaft = RigidShaft::new(Ideal::default(), scene.start());
        let device = bare_joint::<F>(scene, solver, scene.step_s(), &shaft.shaft())?;
        let device = device.expect("a joint with symptoms");
        let coupling = Coupling::<F> {
            scene,
            solver,
            watch,
            precision: PhantomData,
        };
        if in_one_go {
            coupling.run(shaft, device)
        } else {
            coupling.run(Plain(shaft), device)
        }
    });
    let totals = totals.unwrap_or_else(|_| unreachable!("it runs"));
    let summary = summary::summarise(scene, &totals, 1.0);
    (bits, format!("{summary:?}"))
}

#[test]
fn ticks_in_one_go_are_those_one_by_one_to_the_bit() {
    let motions = [
        "kind = \"sine\"\namplitude_deg = 30\nfrequency_hz = 1.0",
        "kind = \"constant\"\nvelocity_rad_s = 1.0",
        "kind = \"strokes\"\nfrom_deg = 5.0\nto_deg = 80.0\npeak_speed_deg_s = 200.0\npause_s = 0.05",
    ];
    let symptoms: [&[&str]; 4] = [
        &["lead-pipe"],
        &["range-limit", "lead-pipe", "cogwheel", "texture"],
        &["clonus", "lead-pipe"],
        &["clasp-knife"],
    ];
    let mut events = 0;
    for motion in motions {
        for symptoms in symptoms {
            for precision in [Precision::F32, Precision::F64] {
                let mut text = format!(
                    "version = 1\ntitle = \"symptoms\"\nduration_s = 1.2\n[motion]\n{motion}\n\
                     [output]\ntrace_step_s = 3.5e-4\n[solver]\nkind = \"exact-events\"\nstep_s = 5e-5\n\
                     precision = \"{}\"\n[effects.crepitus]\n",
                    precision.name()
                );
                text.extend(symptoms.iter().map(|name| format!("[effects.{name}]\n")));
                let file = Path::new("symptoms.toml");
                let scene = Scene::parse(file, &text, &Overrides::default()).unwrap();
                let runs = [true, false].map(|in_one_go| match precision {
                    Precision::F32 => run::<f32>(&scene, in_one_go),
                    Precision::F64 => run::<f64>(&scene, in_one_go),
                });
                let [(ours, our_sums), (theirs, their_sums)] = runs;
                assert!(ours.all == theirs.all, "{text}");
                assert_eq!(our_sums, their_sums, "{text}");
                events += ours.events;
            }
        }
    }
    assert!(events > 1_000, "{events}");
}
