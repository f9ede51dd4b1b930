//! The exact input of a trial, as data.

mod actuator;
mod device;
mod scene;
mod symptom;

pub(crate) use actuator::{ActuatorLoop, ActuatorRun, Upset};
pub(crate) use device::{Fault, Lost, Readings, Rendered, Shake};
pub(crate) use scene::SceneRun;
pub(crate) use symptom::SymptomRun;

use super::text::{Knots, Plain, Time};
use crate::sampling::Sampling;
use crate::symptoms::Given;
use crepitus_model::Parameters;
use crepitus_model::parameters::Tabled;
use crepitus_plant::Motion;
use crepitus_plant::motion::{Strokes, VelocityKnot};
use crepitus_plant::recording::{Samples, smooth};
use std::fmt;

/// A prescribed motion of the shaft.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Shaft {
    /// φ = Ω·t, Ω in rad/s.
    Constant(f64),
    /// φ = A·sin(2π·f·t + phase): A in rad, f in Hz, the phase in degrees.
    Sine(f64, f64, f64),
    /// Velocity linear between knots: time s, Ω just before and just after it,
    /// rad/s.
    Knots(&'static [(f64, f64, f64)]),
    /// Minimum-jerk strokes there and back, with a pause after each.
    Strokes(Strokes),
    /// A recording: time s and angle rad of each row, the sign of the angles, and the cutoff of
    /// the low-pass that smooths it, Hz.
    Rows(&'static [(f64, f64)], f64, f64),
}

/// Input of a trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    pub(super) what: What,
    /// Duration, s; 0 if nothing runs.
    pub(super) duration_s: f64,
    /// The step, s.
    pub(super) step_s: f64,
}

