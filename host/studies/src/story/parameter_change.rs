//! Effect of a change of stiffness on a wound spring.

use super::{PanelData, Scale, Series, Story, mark};
use crate::stability::story::ParameterChange;

const COMMITTED: &str = "committed and ramped";
const NAIVE: &str = "replaced as they are";
/// The smallest energy that is drawn, J.
const LEAST_J: f64 = 3e-4;

pub(super) fn story(data: &ParameterChange) -> Story {
    let ParameterChange {
        committed, naive, ..
    } = data;
    let at_change = |lines: &[(f64, f64)], after_s: f64| {
        let next = lines.iter().find(|(t, _)| *t > after_s);
        next.map_or(0.0, |(_, y)| *y)
    };
    let (stiffer_s, softer_s) = data.changes_s;
    // Just before and just after, whatever rounding makes of the time.
    let (before_s, after_s) = (stiffer_s - 1.5 * data.step_s, stiffer_s + 0.5 * data.step_s);
    let before_j = at_change(&committed.stored_j, before_s);
    let time = || Scale::linear("Time (s)").within(0.0, data.shown_s);
    // Named in the first panel, where there is room.
    let marks = |names: [&str; 2]| vec![mark(stiffer_s, names[0]), mark(softer_s, names[1])];
    Story {
        name: "parameter-change",
        title: "A stiffer spring, and no energy from nowhere",
        caption: format!(
            "A hand has wound a spring of 10 N·m/rad to {:.2} N·m when its stiffness is set to 400 N·m/rad. Replaced as \
             it is, spring and object hold {:.2} J instead of {:.1} mJ, show {:.1} N·m for a moment, and go on swinging. \
             Committed as the device does it, θ is scaled so that the torque goes on and the energy falls to {:.1} mJ. \
             Back to the soft spring the torque may only fall at {} N·m/s, so the stiffness takes its time.",
            at_change(&committed.torque_nm, before_s),
            at_change(&naive.stored_j, after_s),
            before_j * 1e3,
            at_change(&naive.torque_nm, after_s),
            at_change(&committed.stored_j, after_s) * 1e3,
            data.slew_nm_per_s,
        ),
        panels: vec![
            PanelData {
                heading: "Torque asked for, without a limit".to_owned(),
                x: time(),
                y: Scale::linear("Torque (N·m)").within(-1.0, 17.0),
                series: vec![
                    Series::line(NAIVE, naive.torque_nm.clone()),
                    Series::line(COMMITTED, committed.torque_nm.clone()),
                ],
                bounds: marks(["kr 10 → 400", "kr 400 → 10"]),
                ..PanelData::default()
            },
            PanelData {
                heading: "The same, near Ts and Tk".to_owned(),
                x: time(),
                y: Scale::linear("Torque (N·m)").within(-0.05, 0.45),
                series: vec![Series::line(COMMITTED, committed.torque_nm.clone())],
                levels: vec![mark(data.levels_nm.0, "Ts"), mark(data.levels_nm.1, "Tk")],
                bounds: marks(["", ""]),
            },
            PanelData {
                heading: "Energy of spring and object".to_owned(),
                x: time(),
                y: Scale::logarithmic("Energy (J)").within(LEAST_J, 1.0),
                series: vec![
                    Series::line(NAIVE, naive.stored_j.clone()),
                    Series::line(COMMITTED, committed.stored_j.clone()),
                ],
                bounds: marks(["", ""]),
                ..PanelData::default()
            },
        ],
    }
}
