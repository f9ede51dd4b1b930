//! A joint in a device: invalid samples, parameters that change during a run,
//! and a hand that turns back.

use super::tools::{TICK_S, changed, faulty, joint, paper_joint, trial};
use crate::stability::case::{Case, located};
use crate::stability::criterion::{Counted, Criterion, Limits};
use crate::stability::input::{Fault, Input, Lost, Shaft, Shake};
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::parameters::Tabled;
use crepitus_model::{Convention, Parameters};
use crepitus_scene::preset::joints;

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H21",
        name: "impossible-samples",
        title: "Samples that are NaN, infinite, or implausible",
        hard: "One NaN in a state is a NaN for ever. A check rejects samples before the joint gets them; a rejected one \
               is counted, the torque is held for 20 ticks and then ramped down at 100 N·m/s, and up to three \
               missing ticks are caught up afterwards, so that the cycles stay on time.",
        source: "model/src/render/input_check.rs: the device's limits are 50 rad/s and 10 rad/s in a tick",
        long: false,
        must: located,
        trials: |subject| {
            let settings = paper_joint(subject.convention);
            let p = &settings.parameters;
            let every = |every| faulty(Shaft::Constant(1.0), Fault::Impossible { every }, 2.0);
            let rate = || Criterion::CycleRate {
                hz: super::tools::cycle_hz(p, 1.0),
                // A tick or two over the whole run.
                within: Limits::both(5e-5),
            };
            let blind = faulty(Shaft::Constant(1.0), Fault::Blind { from_s: 1.0 }, 1.5);
            let silence = [
                // 20 ticks, and at most 0.4 N·m at 5 mN·m a tick.
                Criterion::TorqueWithin {
                    from_s: 1.0 + 101.0 * TICK_S,
                    low_nm: 0.0,
                    high_nm: 0.0,
                    slack_nm: 0.0,
                },
                Criterion::SilentAfter { time_s: 1.0 },
            ];
            vec![
                trial(settings, every(7), [rate()]),
                trial(settings, every(2), [rate()]),
                trial(settings, blind, silence),
            ]
        },
    },
    Case {
        id: "H28",
        name: "gap",
        title: "No sample for a tenth of a second while the shaft moves on",
        hard: "The shaft's motion meanwhile is unknown. The torque has been ramped down; the joint continues in a new \
               stick that begins with the torque then shown. Later events are those of a joint \
               that was started there.",
        source: "model/src/render/held.rs: no torque step above Ts − (2Tk − Ts), a valid phase at the end",
        long: false,
        must: located,
        trials: |subject| {
            let settings = paper_joint(subject.convention);
            let fault = Fault::Gap {
                from_s: 0.5,
                to_s: 0.6,
            };
            let p = &settings.parameters;
            let most_nm = p.static_torque_nm - p.restart_torque_nm();
            // 31.8 a second for 1.9 s, and one more or less at the gap.
            let breaks = Criterion::Count {
                what: Counted::Breaks,
                least: 60,
                most: 62,
            };
            // Restarted at 0.6 s with an unloaded spring: 0.4 N·m later it breaks.
            let first = Criterion::FirstBreakAfter {
                from_s: 0.500_1,
                at_s: 0.6 + p.static_torque_nm / p.stiffness_nm_per_rad,
                within_s: Limits {
                    f64: 1e-9,
                    f32: 1e-6,
                },
            };
            vec![trial(
                settings,
                faulty(Shaft::Constant(1.0), fault, 2.0),
                [Criterion::TorqueStep { most_nm }, breaks, first],
            )]
        },
    },
    Case {
        id: "H29",
        name: "parameter-changes",
        title: "Parameters change in the middle of a stick and of a slip",
        hard: "A spring wound to 0.4 N·m at 10 N·m/rad holds 8 mJ; set it to 400 N·m/rad at once, and it holds \
               0.32 J and shows 16 N·m. A commit is a ramp: torques keep the slew limit, θ is scaled so that stored \
               energy never rises, and |T| is at most the static limit in force at every tick. Frozen only: it is \
               what the device renders and changes while armed.",
        source: "docs/stability.md, Energy from nowhere",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention != Convention::Frozen {
                return Vec::new();
            }
            let paper = Parameters::default();
            let soft = Parameters {
                stiffness_nm_per_rad: 10.0,
                ..paper
            };
            let weak = Parameters {
                kinetic_torque_nm: 0.05,
                static_torque_nm: 0.1,
                ..paper
            };
            let presets: Vec<_> = joints().iter().map(|joint| joint.parameters).collect();
            let tour: Vec<_> = (0..60_u8)
                .map(|n| {
                    let next = presets.get(usize::from(n) % presets.len());
                    (0.05 + 0.0317 * f64::from(n), next.copied().unwrap_or(paper))
                })
                .collect();
            let one = Shaft::Constant(1.0);
            let knee = super::tools::knee(0.5);
            let cases = [
                (soft, changed(one.clone(), 0.5, &[(0.039, paper)])),
                (
                    soft,
                    changed(one.clone(), 0.5, &[(0.06, paper), (0.2, soft)]),
                ),
                (
                    paper,
                    changed(one, 0.5, &[(9.5e-4, weak), (0.1, paper), (0.118, weak)]),
                ),
                (paper, changed(knee, 2.0, &tour)),
            ];
            let limits = Limits {
                f64: 1e-12,
                f32: 1e-5,
            };
            // Torques of 1 N·m are rounded against 5 mN·m a tick.
            let beyond = Limits {
                f64: 2e-6,
                f32: 1e-3,
            };
            cases
                .map(|(first, input)| {
                    let settings = crepitus_model::Settings {
                        parameters: first,
                        ..paper_joint(subject.convention)
                    };
                    trial(
                        settings,
                        input,
                        [
                            Criterion::EnergyRise { most: limits },
                            Criterion::Slew { beyond },
                        ],
                    )
                })
                .to_vec()
        },
    },
    Case {
        id: "H37",
        name: "shaking-hand",
        title: "A hand that turns back inside every slip gets no energy for it",
        hard: "A frozen slip shows s·Tk until its time is over; a hand that turns back meanwhile would be pushed along, \
               and a sampled spring gives back more than it took. With the turn-back guard only that energy returns which \
               the spring stored and sampling generates, also with the torque one or two ticks late. An encoder's \
               staircase holds half a count more at the limit, Ts·Δ/2.",
        source: "docs/stability.md, A hand that turns back; measured with an energy observer",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention != Convention::Frozen {
                return Vec::new();
            }
            let mut trials = Vec::new();
            for preset in joints() {
                let p = preset.parameters;
                let stroke_rad = p.static_torque_nm / p.stiffness_nm_per_rad;
                let count_rad = EncoderSettings::default().rad_per_count();
                for (share, frequency_hz) in [
                    (0.9, 50.0),
                    (0.99, 7.0),
                    (1.01, 50.0),
                    (1.2, 90.0),
                    (5.0, 20.0),
                ] {
                    for delay_ticks in 0..=2 {
                        for counts in [false, true] {
                            let shake = Shake {
                                amplitude_rad: share * stroke_rad,
                                frequency_hz,
                                delay_ticks,
                                counts,
                                lost: Lost::NONE,
                            };
                            let staircase = if counts { count_rad / stroke_rad } else { 0.0 };
                            let input = Input::ShakingHand {
                                shake,
                                duration_s: 2.0,
                                step_s: TICK_S,
                            };
                            let values = p.values();
                            trials.push(trial(
                                joint(subject.convention, values),
                                input,
                                [Criterion::Returned {
                                    most: 1.0 + staircase,
                                }],
                            ));
                        }
                    }
                }
            }
            trials
        },
    },
];
