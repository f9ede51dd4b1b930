//! Loss of the effect under implicit Euler, which is stable at every step: its numerical
//! damping stops the object short of the shaft's speed.

use super::Line;
use super::trace::{Run, frequency_hz};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters, Settings, SettingsError, Validated};
use crepitus_plant::Motion;

/// Speed of the shaft, rad/s.
const OMEGA_RAD_S: f64 = 1.0;
/// The device's tick, s.
const STEP_S: f64 = 5e-5;
/// Duration of the run in the first panel, s: three cycles.
const SHOWN_S: f64 = 0.1;
/// Interval around the moment when the object should stick again, s.
const NEAR_S: (f64, f64) = (0.029, 0.035);
/// Duration over which a run is counted, s.
const COUNTED_S: f64 = 1.0;

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct ImplicitEuler {
    /// Parameters of the joint.
    pub parameters: Parameters,
    /// Speed of the shaft, rad/s.
    pub omega_rad_s: f64,
    /// Duration over which torques are shown, s.
    pub shown_s: f64,
    /// Interval around the moment when the object should stick again, s.
    pub near_s: (f64, f64),
    /// The longest step with which implicit Euler still sticks, s.
    pub bound_s: f64,
    /// The exact rung, then implicit Euler.
    pub methods: Vec<Method>,
}

/// One of the two.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// Solver of the method.
    pub solver: Solver,
    /// Torque, N·m, against time, s.
    pub torque_nm: Line,
    /// Velocity of the object, rad/s, near that moment, against time, s.
    pub theta_dot_rad_s: Line,
    /// Number of times that the object broke loose.
    pub breaks: usize,
    /// Frequency of the cycle, Hz, against the step, s.
    pub frequency_hz: Line,
}

/// See the module.
pub(super) fn implicit_euler() -> Result<ImplicitEuler, SettingsError> {
    let settings = Settings {
        convention: Convention::Physical,
        ..Settings::default()
    }
    .validate()?;
    let motion = Motion::constant(OMEGA_RAD_S);
    let bound_s = longest_step_s(&settings);
    let steps_s = steps_s(bound_s);
    let method = |solver| {
        let run = Run {
            settings: &settings,
            solver,
            motion: &motion,
            duration_s: SHOWN_S,
            step_s: STEP_S,
        };
        let trace = run.trace()?;
        let near = trace.theta_dot_rad_s.into_iter();
        let counted = |step_s: &f64| {
            let run = Run {
                duration_s: COUNTED_S,
                step_s: *step_s,
                ..run
            };
            Ok((*step_s, frequency_hz(&run.breaks_s()?)))
        };
        Ok(Method {
            solver,
            torque_nm: trace.torque_nm,
            theta_dot_rad_s: near
                .filter(|(t, _)| (NEAR_S.0..=NEAR_S.1).contains(t))
                .collect(),
            breaks: trace.breaks_s.len(),
            frequency_hz: steps_s
                .iter()
                .map(counted)
                .collect::<Result<_, SettingsError>>()?,
        })
    };
    Ok(ImplicitEuler {
        parameters: settings.parameters,
        omega_rad_s: OMEGA_RAD_S,
        shown_s: SHOWN_S,
        near_s: NEAR_S,
        bound_s,
        methods: [Solver::ExactEvents, Solver::ImplicitEuler]
            .into_iter()
            .map(method)
            .collect::<Result<_, SettingsError>>()?,
    })
}

/// The step at which the numerical damping ωn·h/2 reaches λ²/4π, beyond which
/// the object no longer catches up with the shaft.
fn longest_step_s(settings: &Validated<Settings>) -> f64 {
    let p = &settings.parameters;
    let drop_nm = p.static_torque_nm - p.kinetic_torque_nm;
    let lambda = drop_nm / (OMEGA_RAD_S * p.impedance_nms_per_rad());
    lambda * lambda / (2.0 * std::f64::consts::PI * p.natural_rad_s())
}

/// Eight steps a decade, and some close to the bound on both sides, s.
fn steps_s(bound_s: f64) -> Vec<f64> {
    let mut steps_s: Vec<f64> = (0..=24)
        .map(|i| 1e-6 * 10_f64.powf(f64::from(i) / 8.0))
        .filter(|h| (h / bound_s).ln().abs() > 0.2)
        .collect();
    steps_s.extend([0.8, 0.92, 0.98, 1.02, 1.08, 1.2].map(|share| share * bound_s));
    steps_s.sort_by(f64::total_cmp);
    steps_s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_lies_where_the_damping_is_critical() {
        let story = implicit_euler().unwrap();
        assert!((story.bound_s - 7.96e-6).abs() < 1e-8);
        let [exact, implicit] = story.methods.as_slice() else {
            panic!("two methods");
        };
        let lines = exact.frequency_hz.iter().zip(&implicit.frequency_hz);
        for ((step_s, f_exact), (_, f_implicit)) in lines {
            assert!((f_exact - 31.82).abs() < 0.02, "{step_s} s: {f_exact} Hz");
            if *step_s < 0.9 * story.bound_s {
                assert!(
                    (f_implicit - 31.8).abs() < 0.2,
                    "{step_s} s: {f_implicit} Hz"
                );
            } else if *step_s > 1.1 * story.bound_s {
                assert_eq!(*f_implicit, 0.0, "{step_s} s");
            }
        }
        // The last torque of implicit Euler is Tk, and it got there early.
        let line = &implicit.torque_nm;
        assert!(line.len() < 40 && line.last().unwrap().1 == 0.2);
        assert_eq!(implicit.breaks, 1);
    }
}
