//! A shaft that turns back, jumps, stops and brakes.

use super::motions::{DWELL, STOP, THROUGH_ZERO, VELOCITY_JUMPS};
use super::tools::{CASE, LOCATED, SAMPLED, at_tick, is_frozen, knee, knots, most_hz, sine};
use crate::stability::case::Case;
use crate::stability::criteria::{
    EVENTS, REVERSES, event_torques, events, events_per_second, events_per_step, exactly,
    loop_area, no_break_at_rest, silent_after, slips_with_shaft, torque_returns,
};
use crate::stability::criterion::Limits;
use crepitus_model::{Convention, Parameters};

/// Tolerance of the torque after an event on a motion that the steps describe exactly, N·m.
const TORQUE: Limits = Limits(1e-9, 1e-4);

const SLOPES: [&[(f64, f64, f64)]; 3] = [
    &[(0.0, 3.15, 3.15), (0.3, -3.15, -3.15), (0.4, -3.15, -3.15)],
    &[(0.0, 3.1, 3.1), (0.2, -3.1, -3.1), (0.4, -3.1, -3.1)],
    &[(0.0, 5.0, 5.0), (0.01, -5.0, -5.0), (0.4, -5.0, -5.0)],
];

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H04",
        name: "dwell",
        title: "Dwells at exactly zero speed, then turns back",
        hard: "Ω = 0 is neither sign: a slip that runs on must end by itself, a stick must hold, and the first \
               movement after the dwell decides the sense.",
        source: "tests/reference-cases, x22 and x22z, with 50 digits",
        trials: |_| vec![knots(DWELL, 1.1).meets([events(LOCATED), no_break_at_rest()])],
        ..CASE
    },
    Case {
        id: "H05",
        name: "reversal-in-stick",
        title: "Turns back inside a stick, and never leaves it",
        hard: "In a stick the object follows by position. One that integrates velocity drifts, and its loop of \
               torque over angle does not close; near the limit the turn can be a break and its undoing in one step.",
        source: "tests/reference-cases, r11 and p12, with 50 digits",
        trials: |subject| {
            // Ω̇ is known as the slope of a step, so the inertia's part of a
            // `physical` torque is half a step old: J·max|Ω̈|·h/2 = 5.6e-8.
            let rounding = match subject.convention {
                Convention::Physical => 1e-7,
                _ => 1e-12,
            };
            let closes = [
                exactly(EVENTS, 0),
                torque_returns(Limits(rounding, 1e-6)),
                loop_area(1e-12),
            ];
            vec![
                at_tick(sine(0.003, 1.0), 3.0).meets([events(SAMPLED), exactly(EVENTS, 47)]),
                at_tick(sine(0.0009, 1.0), 3.0).meets(closes),
            ]
        },
        ..CASE
    },
    Case {
        id: "H06",
        name: "velocity-jumps",
        title: "Ω jumps by half a radian per second",
        hard: "A jump breaks a stick whatever its torque, and can reverse a slip at once; \
               the event belongs to the instant of the jump and the torque to the new sense.",
        source: "tests/reference-cases, q10, q10p and q10z, with 50 digits",
        trials: |_| {
            let criteria = [events(LOCATED), event_torques(TORQUE)];
            vec![knots(VELOCITY_JUMPS, 1.0).meets(criteria)]
        },
        ..CASE
    },
    Case {
        id: "H07",
        name: "through-zero",
        title: "Ω passes zero during a slip",
        hard: "Friction follows the velocity relative to the object, not the shaft's: a method that uses the sign of Ω \
               reverses the torque too early.",
        source: "tests/reference-cases, t09, with 50 digits",
        trials: |subject| {
            let mut criteria = vec![events(LOCATED), event_torques(TORQUE)];
            // Under `frozen` the object's velocity decides nothing.
            if !is_frozen(subject) {
                criteria.push(slips_with_shaft(Limits(1e-12, 1e-6)));
            }
            vec![knots(THROUGH_ZERO, 0.6).meets(criteria)]
        },
        ..CASE
    },
    Case {
        id: "H16",
        name: "fast-swing",
        title: "45° at 2 Hz: the inertia alone exceeds Ts",
        hard: "J·Ω̇ is above Ts from the first instant, so there is no stick to start from, and a velocity match \
               needs three times the static limit: it must reverse, and never show that torque.",
        source: "tests/reference-cases, f19 and f19s, with 50 digits",
        trials: |subject| {
            let mut criteria = vec![events(SAMPLED)];
            if subject.convention == Convention::Physical {
                criteria.push(exactly(REVERSES, 3));
            }
            let at_speed = sine(std::f64::consts::FRAC_PI_4, 2.0);
            vec![
                at_tick(knee(2.0), 1.0).meets(criteria),
                at_tick(at_speed, 1.0).meets([events(SAMPLED)]),
            ]
        },
        ..CASE
    },
    Case {
        id: "H17",
        name: "sudden-stop",
        title: "1 rad/s stops within 50 ms",
        hard: "The object keeps √(J·kr)·Ω = 2 N·m of swing, and a stick after the match needs 1.6 N·m, four times Ts. \
               What is shown must stay within Ts, and the ringing must end.",
        source: "tests/reference-cases, g20 and g20z, with 50 digits",
        trials: |subject| {
            let mut criteria = vec![events(LOCATED)];
            let slip_s = std::f64::consts::TAU / Parameters::default().natural_rad_s();
            criteria.extend(match subject.convention {
                // At most one slip outlasts the motion.
                Convention::Frozen => Some(silent_after(1.05 + slip_s)),
                Convention::Physical => Some(silent_after(1.0922)),
                Convention::Paper => None,
            });
            vec![knots(STOP, 2.0).meets(criteria)]
        },
        ..CASE
    },
    Case {
        id: "H18",
        name: "hard-braking",
        title: "The hand brakes harder than (Ts − Tk)/J = 20 rad/s²",
        hard: "The paper's torque leaves the inertia out, so a stick breaks although the object would at once be \
               faster than the shaft: it sticks again in the same instant, without end (Zeno). An encoder's \
               velocity decelerates that much at every count.",
        source: "J·Ω̇ against Ts − Tk in eq. (7)",
        of: |subject| subject.convention == Convention::Paper,
        trials: |_| {
            let rate = || events_per_second(2.0 * most_hz(&Parameters::default()) + 2.0);
            SLOPES
                .map(|slope| knots(slope, 0.4).meets([events_per_step(4), rate()]))
                .into()
        },
        ..CASE
    },
];
