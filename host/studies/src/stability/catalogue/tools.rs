//! Helpers shared by the files of the catalogue.

use crate::stability::case::Trial;
use crate::stability::criterion::{Counted, Criterion, Limits};
use crate::stability::input::{Change, Fault, Input, Lost, Rendered, Shaft};
use crepitus_model::{Convention, Parameters, Settings};

/// The device's tick, s.
pub(super) const TICK_S: f64 = 5e-5;

/// Tolerance of events when Ω is linear within every step, so that a solver
/// that locates them only has rounding errors.
pub(super) const LOCATED: Limits = Limits {
    f64: 1e-12,
    f32: 2e-5,
};

/// Tolerance of events on a motion that is not linear within a step.
pub(super) const SAMPLED: Limits = Limits {
    f64: 1e-6,
    f32: 2e-5,
};

/// J, kr, c, Tk, Ts under a convention.
pub(super) fn joint(convention: Convention, values: [f64; 5]) -> Settings {
    let [
        inertia_kg_m2,
        stiffness_nm_per_rad,
        damping_nms_per_rad,
        kinetic_torque_nm,
        static_torque_nm,
    ] = values;
    Settings {
        parameters: Parameters {
            inertia_kg_m2,
            stiffness_nm_per_rad,
            damping_nms_per_rad,
            kinetic_torque_nm,
            static_torque_nm,
        },
        convention,
        ..Settings::default()
    }
}

/// The paper's parameters under a convention.
pub(super) fn paper_joint(convention: Convention) -> Settings {
    Settings {
        convention,
        ..Settings::default()
    }
}

/// A motion at the device's tick.
pub(super) fn at_tick(shaft: Shaft, duration_s: f64) -> Input {
    Input::Sampled {
        shaft,
        duration_s,
        step_s: TICK_S,
    }
}

/// A motion at the device's tick, with a fault.
pub(super) fn faulty(shaft: Shaft, fault: Fault, duration_s: f64) -> Input {
    Input::Faulty {
        shaft,
        fault,
        duration_s,
        step_s: TICK_S,
    }
}

/// Commits at the device's tick.
pub(super) fn changed(shaft: Shaft, duration_s: f64, changes: &[(f64, Parameters)]) -> Input {
    let change = |&(at_s, parameters): &(f64, Parameters)| Change { at_s, parameters };
    Input::ParameterChanges {
        shaft,
        changes: changes.iter().map(change).collect(),
        duration_s,
        step_s: TICK_S,
    }
}

/// A joint as the device renders it, without losses and commits.
pub(super) fn rendered(shaft: Shaft, duration_s: f64) -> Rendered {
    Rendered {
        shaft,
        counts: false,
        lost: Lost::NONE,
        commit_every: 0,
        commits: Vec::new(),
        duration_s,
        step_s: TICK_S,
    }
}

/// φ = −A·cos(2π·f·t) with A = 45°: a knee from standstill.
pub(super) fn knee(frequency_hz: f64) -> Shaft {
    Shaft::Sine {
        amplitude_rad: std::f64::consts::FRAC_PI_4,
        frequency_hz,
        phase_deg: -90.0,
    }
}

/// φ = A·sin(2π·f·t).
pub(super) fn sine(amplitude_rad: f64, frequency_hz: f64) -> Shaft {
    Shaft::Sine {
        amplitude_rad,
        frequency_hz,
        phase_deg: 0.0,
    }
}

/// A trial.
pub(super) fn trial<const N: usize>(
    settings: Settings,
    input: Input,
    criteria: [Criterion; N],
) -> Trial {
    Trial {
        settings,
        input,
        criteria: Vec::from(criteria),
    }
}

/// Exactly this number of events.
pub(super) fn exactly(what: Counted, count: u64) -> Criterion {
    Criterion::Count {
        what,
        least: count,
        most: count,
    }
}

/// The true events.
pub(super) fn events(within_s: Limits) -> Criterion {
    Criterion::Events { within_s }
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
