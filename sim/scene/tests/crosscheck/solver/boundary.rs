//! The start, and where two pieces of the motion meet.
//!
//! A jump of Ω breaks a stick and reverses a slip if the shaft jumps past the
//! object; a jump of Ω̇ breaks a `physical` stick if it exceeds the limit. A
//! `frozen` joint ignores both. Pieces that are not marked as
//! jumping have one velocity at their boundary, though perhaps not to the bit.

use super::{Certain, Gap, Phase, SlipStart, Solver};
use crate::double_double::Dd;
use crate::event::{Cause, Unsolved};
use crepitus_model::Convention;

impl Solver<'_> {
    /// The shaft at this instant: Ω and Ω̇ just after.
    pub(super) fn shaft_now(&self) -> (Dd, Dd) {
        let shaft = self.shaft(self.reach_s());
        (shaft.omega.value(Dd::ZERO), shaft.omega_dot.value(Dd::ZERO))
    }

    /// A stick at θ = 0, which may be impossible.
    pub(super) fn start(&mut self) -> Result<(), Unsolved> {
        self.round_state();
        self.break_by_acceleration(Cause::Start, None)
    }

    /// Breaks a stick whose torque is beyond the limit at this instant.
    fn break_by_acceleration(&mut self, cause: Cause, before: Option<Dd>) -> Result<(), Unsolved> {
        let (omega, omega_dot) = self.shaft_now();
        let joint = self.joint;
        let required = joint.stiffness * self.theta
            + joint.stick_inertia * omega_dot
            + joint.stick_damping * omega;
        if joint.convention != Convention::Physical || !joint.is_beyond(required, 0.0) {
            self.phase = Phase::Stick { fresh: true };
            return Ok(());
        }
        let to = required.sign();
        self.begin_slip(SlipStart {
            cause,
            from: 0.0,
            to,
            v: omega,
            omega,
            gap: Gap::Opening((required * to - joint.kinetic_nm) / joint.inertia),
            before,
            certain: Certain::default(),
        })
    }

    /// Crosses a boundary, which the time has just reached.
    pub(super) fn cross(&mut self) -> Result<(), Unsolved> {
        let old = self.piece;
        // Velocity and torque just before, from a series of the old piece.
        let back = (self.time_s - Dd::new(old.start_s)).scaled(0.5);
        let left = crate::shaft::Shaft::new(&old, &self.changes, self.time_s, back);
        let (omega_left, dot_left) = (left.omega.value(Dd::ZERO), left.omega_dot.value(Dd::ZERO));
        self.piece = self.problem.motion.piece(old.end_s);
        let (omega, omega_dot) = self.shaft_now();
        let joint = self.joint;
        let jumps = self.piece.jump && joint.convention != Convention::Frozen;
        let spring = joint.stiffness * self.theta;
        match self.phase {
            Phase::Slip { sense, gap } if joint.convention != Convention::Frozen => {
                if !jumps {
                    if let Gap::Opening(_) = gap {
                        // A slip that begins on the boundary opens as the new
                        // piece says.
                        let truth = spring + joint.inertia * omega_dot + joint.damping * omega;
                        let slope = (truth * sense - joint.kinetic_nm) / joint.inertia;
                        if slope < Dd::ZERO {
                            return self.settle(sense, omega, omega_dot, 0.0);
                        }
                        self.v = omega;
                        self.phase = Phase::Slip {
                            sense,
                            gap: Gap::Opening(slope),
                        };
                    }
                    return Ok(());
                }
                let lead = (omega - self.v) * sense;
                if lead > Dd::ZERO {
                    self.phase = Phase::Slip {
                        sense,
                        gap: Gap::Open,
                    };
                    Ok(())
                } else if lead == Dd::ZERO {
                    self.settle(sense, omega, omega_dot, 0.0)
                } else {
                    self.begin_slip(SlipStart {
                        cause: Cause::VelocityJump,
                        from: sense,
                        to: -sense,
                        v: self.v,
                        omega,
                        gap: Gap::Open,
                        before: Some(joint.kinetic_nm * sense),
                        certain: Certain::default(),
                    })
                }
            }
            Phase::Stick { .. } | Phase::Held(_) if jumps => {
                let before =
                    spring + joint.stick_inertia * dot_left + joint.stick_damping * omega_left;
                self.begin_slip(SlipStart {
                    cause: Cause::VelocityJump,
                    from: 0.0,
                    to: (omega - omega_left).sign(),
                    v: omega_left,
                    omega,
                    gap: Gap::Open,
                    before: Some(before),
                    certain: Certain::default(),
                })
            }
            Phase::Slip { .. } | Phase::Held(_) => Ok(()),
            Phase::Stick { .. } => {
                let before =
                    spring + joint.stick_inertia * dot_left + joint.stick_damping * omega_left;
                self.break_by_acceleration(Cause::AccelerationJump, Some(before))
            }
        }
    }
}
