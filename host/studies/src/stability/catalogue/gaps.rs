//! Samples lost while the joint carries a torque, and implausible velocities.

use super::tools::{CASE, FROZEN, PLAIN, TICK_S, cycle_hz, faulty, rendered, shaking, sine};
use crate::stability::case::Case;
use crate::stability::criteria::{
    BREAKS, EVENTS, cycle_rate, exactly, first_break_after, returned, slip_time, torque,
    torque_step,
};
use crate::stability::criterion::Limits;
use crate::stability::input::{Fault, Lost, Rendered, Shaft, Shake};
use crepitus_model::Parameters;
use crepitus_model::control::encoder::EncoderSettings;

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
        trials: |_| {
            [
                (1.0, 4.0),
                (1.0, 10.0),
                (-1.0, 10.0),
                (1.0, 20.0),
                (-1.0, 25.0),
            ]
            .map(|(sign, lost): (f64, f64)| {
                // Sample 100 of 190 is the first lost one; the one after the
                // gap brings travel of unknown timing.
                let fault = Fault::Gap(99.5 * TICK_S, (99.5 + lost) * TICK_S);
                let released_nm = 5e-3 * (lost - 20.0).max(0.0);
                let end_nm = sign * (2e-3 * (189.0 - lost) - released_nm);
                let end = torque(189.0 * TICK_S, end_nm, end_nm, 1e-5);
                let step = torque_step(if lost > 20.0 { 5.01e-3 } else { 2.01e-3 });
                let input = faulty(Shaft::Constant(sign * 0.1), fault, 190.0 * TICK_S);
                input.meets([exactly(EVENTS, 0), step, end])
            })
            .into()
        },
        ..CASE
    },
    Case {
        id: "H39",
        name: "losses-with-the-motion",
        title: "Every sample is lost while the shaft moves backwards",
        hard: "Losses in phase with the motion do not average out: only the forward half of each swing is sampled, \
               and an angle summed from it would diverge. Each pass winds an unloaded spring, breaks \
               once and comes to rest.",
        source: "0.9 mrad never breaks a stick that gets all samples; with half of them it winds 1.8 mrad a pass",
        trials: |_| {
            let criteria = [
                exactly(BREAKS, 3),
                // A slip ends a little beyond 2Tk − Ts = 0.
                torque(0.0, -0.01, 0.4, 1e-5),
                // 1 mrad from the turn at −0.9 mrad: sin(4π·t) = 1/9.
                first_break_after(0.126, 0.508_86, 1e-4),
            ];
            vec![faulty(sine(0.0009, 2.0), Fault::Retreating, 2.0).meets(criteria)]
        },
        ..CASE
    },
    Case {
        id: "H56",
        name: "retreat-in-a-gap",
        title: "A hand that retreats in every gap gets no energy for it",
        hard: "While samples are lost the torque is held, and pushes a hand that retreats. A stick that then begins with \
               all of that torque stores the energy a second time, gap after gap. It begins with what the spring would \
               have left, and then a gap returns no more than a spring that is sampled as rarely.",
        source: "|T′| = max(0, |T| − kr·x), model/src/render/held.rs; the bound with n ticks between two samples",
        trials: |_| {
            let p = Parameters::default();
            let stroke_rad = p.static_torque_nm / p.stiffness_nm_per_rad;
            let count_rad = EncoderSettings::default().rad_per_count();
            [(4, false), (10, true), (20, false), (25, true)]
                .map(|(ticks, counts)| {
                    // The hand turns back at 5 ms, and every 20 ms.
                    let lost = Lost {
                        ticks,
                        every: 400,
                        from_s: 0.006,
                    };
                    let shake = Shake {
                        delay_ticks: 1,
                        counts,
                        lost,
                    };
                    let staircase = if counts { count_rad / stroke_rad } else { 0.0 };
                    shaking(sine(0.0009, 50.0), shake).meets([returned(1.0 + staircase)])
                })
                .into()
        },
        ..FROZEN
    },
    Case {
        id: "H40",
        name: "velocity-outliers",
        title: "Every seventh velocity is 20 rad/s off",
        hard: "A plausible speed, but not within a tick. Unless rejected, it breaks a stick under \
               `paper` and `physical`, and lengthens a `frozen` slip that begins there by a millisecond.",
        source: "the device's limit is 10 rad/s in a tick",
        trials: |_| {
            let rate = cycle_rate(cycle_hz(&Parameters::default(), 1.0), 5e-5);
            vec![faulty(Shaft::Constant(1.0), Fault::Jumps(7), 2.0).meets([rate])]
        },
        ..CASE
    },
    Case {
        id: "H41",
        name: "encoder-bursts",
        title: "Three of every four readings of the encoder are lost",
        hard: "The next count brings the travel of four ticks. A velocity estimate that takes it for that of one is \
               four times too fast, and every slip too long.",
        source: "closed form of the cycle; the estimator that ships, bandwidth 50 Hz",
        trials: |_| {
            [0.1, 0.3, -0.3]
                .map(|omega| {
                    let device = Rendered {
                        counts: true,
                        lost: Lost {
                            ticks: 3,
                            every: 4,
                            from_s: 0.0,
                        },
                        ..PLAIN
                    };
                    let rate = cycle_rate(cycle_hz(&Parameters::default(), omega), 1e-2);
                    rendered(Shaft::Constant(omega), 4.0, device).meets([rate])
                })
                .into()
        },
        ..FROZEN
    },
    Case {
        id: "H42",
        name: "late-estimate",
        title: "A stick breaks backwards while the estimated velocity still goes forwards",
        hard: "The angle is exact, the velocity 3 ms late. Eqs. (10) and (11) take the velocity in the slip's sense: \
               against it the slip lasts half a period, and with |Ω| nearly a whole one.",
        source: "ωn·t = 2(π − atan2(Ts − Tk, max(0, s·Ω)·√(J·kr))): π/ωn for s·Ω ≤ 0",
        trials: |_| {
            let device = Rendered {
                counts: true,
                ..PLAIN
            };
            let half_s = std::f64::consts::PI / Parameters::default().natural_rad_s();
            let slip = slip_time(half_s, Limits(1e-9, 1e-6));
            let input = rendered(Shaft::Knots(BACK), 0.05, device);
            vec![input.meets([slip, exactly(EVENTS, 2)])]
        },
        ..FROZEN
    },
];
