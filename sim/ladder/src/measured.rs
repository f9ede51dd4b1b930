//! One step of each subject.
//!
//! The second word of a joint's output has its events: two bits each, the last
//! in the lowest, 1 a break, 2 a stick, 3 a reversal.

use crate::exchange::{Input, Kind, Output};
use crate::laws::Mounted;
use crepitus_model::control::encoder::EncoderReader;
use crepitus_model::render::effects::{DeviceEffect, Tick};
use crepitus_model::render::input_check::Checked;
use crepitus_model::render::position::{Position, Scale, Travel};
use crepitus_model::render::{ShaftEstimate, Shown};
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{
    CurrentLoop, Event, EventKind, Guarded, Renderer, Sample, ShaftStep, StepCoefficients,
    StickSlip,
};

/// A subject that is stepped.
pub trait Measured {
    /// A commit of other parameters, outside of the step.
    fn commit(&mut self, _next: StepCoefficients<f32>) {}

    /// One step.
    fn step(&mut self, input: &Input) -> Output;
}

/// The function whose calls are measured: one for each subject.
#[inline(never)]
pub fn step<M: Measured>(subject: &mut M, input: &Input) -> Output {
    subject.step(input)
}

/// Events of a step.
#[derive(Default)]
struct Happened {
    kinds: u32,
    fraction: f32,
}

impl Happened {
    #[inline]
    fn event(&mut self, event: &Event<f32>) {
        let kind = match event.kind {
            EventKind::Break => 1,
            EventKind::Stick => 2,
            EventKind::Reverse => 3,
        };
        self.kinds = self.kinds << 2 | kind;
        self.fraction = event.fraction;
    }

    #[inline]
    fn with(&self, torque_nm: f32) -> Output {
        [torque_nm.to_bits(), self.kinds, self.fraction.to_bits()]
    }
}

impl Input {
    #[inline]
    fn number(&self, n: usize) -> f32 {
        self.words.get(n).map_or(0.0, |word| f32::from_bits(*word))
    }

    #[inline]
    fn shaft(&self) -> ShaftStep<f32> {
        ShaftStep {
            delta_phi_rad: self.number(0),
            omega_start_rad_s: self.number(1),
            omega_end_rad_s: self.number(2),
        }
    }

    #[inline]
    fn sample(&self) -> Sample<f32> {
        if self.kind == Kind::Lost {
            Sample::Lost
        } else {
            Sample::Taken(self.shaft())
        }
    }
}

/// A rung alone.
pub struct Joint<J>(pub J);

impl<J: StickSlip<f32>> Measured for Joint<J> {
    #[inline]
    fn step(&mut self, input: &Input) -> Output {
        let mut seen = Happened::default();
        self.0.step(&input.shaft(), |event| seen.event(&event));
        seen.with(self.0.torque_nm())
    }
}

impl<J: StickSlip<f32>> Measured for Guarded<f32, J> {
    #[inline]
    fn step(&mut self, input: &Input) -> Output {
        let mut seen = Happened::default();
        self.tick(&input.sample(), |event| seen.event(&event));
        seen.with(self.torque_nm())
    }
}

/// The renderer, and the slew limit of its parameters.
pub struct Rendered {
    /// The joint of the firmware.
    pub renderer: Renderer<f32, ExactEvents>,
    /// Slew limit, N·m/s.
    pub slew_nm_per_s: f64,
}

impl Measured for Rendered {
    fn commit(&mut self, next: StepCoefficients<f32>) {
        self.renderer.commit(next, self.slew_nm_per_s);
    }

    #[inline]
    fn step(&mut self, input: &Input) -> Output {
        let mut seen = Happened::default();
        let shown = self
            .renderer
            .render(&input.sample(), |event| seen.event(&event));
        seen.with(shown.torque_nm)
    }
}

impl Measured for EncoderReader<f32> {
    #[inline]
    fn step(&mut self, input: &Input) -> Output {
        if input.kind == Kind::Lost {
            self.miss();
            return [0, self.omega_rad_s().to_bits(), 0];
        }
        let [count, ..] = input.words;
        let shaft = self.read(count.cast_signed());
        [
            shaft.delta_phi_rad.to_bits(),
            shaft.omega_end_rad_s.to_bits(),
            0,
        ]
    }
}

/// A friction law.
pub struct Law<M>(pub M);

impl<M: Mounted<f32>> Measured for Law<M> {
    #[inline]
    fn step(&mut self, input: &Input) -> Output {
        [self.0.step(&input.shaft()).to_bits(), 0, 0]
    }
}

/// An effect of the device. The input of a symptom is a step of the shaft, that of
/// others travel, speed, and the jump of the joint's torque.
pub struct Effect<E> {
    law: E,
    place: Position<f32>,
    scale: Scale<f32>,
}

impl<E: DeviceEffect<f32>> Effect<E> {
    /// Returns the effect at rest, so many counts from where the joint is straight.
    pub fn new(mut law: E, count: i32, scale: Scale<f32>) -> Self {
        let place = Position::at(count);
        law.rest(&place);
        Self { law, place, scale }
    }
}

impl<E: DeviceEffect<f32>> Measured for Effect<E> {
    #[inline]
    fn step(&mut self, input: &Input) -> Output {
        let (shaft, jump_nm) = if E::IS_SYMPTOM {
            (input.shaft(), 0.0)
        } else {
            let omega_rad_s = input.number(1);
            let shaft = ShaftStep {
                delta_phi_rad: input.number(0),
                omega_start_rad_s: omega_rad_s,
                omega_end_rad_s: omega_rad_s,
            };
            (shaft, input.number(2))
        };
        let place = self.place.moved(shaft.delta_phi_rad);
        if place.rest_rad.is_finite() {
            self.place = place;
        }
        // What is added to a joint that jumps gets its torque, too.
        let mut shown = Shown {
            torque_nm: jump_nm,
            jump_nm,
            ..Shown::nothing()
        };
        let input = Checked::Step(shaft);
        let travel = Travel::plausible(&input, &self.place, &self.scale);
        let seen = ShaftEstimate::taken(&shaft, self.place);
        let tick = Tick::of(&seen, &input, travel.as_ref(), 1.0);
        let added_nm = self.law.added(&tick, &mut shown, &mut ());
        [added_nm.to_bits(), 0, 0]
    }
}

impl Measured for CurrentLoop<f32> {
    #[inline]
    fn step(&mut self, input: &Input) -> Output {
        [self.tick(input.number(0), input.number(1)).to_bits(), 0, 0]
    }
}
