//! The steps of an input, generated on demand.

use super::guarded_joint::missing_step;
use super::input::{Fault, Input, What};
use crate::sampling::{CHUNK_STEPS, Sampling, Walk};
use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::render::input_check::CATCH_UP_TICKS;
use crepitus_model::{Real, SettingsError, ShaftStep};
use crepitus_plant::Motion;
use crepitus_plant::encoder::Encoder;
use fastrand::Rng;

/// A source of steps.
pub(super) trait Source<F> {
    /// Replaces `chunk` by the next steps, at most [`CHUNK_STEPS`]; empty at
    /// the end. `torque_nm` is the joint's current torque.
    fn fill(&mut self, chunk: &mut Vec<ShaftStep<F>>, torque_nm: F);

    /// First and last swing of the hand, rad, if there is one.
    fn swing_rad(&self) -> Option<(f64, f64)> {
        None
    }
}

/// The steps of `input` along its `motion`, which is owned by the caller because sources borrow it.
pub(super) fn source<'a, F: Real>(
    input: &Input,
    motion: &'a Motion,
) -> Result<Box<dyn Source<F> + 'a>, SettingsError> {
    let sampling = input.sampling(motion);
    let (steps, step_s) = (sampling.steps(), sampling.step_s());
    Ok(match input.what {
        What::Sampled(_) => Box::new(Cut(sampling.walk_from(0))),
        What::Repeated(omega_rad_s) => Box::new(Same {
            step: straight(omega_rad_s * step_s, omega_rad_s, omega_rad_s),
            left: steps,
        }),
        What::Encoder(_, readings) => {
            let settings = EncoderSettings {
                lines: readings.lines,
                ..EncoderSettings::default()
            };
            let encoder = Encoder::new(&settings);
            let (start, first) = (motion.at(0.0), readings.first_count);
            let zero = encoder.count(start.phi_rad);
            let omega = F::from_f64(start.omega_rad_s);
            Box::new(Counted {
                sampling,
                motion,
                offset: first.wrapping_sub(zero),
                encoder,
                reader: EncoderReader::new(&settings, step_s, first, omega)?,
                jitter: readings.jitter,
                lost: readings.lost,
                missed: 0,
                random: Rng::with_seed(1),
                n: 0,
            })
        }
        What::White { most_rad_s, seed } => Box::new(White {
            most_rad_s,
            step_s,
            random: Rng::with_seed(seed),
            omega_rad_s: 0.0,
            n: 0,
            steps,
        }),
        What::Hand {
            inertia_kg_m2,
            damping_nms_per_rad,
            omega_rad_s,
        } => Box::new(Hand {
            inertia_kg_m2,
            damping_nms_per_rad,
            step_s,
            phi_rad: 0.0,
            omega_rad_s,
            first_rad: 0.0,
            last_rad: 0.0,
            n: 0,
            steps,
        }),
        What::Faulty(_, fault) => Box::new(Faulty {
            walk: sampling.walk_from(0),
            fault,
            step_s,
            n: 0,
            travel: F::ZERO,
        }),
        // The others have their own runs.
        _ => Box::new(Same {
            step: ShaftStep::default(),
            left: 0,
        }),
    })
}

fn straight<F: Real>(delta_phi_rad: f64, from_rad_s: f64, to_rad_s: f64) -> ShaftStep<F> {
    ShaftStep {
        delta_phi_rad: F::from_f64(delta_phi_rad),
        omega_start_rad_s: F::from_f64(from_rad_s),
        omega_end_rad_s: F::from_f64(to_rad_s),
    }
}

struct Cut<'a>(Walk<'a>);

impl<F: Real> Source<F> for Cut<'_> {
    fn fill(&mut self, chunk: &mut Vec<ShaftStep<F>>, _: F) {
        self.0.fill(chunk, CHUNK_STEPS);
    }
}

struct Same<F> {
    step: ShaftStep<F>,
    left: u64,
}

impl<F: Real> Source<F> for Same<F> {
    fn fill(&mut self, chunk: &mut Vec<ShaftStep<F>>, _: F) {
        let full = u64::try_from(CHUNK_STEPS).unwrap_or(u64::MAX);
        let now = self.left.min(full);
        self.left -= now;
        chunk.resize(usize::try_from(now).unwrap_or(CHUNK_STEPS), self.step);
    }
}

struct Counted<'a, F> {
    sampling: Sampling<'a>,
    motion: &'a Motion,
    encoder: Encoder,
    reader: EncoderReader<F>,
    offset: i32,
    jitter: f64,
    lost: f64,
    /// Readings lost in a row. After more than the device catches up the joint begins anew, which
    /// is another case.
    missed: u32,
    random: Rng,
    n: u64,
}

impl<F: Real> Source<F> for Counted<'_, F> {
    fn fill(&mut self, chunk: &mut Vec<ShaftStep<F>>, _: F) {
        chunk.clear();
        while chunk.len() < CHUNK_STEPS && self.n < self.sampling.steps() {
            self.n += 1;
            let late = if self.jitter > 0.0 {
                self.jitter * (2.0 * self.random.f64() - 1.0)
            } else {
                0.0
            };
            let phi_rad = self.motion.at(self.sampling.time_s(self.n, late)).phi_rad;
            let count = self.encoder.count(phi_rad).wrapping_add(self.offset);
            let may_miss = self.lost > 0.0 && self.missed < CATCH_UP_TICKS;
            if may_miss && self.random.f64() < self.lost {
                self.missed += 1;
                self.reader.miss();
                chunk.push(missing_step());
            } else {
                self.missed = 0;
                chunk.push(self.reader.read(count));
            }
        }
    }
}

