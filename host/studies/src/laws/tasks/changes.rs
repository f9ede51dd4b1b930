//! Parameters that change while the law runs: Ts and Tk to 0.7 of what they were, kr to 1.2.
//!
//! The shaft is dragged with 0.1 rad/s. Once the change comes in a stick, as the torque rises through
//! 0.5·Ts, where it is below the new Ts; once in a slip, a quarter of a natural period after a
//! break. A law without cycles is changed after 1 s.
//!
//! Known: the torque goes on from where it is, so that at the change it moves by no more than the new
//! kr·Ω·h of a stick; in the stick, the new Ts is reached (0.95·Ts' − T)/(kr'·Ω) later.

use crate::laws::runner::{Ride, Runner, TICK_S};
use crate::laws::task::{Demand, Prepared, Quantity, Reading, Setting, Task, Use};
use crate::watcher::StudyError;
use crepitus_model::{Parameters, SettingsError};
use std::f64::consts::TAU;

/// The task.
pub struct Change;

/// Velocity of the shaft, rad/s.
const OMEGA_RAD_S: f64 = 0.1;
/// A law has swung in, s.
const SETTLED_S: f64 = 0.5;
/// A law without cycles is changed then, s.
const LATEST_S: f64 = 1.0;
/// Time within which the new limit is reached, s.
const WAITED_S: f64 = 0.5;
/// Torque at which a stick is changed, in shares of Ts.
const AT_SHARE: f64 = 0.5;
/// Torque at which the new limit counts as reached.
const REACHED_SHARE: f64 = 0.95;

const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "change-jump-stick",
        title: "change of torque in the tick after the parameters change in a stick",
        unit: "N·m",
        demands: "the torque goes on from where it is, with the new kr·Ω·h",
        of: Use::Running,
    },
    Quantity {
        name: "change-jump-slip",
        title: "change of torque in the tick after the parameters change in a slip",
        unit: "N·m",
        demands: "the torque goes on from where it is",
        of: Use::Running,
    },
    Quantity {
        name: "change-time",
        title: "time until the new Ts is reached, after the parameters change in a stick",
        unit: "s",
        demands: "(0.95·Ts' − 0.5·Ts)/(kr'·Ω): a stick loads on",
        of: Use::Running,
    },
];

impl Task for Change {
    fn name(&self) -> &'static str {
        "changes"
    }

    fn title(&self) -> &'static str {
        "parameters that change while running"
    }

    fn quantities(&self) -> &'static [Quantity] {
        QUANTITIES
    }

    fn prepare(&self, setting: &Setting) -> Result<Box<dyn Prepared>, StudyError> {
        let before = setting.joint.parameters;
        Ok(Box::new(Changed {
            before,
            after: Parameters {
                static_torque_nm: 0.7 * before.static_torque_nm,
                kinetic_torque_nm: 0.7 * before.kinetic_torque_nm,
                stiffness_nm_per_rad: 1.2 * before.stiffness_nm_per_rad,
                ..before
            },
        }))
    }
}

struct Changed {
    before: Parameters,
    after: Parameters,
}

impl Prepared for Changed {
    fn demanded(&self) -> Vec<Demand> {
        let scale = self.before.static_torque_nm;
        let rate = self.after.stiffness_nm_per_rad * OMEGA_RAD_S;
        let to_load_nm =
            REACHED_SHARE * self.after.static_torque_nm - AT_SHARE * self.before.static_torque_nm;
        vec![
            Demand::beside(rate * TICK_S, scale),
            Demand::none_of(scale),
            Demand::itself(to_load_nm / rate),
        ]
    }

    fn refinements(&self) -> &[u32] {
        &[8, 32]
    }

    fn measure(&self, runner: &Runner<'_>) -> Result<Vec<Reading>, SettingsError> {
        const NO_STICK: &str = "no stick to change in";
        const NO_SLIP: &str = "no slip to change in";
        let (in_stick, mut ride, stick_nm) = self.changed(runner, In::Stick)?;
        // The rest of the way to the new limit; the tick after the change is counted.
        let reached_nm = REACHED_SHARE * self.after.static_torque_nm;
        let waited = ride.turn(OMEGA_RAD_S, WAITED_S * OMEGA_RAD_S, |nm| nm >= reached_nm);
        let time = waited.map_or(
            Reading::failed("does not load to the new Ts"),
            |travel_rad| Reading::of(TICK_S + travel_rad / OMEGA_RAD_S),
        );
        let (in_slip, _, slip_nm) = self.changed(runner, In::Slip)?;
        let time = if in_stick {
            time
        } else {
            Reading::failed(NO_STICK)
        };
        Ok(vec![
            Reading::but(stick_nm, !in_stick, NO_STICK),
            Reading::but(slip_nm, !in_slip, NO_SLIP),
            time,
        ])
    }
}

/// Phase in which the parameters change.
#[derive(Clone, Copy, PartialEq, Eq)]
enum In {
    Stick,
    Slip,
}

impl Changed {
    /// Drags the law until the phase comes, and changes it. Returns whether the phase came, the ride one tick
    /// later, and the change of the torque in that tick, N·m.
    fn changed<'r>(
        &self,
        runner: &'r Runner<'_>,
        phase: In,
    ) -> Result<(bool, Ride<'r>, f64), SettingsError> {
        let mut ride = runner.start(OMEGA_RAD_S)?;
        ride.turn(OMEGA_RAD_S, SETTLED_S * OMEGA_RAD_S, |_| false);
        let drop_nm = self.before.static_torque_nm - self.before.kinetic_torque_nm;
        let at_nm = AT_SHARE * self.before.static_torque_nm;
        let (mut last_nm, mut highest_nm) = (ride.torque_nm, 0.0_f64);
        let most_rad = (LATEST_S - SETTLED_S) * OMEGA_RAD_S;
        let came = ride.turn(OMEGA_RAD_S, most_rad, |nm| {
            let rises = last_nm < at_nm && nm >= at_nm && nm < 1.2 * at_nm;
            highest_nm = highest_nm.max(nm);
            last_nm = nm;
            let fell = highest_nm > self.before.kinetic_torque_nm + 0.5 * drop_nm
                && nm < self.before.kinetic_torque_nm + 0.25 * drop_nm;
            match phase {
                In::Stick => rises,
                In::Slip => fell,
            }
        });
        if phase == In::Slip && came.is_some() {
            let quarter_s = 0.25 * TAU / self.before.natural_rad_s();
            ride.turn(OMEGA_RAD_S, quarter_s * OMEGA_RAD_S, |_| false);
        }
        let before_nm = ride.torque_nm;
        ride.change(&self.after)?;
        // A tick and a half of a step: the quotient may round down.
        let tick_rad = OMEGA_RAD_S * (TICK_S + 0.5 * runner.step_s());
        ride.turn(OMEGA_RAD_S, tick_rad, |_| false);
        let jump_nm = (ride.torque_nm - before_nm).abs();
        Ok((came.is_some(), ride, jump_nm))
    }
}
