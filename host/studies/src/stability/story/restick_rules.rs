//! The paper's two rules for the end of a slip, on one movement of a knee: two
//! different products.

use super::trace::{Run, Trace};
use super::{Line, STEP_S};
use crate::story::{PanelData, Scale, Series, Story, mark};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters, SettingsError};
use crepitus_plant::Motion;

/// Amplitude of the knee's sine, degrees.
const AMPLITUDE_DEG: f64 = 45.0;
/// Frequency of the knee's sine, Hz.
const FREQUENCY_HZ: f64 = 0.25;
/// There and back once, s.
const DURATION_S: f64 = 4.0;

fn motion() -> Motion {
    Motion::sine(AMPLITUDE_DEG.to_radians(), FREQUENCY_HZ, -90.0)
}

fn trace(convention: Convention) -> Result<Trace, SettingsError> {
    let run = Run {
        convention,
        solver: Solver::ExactEvents,
        motion: &motion(),
        duration_s: DURATION_S,
        step_s: STEP_S,
    };
    run.trace(true)
}

/// See the module.
pub(super) fn story() -> Result<Story, SettingsError> {
    let static_nm = Parameters::default().static_torque_nm;
    let time = || Scale::linear("Time (s)").within(0.0, DURATION_S);
    let (mut panels, mut counts, mut totals) = (Vec::new(), Vec::new(), Vec::new());
    for convention in [Convention::Frozen, Convention::Physical] {
        let (trace, name) = (trace(convention)?, convention.name());
        let total = trace.breaks_s.len();
        counts.push(Series::line(name, counted(&trace.breaks_s)));
        totals.push(total.to_string());
        panels.push(PanelData {
            heading: format!("Torque under {name}: {total} cycles"),
            x: time(),
            y: Scale::linear("Torque (N·m)").within(-0.44, 0.44),
            series: vec![Series::line(name, trace.torque_nm)],
            levels: vec![mark(static_nm, "Ts"), mark(-static_nm, "−Ts")],
            ..PanelData::default()
        });
    }
    panels.push(PanelData {
        heading: format!("Cycles so far: {} at the end", totals.join(" and ")),
        x: time(),
        y: Scale::linear("Breaks"),
        series: counts,
        ..PanelData::default()
    });
    let shaft = motion();
    let speed = (0..=400)
        .map(|i| DURATION_S * f64::from(i) / 400.0)
        .map(|time_s| (time_s, shaft.at(time_s).omega_rad_s));
    panels.push(PanelData {
        heading: "Speed of the shaft".to_owned(),
        x: time(),
        y: Scale::linear("Ω (rad/s)"),
        series: vec![Series::line("shaft", speed.collect())],
        ..PanelData::default()
    });
    Ok(Story {
        name: "restick-rules",
        title: "One knee pass under the paper's two rules",
        caption: format!(
            "A pass of {AMPLITUDE_DEG}° at {FREQUENCY_HZ} Hz, there and back. Eqs. (10) and (11) of the paper fix the \
             duration of a slip when it begins: under frozen the joint grates {} times. Eq. (8) ends a slip when the \
             object is as fast as the shaft: under physical it grates {} times, because a hand that speeds up leaves \
             the object behind. At a steady speed the two rules agree; both are the paper's.",
            totals[0], totals[1]
        ),
        panels,
    })
}

/// Number of breaks so far: a staircase.
fn counted(breaks_s: &[f64]) -> Line {
    let mut line = vec![(0.0, 0.0)];
    for (count, time_s) in breaks_s.iter().enumerate() {
        line.extend([(*time_s, count as f64), (*time_s, count as f64 + 1.0)]);
    }
    line.push((DURATION_S, breaks_s.len() as f64));
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rules_differ_as_the_reference_does() {
        let rules = [Convention::Frozen, Convention::Physical].map(|c| trace(c).unwrap());
        let breaks: Vec<usize> = rules.iter().map(|rule| rule.breaks_s.len()).collect();
        assert_eq!(breaks, [124, 3]);
        let lowest = rules[0].torque_nm.iter();
        assert!(lowest.map(|p| p.1).fold(0.0, f64::min) >= -0.4);
    }
}
