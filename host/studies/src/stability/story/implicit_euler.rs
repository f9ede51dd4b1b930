//! Loss of the effect under implicit Euler, which is stable at every step: its numerical
//! damping stops the object short of the shaft's speed.

use super::trace::{Run, Trace, frequency_hz};
use super::{Line, STEP_S, levels, times};
use crate::story::{PanelData, Scale, Series, Story, mark};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters, SettingsError};
use crepitus_plant::Motion;

/// Speed of the shaft, rad/s.
const OMEGA_RAD_S: f64 = 1.0;
/// Duration of the run in the first panel, s: three cycles.
const SHOWN_S: f64 = 0.1;
/// Interval around the moment when the object should stick again, s.
const NEAR_S: (f64, f64) = (0.029, 0.035);
/// Duration over which a run is counted, s.
const COUNTED_S: f64 = 1.0;

/// One of the two.
struct Method {
    trace: Trace,
    /// Frequency of the cycle, Hz, against the step, s.
    frequency_hz: Line,
}

fn method(solver: Solver) -> Result<Method, SettingsError> {
    let run = Run {
        convention: Convention::Physical,
        solver,
        motion: &Motion::constant(OMEGA_RAD_S),
        duration_s: SHOWN_S,
        step_s: STEP_S,
    };
    let mut frequencies = Line::new();
    for step_s in steps_s() {
        let counted = Run {
            duration_s: COUNTED_S,
            step_s,
            ..run
        };
        frequencies.push((step_s, frequency_hz(&counted.trace(false)?.breaks_s)));
    }
    Ok(Method {
        trace: run.trace(true)?,
        frequency_hz: frequencies,
    })
}

/// The step at which the numerical damping ωn·h/2 reaches λ²/4π, beyond which
/// the object no longer catches up with the shaft.
fn longest_step_s() -> f64 {
    let p = Parameters::default();
    let drop_nm = p.static_torque_nm - p.kinetic_torque_nm;
    let lambda = drop_nm / (OMEGA_RAD_S * p.impedance_nms_per_rad());
    lambda * lambda / (2.0 * std::f64::consts::PI * p.natural_rad_s())
}

/// Eight steps a decade, and some close to the bound on both sides, s.
fn steps_s() -> Vec<f64> {
    let bound_s = longest_step_s();
    let mut steps_s: Vec<f64> = (0..=24)
        .map(|i| 1e-6 * 10_f64.powf(f64::from(i) / 8.0))
        .filter(|h| (h / bound_s).ln().abs() > 0.2)
        .collect();
    steps_s.extend([0.8, 0.92, 0.98, 1.02, 1.08, 1.2].map(|share| share * bound_s));
    steps_s.sort_by(f64::total_cmp);
    steps_s
}

/// See the module.
pub(super) fn story() -> Result<Story, SettingsError> {
    let exact = method(Solver::ExactEvents)?;
    let implicit = method(Solver::ImplicitEuler)?;
    let bound_us = longest_step_s() * 1e6;
    let lines = |line: fn(&Method) -> Line| {
        vec![
            Series::line("exact-events", line(&exact)),
            Series::line("implicit-euler, set-valued", line(&implicit)),
        ]
    };
    let mut frequency = lines(|method| {
        let frequencies = method.frequency_hz.iter();
        frequencies.map(|(h, f)| (h * 1e6, *f)).collect()
    });
    frequency[1].dotted = true;
    Ok(Story {
        name: "implicit-euler",
        title: "Stable, and wrong: implicit Euler loses the effect",
        caption: format!(
            "A steady {OMEGA_RAD_S} rad/s with the paper's parameters under physical. At the device's 50 µs the exact \
             rung breaks {} times in a tenth of a second; implicit Euler, which the haptics literature calls \
             unconditionally stable, breaks {} and then slides for ever at Tk. It damps the swing by ωn·h/2, so the \
             object comes back short of the shaft's speed and never sticks. Stick-slip bears a damping of no more than \
             λ²/4π: here a step of {bound_us:.1} µs. The bottom panel finds that bound by trying: above it no cycle is left.",
            exact.trace.breaks_s.len(),
            times(implicit.trace.breaks_s.len()),
        ),
        panels: vec![
            PanelData {
                heading: "Torque with a step of 50 µs".to_owned(),
                x: Scale::linear("Time (s)").within(0.0, SHOWN_S),
                y: Scale::linear("Torque (N·m)"),
                series: lines(|method| method.trace.torque_nm.clone()),
                levels: levels(),
                ..PanelData::default()
            },
            PanelData {
                heading: "Velocity of the object as it meets the shaft".to_owned(),
                x: Scale::linear("Time (s)").within(NEAR_S.0, NEAR_S.1),
                y: Scale::linear("θ̇ (rad/s)"),
                series: lines(|method| {
                    let mut near = method.trace.theta_dot_rad_s.clone();
                    near.retain(|(t, _)| (NEAR_S.0..=NEAR_S.1).contains(t));
                    near
                }),
                levels: vec![mark(OMEGA_RAD_S, "shaft, Ω")],
                ..PanelData::default()
            },
            PanelData {
                heading: "Cycle frequency found, against the step".to_owned(),
                x: Scale::logarithmic("Step (µs)").within(0.9, 1100.0),
                y: Scale::linear("Frequency (Hz)").within(-1.5, 38.0),
                series: frequency,
                bounds: vec![mark(
                    bound_us,
                    &format!("ωn·h/2 = λ²/4π at {bound_us:.1} µs"),
                )],
                ..PanelData::default()
            },
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_lies_where_the_damping_is_critical() {
        let bound_s = longest_step_s();
        assert!((bound_s - 7.96e-6).abs() < 1e-8);
        let exact = method(Solver::ExactEvents).unwrap();
        let implicit = method(Solver::ImplicitEuler).unwrap();
        let lines = exact.frequency_hz.iter().zip(&implicit.frequency_hz);
        for ((step_s, f_exact), (_, f_implicit)) in lines {
            assert!((f_exact - 31.82).abs() < 0.02, "{step_s} s: {f_exact} Hz");
            if *step_s < 0.9 * bound_s {
                assert!(
                    (f_implicit - 31.8).abs() < 0.2,
                    "{step_s} s: {f_implicit} Hz"
                );
            } else if *step_s > 1.1 * bound_s {
                assert_eq!(*f_implicit, 0.0, "{step_s} s");
            }
        }
        // The last torque of implicit Euler is Tk, and it got there early.
        let line = &implicit.trace.torque_nm;
        assert!(line.len() < 40 && line.last().unwrap().1 == 0.2);
        assert_eq!(implicit.trace.breaks_s.len(), 1);
    }
}