/// Kinds of inputs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum What {
    /// A motion cut into steps; the true events are known.
    Sampled(Shaft),
    /// One step at this velocity, rad/s, repeated, for runs too long to cut into steps.
    Repeated(f64),
    /// A motion measured by the encoder at the motor and the estimator that
    /// ships.
    Encoder(Shaft, Readings),
    /// White velocities: every step ends at a random one, and every fourth
    /// begins with a jump to one.
    White {
        /// The largest speed, rad/s.
        most_rad_s: f64,
        seed: u64,
    },
    /// A hand of inertia I with damping b that turns the joint against its
    /// torque, held over each step: I·Ω̇ = −T − b·Ω.
    Hand {
        inertia_kg_m2: f64,
        damping_nms_per_rad: f64,
        /// Velocity at the start, rad/s.
        omega_rad_s: f64,
    },
    /// A motion with faulty samples.
    Faulty(Shaft, Fault),
    /// A frozen joint whose parameters change at these times, s, ramped as in the
    /// device.
    ParameterChanges(Shaft, Vec<(f64, Parameters)>),
    /// A hand that shakes a joint as the device renders it.
    ShakingHand(Shaft, Shake),
    /// A frozen joint as the device renders it, with lost samples and commits.
    Rendered(Shaft, Rendered),
    /// Symptoms besides crepitus, as the device renders them.
    Symptoms(SymptomRun),
    Scene(SceneRun),
    /// A device with the vibration actuator, on a leg in a hand.
    Actuator(ActuatorRun),
    /// The loop from the vibration actuator to the encoder and back, linear.
    ActuatorLoop(ActuatorLoop),
    /// Parameters and steps, s, that must be refused, with the mistake of each.
    Refusals(Vec<(&'static str, Parameters, f64)>),
    /// Symptoms that must be refused, with the mistake of each.
    SymptomRefusals(Vec<(&'static str, Vec<Given>)>),
}

impl Shaft {
    /// The motion itself.
    pub(super) fn motion(&self) -> Motion {
        match self {
            Self::Constant(omega_rad_s) => Motion::constant(*omega_rad_s),
            Self::Sine(amplitude_rad, frequency_hz, phase_deg) => {
                Motion::sine(*amplitude_rad, *frequency_hz, *phase_deg)
            }
            Self::Knots(knots) => {
                let knot = |&(time_s, left, right): &(f64, f64, f64)| VelocityKnot {
                    time_s,
                    omega_left_rad_s: left,
                    omega_right_rad_s: right,
                };
                Motion::velocity_knots(&knots.iter().map(knot).collect::<Vec<_>>())
            }
            Self::Strokes(strokes) => Motion::Strokes(*strokes),
            Self::Rows(rows, sign, cutoff_hz) => {
                let samples = Samples {
                    time_s: rows.iter().map(|row| row.0).collect(),
                    angle_rad: rows.iter().map(|row| sign * row.1).collect(),
                    ..Samples::default()
                };
                // The catalogue's rows can be smoothed; a test says so.
                smooth(&samples, *cutoff_hz)
                    .map_or_else(|_| Motion::rest(0.0), |pieces| Motion::recording(&pieces))
            }
        }
    }
}

impl Input {
    pub(crate) fn new(what: What, duration_s: f64, step_s: f64) -> Self {
        Self {
            what,
            duration_s,
            step_s,
        }
    }

    /// A motion cut into steps.
    pub(crate) fn sampled(shaft: Shaft, duration_s: f64, step_s: f64) -> Self {
        Self::new(What::Sampled(shaft), duration_s, step_s)
    }

    /// Nothing that runs.
    pub(super) fn still(what: What) -> Self {
        Self::new(what, 0.0, 1.0)
    }

    /// The motion of the shaft; rest if it is not prescribed.
    pub(super) fn motion(&self) -> Motion {
        match &self.what {
            What::Sampled(shaft)
            | What::Encoder(shaft, _)
            | What::Faulty(shaft, _)
            | What::ParameterChanges(shaft, _)
            | What::ShakingHand(shaft, _)
            | What::Rendered(shaft, _) => shaft.motion(),
            What::Repeated(omega_rad_s) => Motion::constant(*omega_rad_s),
            _ => Motion::constant(0.0),
        }
    }

    /// Cuts a motion into the steps of a run.
    pub(super) fn sampling<'m>(&self, motion: &'m Motion) -> Sampling<'m> {
        Sampling::new(motion, self.duration_s, self.step_s)
    }

    /// Velocity of the shaft as the run starts, rad/s.
    pub(super) fn first_omega_rad_s(&self) -> f64 {
        match self.what {
            What::Hand { omega_rad_s, .. } => omega_rad_s,
            _ => self.motion().at(0.0).omega_rad_s,
        }
    }

    /// Returns whether it applies to the reference, which takes no samples.
    pub(super) fn suits_the_reference(&self) -> bool {
        match &self.what {
            What::Sampled(_) => true,
            What::Symptoms(run) => run.suits_the_reference(),
            What::Scene(run) => run.is_compared,
            _ => false,
        }
    }

    /// Returns whether the joint needs the check of its input that the device has.
    pub(super) fn needs_guard(&self) -> bool {
        match &self.what {
            What::Faulty(..) => true,
            What::Encoder(_, readings) => readings.lost > 0.0,
            _ => false,
        }
    }

    /// Returns whether each step is that of the motion to f64 precision: without an
    /// encoder and without catching up.
    pub(super) fn is_exact(&self) -> bool {
        !matches!(self.what, What::Encoder(..) | What::Faulty(..))
    }

    /// Steps of a run; 0 if nothing runs.
    pub fn steps(&self) -> f64 {
        (self.duration_s / self.step_s).round()
    }
}

/// Parameters that differ from the paper's, in words.
pub(super) fn unlike_the_paper(parameters: &Parameters) -> Vec<String> {
    let paper = Parameters::default().values();
    let all = Parameters::TABLE.iter().zip(parameters.values());
    all.zip(paper)
        .filter(|((_, value), paper)| value != paper)
        .map(|((spec, value), _)| format!("{} = {} {}", spec.symbol, Plain(value), spec.unit))
        .collect()
}

impl fmt::Display for Shaft {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(omega) => write!(f, "Ω = {} rad/s", Plain(*omega)),
            Self::Sine(amplitude, frequency, phase_deg) => {
                let [amplitude, frequency] = [*amplitude, *frequency].map(Plain);
                write!(f, "φ = {amplitude} rad · sin(2π · {frequency} Hz · t")?;
                if *phase_deg == 0.0 {
                    f.write_str(")")
                } else {
                    write!(f, " {phase_deg:+}°)")
                }
            }
            Self::Knots(knots) => {
                write!(f, "Ω linear between (t s: Ω rad/s){}", Knots(knots))
            }
            Self::Strokes(strokes) => write!(
                f,
                "minimum-jerk strokes from {} to {} rad at {} rad/s with a pause of {}",
                Plain(strokes.from_rad),
                Plain(strokes.to_rad),
                Plain(strokes.peak_speed_rad_s),
                Time(strokes.pause_s)
            ),
            Self::Rows(rows, sign, cutoff_hz) => {
                let angles = rows.iter().map(|(time_s, angle)| (*time_s, sign * angle));
                let rows: Vec<_> = angles.map(|(t, angle)| (t, angle, angle)).collect();
                let rows = Knots(&rows);
                write!(f, "recording smoothed at {cutoff_hz} Hz (t s: rad){rows}")
            }
        }
    }
}

impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.what {
            What::Sampled(shaft) => write!(f, "{shaft}")?,
            What::Repeated(omega) => {
                write!(f, "one and the same step of Ω = {} rad/s", Plain(*omega))?;
            }
            What::Encoder(shaft, readings) => write!(f, "{shaft}, {readings}")?,
            What::White { most_rad_s, seed } => write!(
                f,
                "white velocity within ±{} rad/s, every fourth step a jump (seed {seed})",
                Plain(*most_rad_s)
            )?,
            What::Hand {
                inertia_kg_m2,
                damping_nms_per_rad,
                omega_rad_s,
            } => write!(
                f,
                "a hand of {} kg·m² and {} N·m·s/rad that starts with {} rad/s, moved by the torque shown",
                Plain(*inertia_kg_m2),
                Plain(*damping_nms_per_rad),
                Plain(*omega_rad_s)
            )?,
            What::Faulty(shaft, fault) => write!(f, "{shaft}, {fault}")?,
            What::ParameterChanges(shaft, changes) => {
                write!(f, "{shaft}")?;
                for (at_s, parameters) in changes {
                    write!(f, ", at {}{}", Time(*at_s), device::named(parameters))?;
                }
            }
            What::ShakingHand(shaft, shake) => write!(f, "{shaft}, {shake}")?,
            What::Rendered(shaft, rendered) => write!(f, "{shaft}, {rendered}")?,
            What::Symptoms(run) => write!(f, "{run}")?,
            What::Scene(run) => f.write_str(run.what)?,
            What::Actuator(run) => write!(f, "{run}")?,
            What::ActuatorLoop(linear) => write!(f, "{linear}")?,
            What::Refusals(attempts) => list(f, attempts.iter().map(|attempt| attempt.0))?,
            What::SymptomRefusals(attempts) => list(f, attempts.iter().map(|attempt| attempt.0))?,
        }
        if self.duration_s == 0.0 {
            return Ok(());
        }
        let (duration, step) = (Time(self.duration_s), Time(self.step_s));
        write!(f, ", {duration} in steps of {step}")
    }
}

fn list(f: &mut fmt::Formatter<'_>, names: impl Iterator<Item = &'static str>) -> fmt::Result {
    f.write_str(&names.collect::<Vec<_>>().join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_holds_every_number() {
        let shaft = Shaft::Knots(&[(0.0, 1.0, 1.0), (0.5, 1.0, -0.25)]);
        let input = Input::sampled(shaft, 2.0, 5e-5);
        assert_eq!(
            input.to_string(),
            "Ω linear between (t s: Ω rad/s) 0: 1, 0.5: 1|-0.25, 2 s in steps of 50 µs"
        );
        assert_eq!(input.steps(), 40_000.0);
        let sine = Shaft::Sine(0.003, 1.0, -90.0);
        assert_eq!(sine.to_string(), "φ = 0.003 rad · sin(2π · 1 Hz · t -90°)");
    }

    #[test]
    fn the_rows_of_the_catalogue_can_be_smoothed() {
        let mut seen = 0;
        for case in crate::stability::catalogue::all() {
            for trial in crate::stability::Subject::all()
                .into_iter()
                .flat_map(case.trials)
            {
                let Input {
                    what, duration_s, ..
                } = trial.input;
                if let What::Sampled(shaft @ Shaft::Rows(..)) = what {
                    let motion = shaft.motion();
                    assert!(motion.at(0.5 * duration_s).phi_rad.abs() > 0.1);
                    assert!(motion.piece(duration_s).end_s > duration_s);
                    seen += 1;
                }
            }
        }
        assert!(seen > 0);
    }

    #[test]
    fn bursts_begin_and_repeat_on_time() {
        let lost = |every, from_s| Lost {
            ticks: 2,
            every,
            from_s,
        };
        let taken = |lost: Lost| {
            (1..=9)
                .filter(|n| lost.takes(*n, 1.0))
                .collect::<Vec<u64>>()
        };
        assert_eq!(taken(lost(4, 0.0)), [1, 2, 5, 6, 9]);
        assert_eq!(taken(lost(0, 3.0)), [4, 5]);
        assert!(taken(Lost::NONE).is_empty());
    }
}
