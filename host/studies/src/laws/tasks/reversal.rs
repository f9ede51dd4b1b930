//! Turning back.
//!
//! ```text
//! slope    load slowly to 0.6 Ts, turn within 40 ms, measure dT/dφ from 0.05 to 0.25 break angles back
//! beyond   10° to and fro at 1 Hz, one and a half times: largest |T| beyond Ts
//! breaks   cycles of the same in both senses
//! balance  mean torque there and mean torque back, added
//! ```
//!
//! Known: our joint sticks on, so that the slope is kr, and shows nothing beyond Ts; the cycles and
//! the balance of the event-driven reference, whose friction is the same in both senses.

use super::break_angle_rad;
use crate::laws::cycles::Cycles;
use crate::laws::reference::{demanded, torques};
use crate::laws::runner::{Runner, TICKS_HZ, between};
use crate::laws::task::{Demand, Prepared, Quantity, Reading, Setting, Task, Use};
use crate::watcher::StudyError;
use crepitus_model::{Parameters, Real, SettingsError};
use crepitus_plant::Motion;

/// The task.
pub struct Reverse;

/// Slow velocity, rad/s.
const SLOW_RAD_S: f64 = 0.002;
/// Time of the turn, s.
const TURN_S: f64 = 0.04;

const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "reversal-slope",
        title: "change of torque with the angle after turning back in a stick",
        unit: "N·m/rad",
        demands: "a stick is a spring in either sense: kr",
        of: Use::Moving,
    },
    Quantity {
        name: "reversal-beyond",
        title: "largest torque beyond ±Ts, 10° to and fro at 1 Hz",
        unit: "N·m",
        demands: "nothing beyond Ts is shown",
        of: Use::Moving,
    },
    Quantity {
        name: "reversal-breaks",
        title: "cycles in both senses, 10° to and fro at 1 Hz for 1.5 s",
        unit: "1",
        demands: "the cycles of the event-driven reference",
        of: Use::Moving,
    },
    Quantity {
        name: "reversal-balance",
        title: "mean torque of the way there and of the way back, added",
        unit: "N·m",
        demands: "the balance of the event-driven reference: friction is the same in both senses",
        of: Use::Moving,
    },
];

/// Length of the motion to and fro, s.
const TO_AND_FRO_S: f64 = 1.5;

fn to_and_fro() -> Motion {
    Motion::sine(10_f64.to_radians(), 1.0, -90.0)
}

impl Task for Reverse {
    fn name(&self) -> &'static str {
        "reversal"
    }

    fn title(&self) -> &'static str {
        "turning back"
    }

    fn quantities(&self) -> &'static [Quantity] {
        QUANTITIES
    }

    fn prepare(&self, setting: &Setting) -> Result<Box<dyn Prepared>, StudyError> {
        let joint = setting.joint.parameters;
        let mut seen = Seen::of(&joint);
        let settings = demanded(&joint)?;
        torques(&settings, &to_and_fro(), TO_AND_FRO_S, TICKS_HZ, |t, nm| {
            seen.add(t, nm);
        });
        Ok(Box::new(Turns { joint, seen }))
    }
}

/// Torques to and fro.
#[derive(Clone, Copy, Debug)]
struct Seen {
    cycles: Cycles,
    count: u32,
    static_nm: f64,
    beyond_nm: f64,
    /// Sums and numbers of the torques there and back.
    strokes: [(f64, f64); 2],
}

impl Seen {
    fn of(joint: &Parameters) -> Self {
        Self {
            cycles: Cycles::of(joint),
            count: 0,
            static_nm: joint.static_torque_nm,
            beyond_nm: 0.0,
            strokes: [(0.0, 0.0); 2],
        }
    }

    fn add(&mut self, time_s: f64, torque_nm: f64) {
        let [there, back] = &mut self.strokes;
        self.count += u32::from(self.cycles.see(time_s, torque_nm).is_some());
        self.beyond_nm = self.beyond_nm.max(torque_nm.abs() - self.static_nm);
        let stroke = match time_s {
            ..0.5 => there,
            0.5..1.0 => back,
            _ => return,
        };
        stroke.0 += torque_nm;
        stroke.1 += 1.0;
    }

    fn balance_nm(&self) -> f64 {
        self.strokes.iter().map(|(sum, count)| sum / count).sum()
    }
}

struct Turns {
    joint: Parameters,
    seen: Seen,
}

impl Prepared for Turns {
    fn demanded(&self) -> Vec<Demand> {
        vec![
            Demand::itself(self.joint.stiffness_nm_per_rad),
            Demand::none_of(self.joint.static_torque_nm),
            Demand::itself(f64::from(self.seen.count)),
            Demand::beside(self.seen.balance_nm(), self.joint.static_torque_nm),
        ]
    }

    fn refinements(&self) -> &[u32] {
        &[8, 32]
    }

    fn measure(&self, runner: &Runner<'_>) -> Result<Vec<Reading>, SettingsError> {
        let seen = self.to_and_fro(runner)?;
        let count = f64::from(seen.count);
        Ok(vec![
            self.slope(runner)?,
            Reading::of(seen.beyond_nm),
            Reading::but(count, count == 0.0, "does not grate: no cycle"),
            Reading::of(seen.balance_nm()),
        ])
    }
}

impl Turns {
    fn slope(&self, runner: &Runner<'_>) -> Result<Reading, SettingsError> {
        const NEVER: Reading = Reading {
            value: None,
            failed: Some("never bears 0.6 Ts"),
        };
        let (broken_rad, load_nm) = (
            break_angle_rad(&self.joint),
            0.6 * self.joint.static_torque_nm,
        );
        let mut ride = runner.start(SLOW_RAD_S)?;
        if ride
            .turn(SLOW_RAD_S, 5.0 * broken_rad, |nm| nm >= load_nm)
            .is_none()
        {
            return Ok(NEVER);
        }
        let turn = |time_s: f64| {
            let share = time_s / TURN_S;
            (
                SLOW_RAD_S * time_s * (1.0 - share),
                SLOW_RAD_S * (1.0 - 2.0 * share),
            )
        };
        ride.follow(TURN_S, turn, |_, _| {});
        // Nothing ends these two: their travel is as long as it is asked for, to a step.
        let step_rad = SLOW_RAD_S * runner.step_s();
        let back = |rad: f64| (rad / step_rad).whole();
        let shaft = between((0.0, -SLOW_RAD_S), (-step_rad, -SLOW_RAD_S));
        let (first, last) = (back(0.05 * broken_rad), back(0.25 * broken_rad));
        let mut first_nm = ride.torque_nm;
        for n in 1..=last {
            let torque_nm = ride.step(&shaft);
            if n == first {
                first_nm = torque_nm;
            }
        }
        let travel_rad = step_rad * f64::from_whole(last - first);
        Ok(Reading::of((first_nm - ride.torque_nm) / travel_rad))
    }

    fn to_and_fro(&self, runner: &Runner<'_>) -> Result<Seen, SettingsError> {
        let mut ride = runner.start(0.0)?;
        let piece = to_and_fro().piece(0.0);
        let mut seen = Seen::of(&self.joint);
        ride.follow(
            TO_AND_FRO_S,
            |time_s| piece.angle_and_velocity(time_s),
            |time_s, torque_nm| seen.add(time_s, torque_nm),
        );
        Ok(seen)
    }
}
