//! Our solvers: `exact-events` in steps, and `reference` from event to event.

use crate::motion::Hand;
use crate::work::{
    DURATION_S, Delivery, Mode, OMEGA, RATE_HZ, Runner, SAMPLES, Sampler, Task, Work,
};
use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{Convention, Event, Settings, ShaftStep, StickSlip, Validated};
use crepitus_plant::Motion;
use crepitus_scene::preset::Joint;
use crepitus_scene::reference::Reference;
use std::hint::black_box;

/// `exact-events` in f64, a step for each sample, which is all that it can be asked for.
pub fn exact_events(convention: Convention, joint: &Joint) -> Runner {
    let settings = settings(convention, joint);
    Box::new(move |task, out| {
        if task != Task::Samples {
            return Err("steps through all samples".into());
        }
        out.events.clear();
        with_joint(
            black_box(&settings),
            Solver::ExactEvents,
            1.0 / RATE_HZ,
            black_box(OMEGA),
            Steps(out),
        )
        .map_err(|e| e.to_string())
    })
}

/// `reference`, which has no step: it goes from event to event, and to the samples in sticks where
/// those are asked for.
pub fn reference(convention: Convention, joint: &Joint) -> Runner {
    let settings = settings(convention, joint);
    let motion = Motion::constant(OMEGA);
    let work = Work::new(joint.parameters);
    Box::new(move |task, out| {
        if task == Task::Samples {
            return Err("has no steps".into());
        }
        let Delivery { events, torque } = out;
        events.clear();
        let (settings, motion) = (black_box(&settings), black_box(&motion));
        Reference::new(settings, motion).advance(DURATION_S, |event| events.push(event.fraction));
        if task == Task::Events {
            return Ok(());
        }
        // Once more, now that it is known how far each mode goes.
        let mut reference = Reference::new(settings, motion);
        let mut sampler = Sampler::new(&work, task, torque);
        let mut mode = Mode::Stick;
        for &until_s in events.iter().chain([&DURATION_S]) {
            sampler.deliver(mode, until_s, |time_s| {
                reference.advance(time_s, |_| ());
                reference.torque_nm()
            });
            mode = mode.next();
        }
        Ok(())
    })
}

/// `reference` from event to event on a moving hand.
pub fn reference_events(convention: Convention, hand: &Hand) -> Runner {
    reference_rows(convention, hand, hand.duration_s, 0)
}

/// `reference` on a moving hand, with the torque at each of `rows` rows, `spacing_s` apart.
#[expect(clippy::cast_precision_loss, reason = "at most 100,000 rows")]
pub fn reference_rows(convention: Convention, hand: &Hand, spacing_s: f64, rows: usize) -> Runner {
    let settings = settings(convention, &hand.joint);
    let (motion, duration_s) = (hand.motion.clone(), hand.duration_s);
    Box::new(move |_, out| {
        let Delivery { events, torque } = out;
        events.clear();
        let mut note = |event: Event<f64>| events.push(event.fraction);
        let mut reference = Reference::new(black_box(&settings), black_box(&motion));
        for (n, torque) in torque[..rows].iter_mut().enumerate() {
            reference.advance((n + 1) as f64 * spacing_s, &mut note);
            *torque = reference.torque_nm();
        }
        reference.advance(duration_s, &mut note);
        Ok(())
    })
}

/// A joint's parameters.
fn settings(convention: Convention, joint: &Joint) -> Validated<Settings> {
    Settings {
        parameters: joint.parameters,
        convention,
        ..Settings::default()
    }
    .validate()
    .expect("the parameters of a preset are valid")
}

struct Steps<'a>(&'a mut Delivery);

impl JointVisitor<f64> for Steps<'_> {
    type Output = ();

    fn visit<J: StickSlip<f64>>(self, mut joint: J) {
        let Delivery { events, torque } = self.0;
        let omega = black_box(OMEGA);
        let shaft = ShaftStep {
            delta_phi_rad: omega / RATE_HZ,
            omega_start_rad_s: omega,
            omega_end_rad_s: omega,
        };
        let mut steps = 0.0;
        for torque in &mut torque[..SAMPLES] {
            joint.step(&shaft, |event| {
                events.push((steps + event.fraction) / RATE_HZ);
            });
            *torque = joint.torque_nm();
            steps += 1.0;
        }
    }
}
