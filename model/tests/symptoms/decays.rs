//! Limits that decay: what is left of a catch and of a blade at every tick, wherever in a tick
//! they begin, and where a spring falls behind them.

use super::rig::*;
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::effects::clasp_knife::ClaspKnifeSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_model::render::effects::symptom::Word;

/// Both begin to decay at 42.5 deg in this movement, in the middle of tick 3,461.
const FROM_DEG: f64 = 20.0;
const DEG_S: f64 = 130.0;
const BEGINS_S: f64 = 22.5 / 130.0;

/// A symptom, its spring, and its limit over time and angle, N·m.
struct Decay {
    settings: EffectSettings,
    word: Word,
    stiffness: f64,
    limit_nm: fn(f64, f64) -> f64,
}

/// P·[r + (1 − r)·e^(−t/τ)] + k·(φ − φc).
fn catch_nm(time_s: f64, rad: f64) -> f64 {
    let peak_nm = 0.67 * DEG_S.to_radians();
    let decayed = (-(time_s - BEGINS_S) / 0.06).exp();
    peak_nm * (0.5 + 0.5 * decayed) + (rad - 42.5_f64.to_radians())
}

/// L·[r + (1 − r)·e^(−t/τ)].
fn blade_nm(time_s: f64, _: f64) -> f64 {
    let release_nm = 0.8 + 3.0 * 17.5_f64.to_radians();
    let decayed = (-(time_s - BEGINS_S) / 0.03).exp();
    release_nm * (0.15 + 0.85 * decayed)
}

fn decays() -> [Decay; 2] {
    let spasticity = SpasticitySettings::default();
    let clasp_knife = ClaspKnifeSettings {
        onset_deg: 25.0,
        release_deg: 42.5,
        ..ClaspKnifeSettings::default()
    };
    [
        Decay {
            settings: on!(spasticity: spasticity),
            word: Word::Catch,
            stiffness: spasticity.catch_stiffness_nm_per_rad,
            limit_nm: catch_nm,
        },
        Decay {
            settings: on!(clasp_knife: clasp_knife),
            word: Word::Release,
            stiffness: clasp_knife.catch_stiffness_nm_per_rad,
            limit_nm: blade_nm,
        },
    ]
}

#[test]
fn a_limit_decays_from_the_moment_on_in_which_it_begins() {
    for decay in decays() {
        let run = only::<f64>(decay.settings, FROM_DEG).run(0.4, ramp(FROM_DEG, DEG_S));
        let [begins_s] = run.times(decay.word)[..] else {
            panic!("{:?}", run.words);
        };
        near(begins_s, BEGINS_S, 1e-12);
        // A catch has built up after some 12 ms.
        let dragged = run.rows.iter().filter(|row| row.0 > BEGINS_S + 0.02);
        for (time_s, rad, nm) in dragged {
            near(*nm, (decay.limit_nm)(*time_s, *rad), 1e-9);
        }
        // A blade falls at once.
        if decay.word == Word::Release {
            let falls = run.rows.iter().filter(|row| row.0 > BEGINS_S);
            for (time_s, rad, nm) in falls.take(400) {
                near(*nm, blade_nm(*time_s, *rad), 1e-9);
            }
        }
    }
}

/// The least value of a function that falls and then rises.
fn least(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..100 {
        let third = (high - low) / 3.0;
        let (a, b) = (low + third, high - third);
        if f(a) < f(b) {
            high = b;
        } else {
            low = a;
        }
    }
    f(0.5 * (low + high))
}

/// A spring is dragged along a limit that decays until the hand takes back more than that:
///
/// ```text
/// T(t) = min u(s) + σ·(φ(t) − φ(s))     s ≤ t
/// ```
#[test]
fn a_spring_falls_behind_a_decay_where_the_hand_takes_back_more() {
    let turns_s = 4_000.0 * TICK_S;
    for decay in decays() {
        // From 0.8 to 1.2 rad/s in a tick: it falls behind early and late in one.
        for n in 0..9 {
            let slows = 1.6e4 + 1e3 * f64::from(n);
            let motion = |time_s: f64| {
                let (rad, rad_s) = ramp(FROM_DEG, DEG_S)(time_s);
                let turned_s = (time_s - turns_s).max(0.0);
                let less_rad = 0.5 * slows * turned_s * turned_s;
                (rad - less_rad, rad_s - slows * turned_s)
            };
            let run = only::<f64>(decay.settings, FROM_DEG).run(4_008.0 * TICK_S, motion);
            for (time_s, rad, nm) in &run.rows[4_004..] {
                let slack_nm = |s: f64| {
                    let then_rad = motion(s).0;
                    (decay.limit_nm)(s, then_rad) - decay.stiffness * then_rad
                };
                let expected_nm = decay.stiffness * rad + least(slack_nm, turns_s, *time_s);
                near(*nm, expected_nm, 1e-9);
                assert!(*nm < (decay.limit_nm)(*time_s, *rad) - 1e-6);
            }
        }
    }
}
