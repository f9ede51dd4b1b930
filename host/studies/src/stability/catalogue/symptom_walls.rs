//! `range-limit` where a wall is easily got wrong.

use super::symptom_tools::{
    DEVICE, SYMPTOM, armed, exactly, in_counts, lasting, steady, times, tremble, under,
};
use super::tools::{TICK_S, scene};
use crate::stability::case::Case;
use crate::stability::criteria::{torque, torque_quiet, torque_step, word_count, words};
use crate::stability::input::{Input, SymptomRun};
use crate::symptoms::{Given, Hand};
use crepitus_model::render::effects::symptom::Word;

/// σΔ: the torque of a count on a spring of 400 N·m/rad is 14 mN·m; a tremble of 1.2
/// counts moves it by 17.
const COUNT_OF_400_NM: f64 = 0.0172;

/// A flexion limit at this angle with this end-feel.
fn wall(limit_deg: f64, k1: f64, k2: f64, loss: f64) -> Given {
    Given::new(
        "range-limit",
        &[
            ("flexion_limit_deg", limit_deg),
            ("flexion_stiffness_nm_per_rad", k1),
            ("flexion_stiffening_nm_per_rad2", k2),
            ("flexion_loss", loss),
        ],
        &[],
    )
}

fn hard() -> Given {
    wall(100.0, 300.0, 0.0, 0.25)
}

fn firm() -> Given {
    wall(100.0, 60.0, 400.0, 0.3)
}

/// A wall under a hand for a second, and another from a time on, s.
fn committed(first: &Given, hand: &Hand, at_s: f64, second: &Given) -> Input {
    let run = SymptomRun {
        commits: vec![(at_s, vec![second.clone()])],
        ..armed(first, hand.clone())
    };
    lasting(run, 1.0)
}

