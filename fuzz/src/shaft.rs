//! Bytes to the motion of a shaft: smooth, jumping, at rest, or numbers that
//! have nothing to do with each other.

use crate::bytes::Bytes;
use crepitus_model::ShaftStep;

/// Goes on from the velocity that the last step ended with.
#[derive(Default)]
pub(crate) struct Shaft {
    omega_rad_s: f64,
}

impl Shaft {
    /// The next steps: a tag, its numbers, and how often the same again.
    pub(crate) fn next(&mut self, bytes: &mut Bytes<'_>, step_s: f64) -> Vec<ShaftStep<f64>> {
        let tag = bytes.byte();
        let step = match tag % 8 {
            // Raw numbers.
            0 => ShaftStep {
                delta_phi_rad: bytes.double(),
                omega_start_rad_s: bytes.double(),
                omega_end_rad_s: bytes.double(),
            },
            1 => ShaftStep {
                delta_phi_rad: bytes.single(),
                omega_start_rad_s: bytes.single(),
                omega_end_rad_s: bytes.single(),
            },
            // Rest, without a jump or with one.
            2 => self.to(0.0, step_s),
            3 => ShaftStep::default(),
            // Steady, and towards a speed, of a hand and of anything.
            4 => self.to(self.omega_rad_s, step_s),
            5 => self.to(50.0 * bytes.signed(), step_s),
            6 => self.to(bytes.single(), step_s),
            // An angle that the velocities do not explain.
            _ => ShaftStep {
                delta_phi_rad: 100.0 * bytes.signed() * step_s,
                ..self.to(50.0 * bytes.signed(), step_s)
            },
        };
        self.omega_rad_s = step.omega_end_rad_s;
        let times = 1 << (tag >> 5);
        // Repeats: the step itself, or its last speed without the rise.
        let again = if tag & 8 == 0 {
            step
        } else {
            self.to(self.omega_rad_s, step_s)
        };
        let mut steps = vec![again; times];
        steps[0] = step;
        steps
    }

    /// A step that ends with `omega_rad_s`, all of one piece.
    fn to(&self, omega_rad_s: f64, step_s: f64) -> ShaftStep<f64> {
        ShaftStep {
            delta_phi_rad: f64::midpoint(self.omega_rad_s, omega_rad_s) * step_s,
            omega_start_rad_s: self.omega_rad_s,
            omega_end_rad_s: omega_rad_s,
        }
    }
}
