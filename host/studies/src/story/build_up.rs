//! The effects of a scene one after the other.

use super::{PanelData, Scale, Series, Story};
use crate::effects::build_up::RungTorques;

/// None without a rung.
pub(crate) fn story(rungs: &[RungTorques]) -> Option<Story> {
    (!rungs.is_empty()).then(|| Story {
        name: "build-up",
        title: "From the joint to the hand, one effect at a time",
        caption: "The end of each run: the model's torque, and what a force sensor between leg and hand shows, \
                      both without their slow part. Each panel has one effect more than the one above it."
                .to_owned(),
        panels: rungs.iter().map(panel).collect(),
    })
}

fn panel(rung: &RungTorques) -> PanelData {
    let (from, to) = match rung.model_nm.as_slice() {
        [first, .., last] => (first.0, last.0),
        _ => (0.0, 1.0),
    };
    PanelData {
        heading: match rung.added {
            "" => "the joint alone".to_owned(),
            added => format!("and {added}"),
        },
        x: Scale::linear("Time (s)").within(from, to),
        y: Scale::linear("Torque less trend (N·m)").within(-0.32, 0.32),
        series: vec![
            Series::line("torque of the model", rung.model_nm.clone()),
            Series::line("torque at the hand", rung.hand_nm.clone()),
        ],
        ..PanelData::default()
    }
}
