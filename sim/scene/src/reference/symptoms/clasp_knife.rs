//! `clasp-knife` (section 7): resistance that builds, then melts away.
//!
//! ```text
//! out    → build   where s(φ − φ_on) rises above 0      `onset`
//! build:   u = T0 + k·s(φ − φ_on)
//! build  → out     where s(φ − φ_on) falls below 0      `back`
//! build  → fallen  where s(φ − φ_r) ≥ 0, or T ≥ T_r     `release`
//! fallen:  u = L_r[r + (1 − r)e^(−(t − t_r)/τ)], at any angle
//! fallen → out     where s(φ_on − φ) ≥ Δ                `rearm`
//! ```
//!
//! Readings: L_r is the limit u at the release, not the torque, which on its
//! σ-rise may still be below it and goes on rising until it meets the falling
//! limit. `trigger` selects one condition: the other one is off. A start beyond
//! φ_on is an `onset` at once, a start beyond φ_r a `release` too, both without
//! torque. A torque that reaches 0 at φ_on itself is `back` alone, without
//! `slack`.

use super::guard::{Decay, Guard, When};
use super::keys::{Reader, SymptomError};
use super::limit::Limit;
use super::play::{End, Limits, Mode, Play, PlayAction};
use super::runner::{Instant, Law, Reported, Watches};
use super::{Word as Kind, of_one_sided};

/// Distance below which two angles are one, rad.
const ONE_ANGLE: f64 = 1e-12;

/// A clasp-knife of one group of muscles.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClaspKnife {
    /// s·φ_on, rad.
    onset: f64,
    /// T0, N·m, and k, N·m/rad.
    onset_torque_nm: f64,
    slope: f64,
    /// r.
    residual: f64,
    /// τ, s.
    collapse_s: f64,
    /// Δ, rad.
    rearm: f64,
    trigger: Trigger,
    state: State,
    play: Play,
}

#[derive(Clone, Copy, Debug)]
enum Trigger {
    /// s·φ_r, rad.
    Angle(f64),
    /// T_r, N·m.
    Torque(f64),
}

#[derive(Clone, Copy, Debug)]
enum State {
    Out,
    Build,
    /// Time of the release, s, and L_r, N·m.
    Fallen {
        since_s: f64,
        level_nm: f64,
    },
}

/// Actions of a clasp-knife.
#[derive(Clone, Copy, Debug)]
pub(super) enum Action {
    Onset,
    Back,
    Release,
    Rearm,
    Play(PlayAction),
}

impl ClaspKnife {
    pub(super) fn read(reader: &Reader<'_>, sign: f64) -> Result<Self, SymptomError> {
        let onset = sign * reader.angle("onset_deg", 30.0)?;
        let release = sign * reader.angle("release_deg", 75.0)?;
        let by_torque = reader.choice("trigger", ("angle", false), &[("torque", true)])?;
        let release_nm = reader.positive("release_torque_nm", 2.5)?;
        if !by_torque && release <= onset {
            return Err(reader.refused(
                "release_deg",
                sign * release.to_degrees(),
                "an angle beyond onset_deg, in the direction that stretches the muscles",
            ));
        }
        Ok(Self {
            onset,
            onset_torque_nm: reader.at_least_zero("onset_torque_nm", 0.8)?,
            slope: reader.at_least_zero("slope_nm_per_rad", 3.0)?,
            residual: reader.share("residual_share", 0.15)?,
            collapse_s: reader.positive("collapse_s", 0.03)?,
            rearm: reader.positive("rearm_deg", 10.0)?.to_radians(),
            trigger: if by_torque {
                Trigger::Torque(release_nm)
            } else {
                Trigger::Angle(release)
            },
            state: State::Out,
            play: Play::closed(reader.positive("catch_stiffness_nm_per_rad", 60.0)?),
        })
    }

    fn limits(&self) -> Limits {
        Limits::one_sided(match self.state {
            State::Out => Limit::level(0.0),
            State::Build => Limit::line(self.onset_torque_nm, self.slope, self.onset),
            State::Fallen { since_s, level_nm } => Limit::Line {
                base: level_nm * self.residual,
                slope: 0.0,
                at: 0.0,
                decay: Some(Decay {
                    amplitude: level_nm * (1.0 - self.residual),
                    start_s: since_s,
                    time_s: self.collapse_s,
                }),
            },
        })
    }

    /// The release of a build.
    fn release(&self) -> Option<Guard> {
        match (self.trigger, self.play.mode) {
            (Trigger::Angle(at), _) => Some(Guard::above(at)),
            (Trigger::Torque(torque_nm), Mode::Elastic { anchor }) => {
                let moved = torque_nm / self.play.sigma;
                Some(Guard::above(anchor + moved).of_terms(anchor.abs() + moved.abs()))
            }
            (Trigger::Torque(torque_nm), Mode::Flow(End::Upper)) => Some(Guard {
                constant: torque_nm - self.onset_torque_nm + self.slope * self.onset,
                terms: torque_nm + self.onset_torque_nm + (self.slope * self.onset).abs(),
                angle: -self.slope,
                ..Guard::default()
            }),
            (Trigger::Torque(_), Mode::Flow(End::Lower) | Mode::Closed) => None,
        }
    }
}

impl Law for ClaspKnife {
    type Action = Action;

    fn arm(&mut self, _: &Instant) {}

    fn watches(&self, watches: &mut Watches<Action>) {
        match self.state {
            State::Out => {
                watches.push((When::Crosses(Guard::above(self.onset)), Action::Onset));
            }
            State::Build => {
                if let Some(release) = self.release() {
                    watches.push((When::Holds(release), Action::Release));
                }
                watches.push((When::Crosses(Guard::below(self.onset)), Action::Back));
            }
            State::Fallen { .. } => {
                let rearm = Guard::below(self.onset - self.rearm);
                watches.push((When::Holds(rearm), Action::Rearm));
            }
        }
        self.play.watches(&self.limits(), |when, action| {
            watches.push((when, Action::Play(action)));
        });
    }

    fn act(&mut self, action: Action, at: &Instant) -> Option<Reported> {
        match action {
            Action::Onset => {
                self.state = State::Build;
                if self.onset_torque_nm > 0.0 || at.x > self.onset + ONE_ANGLE {
                    self.play.change(0.0, &self.limits(), at);
                } else {
                    self.play.mode = Mode::Flow(End::Upper);
                }
                Some(Kind::Onset.into())
            }
            Action::Back => {
                self.state = State::Out;
                self.play.mode = Mode::Closed;
                Some(Kind::Back.into())
            }
            Action::Release => {
                let level_nm = self.limits().torque_nm(End::Upper, at);
                self.state = State::Fallen {
                    since_s: at.time_s,
                    level_nm,
                };
                if level_nm <= 0.0 {
                    self.play.mode = Mode::Closed;
                }
                Some(Kind::Release.into())
            }
            Action::Rearm => {
                self.state = State::Out;
                self.play.mode = Mode::Closed;
                Some(Kind::Rearm.into())
            }
            Action::Play(action) => {
                let was = self.play.mode;
                self.play.act(action, &self.limits(), at);
                let is_back = matches!(self.state, State::Build) && at.x <= self.onset + ONE_ANGLE;
                if action == PlayAction::Meet(End::Lower) && is_back {
                    return None;
                }
                Some(of_one_sided(action, was).into())
            }
        }
    }

    fn torque_nm(&self, at: &Instant) -> f64 {
        self.play.torque_nm(&self.limits(), at)
    }
}
