//! The laws in small steps, for random motions and numbers: a state that ends
//! is seen at the next step, so all agrees within some steps.

use crate::support::{Given, given, jumps, symptom};
use crepitus_plant::Motion;
use crepitus_scene::reference::symptoms::SymptomEvent;
use fastrand::Rng;

pub(crate) const STEP_S: f64 = 2e-6;
const END_S: f64 = 1.2;

/// Tolerances of the torques: at rest, N·m, and for a speed, N·m·s/rad: the
/// stiffest rise over two steps.
const TORQUE_NM: f64 = 1e-3;
const TORQUE_NMS_PER_RAD: f64 = 2.0 * 500.0 * STEP_S;

/// Symptoms whose torque does not hang on which of two events comes first, or
/// on which side of an edge the joint rests.
const STEADY: [&str; 3] = ["range-limit", "lead-pipe", "cogwheel"];

/// Tolerance of the times, s: a slow return shows what a step was late.
const TIME_S: f64 = 1e-4;

/// Runs of each law.
const RUNS: u64 = 40;

/// Numbers that look random.
pub(crate) struct Random(Rng);

impl Random {
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.f64()
    }

    /// Returns what [`Self::between`] does, but now and then a number at which a law is not
    /// what it is in general.
    pub(crate) fn or(&mut self, low: f64, high: f64, special: &[f64]) -> f64 {
        let (usual, place) = (self.between(low, high), self.between(0.0, 3.0));
        let special = special.iter().zip(0_u8..);
        let mut chosen = special.filter(|(_, i)| (place - f64::from(*i)).abs() < 0.15);
        chosen.next().map_or(usual, |(x, _)| *x)
    }

    fn happens(&mut self, share: f64) -> bool {
        self.0.f64() < share
    }

    /// Whole degrees and twentieths of seconds: events meet knots, and each
    /// other.
    fn lattice(&mut self) -> Motion {
        let (mut time, mut speed) = (0.0, 0.0);
        let mut knots = Vec::new();
        let mut angle = 5.0 * self.between(0.0, 20.0).floor();
        let from_deg = angle;
        while time < END_S {
            let left = speed;
            if self.happens(0.7) {
                speed = 20.0 * self.between(-8.0, 9.0).floor();
                if (angle - 50.0) * speed > 0.0 && self.happens(0.7) {
                    speed = -speed;
                }
            }
            knots.push((time, left, speed));
            let length = 0.05 * self.between(1.0, 5.0).floor();
            angle += speed * length;
            time += length;
        }
        jumps(from_deg, &knots)
    }

    /// Strokes, rests and jumps about the middle of the joint's range.
    fn motion(&mut self) -> Motion {
        if self.happens(0.15) {
            let amplitude = self.between(0.3, 2.0);
            let frequency_hz = self.between(0.3, 4.0);
            return Motion::sine(amplitude, frequency_hz, self.between(-180.0, 180.0));
        }
        let from_deg = self.between(0.0, 120.0);
        let (mut angle, mut time, mut speed) = (from_deg, 0.0, 0.0);
        let mut knots = Vec::new();
        while time < END_S {
            let left = speed;
            let pull = 2.0 * (60.0 - angle);
            if self.happens(0.3) {
                speed = if self.happens(0.3) {
                    0.0
                } else {
                    pull + self.between(-250.0, 250.0)
                };
            }
            knots.push((time, left, speed));
            let length = self.between(0.03, 0.3);
            let next = if self.happens(0.4) {
                speed
            } else {
                pull + self.between(-250.0, 250.0)
            };
            angle += 0.5 * (speed + next) * length;
            time += length;
            speed = next;
        }
        jumps(from_deg, &knots)
    }
}

/// A law in steps: the torque at the end of a step, and what happened in it.
pub(crate) type Stepped<'a> = Box<dyn FnMut(f64, f64, f64, &mut Vec<&'static str>) -> f64 + 'a>;

/// The stop operator.
#[derive(Clone, Copy)]
pub(crate) struct Stop {
    pub(crate) sigma: f64,
    pub(crate) a: f64,
}

impl Stop {
    pub(crate) fn clip(&mut self, x: f64, upper: f64, lower: f64) -> f64 {
        let torque = self.sigma * (x - self.a);
        let clipped = torque.min(upper).max(lower);
        if clipped != torque {
            self.a = x - clipped / self.sigma;
        }
        clipped
    }
}

