//! The device of a coupled run: sensor and joint, one tick at a time, behind
//! one call, so that the loop around them is the same for all.

use super::sensor::{Encoded, Ideal, Sensor};
use super::stepping::Books;
use super::tally::Tally;
use crate::scene::Scene;
use crate::trace::EventRecord;
use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{Real, SettingsError, StickSlip};
use crepitus_plant::chain::Body;
use crepitus_plant::effect::Seen;
use std::marker::PhantomData;

/// What a device renders on the shaft that it sees.
pub(super) trait Device {
    /// The model's torque, N·m.
    fn torque_nm(&self) -> f64;

    /// What it has seen of the shaft in the last tick.
    fn seen(&self) -> Seen;

    /// One tick, which began at `start_s` and in which the shaft moved so.
    fn tick(
        &mut self,
        start_s: f64,
        from: &Body,
        to: &Body,
        on_event: &mut dyn FnMut(&EventRecord),
    );

    /// Writes its columns.
    fn write(&self, row: &mut Vec<f64>);

    /// Whether its state is still numbers.
    fn is_finite(&self) -> bool;

    /// Closes the books of the object, if there is one, and tells in how many
    /// steps it had as many events as a step may have.
    fn finish(self: Box<Self>, time_s: f64) -> Option<(Tally, u64)>;
}

/// The device that a scene calls for, on a shaft that begins like this.
pub(super) fn device<F: Real>(
    scene: &Scene,
    solver: Solver,
    step_s: f64,
    shaft: &Body,
) -> Result<Box<dyn Device>, SettingsError> {
    match &scene.encoder {
        None => with_sensor::<F, _>(scene, solver, step_s, shaft, Ideal),
        Some(encoder) => {
            let sensor = Encoded::<F>::new(encoder, step_s, shaft)?;
            with_sensor::<F, _>(scene, solver, step_s, shaft, sensor)
        }
    }
}

fn with_sensor<F: Real, S: Sensor<F> + 'static>(
    scene: &Scene,
    solver: Solver,
    step_s: f64,
    shaft: &Body,
    sensor: S,
) -> Result<Box<dyn Device>, SettingsError> {
    let seen = Seen {
        omega_rad_s: shaft.omega_rad_s,
        ..Seen::default()
    };
    let Some(crepitus) = &scene.crepitus else {
        return Ok(Box::new(Watching {
            sensor,
            seen,
            precision: PhantomData::<F>,
        }));
    };
    let maker = Maker {
        books: Books::new::<F>(*crepitus.settings, step_s, shaft.omega_rad_s),
        sensor,
        seen,
    };
    let omega = F::from_f64(shaft.omega_rad_s);
    with_joint::<F, _>(&crepitus.settings, solver, step_s, omega, maker)
}

/// Boxes whatever joint the scene calls for.
struct Maker<S> {
    books: Books,
    sensor: S,
    seen: Seen,
}

impl<F: Real, S: Sensor<F> + 'static> JointVisitor<F> for Maker<S> {
    type Output = Box<dyn Device>;

    fn visit<J: StickSlip<F>>(self, joint: J) -> Self::Output {
        let Self {
            mut books,
            sensor,
            seen,
        } = self;
        books.tally.shown(joint.torque_nm().to_f64());
        Box::new(Rendering {
            joint,
            sensor,
            books,
            seen,
            precision: PhantomData::<F>,
        })
    }
}

/// A device with a joint.
struct Rendering<F, J, S> {
    joint: J,
    sensor: S,
    books: Books,
    seen: Seen,
    precision: PhantomData<F>,
}

impl<F: Real, J: StickSlip<F>, S: Sensor<F>> Device for Rendering<F, J, S> {
    fn torque_nm(&self) -> f64 {
        self.joint.torque_nm().to_f64()
    }

    fn seen(&self) -> Seen {
        self.seen
    }

    fn tick(
        &mut self,
        start_s: f64,
        from: &Body,
        to: &Body,
        on_event: &mut dyn FnMut(&EventRecord),
    ) {
        let seen = self.sensor.see(from, to);
        let (books, mut jump_nm) = (&mut self.books, 0.0);
        self.joint.step(&seen, |event| {
            let record = books.event(start_s, &seen, &event);
            jump_nm += record.torque_after_nm - record.torque_before_nm;
            on_event(&record);
        });
        self.books.end_step(&seen, &self.joint);
        self.seen = Seen {
            omega_rad_s: seen.omega_end_rad_s.to_f64(),
            delta_phi_rad: seen.delta_phi_rad.to_f64(),
            jump_nm,
        };
    }

    fn write(&self, row: &mut Vec<f64>) {
        row.extend([
            f64::from(self.joint.phase().sign()),
            self.joint.theta_rad().to_f64(),
            self.joint.theta_dot_rad_s().to_f64(),
            self.joint.torque_nm().to_f64(),
        ]);
        self.sensor.write(row);
    }

    fn is_finite(&self) -> bool {
        self.joint.theta_rad().is_finite() && self.joint.theta_dot_rad_s().is_finite()
    }

    fn finish(mut self: Box<Self>, time_s: f64) -> Option<(Tally, u64)> {
        let (theta, theta_dot) = (self.joint.theta_rad(), self.joint.theta_dot_rad_s());
        let phi_rad = self.books.phi_rad;
        self.books
            .tally
            .finish(time_s, phi_rad, theta.to_f64(), theta_dot.to_f64());
        let crowded = self.books.crowded_steps;
        Some((self.books.tally, crowded))
    }
}

/// A device that only looks.
struct Watching<F, S> {
    sensor: S,
    seen: Seen,
    precision: PhantomData<F>,
}

impl<F: Real, S: Sensor<F>> Device for Watching<F, S> {
    fn torque_nm(&self) -> f64 {
        0.0
    }

    fn seen(&self) -> Seen {
        self.seen
    }

    fn tick(&mut self, _: f64, from: &Body, to: &Body, _: &mut dyn FnMut(&EventRecord)) {
        let seen = self.sensor.see(from, to);
        self.seen = Seen {
            omega_rad_s: seen.omega_end_rad_s.to_f64(),
            delta_phi_rad: seen.delta_phi_rad.to_f64(),
            jump_nm: 0.0,
        };
    }

    fn write(&self, row: &mut Vec<f64>) {
        self.sensor.write(row);
    }

    fn is_finite(&self) -> bool {
        true
    }

    fn finish(self: Box<Self>, _: f64) -> Option<(Tally, u64)> {
        None
    }
}
