//! The vibration actuator on a leg, under everything that can happen to it.

use super::tools::{CASE, TICK_S, is_frozen};
use crate::stability::actuator::NOMINAL;
use crate::stability::case::{Case, Trial};
use crate::stability::criteria::{
    ACCELERATION, CURRENT, EXCURSION, LOOP_GAIN, LOOP_IN_PHASE, Measure, SHAFT_SPEED, VOLTAGE,
    VOLTAGE_STEP, actuator,
};
use crate::stability::criterion::Criterion;
use crate::stability::input::{ActuatorLoop, ActuatorRun, Input, Lost, Upset, What};
use crate::stability::subject::Rung;
use crepitus_model::solver::Solver;

/// A case of what the firmware has.
const ACTUATOR: Case = Case {
    source: "vibration-actuator: what its limits promise, and docs/vibration.md",
    of: |subject| is_frozen(subject) && subject.solver == Rung::Ladder(Solver::ExactEvents),
    ..CASE
};

const BONE_ON_BONE: ActuatorRun = ActuatorRun {
    preset: "bone-on-bone",
    ..NOMINAL
};

/// Stroke of the default mass, mm, and the supply, V.
const STROKE_MM: f64 = 1.6;
const SUPPLY_V: f64 = 5.0;

/// Criterion of at most so much, over the whole run or from a time on.
fn at_most(what: Measure, most: f64) -> Criterion {
    actuator(what, None, 0.0, most)
}

fn late(what: Measure, from_s: f64, most: f64) -> Criterion {
    actuator(what, Some(from_s), 0.0, most)
}

fn trial<const N: usize>(run: ActuatorRun, duration_s: f64, criteria: [Criterion; N]) -> Trial {
    Input::new(What::Actuator(run), duration_s, TICK_S).meets(criteria)
}

