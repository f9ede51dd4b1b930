//! `cogwheel` (section 4): rigidity whose limits switch between T_h and ρ·T_h.
//!
//! `mode = "time"`: high from n/f to (n + D)/f, low up to (n + 1)/f, by a clock
//! that starts with the run. `mode = "space"`: high while (φ/λ mod 1) < D.
//!
//! Readings: a change of phase is an event (`give`, `catch`) if the shaft moves
//! or the torque changes: at rest there is one `give`, then silence, though the
//! clock goes on. A torque that a `give` takes to the lower limit stays at that
//! limit without a `flow`; one that is being turned back is elastic from there
//! on without a `turn`. With ρ = 0 the low phase has no play, and no events of
//! it.

use super::guard::{Guard, When};
use super::keys::{Reader, SymptomError};
use super::play::{FELT_NM, Limits, Mode, Play, PlayAction};
use super::rigidity::{Spring, presliding};
use super::runner::{Instant, Law, Reported, Watches};
use super::{Word as Kind, of_two_sided};

/// Measure of the phases.
#[derive(Clone, Copy, Debug)]
enum Ratchet {
    /// Frequency, Hz.
    Time { frequency_hz: f64 },
    /// Pitch, rad.
    Space { pitch: f64 },
}

/// Rigidity that catches and gives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cogwheel {
    /// T_h, N·m.
    torque_nm: f64,
    /// ρ.
    low_share: f64,
    /// D.
    duty: f64,
    ratchet: Ratchet,
    /// The phases are counted through: 2n is high, 2n + 1 is low.
    phase: f64,
    spring: Spring,
    play: Play,
}

/// Actions of a cogwheel.
#[derive(Clone, Copy, Debug)]
pub(super) enum Action {
    /// The phase of this number begins.
    Phase(f64),
    Play(PlayAction),
}

impl Cogwheel {
    pub(super) fn read(reader: &Reader<'_>) -> Result<Self, SymptomError> {
        let torque_nm = reader.at_least_zero("torque_nm", 2.0)?;
        let by_space = reader.choice("mode", ("time", false), &[("space", true)])?;
        let frequency_hz = reader.positive("frequency_hz", 6.25)?;
        let pitch = reader.positive("pitch_deg", 7.5)?.to_radians();
        Ok(Self {
            torque_nm,
            low_share: reader.share("low_share", 0.4)?,
            duty: reader.checked("duty", 0.5, "a number between 0 and 1", |x| {
                x > 0.0 && x < 1.0
            })?,
            ratchet: if by_space {
                Ratchet::Space { pitch }
            } else {
                Ratchet::Time { frequency_hz }
            },
            phase: 0.0,
            spring: Spring::read(reader)?,
            play: Play::closed(torque_nm / presliding(reader)?),
        })
    }

    fn is_high(&self) -> bool {
        self.phase % 2.0 == 0.0
    }

    fn limit_nm(&self) -> f64 {
        if self.is_high() {
            self.torque_nm
        } else {
            self.low_share * self.torque_nm
        }
    }

    fn limits(&self) -> Limits {
        Limits::symmetric(self.limit_nm())
    }

    /// Start of a phase, in periods.
    fn begins(&self, phase: f64) -> f64 {
        let period = (phase / 2.0).floor();
        if phase % 2.0 == 0.0 {
            period
        } else {
            period + self.duty
        }
    }

    fn relimit(&mut self, torque_nm: f64, at: &Instant) {
        if self.limit_nm() > 0.0 {
            self.play.change(torque_nm, &self.limits(), at);
        } else {
            self.play.mode = Mode::Closed;
        }
    }
}

impl Law for Cogwheel {
    type Action = Action;

    fn arm(&mut self, at: &Instant) {
        if let Ratchet::Space { pitch } = self.ratchet {
            self.phase = 2.0 * (at.x / pitch).floor();
            // The quotient may round across an edge; and a period has two.
            if self.begins(self.phase) * pitch > at.x {
                self.phase -= 1.0;
            }
            for _ in 0..2 {
                if self.begins(self.phase + 1.0) * pitch <= at.x {
                    self.phase += 1.0;
                }
            }
        }
        self.relimit(0.0, at);
    }

    fn watches(&self, watches: &mut Watches<Action>) {
        let (next, last) = (self.phase + 1.0, self.phase - 1.0);
        match self.ratchet {
            Ratchet::Time { frequency_hz } => {
                let begins_s = self.begins(next) / frequency_hz;
                watches.push((When::At(begins_s), Action::Phase(next)));
            }
            Ratchet::Space { pitch } => {
                let forth = Guard::above(self.begins(next) * pitch);
                watches.push((When::Crosses(forth), Action::Phase(next)));
                let back = Guard::below(self.begins(self.phase) * pitch);
                watches.push((When::Crosses(back), Action::Phase(last)));
            }
        }
        self.play.watches(&self.limits(), |when, action| {
            watches.push((when, Action::Play(action)));
        });
    }

    fn act(&mut self, action: Action, at: &Instant) -> Option<Reported> {
        match action {
            Action::Phase(phase) => {
                let torque_nm = self.play.torque_nm(&self.limits(), at);
                self.phase = phase;
                self.relimit(torque_nm, at);
                let is_felt = at.v != 0.0 || torque_nm.abs() > self.limit_nm() + FELT_NM;
                let kind = if self.is_high() {
                    Kind::Catch
                } else {
                    Kind::Give
                };
                is_felt.then(|| kind.into())
            }
            Action::Play(action) => {
                self.play.act(action, &self.limits(), at);
                Some(of_two_sided(action).into())
            }
        }
    }

    fn torque_nm(&self, at: &Instant) -> f64 {
        self.play.torque_nm(&self.limits(), at) + self.spring.torque_nm(at)
    }
}
