//! Why implicit Euler, stable at every step, loses the effect: its numerical
//! damping stops the object short of the shaft's speed.

use super::trace::{Run, frequency_hz};
use super::{Mark, Panel, Scale, Series, Story};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Settings, SettingsError, Validated};
use crepitus_plant::Motion;

/// Speed of the shaft, rad/s.
const OMEGA_RAD_S: f64 = 1.0;
/// The device's tick, s.
const STEP_S: f64 = 5e-5;
/// How much of the run the first panel shows, s: three cycles.
const SHOWN_S: f64 = 0.1;
/// Around the moment when the object should stick again, s.
const NEAR_S: (f64, f64) = (0.029, 0.035);
/// How long a run is counted, s.
const COUNTED_S: f64 = 1.0;

/// The two methods and their names in the legend.
const METHODS: [(Solver, &str); 2] = [
    (Solver::ExactEvents, "exact-events"),
    (Solver::ImplicitEuler, "implicit-euler, set-valued"),
];

/// See the module.
pub(super) fn implicit_euler() -> Result<Story, SettingsError> {
    let settings = Settings {
        convention: Convention::Physical,
        ..Settings::default()
    }
    .validate()?;
    let motion = Motion::constant(OMEGA_RAD_S);
    let run = |solver| Run {
        settings: &settings,
        solver,
        motion: &motion,
        duration_s: SHOWN_S,
        step_s: STEP_S,
    };
    let mut torque = Vec::new();
    let mut velocity = Vec::new();
    let mut breaks = Vec::new();
    for (solver, name) in METHODS {
        let trace = run(solver).trace()?;
        torque.push(Series::line(name, trace.torque_nm));
        let near = trace.theta_dot_rad_s.into_iter();
        let near = near.filter(|(t, _)| (NEAR_S.0..=NEAR_S.1).contains(t));
        velocity.push(Series::line(name, near.collect()));
        breaks.push(trace.breaks_s.len());
    }
    let bound_s = longest_step_s(&settings);
    let frequency = frequencies(&settings, &motion, bound_s)?;
    let p = &settings.parameters;
    Ok(Story {
        name: "implicit-euler",
        title: "Stable, and wrong: implicit Euler loses the effect",
        caption: format!(
            "A steady {OMEGA_RAD_S} rad/s with the paper's parameters under physical. At the device's 50 µs the exact \
             rung breaks {} times in a tenth of a second; implicit Euler, which the haptics literature calls \
             unconditionally stable, breaks {} and then slides for ever at Tk. It damps the swing by ωn·h/2, so the \
             object comes back short of the shaft's speed and never sticks. Stick-slip bears a damping of no more than \
             λ²/4π: here a step of {:.1} µs. The bottom panel finds that bound by trying: above it no cycle is left.",
            breaks[0],
            if breaks[1] == 1 {
                "once".to_owned()
            } else {
                format!("{} times", breaks[1])
            },
            bound_s * 1e6,
        ),
        panels: vec![
            Panel {
                heading: "Torque with a step of 50 µs".to_owned(),
                x: Scale::linear("Time (s)").within(0.0, SHOWN_S),
                y: Scale::linear("Torque (N·m)"),
                series: torque,
                levels: vec![
                    Mark::new(p.static_torque_nm, "Ts"),
                    Mark::new(p.kinetic_torque_nm, "Tk"),
                ],
                bounds: Vec::new(),
            },
            Panel {
                heading: "Velocity of the object where it should meet the shaft".to_owned(),
                x: Scale::linear("Time (s)").within(NEAR_S.0, NEAR_S.1),
                y: Scale::linear("θ̇ (rad/s)"),
                series: velocity,
                levels: vec![Mark::new(OMEGA_RAD_S, "shaft, Ω")],
                bounds: Vec::new(),
            },
            Panel {
                heading: "Cycle frequency found, against the step".to_owned(),
                x: Scale {
                    logarithmic: true,
                    ..Scale::linear("Step (µs)").within(0.9, 1100.0)
                },
                y: Scale::linear("Frequency (Hz)").within(-1.5, 38.0),
                series: frequency,
                levels: Vec::new(),
                bounds: vec![Mark::new(
                    bound_s * 1e6,
                    format!("ωn·h/2 = λ²/4π at {:.1} µs", bound_s * 1e6),
                )],
            },
        ],
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

/// Frequency of the cycle, Hz, against the step, µs.
fn frequencies(
    settings: &Validated<Settings>,
    motion: &Motion,
    bound_s: f64,
) -> Result<Vec<Series>, SettingsError> {
    // Eight steps a decade, and some close to the bound on both sides.
    let mut steps_s: Vec<f64> = (0..=24)
        .map(|i| 1e-6 * 10_f64.powf(f64::from(i) / 8.0))
        .filter(|h| (h / bound_s).ln().abs() > 0.2)
        .collect();
    steps_s.extend([0.8, 0.92, 0.98, 1.02, 1.08, 1.2].map(|share| share * bound_s));
    steps_s.sort_by(f64::total_cmp);
    METHODS
        .into_iter()
        .map(|(solver, name)| {
            let points = steps_s.iter().map(|step_s| {
                let run = Run {
                    settings,
                    solver,
                    motion,
                    duration_s: COUNTED_S,
                    step_s: *step_s,
                };
                Ok((step_s * 1e6, frequency_hz(&run.breaks_s()?)))
            });
            Ok(Series {
                name,
                dotted: solver == Solver::ImplicitEuler,
                points: points.collect::<Result<_, SettingsError>>()?,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_lies_where_the_damping_is_critical() {
        let story = implicit_euler().unwrap();
        let [torque, _, frequency] = story.panels.as_slice() else {
            panic!("three panels");
        };
        assert!((frequency.bounds[0].at - 7.96).abs() < 0.01);
        let (exact, implicit) = (&frequency.series[0], &frequency.series[1]);
        for ((step_us, f_exact), (_, f_implicit)) in exact.points.iter().zip(&implicit.points) {
            assert!((f_exact - 31.82).abs() < 0.02, "{step_us} µs: {f_exact} Hz");
            if *step_us < 0.9 * frequency.bounds[0].at {
                assert!(
                    (f_implicit - 31.8).abs() < 0.2,
                    "{step_us} µs: {f_implicit} Hz"
                );
            } else if *step_us > 1.1 * frequency.bounds[0].at {
                assert_eq!(*f_implicit, 0.0, "{step_us} µs");
            }
        }
        // The last torque of implicit Euler is Tk, and it got there early.
        let line = &torque.series[1].points;
        assert!(line.len() < 40 && line.last().unwrap().1 == 0.2);
        assert!(story.caption.contains("breaks once"), "{}", story.caption);
    }
}
