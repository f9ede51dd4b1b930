//! Energy that a bare joint can return: what its spring stores, what its sampling makes, and what a slip pushes.
//!
//! A `frozen` slip shows s·Tk for its time t, whatever the shaft does meanwhile (Tk: kinetic torque). A shaft that begins it
//! with s·Ω₀ and is slowed down by α retreats by α·t²/2 − Ω₀·t, and the torque pushes it along. The slip has taken
//! (Ts² − Tr²)/2kr out of the spring (Ts: static torque, Tr: torque of the restart, kr: stiffness), so nothing is
//! returned as long as
//!
//! ```text
//! Tk·(α·t²/2 − Ω₀·t) ≤ (Ts² − Tr²)/2kr     for every Ω₀ ≥ 0,     ωn·t = π + 2·atan(Ω₀·√(J·kr)/(Ts − Tk))
//! ```
//!
//! (the slip's duration: eqs. (10) and (11) of Ishikawa, Okamoto et al.; the condition: docs/stability.md, where a device
//! has a guard instead, and retreats are counts of its encoder). Then, over any stretch,
//!
//! ```text
//! E ≤ Ts²/2kr + (½ + d)·kr·h·∫Ω² dt
//! ```
//!
//! for a torque that is held over the step after its own, and d steps more. Under `paper` and `physical` a slip ends where
//! the velocities meet, and no such limit is known.

use crepitus_model::{Convention, Settings, SettingsError, StepCoefficients, Validated};

/// Speeds of the shaft at which a slip is looked at, as shares of (Ts − Tk)/√(J·kr): from rest to where its duration
/// hardly changes any more.
const SPEEDS: u32 = 4_000;
const SPEED_STEP: f64 = 0.005;

/// Energy that a joint without a guard can return to its shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passivity {
    /// Energy that the spring stores at most, Ts²/2kr, J: what comes back of it was put in before.
    pub stored_j: f64,
    /// Damping of the shaft that takes what sampling makes, (½ + d)·kr·h, N·m·s/rad.
    pub needed_damping_nms_per_rad: f64,
    /// Acceleration up to which no slip pushes, without velocity steps, rad/s²; none where no limit is known.
    pub most_acceleration_rad_s2: Option<f64>,
    /// Velocity step in a slip up to which it does not push, without other acceleration, rad/s; none likewise.
    pub most_velocity_step_rad_s: Option<f64>,
}

impl Passivity {
    /// Passivity of a joint that is stepped by `step_s` and whose torque is held over the step after its own, and
    /// `delay_steps` more.
    ///
    /// # Errors
    /// [`SettingsError::Step`] for a step that is none.
    pub fn of(
        settings: &Validated<Settings>,
        step_s: f64,
        delay_steps: f64,
    ) -> Result<Self, SettingsError> {
        let c = StepCoefficients::<f64>::new(settings, step_s)?;
        let stored_j = 0.5 * c.static_nm * c.static_angle_rad;
        let taken_j = stored_j - 0.5 * c.restart_nm * c.restart_angle_rad;
        // Tk = 0 shows nothing that could push.
        let free_rad = if c.kinetic_nm > 0.0 {
            taken_j / c.kinetic_nm
        } else {
            f64::INFINITY
        };
        let (mut acceleration, mut velocity_step) = (f64::INFINITY, f64::INFINITY);
        for n in 0..SPEEDS {
            let speed_rad_s = f64::from(n) * SPEED_STEP * c.drop_nm / c.impedance;
            let slip_s = c.slip_time(speed_rad_s).value() * step_s;
            let retreat_rad = free_rad + speed_rad_s * slip_s;
            acceleration = acceleration.min(2.0 * retreat_rad / (slip_s * slip_s));
            velocity_step = velocity_step.min(retreat_rad / slip_s);
        }
        let is_known = settings.convention == Convention::Frozen;
        Ok(Self {
            stored_j,
            needed_damping_nms_per_rad: (0.5 + delay_steps) * c.stiffness * step_s,
            most_acceleration_rad_s2: is_known.then_some(acceleration),
            most_velocity_step_rad_s: is_known.then_some(velocity_step),
        })
    }

    /// Returns whether a slip can push a shaft with this acceleration, rad/s², and velocity steps that add up to this in a
    /// slip, rad/s; none where that is not known. Each has its share of the one retreat.
    pub fn may_push(&self, acceleration_rad_s2: f64, velocity_step_rad_s: f64) -> Option<bool> {
        let share = share(acceleration_rad_s2, self.most_acceleration_rad_s2?)
            + share(velocity_step_rad_s, self.most_velocity_step_rad_s?);
        Some(share.is_nan() || share > 1.0)
    }
}

/// Share of a limit, which may be zero.
fn share(of: f64, most: f64) -> f64 {
    if of <= 0.0 { 0.0 } else { of / most }
}
