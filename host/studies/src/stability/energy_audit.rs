//! The energy audit of a `physical` joint: work of the shaft against stored and
//! dissipated energy, segment by segment between events.
//!
//! In a stick the work is the integral of kr·θ + J·Ω̇ + c·Ω along the path that
//! the step describes, a closed form; θ and v at its end are the joint's own,
//! so a drift is detected. In a slip the shaft's travel cancels: s·Tk·Δθ
//! remains, against the object's energy.

use crepitus_model::{Event, Parameters, Phase, Real, ShaftStep};

/// Energy audit.
#[derive(Clone, Debug)]
pub(super) struct EnergyAudit {
    parameters: Parameters,
    step_s: f64,
    phase: Phase,
    theta: f64,
    v: f64,
    /// Audited fraction of the step.
    fraction: f64,
    /// Work of the shaft, J.
    work_j: f64,
    /// Missing energy, J.
    missing_j: f64,
    /// Largest |work| + stored so far, J; at least what a stick can store, as
    /// both are tiny at first.
    scale_j: f64,
    /// Worst missing share.
    worst: f64,
}

impl EnergyAudit {
    /// The audit of a joint in stick at θ = 0.
    pub(super) fn new(parameters: Parameters, step_s: f64, omega_rad_s: f64) -> Self {
        Self {
            parameters,
            step_s,
            phase: Phase::Stick,
            theta: 0.0,
            v: omega_rad_s,
            fraction: 0.0,
            work_j: 0.0,
            missing_j: 0.0,
            scale_j: parameters.static_torque_nm * parameters.static_torque_nm
                / (2.0 * parameters.stiffness_nm_per_rad),
            worst: 0.0,
        }
    }

    /// Adds the segment up to an event.
    pub(super) fn event<F: Real>(&mut self, shaft: &ShaftStep<F>, event: &Event<F>) {
        self.segment(
            shaft,
            event.fraction.to_f64(),
            event.theta_rad.to_f64(),
            event.theta_dot_rad_s.to_f64(),
        );
        self.phase = event.to;
    }

    /// Adds the segment up to the end of the step.
    pub(super) fn end_of_step<F: Real>(&mut self, shaft: &ShaftStep<F>, theta: f64, v: f64) {
        self.segment(shaft, 1.0, theta, v);
        self.fraction = 0.0;
        self.scale_j = self.scale_j.max(self.work_j.abs() + self.stored(theta, v));
        let share = if self.missing_j == 0.0 {
            0.0
        } else {
            self.missing_j.abs() / self.scale_j
        };
        // NaN is the worst.
        if share.is_nan() || share > self.worst {
            self.worst = share;
        }
    }

    /// Work of the shaft so far, J.
    pub(super) fn work_j(&self) -> f64 {
        self.work_j
    }

    /// The worst missing share of |work| + stored.
    pub(super) fn worst(&self) -> f64 {
        self.worst
    }

    fn stored(&self, theta: f64, v: f64) -> f64 {
        let p = &self.parameters;
        0.5 * (p.stiffness_nm_per_rad * theta * theta + p.inertia_kg_m2 * v * v)
    }

    fn segment<F: Real>(&mut self, shaft: &ShaftStep<F>, fraction: f64, theta: f64, v: f64) {
        let p = self.parameters;
        let shaft = ShaftStep {
            delta_phi_rad: shaft.delta_phi_rad.to_f64(),
            omega_start_rad_s: shaft.omega_start_rad_s.to_f64(),
            omega_end_rad_s: shaft.omega_end_rad_s.to_f64(),
        };
        let travel = shaft.travel(fraction, self.step_s) - shaft.travel(self.fraction, self.step_s);
        let time_s = (fraction - self.fraction) * self.step_s;
        let omega = |f: f64| {
            shaft.omega_start_rad_s + f * (shaft.omega_end_rad_s - shaft.omega_start_rad_s)
        };
        let gained = self.stored(theta, v) - self.stored(self.theta, self.v);
        match self.phase {
            Phase::Stick => {
                let (w0, w1) = (omega(self.fraction), omega(fraction));
                let viscous = p.damping_nms_per_rad * time_s * (w0 * w0 + w0 * w1 + w1 * w1) / 3.0;
                let reversible = p.stiffness_nm_per_rad * travel * (self.theta + 0.5 * travel)
                    + 0.5 * p.inertia_kg_m2 * (w1 * w1 - w0 * w0);
                self.work_j += reversible + viscous;
                self.missing_j += reversible - gained;
            }
            Phase::Slip(sense) => {
                let torque_nm = sense.of_signed(p.kinetic_torque_nm);
                let acceleration = |theta: f64, v: f64| {
                    (torque_nm - p.damping_nms_per_rad * v - p.stiffness_nm_per_rad * theta)
                        / p.inertia_kg_m2
                };
                // Simpson, the middle by Hermite.
                let middle = 0.5 * (self.v + v)
                    + time_s / 8.0 * (acceleration(self.theta, self.v) - acceleration(theta, v));
                let viscous = p.damping_nms_per_rad * time_s / 6.0
                    * (self.v * self.v + 4.0 * middle * middle + v * v);
                self.work_j += torque_nm * travel;
                self.missing_j += torque_nm * (theta - self.theta) - gained - viscous;
            }
        }
        (self.fraction, self.theta, self.v) = (fraction, theta, v);
    }
}
