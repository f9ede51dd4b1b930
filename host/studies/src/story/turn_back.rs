//! Work that a hand gets back that turns round inside a slip, with the turn-back
//! guard and without it, and how close the worst comes to the bound.

use super::{PanelData, Scale, Series, Story, mark};
use crate::stability::story::TurnBack;

const UNGUARDED: &str = "without the guard";
/// Names of the lines with the guard, by the delay of the torque.
const GUARDED: [&str; 3] = [
    "with the guard",
    "with the guard, torque 1 tick late",
    "with the guard, torque 2 ticks late",
];

pub(super) fn story(data: &TurnBack) -> Story {
    let TurnBack {
        shaking, swept_hz, ..
    } = data;
    let (shown_s, swept_s) = data.lengths_s;
    let end_mj = |line: &[(f64, f64)]| line.last().map_or(0.0, |(_, j)| j * 1e3);
    let worst = |line: &[(f64, f64)]| line.iter().map(|p| p.1).fold(0.0, f64::max);
    let milli = |line: &[(f64, f64)]| line.iter().map(|(t, j)| (*t, j * 1e3)).collect();
    let time = || Scale::linear("Time (s)").within(0.0, shown_s);
    let mut swept = vec![Series::line(UNGUARDED, data.unguarded.clone())];
    let guarded = GUARDED.iter().zip(&data.guarded);
    swept.extend(guarded.map(|(name, swept)| Series::line(name, swept.returned.clone())));
    Story {
        name: "turn-back-guard",
        title: "A hand that turns back gets no more than the spring held",
        caption: format!(
            "A hand that shakes by ±5 mrad at 20 Hz turns back inside every slip. A frozen slip shows Tk until its time is \
             over: without the guard it pushes the hand along, so that the work put in after {shown_s} s is {:.2} mJ, with the \
             guard {:.2} mJ. Below, for amplitudes from 0.3 to 3 strokes of a stick at {swept_hz} Hz, the most that is returned over \
             any stretch of {swept_s} s, as a share of the {:.1} mJ that the spring holds, what sampling gives away being \
             granted: the worst with the guard is {:.3}, without it {:.0}.",
            end_mj(&shaking.unguarded_j),
            end_mj(&shaking.guarded_j),
            data.stored_j * 1e3,
            data.guarded
                .iter()
                .map(|swept| worst(&swept.returned))
                .fold(0.0, f64::max),
            worst(&data.unguarded),
        ),
        panels: vec![
            PanelData {
                heading: "Torque".to_owned(),
                x: time(),
                y: Scale::linear("Torque (N·m)"),
                series: vec![
                    Series::line(UNGUARDED, shaking.unguarded_nm.clone()),
                    Series::line(GUARDED[0], shaking.guarded_nm.clone()),
                ],
                ..PanelData::default()
            },
            PanelData {
                heading: "Work that the hand has put in".to_owned(),
                x: time(),
                y: Scale::linear("Work (mJ)"),
                series: vec![
                    Series::line(UNGUARDED, milli(&shaking.unguarded_j)),
                    Series::line(GUARDED[0], milli(&shaking.guarded_j)),
                ],
                ..PanelData::default()
            },
            PanelData {
                heading: "Most energy returned, against the amplitude".to_owned(),
                x: Scale::logarithmic("Amplitude (strokes of a stick, Ts/kr)").within(0.3, 3.0),
                y: Scale::logarithmic("Share of Ts²/2kr").within(0.05, 100.0),
                series: swept,
                levels: vec![mark(1.0, "bound")],
                ..PanelData::default()
            },
        ],
    }
}
