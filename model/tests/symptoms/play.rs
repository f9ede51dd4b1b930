//! The play element by itself.

use super::rig::*;
use crepitus_model::ShaftStep;
use crepitus_model::render::effects::play::{Hold, Limits, Part, Play};
use crepitus_model::render::effects::symptom::{Change, Word};
use crepitus_model::render::input_check::Checked;
use crepitus_model::render::position::decay;
use crepitus_model::render::position::{Scale, Sensing, Travel};

/// A tick from one angle to another, rad.
fn travel(from_rad: f64, to_rad: f64) -> Travel<f64> {
    let omega = (to_rad - from_rad) / TICK_S;
    let shaft = ShaftStep {
        delta_phi_rad: to_rad - from_rad,
        omega_start_rad_s: omega,
        omega_end_rad_s: omega,
    };
    let scale = Scale::new(&Sensing::IDEAL, TICK_S);
    let place = Sensing::IDEAL.position(to_rad);
    Travel::of(&Checked::Step(shaft), &place, &scale).unwrap()
}

/// Moves to an angle with a spring of 100 N·m/rad within ±2 N·m.
fn to(play: &mut Play<f64>, from_rad: f64, to_rad: f64, stiffness: f64) -> f64 {
    let travel = travel(from_rad, to_rad);
    play.follow(
        &travel,
        Part::whole(1.0),
        stiffness,
        |_| Limits::both(2.0),
        &mut (),
    )
}

fn stretched() -> Play<f64> {
    let mut play = Play::new();
    play.rest(&Sensing::IDEAL.position(0.5));
    near(to(&mut play, 0.5, 0.51, 100.0), 1.0, 1e-12);
    play
}

#[test]
fn it_is_dragged_at_its_limits_and_elastic_between() {
    let mut play = stretched();
    assert_eq!(play.hold(), Hold::Elastic);
    near(to(&mut play, 0.51, 0.6, 100.0), 2.0, 1e-12);
    assert_eq!(play.hold(), Hold::Upper);
    near(to(&mut play, 0.6, 0.59, 100.0), 1.0, 1e-12);
    near(to(&mut play, 0.59, 0.5, 100.0), -2.0, 1e-12);
    assert_eq!(play.hold(), Hold::Lower);
}

#[test]
fn a_stiffer_spring_keeps_its_torque_and_a_softer_one_its_share() {
    for (stiffness, nm) in [(400.0, 1.0), (100.0, 1.0), (25.0, 0.25)] {
        let mut play = stretched();
        play.change(100.0, stiffness, 1.0);
        near(play.torque_nm(), nm, 1e-12);
        // The play goes on from there with the new stiffness.
        near(to(&mut play, 0.51, 0.51, stiffness), nm, 1e-12);
        near(
            to(&mut play, 0.51, 0.512, stiffness),
            nm + 0.002 * stiffness,
            1e-12,
        );
        // The energy of the play does not rise.
        assert!(nm * nm / (2.0 * stiffness) <= 1.0 / 200.0 + 1e-12);
    }
}

#[test]
fn what_lies_beyond_a_lowered_limit_falls_with_the_slew_limit() {
    let mut play = stretched();
    play.change(100.0, 100.0, 0.1);
    let mut follow = |nm: f64| {
        let travel = travel(0.51, 0.51);
        let limits = |_| Limits::both(0.65);
        near(
            play.follow(&travel, Part::whole(1.0), 100.0, limits, &mut ()),
            nm,
            1e-12,
        );
    };
    for nm in [1.0, 0.9, 0.8, 0.7, 0.65, 0.65] {
        follow(nm);
    }
}

#[test]
fn a_release_lets_go_of_so_much_and_no_more_than_there_is() {
    let mut play = stretched();
    play.release(0.3);
    near(to(&mut play, 0.51, 0.51, 100.0), 0.7, 1e-12);
    play.release(5.0);
    near(to(&mut play, 0.51, 0.51, 100.0), 0.0, 1e-12);
    near(to(&mut play, 0.51, 0.5, 100.0), -1.0, 1e-12);
}

#[test]
fn part_of_a_travel_ends_where_its_share_does() {
    let mut play = stretched();
    let travel = travel(0.51, 0.514);
    let part = Part::until(1.0, 0.25);
    let nm = play.follow(&travel, part, 100.0, |_| Limits::both(2.0), &mut ());
    near(nm, 1.1, 1e-12);
}

#[test]
fn a_short_decay_is_the_exponential() {
    // The shortest time constant is 5 ms, a hundred ticks.
    for n in 0..=100 {
        let x = -1e-4 * f64::from(n);
        near(decay(x), x.exp(), 5e-10);
    }
    // Over a gap: 32 ticks of 50 µs at 5 ms are a third.
    for n in 0..=33 {
        let x = -0.01 * f64::from(n);
        near(decay(x), x.exp(), 1e-5);
    }
    for n in 0..=60 {
        let x = -0.1 * f64::from(n);
        assert!((0.0..=1.0).contains(&decay(x)), "{x}");
    }
}

