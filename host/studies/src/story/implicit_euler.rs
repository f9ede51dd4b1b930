//! Reason why implicit Euler, stable at every step, loses the effect.

use super::{PanelData, Scale, Series, Story, mark};
use crate::stability::story::{ImplicitEuler, Line, Method};

const NAMES: [&str; 2] = ["exact-events", "implicit-euler, set-valued"];

pub(super) fn story(data: &ImplicitEuler) -> Story {
    let p = &data.parameters;
    let bound_us = data.bound_s * 1e6;
    let [exact, implicit] = data.methods.as_slice() else {
        return Story::default();
    };
    let lines = |line: fn(&Method) -> Line| {
        let methods = NAMES.into_iter().zip([exact, implicit]);
        methods
            .map(|(name, method)| Series::line(name, line(method)))
            .collect::<Vec<_>>()
    };
    let mut frequency = lines(|method| {
        method
            .frequency_hz
            .iter()
            .map(|(h, f)| (h * 1e6, *f))
            .collect()
    });
    frequency[1].dotted = true;
    Story {
        name: "implicit-euler",
        title: "Stable, and wrong: implicit Euler loses the effect",
        caption: format!(
            "A steady {} rad/s with the paper's parameters under physical. At the device's 50 µs the exact \
             rung breaks {} times in a tenth of a second; implicit Euler, which the haptics literature calls \
             unconditionally stable, breaks {} and then slides for ever at Tk. It damps the swing by ωn·h/2, so the \
             object comes back short of the shaft's speed and never sticks. Stick-slip bears a damping of no more than \
             λ²/4π: here a step of {:.1} µs. The bottom panel finds that bound by trying: above it no cycle is left.",
            data.omega_rad_s,
            exact.breaks,
            if implicit.breaks == 1 {
                "once".to_owned()
            } else {
                format!("{} times", implicit.breaks)
            },
            bound_us,
        ),
        panels: vec![
            PanelData {
                heading: "Torque with a step of 50 µs".to_owned(),
                x: Scale::linear("Time (s)").within(0.0, data.shown_s),
                y: Scale::linear("Torque (N·m)"),
                series: lines(|method| method.torque_nm.clone()),
                levels: vec![
                    mark(p.static_torque_nm, "Ts"),
                    mark(p.kinetic_torque_nm, "Tk"),
                ],
                ..PanelData::default()
            },
            PanelData {
                heading: "Velocity of the object as it meets the shaft".to_owned(),
                x: Scale::linear("Time (s)").within(data.near_s.0, data.near_s.1),
                y: Scale::linear("θ̇ (rad/s)"),
                series: lines(|method| method.theta_dot_rad_s.clone()),
                levels: vec![mark(data.omega_rad_s, "shaft, Ω")],
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
    }
}
