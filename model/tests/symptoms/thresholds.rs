//! A threshold that is met to the last bit is met: what happens there is what the head of a
//! law says with its ≥, whichever side rounding would take.

use super::rig::*;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::render::Addition;
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::effects::clasp_knife::ClaspKnifeSettings;
use crepitus_model::render::effects::clonus::ClonusSettings;
use crepitus_model::render::effects::range_limit::RangeLimitSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_model::render::effects::symptom::Word;
use crepitus_model::render::position::{Position, Sensing};
use crepitus_model::{Sample, ShaftStep};

const COUNT_RAD: f64 = Sensing::IDEAL.rad_per_count;

/// Place so many counts from an angle. Differences of such places are exact.
fn place(deg: f64, counts: i32) -> Position<f64> {
    let place = Sensing::IDEAL.position::<f64>(deg.to_radians());
    Position {
        count: place.count + counts,
        ..place
    }
}

/// Armed at this place.
fn armed(settings: EffectSettings, at: Position<f64>) -> Rig<f64> {
    let mut rig = only::<f64>(settings, 0.0);
    rig.effects.rest(&at);
    rig
}

/// Goes on by so many counts in a tick, to this place, with these velocities at its ends.
fn go(rig: &mut Rig<f64>, to: Position<f64>, counts: i32, (from, end): (f64, f64)) -> f64 {
    let shaft = ShaftStep {
        delta_phi_rad: f64::from(counts) * COUNT_RAD,
        omega_start_rad_s: from,
        omega_end_rad_s: end,
    };
    rig.tick(Sample::Taken(shaft), to)
}

/// Events of the last tick, but for those of the play under a symptom.
fn told(rig: &Rig<f64>) -> Vec<(Word, f64)> {
    let words = rig.words.iter().copied();
    words.filter(|(word, _)| !word.is_of_play()).collect()
}

const NOTHING: [(Word, f64); 0] = [];

/// Extensors in flexion, and flexors in extension.
const BOTH: [(u8, i32); 2] = [(0, 1), (1, -1)];

fn knife(muscles: u8) -> EffectSettings {
    on!(clasp_knife: ClaspKnifeSettings {
        muscles,
        onset_deg: 40.0,
        release_deg: if muscles == 0 { 90.0 } else { 10.0 },
        ..ClaspKnifeSettings::default()
    })
}

#[test]
fn a_blade_builds_from_its_onset_on() {
    for (muscles, along) in BOTH {
        let rad_s = f64::from(along);
        let mut rig = armed(knife(muscles), place(40.0, -52 * along));
        let nm = go(&mut rig, place(40.0, 0), 52 * along, (rad_s, rad_s));
        assert_eq!(told(&rig), [(Word::Onset, 1.0)]);
        assert_eq!((nm, rig.phase()), (0.0, Some("building")));
        // There it stays.
        for _ in 0..3 {
            go(&mut rig, place(40.0, 0), 0, (0.0, 0.0));
            assert_eq!(told(&rig), NOTHING);
            assert_eq!(rig.phase(), Some("building"));
        }
        // One that is armed there builds from the beginning.
        let mut rig = armed(knife(muscles), place(40.0, 0));
        go(&mut rig, place(40.0, 0), 0, (0.0, 0.0));
        assert_eq!(told(&rig), [(Word::Onset, 0.0)]);
        // Within a tick it is a spring from the onset on, 60 N·m/rad.
        let mut rig = armed(knife(muscles), place(40.0, -13 * along));
        let nm = go(
            &mut rig,
            place(40.0, 39 * along),
            52 * along,
            (rad_s, rad_s),
        );
        assert_eq!(told(&rig), [(Word::Onset, 0.25)]);
        near(nm, 60.0 * 39.0 * f64::from(along) * COUNT_RAD, 1e-15);
    }
}

/// 1000 ticks a beat, without delay, about 0 deg.
fn clonus(muscles: u8) -> EffectSettings {
    on!(clonus: ClonusSettings {
        muscles,
        frequency_hz: 5.0,
        push_share: 0.25,
        first_stretch: 0.0,
        hold_deg: 0.0,
        hysteresis_deg: 5.0,
        start_velocity_deg_s: 100.0,
        delay_s: 0.0,
        ..ClonusSettings::default()
    })
}

