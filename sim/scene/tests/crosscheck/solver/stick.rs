//! Stick: the object follows the shaft until its torque reaches a limit.
//!
//! The margins Ts − T and Ts + T are series; the first that falls to zero
//! breaks the stick. Under `paper` the torque leaves the inertia out but the
//! motion does not, so a slip may be unable to begin: then the stick is held
//! until kr·θ + J·Ω̇ + c·Ω reaches Tk, or kr·θ comes back within Ts.

use super::{AT_LIMIT, Certain, Gap, Phase, SlipStart, Solver};
use crate::double_double::Dd;
use crate::event::{Cause, Unsolved};
use crate::first_fall::{Fall, Root, first_fall};
use crate::series::Series;
use crepitus_model::Convention;

/// Continuation of a series that may begin at zero.
#[allow(clippy::large_enum_variant, reason = "on the stack for one step")]
pub(super) enum Leaving {
    /// Continuation above zero: the series, divided by the power of σ that is zero at the start.
    Above(Series),
    /// Continuation below zero.
    Below,
    /// The series stays at zero.
    Nowhere,
}

/// Continuation of `series`, which is at zero if its start is within `slack`.
pub(super) fn leaving(series: &Series, slack: f64) -> Leaving {
    let c = series.coefficients();
    let start = c[0].to_f64();
    if start > slack {
        return Leaving::Above(*series);
    }
    if start < -slack {
        return Leaving::Below;
    }
    let tiny = AT_LIMIT * series.size();
    match c.iter().skip(1).position(|c| c.to_f64().abs() > tiny) {
        None => Leaving::Nowhere,
        Some(k) if c[k + 1] > Dd::ZERO => Leaving::Above(series.without_leading(k + 1)),
        Some(_) => Leaving::Below,
    }
}

impl Solver<'_> {
    /// One step of a stick; returns whether the horizon is reached.
    pub(super) fn stick(&mut self, fresh: bool) -> Result<bool, Unsolved> {
        let length_s = self.reach_s();
        let shaft = self.shaft(length_s);
        let torque = self.joint.required(self.theta, &shaft);
        let limit = self.joint.static_nm;
        let mut first: Option<(Root, f64)> = None;
        for sense in [1.0, -1.0] {
            let mut margin = torque.times(Dd::new(-sense)).plus(limit);
            if fresh {
                // A stick may begin at the limit, as every one does at Tk = 0.
                let slack = AT_LIMIT * (limit.to_f64() + torque.size()) + margin.doubt();
                match leaving(&margin, slack) {
                    Leaving::Above(rest) => margin = rest,
                    Leaving::Below => {
                        margin = margin.with(0, Dd::ZERO);
                    }
                    Leaving::Nowhere => continue,
                }
            }
            match first_fall(&margin) {
                Fall::At(root) if first.is_none_or(|(earlier, _)| root.at < earlier.at) => {
                    first = Some((root, sense));
                }
                Fall::Unclear(at) => return Err(self.unclear(at, length_s)),
                _ => {}
            }
        }
        let Some((root, sense)) = first else {
            self.theta += shaft.turned.end();
            self.phase = Phase::Stick { fresh: false };
            return Ok(self.pass(length_s));
        };
        self.theta += shaft.turned.value(root.at);
        let at_end = self.pass(length_s * root.at);
        let half_width_s = root.half_width * length_s.to_f64();
        let (omega, omega_dot) = (shaft.omega.value(root.at), shaft.omega_dot.value(root.at));
        self.reach_limit(sense, omega, omega_dot, half_width_s)?;
        // On the horizon the next piece decides how a slip continues.
        Ok(at_end)
    }

    /// kr·θ, or under `physical` the whole torque, is at s·Ts.
    fn reach_limit(
        &mut self,
        sense: f64,
        omega: Dd,
        omega_dot: Dd,
        half_width_s: f64,
    ) -> Result<(), Unsolved> {
        let joint = &self.joint;
        let drop = joint.static_nm - joint.kinetic_nm;
        // J·d(Ω − θ̇)/dt·s, exact where it must be: 0 for Ts = Tk.
        let excess = match joint.convention {
            Convention::Paper => drop + (joint.inertia * omega_dot + joint.damping * omega) * sense,
            _ => drop,
        };
        if excess < Dd::ZERO {
            self.phase = Phase::Held(sense);
            return Ok(());
        }
        let before = joint.static_nm * sense;
        self.begin_slip(SlipStart {
            cause: Cause::Limit,
            from: 0.0,
            to: sense,
            v: omega,
            omega,
            gap: Gap::Opening(excess / joint.inertia),
            before: Some(before),
            certain: Certain {
                half_width_s,
                excess: None,
            },
        })
    }

    /// One step of a held stick; returns whether the horizon is reached.
    pub(super) fn held(&mut self, sense: f64) -> Result<bool, Unsolved> {
        let length_s = self.reach_s();
        let shaft = self.shaft(length_s);
        let joint = &self.joint;
        let beyond = joint
            .required(self.theta, &shaft)
            .times(Dd::new(sense))
            .plus(-joint.static_nm);
        let lacking = joint
            .true_torque(self.theta, &shaft)
            .times(Dd::new(-sense))
            .plus(joint.kinetic_nm);
        let slack = AT_LIMIT * (joint.static_nm.to_f64() + beyond.size()) + beyond.doubt();
        let returns = match leaving(&beyond, slack) {
            Leaving::Above(rest) => first_fall(&rest),
            Leaving::Below => {
                self.phase = Phase::Stick { fresh: true };
                return Ok(false);
            }
            Leaving::Nowhere => Fall::Never,
        };
        let begins = first_fall(&lacking);
        let at = |fall: Fall| match fall {
            Fall::At(root) => Ok(Some(root)),
            Fall::Unclear(at) => Err(self.unclear(at, length_s)),
            Fall::Never | Fall::Touch(_) => Ok(None),
        };
        let (returns, begins) = (at(returns)?, at(begins)?);
        let root = match (returns, begins) {
            (None, None) => {
                self.theta += shaft.turned.end();
                return Ok(self.pass(length_s));
            }
            (Some(a), None) | (None, Some(a)) => a,
            (Some(a), Some(b)) => {
                if a.at < b.at {
                    a
                } else {
                    b
                }
            }
        };
        self.theta += shaft.turned.value(root.at);
        let at_end = self.pass(length_s * root.at);
        if begins.is_some_and(|b| b.at == root.at) {
            let omega = shaft.omega.value(root.at);
            // The true torque is at Tk, so the gap opens with slope 0; where a
            // piece began with more, with what is more.
            let slope = lacking.value(root.at);
            let gap = if root.at == Dd::ZERO && slope < Dd::ZERO {
                -slope / self.joint.inertia
            } else {
                Dd::ZERO
            };
            let before = self.joint.static_nm * sense;
            self.begin_slip(SlipStart {
                cause: Cause::Limit,
                from: 0.0,
                to: sense,
                v: omega,
                omega,
                gap: Gap::Opening(gap),
                before: Some(before),
                certain: Certain {
                    half_width_s: root.half_width * length_s.to_f64(),
                    excess: None,
                },
            })?;
        } else {
            self.phase = Phase::Stick { fresh: true };
        }
        Ok(at_end)
    }

    pub(super) fn unclear(&self, at: f64, length_s: Dd) -> Unsolved {
        Unsolved::Unclear {
            time_s: (self.time_s + length_s * at).to_f64(),
        }
    }
}
