//! A shaft at constant speed or at rest, with closed forms.

use super::tools::{LOCATED, at_tick, events, exactly, joint, most_hz, paper_joint, sine, trial};
use crate::stability::case::{Case, Trial, located};
use crate::stability::criterion::{Counted, Criterion, Limits};
use crate::stability::input::{Input, Shaft};
use crate::stability::subject::Subject;

/// Rest from the start, and at 0.9·Ts/kr after a careful approach.
fn rest_trials(subject: Subject, duration_s: f64) -> Vec<Trial> {
    const APPROACH: &[(f64, f64, f64)] = &[
        (0.0, 0.0, 0.0),
        (0.05, 0.018, 0.018),
        (0.1, 0.0, 0.0),
        (0.2, 0.0, 0.0),
    ];
    [Shaft::Constant(0.0), Shaft::Knots(APPROACH)]
        .map(|shaft| {
            let input = Input::Sampled {
                shaft,
                duration_s,
                step_s: 1e-3,
            };
            let criteria = [
                exactly(Counted::Events, 0),
                // One step later the last acceleration is over, too.
                Criterion::TorqueStays { from_s: 0.101 },
            ];
            trial(paper_joint(subject.convention), input, criteria)
        })
        .to_vec()
}

const REST: Case = Case {
    id: "H03",
    name: "rest",
    title: "A shaft at rest, slack and loaded to 0.9 Ts",
    hard: "A regularised friction law creeps under load; rounding errors accumulate; a comparison \
           of two zeros can start a slip.",
    source: "at rest nothing in eqs. (1) to (11) moves",
    long: false,
    must: located,
    trials: |subject| rest_trials(subject, 100.0),
};

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H01",
        name: "constant-speed",
        title: "Constant speed from 0.05 to 3 rad/s",
        hard: "A stick lasts from 20 ms down to 0.33 ms, a slip ends where the velocities touch with an overlap of \
               λ²/2, 0.06 % at 3 rad/s, and each error shifts all events after it.",
        source: "tests/reference-cases, c01, c03z and c05, with 50 digits; closed form of the cycle, docs/model.md",
        long: false,
        must: located,
        trials: |subject| {
            let speeds = [
                (0.05, 10.0),
                (0.1, 10.0),
                (0.5, 4.0),
                (1.0, 2.0),
                (3.0, 2.0),
            ];
            let within_s = Limits {
                f64: 1e-12,
                f32: 5e-6,
            };
            let run = |(omega, duration_s)| {
                let input = at_tick(Shaft::Constant(omega), duration_s);
                trial(paper_joint(subject.convention), input, [events(within_s)])
            };
            speeds.map(run).to_vec()
        },
    },
    Case {
        id: "H02",
        name: "mirror",
        title: "The other direction is the mirror image",
        hard: "The paper's equations hold for Ω > 0 only. A comparison with > on one side and ≥ on the other, or a \
               sum in another order, makes flexion and extension differ.",
        source: "the equations are odd in angle and torque; tests/reference-cases, n06, with 50 digits",
        long: false,
        must: located,
        trials: |subject| {
            let settings = paper_joint(subject.convention);
            let pairs = [
                (Shaft::Constant(-1.0), Shaft::Constant(1.0), 1.0),
                (sine(-0.785, 0.25), sine(0.785, 0.25), 4.0),
            ];
            let run = |(shaft, other, duration_s)| {
                let other = at_tick(other, duration_s);
                trial(
                    settings,
                    at_tick(shaft, duration_s),
                    [Criterion::MirrorOf(other)],
                )
            };
            pairs.map(run).to_vec()
        },
    },
    REST,
    Case {
        id: "H03L",
        name: "rest-24h",
        title: "A shaft at rest for 24 hours",
        long: true,
        trials: |subject| rest_trials(subject, 86_400.0),
        ..REST
    },
    Case {
        id: "H08",
        name: "equal-torques",
        title: "Ts = Tk: breaks once and slides for ever",
        hard: "Once per period the velocities touch without crossing, with the torque exactly at the limit: a root \
               of even multiplicity, where rounding decides between no event and a stick of zero length.",
        source: "with Ts = Tk a slip takes nothing from the spring; tests/reference-cases, d13, with 50 digits",
        long: false,
        must: located,
        trials: |subject| {
            let criteria = [
                exactly(Counted::Events, 1),
                Criterion::EventsPerStep { most: 4 },
                Criterion::TorqueWithin {
                    from_s: 0.01,
                    low_nm: 0.3,
                    high_nm: 0.3,
                    slack_nm: 1e-7,
                },
            ];
            let settings = joint(subject.convention, [0.01, 400.0, 0.0, 0.3, 0.3]);
            vec![trial(
                settings,
                at_tick(Shaft::Constant(1.0), 2.0),
                criteria,
            )]
        },
    },
    Case {
        id: "H09",
        name: "nearly-equal-torques",
        title: "Ts a millionth above Tk",
        hard: "A stick lasts 1.5 ns, a thirty-thousandth of a step, and in f32 a millionth is eight roundings: the \
               phases must not chatter between two samples.",
        source: "tests/reference-cases, d14, with 50 digits",
        long: false,
        must: located,
        trials: |subject| {
            let settings = joint(
                subject.convention,
                [0.01, 400.0, 0.0, 0.3, 0.3 * (1.0 + 1e-6)],
            );
            let criteria = [
                Criterion::EventsPerSecond {
                    most: 2.0 * most_hz(&settings.parameters) + 2.0,
                },
                Criterion::EventsPerStep { most: 4 },
            ];
            vec![trial(
                settings,
                at_tick(Shaft::Constant(1.0), 2.0),
                criteria,
            )]
        },
    },
    Case {
        id: "H10",
        name: "no-kinetic-friction",
        title: "Tk = 0: every slip ends exactly at −Ts",
        hard: "The torque that stick needs after a slip is the static limit itself. Without a tolerance rounding \
               turns every stick into a reverse; one built without it counted 636 reverses.",
        source: "2Tk − Ts = −Ts; tests/reference-cases, z14, with 50 digits",
        long: false,
        must: located,
        trials: |subject| {
            let settings = joint(subject.convention, [0.01, 400.0, 0.0, 0.0, 0.4]);
            let criteria = [
                exactly(Counted::Breaks, 64),
                exactly(Counted::Reverses, 0),
                events(LOCATED),
            ];
            vec![trial(
                settings,
                at_tick(Shaft::Constant(1.0), 2.0),
                criteria,
            )]
        },
    },
];
