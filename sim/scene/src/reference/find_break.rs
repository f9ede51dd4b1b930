//! Time at which a stick of the reference solver breaks.

use super::Reference;
use super::ahead::PhaseEnd;
use super::first_root::{Sample, Touch, first_root};
use super::parabola::Parabola;
use super::rising::Answer;
use crepitus_model::solver::locate::earlier;
use crepitus_model::{Convention, Sense};
use crepitus_plant::ShaftState;
use std::ops::ControlFlow;

/// A torque that is looked for: its sense, its size, and whether the object's
/// inertia and damping are part of it.
#[derive(Clone, Copy)]
struct Mark {
    sense: Sense,
    limit_nm: f64,
    inertial: bool,
}

impl Reference<'_> {
    /// The torque of a stick and its first derivative: the spring's, with the
    /// object's inertia and damping if `inertial`.
    fn torque_and_rate(
        &self,
        (theta, phi): (f64, f64),
        inertial: bool,
        s: &ShaftState,
    ) -> (f64, f64) {
        let p = &self.settings.parameters;
        let kr = p.stiffness_nm_per_rad;
        let (torque, rate) = (kr * (theta + (s.phi_rad - phi)), kr * s.omega_rad_s);
        if !inertial {
            return (torque, rate);
        }
        let (j, c) = (p.inertia_kg_m2, p.damping_nms_per_rad);
        (
            torque + (j * s.omega_dot + c * s.omega_rad_s),
            rate + (j * s.omega_ddot + c * s.omega_dot),
        )
    }

    /// The first time at which s·T reaches a mark, on a piece of any shape.
    fn reaches<B>(
        &self,
        anchor: (f64, f64),
        mark: Mark,
        (from_s, to_s): (f64, f64),
        poll: &mut impl FnMut() -> ControlFlow<B>,
    ) -> ControlFlow<B, Option<f64>> {
        let Mark {
            sense,
            limit_nm,
            inertial,
        } = mark;
        let p = &self.settings.parameters;
        let kr = p.stiffness_nm_per_rad;
        let bounds = self.piece.bounds(from_s, to_s);
        let mut bound = kr * bounds.omega_dot;
        if inertial {
            bound +=
                p.damping_nms_per_rad * bounds.omega_ddot + p.inertia_kg_m2 * bounds.omega_dddot;
        }
        let slack = self.limit_slack_nm(&self.now);
        first_root(from_s, to_s, Touch::Passes, poll, |time_s| {
            let (phi_rad, torque, rate) = if inertial {
                let shaft = self.piece.at(time_s);
                let (torque, rate) = self.torque_and_rate(anchor, true, &shaft);
                (shaft.phi_rad, torque, rate)
            } else {
                // The spring needs no acceleration.
                let (phi_rad, omega_rad_s) = self.piece.angle_and_velocity(time_s);
                let (theta, phi) = anchor;
                (phi_rad, kr * (theta + (phi_rad - phi)), kr * omega_rad_s)
            };
            // The angle is rounded, too.
            let noise = 2.0 * f64::EPSILON * (limit_nm + torque.abs() + kr * phi_rad.abs());
            Sample {
                value: limit_nm - sense.of_signed(torque),
                slope: -sense.of_signed(rate),
                bound,
                noise,
                slack: noise.max(slack),
            }
        })
    }

    /// The first time at which |T| reaches the static limit.
    fn reaches_limit<B>(
        &self,
        anchor: (f64, f64),
        (from_s, to_s): (f64, f64),
        poll: &mut impl FnMut() -> ControlFlow<B>,
    ) -> ControlFlow<B, Option<(f64, Sense)>> {
        let limit_nm = self.settings.parameters.static_torque_nm;
        let inertial = self.settings.convention == Convention::Physical;
        let later;
        // No copy: the shaft may just have been written, and not as a whole.
        let shaft = if from_s == self.time_s {
            &self.now
        } else {
            later = self.piece.at(from_s);
            &later
        };
        let (torque_nm, rate) = self.torque_and_rate(anchor, inertial, shaft);
        if self.piece.is_parabolic() {
            // So is the torque.
            let curvature = self.settings.parameters.stiffness_nm_per_rad * shaft.omega_dot;
            let slack = self.limit_slack_nm(shaft);
            let at = |sense: Sense| {
                Parabola {
                    left: limit_nm - sense.of_signed(torque_nm),
                    rate: sense.of_signed(rate),
                    curvature: sense.of_signed(curvature),
                }
                .first_root(slack)
                .map(|after_s| (from_s + after_s, sense))
                .filter(|(time_s, _)| *time_s <= to_s)
            };
            return ControlFlow::Continue(earlier(at(Sense::Positive), at(Sense::Negative)));
        }
        if !inertial {
            match self.surely_breaks(anchor, (from_s, to_s), shaft, torque_nm) {
                Answer::None => return ControlFlow::Continue(None),
                Answer::Break(time_s, sense) => {
                    return ControlFlow::Continue(Some((time_s, sense)));
                }
                Answer::Unknown => {}
            }
        }
        // First where it is going.
        let ahead = if rate < 0.0 {
            Sense::Negative
        } else {
            Sense::Positive
        };
        self.search_limit(anchor, (from_s, to_s), (ahead, inertial), poll)
    }

    /// The first time at which |T| reaches the static limit, by a search that cannot miss it: in the
    /// sense `ahead`, then the other way, no further than that.
    pub(super) fn search_limit<B>(
        &self,
        anchor: (f64, f64),
        (from_s, to_s): (f64, f64),
        (ahead, inertial): (Sense, bool),
        poll: &mut impl FnMut() -> ControlFlow<B>,
    ) -> ControlFlow<B, Option<(f64, Sense)>> {
        let limit_nm = self.settings.parameters.static_torque_nm;
        let mut at = |sense, to_s| {
            let mark = Mark {
                sense,
                limit_nm,
                inertial,
            };
            self.reaches(anchor, mark, (from_s, to_s), poll)
                .map_continue(|found| found.map(|time_s| (time_s, sense)))
        };
        let first = at(ahead, to_s)?;
        let other = at(ahead.opposite(), first.map_or(to_s, |(time_s, _)| time_s))?;
        ControlFlow::Continue(earlier(first, other))
    }

    /// The next break of a stick.
    pub(super) fn find_break<B>(
        &self,
        theta: f64,
        phi: f64,
        span_s: (f64, f64),
        poll: &mut impl FnMut() -> ControlFlow<B>,
    ) -> ControlFlow<B, Option<PhaseEnd>> {
        let anchor = (theta, phi);
        let found = match self.reaches_limit(anchor, span_s, poll)? {
            Some((time_s, sense))
                if self.settings.convention == Convention::Paper
                    && !self.slips(theta, phi, &self.piece.at(time_s), sense) =>
            {
                let forth = self.held_break(anchor, Sense::Positive, span_s, poll)?;
                let back = self.held_break(anchor, Sense::Negative, span_s, poll)?;
                earlier(forth, back)
            }
            found => found,
        };
        ControlFlow::Continue(found.map(|(time_s, sense)| PhaseEnd { time_s, sense }))
    }

    /// Returns whether the true torque of a stick is at least Tk in `sense`, to
    /// rounding: the shaft overtakes an object that slips.
    pub(super) fn slips(&self, theta: f64, phi: f64, shaft: &ShaftState, sense: Sense) -> bool {
        let kinetic = self.settings.parameters.kinetic_torque_nm;
        let (spring, _) = self.torque_and_rate((theta, phi), false, shaft);
        let (torque, _) = self.torque_and_rate((theta, phi), true, shaft);
        let rounding = 8.0 * f64::EPSILON * (kinetic + spring.abs() + (torque - spring).abs());
        sense.of_signed(torque) >= kinetic - rounding
    }

    /// The next break in `sense` of a `paper` stick: a slip cannot begin while
    /// the shaft brakes too hard for it, and until the true torque reaches Tk
    /// the stick is held at its limit.
    fn held_break<B>(
        &self,
        anchor: (f64, f64),
        sense: Sense,
        (from_s, to_s): (f64, f64),
        poll: &mut impl FnMut() -> ControlFlow<B>,
    ) -> ControlFlow<B, Option<(f64, Sense)>> {
        let p = &self.settings.parameters;
        let mark = |limit_nm, inertial| Mark {
            sense,
            limit_nm,
            inertial,
        };
        let limit = p.static_torque_nm;
        let mut time_s = from_s;
        loop {
            // At the limit, or below it again since the spring came back.
            let spring = self.reaches(anchor, mark(limit, false), (time_s, to_s), poll)?;
            let Some(at_limit_s) = spring else {
                return ControlFlow::Continue(None);
            };
            let kinetic = mark(p.kinetic_torque_nm, true);
            let Some(slips_s) = self.reaches(anchor, kinetic, (at_limit_s, to_s), poll)? else {
                return ControlFlow::Continue(None);
            };
            let (torque, _) = self.torque_and_rate(anchor, false, &self.piece.at(slips_s));
            if sense.of_signed(torque) >= limit - self.limit_slack_nm(&self.now) {
                return ControlFlow::Continue(Some((slips_s, sense)));
            }
            time_s = slips_s;
            poll()?;
        }
    }
}
