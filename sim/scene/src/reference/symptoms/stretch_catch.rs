//! `spasticity`, form `catch` (section 5): passive, found by velocity.
//!
//! ```text
//! armed  → caught  where s(φ − λ + μΩ) ≥ 0 and sΩ ≥ Ω_th first hold
//! caught:  P = min(Tmax, b·sΩ_c)
//!          u = P[r + (1 − r)e^(−(t − t_c)/τ)] + k·max(0, s(φ − φ_c)), ℓ = 0
//! caught → armed   where s(φ_c − φ) ≥ Δ
//! ```
//!
//! Readings: the sum u is not limited once more by Tmax. With P = 0 the torque
//! is on its limit from the catch on, which is no `flow`. Armed, there is no
//! play, so what torque is left at `rearm` falls to 0 there.

use super::guard::{Decay, Guard, When};
use super::keys::{Reader, SymptomError};
use super::limit::Limit;
use super::play::{End, Limits, Mode, Play, PlayAction};
use super::runner::{Instant, Law, Reported, Watches};
use super::{Word as Kind, of_one_sided};

/// A catch of one group of muscles.
#[derive(Clone, Copy, Debug)]
pub(super) struct StretchCatch {
    /// s·λ, rad.
    threshold: f64,
    /// μ, s.
    shift_s: f64,
    /// Ω_th, rad/s.
    threshold_velocity: f64,
    /// b, N·m·s/rad.
    velocity_torque: f64,
    /// Tmax, N·m.
    torque_nm: f64,
    /// r.
    residual: f64,
    /// k, N·m/rad.
    stiffness: f64,
    /// τ, s.
    release_s: f64,
    /// Δ, rad.
    rearm: f64,
    caught: Option<Caught>,
    play: Play,
}

#[derive(Clone, Copy, Debug)]
struct Caught {
    /// s·φ_c, rad.
    x: f64,
    time_s: f64,
    /// P, N·m.
    peak_nm: f64,
    /// True where x is above that of the catch.
    is_beyond: bool,
}

/// Actions of a catch.
#[derive(Clone, Copy, Debug)]
pub(super) enum Action {
    Catch,
    Rearm,
    /// x passes that of the catch; whether it is beyond it then.
    Passes(bool),
    Play(PlayAction),
}

impl StretchCatch {
    pub(super) fn read(reader: &Reader<'_>, sign: f64) -> Result<Self, SymptomError> {
        Ok(Self {
            threshold: sign * reader.angle("threshold_deg", 75.0)?,
            shift_s: reader.at_least_zero("velocity_shift_s", 0.25)?,
            threshold_velocity: reader
                .positive("threshold_velocity_deg_s", 40.0)?
                .to_radians(),
            velocity_torque: reader.at_least_zero("velocity_torque_nms_per_rad", 0.67)?,
            torque_nm: reader.at_least_zero("torque_nm", 4.5)?,
            residual: reader.share("residual_share", 0.5)?,
            stiffness: reader.at_least_zero("stiffness_nm_per_rad", 1.0)?,
            release_s: reader.positive("release_s", 0.06)?,
            rearm: reader.positive("rearm_deg", 10.0)?.to_radians(),
            caught: None,
            play: Play::closed(reader.positive("catch_stiffness_nm_per_rad", 60.0)?),
        })
    }

    fn limits(&self, caught: &Caught) -> Limits {
        let amplitude = caught.peak_nm * (1.0 - self.residual);
        Limits::one_sided(Limit::Line {
            base: caught.peak_nm * self.residual,
            slope: if caught.is_beyond {
                self.stiffness
            } else {
                0.0
            },
            at: caught.x,
            decay: (amplitude > 0.0).then_some(Decay {
                amplitude,
                start_s: caught.time_s,
                time_s: self.release_s,
            }),
        })
    }

    /// The mode in which a limit without P begins.
    fn without_peak(&self, is_beyond: bool) -> Mode {
        if is_beyond && self.stiffness > 0.0 {
            Mode::Flow(End::Upper)
        } else {
            Mode::Closed
        }
    }
}

impl Law for StretchCatch {
    type Action = Action;

    fn arm(&mut self, _: &Instant) {}

    fn watches(&self, watches: &mut Watches<Action>) {
        let Some(caught) = &self.caught else {
            let stretched = Guard {
                velocity: -self.shift_s,
                ..Guard::above(self.threshold)
            };
            let fast = Guard::faster(self.threshold_velocity);
            watches.push((When::BothHold([stretched, fast]), Action::Catch));
            return;
        };
        let rearm = Guard::below(caught.x - self.rearm);
        watches.push((When::Holds(rearm), Action::Rearm));
        let passes = if caught.is_beyond {
            Guard::below(caught.x)
        } else {
            Guard::above(caught.x)
        };
        watches.push((When::Crosses(passes), Action::Passes(!caught.is_beyond)));
        self.play.watches(&self.limits(caught), |when, action| {
            watches.push((when, Action::Play(action)));
        });
    }

    fn act(&mut self, action: Action, at: &Instant) -> Option<Reported> {
        match (action, &mut self.caught) {
            (Action::Catch, _) => {
                let peak_nm = self.torque_nm.min(self.velocity_torque * at.v);
                let caught = Caught {
                    x: at.x,
                    time_s: at.time_s,
                    peak_nm,
                    is_beyond: true,
                };
                self.caught = Some(caught);
                if peak_nm > 0.0 {
                    self.play.change(0.0, &self.limits(&caught), at);
                } else {
                    self.play.mode = self.without_peak(true);
                }
                Some(Reported {
                    kind: Kind::Catch,
                    peak_nm: Some(peak_nm),
                })
            }
            (Action::Rearm, _) => {
                self.caught = None;
                self.play.mode = Mode::Closed;
                Some(Kind::Rearm.into())
            }
            (Action::Passes(is_beyond), Some(caught)) => {
                caught.is_beyond = is_beyond;
                if caught.peak_nm <= 0.0 {
                    self.play.mode = self.without_peak(is_beyond);
                }
                None
            }
            (Action::Play(action), Some(caught)) => {
                let (caught, was) = (*caught, self.play.mode);
                self.play.act(action, &self.limits(&caught), at);
                Some(of_one_sided(action, was).into())
            }
            (_, None) => None,
        }
    }

    fn torque_nm(&self, at: &Instant) -> f64 {
        self.caught
            .map_or(0.0, |caught| self.play.torque_nm(&self.limits(&caught), at))
    }
}
