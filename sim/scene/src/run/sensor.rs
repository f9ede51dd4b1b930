//! The joint's input: the exact motion of the shaft, or that of an encoder.

use crate::trace::{Column, ColumnKind};
use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::render::position::{Position, Sensing};
use crepitus_model::{Real, SettingsError, ShaftStep};
use crepitus_plant::chain::Body;
use crepitus_plant::encoder::Encoder;

/// Turns the true motion over a step into the joint's input.
///
/// Implementations are chosen once per run; an absent sensor is the type
/// [`Ideal`], which has no state, no column and no test in the step.
pub(super) trait Sensor<F: Real>: Clone + Send + 'static {
    /// Columns of the sensor in the trace.
    const COLUMNS: &'static [Column];

    /// Whether a step may be split where the motion breaks: a device samples on its ticks.
    const SPLITS: bool;

    /// Takes in one step. Velocities are those just inside the step.
    fn see(&mut self, from: &Body, to: &Body) -> ShaftStep<F>;

    /// Position at which it has last seen the joint.
    fn place(&self, to: &Body) -> Position<F>;

    /// Writes its columns.
    fn write(&self, row: &mut Vec<f64>);
}

/// The joint knows the true motion.
#[derive(Clone)]
pub(super) struct Ideal;

impl<F: Real> Sensor<F> for Ideal {
    const COLUMNS: &'static [Column] = &[];
    const SPLITS: bool = true;

    #[inline]
    fn see(&mut self, from: &Body, to: &Body) -> ShaftStep<F> {
        ShaftStep {
            delta_phi_rad: F::from_f64(to.angle_rad - from.angle_rad),
            omega_start_rad_s: F::from_f64(from.omega_rad_s),
            omega_end_rad_s: F::from_f64(to.omega_rad_s),
        }
    }

    #[inline]
    fn place(&self, to: &Body) -> Position<F> {
        Sensing::IDEAL.position(to.angle_rad)
    }

    fn write(&self, _: &mut Vec<f64>) {}
}

/// The joint knows the counts of an encoder at the motor.
#[derive(Clone)]
pub(super) struct Encoded<F> {
    encoder: Encoder,
    reader: EncoderReader<F>,
    first_count: i32,
    first_rad: f64,
    count: i32,
    omega_rad_s: F,
}

impl<F: Real> Encoded<F> {
    /// An encoder on a shaft that has moved like this for a while: the
    /// velocity estimate has settled.
    pub(super) fn new(
        settings: &EncoderSettings,
        step_s: f64,
        shaft: &Body,
    ) -> Result<Self, SettingsError> {
        let encoder = Encoder::new(settings);
        let count = encoder.count(shaft.angle_rad);
        let omega_rad_s = F::from_f64(shaft.omega_rad_s);
        Ok(Self {
            reader: EncoderReader::new(settings, step_s, count, omega_rad_s)?,
            first_count: count,
            first_rad: (shaft.angle_rad / encoder.rad_per_count()).floor()
                * encoder.rad_per_count(),
            encoder,
            count,
            omega_rad_s,
        })
    }
}

impl<F: Real> Sensor<F> for Encoded<F> {
    const SPLITS: bool = false;
    const COLUMNS: &'static [Column] = &[
        Column {
            name: "encoder_count",
            kind: ColumnKind::Whole,
        },
        Column {
            name: "encoder_angle_rad",
            kind: ColumnKind::Number,
        },
        Column {
            name: "encoder_omega_rad_s",
            kind: ColumnKind::Number,
        },
    ];

    #[inline]
    fn see(&mut self, _: &Body, to: &Body) -> ShaftStep<F> {
        self.count = self.encoder.count(to.angle_rad);
        let step = self.reader.read(self.count);
        self.omega_rad_s = step.omega_end_rad_s;
        step
    }

    #[inline]
    fn place(&self, _: &Body) -> Position<F> {
        Position::at(self.count)
    }

    fn write(&self, row: &mut Vec<f64>) {
        let moved = f64::from(self.count.wrapping_sub(self.first_count));
        row.extend([
            f64::from(self.count),
            self.first_rad + moved * self.encoder.rad_per_count(),
            self.omega_rad_s.to_f64(),
        ]);
    }
}
