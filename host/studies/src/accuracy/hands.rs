//! Motions of a hand: minimum-jerk strokes, and knee bends that are read as a recording.

use crepitus_plant::Motion;
use crepitus_plant::motion::Strokes;
use crepitus_plant::recording::{Samples, smooth};
/// Motions of a hand: name in the study of costs, description, motion.
pub(super) fn hands() -> Vec<(&'static str, &'static str, Motion)> {
    let strokes = Strokes {
        from_rad: 0.0,
        to_rad: 60_f64.to_radians(),
        peak_speed_rad_s: 60_f64.to_radians(),
        pause_s: 0.1,
    };
    let strokes = (
        "hand-strokes",
        "minimum-jerk strokes of 60° with a peak of 60°/s",
        Motion::Strokes(strokes),
    );
    let knee = knee_bends().map(|motion| {
        let title = "knee bends sampled at 100 Hz, as a recording is read: a C² spline";
        ("knee-bends", title, motion)
    });
    [strokes].into_iter().chain(knee).collect()
}

/// Two knee bends and a half, as a camera sees them.
fn knee_bends() -> Option<Motion> {
    const RATE_HZ: f64 = 100.0;
    const CUTOFF_HZ: f64 = 6.0;
    let time_s: Vec<f64> = (0..=420_u16).map(|n| f64::from(n) / RATE_HZ).collect();
    let angle = |t: &f64| {
        let turn = std::f64::consts::TAU * t / 1.6;
        (35.0 - 30.0 * turn.cos() - 4.0 * (2.0 * turn + 0.4).cos() + (3.0 * turn).sin())
            .to_radians()
    };
    let samples = Samples {
        angle_rad: time_s.iter().map(angle).collect(),
        time_s,
        ..Samples::default()
    };
    smooth(&samples, CUTOFF_HZ)
        .ok()
        .map(|segments| Motion::recording(&segments))
}
