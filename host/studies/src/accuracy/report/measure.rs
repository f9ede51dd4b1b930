//! The errors that diagrams show.

use crate::accuracy::Point;

crepitus_model::named! {
    /// See the module.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) enum Measure {
        EventTime => "event-time",
        HeldTorque => "held-torque",
        TickTorque => "tick-torque",
        Frequency => "frequency",
    }
}

/// A line of FACTS: an error below it is good enough, or cannot be felt.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PerceptualLine {
    pub(crate) value: f64,
    pub(crate) label: &'static str,
}

const fn line(value: f64, label: &'static str) -> PerceptualLine {
    PerceptualLine { value, label }
}

const EVENT_TIME: [PerceptualLine; 2] = [
    line(5e-4, "0.5 ms worth having"),
    line(1e-4, "0.1 ms imperceptible"),
];

const TORQUE: [PerceptualLine; 2] = [
    line(5e-3, "5 mN·m worth having"),
    line(1e-3, "1 mN·m imperceptible"),
];

impl Measure {
    pub(crate) fn of(self, point: &Point) -> f64 {
        match self {
            Self::EventTime => point.max_event_error_s,
            Self::HeldTorque => point.rms_held_torque_error_nm,
            Self::TickTorque => point.rms_tick_torque_error_nm,
            Self::Frequency => point.frequency_error_rel,
        }
    }

    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::EventTime => "Event time: the worst error against the cost",
            Self::HeldTorque => "Held torque: the RMS error against the cost",
            Self::TickTorque => "Torque at the tick: the RMS error against the cost",
            Self::Frequency => "Cycle frequency: the relative error against the cost",
        }
    }

    pub(crate) fn axis(self) -> &'static str {
        match self {
            Self::EventTime => "Worst event-time error (s)",
            Self::HeldTorque => "RMS error of the held torque (N·m)",
            Self::TickTorque => "RMS torque error at the tick (N·m)",
            Self::Frequency => "Relative frequency error",
        }
    }

    /// Unit to stand after a number, with its space.
    pub(crate) fn unit(self) -> &'static str {
        match self {
            Self::EventTime => " s",
            Self::HeldTorque | Self::TickTorque => " N·m",
            Self::Frequency => "",
        }
    }

    /// Perceptual lines from the larger to the smaller.
    pub(crate) fn lines(self) -> &'static [PerceptualLine] {
        match self {
            Self::EventTime => &EVENT_TIME,
            Self::HeldTorque | Self::TickTorque => &TORQUE,
            Self::Frequency => &[],
        }
    }

    pub(crate) fn caption(self) -> &'static str {
        match self {
            Self::EventTime => {
                "How far the worst break, stick or reversal is from where it belongs. Below 0.5 ms \
                 a better time is still worth having; below 0.1 ms nobody feels it."
            }
            Self::HeldTorque => {
                "What a device shows that holds each torque for a step, against the true torque \
                 at every time between, as root mean square. An event that falls within a step \
                 comes late however exactly its time is known, so all solvers that find it meet \
                 at one line."
            }
            Self::TickTorque => {
                "The torque's error at the ends of steps alone, as root mean square: a jump of the \
                 torque that comes late counts in full while it is late. Below 5 mN·m less is \
                 still worth having; below 1 mN·m nobody feels it."
            }
            Self::Frequency => {
                "The error of the number of cycles per second: 10⁻⁵ are five correct digits."
            }
        }
    }
}