/// A rotor without a leg that is pressed into a flexion limit. What presses is a string so soft that it does not notice the
/// wall.
const PRESSED: &str = "device = true\n\
    [motion]\nkind = \"velocity-knots\"\nfrom_deg = 89.0\nknots = [\n\
    { t_s = 0.0, omega_rad_s = 0.0 },\n\
    { t_s = 0.05, omega_rad_s = 2000.0 },\n\
    { t_s = 0.1, omega_rad_s = 0.0 }]\n\
    [effects.range-limit]\nextension_limit_deg = 0.0\nflexion_limit_deg = 90.0\n\
    flexion_stiffness_nm_per_rad = 300.0\nflexion_stiffening_nm_per_rad2 = 0.0\nflexion_loss = 0.25\n\
    [effects.encoder]\n[effects.motor]\n\
    [effects.drivetrain]\nfriction_nm = 0.1\nload_loss = 0.0\n\
    [effects.hand]\nmass_kg = 1e-3\ndamping_ns_per_m = 0.0\n\
    stiffness_n_per_m = 0.02\nlever_m = 1.0\n";

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H57",
        name: "wall-rest",
        title: "A leg that rests on a wall, or exactly at it, while a count flickers",
        hard: "A count more or less is 14 mN·m at 400 N·m/rad: elastic, and no event. At the wall itself every count \
               would be a contact and a leave; the leave needs two counts.",
        source: "docs/symptoms.md, range-limit; a hard end-feel, K_u = 400 N·m/rad",
        trials: |_| {
            // From 98° at 20 deg/s, then by 0.6 counts to either side, 700 times a second.
            let flicker = |at_deg| tremble((98.0, 20.0), at_deg, (0.001_226, 700.0));
            // 300 N·m/rad · 0.3°, and what a flickering count adds or lets go.
            let pressed_nm = 300.0 * 0.3_f64.to_radians();
            let pressed = torque(0.2, pressed_nm, pressed_nm, 2.0 * COUNT_OF_400_NM);
            let slack = torque(0.2, 0.0, 0.0, COUNT_OF_400_NM);
            let once = words(&[Word::Contact]);
            vec![
                in_counts(&hard(), flicker(100.3), 1.0).meets([pressed, once.clone()]),
                in_counts(&hard(), flicker(100.0), 1.0).meets([slack, once]),
            ]
        },
        ..SYMPTOM
    },
    Case {
        id: "H58",
        name: "wall-graze",
        title: "A graze of a wall, 10 µrad deep, and a drift onto it at 0.05 deg/s",
        hard: "The hand turns 10 µrad behind the wall, a third of a count, or stays a nanodegree before it. A drift of \
               0.05 deg/s moves by 4e-8 rad in a tick, and takes 15 s to the cap: what is added up tick by tick is lost in f32.",
        source: "docs/symptoms.md, range-limit",
        trials: |_| {
            // A parabola with its top half a second on, 10° further.
            let turn = |depth_rad: f64| {
                let from_deg = 90.0 + depth_rad.to_degrees();
                Hand::ramps(from_deg, &[(0.0, 40.0), (1.0, -40.0)])
            };
            let grazed = exactly(&[Word::Contact, Word::Leave]);
            // As late as a rounding of the angle is: 1e-13 rad at 9e-4 rad/s, in f32 1e-10.
            let drifted = exactly(&[Word::Contact, Word::Cap]);
            vec![
                under(&hard(), turn(1e-5), 1.0).meets(grazed),
                under(&hard(), turn(-2e-11), 1.0).meets([words(&[])]),
                under(&hard(), steady(99.99, 0.05), 18.0).meets(drifted),
            ]
        },
        ..SYMPTOM
    },
    Case {
        id: "H59",
        name: "wall-moved",
        title: "A wall that is armed around the leg, moved under it, or moved away",
        hard: "A wall at an absolute angle would push a leg that is beyond it with all of its cap, at once. Its spring \
               begins where the leg is: nothing is felt until it moves. A wall that is moved away lets go within the slew limit.",
        source: "docs/symptoms.md, The play: start, arming, moved limits",
        trials: |_| {
            let rest = steady(110.0, 0.0);
            let pressed = Hand::jumps(99.0, &[(0.0, 20.0), (0.15, 0.0)]);
            let far = wall(140.0, 60.0, 400.0, 0.3);
            let silent = || torque(0.0, 0.0, 0.0, 0.0);
            // Out again at once: it never pulls or pushes.
            let left = [silent(), words(&[Word::Leave])];
            vec![
                under(&firm(), rest.clone(), 0.5).meets([silent(), words(&[])]),
                under(&firm(), steady(103.0, -20.0), 0.5).meets(left),
                // 5 mN·m a tick, and the travel on the spring.
                committed(&far, &rest, 0.3, &firm()).meets([silent(), torque_step(0.005_001)]),
                // 4 N·m in 40 ms at most.
                committed(&firm(), &pressed, 0.3, &far).meets([torque(0.345, 0.0, 0.0, 0.0)]),
            ]
        },
        ..SYMPTOM
    },
    Case {
        id: "H60",
        name: "wall-stiffness",
        title: "A wall made five times as stiff, and as soft again, while a leg rests on it",
        hard: "The stretch of the spring is kept or the torque is: with the stretch kept the torque is five times as large at \
               once, and the energy, too, out of nothing. The torque goes on where the spring gets stiffer, and \
               falls within the slew limit where it gets softer.",
        source: "docs/symptoms.md, The play: change of σ",
        trials: |_| {
            let soft = wall(100.0, 60.0, 0.0, 0.3);
            let stiff = wall(100.0, 300.0, 0.0, 0.3);
            let hand = Hand::jumps(98.0, &[(0.0, 20.0), (0.15, 0.0)]);
            let pressed_nm = 60.0_f64.to_radians();
            // The approach: K_u·Ω·h on the way in.
            let approach_nm = 300.0 / 0.7 * 20.0_f64.to_radians() * 5e-5;
            let step = torque_step(approach_nm.max(0.005) + 1e-5);
            let stays = torque(0.2, pressed_nm, pressed_nm, 1e-5);
            // 300 → 60: no more than the softer wall has there.
            let falls = torque(0.6, 0.0, pressed_nm, 1e-5);
            let once = times(Word::Contact, 1);
            vec![
                committed(&soft, &hand, 0.5, &stiff).meets([stays, step.clone(), once]),
                committed(&stiff, &hand, 0.5, &soft).meets([falls, step]),
            ]
        },
        ..SYMPTOM
    },
    Case {
        id: "H61",
        name: "both-walls",
        title: "Both ends of the range in one stroke, and beyond a cap and in again",
        hard: "With five degrees between the ends a stroke leaves one wall and meets the other, and on its way back the first again. \
               Beyond its cap a wall yields; turned back and in again without leaving, it must be met where it is.",
        source: "docs/symptoms.md, range-limit",
        trials: |_| {
            let mut narrow = hard();
            narrow.numbers.extend([
                ("extension_limit_deg", 95.0),
                ("extension_stiffness_nm_per_rad", 100.0),
            ]);
            let stroke = Hand::jumps(94.0, &[(0.0, 30.0), (0.25, -30.0)]);
            let again = Hand::jumps(
                99.0,
                &[(0.0, 50.0), (0.2, -50.0), (0.28, 50.0), (0.5, -50.0)],
            );
            let both = exactly(&[
                Word::Leave,
                Word::Contact,
                Word::Cap,
                Word::Leave,
                Word::Contact,
                Word::Cap,
            ]);
            let one = exactly(&[Word::Contact, Word::Cap, Word::Cap, Word::Leave]);
            vec![
                under(&narrow, stroke, 0.6).meets(both),
                under(&firm(), again, 1.0).meets(one),
            ]
        },
        ..SYMPTOM
    },
    Case {
        id: "H75",
        name: "wall-pressed",
        title: "A rotor alone, pressed into a hard end with the device in the loop",
        hard: "No leg, no cuff, no arm, and hardly any friction between the spring of the wall and counts, half a tick and a \
               current loop. Without friction the wall's 4 N·m come and go for ever; with 0.1 N·m the rotor bounces a few \
               times, and then not a millinewton metre moves.",
        source: "docs/symptoms.md, range-limit, how stiff: 2 N·m, quiet after 1.2 s",
        trials: |_| {
            let what = "a rotor with 0.1 N·m of friction, pressed by 2 N·m into an end of 300 N·m/rad with a loss of \
                        0.25, with encoder, tick and current loop between them";
            let pressed = Input::new(scene(what, PRESSED, "range_limit_nm", false), 2.0, TICK_S);
            let bounces = word_count(Word::Contact, 1, 20);
            vec![pressed.meets([torque_quiet(1.2, 1e-3), bounces])]
        },
        ..DEVICE
    },
];
