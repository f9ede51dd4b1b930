//! One joint under three solvers: the exact one that the device runs, explicit Euler and implicit Euler.

use super::trace::{Run, Trace};
use super::{STEP_S, levels, times};
use crate::story::{PanelData, Scale, Series, Story};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, SettingsError};
use crepitus_pages::plot::number::rounded;
use crepitus_plant::Motion;

/// Speed of the shaft, rad/s.
const OMEGA_RAD_S: f64 = 1.0;
/// Duration of the run, s: three cycles.
const SHOWN_S: f64 = 0.1;

fn trace(solver: Solver) -> Result<Trace, SettingsError> {
    let run = Run {
        convention: Convention::Physical,
        solver,
        motion: &Motion::constant(OMEGA_RAD_S),
        duration_s: SHOWN_S,
        step_s: STEP_S,
    };
    run.trace(true)
}

/// The least torque, N·m: below 2Tk − Ts it pushes the leg along.
fn least_nm(trace: &Trace) -> f64 {
    let torques = trace.torque_nm.iter().map(|(_, nm)| *nm);
    torques.fold(f64::INFINITY, f64::min)
}

/// See the module.
pub(super) fn story() -> Result<Story, SettingsError> {
    let exact = trace(Solver::ExactEvents)?;
    let euler = trace(Solver::Euler)?;
    let implicit = trace(Solver::ImplicitEuler)?;
    Ok(Story {
        name: "three-solvers",
        title: "One knee, three solvers, the device's step",
        caption: format!(
            "The paper's joint at a steady {OMEGA_RAD_S} rad/s in steps of {:.0} µs, under physical. Exact events grate, {} breaks in a \
             tenth of a second. Explicit Euler gains energy in every slip: its torque falls to {} N·m and pushes the \
             leg. Implicit Euler, which is always stable, breaks {} and slides on at Tk: the patient is healed.",
            1e6 * STEP_S,
            exact.breaks_s.len(),
            rounded(least_nm(&euler)),
            times(implicit.breaks_s.len()),
        ),
        panels: vec![PanelData {
            heading: "Torque of the joint".to_owned(),
            x: Scale::linear("Time (s)").within(0.0, SHOWN_S),
            y: Scale::linear("Torque (N·m)"),
            series: vec![
                Series::line("exact events, the device's solver", exact.torque_nm),
                Series::line("explicit Euler", euler.torque_nm),
                Series::line("implicit Euler", implicit.torque_nm),
            ],
            levels: levels(),
            ..PanelData::default()
        }],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_holds_one_gains_energy_and_one_heals() {
        let solvers = [Solver::ExactEvents, Solver::Euler, Solver::ImplicitEuler];
        let traces = solvers.map(|solver| trace(solver).unwrap());
        let breaks: Vec<usize> = traces.iter().map(|trace| trace.breaks_s.len()).collect();
        assert_eq!(breaks, [4, 4, 1]);
        let least: Vec<f64> = traces.iter().map(least_nm).collect();
        // 2Tk − Ts is 0.
        assert!(
            least[0].abs() < 1e-3 && least[1] < -0.3 && least[2].abs() < 1e-3,
            "{least:?}"
        );
    }
}
