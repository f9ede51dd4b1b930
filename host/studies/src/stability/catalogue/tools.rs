//! Helpers shared by the files of the catalogue.

use crate::stability::case::{Case, located};
use crate::stability::criterion::Limits;
use crate::stability::input::{
    Fault, Input, Lost, Readings, Rendered, SceneRun, Shaft, Shake, What,
};
use crate::stability::subject::Subject;
use crepitus_model::{Convention, Parameters};

/// The device's tick, s.
pub(super) const TICK_S: f64 = 5e-5;

/// Tolerance of events when Ω is linear within every step, so that a solver
/// that locates them only has rounding errors.
pub(super) const LOCATED: Limits = Limits(1e-12, 2e-5);

/// Tolerance of events on a motion that is not linear within a step.
pub(super) const SAMPLED: Limits = Limits(1e-6, 2e-5);

/// A case of all subjects, without its texts and trials.
pub(super) const CASE: Case = Case {
    id: "",
    name: "",
    title: "",
    hard: "",
    source: "",
    long: false,
    of: |_| true,
    must: located,
    trials: |_| Vec::new(),
};

/// A case of `frozen` alone: of what the device renders.
pub(super) const FROZEN: Case = Case {
    of: is_frozen,
    ..CASE
};

/// A case of an object that moves freely in a slip.
pub(super) const MOVING: Case = Case {
    of: |subject| !is_frozen(subject),
    ..CASE
};

pub(super) fn is_frozen(subject: Subject) -> bool {
    subject.convention == Convention::Frozen
}

/// The plain encoder of the device.
pub(super) const ENCODER: Readings = Readings {
    rate_hz: 2e4,
    lines: 512.0,
    jitter: 0.0,
    lost: 0.0,
    first_count: 0,
};

/// A joint as the device renders it, without losses and commits.
pub(super) const PLAIN: Rendered = Rendered {
    counts: false,
    lost: Lost::NONE,
    commit_every: 0,
    commits: Vec::new(),
};

/// A motion at the device's tick.
pub(super) fn at_tick(shaft: Shaft, duration_s: f64) -> Input {
    Input::sampled(shaft, duration_s, TICK_S)
}

/// A constant speed, rad/s, at the device's tick.
pub(super) fn constant(omega_rad_s: f64, duration_s: f64) -> Input {
    at_tick(Shaft::Constant(omega_rad_s), duration_s)
}

/// A velocity between knots at the device's tick.
pub(super) fn knots(knots: &'static [(f64, f64, f64)], duration_s: f64) -> Input {
    at_tick(Shaft::Knots(knots), duration_s)
}

/// One step at this velocity, repeated.
pub(super) fn repeated(omega_rad_s: f64, duration_s: f64, step_s: f64) -> Input {
    Input::new(What::Repeated(omega_rad_s), duration_s, step_s)
}

/// A motion read by the encoder.
pub(super) fn encoder(shaft: Shaft, duration_s: f64, readings: Readings) -> Input {
    let step_s = 1.0 / readings.rate_hz;
    Input::new(What::Encoder(shaft, readings), duration_s, step_s)
}

/// A motion at the device's tick, with a fault.
pub(super) fn faulty(shaft: Shaft, fault: Fault, duration_s: f64) -> Input {
    Input::new(What::Faulty(shaft, fault), duration_s, TICK_S)
}

/// Commits at the device's tick.
pub(super) fn changed(shaft: Shaft, duration_s: f64, changes: &[(f64, Parameters)]) -> Input {
    let what = What::ParameterChanges(shaft, changes.to_vec());
    Input::new(what, duration_s, TICK_S)
}

/// A joint as the device renders it.
pub(super) fn rendered(shaft: Shaft, duration_s: f64, rendered: Rendered) -> Input {
    Input::new(What::Rendered(shaft, rendered), duration_s, TICK_S)
}

/// A hand that shakes the joint for two seconds.
pub(super) fn shaking(shaft: Shaft, shake: Shake) -> Input {
    Input::new(What::ShakingHand(shaft, shake), 2.0, TICK_S)
}

/// A scene whose torque stands in this column, for the reference, too, if it is compared.
pub(super) fn scene(
    what: &'static str,
    text: &str,
    column: &'static str,
    is_compared: bool,
) -> What {
    What::Scene(SceneRun {
        what,
        text: text.to_owned(),
        column,
        is_compared,
    })
}

/// φ = −A·cos(2π·f·t) with A = 45°: a knee from standstill.
pub(super) fn knee(frequency_hz: f64) -> Shaft {
    Shaft::Sine(std::f64::consts::FRAC_PI_4, frequency_hz, -90.0)
}

/// φ = A·sin(2π·f·t).
pub(super) fn sine(amplitude_rad: f64, frequency_hz: f64) -> Shaft {
    Shaft::Sine(amplitude_rad, frequency_hz, 0.0)
}

/// Cycle frequency at a constant speed, Hz: ωn/(2π + 2(λ − atan λ)), λ =
/// (Ts − Tk)/(|Ω|√(J·kr)).
pub(super) fn cycle_hz(p: &Parameters, omega_rad_s: f64) -> f64 {
    let lambda = (p.static_torque_nm - p.kinetic_torque_nm)
        / (omega_rad_s.abs() * p.impedance_nms_per_rad());
    p.natural_rad_s() / (std::f64::consts::TAU + 2.0 * (lambda - lambda.atan()))
}

/// Duration of a slip at a constant speed, s: 2(π − atan λ)/ωn.
pub(super) fn slip_s(p: &Parameters, omega_rad_s: f64) -> f64 {
    let lag = (p.static_torque_nm - p.kinetic_torque_nm)
        .atan2(omega_rad_s.abs() * p.impedance_nms_per_rad());
    2.0 * (std::f64::consts::PI - lag) / p.natural_rad_s()
}

/// The highest possible cycle frequency, Hz: ωn/2π.
pub(super) fn most_hz(p: &Parameters) -> f64 {
    p.natural_rad_s() / std::f64::consts::TAU
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_have_the_values_of_the_literature() {
        let p = Parameters::default();
        assert!((cycle_hz(&p, 1.0) - 31.828).abs() < 5e-4);
        assert!((cycle_hz(&p, -0.05) - 24.787).abs() < 5e-4);
        assert!((slip_s(&p, 0.1) - 23.562e-3).abs() < 5e-7);
        assert!((most_hz(&p) - 31.831).abs() < 5e-4);
    }
}
