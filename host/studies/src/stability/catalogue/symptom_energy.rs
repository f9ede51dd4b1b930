//! Energy that a hand gets back from symptoms, and settings that must be refused.

use super::symptom_tools::{DEVICE, armed, lasting, plain, wander};
use crate::stability::case::Case;
use crate::stability::criteria::{net_returned, refused, springs_return};
use crate::stability::input::{Input, SymptomRun, What};
use crate::symptoms::{Given, Hand};
use crepitus_model::render::effects::{TANK_J, TANK_REFILL_W};

/// The most that a hand gets back in two seconds of what the tank pays for, J.
pub(super) const PAID_J: f64 = TANK_J + 2.0 * TANK_REFILL_W;

/// The symptoms that are springs, each stiff and strong.
pub(super) fn springs() -> [Given; 6] {
    [
        Given::new(
            "range-limit",
            &[
                ("extension_limit_deg", 50.0),
                ("flexion_limit_deg", 70.0),
                ("extension_stiffness_nm_per_rad", 300.0),
                ("extension_stiffening_nm_per_rad2", 0.0),
                ("flexion_stiffness_nm_per_rad", 300.0),
                ("flexion_stiffening_nm_per_rad2", 0.0),
            ],
            &[],
        ),
        plain("lead-pipe"),
        plain("cogwheel"),
        Given::new(
            "spasticity",
            &[("threshold_deg", 70.0)],
            &[("form", "catch")],
        ),
        Given::new(
            "clasp-knife",
            &[
                ("onset_deg", 50.0),
                ("release_deg", 75.0),
                ("rearm_deg", 2.0),
            ],
            &[],
        ),
        plain("texture"),
    ]
}

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H72",
        name: "play-energy",
        title: "Random hands get no more from a play than its spring holds",
        hard: "A wall, a catch, a tooth give energy back if what the hand stretched is more at the end than at the beginning: with a \
               limit that jumps up under the leg, or a spring whose end is not taken along. What returns is the spring's energy and that \
               of sampling, with the torque 0, 1 or 2 ticks late.",
        source: "docs/symptoms.md, The play: E ≤ T₀²/2σ + (½ + d)·σ·h·∫Ω² dt",
        trials: |_| {
            // All of the spring is 1, but for rounding.
            const MOST: f64 = 1.0 + 1e-6;
            let mut trials = Vec::new();
            for given in springs() {
                for seed in 1..=4 {
                    for delay_ticks in 0..=2 {
                        let run = SymptomRun {
                            delay_ticks,
                            ..armed(&given, wander(60.0, 200.0, seed))
                        };
                        trials.push(lasting(run, 4.0).meets([springs_return(MOST)]));
                    }
                }
            }
            trials
        },
        ..DEVICE
    },
    Case {
        id: "H73",
        name: "tank",
        title: "A hand that goes with a reflex and with the beats of clonus",
        hard: "Both push. A reflex gives energy above 3.7 Hz, beats to a hand that moves with them. One tank of 0.2 J with 0.04 W pays for \
               both, so that no hand gets more than 0.28 J in any 2 s, however late the torque is.",
        source: "docs/symptoms.md, Sum, tank and limits",
        trials: |_| {
            let reflex = Given::new(
                "spasticity",
                &[("gain_nm_per_rad", 20.0), ("threshold_deg", 60.0)],
                &[("form", "reflex")],
            );
            let clonus = Given::new(
                "clonus",
                &[
                    ("amplitude_nm", 4.5),
                    ("hold_deg", 58.0),
                    ("hysteresis_deg", 30.0),
                ],
                &[],
            );
            let mut trials = Vec::new();
            for symptoms in [
                vec![reflex.clone()],
                vec![clonus.clone()],
                vec![reflex, clonus],
            ] {
                for frequency_hz in [4.5, 6.0, 8.0] {
                    for delay_ticks in 0..=2 {
                        let hand = Hand::Sine {
                            centre_deg: 60.0,
                            amplitude_deg: 8.0,
                            frequency_hz,
                        };
                        let run = SymptomRun {
                            symptoms: symptoms.clone(),
                            delay_ticks,
                            ..armed(&plain("clonus"), hand)
                        };
                        trials.push(lasting(run, 6.0).meets([net_returned(PAID_J)]));
                    }
                }
            }
            trials
        },
        ..DEVICE
    },
    Case {
        id: "H74",
        name: "bad-symptoms",
        title: "Symptoms that a device must refuse",
        hard: "A reflex that is later than its muscle is stretched gives energy at every speed; a wall that is too stiff, or that loses \
               nothing, rings; together they may be stiffer than dry friction keeps quiet. NaN passes every comparison that is \
               written the wrong way round.",
        source: "docs/symptoms.md, Sum, tank and limits",
        trials: |_| {
            let wall = |k1: f64, loss: f64| {
                Given::new(
                    "range-limit",
                    &[
                        ("flexion_stiffness_nm_per_rad", k1),
                        ("flexion_stiffening_nm_per_rad2", 0.0),
                        ("flexion_loss", loss),
                    ],
                    &[],
                )
            };
            let one = |effect, numbers: &[(&'static str, f64)]| Given::new(effect, numbers, &[]);
            let reflex = |shift_s: f64| {
                let shift = [("velocity_shift_s", shift_s)];
                Given::new("spasticity", &shift, &[("form", "reflex")])
            };
            let nan = f64::NAN;
            let attempts = vec![
                ("a wall of 1,001 N·m/rad", vec![wall(600.0, 0.401)]),
                (
                    "a wall of 401 N·m/rad without a loss",
                    vec![wall(401.0, 0.0)],
                ),
                (
                    "ends of the range 4.9° apart",
                    vec![one(
                        "range-limit",
                        &[("extension_limit_deg", 50.0), ("flexion_limit_deg", 54.9)],
                    )],
                ),
                (
                    "1,236 N·m/rad together",
                    vec![
                        wall(300.0, 0.25),
                        one("lead-pipe", &[("torque_nm", 2.2), ("presliding_deg", 0.5)]),
                        one("texture", &[("stiffness_nm_per_rad", 400.0)]),
                        one("clasp-knife", &[("catch_stiffness_nm_per_rad", 190.0)]),
                    ],
                ),
                ("a reflex with μ < τd + τa", vec![reflex(0.059)]),
                ("a reflex with μ = NaN", vec![reflex(nan)]),
                (
                    "a clasp-knife that is released before its onset",
                    vec![one(
                        "clasp-knife",
                        &[("onset_deg", 75.0), ("release_deg", 30.0)],
                    )],
                ),
                (
                    "a texture whose spring is too soft for its teeth",
                    vec![one("texture", &[("stiffness_nm_per_rad", 30.0)])],
                ),
                (
                    "a rigidity of NaN N·m",
                    vec![one("lead-pipe", &[("torque_nm", nan)])],
                ),
                (
                    "a cogwheel of 0 Hz",
                    vec![one("cogwheel", &[("frequency_hz", 0.0)])],
                ),
            ];
            vec![Input::still(What::SymptomRefusals(attempts)).meets([refused()])]
        },
        ..DEVICE
    },
];
