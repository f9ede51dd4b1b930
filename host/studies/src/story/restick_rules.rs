//! The paper's two rules for the end of a slip, on one movement of a knee.

use super::{PanelData, Scale, Series, Story, mark};
use crate::stability::story::{Line, RestickRules};

pub(super) fn story(data: &RestickRules) -> Story {
    let time = || Scale::linear("Time (s)").within(0.0, data.duration_s);
    let [frozen, physical] = data.rules.as_slice() else {
        return Story::default();
    };
    let totals = [frozen, physical].map(|rule| rule.breaks_s.len());
    let mut panels: Vec<PanelData> = [frozen, physical]
        .into_iter()
        .map(|rule| PanelData {
            heading: format!(
                "Torque under {}: {} cycles",
                rule.convention.name(),
                rule.breaks_s.len()
            ),
            x: time(),
            y: Scale::linear("Torque (N·m)").within(-0.44, 0.44),
            series: vec![Series::line(rule.convention.name(), rule.torque_nm.clone())],
            levels: vec![
                mark(data.static_torque_nm, "Ts"),
                mark(-data.static_torque_nm, "−Ts"),
            ],
            ..PanelData::default()
        })
        .collect();
    let counts = [frozen, physical].map(|rule| {
        Series::line(
            rule.convention.name(),
            counted(&rule.breaks_s, data.duration_s),
        )
    });
    panels.push(PanelData {
        heading: format!("Cycles so far: {} and {} at the end", totals[0], totals[1]),
        x: time(),
        y: Scale::linear("Breaks"),
        series: counts.into(),
        ..PanelData::default()
    });
    panels.push(PanelData {
        heading: "Speed of the shaft".to_owned(),
        x: time(),
        y: Scale::linear("Ω (rad/s)"),
        series: vec![Series::line("shaft", data.omega_rad_s.clone())],
        ..PanelData::default()
    });
    Story {
        name: "restick-rules",
        title: "One knee pass under the paper's two rules",
        caption: format!(
            "A pass of {}° at {} Hz, there and back. Eqs. (10) and (11) of the paper fix the \
             duration of a slip when it begins: under frozen the joint grates {} times. Eq. (8) ends a slip when the \
             object is as fast as the shaft: under physical it grates {} times, because a hand that speeds up leaves \
             the object behind. At a steady speed the two rules agree; both are the paper's.",
            data.amplitude_deg, data.frequency_hz, totals[0], totals[1]
        ),
        panels,
    }
}

/// Number of breaks so far: a staircase.
fn counted(breaks_s: &[f64], duration_s: f64) -> Line {
    let mut line = vec![(0.0, 0.0)];
    for (count, time_s) in breaks_s.iter().enumerate() {
        line.extend([(*time_s, count as f64), (*time_s, count as f64 + 1.0)]);
    }
    line.push((duration_s, breaks_s.len() as f64));
    line
}
