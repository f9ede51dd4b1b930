//! What a hand gets back that turns round inside a slip, with the turn-back
//! guard and without it, and how close the worst comes to the bound.

use super::{Mark, Panel, Scale, Series, Story};
use crate::sampling::Sampling;
use crate::stability::input::{Lost, Shake};
use crate::stability::shaking_hand::{Returned, ShakingHand, Tick};
use crate::stability::subject::{Rung, Subject};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Settings, SettingsError};
use crepitus_scene::scene::Precision;

/// The device's tick, s.
const STEP_S: f64 = 5e-5;
/// How long the hand shakes for a point of the sweep, s, and for the lines.
const SWEPT_S: f64 = 2.0;
const SHOWN_S: f64 = 0.2;
/// The hand of the lines: far enough to break the stick at every stroke.
const SHOWN: Shake = Shake {
    amplitude_rad: 5e-3,
    frequency_hz: 20.0,
    delay_ticks: 0,
    counts: false,
    lost: Lost::NONE,
};
/// Frequency of the sweep, Hz.
const SWEPT_HZ: f64 = 50.0;

/// What the device renders.
const DEVICE: Subject = Subject {
    solver: Rung::Ladder(Solver::ExactEvents),
    convention: Convention::Frozen,
    precision: Precision::F32,
};

/// Delays of the torque and their names, ticks.
const DELAYS: [(usize, &str); 3] = [
    (0, "with the guard"),
    (1, "with the guard, torque 1 tick late"),
    (2, "with the guard, torque 2 ticks late"),
];
const UNGUARDED: &str = "without the guard";

/// See the module.
pub(super) fn turn_back() -> Result<Story, SettingsError> {
    let p = Settings::default().parameters;
    let (mut shown, mut model) = (Vec::new(), Vec::new());
    let (mut work, mut unguarded) = (Vec::new(), Vec::new());
    let mut time_s = 0.0;
    shake(SHOWN, SHOWN_S, |tick| {
        time_s += STEP_S;
        shown.push((time_s, tick.shown_nm));
        model.push((time_s, tick.model_nm));
        work.push((time_s, tick.work_j * 1e3));
        unguarded.push((time_s, tick.unguarded_work_j * 1e3));
    })?;
    let sweep = Sweep::new(&p)?;
    let stored_j = p.static_torque_nm.powi(2) / (2.0 * p.stiffness_nm_per_rad);
    let ends_mj = |line: &[(f64, f64)]| line.last().map_or(0.0, |(_, y)| *y);
    let time = || Scale::linear("Time (s)").within(0.0, SHOWN_S);
    let first = DELAYS[0].1;
    Ok(Story {
        name: "turn-back-guard",
        title: "A hand that turns back gets no more than the spring held",
        caption: format!(
            "A hand that shakes by ±5 mrad at 20 Hz turns back inside every slip. A frozen slip shows Tk until its time is \
             over: without the guard it pushes the hand along, so that the work put in after {SHOWN_S} s is {:.2} mJ, with the \
             guard {:.2} mJ. Below, for amplitudes from 0.3 to 3 strokes of a stick at {SWEPT_HZ} Hz, the most that is returned over \
             any stretch of {SWEPT_S} s, as a share of the {:.1} mJ that the spring holds, what sampling gives away being \
             granted: the worst with the guard is {:.3}, without it {:.0}.",
            ends_mj(&unguarded),
            ends_mj(&work),
            stored_j * 1e3,
            sweep.worst,
            sweep.worst_unguarded,
        ),
        panels: vec![
            Panel {
                heading: "Torque".to_owned(),
                x: time(),
                y: Scale::linear("Torque (N·m)"),
                series: vec![Series::line(UNGUARDED, model), Series::line(first, shown)],
                levels: Vec::new(),
                bounds: Vec::new(),
            },
            Panel {
                heading: "Work that the hand has put in".to_owned(),
                x: time(),
                y: Scale::linear("Work (mJ)"),
                series: vec![
                    Series::line(UNGUARDED, unguarded),
                    Series::line(first, work),
                ],
                levels: Vec::new(),
                bounds: Vec::new(),
            },
            Panel {
                heading: "Most energy returned, against the amplitude".to_owned(),
                x: Scale {
                    logarithmic: true,
                    ..Scale::linear("Amplitude (strokes of a stick, Ts/kr)").within(0.3, 3.0)
                },
                y: Scale {
                    logarithmic: true,
                    ..Scale::linear("Share of Ts²/2kr").within(0.05, 100.0)
                },
                series: sweep.series,
                levels: vec![Mark::new(1.0, "bound")],
                bounds: Vec::new(),
            },
        ],
    })
}

fn shake(
    shake: Shake,
    duration_s: f64,
    on_tick: impl FnMut(&Tick),
) -> Result<Returned, SettingsError> {
    let motion = shake.motion();
    let hand = ShakingHand {
        settings: Settings::default().validate()?,
        sampling: Sampling::new(&motion, duration_s, STEP_S),
        shake,
    };
    hand.run::<f32>(DEVICE, on_tick)
}

/// What is returned, against the amplitude.
struct Sweep {
    series: Vec<Series>,
    worst: f64,
    worst_unguarded: f64,
}

impl Sweep {
    fn new(p: &crepitus_model::Parameters) -> Result<Self, SettingsError> {
        let stroke_rad = p.static_torque_nm / p.stiffness_nm_per_rad;
        let (mut worst, mut worst_unguarded) = (0.0_f64, 0.0_f64);
        let mut unguarded = Vec::new();
        let mut series = Vec::new();
        for (delay_ticks, name) in DELAYS {
            let mut points = Vec::new();
            for i in 0..=40 {
                let share = 0.3 * 10_f64.powf(f64::from(i) / 40.0);
                let hand = Shake {
                    amplitude_rad: share * stroke_rad,
                    frequency_hz: SWEPT_HZ,
                    delay_ticks,
                    counts: false,
                    lost: Lost::NONE,
                };
                let returned = shake(hand, SWEPT_S, |_| {})?;
                points.push((share, returned.guarded));
                worst = worst.max(returned.guarded);
                if delay_ticks == 0 {
                    unguarded.push((share, returned.unguarded));
                    worst_unguarded = worst_unguarded.max(returned.unguarded);
                }
            }
            series.push(Series::line(name, points));
        }
        series.insert(0, Series::line(UNGUARDED, unguarded));
        Ok(Self {
            series,
            worst,
            worst_unguarded,
        })
    }
}