/// Steps through motions and compares torques and, on a motion without
/// coincidences, the events of these words.
pub(crate) fn compare(
    name: &str,
    choices: &[(&str, &str)],
    words: &[&str],
    numbers: impl Fn(&mut Random) -> Vec<(&'static str, f64)>,
    law: impl for<'a> Fn(&'a [(&'static str, f64)], f64) -> Stepped<'a>,
) {
    let mut seen = 0;
    for seed in 0..RUNS {
        let seed_of_case = seed.wrapping_mul(0x1234_5678_9ABC) ^ name.len() as u64;
        let mut random = Random(Rng::with_seed(seed_of_case));
        let numbers = numbers(&mut random);
        // A coincidence may trigger a muscle or not, by rounding alone.
        let is_lattice = STEADY.contains(&name) && choices.is_empty() && seed % 2 == 1;
        let motion = if is_lattice {
            random.lattice()
        } else {
            random.motion()
        };
        let given: Given = given(&numbers, choices);
        let mut reference = symptom(name, &given, &motion);
        let mut all: Vec<SymptomEvent> = Vec::new();
        let mut stepped = law(&numbers, motion.at(0.0).phi_rad);
        let mut happened: Vec<(f64, &'static str)> = Vec::new();
        let mut own = Vec::new();
        let mut place = 0;
        let mut fastest = 0.0_f64;
        let mut piece = motion.piece(0.0);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "small"
        )]
        let steps = (END_S / STEP_S) as u32;
        // A torque is compared a few steps after the last event at the earliest.
        let mut pending: Option<(f64, f64)> = None;
        for n in 0..=steps {
            let time_s = f64::from(n) * STEP_S;
            while piece.end_s <= time_s {
                piece = motion.piece_from(piece.end_s, &mut place);
            }
            let (phi, omega) = piece.angle_and_velocity(time_s);
            fastest = fastest.max(omega.abs());
            let torque = stepped(time_s, phi, omega, &mut own);
            happened.extend(own.drain(..).map(|word| (time_s, word)));
            if let Some((at_s, nm)) = pending.take_if(|_| n % 500 == 5) {
                let quiet = |e: &SymptomEvent| (e.time_s - at_s).abs() > 4.0 * STEP_S;
                all.extend(reference.advance(at_s));
                let found = reference.torque_nm();
                let (before, calm) = (all.len(), all.iter().rev().take(3).all(quiet));
                if n % 50_000 == 5 {
                    // Now and then from the start, to be sure that nothing hangs on the rows.
                    let mut later = symptom(name, &given, &motion);
                    later.advance(at_s);
                    assert_eq!(later.torque_nm().to_bits(), found.to_bits());
                }
                all.extend(reference.advance(time_s));
                if calm && all.len() == before {
                    assert!(
                        (found - nm).abs() < TORQUE_NM + TORQUE_NMS_PER_RAD * fastest,
                        "{name} {choices:?} {seed}: {found} for {nm} at {at_s}, {numbers:?}"
                    );
                    seen += 1;
                }
            }
            if n % 500 == 0 {
                pending = Some((time_s, torque));
            }
        }
        all.extend(reference.advance(END_S));
        if is_lattice {
            continue;
        }
        let listed: Vec<_> = all
            .iter()
            .filter(|e| words.contains(&e.kind.name()))
            .map(|e| (e.time_s, e.kind.name()))
            .collect();
        let sequence = |events: &[(f64, &'static str)]| -> Vec<_> {
            events.iter().map(|(_, word)| *word).collect()
        };
        assert_eq!(
            sequence(&listed),
            sequence(&happened),
            "{name} {choices:?} {seed}: {listed:?} for {happened:?}, {numbers:?}"
        );
        for ((found, word), (stepped, _)) in listed.iter().zip(&happened) {
            assert!(
                (found - stepped).abs() < TIME_S,
                "{name} {choices:?} {seed}: {word} at {found} for {stepped}, {numbers:?}"
            );
        }
    }
    println!("{name} {choices:?}: {seen} torques");
    assert!(seen > 10_000, "{name}: {seen}");
}

pub(crate) fn get(numbers: &[(&'static str, f64)], key: &str) -> f64 {
    let found = numbers.iter().find(|(k, _)| *k == key);
    found.map(|(_, x)| *x).expect("a number of the case")
}

pub(crate) fn deg(numbers: &[(&'static str, f64)], key: &str) -> f64 {
    get(numbers, key).to_radians()
}
