//! Hard changes of parameters during a run.

use super::tools::{FROZEN, PLAIN, changed, rendered, sine, slip_s};
use crate::stability::case::{Case, Trial};
use crate::stability::criteria::{
    energy_rise, guard_ticks, same_as, slew, slip_energy, slip_time, survives, torque,
};
use crate::stability::criterion::Limits;
use crate::stability::input::{Lost, Rendered, Shaft};
use crepitus_model::Parameters;
use crepitus_model::parameters::Tabled;
use crepitus_scene::preset::joints;
use crepitus_scene::scene::Precision;

// Each slip of 23.6 ms begins at 0.1 rad/s, 10 ms after a stick at 0 N·m.
const TWO_SLIPS: Shaft = Shaft::Knots(&[
    (0.0, 0.1, 0.1),
    (0.011, 0.1, -0.004),
    (0.026, -0.004, 0.0),
    (0.034, 0.0, 0.1),
    (0.044_2, 0.1, -0.004),
    (0.054_2, -0.004, 0.0),
    (0.06, 0.0, 0.0),
]);
const RETREAT: Shaft = Shaft::Knots(&[
    (0.0, 0.1, 0.1),
    (0.011, 0.1, -0.02),
    (0.021, -0.02, 0.0),
    (0.05, 0.0, 0.0),
]);
const THERE_AND_BACK: Shaft = Shaft::Knots(&[
    (0.0, 0.1, 0.1),
    (0.02, 0.1, -0.02),
    (0.03, -0.02, 0.1),
    (0.1, 0.1, 0.1),
]);

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H43",
        name: "equal-torques-ramp",
        title: "Ts and Tk one rounding apart, both ramping",
        hard: "Each number of a ramp is rounded separately: if Tk and Ts are one rounding apart, Tk may come out \
               above Ts, and a slip then shows more than the static limit.",
        source: "|T| is at most the static limit in force, to the bit",
        trials: |subject| {
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
            let torques = |kinetic_nm, static_nm| [0.01, 400.0, 0.0, kinetic_nm, static_nm];
            let mut changes = Vec::new();
            for (n, (kinetic_nm, static_nm, equal_nm)) in (0_u8..).zip(pairs) {
                let at_s = 0.04 * f64::from(n);
                changes.push((at_s, Parameters::of(torques(kinetic_nm, static_nm))));
                changes.push((at_s + 0.02, Parameters::of(torques(equal_nm, equal_nm))));
            }
            let input = changed(Shaft::Constant(1.0), 0.13, &changes);
            vec![input.meets([survives()]).with(torques(0.3, 0.3))]
        },
        ..FROZEN
    },
    Case {
        id: "H44",
        name: "softer-under-load",
        title: "The spring gets forty times softer under a stick",
        hard: "The angle stays, so the torque falls with the stiffness: a ramp that depends on Tk and Ts only has nothing \
               to do, takes one tick, and drops 0.35 N·m at once.",
        source: "model/src/render/ramp.rs: n = Ts·ln(kr/kr′)/(slew·h)",
        trials: |_| {
            let soft = Parameters::of([0.01, 10.0, 0.0, 0.2, 0.4]);
            [0.01, -0.01]
                .map(|omega| {
                    let input = changed(Shaft::Constant(omega), 0.15, &[(0.09, soft)]);
                    input.meets([slew(Limits(2e-6, 1e-3)), energy_rise(Limits(1e-12, 1e-5))])
                })
                .into()
        },
        ..FROZEN
    },
    Case {
        id: "H45",
        name: "stronger-in-a-slip",
        title: "Torques and stiffness change inside a slip, whose end then lies elsewhere",
        hard: "The restart angle (2Tk − Ts)/kr of the new numbers may store more than the old spring did at the break: \
               a slip would end with energy from nowhere.",
        source: "model/src/solver/frozen.rs: the angle of a slip's end is at most that of its break, scaled as the spring is",
        trials: |_| {
            let soft_and_strong = [0.01, 10.0, 0.0, 0.9, 1.0];
            let stiff_and_strong = [0.01, 4000.0, 0.0, 0.9, 1.0];
            let stiffer_and_strong = [0.01, 900.0, 0.0, 0.95, 1.0];
            let paper = Parameters::default();
            let mut trials: Vec<Trial> = [
                (paper.values(), stiffer_and_strong),
                (paper.values(), soft_and_strong),
                (paper.values(), stiff_and_strong),
                ([0.01, 100.0, 0.0, 0.2, 0.4], stiff_and_strong),
            ]
            .map(|(from, to)| {
                // The first break at 1 rad/s, and 2 ms later the commit.
                let change = (from[4] / from[1] + 0.002, Parameters::of(to));
                let input = changed(Shaft::Constant(1.0), 0.06, &[change]);
                let most = slip_energy(Limits(1e-12, 1e-5));
                input.meets([most]).with(from)
            })
            .into();
            // Four times the inertia, one tick after the break: the slip keeps
            // the end that it began with.
            let heavy = Parameters::of([0.04, 400.0, 0.0, 0.2, 0.4]);
            let input = changed(Shaft::Constant(0.97), 0.033, &[(1.04e-3, heavy)]);
            let slip = slip_time(slip_s(&paper, 0.97), Limits(1e-9, 1e-6));
            trials.push(input.meets([slip]));
            trials
        },
        ..FROZEN
    },
    Case {
        id: "H46",
        name: "commits-while-blind",
        title: "A commit every tick while samples are lost",
        hard: "Each commit starts a ramp before the last one has ended, some in the tick after a break, some while the \
               torque is held. Commits of the numbers in force must change nothing, to the bit.",
        source: "docs/stability.md, Energy from nowhere: a commit is one atomic exchange",
        trials: |_| {
            let mut trials = Vec::new();
            for (ticks, every) in [(0, 0), (2, 5), (10, 37), (40, 101)] {
                let run = |commits: Vec<Parameters>| {
                    let lost = Lost {
                        ticks,
                        every,
                        from_s: 0.0,
                    };
                    let device = Rendered {
                        counts: false,
                        lost,
                        commit_every: u64::from(!commits.is_empty()),
                        commits,
                    };
                    rendered(Shaft::Constant(0.5), 1.0, device)
                };
                let same = run(vec![Parameters::default()]);
                trials.push(same.meets([same_as(run(Vec::new()))]));
                let tour = run(joints().iter().map(|joint| joint.parameters).collect());
                trials.push(tour.meets([survives()]));
            }
            trials
        },
        ..FROZEN
    },
    Case {
        id: "H47",
        name: "guard-memory",
        title: "A hand that turns back a little in slip after slip, and one that turns back for good",
        hard: "Less than two counts in a slip are noise: a guard that adds them up over slips switches off the \
               torque of a hand that holds still, and one that does not switch it on again suppresses the next stick.",
        source: "model/src/render/turn_back.rs: 2 counts of 35.7 µrad; 60 and 40 µrad in two slips, then 200 µrad in one",
        trials: |_| {
            let run = |shaft, duration_s| rendered(shaft, duration_s, PLAIN);
            let gap = Rendered {
                lost: Lost {
                    ticks: 10,
                    every: 0,
                    from_s: 0.025,
                },
                ..PLAIN
            };
            let dithered = Rendered {
                counts: true,
                ..PLAIN
            };
            let on_again = torque(0.065, 0.3, 0.3, 1e-6);
            vec![
                run(TWO_SLIPS, 0.06).meets([guard_ticks(0, 0)]),
                // From 71.3 µrad behind, 14.6 ms, to the slip's end, 33.6 ms.
                run(RETREAT, 0.05).meets([guard_ticks(375, 383)]),
                // Samples are lost then: no torque is held, no stick restarts.
                rendered(RETREAT, 0.05, gap).meets([torque(0.031, 0.0, 0.0, 0.0)]),
                // With Ts = Tk slip follows slip without a stick between.
                run(THERE_AND_BACK, 0.1)
                    .meets([on_again])
                    .with([0.01, 400.0, 0.0, 0.3, 0.3]),
                // So weak a joint slips at once, and its hand shakes by a count.
                rendered(sine(20e-6, 300.0), 0.02, dithered)
                    .meets([guard_ticks(0, 0)])
                    .with([0.01, 400.0, 0.0, 0.001, 0.002]),
            ]
        },
        ..FROZEN
    },
];
