//! The paper's two rules for the end of a slip, on one movement of a knee: two
//! different products.

use super::trace::{Run, Trace};
use super::{Mark, Panel, Scale, Series, Story};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Real, Settings, SettingsError};
use crepitus_plant::Motion;

/// Amplitude of the knee's sine, degrees.
const AMPLITUDE_DEG: f64 = 45.0;
/// Its frequency, Hz.
const FREQUENCY_HZ: f64 = 0.25;
/// There and back once, s.
const DURATION_S: f64 = 4.0;
/// The device's tick, s.
const STEP_S: f64 = 5e-5;

/// See the module.
pub(super) fn restick_rules() -> Result<Story, SettingsError> {
    let motion = Motion::sine(AMPLITUDE_DEG.to_radians(), FREQUENCY_HZ, -90.0);
    let time = || Scale::linear("Time (s)").within(0.0, DURATION_S);
    let mut torques = Vec::new();
    let mut counts = Vec::new();
    let mut totals = Vec::new();
    for convention in [Convention::Frozen, Convention::Physical] {
        let settings = Settings {
            convention,
            ..Settings::default()
        }
        .validate()?;
        let trace = Run {
            settings: &settings,
            solver: Solver::ExactEvents,
            motion: &motion,
            duration_s: DURATION_S,
            step_s: STEP_S,
        }
        .trace()?;
        let total = trace.breaks_s.len();
        let p = &settings.parameters;
        counts.push(Series::line(convention.name(), counted(&trace)));
        torques.push(Panel {
            heading: format!("Torque under {}: {total} cycles", convention.name()),
            x: time(),
            y: Scale::linear("Torque (N·m)").within(-0.44, 0.44),
            series: vec![Series::line(convention.name(), trace.torque_nm)],
            levels: vec![
                Mark::new(p.static_torque_nm, "Ts"),
                Mark::new(-p.static_torque_nm, "−Ts"),
            ],
            bounds: Vec::new(),
        });
        totals.push(total);
    }
    let mut panels = torques;
    panels.push(Panel {
        heading: format!("Cycles so far: {} and {} at the end", totals[0], totals[1]),
        x: time(),
        y: Scale::linear("Breaks"),
        series: counts,
        ..Panel::default()
    });
    panels.push(Panel {
        heading: "Speed of the shaft".to_owned(),
        x: time(),
        y: Scale::linear("Ω (rad/s)"),
        series: vec![Series::line("shaft", speed(&motion))],
        ..Panel::default()
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

/// How many breaks there were so far: a staircase.
fn counted(trace: &Trace) -> Vec<(f64, f64)> {
    let mut line = vec![(0.0, 0.0)];
    let mut count = 0_u64;
    for time_s in &trace.breaks_s {
        line.push((*time_s, f64::from_whole(count)));
        count += 1;
        line.push((*time_s, f64::from_whole(count)));
    }
    line.push((DURATION_S, f64::from_whole(count)));
    line
}

/// Ω against time.
fn speed(motion: &Motion) -> Vec<(f64, f64)> {
    (0..=400)
        .map(|i| DURATION_S * f64::from(i) / 400.0)
        .map(|time_s| (time_s, motion.at(time_s).omega_rad_s))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rules_differ_as_the_reference_does() {
        let story = restick_rules().unwrap();
        let last = |series: &Series| series.points.last().unwrap().1;
        let counts = &story.panels[2].series;
        assert_eq!((last(&counts[0]), last(&counts[1])), (124.0, 3.0));
        assert!(story.panels[0].heading.contains("124 cycles"));
        let lowest = story.panels[0].series[0].points.iter();
        assert!(lowest.map(|p| p.1).fold(0.0, f64::min) >= -0.4);
    }
}
