//! A shaft that comes to rest for one instant and goes on the same way:
//!
//! ```text
//! Ω = Ω₀·(1 − t/t₀)²,  Ω₀ = 1 rad/s,  t₀ = 0.5 s
//! ```
//!
//! Known: the cycles of the event-driven reference, and its largest change of torque from tick to
//! tick within 2 ms of the instant. A law that takes a velocity near zero for a turn shows a jump there.

use crate::laws::cycles::Cycles;
use crate::laws::reference::{demanded, torques};
use crate::laws::runner::{Runner, TICKS_HZ};
use crate::laws::task::{Demand, Prepared, Quantity, Reading, Setting, Task, Use};
use crate::watcher::StudyError;
use crepitus_model::{Parameters, SettingsError};
use crepitus_plant::Motion;
use crepitus_plant::piece::{Curve, Piece};

/// The task.
pub struct Pause;

/// Velocity at the start, rad/s.
const OMEGA_RAD_S: f64 = 1.0;
/// Time from there to the instant, s.
const TO_REST_S: f64 = 0.5;
const END_S: f64 = 2.0 * TO_REST_S;
/// Cycles are counted from here on, when a law has swung in, s.
const COUNTED_S: f64 = 0.1;
/// Time around the instant, s.
const AROUND_S: f64 = 2e-3;

const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "zero-speed-breaks",
        title: "cycles of a shaft that rests for one instant and goes on",
        unit: "1",
        demands: "the cycles of the event-driven reference",
        of: Use::Grating,
    },
    Quantity {
        name: "zero-speed-jump",
        title: "largest change of torque from tick to tick around that instant",
        unit: "N·m",
        demands: "the change of the event-driven reference, which goes on from where it is",
        of: Use::Rest,
    },
];

impl Task for Pause {
    fn name(&self) -> &'static str {
        "zero-speed"
    }

    fn title(&self) -> &'static str {
        "an instant of zero speed"
    }

    fn quantities(&self) -> &'static [Quantity] {
        QUANTITIES
    }

    fn prepare(&self, setting: &Setting) -> Result<Box<dyn Prepared>, StudyError> {
        let joint = &setting.joint.parameters;
        let motion = motion();
        let mut seen = Seen::of(joint);
        torques(&demanded(joint)?, &motion, END_S, TICKS_HZ, |t, nm| {
            seen.add(t, nm, true);
        });
        Ok(Box::new(Instant { seen, motion }))
    }
}

fn motion() -> Motion {
    let bend = OMEGA_RAD_S / TO_REST_S;
    let terms = [0.0, OMEGA_RAD_S, -bend, bend / (3.0 * TO_REST_S), 0.0, 0.0];
    let piece = |start_s, end_s, terms| Piece {
        start_s,
        end_s,
        jump: false,
        curve: Curve::Polynomial(terms),
    };
    // The reference bounds a curve over the whole of its piece.
    let end_rad = 2.0 / 3.0 * OMEGA_RAD_S * TO_REST_S;
    let on = [end_rad, OMEGA_RAD_S, 0.0, 0.0, 0.0, 0.0];
    Motion::Sequence(vec![
        piece(0.0, END_S, terms),
        piece(END_S, f64::INFINITY, on),
    ])
}

/// Torques of a run.
#[derive(Clone, Copy, Debug)]
struct Seen {
    cycles: Cycles,
    count: u32,
    last_nm: f64,
    jump_nm: f64,
    scale_nm: f64,
}

impl Seen {
    fn of(joint: &Parameters) -> Self {
        Self {
            cycles: Cycles::of(joint),
            count: 0,
            last_nm: 0.0,
            jump_nm: 0.0,
            scale_nm: joint.static_torque_nm,
        }
    }

    fn add(&mut self, time_s: f64, torque_nm: f64, is_tick: bool) {
        let counted = self.cycles.see(time_s, torque_nm);
        self.count += u32::from(counted.is_some_and(|at_s| at_s > COUNTED_S));
        if is_tick {
            if (time_s - TO_REST_S).abs() <= AROUND_S {
                self.jump_nm = self.jump_nm.max((torque_nm - self.last_nm).abs());
            }
            self.last_nm = torque_nm;
        }
    }
}

struct Instant {
    seen: Seen,
    motion: Motion,
}

impl Prepared for Instant {
    fn demanded(&self) -> Vec<Demand> {
        vec![
            Demand::itself(f64::from(self.seen.count)),
            Demand::beside(self.seen.jump_nm, self.seen.scale_nm),
        ]
    }

    fn measure(&self, runner: &Runner<'_>) -> Result<Vec<Reading>, SettingsError> {
        let mut ride = runner.start(OMEGA_RAD_S)?;
        let mut seen = Seen::of(runner.joint);
        let piece = self.motion.piece(0.0);
        let mut part = 0;
        ride.follow(
            END_S,
            |time_s| piece.angle_and_velocity(time_s),
            |time_s, torque_nm| {
                part = (part + 1) % runner.parts;
                seen.add(time_s, torque_nm, part == 0);
            },
        );
        Ok(vec![
            Reading::but(
                f64::from(seen.count),
                seen.count == 0,
                "does not grate: no cycle",
            ),
            Reading::of(seen.jump_nm),
        ])
    }
}
