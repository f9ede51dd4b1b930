//! `lead-pipe` (section 3), and the elastic part that `cogwheel` shares.
//!
//! ```text
//! play with u = −ℓ = Tc, σ = Tc/δ, plus k_e(φ − φ₀)
//! ```

use super::keys::{Reader, SymptomError};
use super::of_two_sided;
use super::play::{Limits, Play, PlayAction};
use super::runner::{Instant, Law, Reported, Watches};

/// k_e(φ − φ₀).
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring {
    stiffness: f64,
    neutral: f64,
}

impl Spring {
    pub(super) fn read(reader: &Reader<'_>) -> Result<Self, SymptomError> {
        Ok(Self {
            stiffness: reader.at_least_zero("elastic_nm_per_rad", 0.0)?,
            neutral: reader.angle("neutral_deg", 45.0)?,
        })
    }

    pub(super) fn torque_nm(&self, at: &Instant) -> f64 {
        self.stiffness * (at.x - self.neutral)
    }
}

/// δ, rad.
pub(super) fn presliding(reader: &Reader<'_>) -> Result<f64, SymptomError> {
    reader.positive("presliding_deg", 1.5).map(f64::to_radians)
}

/// Rigidity that is the same throughout.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeadPipe {
    /// Tc, N·m.
    torque_nm: f64,
    spring: Spring,
    play: Play,
}

impl LeadPipe {
    pub(super) fn read(reader: &Reader<'_>) -> Result<Self, SymptomError> {
        let torque_nm = reader.at_least_zero("torque_nm", 1.2)?;
        Ok(Self {
            torque_nm,
            spring: Spring::read(reader)?,
            play: Play::closed(torque_nm / presliding(reader)?),
        })
    }

    fn limits(&self) -> Limits {
        Limits::symmetric(self.torque_nm)
    }
}

impl Law for LeadPipe {
    type Action = PlayAction;

    fn arm(&mut self, at: &Instant) {
        if self.torque_nm > 0.0 {
            self.play.change(0.0, &self.limits(), at);
        }
    }

    fn watches(&self, watches: &mut Watches<PlayAction>) {
        self.play
            .watches(&self.limits(), |when, action| watches.push((when, action)));
    }

    fn act(&mut self, action: PlayAction, at: &Instant) -> Option<Reported> {
        self.play.act(action, &self.limits(), at);
        Some(of_two_sided(action).into())
    }

    fn torque_nm(&self, at: &Instant) -> f64 {
        self.play.torque_nm(&self.limits(), at) + self.spring.torque_nm(at)
    }
}