/// The loop without lateness, and four ticks late: stable to gain 2.
fn loops(hands: &'static [&'static str], on_time: Criterion) -> Vec<Trial> {
    let trial = |late_ticks, criterion| {
        let linear = ActuatorLoop { hands, late_ticks };
        Input::still(What::ActuatorLoop(linear)).meets([criterion])
    };
    vec![trial(0, on_time), trial(4, at_most(LOOP_IN_PHASE, 0.5))]
}

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H76",
        name: "actuator-let-go",
        title: "The hand lets go of the shell",
        hard: "Without the hand's mass and tissue the shell moves up to twice as much, and nothing but the seat damps it. The \
               leg falls, and the loop from the actuator to the encoder has its least margin.",
        trials: |_| {
            let run = ActuatorRun {
                upsets: &[(1.0, Upset::LetsGo)],
                ..NOMINAL
            };
            let loud = ActuatorRun {
                with: " at gain 2 on a stiff cuff",
                keys: &[
                    ("vibration-actuator", "gain", "2.0"),
                    ("cuff", "stiffness_nm_per_rad", "300.0"),
                ],
                ..run.clone()
            };
            let level = |most| late(ACCELERATION, 1.1, most);
            vec![
                trial(run, 1.4, [level(3.0), at_most(EXCURSION, STROKE_MM)]),
                trial(loud, 1.4, [level(6.0), at_most(VOLTAGE, SUPPLY_V)]),
            ]
        },
        ..ACTUATOR
    },
    Case {
        id: "H77",
        name: "actuator-stops",
        title: "The mass is driven against its stops",
        hard: "The device believes a stroke of 1.6 mm and the mass has 0.4: it knocks at every large swing. What is seen by \
               the encoder must not make the joint chatter.",
        trials: |_| {
            let run = ActuatorRun {
                with: " whose mass has 0.4 mm",
                speed_rad_s: 0.1,
                keys: &[("reaction-mass", "stroke_mm", "0.4")],
                ..BONE_ON_BONE
            };
            let criteria = [
                actuator(EXCURSION, None, 0.4, 1.2),
                at_most(VOLTAGE, SUPPLY_V),
                at_most(SHAFT_SPEED, 1.0),
            ];
            vec![trial(run, 3.0, criteria)]
        },
        ..ACTUATOR
    },
    Case {
        id: "H78",
        name: "actuator-rail",
        title: "More voltage is wanted than the supply has",
        hard: "At gain 2 the strongest joint wants twice what 5 V give. A cut command is another waveform, and must leave \
               excursion and heat within their limits.",
        trials: |_| {
            let run = ActuatorRun {
                with: " at gain 2 on 3 V",
                speed_rad_s: 0.3,
                keys: &[
                    ("vibration-actuator", "gain", "2.0"),
                    ("vibration-actuator", "supply_v", "3.0"),
                    ("reaction-mass", "supply_v", "3.0"),
                ],
                ..BONE_ON_BONE
            };
            let criteria = [
                actuator(VOLTAGE, None, 2.999, 3.000_001),
                at_most(EXCURSION, STROKE_MM),
                at_most(CURRENT, 1.45),
            ];
            vec![trial(run, 2.0, criteria)]
        },
        ..ACTUATOR
    },
    Case {
        id: "H79",
        name: "actuator-mean-step",
        title: "The mean torque changes its sign at once",
        hard: "A reversal turns the kinetic torque over. The high-pass answers with a swing of volts at the corner, which has \
               to be gone within 0.3 s and must not carry the mass to its stops.",
        trials: |_| {
            let run = ActuatorRun {
                speed_rad_s: 1.0,
                upsets: &[(0.6, Upset::Speed(-1.0))],
                ..BONE_ON_BONE
            };
            let criteria = [
                at_most(VOLTAGE, SUPPLY_V),
                at_most(EXCURSION, STROKE_MM),
                late(EXCURSION, 0.95, 0.6),
            ];
            vec![trial(run, 1.2, criteria)]
        },
        ..ACTUATOR
    },
    Case {
        id: "H80",
        name: "actuator-crawl",
        title: "0.02 rad/s: nine breaks a second",
        hard: "Below the corner of the high-pass there is hardly a ripple left, and each break is an event on its own. The \
               level stays, and neither the mass nor the coil is asked for more than they have.",
        trials: |_| {
            let run = ActuatorRun {
                speed_rad_s: 0.02,
                ..NOMINAL
            };
            let criteria = [
                actuator(ACCELERATION, None, 0.1, 2.0),
                at_most(EXCURSION, STROKE_MM),
                at_most(CURRENT, 1.45),
            ];
            vec![trial(run, 4.0, criteria)]
        },
        ..ACTUATOR
    },
    Case {
        id: "H81",
        name: "actuator-hot",
        title: "A coil that bears little current",
        hard: "It is asked for several times the current that it bears for ever. The command is reduced until the mean square is within, \
               without a jump and without pumping.",
        trials: |_| {
            let run = ActuatorRun {
                with: " at gain 2, whose coil bears 0.1 A",
                speed_rad_s: 0.3,
                keys: &[
                    ("vibration-actuator", "gain", "2.0"),
                    ("vibration-actuator", "continuous_current_a", "0.1"),
                ],
                ..BONE_ON_BONE
            };
            vec![trial(run, 8.0, [actuator(CURRENT, Some(5.0), 0.05, 0.13)])]
        },
        ..ACTUATOR
    },
    Case {
        id: "H82",
        name: "actuator-disarmed",
        title: "Disarmed in the middle of a ring",
        hard: "Both bridges open at once. The coil's current is gone, the mass rings down on its flexure alone, and nothing \
               drives it any more.",
        trials: |_| {
            let run = ActuatorRun {
                speed_rad_s: 0.1,
                upsets: &[(1.0, Upset::Disarmed)],
                ..BONE_ON_BONE
            };
            let none = [VOLTAGE, CURRENT].map(|what| late(what, 1.001, 0.0));
            vec![
                trial(run.clone(), 1.6, none),
                // The weight of the mass is left.
                trial(run, 1.6, [late(EXCURSION, 1.4, 0.25)]),
            ]
        },
        ..ACTUATOR
    },
    Case {
        id: "H83",
        name: "actuator-gain",
        title: "Its gain goes from 0 to 2 and back while the joint grates",
        hard: "A commit in mid-ring: the gain is followed, so that the voltage takes no step that the joint did not take, and \
               after it is 0 nothing is left.",
        trials: |_| {
            let run = ActuatorRun {
                with: " at gain 0",
                speed_rad_s: 0.3,
                keys: &[("vibration-actuator", "gain", "0.0")],
                upsets: &[(0.5, Upset::Gain(2.0)), (1.2, Upset::Gain(0.0))],
                ..NOMINAL
            };
            let criteria = [
                actuator(VOLTAGE, None, 1.0, SUPPLY_V),
                // A drop of 0.2 N·m at gain 2 is 2.2 V.
                at_most(VOLTAGE_STEP, 2.5),
                late(VOLTAGE, 1.31, 0.0),
            ];
            vec![trial(run, 2.0, criteria)]
        },
        ..ACTUATOR
    },
    Case {
        id: "H84",
        name: "actuator-mismatch",
        title: "Everything 30 % off at once, in the worst directions",
        hard: "A stronger coil, less resistance, a lighter shell and hand, and a resonance that is not where the filter \
               expects it: the level goes up, the loop's gain with it. With the gear's friction and backlash.",
        trials: |_| {
            let louder = ActuatorRun {
                with: ", stronger and lighter by 30 % at gain 2",
                backlash: true,
                keys: &[
                    ("vibration-actuator", "gain", "2.0"),
                    ("reaction-mass", "force_constant_n_per_a", "1.43"),
                    ("reaction-mass", "resistance_ohm", "1.26"),
                    ("reaction-mass", "resonance_hz", "24.5"),
                    ("shell", "mass_kg", "0.175"),
                    ("shell", "seat_stiffness_n_per_m", "5200.0"),
                    ("cuff", "stiffness_nm_per_rad", "156.0"),
                    ("hand", "palm_factor", "0.7"),
                ],
                ..NOMINAL
            };
            let weaker = ActuatorRun {
                with: ", weaker and heavier by 30 %",
                backlash: true,
                keys: &[
                    ("reaction-mass", "force_constant_n_per_a", "0.77"),
                    ("reaction-mass", "resistance_ohm", "2.34"),
                    ("reaction-mass", "resonance_hz", "45.5"),
                    ("shell", "mass_kg", "0.325"),
                    ("hand", "palm_factor", "1.3"),
                ],
                ..NOMINAL
            };
            let loud = [at_most(ACCELERATION, 3.0), at_most(SHAFT_SPEED, 1.5)];
            let weak = [actuator(ACCELERATION, None, 0.03, 1.0)];
            vec![trial(louder, 2.0, loud), trial(weaker, 2.0, weak)]
        },
        ..ACTUATOR
    },
    Case {
        id: "H85",
        name: "actuator-lost-samples",
        title: "Bursts of lost samples",
        hard: "Of every 400 samples 15 in a row are missing: the torque is held, then released, and comes back. Each of these is a step \
               for the high-pass, of up to the whole torque, and none may drive the mass to its stops.",
        trials: |_| {
            let run = ActuatorRun {
                lost: Lost {
                    ticks: 15,
                    every: 400,
                    from_s: 0.5,
                },
                ..NOMINAL
            };
            let criteria = [
                // A torque of 0.4 N·m that comes back at once is 2.2 V, on what rings.
                at_most(VOLTAGE, 4.4),
                at_most(ACCELERATION, 1.5),
                at_most(EXCURSION, STROKE_MM),
            ];
            vec![trial(run, 2.0, criteria)]
        },
        ..ACTUATOR
    },
    Case {
        id: "H86",
        name: "actuator-loop",
        title: "The loop from the actuator to the encoder, in a hand",
        hard: "The actuator shakes the shell, the shell the rotor, the encoder sees it, and the stick answers with kr: that \
               torque goes to the actuator, too. In the worst case for it the joint sticks always and the gear has no friction.",
        trials: |_| loops(&["light", "firm", "whole-arm"], at_most(LOOP_GAIN, 0.4)),
        ..ACTUATOR
    },
    Case {
        id: "H87",
        name: "actuator-loop-let-go",
        title: "The same loop when nobody holds the shell",
        hard: "On the stiffest cuff the gain of 0.4 is missed, without a hand that takes part. Up to gain 2, where the \
               parameter ends, it is stable all the same, though by little.",
        trials: |_| loops(&["nobody"], at_most(LOOP_IN_PHASE, 0.5)),
        ..ACTUATOR
    },
];
