//! Criteria of a trial, with their limits.

mod words;

use super::input::Input;
use crepitus_model::EVENTS_PER_STEP;
use crepitus_model::render::effects::symptom::Word;
use crepitus_scene::scene::Precision;

/// Common bounds of every trial: everything is finite, and no torque exceeds
/// Ts by more than this share; under `frozen` no angle of a stick exceeds
/// Ts/kr by more, unless its step had as many events as a step may have.
pub const BOUND_SLACK: f64 = 1e-5;

/// Largest missing share of (work + stored energy) under `physical` with both
/// events located.
pub const BALANCE: Limits = Limits {
    f64: 1e-10,
    f32: 1e-4,
};

/// Descriptions of the common bounds.
pub fn common_bounds() -> [String; 3] {
    [
        format!(
            "finite, and |T| ≤ Ts · (1 + {BOUND_SLACK:e}), after every step and at every event"
        ),
        format!(
            "frozen: |θ| ≤ Ts/kr · (1 + {BOUND_SLACK:e}) in every stick, but after a step of {EVENTS_PER_STEP} events"
        ),
        format!(
            "physical, exact-events: |work − stored − dissipated| within {} of the largest |work| + stored so far, \
             which is at least Ts²/2kr, where no step has {EVENTS_PER_STEP} events",
            words::Number(&BALANCE, "")
        ),
    ]
}

/// A limit in each precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Limit in f64.
    pub f64: f64,
    /// Limit in f32.
    pub f32: f64,
}

impl Limits {
    /// Equal limits in both precisions.
    pub const fn both(limit: f64) -> Self {
        Self {
            f64: limit,
            f32: limit,
        }
    }

    /// Returns the limit in `precision`.
    pub fn of(&self, precision: Precision) -> f64 {
        match precision {
            Precision::F32 => self.f32,
            Precision::F64 => self.f64,
        }
    }
}

/// Events that are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counted {
    /// All.
    Events,
    /// Breaks.
    Breaks,
    /// Reverses.
    Reverses,
}

/// A criterion.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Criterion {
    /// The common bounds, and nothing else.
    Survives,
    /// The true events in their order, each within a tolerance.
    Events {
        /// Seconds.
        within_s: Limits,
    },
    /// The torque just after each event is the true one.
    EventTorques {
        /// N·m.
        within_nm: Limits,
    },
    /// Number of events.
    Count {
        /// The counted events.
        what: Counted,
        /// Smallest number allowed.
        least: u64,
        /// Largest number allowed.
        most: u64,
    },
    /// No step has more events.
    EventsPerStep {
        /// Largest number allowed.
        most: u32,
    },
    /// Events per second, over the whole run.
    EventsPerSecond {
        /// Largest rate allowed, 1/s.
        most: f64,
    },
    /// The frequency of breaks is that of the closed form.
    CycleRate {
        /// The closed form, Hz.
        hz: f64,
        /// Relative.
        within: Limits,
    },
    /// Standard deviation of the time from break to break, relative to its
    /// mean.
    IntervalVariation {
        /// Largest ratio allowed.
        most: f64,
    },
    /// Every slip lasts this long.
    SlipTime {
        /// Seconds.
        slip_s: f64,
        /// Relative.
        within: Limits,
    },
    /// No event after this time.
    SilentAfter {
        /// Seconds.
        time_s: f64,
    },
    /// From `from_s` on the torque stays in a band.
    TorqueWithin {
        /// Start of the judged part of the run, s.
        from_s: f64,
        /// N·m.
        low_nm: f64,
        /// N·m.
        high_nm: f64,
        /// Tolerance outside, N·m.
        slack_nm: f64,
    },
    /// From `from_s` on the torque moves by so much at most, from its lowest to its
    /// highest.
    TorqueQuiet {
        /// Start of the judged part of the run, s.
        from_s: f64,
        /// N·m.
        most_nm: f64,
    },
    /// From `from_s` on every torque is the same, bit for bit.
    TorqueStays {
        /// Start of the judged part of the run, s.
        from_s: f64,
    },
    /// The last torque is the first.
    TorqueReturns {
        /// N·m.
        within_nm: Limits,
    },
    /// |∮ T dφ| over the run.
    LoopArea {
        /// J.
        most_j: Limits,
    },
    /// No stick breaks while the shaft is at rest.
    NoBreakAtRest,
    /// In a slip the shaft leads the object in the slip's sense, so the torque
    /// changes sign only when the relative velocity does.
    SlipsWithShaft {
        /// Largest lag at the end of a step, rad/s.
        within_rad_s: Limits,
    },
    /// The torque is that of another input with the sign changed, bit for bit.
    MirrorOf(Input),
    /// The torque is that of another input, bit for bit.
    SameAs(Input),
    /// The hash of all torque bits.
    TorqueBits(u64),
    /// The hand's largest swing in the last half second over that in the first.
    SwingRatio {
        /// Theory.
        theory: f64,
        /// Relative.
        within: f64,
    },
    /// Number of steps that end with a velocity below the smallest normal number.
    Subnormals {
        /// Largest number allowed.
        most: u64,
    },
    /// Change of torque from one step to the next.
    TorqueStep {
        /// N·m.
        most_nm: f64,
    },
    /// No adjustment of parameters raises the energy stored in the object.
    EnergyRise {
        /// Relative: rounding only.
        most: Limits,
    },
    /// Between events the torque keeps the slew limit, apart from the shaft's
    /// travel.
    Slew {
        /// Share of the limit by which it is exceeded: rounding only.
        beyond: Limits,
    },
    /// The first event after this time is a break, and on time.
    FirstBreakAfter {
        /// Time since the start, s.
        from_s: f64,
        /// Due time of the break, s.
        at_s: f64,
        /// Seconds.
        within_s: Limits,
    },
    /// No slip ends with more energy in the spring than it held at the break.
    SlipEnergy {
        /// Relative: rounding only.
        most: Limits,
    },
    /// Ticks in which the turn-back guard has switched the torque off.
    GuardTicks {
        /// Smallest number allowed.
        least: u64,
        /// Largest number allowed.
        most: u64,
    },
    /// Energy that the hand gets back over any time, beyond that of sampling,
    /// (½ + d)·kr·h·∫Ω²dt, as a share of the bound Ts²/2kr.
    Returned {
        /// Largest share allowed.
        most: f64,
    },
    /// The symptom's own events are those of its reference, each within a tolerance.
    SymptomEvents {
        /// Seconds.
        within_s: Limits,
    },
    /// The symptom's torque at the end of each step is that of its reference.
    SymptomTorques {
        /// N·m.
        within_nm: Limits,
    },
    /// The symptoms' own events are these, in this order.
    Words(&'static [Word]),
    /// Time of the symptoms' first event of one kind.
    FirstWord {
        /// Kind of event.
        word: Word,
        /// Time at which it is due, s.
        at_s: f64,
        /// Seconds.
        within_s: Limits,
    },
    /// Number of the symptoms' events of one kind.
    WordCount {
        /// Kind of event.
        word: Word,
        /// Smallest number allowed.
        least: u64,
        /// Largest number allowed.
        most: u64,
    },
    /// Energy that the hand gets back over any time from the springs of symptoms, beyond
    /// that of sampling, (½ + d)·σ·h·∫Ω²dt, as a share of T²/2σ.
    SpringsReturn {
        /// Largest share allowed.
        most: f64,
    },
    /// Energy that the hand gets back in any two seconds.
    NetReturned {
        /// Largest energy allowed, J.
        most_j: f64,
    },
    /// Range of a measured quantity of the vibration actuator.
    Actuator {
        /// Measured quantity.
        what: ActuatorMeasure,
        /// Start of the judged part of the run, s; without it the whole run is judged.
        from_s: Option<f64>,
        /// Smallest value allowed, in the unit of what is measured.
        least: f64,
        /// Largest value allowed, in the same unit.
        most: f64,
    },
    /// Every attempt is refused.
    Refused,
}

