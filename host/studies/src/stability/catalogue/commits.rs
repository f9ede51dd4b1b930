//! Hard changes of parameters during a run.

use super::tools::{changed, joint, paper_joint, rendered, slip_s, trial};
use crate::stability::case::{Case, located};
use crate::stability::criterion::{Criterion, Limits};
use crate::stability::input::{Input, Lost, Rendered, Shaft};
use crepitus_model::parameters::Tabled;
use crepitus_model::{Convention, Parameters};
use crepitus_scene::preset::joints;
use crepitus_scene::scene::Precision;

// Each slip of 23.6 ms begins at 0.1 rad/s, 10 ms after a stick at 0 N·m.
const TWO_SLIPS: &[(f64, f64, f64)] = &[
    (0.0, 0.1, 0.1),
    (0.011, 0.1, -0.004),
    (0.026, -0.004, 0.0),
    (0.034, 0.0, 0.1),
    (0.044_2, 0.1, -0.004),
    (0.054_2, -0.004, 0.0),
    (0.06, 0.0, 0.0),
];
const RETREAT: &[(f64, f64, f64)] = &[
    (0.0, 0.1, 0.1),
    (0.011, 0.1, -0.02),
    (0.021, -0.02, 0.0),
    (0.05, 0.0, 0.0),
];
const THERE_AND_BACK: &[(f64, f64, f64)] = &[
    (0.0, 0.1, 0.1),
    (0.02, 0.1, -0.02),
    (0.03, -0.02, 0.1),
    (0.1, 0.1, 0.1),
];

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H43",
        name: "equal-torques-ramp",
        title: "Ts and Tk one rounding apart, both ramping",
        hard: "Each number of a ramp is rounded separately: if Tk and Ts are one rounding apart, Tk may come out \
               above Ts, and a slip then shows more than the static limit.",
        source: "|T| is at most the static limit in force, to the bit",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention != Convention::Frozen {
                return Vec::new();
            }
            // Found by a search: along these the sum Tk + (Tk′ − Tk)·f is rounded
            // above Ts + (Ts′ − Ts)·f.
            let pairs = match subject.precision {
                Precision::F32 => [
                    (0.139_999_991_6, 0.14, 0.461),
                    (0.077_999_981_28, 0.078, 0.399),
                    (0.015_999_992_32, 0.016, 0.146),
                ],
                Precision::F64 => [
                    (0.173_999_999_999_999_96, 0.174, 0.892),
                    (0.151_999_999_999_999_94, 0.152, 0.495),
                    (0.142_999_999_999_999_85, 0.143, 0.927),
                ],
            };
            let torques = |kinetic_torque_nm, static_torque_nm| Parameters {
                kinetic_torque_nm,
                static_torque_nm,
                ..Parameters::default()
            };
            let mut changes = Vec::new();
            for (n, (kinetic_nm, static_nm, equal_nm)) in (0_u8..).zip(pairs) {
                let at_s = 0.04 * f64::from(n);
                changes.push((at_s, torques(kinetic_nm, static_nm)));
                changes.push((at_s + 0.02, torques(equal_nm, equal_nm)));
            }
            let settings = crepitus_model::Settings {
                parameters: torques(0.3, 0.3),
                ..paper_joint(subject.convention)
            };
            let input = changed(Shaft::Constant(1.0), 0.13, &changes);
            vec![trial(settings, input, [Criterion::Survives])]
        },
    },
    Case {
        id: "H44",
        name: "softer-under-load",
        title: "The spring gets forty times softer under a stick",
        hard: "The angle stays, so the torque falls with the stiffness: a ramp that depends on Tk and Ts only has nothing \
               to do, takes one tick, and drops 0.35 N·m at once.",
        source: "model/src/render/ramp.rs: n = Ts·ln(kr/kr′)/(slew·h)",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention != Convention::Frozen {
                return Vec::new();
            }
            let soft = Parameters {
                stiffness_nm_per_rad: 10.0,
                ..Parameters::default()
            };
            [0.01, -0.01]
                .map(|omega| {
                    let input = changed(Shaft::Constant(omega), 0.15, &[(0.09, soft)]);
                    let beyond = Limits {
                        f64: 2e-6,
                        f32: 1e-3,
                    };
                    let criteria = [
                        Criterion::Slew { beyond },
                        Criterion::EnergyRise {
                            most: Limits {
                                f64: 1e-12,
                                f32: 1e-5,
                            },
                        },
                    ];
                    trial(paper_joint(subject.convention), input, criteria)
                })
                .to_vec()
        },
    },
    Case {
        id: "H45",
        name: "stronger-in-a-slip",
        title: "Torques and stiffness change inside a slip, whose end then lies elsewhere",
        hard: "The restart angle (2Tk − Ts)/kr of the new numbers may store more than the old spring did at the break: \
               a slip would end with energy from nowhere.",
        source: "model/src/solver/frozen.rs: the angle of a slip's end is at most that of its break, scaled as the spring is",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention != Convention::Frozen {
                return Vec::new();
            }
            let soft_and_strong = [0.01, 10.0, 0.0, 0.9, 1.0];
            let stiff_and_strong = [0.01, 4000.0, 0.0, 0.9, 1.0];
            let stiffer_and_strong = [0.01, 900.0, 0.0, 0.95, 1.0];
            let paper = Parameters::default().values();
            let mut trials = [
                (paper, stiffer_and_strong),
                (paper, soft_and_strong),
                (paper, stiff_and_strong),
                ([0.01, 100.0, 0.0, 0.2, 0.4], stiff_and_strong),
            ]
            .map(|(from, to)| {
                // The first break at 1 rad/s, and 2 ms later the commit.
                let at_s = from[4] / from[1] + 0.002;
                let to = joint(subject.convention, to).parameters;
                let input = changed(Shaft::Constant(1.0), 0.06, &[(at_s, to)]);
                let most = Limits {
                    f64: 1e-12,
                    f32: 1e-5,
                };
                trial(
                    joint(subject.convention, from),
                    input,
                    [Criterion::SlipEnergy { most }],
                )
            })
            .to_vec();
            // Four times the inertia, one tick after the break: the slip keeps
            // the end that it began with.
            let heavy = joint(subject.convention, [0.04, 400.0, 0.0, 0.2, 0.4]).parameters;
            let slip = Criterion::SlipTime {
                slip_s: slip_s(&Parameters::default(), 0.97),
                within: Limits {
                    f64: 1e-9,
                    f32: 1e-6,
                },
            };
            let input = changed(Shaft::Constant(0.97), 0.033, &[(1.04e-3, heavy)]);
            trials.push(trial(paper_joint(subject.convention), input, [slip]));
            trials
        },
    },
    Case {
        id: "H46",
        name: "commits-while-blind",
        title: "A commit every tick while samples are lost",
        hard: "Each commit starts a ramp before the last one has ended, some in the tick after a break, some while the \
               torque is held. Commits of the numbers in force must change nothing, to the bit.",
        source: "docs/stability.md, Energy from nowhere: a commit is one atomic exchange",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention != Convention::Frozen {
                return Vec::new();
            }
            let settings = paper_joint(subject.convention);
            let mut trials = Vec::new();
            for (ticks, every) in [(0, 0), (2, 5), (10, 37), (40, 101)] {
                let lost = Lost {
                    ticks,
                    every,
                    from_s: 0.0,
                };
                let plain = Rendered {
                    lost,
                    ..rendered(Shaft::Constant(0.5), 1.0)
                };
                let same = Rendered {
                    commit_every: 1,
                    commits: vec![settings.parameters],
                    ..plain.clone()
                };
                let tour = Rendered {
                    commit_every: 1,
                    commits: joints().iter().map(|joint| joint.parameters).collect(),
                    ..plain.clone()
                };
                let same_as = Criterion::SameAs(Input::Rendered(plain));
                trials.push(trial(settings, Input::Rendered(same), [same_as]));
                trials.push(trial(
                    settings,
                    Input::Rendered(tour),
                    [Criterion::Survives],
                ));
            }
            trials
        },
    },
    Case {
        id: "H47",
        name: "guard-memory",
        title: "A hand that turns back a little in slip after slip, and one that turns back for good",
        hard: "Less than two counts in a slip are noise: a guard that adds them up over slips switches off the \
               torque of a hand that holds still, and one that does not switch it on again suppresses the next stick.",
        source: "model/src/render/turn_back.rs: 2 counts of 35.7 µrad; 60 and 40 µrad in two slips, then 200 µrad in one",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention != Convention::Frozen {
                return Vec::new();
            }
            let settings = paper_joint(subject.convention);
            let run = |shaft, duration_s| Rendered {
                shaft,
                ..rendered(Shaft::Constant(0.0), duration_s)
            };
            let ticks = |least, most| Criterion::GuardTicks { least, most };
            let silent = Criterion::TorqueWithin {
                from_s: 0.031,
                low_nm: 0.0,
                high_nm: 0.0,
                slack_nm: 0.0,
            };
            let gap = Lost {
                ticks: 10,
                every: 0,
                from_s: 0.025,
            };
            let equal = joint(subject.convention, [0.01, 400.0, 0.0, 0.3, 0.3]);
            let on_again = Criterion::TorqueWithin {
                from_s: 0.065,
                low_nm: 0.3,
                high_nm: 0.3,
                slack_nm: 1e-6,
            };
            let dither = Shaft::Sine {
                amplitude_rad: 20e-6,
                frequency_hz: 300.0,
                phase_deg: 0.0,
            };
            let dithered = Rendered {
                counts: true,
                ..run(dither, 0.02)
            };
            let mut trials = vec![
                trial(
                    settings,
                    Input::Rendered(run(Shaft::Knots(TWO_SLIPS), 0.06)),
                    [ticks(0, 0)],
                ),
                // From 71.3 µrad behind, 14.6 ms, to the slip's end, 33.6 ms.
                trial(
                    settings,
                    Input::Rendered(run(Shaft::Knots(RETREAT), 0.05)),
                    [ticks(375, 383)],
                ),
                // Samples are lost then: no torque is held, no stick restarts.
                trial(
                    settings,
                    Input::Rendered(Rendered {
                        lost: gap,
                        ..run(Shaft::Knots(RETREAT), 0.05)
                    }),
                    [silent],
                ),
                // With Ts = Tk slip follows slip without a stick between.
                trial(
                    equal,
                    Input::Rendered(run(Shaft::Knots(THERE_AND_BACK), 0.1)),
                    [on_again],
                ),
            ];
            // So weak a joint slips at once, and its hand shakes by a count.
            let weak = joint(subject.convention, [0.01, 400.0, 0.0, 0.001, 0.002]);
            trials.push(trial(weak, Input::Rendered(dithered), [ticks(0, 0)]));
            trials
        },
    },
];
