//! Slip: the object swings freely until the shaft's lead has fallen to zero.
//!
//! The gap g = s·(Ω − θ̇) is a series. A slip that begins with g = 0 is divided
//! by the power of σ with which it opens, so that its beginning is not a zero of
//! the searched function; likewise after a touch (Ts = Tk: the velocities
//! meet and part again).

use super::{AT_LIMIT, Certain, Gap, Phase, SlipStart, Solver};
use crate::double_double::Dd;
use crate::event::{Cause, Unsolved};
use crate::first_fall::{Fall, Root, first_fall};
use crate::series::Series;
use crate::shaft::{Shaft, speed_size_rad_s};
use crate::swing::Swing;
use crepitus_model::Convention;

/// Margin for the remainder of a series of the gap after division by σⁿ.
fn opened(gap: &Series, slope: Dd) -> Option<Series> {
    if slope > Dd::ZERO {
        return Some(gap.with(1, slope).without_leading(1));
    }
    let tiny = AT_LIMIT * gap.size();
    let c = gap.coefficients();
    let k = c.iter().skip(2).position(|c| c.to_f64().abs() > tiny)? + 2;
    (c[k] > Dd::ZERO).then(|| gap.without_leading(k))
}

impl Solver<'_> {
    /// One step of a slip; returns whether the horizon is reached.
    pub(super) fn slip(&mut self, sense: f64, gap: Gap) -> Result<bool, Unsolved> {
        let center = self.joint.kinetic_nm * sense / self.joint.stiffness;
        let x = self.theta - center;
        let swing = self.joint.object.swing(x, self.v, self.reach_s());
        let length_s = swing.length_s;
        let shaft = self.shaft(length_s);
        let s = Dd::new(sense);
        let series = shaft.omega.combine(s, &swing.v, -s);
        let searched = match gap {
            Gap::Open => Some(series),
            Gap::Opening(slope) => opened(&series, slope * length_s),
        };
        // No relative motion: at rest for ever.
        let Some(searched) = searched else {
            if series.size() > AT_LIMIT * (shaft.omega.size() + swing.v.size()) {
                return Err(Unsolved::Inconsistent {
                    time_s: self.time_s.to_f64(),
                });
            }
            return Ok(self.swing_on(&swing, center, gap));
        };
        match first_fall(&searched) {
            Fall::Never => Ok(self.swing_on(&swing, center, Gap::Open)),
            Fall::Unclear(at) => Err(self.unclear(at, length_s)),
            Fall::Touch(at) => {
                self.theta = center + swing.x.value(at);
                self.v = swing.v.value(at);
                let at_end = self.pass(length_s * at);
                self.history.touches_s.push(self.time_s.to_f64());
                self.phase = Phase::Slip {
                    sense,
                    gap: Gap::Opening(Dd::ZERO),
                };
                Ok(at_end)
            }
            Fall::At(root) => {
                self.theta = center + swing.x.value(root.at);
                let at_end = self.pass(length_s * root.at);
                self.meet(sense, &shaft, root, length_s)?;
                Ok(at_end)
            }
        }
    }

    /// Advances to the end of a step without an event.
    fn swing_on(&mut self, swing: &Swing, center: Dd, gap: Gap) -> bool {
        let (x, v) = (swing.x.end(), swing.v.end());
        let object = &self.joint.object;
        // What is compared are two velocities, each rounded in its own size.
        let size = object.reach_rad_s(x, v) + speed_size_rad_s(&self.piece, self.time_s);
        let natural = object.natural_rad_s();
        self.theta = center + x + Dd::new(self.rounding.change(size / natural));
        self.v = v + Dd::new(self.rounding.change(size));
        if let Phase::Slip { sense, .. } = self.phase {
            self.phase = Phase::Slip { sense, gap };
        }
        self.pass(swing.length_s)
    }

    /// The velocities meet: stick if the static limit can hold the object,
    /// otherwise slip in the other sense.
    fn meet(
        &mut self,
        sense: f64,
        shaft: &Shaft,
        root: Root,
        length_s: Dd,
    ) -> Result<(), Unsolved> {
        let (omega, omega_dot) = (shaft.omega.value(root.at), shaft.omega_dot.value(root.at));
        let half_width_s = root.half_width * length_s.to_f64();
        self.settle(sense, omega, omega_dot, half_width_s)
    }

    /// The phase after equal velocities.
    pub(super) fn settle(
        &mut self,
        sense: f64,
        omega: Dd,
        omega_dot: Dd,
        half_width_s: f64,
    ) -> Result<(), Unsolved> {
        let joint = self.joint;
        let spring = joint.stiffness * self.theta;
        let required = spring + joint.stick_inertia * omega_dot + joint.stick_damping * omega;
        let truth = spring + joint.inertia * omega_dot + joint.damping * omega;
        let doubt = 4.0 * half_width_s * (joint.stiffness * omega).to_f64().abs();
        let certain = Certain {
            half_width_s,
            excess: Some(((required.abs() - joint.static_nm) / joint.static_nm).to_f64()),
        };
        let to = required.sign();
        let opening = (truth * to - joint.kinetic_nm) / joint.inertia;
        // Under `paper` the limit may be passed and yet no slip can begin:
        // the stick is held.
        let beyond = joint.is_beyond(required, doubt);
        let held = joint.convention == Convention::Paper && (to == sense || opening < Dd::ZERO);
        if beyond && !held {
            return self.begin_slip(SlipStart {
                cause: Cause::Match,
                from: sense,
                to,
                v: omega,
                omega,
                gap: Gap::Opening(opening),
                before: Some(joint.kinetic_nm * sense),
                certain,
            });
        }
        self.report_stick(Cause::Match, sense, omega, required, certain);
        self.phase = if beyond {
            Phase::Held(to)
        } else {
            Phase::Stick { fresh: true }
        };
        self.round_state();
        Ok(())
    }
}
