//! The vibration actuator on a leg, under everything that can happen to it.

use super::tools::TICK_S;
use crate::stability::case::{Case, Trial, located};
use crate::stability::criterion::{ActuatorMeasure as Measure, Criterion};
use crate::stability::input::{ActuatorLoop, ActuatorRun, Input, Lost, Upset};
use crate::stability::subject::{Rung, Subject};
use crate::vibration::loop_gain::CUFFS;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Settings};

/// Returns whether a subject is what the firmware has.
fn shakes(subject: Subject) -> bool {
    subject.convention == Convention::Frozen
        && matches!(subject.solver, Rung::Ladder(Solver::ExactEvents))
}

/// A firm hand on a nominal device.
pub(in crate::stability) const NOMINAL: ActuatorRun = ActuatorRun {
    with: "",
    preset: "coarse",
    speed_rad_s: 0.5,
    keys: &[],
    backlash: false,
    upsets: &[],
    lost: Lost::NONE,
    duration_s: 2.0,
    step_s: TICK_S,
};

/// Criterion of at most so much, over the whole run or from a time on.
fn at_most(what: Measure, most: f64) -> Criterion {
    within(what, None, 0.0, most)
}

fn late(what: Measure, from_s: f64, most: f64) -> Criterion {
    within(what, Some(from_s), 0.0, most)
}

fn within(what: Measure, from_s: Option<f64>, least: f64, most: f64) -> Criterion {
    Criterion::Actuator {
        what,
        from_s,
        least,
        most,
    }
}

/// Stroke of the default mass, mm, and the supply, V.
const STROKE_MM: f64 = 1.6;
const SUPPLY_V: f64 = 5.0;

