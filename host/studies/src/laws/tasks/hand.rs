//! A hand that rests on a leg, coupled to the device.
//!
//! ```text
//! I·φ̈ = −B·φ̇ − K·φ − T(held)        leg and arm; the hand holds them where they are
//!
//! tick n: the law gets the motion of the tick; its torque acts from tick n + 1 to n + 2
//! ```
//!
//! The leg is struck, so that it swings by 0.3·Ts on the stick's spring: Ω₀ = 0.3·Ts/√(kr·I).
//!
//! Known: friction gives nothing. So the energy that the law has given to the leg, −∫T·Ω dt, is never
//! above zero. And a delay of 1.5 ticks lets a spring oscillate beyond a stiffness of a closed form,
//! [`onset_nm_per_rad`]: a law is quiet up to there, and in a larger one if it damps. As long as it sticks it holds the leg, which
//! swings with the frequency of a spring; a law without a stick would be quiet, and let it go.
//!
//! The numbers of the arm are those of the effect `hand`; the leg has no inertia of its own here, which
//! is the harder case.

use crate::laws::closed_forms::{Leg, onset_nm_per_rad};
use crate::laws::cycles::Frequency;
use crate::laws::runner::{Runner, TICK_S, between};
use crate::laws::task::{Demand, Prepared, Quantity, Reading, Setting, Task, Use};
use crate::watcher::StudyError;
use crepitus_model::{Parameters, SettingsError};
use std::f64::consts::TAU;

/// The task.
pub struct Rest;

/// The arm of the effect `hand` at its lever.
pub const ARM: Leg = Leg {
    inertia_kg_m2: 0.554 * 0.35 * 0.35,
    damping_nms_per_rad: 6.45 * 0.35 * 0.35,
    stiffness_nm_per_rad: 135.0 * 0.35 * 0.35,
};

/// Torque of the first swing on the stick's spring, in shares of Ts.
const STRIKE_SHARE: f64 = 0.3;
/// Largest factor on the stiffness that is tried.
const MOST_FACTOR: f64 = 1000.0;
/// Bisections of the factor: to 0.4 %.
const BISECTIONS: u32 = 11;
/// Length of a run whose growth is judged, ticks.
const JUDGED_TICKS: u32 = 12_000;

const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "hand-energy",
        title: "energy that the law has given to a leg with a hand on it, at most",
        unit: "J",
        demands: "friction gives no energy",
        of: Use::Coupled,
    },
    Quantity {
        name: "hand-onset",
        title: "largest factor on the stiffness at which a leg with a hand on it stays quiet",
        unit: "1",
        demands: "at least where a spring whose torque is 1.5 ticks late begins to oscillate",
        of: Use::Coupled,
    },
    Quantity {
        name: "hand-swing",
        title: "frequency of the first swings of a struck leg",
        unit: "Hz",
        demands: "a stick holds the leg as a spring: √((kr + K)/I − (B/2I)²)/2π",
        of: Use::Coupled,
    },
];

impl Task for Rest {
    fn name(&self) -> &'static str {
        "hand"
    }

    fn title(&self) -> &'static str {
        "a hand that rests on the coupled leg"
    }

    fn quantities(&self) -> &'static [Quantity] {
        QUANTITIES
    }

    fn prepare(&self, setting: &Setting) -> Result<Box<dyn Prepared>, StudyError> {
        Ok(Box::new(Coupled {
            joint: setting.joint.parameters,
            energy_ticks: setting.or_quick(100_000, 20_000),
        }))
    }
}

struct Coupled {
    joint: Parameters,
    energy_ticks: u32,
}

impl Prepared for Coupled {
    fn demanded(&self) -> Vec<Demand> {
        let strike = STRIKE_SHARE * self.joint.static_torque_nm;
        let onset = onset_nm_per_rad(&ARM, 1.5 * TICK_S);
        vec![
            // Beside the energy of the strike.
            Demand::none_of(0.5 * strike * strike / self.joint.stiffness_nm_per_rad),
            Demand::at_least(onset / self.joint.stiffness_nm_per_rad),
            Demand::itself(self.swing_hz()),
        ]
    }

    fn refinements(&self) -> &[u32] {
        &[2, 8]
    }

    fn measure(&self, runner: &Runner<'_>) -> Result<Vec<Reading>, SettingsError> {
        let struck = Self::struck(runner, &self.joint, self.energy_ticks)?;
        Ok(vec![
            Reading::of(struck.given_j),
            self.onset(runner)?,
            Reading::but(
                struck.swing_hz,
                struck.swing_hz == 0.0,
                "does not hold the leg: it does not swing back",
            ),
        ])
    }
}

