//! The sensors of the drive, and their faults.

use crepitus_model::control::encoder::EncoderSettings;
use crepitus_plant::effects::motor::current_path::{self, Half};
use crepitus_plant::encoder::Encoder;

/// Wiring of the encoder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EncoderWiring {
    /// Correctly.
    #[default]
    Right,
    /// Channels A and B are swapped: it counts the other way.
    Swapped,
    /// No connection: the counter stays where it is, and edges are lost.
    Unplugged,
}

/// The two ways on which the current is measured: each has a shunt, an amplifier
/// and a converter of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CurrentPath {
    /// Path to the current loop.
    Sensor,
    /// Path to the monitor, whose amplifier the comparator sees, too.
    Monitor,
}

impl CurrentPath {
    /// Half of the bridge at which its amplifier sits.
    pub(super) fn half(self) -> Half {
        match self {
            Self::Sensor => Half::A,
            Self::Monitor => Half::B,
        }
    }
}

/// Reading of a shunt with its amplifier.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum CurrentSensor {
    /// The true current.
    #[default]
    Right,
    /// The current plus an offset, A.
    Offset(f64),
    /// The current times a gain.
    Gain(f64),
    /// A constant, A.
    StuckAt(f64),
}

impl CurrentSensor {
    pub(super) fn shows(self, current_a: f64) -> f64 {
        match self {
            Self::Right => current_a,
            Self::Offset(offset_a) => current_a + offset_a,
            Self::Gain(gain) => current_a * gain,
            Self::StuckAt(stuck_a) => stuck_a,
        }
    }
}

/// An amplifier over half a tick, with the faults of its shunt.
#[derive(Clone, Debug)]
pub struct Amplifier {
    pub(super) path: current_path::CurrentPath,
    pub(super) half: Half,
    /// By what the plant's current is above that of the pulses without their ripple, A.
    pub(super) off_a: f64,
    pub(super) sensor: CurrentSensor,
}

impl Amplifier {
    /// Reading `at_s` after the half tick began, A.
    pub fn shown_a(&self, at_s: f64) -> f64 {
        self.sensor
            .shows(self.path.shown_a(self.half, at_s) + self.off_a)
    }
}

/// Sensors of what changes slowly, and their faults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlowSensors {
    /// Reading of the supply's sensor in place of its voltage, V.
    pub supply_v: Option<f64>,
    /// Temperature of the motor, °C.
    pub motor_c: f64,
    /// Slip of the coupling between gear and brace, rad.
    pub slipped_rad: f64,
    /// Reading of the joint's sensor in place of its angle, turns.
    pub joint_turns: Option<f64>,
}

impl Default for SlowSensors {
    fn default() -> Self {
        Self {
            supply_v: None,
            motor_c: 25.0,
            slipped_rad: 0.0,
            joint_turns: None,
        }
    }
}

/// The encoder and the timer that counts its edges.
pub(super) struct Counter {
    encoder: Encoder,
    pub(super) wiring: EncoderWiring,
    /// Edges from the angle zero to the shaft's.
    edges: i32,
    count: i32,
}

impl Counter {
    /// A timer at zero.
    pub(super) fn new(settings: &EncoderSettings, angle_rad: f64) -> Self {
        let encoder = Encoder::new(settings);
        Self {
            edges: encoder.count(angle_rad),
            encoder,
            wiring: EncoderWiring::Right,
            count: 0,
        }
    }

    pub(super) fn count(&self) -> i32 {
        self.count
    }

    pub(super) fn preset(&mut self, count: i32) {
        self.count = count;
    }

    /// Turns the shaft to an angle.
    pub(super) fn turn_to(&mut self, angle_rad: f64) {
        let edges = self.encoder.count(angle_rad);
        let turned = edges.wrapping_sub(self.edges);
        self.edges = edges;
        self.count = match self.wiring {
            EncoderWiring::Right => self.count.wrapping_add(turned),
            EncoderWiring::Swapped => self.count.wrapping_sub(turned),
            EncoderWiring::Unplugged => self.count,
        };
    }
}
