//! Answer of `reference` to a case: its events, and the worst breach of the
//! sign law.
//!
//! ```text
//! s·(Ω − θ̇) ≥ 0 in every slip of `paper` and `physical`
//! ```
//! The law is what the energy balance cannot see: friction that pushes along
//! the shaft. It is checked between the events, at evenly spaced times, by
//! what the solver offers to everybody. A breach is counted in roundings,
//!
//! ```text
//! 2⁻⁵³·(|Ω| + R + t·(|Ω̇| + (ωn + c/J)·R)),   R = √(θ̇² + ωn²·(θ − s·Tk/kr)²)
//! ```
//! the rounding of both velocities and of the time at which they are asked
//! for.

use crate::corpus::{Case, MOST_EVENTS};
use crepitus_model::{Convention, Event, Phase};
use crepitus_scene::reference::Reference;

/// Samples of the law between two events.
const SAMPLES: u32 = 12;
/// Largest allowed breach, in roundings.
pub const LAW_ROUNDINGS: f64 = 256.0;

/// All that is asked of `reference`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Theirs {
    /// First events of `reference`; `fraction` is the time, s.
    pub events: Vec<Event<f64>>,
    /// The worst breach of the sign law, in roundings; 0 where there is none.
    pub breach: f64,
    /// Time of the worst breach, s.
    pub breach_s: f64,
}

impl Theirs {
    /// Runs `reference` on a case.
    pub fn of(case: &Case) -> Self {
        let mut events = Vec::new();
        Reference::new(&case.settings, &case.motion).advance(case.duration_s, |event| {
            if events.len() < MOST_EVENTS {
                events.push(event);
            }
        });
        let mut theirs = Self {
            events,
            ..Self::default()
        };
        if case.settings.convention != Convention::Frozen {
            theirs.check_law(case);
        }
        theirs
    }

    fn check_law(&mut self, case: &Case) {
        let mut reference = Reference::new(&case.settings, &case.motion);
        let mut from_s = 0.0;
        let ends: Vec<f64> = (self.events.iter().map(|e| e.fraction))
            .chain((self.events.len() < MOST_EVENTS).then_some(case.duration_s))
            .collect();
        for end_s in ends {
            for i in 0..SAMPLES {
                let share = (f64::from(i) + 0.5) / f64::from(SAMPLES);
                let time_s = from_s + (end_s - from_s) * share;
                reference.advance(time_s, |_| {});
                let breach = breach(case, &reference, time_s);
                if breach > self.breach {
                    (self.breach, self.breach_s) = (breach, time_s);
                }
            }
            from_s = end_s;
        }
    }
}

/// Returns the breach of the sign law now, in roundings.
fn breach(case: &Case, reference: &Reference<'_>, time_s: f64) -> f64 {
    let Phase::Slip(sense) = reference.phase() else {
        return 0.0;
    };
    let p = &case.settings.parameters;
    let shaft = reference.shaft();
    let v = reference.theta_dot_rad_s();
    let x = reference.theta_rad() - sense.of_signed(p.kinetic_torque_nm / p.stiffness_nm_per_rad);
    let natural = p.natural_rad_s();
    let reach = v.hypot(natural * x);
    let rate = natural + p.damping_nms_per_rad / p.inertia_kg_m2;
    let size = shaft.omega_rad_s.abs() + reach + time_s * (shaft.omega_dot.abs() + rate * reach);
    let lead = sense.of_signed(shaft.omega_rad_s - v);
    if size > 0.0 {
        (-lead / (f64::EPSILON / 2.0 * size)).max(0.0)
    } else {
        0.0
    }
}
