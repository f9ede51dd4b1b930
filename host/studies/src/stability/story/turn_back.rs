//! Energy that a hand gets back when it turns round inside a slip, with the turn-back
//! guard and without it, and how close the worst comes to the bound.

use super::{Line, STEP_S};
use crate::sampling::Sampling;
use crate::stability::device_run::{DeviceRun, Returned, Tick};
use crate::stability::input::Lost;
use crate::stability::subject::{Rung, Subject};
use crate::story::{PanelData, Scale, Series, Story, mark};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters, Settings, SettingsError};
use crepitus_plant::Motion;
use crepitus_scene::scene::Precision;

/// Duration of the shaking for a point of the sweep, s, and for the lines.
const SWEPT_S: f64 = 2.0;
const SHOWN_S: f64 = 0.2;
/// Frequency of the sweep, Hz.
const SWEPT_HZ: f64 = 50.0;

/// Subject that the device renders.
const DEVICE: Subject = Subject {
    solver: Rung::Ladder(Solver::ExactEvents),
    convention: Convention::Frozen,
    precision: Precision::F32,
};

const UNGUARDED: &str = "without the guard";
/// Names of the lines with the guard, by the delay of the torque in ticks.
const GUARDED: [&str; 3] = [
    "with the guard",
    "with the guard, torque 1 tick late",
    "with the guard, torque 2 ticks late",
];

/// Shakes the joint by an amplitude, rad, at a frequency, Hz, for a duration, s.
fn shake(
    (amplitude_rad, frequency_hz): (f64, f64),
    duration_s: f64,
    delay_ticks: usize,
    on_tick: &mut dyn FnMut(&Tick<'_>, [f64; 2]),
) -> Result<Returned, SettingsError> {
    let motion = Motion::sine(amplitude_rad, frequency_hz, 0.0);
    let run = DeviceRun {
        settings: Settings::default().validate()?,
        sampling: Sampling::new(&motion, duration_s, STEP_S),
        counts: false,
        lost: Lost::NONE,
        commits: (0, &[]),
    };
    run.shake::<f32>(DEVICE, delay_ticks, on_tick)
}

/// The most that is returned by hands of many amplitudes, in strokes of a stick, as a share of what the spring holds: with
/// the guard, and without it.
fn swept(delay_ticks: usize) -> Result<[Line; 2], SettingsError> {
    let p = Parameters::default();
    let stroke_rad = p.static_torque_nm / p.stiffness_nm_per_rad;
    let [mut guarded, mut unguarded] = [Line::new(), Line::new()];
    for i in 0..=40 {
        let share = 0.3 * 10_f64.powf(f64::from(i) / 40.0);
        let hand = (share * stroke_rad, SWEPT_HZ);
        let returned = shake(hand, SWEPT_S, delay_ticks, &mut |_, _| {})?;
        guarded.push((share, returned.guarded));
        unguarded.push((share, returned.unguarded));
    }
    Ok([guarded, unguarded])
}

/// See the module.
pub(super) fn story() -> Result<Story, SettingsError> {
    let p = Parameters::default();
    let stored_j = p.static_torque_nm.powi(2) / (2.0 * p.stiffness_nm_per_rad);
    // Torque, N·m, and work put in, mJ: with the guard, and without it.
    let [mut guarded_nm, mut unguarded_nm] = [Line::new(), Line::new()];
    let [mut guarded_mj, mut unguarded_mj] = [Line::new(), Line::new()];
    let mut time_s = 0.0;
    // Far enough to break the stick at every stroke.
    shake((5e-3, 20.0), SHOWN_S, 0, &mut |tick, [shown_j, model_j]| {
        time_s += STEP_S;
        guarded_nm.push((time_s, tick.shown_nm));
        unguarded_nm.push((time_s, tick.model_nm));
        guarded_mj.push((time_s, shown_j * 1e3));
        unguarded_mj.push((time_s, model_j * 1e3));
    })?;
    let [at_once, unguarded] = swept(0)?;
    let [one_late, _] = swept(1)?;
    let [two_late, _] = swept(2)?;
    let guarded = [at_once, one_late, two_late];
    let end = |line: &Line| line.last().map_or(0.0, |(_, y)| *y);
    let worst = |line: &Line| line.iter().map(|p| p.1).fold(0.0, f64::max);
    let (end_mj, guarded_end_mj) = (end(&unguarded_mj), end(&guarded_mj));
    let worst_guarded = guarded.iter().map(worst).fold(0.0, f64::max);
    let worst_unguarded = worst(&unguarded);
    let time = || Scale::linear("Time (s)").within(0.0, SHOWN_S);
    let mut swept = vec![Series::line(UNGUARDED, unguarded)];
    let guarded = GUARDED.into_iter().zip(guarded);
    swept.extend(guarded.map(|(name, line)| Series::line(name, line)));
    Ok(Story {
        name: "turn-back-guard",
        title: "A hand that turns back gets no more than the spring held",
        caption: format!(
            "A hand that shakes by ±5 mrad at 20 Hz turns back inside every slip. A frozen slip shows Tk until its time is \
             over: without the guard it pushes the hand along, so that the work put in after {SHOWN_S} s is {end_mj:.2} mJ, with the \
             guard {guarded_end_mj:.2} mJ. Below, for amplitudes from 0.3 to 3 strokes of a stick at {SWEPT_HZ} Hz, the most that is returned over \
             any stretch of {SWEPT_S} s, as a share of the {:.1} mJ that the spring holds, what sampling gives away being \
             granted: the worst with the guard is {worst_guarded:.3}, without it {worst_unguarded:.0}.",
            stored_j * 1e3,
        ),
        panels: vec![
            PanelData {
                heading: "Torque".to_owned(),
                x: time(),
                y: Scale::linear("Torque (N·m)"),
                series: vec![
                    Series::line(UNGUARDED, unguarded_nm),
                    Series::line(GUARDED[0], guarded_nm),
                ],
                ..PanelData::default()
            },
            PanelData {
                heading: "Work that the hand has put in".to_owned(),
                x: time(),
                y: Scale::linear("Work (mJ)"),
                series: vec![
                    Series::line(UNGUARDED, unguarded_mj),
                    Series::line(GUARDED[0], guarded_mj),
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
    })
}