/// Observations of a struck leg.
#[derive(Clone, Copy, Debug, Default)]
struct Struck {
    /// Energy given by the law, at most, J.
    given_j: f64,
    /// Largest torque in the second half, N·m.
    late_nm: f64,
    /// Largest velocity in the second and in the last quarter, rad/s.
    early_rad_s: f64,
    late_rad_s: f64,
    /// Frequency of the first swings, by the times at which the leg turns back, Hz; 0 without.
    swing_hz: f64,
}

/// Turns by which the frequency of swings is measured: two whole swings.
const TURNS: u32 = 5;

impl Coupled {
    fn swing_hz(&self) -> f64 {
        let stiffness = self.joint.stiffness_nm_per_rad + ARM.stiffness_nm_per_rad;
        let decay = 0.5 * ARM.damping_nms_per_rad / ARM.inertia_kg_m2;
        (stiffness / ARM.inertia_kg_m2 - decay * decay).sqrt() / TAU
    }

    fn onset(&self, runner: &Runner<'_>) -> Result<Reading, SettingsError> {
        let is_quiet = |factor: f64| -> Result<bool, SettingsError> {
            let joint = Parameters {
                stiffness_nm_per_rad: factor * self.joint.stiffness_nm_per_rad,
                ..self.joint
            };
            let seen = Self::struck(runner, &joint, JUDGED_TICKS)?;
            // One that has grown until the law breaks grows no further.
            let is_held = seen.late_nm <= 2.0 * STRIKE_SHARE * joint.static_torque_nm;
            Ok(is_held && seen.late_rad_s <= seen.early_rad_s)
        };
        if !is_quiet(1.0)? {
            return Ok(Reading::but(
                0.0,
                true,
                "a leg with a hand on it oscillates",
            ));
        }
        let (mut low, mut high) = (1.0, MOST_FACTOR);
        for _ in 0..BISECTIONS {
            let middle = f64::sqrt(low * high);
            // Where the law refuses the joint, it is not quiet.
            if is_quiet(middle).unwrap_or(false) {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(Reading::of(low))
    }

    fn struck(
        runner: &Runner<'_>,
        joint: &Parameters,
        ticks: u32,
    ) -> Result<Struck, SettingsError> {
        let strike = STRIKE_SHARE * joint.static_torque_nm;
        let omega = strike / (joint.stiffness_nm_per_rad * ARM.inertia_kg_m2).sqrt();
        let mut ride = runner.start_with(joint, omega)?;
        let (mut pose, mut acting_nm) = ((0.0, omega), 0.0);
        let (mut seen, mut given_j) = (Struck::default(), 0.0);
        let mut turns = Frequency::default();
        for n in 0..ticks {
            let next = ARM.moved(pose, acting_nm);
            given_j -= acting_nm * (next.0 - pose.0);
            seen.given_j = seen.given_j.max(given_j);
            // What the law had shown by the beginning of this tick acts in the next.
            acting_nm = ride.torque_nm;
            ride.tick(&between(pose, next));
            if pose.1 * next.1 < 0.0 && turns.count() < TURNS {
                // Linear between the ticks.
                turns.add(f64::from(n) + pose.1 / (pose.1 - next.1));
            }
            pose = next;
            let quarter = 4 * n / ticks;
            if quarter >= 2 {
                seen.late_nm = seen.late_nm.max(ride.torque_nm.abs());
            }
            if quarter == 1 {
                seen.early_rad_s = seen.early_rad_s.max(pose.1.abs());
            } else if quarter == 3 {
                seen.late_rad_s = seen.late_rad_s.max(pose.1.abs());
            }
        }
        if turns.count() == TURNS {
            // Two turns are a swing.
            seen.swing_hz = 0.5 * turns.hz() / TICK_S;
        }
        Ok(seen)
    }
}

impl Leg {
    /// The leg a tick later under a constant torque of the device, by one step of the classical Runge-Kutta
    /// method: its poles are far slower than a tick.
    fn moved(&self, (x, v): (f64, f64), torque_nm: f64) -> (f64, f64) {
        let slope = |x: f64, v: f64| {
            let pull = -self.damping_nms_per_rad * v - self.stiffness_nm_per_rad * x;
            (v, (pull - torque_nm) / self.inertia_kg_m2)
        };
        let h = TICK_S;
        let a = slope(x, v);
        let b = slope(x + 0.5 * h * a.0, v + 0.5 * h * a.1);
        let c = slope(x + 0.5 * h * b.0, v + 0.5 * h * b.1);
        let d = slope(x + h * c.0, v + h * c.1);
        (
            x + h / 6.0 * (a.0 + 2.0 * (b.0 + c.0) + d.0),
            v + h / 6.0 * (a.1 + 2.0 * (b.1 + c.1) + d.1),
        )
    }
}