/// A motion with faulty samples.
struct Faulty<'a, F> {
    walk: Walk<'a>,
    fault: Fault,
    step_s: f64,
    n: u64,
    /// Travel since the last valid sample, rad.
    travel: F,
}

impl<F: Real> Faulty<'_, F> {
    /// The faulty sample in place of that of `shaft`, if it is faulty.
    fn wrong(&self, shaft: &ShaftStep<F>) -> Option<ShaftStep<F>> {
        let now_s = f64::from_whole(self.n) * self.step_s;
        match self.fault {
            Fault::Impossible(every) => self
                .n
                .is_multiple_of(every)
                .then(|| impossible(shaft, self.n / every)),
            Fault::Blind(from_s) => (now_s >= from_s).then(missing_step),
            Fault::Gap(from_s, to_s) => (from_s..to_s).contains(&now_s).then(missing_step),
            Fault::Retreating => (shaft.delta_phi_rad < F::ZERO).then(missing_step),
            Fault::Jumps(every) => self.n.is_multiple_of(every).then(|| ShaftStep {
                omega_end_rad_s: shaft.omega_end_rad_s + F::from_f64(20.0),
                ..*shaft
            }),
        }
    }
}

/// An implausible sample, its kind by `n`.
fn impossible<F: Real>(shaft: &ShaftStep<F>, n: u64) -> ShaftStep<F> {
    let (nan, inf) = (F::from_f64(f64::NAN), F::from_f64(f64::INFINITY));
    let mut wrong = *shaft;
    match n % 6 {
        0 => wrong.delta_phi_rad = nan,
        1 => wrong.omega_end_rad_s = nan,
        2 => wrong.delta_phi_rad = -inf,
        3 => wrong.omega_start_rad_s = inf,
        4 => wrong.delta_phi_rad = F::ONE,
        _ => wrong.omega_end_rad_s = F::from_f64(60.0),
    }
    wrong
}

impl<F: Real> Source<F> for Faulty<'_, F> {
    fn fill(&mut self, chunk: &mut Vec<ShaftStep<F>>, _: F) {
        self.walk.fill(chunk, CHUNK_STEPS);
        for shaft in chunk {
            self.n += 1;
            self.travel += shaft.delta_phi_rad;
            *shaft = match self.wrong(shaft) {
                Some(wrong) => wrong,
                None => ShaftStep {
                    delta_phi_rad: std::mem::take(&mut self.travel),
                    ..*shaft
                },
            };
        }
    }
}

struct White {
    most_rad_s: f64,
    step_s: f64,
    random: Rng,
    omega_rad_s: f64,
    n: u64,
    steps: u64,
}

impl White {
    /// Uniformly distributed velocity, rad/s.
    fn draw(&mut self) -> f64 {
        self.most_rad_s * (2.0 * self.random.f64() - 1.0)
    }
}

impl<F: Real> Source<F> for White {
    fn fill(&mut self, chunk: &mut Vec<ShaftStep<F>>, _: F) {
        chunk.clear();
        while chunk.len() < CHUNK_STEPS && self.n < self.steps {
            self.n += 1;
            if self.n.is_multiple_of(4) {
                self.omega_rad_s = self.draw();
            }
            let from = self.omega_rad_s;
            self.omega_rad_s = self.draw();
            let travel = 0.5 * (from + self.omega_rad_s) * self.step_s;
            chunk.push(straight(travel, from, self.omega_rad_s));
        }
    }
}

/// The hand's motion under a held torque is a closed form.
struct Hand {
    inertia_kg_m2: f64,
    damping_nms_per_rad: f64,
    step_s: f64,
    phi_rad: f64,
    omega_rad_s: f64,
    /// Largest |φ| within the first and the last half second, rad.
    first_rad: f64,
    last_rad: f64,
    n: u64,
    steps: u64,
}

impl<F: Real> Source<F> for Hand {
    fn fill(&mut self, chunk: &mut Vec<ShaftStep<F>>, torque_nm: F) {
        chunk.clear();
        if self.n == self.steps {
            return;
        }
        self.n += 1;
        let rate = self.damping_nms_per_rad / self.inertia_kg_m2;
        let drift = -torque_nm.to_f64() / self.damping_nms_per_rad;
        let decay = -(-rate * self.step_s).exp_m1();
        let from = self.omega_rad_s;
        self.omega_rad_s = from - (from - drift) * decay;
        let travel = drift * self.step_s + (from - drift) * decay / rate;
        self.phi_rad += travel;
        let window = (0.5 / self.step_s).whole();
        if self.n <= window {
            self.first_rad = self.first_rad.max(self.phi_rad.abs());
        }
        if self.n + window > self.steps {
            self.last_rad = self.last_rad.max(self.phi_rad.abs());
        }
        chunk.push(straight(travel, from, self.omega_rad_s));
    }

    fn swing_rad(&self) -> Option<(f64, f64)> {
        Some((self.first_rad, self.last_rad))
    }
}
