//! A shaft measured by an encoder, and one held by a hand.

use super::tools::{CASE, ENCODER, cycle_hz, encoder, is_frozen, most_hz};
use crate::stability::case::{Case, Trial, located};
use crate::stability::criteria::{
    cycle_rate, events_per_second, interval_variation, same_as, swing_ratio,
};
use crate::stability::input::{Input, Readings, Shaft, What};
use crate::stability::subject::Subject;
use crepitus_model::{Convention, Parameters};

/// Counts of 10⁴ turns of the joint: 86 motor turns each of 4 · 512.
const TEN_THOUSAND_TURNS: i32 = 10_000 * 86 * 2048;

const TEN_THOUSAND: Shaft = Shaft::Knots(&[
    (0.0, 1000.0, 1000.0),
    (62.85, 1000.0, 1000.0),
    (63.0, 1.0, 1.0),
    (65.0, 1.0, 1.0),
]);

/// A case in which `frozen` has to hold behind an encoder; the others are shown.
const BEHIND_ENCODER: Case = Case {
    must: |subject| located(subject) && is_frozen(subject),
    ..CASE
};

/// Four seconds of a joint behind an encoder at a steady speed.
fn steady(subject: Subject, omega_rad_s: f64, readings: Readings) -> Trial {
    let p = Parameters::default();
    let mut criteria = vec![
        cycle_rate(cycle_hz(&p, omega_rad_s), 1e-2),
        interval_variation(3e-2),
    ];
    if !is_frozen(subject) {
        // At most 2·f_max cycles of two events each.
        criteria.push(events_per_second(4.0 * most_hz(&p)));
    }
    encoder(Shaft::Constant(omega_rad_s), 4.0, readings).meets(criteria)
}

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H25",
        name: "counter-wrap",
        title: "The counter wraps, and the joint has made ten thousand turns",
        hard: "An angle of 10⁴ turns has steps of 4 mrad in f32, four times the whole travel of a stick: angles may \
               only travel as differences of counts, and those must survive the wrap of the counter.",
        source: "a counter of 32 bits wraps; at 1e4 rad an f32 has steps of 0.98 mrad, a whole stick",
        trials: |subject| {
            let same = |shaft: Shaft, rate_hz, duration_s, first_count| {
                let from = |first_count| Readings {
                    rate_hz,
                    first_count,
                    ..ENCODER
                };
                let plain = encoder(shaft.clone(), duration_s, from(0));
                encoder(shaft, duration_s, from(first_count)).meets([same_as(plain)])
            };
            let (up, down) = (Shaft::Constant(1.0), Shaft::Constant(-1.0));
            let mut trials = vec![
                same(up.clone(), 2e4, 1.0, i32::MAX - 1000),
                same(down, 2e4, 1.0, i32::MIN + 1000),
                same(up, 2e4, 1.0, TEN_THOUSAND_TURNS),
            ];
            if is_frozen(subject) {
                trials.push(same(TEN_THOUSAND, 1e3, 65.0, i32::MAX - 1000));
            }
            trials
        },
        ..CASE
    },
    Case {
        id: "H26",
        name: "quantised-velocity",
        title: "Ω from an encoder of 512 to 2000 lines at 1 and 20 kHz",
        hard: "One count is 36 µrad, and between two samples at 20 kHz there is mostly none: the velocity is an \
               estimate, and its slope at every count is steeper than (Ts − Tk)/J. Frozen uses Ω once a cycle. \
               Under paper and physical a slip ends where the noise meets the object's velocity, and their overlap \
               is only 0.5 % at 1 rad/s: these are shown, and not required to hold.",
        source: "closed form of the cycle; the estimator that ships, bandwidth 50 Hz",
        trials: |subject| {
            let mut trials = Vec::new();
            for lines in [512.0, 1000.0, 2000.0] {
                for rate_hz in [1e3, 2e4] {
                    let readings = Readings {
                        rate_hz,
                        lines,
                        ..ENCODER
                    };
                    trials.extend([0.1, 1.0, 3.0].map(|omega| steady(subject, omega, readings)));
                }
            }
            trials
        },
        ..BEHIND_ENCODER
    },
    Case {
        id: "H27",
        name: "jitter-and-loss",
        title: "Readings up to a tenth of a period early or late, and one in twenty lost",
        hard: "The model assumes steps of equal length. A reading late in one step is early in the \
               next: the angle stays exact, the velocity gets noise that grows with the speed. A lost reading is \
               recovered by the next one, which has travelled twice as far: angle and time stay exact, and only \
               the torque is held for a tick. At most three in a row are lost, as many as are caught up.",
        source: "closed form of the cycle; an angle that is counted is not lost with a reading",
        trials: |subject| {
            let mut trials = Vec::new();
            for lines in [512.0, 2000.0] {
                for rate_hz in [1e3, 2e4] {
                    for (jitter, lost) in [(0.1, 0.0), (0.0, 0.05), (0.1, 0.05)] {
                        let readings = Readings {
                            rate_hz,
                            lines,
                            jitter,
                            lost,
                            first_count: 0,
                        };
                        trials.push(steady(subject, 1.0, readings));
                    }
                }
            }
            trials
        },
        ..BEHIND_ENCODER
    },
    Case {
        id: "H34",
        name: "sampled-spring",
        title: "A hand on the sampled spring, damped just below and above b = K·T/2",
        hard: "A spring that is sampled and held gives back more than it took, K·T/2 worth of negative damping. \
               The cause is sampling, not the joint, and the run must agree with theory: below the \
               limit of Colgate and Schenkel the swing grows, above it decays. Physical adds the object's inertia \
               to the loop and is left out.",
        source: "Colgate and Schenkel 1997, b > K·T/2; numbers from the eigenvalues of the exact discrete loop, over 2.5 s",
        of: |subject| subject.convention != Convention::Physical,
        trials: |_| {
            let (stiffness, step_s) = (Parameters::default().stiffness_nm_per_rad, 1e-3);
            [(0.95, 1.2775), (1.05, 0.7777)]
                .map(|(share, theory)| {
                    let hand = What::Hand {
                        inertia_kg_m2: 0.0503,
                        damping_nms_per_rad: share * stiffness * step_s / 2.0,
                        // 0.56 mrad of swing: well within a stick of 1 mrad.
                        omega_rad_s: 0.05,
                    };
                    Input::new(hand, 3.0, step_s).meets([swing_ratio(theory, 0.01)])
                })
                .into()
        },
        ..CASE
    },
];
