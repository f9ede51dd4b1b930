//! Energy that a hand gets back when it turns round inside a slip, with the turn-back
//! guard and without it, and how close the worst comes to the bound.

use super::Line;
use crate::sampling::Sampling;
use crate::stability::input::{Lost, Shake};
use crate::stability::shaking_hand::{Returned, ShakingHand, Tick};
use crate::stability::subject::{Rung, Subject};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Settings, SettingsError};
use crepitus_scene::scene::Precision;

/// The device's tick, s.
const STEP_S: f64 = 5e-5;
/// Duration of the shaking for a point of the sweep, s, and for the lines.
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

/// Subject that the device renders.
const DEVICE: Subject = Subject {
    solver: Rung::Ladder(Solver::ExactEvents),
    convention: Convention::Frozen,
    precision: Precision::F32,
};

/// Delays of the torque, ticks.
const DELAYS: [usize; 3] = [0, 1, 2];

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnBack {
    /// Durations of the lines, s, and of the shaking for a point of the
    /// sweep, s.
    pub lengths_s: (f64, f64),
    /// Frequency of the sweep, Hz.
    pub swept_hz: f64,
    /// Energy that the spring holds at the static limit, J.
    pub stored_j: f64,
    /// One hand.
    pub shaking: Shaking,
    /// Many hands, without the guard.
    pub unguarded: Line,
    /// Many hands, with it.
    pub guarded: Vec<Swept>,
}

/// A hand that turns back inside every slip; against time, s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shaking {
    /// Torque with the guard, N·m.
    pub guarded_nm: Line,
    /// Torque without it, N·m.
    pub unguarded_nm: Line,
    /// Work put in with the guard, J.
    pub guarded_j: Line,
    /// Work put in without it, J.
    pub unguarded_j: Line,
}

/// The most that is returned, as a share of what the spring holds, against the
/// amplitude in strokes of a stick.
#[derive(Clone, Debug, PartialEq)]
pub struct Swept {
    /// Delay of the torque, ticks.
    pub delay_ticks: usize,
    /// The line.
    pub returned: Line,
}

/// See the module.
pub(super) fn turn_back() -> Result<TurnBack, SettingsError> {
    let p = Settings::default().parameters;
    let mut shaking = Shaking::default();
    let mut time_s = 0.0;
    shake(SHOWN, SHOWN_S, |tick| {
        time_s += STEP_S;
        shaking.guarded_nm.push((time_s, tick.shown_nm));
        shaking.unguarded_nm.push((time_s, tick.model_nm));
        shaking.guarded_j.push((time_s, tick.work_j));
        shaking.unguarded_j.push((time_s, tick.unguarded_work_j));
    })?;
    let stroke_rad = p.static_torque_nm / p.stiffness_nm_per_rad;
    let mut unguarded = Line::new();
    let mut guarded = Vec::new();
    for delay_ticks in DELAYS {
        let mut line = Line::new();
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
            line.push((share, returned.guarded));
            if delay_ticks == 0 {
                unguarded.push((share, returned.unguarded));
            }
        }
        guarded.push(Swept {
            delay_ticks,
            returned: line,
        });
    }
    Ok(TurnBack {
        lengths_s: (SHOWN_S, SWEPT_S),
        swept_hz: SWEPT_HZ,
        stored_j: p.static_torque_nm.powi(2) / (2.0 * p.stiffness_nm_per_rad),
        shaking,
        unguarded,
        guarded,
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