#[test]
fn a_stretch_as_fast_as_the_least_starts_clonus() {
    for (muscles, along) in BOTH {
        let least = 100_f64.to_radians() * f64::from(along);
        let slower = least * (1.0 - f64::EPSILON);
        for (rad_s, starts) in [(least, true), (slower, false)] {
            let mut rig = armed(clonus(muscles), place(0.0, -52 * along));
            go(&mut rig, place(0.0, 0), 52 * along, (rad_s, rad_s));
            if starts {
                assert_eq!(told(&rig), [(Word::Start, 1.0), (Word::Beat, 1.0)]);
            } else {
                assert_eq!(told(&rig), NOTHING);
            }
        }
    }
}

#[test]
fn a_beat_is_over_after_its_share_of_the_period() {
    for (muscles, along) in BOTH {
        let rad_s = 2.0 * f64::from(along);
        let mut rig = armed(clonus(muscles), place(0.0, -52 * along));
        go(&mut rig, place(0.0, 0), 52 * along, (rad_s, rad_s));
        let mut rest = || go(&mut rig, place(0.0, 0), 0, (0.0, 0.0));
        for tick in 1..1_000 {
            let nm = rest();
            let share = f64::from(tick) / 1_000.0;
            let expected_nm = 1.5 * (std::f64::consts::PI * share).sin() * f64::from(along);
            near(nm, expected_nm, 1e-9);
            assert!(nm != 0.0);
        }
        assert_eq!(rest(), 0.0);
    }
}

#[test]
fn a_muscle_is_let_go_of_where_the_hysteresis_ends() {
    for (muscles, along) in BOTH {
        let rad_s = 2.0 * f64::from(along);
        let mut rig = armed(clonus(muscles), place(0.0, -52 * along));
        go(&mut rig, place(0.0, 0), 52 * along, (rad_s, rad_s));
        let back_rad = 5_f64.to_radians();
        // In steps of 4.8 mrad.
        for n in 1..=18 {
            let to = place(0.0, -5_000 * n * along);
            go(&mut rig, to, -5_000 * along, (0.0, 0.0));
            assert_eq!(told(&rig), NOTHING);
        }
        let there = Position {
            count: 0,
            rest_rad: -back_rad * f64::from(along),
        };
        go(&mut rig, there, -1_504 * along, (0.0, 0.0));
        let words: Vec<_> = told(&rig).iter().map(|told| told.0).collect();
        assert_eq!(words, [Word::Stop]);
    }
}

/// Catches from 40 deg on, at 40 deg/s.
fn caught(muscles: u8) -> EffectSettings {
    on!(spasticity: SpasticitySettings {
        muscles,
        threshold_deg: 40.0,
        velocity_shift_s: 0.0,
        threshold_velocity_deg_s: 40.0,
        ..SpasticitySettings::default()
    })
}

#[test]
fn a_catch_needs_no_more_than_its_angle_and_its_velocity() {
    for (muscles, along) in BOTH {
        let sign = f64::from(along);
        let least = 40_f64.to_radians() * sign;
        let at = |counts: i32| place(40.0, counts * along);
        let tick = |from: i32, to: i32, velocities: (f64, f64)| {
            let mut rig = armed(caught(muscles), at(from));
            go(&mut rig, at(to), (to - from) * along, velocities);
            told(&rig)
        };
        // At the least velocity, where it comes to the angle.
        assert_eq!(tick(-13, 39, (least, least)), [(Word::Catch, 0.25)]);
        // At the angle, as the tick ends.
        assert_eq!(tick(-52, 0, (sign, sign)), [(Word::Catch, 1.0)]);
        // Beyond it: at the least velocity as the tick ends, or as it begins.
        let ends = tick(100, 113, (0.1 * sign, least));
        assert_eq!((ends.len(), ends[0].0), (1, Word::Catch));
        near(ends[0].1, 1.0, 1e-12);
        assert_eq!(tick(0, 13, (least, 0.1 * sign)), [(Word::Catch, 0.0)]);
        // A little less of either is none.
        let slower = least * (1.0 - f64::EPSILON);
        for passed in [
            tick(-13, 39, (slower, slower)),
            tick(-53, -1, (sign, sign)),
            tick(100, 113, (0.1 * sign, slower)),
            tick(0, 13, (slower, 0.1 * sign)),
            tick(-1, 12, (least, 0.1 * sign)),
        ] {
            assert_eq!(passed, NOTHING);
        }
    }
}