const fn case(
    (id, name, title): (&'static str, &'static str, &'static str),
    hard: &'static str,
    trials: fn(Subject) -> Vec<Trial>,
) -> Case {
    Case {
        id,
        name,
        title,
        hard,
        source: "vibration-actuator: what its limits promise, and docs/vibration.md",
        long: false,
        must: located,
        trials,
    }
}

fn trials<const N: usize>(
    subject: Subject,
    runs: [(ActuatorRun, Vec<Criterion>); N],
) -> Vec<Trial> {
    if !shakes(subject) {
        return Vec::new();
    }
    let trial = |(run, criteria)| Trial {
        settings: Settings::default(),
        input: Input::Actuator(run),
        criteria,
    };
    runs.into_iter().map(trial).collect()
}

/// The loop without lateness, and four ticks late.
fn loops(
    subject: Subject,
    linear: ActuatorLoop,
    on_time: Vec<Criterion>,
    late: Vec<Criterion>,
) -> Vec<Trial> {
    if !shakes(subject) {
        return Vec::new();
    }
    let late_linear = ActuatorLoop {
        late_ticks: 4,
        ..linear
    };
    [(linear, on_time), (late_linear, late)]
        .map(|(linear, criteria)| Trial {
            settings: Settings::default(),
            input: Input::ActuatorLoop(linear),
            criteria,
        })
        .into()
}

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    case(
        ("H76", "actuator-let-go", "The hand lets go of the shell"),
        "Without the hand's mass and tissue the shell moves up to twice as much, and nothing but the seat damps it. The \
         leg falls, and the loop from the actuator to the encoder has its least margin.",
        |subject| {
            let run = ActuatorRun {
                upsets: &[(1.0, Upset::LetsGo)],
                duration_s: 1.4,
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
            trials(
                subject,
                [
                    (
                        run,
                        vec![
                            late(Measure::AccelerationRms, 1.1, 3.0),
                            at_most(Measure::Excursion, STROKE_MM),
                        ],
                    ),
                    (
                        loud,
                        vec![
                            late(Measure::AccelerationRms, 1.1, 6.0),
                            at_most(Measure::Voltage, SUPPLY_V),
                        ],
                    ),
                ],
            )
        },
    ),
    case(
        (
            "H77",
            "actuator-stops",
            "The mass is driven against its stops",
        ),
        "The device believes a stroke of 1.6 mm and the mass has 0.4: it knocks at every large swing. What is seen by \
         the encoder must not make the joint chatter.",
        |subject| {
            let run = ActuatorRun {
                with: " whose mass has 0.4 mm",
                preset: "bone-on-bone",
                speed_rad_s: 0.1,
                keys: &[("reaction-mass", "stroke_mm", "0.4")],
                duration_s: 3.0,
                ..NOMINAL
            };
            trials(
                subject,
                [(
                    run,
                    vec![
                        within(Measure::Excursion, None, 0.4, 1.2),
                        at_most(Measure::Voltage, SUPPLY_V),
                        at_most(Measure::ShaftSpeed, 1.0),
                    ],
                )],
            )
        },
    ),
    case(
        (
            "H78",
            "actuator-rail",
            "More voltage is wanted than the supply has",
        ),
        "At gain 2 the strongest joint wants twice what 5 V give. A cut command is another waveform, and must leave \
         excursion and heat within their limits.",
        |subject| {
            let run = ActuatorRun {
                with: " at gain 2 on 3 V",
                preset: "bone-on-bone",
                speed_rad_s: 0.3,
                keys: &[
                    ("vibration-actuator", "gain", "2.0"),
                    ("vibration-actuator", "supply_v", "3.0"),
                    ("reaction-mass", "supply_v", "3.0"),
                ],
                ..NOMINAL
            };
            trials(
                subject,
                [(
                    run,
                    vec![
                        within(Measure::Voltage, None, 2.999, 3.000_001),
                        at_most(Measure::Excursion, STROKE_MM),
                        at_most(Measure::CurrentRms, 1.45),
                    ],
                )],
            )
        },
    ),
    case(
        (
            "H79",
            "actuator-mean-step",
            "The mean torque changes its sign at once",
        ),
        "A reversal turns the kinetic torque over. The high-pass answers with a swing of volts at the corner, which has \
         to be gone within 0.3 s and must not carry the mass to its stops.",
        |subject| {
            let run = ActuatorRun {
                preset: "bone-on-bone",
                speed_rad_s: 1.0,
                upsets: &[(0.6, Upset::Speed(-1.0))],
                duration_s: 1.2,
                ..NOMINAL
            };
            trials(
                subject,
                [(
                    run,
                    vec![
                        at_most(Measure::Voltage, SUPPLY_V),
                        at_most(Measure::Excursion, STROKE_MM),
                        late(Measure::Excursion, 0.95, 0.6),
                    ],
                )],
            )
        },
    ),
    case(
        ("H80", "actuator-crawl", "0.02 rad/s: nine breaks a second"),
        "Below the corner of the high-pass there is hardly a ripple left, and each break is an event on its own. The \
         level stays, and neither the mass nor the coil is asked for more than they have.",
        |subject| {
            let run = ActuatorRun {
                speed_rad_s: 0.02,
                duration_s: 4.0,
                ..NOMINAL
            };
            trials(
                subject,
                [(
                    run,
                    vec![
                        within(Measure::AccelerationRms, None, 0.1, 2.0),
                        at_most(Measure::Excursion, STROKE_MM),
                        at_most(Measure::CurrentRms, 1.45),
                    ],
                )],
            )
        },
    ),
    case(
        ("H81", "actuator-hot", "A coil that bears little current"),
        "It is asked for several times the current that it bears for ever. The command is reduced until the mean square is within, \
         without a jump and without pumping.",
        |subject| {
            let run = ActuatorRun {
                with: " at gain 2, whose coil bears 0.1 A",
                preset: "bone-on-bone",
                speed_rad_s: 0.3,
                keys: &[
                    ("vibration-actuator", "gain", "2.0"),
                    ("vibration-actuator", "continuous_current_a", "0.1"),
                ],
                duration_s: 8.0,
                ..NOMINAL
            };
            let bounds = within(Measure::CurrentRms, Some(5.0), 0.05, 0.13);
            trials(subject, [(run, vec![bounds])])
        },
    ),
    case(
        (
            "H82",
            "actuator-disarmed",
            "Disarmed in the middle of a ring",
        ),
        "Both bridges open at once. The coil's current is gone, the mass rings down on its flexure alone, and nothing \
         drives it any more.",
        |subject| {
            let run = ActuatorRun {
                preset: "bone-on-bone",
                speed_rad_s: 0.1,
                upsets: &[(1.0, Upset::Disarmed)],
                duration_s: 1.6,
                ..NOMINAL
            };
            trials(
                subject,
                [
                    (
                        run.clone(),
                        vec![
                            late(Measure::Voltage, 1.001, 0.0),
                            late(Measure::CurrentRms, 1.001, 0.0),
                        ],
                    ),
                    // The weight of the mass is left.
                    (run, vec![late(Measure::Excursion, 1.4, 0.25)]),
                ],
            )
        },
    ),
    case(
        (
            "H83",
            "actuator-gain",
            "Its gain goes from 0 to 2 and back while the joint grates",
        ),
        "A commit in mid-ring: the gain is followed, so that the voltage takes no step that the joint did not take, and \
         after it is 0 nothing is left.",
        |subject| {
            let run = ActuatorRun {
                with: " at gain 0",
                speed_rad_s: 0.3,
                keys: &[("vibration-actuator", "gain", "0.0")],
                upsets: &[(0.5, Upset::Gain(2.0)), (1.2, Upset::Gain(0.0))],
                ..NOMINAL
            };
            trials(
                subject,
                [(
                    run,
                    vec![
                        within(Measure::Voltage, None, 1.0, SUPPLY_V),
                        // A drop of 0.2 N·m at gain 2 is 2.2 V.
                        at_most(Measure::VoltageStep, 2.5),
                        late(Measure::Voltage, 1.31, 0.0),
                    ],
                )],
            )
        },
    ),
    case(
        (
            "H84",
            "actuator-mismatch",
            "Everything 30 % off at once, in the worst directions",
        ),
        "A stronger coil, less resistance, a lighter shell and hand, and a resonance that is not where the filter \
         expects it: the level goes up, the loop's gain with it. With the gear's friction and backlash.",
        |subject| {
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
            trials(
                subject,
                [
                    (
                        louder,
                        vec![
                            at_most(Measure::AccelerationRms, 3.0),
                            at_most(Measure::ShaftSpeed, 1.5),
                        ],
                    ),
                    (
                        weaker,
                        vec![within(Measure::AccelerationRms, None, 0.03, 1.0)],
                    ),
                ],
            )
        },
    ),
    case(
        ("H85", "actuator-lost-samples", "Bursts of lost samples"),
        "Of every 400 samples 15 in a row are missing: the torque is held, then released, and comes back. Each of these is a step \
         for the high-pass, of up to the whole torque, and none may drive the mass to its stops.",
        |subject| {
            let run = ActuatorRun {
                lost: Lost {
                    ticks: 15,
                    every: 400,
                    from_s: 0.5,
                },
                ..NOMINAL
            };
            trials(
                subject,
                [(
                    run,
                    vec![
                        // A torque of 0.4 N·m that comes back at once is 2.2 V, on what rings.
                        at_most(Measure::Voltage, 4.4),
                        at_most(Measure::AccelerationRms, 1.5),
                        at_most(Measure::Excursion, STROKE_MM),
                    ],
                )],
            )
        },
    ),
    case(
        (
            "H86",
            "actuator-loop",
            "The loop from the actuator to the encoder, in a hand",
        ),
        "The actuator shakes the shell, the shell the rotor, the encoder sees it, and the stick answers with kr: that \
         torque goes to the actuator, too. In the worst case for it the joint sticks always and the gear has no friction.",
        |subject| {
            let linear = ActuatorLoop {
                hands: &["light", "firm", "whole-arm"],
                cuffs_nm_per_rad: &CUFFS,
                late_ticks: 0,
            };
            loops(
                subject,
                linear,
                vec![at_most(Measure::LoopGain, 0.4)],
                // Stable to gain 2.
                vec![at_most(Measure::LoopInPhase, 0.5)],
            )
        },
    ),
    case(
        (
            "H87",
            "actuator-loop-let-go",
            "The same loop when nobody holds the shell",
        ),
        "On the stiffest cuff the gain of 0.4 is missed, without a hand that takes part. Up to gain 2, where the \
         parameter ends, it is stable all the same, though by little.",
        |subject| {
            let linear = ActuatorLoop {
                hands: &["nobody"],
                cuffs_nm_per_rad: &CUFFS,
                late_ticks: 0,
            };
            let stable = || vec![at_most(Measure::LoopInPhase, 0.5)];
            loops(subject, linear, stable(), stable())
        },
    ),
];
