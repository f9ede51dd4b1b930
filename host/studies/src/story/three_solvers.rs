//! One joint under three solvers.

use super::{PanelData, Scale, Series, Story, mark};
use crate::stability::story::ThreeSolvers;
use crepitus_pages::plot::number::rounded;

const NAMES: [&str; 3] = [
    "exact events, the device's solver",
    "explicit Euler",
    "implicit Euler",
];

pub(super) fn story(data: &ThreeSolvers) -> Story {
    let p = &data.parameters;
    let [exact, euler, implicit] = data.curves.as_slice() else {
        return Story::default();
    };
    let curves = NAMES.into_iter().zip(&data.curves);
    Story {
        name: "three-solvers",
        title: "One knee, three solvers, the device's step",
        caption: format!(
            "The paper's joint at a steady {} rad/s in steps of {:.0} µs, under physical. Exact events grate, {} breaks in a \
             tenth of a second. Explicit Euler gains energy in every slip: its torque falls to {} N·m and pushes the \
             leg. Implicit Euler, which is always stable, breaks {} and slides on at Tk: the patient is healed.",
            data.omega_rad_s,
            1e6 * data.step_s,
            exact.breaks,
            rounded(euler.least_nm()),
            if implicit.breaks == 1 {
                "once".to_owned()
            } else {
                format!("{} times", implicit.breaks)
            },
        ),
        panels: vec![PanelData {
            heading: "Torque of the joint".to_owned(),
            x: Scale::linear("Time (s)").within(0.0, data.shown_s),
            y: Scale::linear("Torque (N·m)"),
            series: curves
                .map(|(name, curve)| Series::line(name, curve.torque_nm.clone()))
                .collect(),
            levels: vec![
                mark(p.static_torque_nm, "Ts"),
                mark(p.kinetic_torque_nm, "Tk"),
            ],
            ..PanelData::default()
        }],
    }
}