/// 2 N·m/rad from 0 deg on, up to 0.5 N·m: a quarter of a radian, 2¹⁸ counts.
fn reflex() -> SpasticitySettings {
    SpasticitySettings {
        form: 1,
        threshold_deg: 0.0,
        gain_nm_per_rad: 2.0,
        torque_nm: 0.5,
        ..SpasticitySettings::default()
    }
}

fn with_reflex(reflex: SpasticitySettings) -> EffectSettings {
    on!(spasticity: reflex)
}

/// The torque after so many ticks at rest at this count.
fn rests(rig: &mut Rig<f64>, count: i32, ticks: u32) -> f64 {
    (0..ticks).fold(0.0, |_, _| go(rig, Position::at(count), 0, (0.0, 0.0)))
}

#[test]
fn a_reflex_is_silent_at_its_threshold_and_largest_at_its_largest() {
    for (count, phase) in [
        (-1, None),
        (0, None),
        (1, Some("reflex")),
        (262_143, Some("reflex")),
        (262_144, Some("reflex-at-its-largest")),
    ] {
        let mut rig = armed(with_reflex(reflex()), Position::at(count));
        rests(&mut rig, count, 1);
        assert_eq!(rig.phase(), phase, "{count}");
    }
}

#[test]
fn a_reflex_that_is_reset_has_been_told_nothing() {
    let mut rig = armed(with_reflex(reflex()), Position::at(262_144));
    near(rests(&mut rig, 262_144, 4_000), 0.5, 1e-6);
    rig.effects.rest(&Position::at(0));
    for _ in 0..1_200 {
        assert_eq!(rests(&mut rig, 0, 1), 0.0);
    }
}

#[test]
fn a_reflex_is_let_go_of_within_the_slew_limit_and_not_beyond() {
    let place = Position::at(131_072);
    let mut rig = armed(with_reflex(reflex()), place);
    near(rests(&mut rig, 131_072, 4_000), 0.25, 1e-6);
    for tick in 1..=100 {
        // Held for 20 ticks.
        let left_nm = 0.25 - f64::from((tick - 20).max(0)) * SLEW_NM;
        near(rig.tick(Sample::Lost, place), left_nm.max(0.0), 1e-6);
    }
}

#[test]
fn a_commit_leaves_a_reflex_what_it_was_told_and_other_muscles_nothing() {
    let count = 131_072;
    let mut rig = armed(with_reflex(reflex()), Position::at(count));
    near(rests(&mut rig, count, 4_000), 0.25, 1e-6);
    // Another largest torque is none of this place.
    let mut stronger = SpasticitySettings {
        torque_nm: 0.6,
        ..reflex()
    };
    rig.commit(with_reflex(stronger));
    for _ in 0..1_500 {
        near(rests(&mut rig, count, 1), 0.25, 1e-6);
    }
    // Another gain is, and comes after the delay.
    stronger.gain_nm_per_rad = 4.0;
    rig.commit(with_reflex(stronger));
    near(rests(&mut rig, count, 900), 0.25, 1e-6);
    near(rests(&mut rig, count, 4_000), 0.5, 1e-6);
    // Flexors are not stretched here, and never were.
    rig.commit(with_reflex(SpasticitySettings {
        muscles: 1,
        ..stronger
    }));
    let mut last_nm = 0.5;
    for _ in 0..3_000 {
        let nm = rests(&mut rig, count, 1);
        assert!((0.0..=last_nm + 1e-9).contains(&nm), "{last_nm} {nm}");
        last_nm = nm;
    }
    assert_eq!(last_nm, 0.0);
}

