//! Samples lost while the joint carries a torque, and implausible velocities.

use super::tools::{TICK_S, cycle_hz, exactly, faulty, paper_joint, rendered, sine, trial};
use crate::stability::case::{Case, located};
use crate::stability::criterion::{Counted, Criterion, Limits};
use crate::stability::input::{Fault, Input, Lost, Rendered, Shaft, Shake};
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::{Convention, Parameters};

// 0.5 mrad forwards, and 1.5 mrad back before the estimate has turned.
const BACK: &[(f64, f64, f64)] = &[
    (0.0, 0.5, 0.5),
    (0.001, 0.5, -5.0),
    (0.001_4, -5.0, 0.0),
    (0.05, 0.0, 0.0),
];

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H38",
        name: "gap-under-load",
        title: "4 to 25 samples lost in the middle of a stick",
        hard: "Too many to catch up: the joint is restarted with the held torque and on a shaft that \
               moves. From 0 N·m instead the hand feels a blow, and a joint that is restarted at rest takes the shaft's \
               next velocity for a jump and breaks.",
        source: "model/src/render/held.rs: held for 20 ticks, then 100 N·m/s; 400 N·m/rad · 0.1 rad/s is 2 mN·m a tick",
        long: false,
        must: located,
        trials: |subject| {
            let settings = paper_joint(subject.convention);
            let mut trials = Vec::new();
            for (sign, lost) in [(1.0, 4_u32), (1.0, 10), (-1.0, 10), (1.0, 20), (-1.0, 25)] {
                // Sample 100 of 190 is the first lost one; the one after the
                // gap brings travel of unknown timing.
                let lost = f64::from(lost);
                let fault = Fault::Gap {
                    from_s: 99.5 * TICK_S,
                    to_s: (99.5 + lost) * TICK_S,
                };
                let released_nm = 5e-3 * (lost - 20.0).max(0.0);
                let end_nm = sign * (2e-3 * (189.0 - lost) - released_nm);
                let end = Criterion::TorqueWithin {
                    from_s: 189.0 * TICK_S,
                    low_nm: end_nm,
                    high_nm: end_nm,
                    slack_nm: 1e-5,
                };
                let most_nm = if lost > 20.0 { 5.01e-3 } else { 2.01e-3 };
                let criteria = [
                    exactly(Counted::Events, 0),
                    Criterion::TorqueStep { most_nm },
                    end,
                ];
                let input = faulty(Shaft::Constant(sign * 0.1), fault, 190.0 * TICK_S);
                trials.push(trial(settings, input, criteria));
            }
            trials
        },
    },
    Case {
        id: "H39",
        name: "losses-with-the-motion",
        title: "Every sample is lost while the shaft moves backwards",
        hard: "Losses in phase with the motion do not average out: only the forward half of each swing is sampled, \
               and an angle summed from it would diverge. Each pass winds an unloaded spring, breaks \
               once and comes to rest.",
        source: "0.9 mrad never breaks a stick that gets all samples; with half of them it winds 1.8 mrad a pass",
        long: false,
        must: located,
        trials: |subject| {
            let input = faulty(sine(0.0009, 2.0), Fault::Retreating, 2.0);
            let criteria = [
                exactly(Counted::Breaks, 3),
                Criterion::TorqueWithin {
                    from_s: 0.0,
                    // A slip ends a little beyond 2Tk − Ts = 0.
                    low_nm: -0.01,
                    high_nm: 0.4,
                    slack_nm: 1e-5,
                },
                // 1 mrad from the turn at −0.9 mrad: sin(4π·t) = 1/9.
                Criterion::FirstBreakAfter {
                    from_s: 0.126,
                    at_s: 0.508_86,
                    within_s: Limits::both(1e-4),
                },
            ];
            vec![trial(paper_joint(subject.convention), input, criteria)]
        },
    },
    Case {
        id: "H56",
        name: "retreat-in-a-gap",
        title: "A hand that retreats in every gap gets no energy for it",
        hard: "While samples are lost the torque is held, and pushes a hand that retreats. A stick that then begins with \
               all of that torque stores the energy a second time, gap after gap. It begins with what the spring would \
               have left, and then a gap returns no more than a spring that is sampled as rarely.",
        source: "|T′| = max(0, |T| − kr·x), model/src/render/held.rs; the bound with n ticks between two samples",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention != Convention::Frozen {
                return Vec::new();
            }
            let p = Parameters::default();
            let stroke_rad = p.static_torque_nm / p.stiffness_nm_per_rad;
            let mut trials = Vec::new();
            for (ticks, counts) in [(4, false), (10, true), (20, false), (25, true)] {
                let shake = Shake {
                    amplitude_rad: 0.0009,
                    frequency_hz: 50.0,
                    delay_ticks: 1,
                    counts,
                    // The hand turns back at 5 ms, and every 20 ms.
                    lost: Lost {
                        ticks,
                        every: 400,
                        from_s: 0.006,
                    },
                };
                let count_rad = EncoderSettings::default().rad_per_count();
                let staircase = if counts { count_rad / stroke_rad } else { 0.0 };
                let input = Input::ShakingHand {
                    shake,
                    duration_s: 2.0,
                    step_s: TICK_S,
                };
                let most = 1.0 + staircase;
                let returned = Criterion::Returned { most };
                trials.push(trial(paper_joint(subject.convention), input, [returned]));
            }
            trials
        },
    },
    Case {
        id: "H40",
        name: "velocity-outliers",
        title: "Every seventh velocity is 20 rad/s off",
        hard: "A plausible speed, but not within a tick. Unless rejected, it breaks a stick under \
               `paper` and `physical`, and lengthens a `frozen` slip that begins there by a millisecond.",
        source: "the device's limit is 10 rad/s in a tick",
        long: false,
        must: located,
        trials: |subject| {
            let settings = paper_joint(subject.convention);
            let hz = cycle_hz(&settings.parameters, 1.0);
            let rate = Criterion::CycleRate {
                hz,
                within: Limits::both(5e-5),
            };
            let input = faulty(Shaft::Constant(1.0), Fault::Jumps { every: 7 }, 2.0);
            vec![trial(settings, input, [rate])]
        },
    },
    Case {
        id: "H41",
        name: "encoder-bursts",
        title: "Three of every four readings of the encoder are lost",
        hard: "The next count brings the travel of four ticks. A velocity estimate that takes it for that of one is \
               four times too fast, and every slip too long.",
        source: "closed form of the cycle; the estimator that ships, bandwidth 50 Hz",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention != Convention::Frozen {
                return Vec::new();
            }
            [0.1, 0.3, -0.3]
                .map(|omega| {
                    let lost = Lost {
                        ticks: 3,
                        every: 4,
                        from_s: 0.0,
                    };
                    let input = Input::Rendered(Rendered {
                        counts: true,
                        lost,
                        ..rendered(Shaft::Constant(omega), 4.0)
                    });
                    let rate = Criterion::CycleRate {
                        hz: cycle_hz(&Parameters::default(), omega),
                        within: Limits::both(1e-2),
                    };
                    trial(paper_joint(subject.convention), input, [rate])
                })
                .to_vec()
        },
    },
    Case {
        id: "H42",
        name: "late-estimate",
        title: "A stick breaks backwards while the estimated velocity still goes forwards",
        hard: "The angle is exact, the velocity 3 ms late. Eqs. (10) and (11) take the velocity in the slip's sense: \
               against it the slip lasts half a period, and with |Ω| nearly a whole one.",
        source: "ωn·t = 2(π − atan2(Ts − Tk, max(0, s·Ω)·√(J·kr))): π/ωn for s·Ω ≤ 0",
        long: false,
        must: located,
        trials: |subject| {
            if subject.convention != Convention::Frozen {
                return Vec::new();
            }
            let settings = paper_joint(subject.convention);
            let input = Input::Rendered(Rendered {
                counts: true,
                ..rendered(Shaft::Knots(BACK), 0.05)
            });
            let slip = Criterion::SlipTime {
                slip_s: std::f64::consts::PI / settings.parameters.natural_rad_s(),
                within: Limits {
                    f64: 1e-9,
                    f32: 1e-6,
                },
            };
            vec![trial(settings, input, [slip, exactly(Counted::Events, 2)])]
        },
    },
];