#[test]
fn a_play_that_gets_a_spring_begins_without_torque() {
    let mut play = Play::new();
    play.rest(&Sensing::IDEAL.position(0.5));
    play.change(0.0, 100.0, 1.0);
    near(to(&mut play, 0.5, 0.505, 100.0), 0.5, 1e-12);
}

#[test]
fn limits_that_a_play_has_yet_to_meet_drag_it_nowhere() {
    let dragged = || {
        let mut play = stretched();
        to(&mut play, 0.51, 0.6, 100.0);
        assert_eq!(play.hold(), Hold::Upper);
        play
    };
    let mut play = dragged();
    play.change(100.0, 100.0, 1.0);
    assert_eq!(play.hold(), Hold::Elastic);
    let mut play = dragged();
    play.release(0.3);
    assert_eq!(play.hold(), Hold::Elastic);
    // What has no torque is where it is.
    let mut play = dragged();
    let travel = travel(0.6, 0.6);
    let mut words = Vec::new();
    let mut told = |change: Change<f64>| words.push(change.word);
    let none = |_| Limits::both(0.0);
    play.follow(&travel, Part::whole(1.0), 100.0, none, &mut told);
    // The play was let go of, and has not turned.
    assert_eq!(words, [Word::Slack]);
    play.change(100.0, 100.0, 1.0);
    assert_eq!(play.hold(), Hold::Slack);
    play.release(0.3);
    assert_eq!(play.hold(), Hold::Slack);
}

/// A joint that slows down evenly turns at a time of its own, early or late in a tick. The
/// spring falls behind its limit then, or a little before where the limit grows:
///
/// ```text
/// T(t) = u(t*) − σ·(φ(t*) − φ(t))     σ·Ω(t*) = u̇
/// ```
#[test]
fn a_spring_that_is_dragged_turns_when_the_joint_does() {
    const STIFFNESS: f64 = 100.0;
    // In a tick by a radian a second.
    let slows = 1.0 / TICK_S;
    // The limit grows by nothing, or by what the spring gains at 0.3 rad/s.
    for earlier in [0.0, 0.3] {
        let grows_nm = STIFFNESS * earlier * TICK_S;
        let limit_nm = |tick: f64| 0.05 + grows_nm * tick;
        for share in [0.1, 0.3, 0.45, 0.55, 0.75, 0.9] {
            for (sense, way) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                let falls_behind = 10.0 + share;
                let turns_s = (falls_behind + earlier) * TICK_S;
                let motion = |tick: f64| {
                    let since_s = tick * TICK_S - turns_s;
                    let rad = 0.5 - way * 0.5 * slows * since_s * since_s;
                    (rad, -way * slows * since_s)
                };
                let mut play = Play::new();
                play.rest(&Sensing::IDEAL.position(motion(0.0).0));
                let mut words = Vec::new();
                for tick in 0..14 {
                    let begins = f64::from(tick);
                    let (from, end) = (motion(begins), motion(begins + 1.0));
                    let shaft = ShaftStep {
                        delta_phi_rad: end.0 - from.0,
                        omega_start_rad_s: from.1,
                        omega_end_rad_s: end.1,
                    };
                    let scale = Scale::new(&Sensing::IDEAL, TICK_S);
                    let place = Sensing::IDEAL.position(end.0);
                    let travel = Travel::of(&Checked::Step(shaft), &place, &scale).unwrap();
                    let nm = play.follow(
                        &travel,
                        Part::whole(sense),
                        STIFFNESS,
                        |fraction| Limits::both(limit_nm(begins + fraction)),
                        &mut |change: Change<f64>| {
                            words.push((change.word, begins + change.fraction));
                        },
                    );
                    // A turn in the second half of a tick shows in the next one.
                    if begins + 0.5 > falls_behind {
                        let there_rad = motion(falls_behind).0;
                        let less_nm = STIFFNESS * way * (there_rad - end.0);
                        let expected_nm = limit_nm(falls_behind) - less_nm;
                        near(nm, sense * way * expected_nm, 1e-11);
                    }
                }
                let [(Word::Flow, flows), (Word::Turn, turns)] = words[..] else {
                    panic!("{words:?}");
                };
                near(turns, falls_behind, 1e-9);
                // From rest at tick 0 by 100 N·m/rad to the limit.
                let torque_nm = STIFFNESS * (motion(flows).0 - motion(0.0).0).abs();
                near(torque_nm, limit_nm(flows), 1e-9);
            }
        }
    }
}
