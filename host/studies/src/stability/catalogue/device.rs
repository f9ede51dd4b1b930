//! A joint in a device: invalid samples, parameters that change during a run,
//! and a hand that turns back.

use super::tools::{CASE, FROZEN, TICK_S, changed, cycle_hz, faulty, knee, shaking, sine};
use crate::stability::case::Case;
use crate::stability::criteria::{
    BREAKS, count, cycle_rate, energy_rise, first_break_after, returned, silent_after, slew,
    torque, torque_step,
};
use crate::stability::criterion::Limits;
use crate::stability::input::{Fault, Lost, Shaft, Shake};
use crepitus_model::Parameters;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::parameters::Tabled;
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
        trials: |_| {
            let run = |fault, duration_s| faulty(Shaft::Constant(1.0), fault, duration_s);
            // A tick or two over the whole run.
            let rate = || [cycle_rate(cycle_hz(&Parameters::default(), 1.0), 5e-5)];
            // 20 ticks, and at most 0.4 N·m at 5 mN·m a tick.
            let silent = torque(1.0 + 101.0 * TICK_S, 0.0, 0.0, 0.0);
            vec![
                run(Fault::Impossible(7), 2.0).meets(rate()),
                run(Fault::Impossible(2), 2.0).meets(rate()),
                run(Fault::Blind(1.0), 1.5).meets([silent, silent_after(1.0)]),
            ]
        },
        ..CASE
    },
    Case {
        id: "H28",
        name: "gap",
        title: "No sample for a tenth of a second while the shaft moves on",
        hard: "The shaft's motion meanwhile is unknown. The torque has been ramped down; the joint continues in a new \
               stick that begins with the torque then shown. Later events are those of a joint \
               that was started there.",
        source: "model/src/render/held.rs: no torque step above Ts − (2Tk − Ts), a valid phase at the end",
        trials: |_| {
            let p = Parameters::default();
            // 31.8 a second for 1.9 s, and one more or less at the gap.
            let breaks = count(BREAKS, 60, 62);
            // Restarted at 0.6 s with an unloaded spring: 0.4 N·m later it breaks.
            let at_s = 0.6 + p.static_torque_nm / p.stiffness_nm_per_rad;
            let first = first_break_after(0.500_1, at_s, Limits(1e-9, 1e-6));
            let step = torque_step(p.static_torque_nm - p.restart_torque_nm());
            let input = faulty(Shaft::Constant(1.0), Fault::Gap(0.5, 0.6), 2.0);
            vec![input.meets([step, breaks, first])]
        },
        ..CASE
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
        trials: |_| {
            let paper = Parameters::default();
            let soft = Parameters::of([0.01, 10.0, 0.0, 0.2, 0.4]);
            let weak = Parameters::of([0.01, 400.0, 0.0, 0.05, 0.1]);
            let presets: Vec<_> = joints().iter().map(|joint| joint.parameters).collect();
            let tour: Vec<_> = (0..60_u8)
                .zip(presets.into_iter().cycle())
                .map(|(n, next)| (0.05 + 0.0317 * f64::from(n), next))
                .collect();
            let weak_twice = [(9.5e-4, weak), (0.1, paper), (0.118, weak)];
            let one = Shaft::Constant(1.0);
            [
                (soft, changed(one.clone(), 0.5, &[(0.039, paper)])),
                (
                    soft,
                    changed(one.clone(), 0.5, &[(0.06, paper), (0.2, soft)]),
                ),
                (paper, changed(one, 0.5, &weak_twice)),
                (paper, changed(knee(0.5), 2.0, &tour)),
            ]
            .map(|(first, input)| {
                let rise = energy_rise(Limits(1e-12, 1e-5));
                // Torques of 1 N·m are rounded against 5 mN·m a tick.
                let trial = input.meets([rise, slew(Limits(2e-6, 1e-3))]);
                trial.with(first.values())
            })
            .into()
        },
        ..FROZEN
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
        trials: |_| {
            const SHAKES: [(f64, f64); 5] = [
                (0.9, 50.0),
                (0.99, 7.0),
                (1.01, 50.0),
                (1.2, 90.0),
                (5.0, 20.0),
            ];
            let count_rad = EncoderSettings::default().rad_per_count();
            let mut trials = Vec::new();
            for p in joints().iter().map(|joint| joint.parameters) {
                let stroke_rad = p.static_torque_nm / p.stiffness_nm_per_rad;
                for (share, frequency_hz) in SHAKES {
                    for (delay_ticks, counts) in (0..=2).flat_map(|d| [(d, false), (d, true)]) {
                        let shake = Shake {
                            delay_ticks,
                            counts,
                            lost: Lost::NONE,
                        };
                        let staircase = if counts { count_rad / stroke_rad } else { 0.0 };
                        let input = shaking(sine(share * stroke_rad, frequency_hz), shake);
                        let trial = input.meets([returned(1.0 + staircase)]);
                        trials.push(trial.with(p.values()));
                    }
                }
            }
            trials
        },
        ..FROZEN
    },
];
