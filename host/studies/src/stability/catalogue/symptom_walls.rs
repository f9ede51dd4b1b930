//! `range-limit` where a wall is easily got wrong.

use super::symptom_tools::{
    as_the_reference, exactly, renders_symptoms, seen_in_counts, times, torque, trial, under,
};
use super::tools::TICK_S;
use crate::stability::case::{Case, Trial, located};
use crate::stability::criterion::Criterion;
use crate::stability::input::{Input, SceneRun, SymptomRun};
use crate::stability::subject::Rung;
use crate::symptoms::{Given, Hand};
use crepitus_model::Settings;
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

/// Hand that moves from 98° at 20 deg/s, then by 0.6 counts to either side, 700 times a second.
fn flicker(at_deg: f64) -> Hand {
    Hand::Tremble {
        from_deg: 98.0,
        deg_s: 20.0,
        at_deg,
        by_deg: 0.001_226,
        frequency_hz: 700.0,
    }
}

/// A rotor without a leg that is pressed into a flexion limit. What presses is a string so soft that it does not notice the
/// wall.
fn pressed() -> SceneRun {
    SceneRun {
        what: "a rotor with 0.1 N·m of friction, pressed by 2 N·m into an end of 300 N·m/rad with a loss of 0.25, \
               with encoder, tick and current loop between them",
        text: "device = true\n\
               [motion]\nkind = \"velocity-knots\"\nfrom_deg = 89.0\nknots = [\n\
               { t_s = 0.0, omega_rad_s = 0.0 },\n\
               { t_s = 0.05, omega_rad_s = 2000.0 },\n\
               { t_s = 0.1, omega_rad_s = 0.0 }]\n\
               [effects.range-limit]\nextension_limit_deg = 0.0\nflexion_limit_deg = 90.0\n\
               flexion_stiffness_nm_per_rad = 300.0\nflexion_stiffening_nm_per_rad2 = 0.0\nflexion_loss = 0.25\n\
               [effects.encoder]\n[effects.motor]\n\
               [effects.drivetrain]\nfriction_nm = 0.1\nload_loss = 0.0\n\
               [effects.hand]\nmass_kg = 1e-3\ndamping_ns_per_m = 0.0\n\
               stiffness_n_per_m = 0.02\nlever_m = 1.0\n"
            .to_owned(),
        column: "range_limit_nm",
        is_compared: false,
        duration_s: 2.0,
        step_s: TICK_S,
    }
}

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H57",
        name: "wall-rest",
        title: "A leg that rests on a wall, or exactly at it, while a count flickers",
        hard: "A count more or less is 14 mN·m at 400 N·m/rad: elastic, and no event. At the wall itself every count \
               would be a contact and a leave; the leave needs two counts.",
        source: "docs/symptoms.md, range-limit; a hard end-feel, K_u = 400 N·m/rad",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
            // 300 N·m/rad · 0.3°, and what a flickering count adds or lets go.
            let pressed_nm = 300.0 * 0.3_f64.to_radians();
            let inside = seen_in_counts(under(&hard(), flicker(100.3), 1.0));
            let at = seen_in_counts(under(&hard(), flicker(100.0), 1.0));
            vec![
                trial(
                    inside,
                    [
                        torque(0.2, pressed_nm, pressed_nm, 2.0 * COUNT_OF_400_NM),
                        Criterion::Words(&[Word::Contact]),
                    ],
                ),
                trial(
                    at,
                    [
                        torque(0.2, 0.0, 0.0, COUNT_OF_400_NM),
                        Criterion::Words(&[Word::Contact]),
                    ],
                ),
            ]
        },
    },
    Case {
        id: "H58",
        name: "wall-graze",
        title: "A graze of a wall, 10 µrad deep, and a drift onto it at 0.05 deg/s",
        hard: "The hand turns 10 µrad behind the wall, a third of a count, or stays a nanodegree before it. A drift of \
               0.05 deg/s moves by 4e-8 rad in a tick, and takes 15 s to the cap: what is added up tick by tick is lost in f32.",
        source: "docs/symptoms.md, range-limit",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
            // A parabola with its top half a second on, 10° further.
            let turn = |depth_rad: f64| {
                let from_deg = 90.0 + depth_rad.to_degrees();
                Hand::ramps(from_deg, &[(0.0, 40.0), (1.0, -40.0)])
            };
            let drift = Hand::Constant {
                from_deg: 99.99,
                deg_s: 0.05,
            };
            let [events, torques] = as_the_reference();
            vec![
                trial(
                    under(&hard(), turn(1e-5), 1.0),
                    exactly(&[Word::Contact, Word::Leave]),
                ),
                trial(under(&hard(), turn(-2e-11), 1.0), [Criterion::Words(&[])]),
                // As late as a rounding of the angle is: 1e-13 rad at 9e-4 rad/s, in f32 1e-10.
                trial(
                    under(&hard(), drift, 18.0),
                    [
                        events,
                        torques,
                        Criterion::Words(&[Word::Contact, Word::Cap]),
                    ],
                ),
            ]
        },
    },
    Case {
        id: "H59",
        name: "wall-moved",
        title: "A wall that is armed around the leg, moved under it, or moved away",
        hard: "A wall at an absolute angle would push a leg that is beyond it with all of its cap, at once. Its spring \
               begins where the leg is: nothing is felt until it moves. A wall that is moved away lets go within the slew limit.",
        source: "docs/symptoms.md, The play: start, arming, moved limits",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
            let rest = Hand::Constant {
                from_deg: 110.0,
                deg_s: 0.0,
            };
            let pressed = Hand::jumps(99.0, &[(0.0, 20.0), (0.15, 0.0)]);
            let committed = |given: &Given, hand: &Hand, next: &Given| SymptomRun {
                commits: vec![(0.3, vec![next.clone()])],
                ..under(given, hand.clone(), 1.0)
            };
            let far = wall(140.0, 60.0, 400.0, 0.3);
            // 5 mN·m a tick, and the travel on the spring.
            let slew = Criterion::TorqueStep { most_nm: 0.005_001 };
            vec![
                trial(
                    under(&firm(), rest.clone(), 0.5),
                    [torque(0.0, 0.0, 0.0, 0.0), Criterion::Words(&[])],
                ),
                // Out again at once: it never pulls or pushes.
                trial(
                    under(
                        &firm(),
                        Hand::Constant {
                            from_deg: 103.0,
                            deg_s: -20.0,
                        },
                        0.5,
                    ),
                    [torque(0.0, 0.0, 0.0, 0.0), Criterion::Words(&[Word::Leave])],
                ),
                trial(
                    committed(&far, &rest, &firm()),
                    [torque(0.0, 0.0, 0.0, 0.0), slew.clone()],
                ),
                // 4 N·m in 40 ms at most.
                trial(
                    committed(&firm(), &pressed, &far),
                    [torque(0.345, 0.0, 0.0, 0.0)],
                ),
            ]
        },
    },
    Case {
        id: "H60",
        name: "wall-stiffness",
        title: "A wall made five times as stiff, and as soft again, while a leg rests on it",
        hard: "The stretch of the spring is kept or the torque is: with the stretch kept the torque is five times as large at \
               once, and the energy, too, out of nothing. The torque goes on where the spring gets stiffer, and \
               falls within the slew limit where it gets softer.",
        source: "docs/symptoms.md, The play: change of σ",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
            let soft = wall(100.0, 60.0, 0.0, 0.3);
            let stiff = wall(100.0, 300.0, 0.0, 0.3);
            let hand = Hand::jumps(98.0, &[(0.0, 20.0), (0.15, 0.0)]);
            let pressed_nm = 60.0_f64.to_radians();
            let committed = |first: &Given, second: &Given| SymptomRun {
                commits: vec![(0.5, vec![second.clone()])],
                ..under(first, hand.clone(), 1.0)
            };
            // The approach: K_u·Ω·h on the way in.
            let approach_nm = 300.0 / 0.7 * 20.0_f64.to_radians() * 5e-5;
            let step = Criterion::TorqueStep {
                most_nm: approach_nm.max(0.005) + 1e-5,
            };
            vec![
                trial(
                    committed(&soft, &stiff),
                    [
                        torque(0.2, pressed_nm, pressed_nm, 1e-5),
                        step.clone(),
                        times(Word::Contact, 1),
                    ],
                ),
                // 300 → 60: no more than the softer wall has there.
                trial(
                    committed(&stiff, &soft),
                    [torque(0.6, 0.0, pressed_nm, 1e-5), step],
                ),
            ]
        },
    },
    Case {
        id: "H61",
        name: "both-walls",
        title: "Both ends of the range in one stroke, and beyond a cap and in again",
        hard: "With five degrees between the ends a stroke leaves one wall and meets the other, and on its way back the first again. \
               Beyond its cap a wall yields; turned back and in again without leaving, it must be met where it is.",
        source: "docs/symptoms.md, range-limit",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) {
                return Vec::new();
            }
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
            vec![
                trial(
                    under(&narrow, stroke, 0.6),
                    exactly(&[
                        Word::Leave,
                        Word::Contact,
                        Word::Cap,
                        Word::Leave,
                        Word::Contact,
                        Word::Cap,
                    ]),
                ),
                trial(
                    under(&firm(), again, 1.0),
                    exactly(&[Word::Contact, Word::Cap, Word::Cap, Word::Leave]),
                ),
            ]
        },
    },
    Case {
        id: "H75",
        name: "wall-pressed",
        title: "A rotor alone, pressed into a hard end with the device in the loop",
        hard: "No leg, no cuff, no arm, and hardly any friction between the spring of the wall and counts, half a tick and a \
               current loop. Without friction the wall's 4 N·m come and go for ever; with 0.1 N·m the rotor bounces a few \
               times, and then not a millinewton metre moves.",
        source: "docs/symptoms.md, range-limit, how stiff: 2 N·m, quiet after 1.2 s",
        long: false,
        must: located,
        trials: |subject| {
            if !renders_symptoms(subject) || subject.solver == Rung::Reference {
                return Vec::new();
            }
            vec![Trial {
                settings: Settings::default(),
                input: Input::Scene(pressed()),
                criteria: vec![
                    Criterion::TorqueQuiet {
                        from_s: 1.2,
                        most_nm: 1e-3,
                    },
                    Criterion::WordCount {
                        word: Word::Contact,
                        least: 1,
                        most: 20,
                    },
                ],
            }]
        },
    },
];