/// Measured quantity of the vibration actuator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActuatorMeasure {
    /// Root mean square of the shell's acceleration, m/s².
    AccelerationRms,
    /// Largest excursion of the mass, mm.
    Excursion,
    /// Largest voltage, V.
    Voltage,
    /// Largest change of the voltage in a tick, V.
    VoltageStep,
    /// Root mean square of the current, A.
    CurrentRms,
    /// Largest speed of the shaft, rad/s.
    ShaftSpeed,
    /// Largest gain of the loop from the actuator to the encoder and back, at gain 1.
    LoopGain,
    /// Largest gain of the loop where it is in phase: beyond its reciprocal the loop oscillates.
    LoopInPhase,
}

impl ActuatorMeasure {
    /// Returns the quantity in words, and the unit.
    pub fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::AccelerationRms => ("the shell's acceleration", "m/s² rms"),
            Self::Excursion => ("the mass's excursion", "mm"),
            Self::Voltage => ("the coil's voltage", "V"),
            Self::VoltageStep => ("a step of the coil's voltage", "V"),
            Self::CurrentRms => ("the coil's current", "A rms"),
            Self::ShaftSpeed => ("the shaft's speed", "rad/s"),
            Self::LoopGain => ("the loop gain", "at gain 1"),
            Self::LoopInPhase => ("the loop gain in phase", "at gain 1"),
        }
    }
}

impl Criterion {
    /// Returns whether it applies to the reference, which has no steps and provides the
    /// true events.
    pub fn suits_the_reference(&self) -> bool {
        !matches!(
            self,
            Self::Events { .. }
                | Self::EventTorques { .. }
                | Self::EventsPerStep { .. }
                | Self::TorqueBits(_)
                | Self::TorqueStep { .. }
                | Self::Subnormals { .. }
                | Self::SymptomEvents { .. }
                | Self::SymptomTorques { .. }
        )
    }

    /// The second input of a comparison.
    pub fn twin(&self) -> Option<&Input> {
        match self {
            Self::MirrorOf(input) | Self::SameAs(input) => Some(input),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_number_are_one() {
        let within_s = Limits {
            f64: 1e-12,
            f32: 5e-6,
        };
        assert_eq!(
            Criterion::Events { within_s }.to_string(),
            "same events as the reference, each within 1e-12 s (f64), 5e-6 s (f32)"
        );
        let three = Criterion::Count {
            what: Counted::Breaks,
            least: 3,
            most: 3,
        };
        assert_eq!(three.to_string(), "3 breaks");
        assert!(common_bounds()[2].contains("1e-10 (f64), 1e-4 (f32)"));
    }
}
