//! The plan of a run.

use crate::exchange::{Exchange, PLAN, STEPS};
use crate::subject::Subject;
use crepitus_model::parameters::Tabled;
use crepitus_model::{Parameters, Restart, Settings, SettingsError, Validated};

/// A subject, its parameters, and its number of steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The subject.
    pub subject: Subject,
    /// The joint's parameters, and those of a commit. (The next commit restores
    /// the first ones.)
    pub parameters: [Parameters; 2],
    /// Restart rule of a stick.
    pub restart: Restart,
    /// The step, s.
    pub step_s: f64,
    /// The shaft's velocity at the start, rad/s.
    pub omega_rad_s: f32,
    /// Position at which an effect finds the joint at the start, in counts of the encoder.
    pub place: i32,
    /// Steps of one command.
    pub steps: u32,
}

/// Words of a plan.
const WORDS: usize = STEPS - PLAN;

/// Words before the joint's parameters.
const HEAD: usize = 7;

impl Plan {
    /// A subject with the paper's parameters at the device's tick, from rest.
    pub fn of(subject: Subject) -> Self {
        Self {
            subject,
            parameters: [Parameters::default(); 2],
            restart: Restart::default(),
            step_s: 5e-5,
            omega_rad_s: 0.0,
            place: 0,
            steps: 0,
        }
    }

    /// The settings of its joint.
    ///
    /// # Errors
    /// [`SettingsError`] if they are invalid.
    pub fn settings(&self, which: usize) -> Result<Validated<Settings>, SettingsError> {
        let [first, second] = self.parameters;
        Settings {
            parameters: if which == 0 { first } else { second },
            convention: self.subject.convention().unwrap_or_default(),
            restart: self.restart,
        }
        .validate()
    }

    /// Encodes the plan as words from [`PLAN`] on.
    pub fn encode(&self) -> [u32; WORDS] {
        let mut words = [0; WORDS];
        let step = self.step_s.to_bits();
        let restart = u32::from(self.restart == Restart::FromKinetic);
        let head = [
            self.subject.code(),
            self.steps,
            restart,
            self.omega_rad_s.to_bits(),
            low(step),
            high(step),
            self.place.cast_unsigned(),
        ];
        let values = self.parameters.iter().flat_map(Parameters::values);
        let bits = values.flat_map(|value| [low(value.to_bits()), high(value.to_bits())]);
        for (word, value) in words.iter_mut().zip(head.into_iter().chain(bits)) {
            *word = value;
        }
        words
    }

    /// Decodes the words of a block; `None` for an unknown subject.
    pub fn decode(exchange: &Exchange<'_>) -> Option<Self> {
        let word = |n: usize| exchange.get(PLAN + n);
        let number = |n| f64::from_bits(u64::from(word(n)) | u64::from(word(n + 1)) << 32);
        let parameters = |first: usize| {
            let mut parameters = Parameters::default();
            for (n, value) in parameters.values_mut().into_iter().enumerate() {
                *value = number(first + 2 * n);
            }
            parameters
        };
        Some(Self {
            subject: Subject::of_code(word(0))?,
            steps: word(1),
            restart: if word(2) == 0 {
                Restart::Elastic
            } else {
                Restart::FromKinetic
            },
            omega_rad_s: f32::from_bits(word(3)),
            step_s: number(4),
            place: word(6).cast_signed(),
            parameters: [HEAD, HEAD + 10].map(parameters),
        })
    }
}

#[expect(clippy::cast_possible_truncation, reason = "that half")]
fn low(bits: u64) -> u32 {
    bits as u32
}

fn high(bits: u64) -> u32 {
    low(bits >> 32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::sync::atomic::AtomicU32;
    use std::vec::Vec;

    #[test]
    fn a_plan_comes_out_as_it_went_in() {
        let mut plan = Plan::of(Subject::Renderer);
        plan.parameters[1].inertia_kg_m2 = 0.0123;
        plan.parameters[1].static_torque_nm = 0.77;
        plan.restart = Restart::FromKinetic;
        plan.step_s = 1.0 / 3.0;
        plan.omega_rad_s = -0.25;
        plan.place = -12_345;
        plan.steps = 77;
        let head = [0; PLAN].into_iter();
        let words: Vec<_> = head.chain(plan.encode()).map(AtomicU32::new).collect();
        assert_eq!(Plan::decode(&Exchange::new(&words)), Some(plan));
        words[PLAN].store(99, core::sync::atomic::Ordering::Relaxed);
        assert_eq!(Plan::decode(&Exchange::new(&words)), None);
    }
}