#[test]
fn a_joint_that_enters_from_the_wall_itself_is_pushed_from_there() {
    let wall = on!(range_limit: RangeLimitSettings::default());
    for (deg, along) in [(120.0, 1), (10.0, -1)] {
        let rad_s = f64::from(along);
        let mut rig = armed(wall, place(deg, 0));
        go(&mut rig, place(deg, 0), 0, (0.0, 0.0));
        assert_eq!((rig.words.len(), rig.phase()), (0, None));
        let nm = go(&mut rig, place(deg, 13 * along), 13 * along, (rad_s, rad_s));
        // Dragged along its envelope from the beginning: nothing is taken up before.
        assert_eq!(rig.words, [(Word::Contact, 0.0)]);
        let beyond_rad = 13.0 * COUNT_RAD;
        let envelope_nm = beyond_rad * (60.0 + 400.0 * beyond_rad);
        near(nm, rad_s * envelope_nm, 1e-15);
    }
}

/// A count that flickers at a wall is no contact and no leave each time.
#[test]
fn a_wall_is_left_once_the_joint_is_out_of_it_by_more_than_noise() {
    let sensing = Sensing::of_encoder(&EncoderSettings::default());
    let wall = on!(range_limit: RangeLimitSettings {
        flexion_limit_deg: 60.0,
        ..RangeLimitSettings::default()
    });
    let limit_rad = 60_f64.to_radians();
    let at_wall = (limit_rad / sensing.rad_per_count).ceil() as i32;
    let mut count = at_wall - 10;
    let mut rig = Rig::<f64>::new(wall, sensing, f64::from(count) * sensing.rad_per_count);
    let mut to = |next: i32| {
        let omega = f64::from(next - count) * sensing.rad_per_count / TICK_S;
        let shaft = ShaftStep {
            delta_phi_rad: omega * TICK_S,
            omega_start_rad_s: omega,
            omega_end_rad_s: omega,
        };
        count = next;
        rig.tick(Sample::Taken(shaft), Position::at(next));
        let words = told(&rig).into_iter();
        let words: Vec<Word> = words.map(|(word, _)| word).collect();
        (words, rig.phase())
    };
    for next in at_wall - 9..at_wall {
        assert_eq!(to(next), (vec![], None));
    }
    assert_eq!(to(at_wall), (vec![Word::Contact], Some("in-the-wall")));
    let noise = (sensing.flicker_rad / sensing.rad_per_count) as i32;
    assert!(noise > 0);
    for _ in 0..3 {
        for next in [at_wall, at_wall - noise] {
            assert_eq!(to(next), (vec![], Some("in-the-wall")), "{next}");
        }
    }
    assert_eq!(to(at_wall - noise - 2), (vec![Word::Leave], None));
}

#[test]
fn a_wall_that_is_moved_under_a_joint_at_rest_begins_there() {
    let wall = |flexion_limit_deg| RangeLimitSettings {
        flexion_limit_deg,
        ..RangeLimitSettings::default()
    };
    let with = |wall| on!(range_limit: wall);
    let mut rig = armed(with(wall(120.0)), place(60.0, 0));
    // Somewhere else than where it was armed.
    go(&mut rig, place(60.0, 5_000), 5_000, (0.0, 0.0));
    rig.commit(with(wall(50.0)));
    let mut rest = || {
        let nm = go(&mut rig, place(60.0, 5_000), 0, (0.0, 0.0));
        (nm, told(&rig))
    };
    assert_eq!(rest(), (0.0, vec![(Word::Contact, 0.0)]));
    for _ in 0..100 {
        assert_eq!(rest(), (0.0, vec![]));
    }
    let nm = go(&mut rig, place(60.0, 6_000), 1_000, (0.0, 0.0));
    let spring = wall(50.0).flexion().spring_nm_per_rad();
    near(nm, spring * 1_000.0 * COUNT_RAD, 1e-12);
}
