//! `texture` (section 9): asperities at fixed angles.
//!
//! ```text
//! φ_n = λ(n + j(h₂ₙ − ½))        H_n = (Tp − Tb)(1 − j·h₂ₙ₊₁)
//! h_k = top 24 bits of lowbias32(k xor seed·0x9E3779B9) / 2²⁴
//! with patches, P > 0, and k = n mod N: H_n = 0 where k ≥ M, N = round(P/λ), M = max(1, round(qN))
//!  u = Tb + H_next·max(0, 1 − (φ_next − φ)/(wλ))
//! −ℓ = Tb + H_last·max(0, 1 − (φ − φ_last)/(wλ))
//! ```
//!
//! Readings: `snap` is where an asperity is crossed while the torque is at its
//! limit, as it is written: a tremble on an asperity is one snap, though from an
//! elastic torque, too, the crossing takes what is above the limit behind it. A
//! touch is no crossing. `flow` and `turn` are not reported. n may be negative; k is it in
//! two's complement. An asperity that a patch leaves out is none, and is crossed without a snap.

use super::Word as Kind;
use super::guard::{Guard, When};
use super::keys::{Reader, SymptomError};
use super::limit::Limit;
use super::play::{End, FELT_NM, Limits, Mode, Play, PlayAction};
use super::runner::{Instant, Law, Reported, Watches};

/// The largest count of asperities from zero: an angle of 1e6 rad has fewer.
const MOST: f64 = 1e12;

/// Spatial crepitus.
#[derive(Clone, Copy, Debug)]
pub(super) struct Texture {
    /// Tb, N·m.
    base_nm: f64,
    /// Tp − Tb, N·m.
    height_nm: f64,
    /// λ, rad.
    pitch: f64,
    /// w·λ, rad.
    width: f64,
    /// j.
    irregularity: f64,
    /// N and M; without patches none.
    patches: Option<(i64, i64)>,
    /// seed·0x9E3779B9.
    key: u32,
    /// The number of the last asperity: φ_n ≤ φ ≤ φ_(n+1).
    last: i64,
    play: Play,
}

/// Actions of texture.
#[derive(Clone, Copy, Debug)]
pub(super) enum Action {
    /// An asperity is crossed in this direction.
    Cross(End),
    Play(PlayAction),
}

impl Texture {
    pub(super) fn read(reader: &Reader<'_>) -> Result<Self, SymptomError> {
        let base_nm = reader.at_least_zero("base_nm", 0.1)?;
        let peak_nm = reader.at_least_zero("peak_nm", 0.4)?;
        let pitch = reader.positive("pitch_deg", 1.5)?.to_radians();
        let share = reader.checked("width_share", 0.6, "a number above 0, at most 1", |x| {
            x > 0.0 && x <= 1.0
        })?;
        let irregularity = reader.checked(
            "irregularity",
            0.3,
            "a number of 0 or more and below 1",
            |x| (0.0..1.0).contains(&x),
        )?;
        let seed = reader.checked("seed", 1.0, "a whole number below 2^32", |x| {
            x.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&x)
        })?;
        let sigma = reader.positive("stiffness_nm_per_rad", 200.0)?;
        let apart = reader.at_least_zero("patch_deg", 0.0)?.to_radians();
        let bare = reader.checked("patch_share", 0.4, "a number above 0, at most 1", |x| {
            x > 0.0 && x <= 1.0
        })?;
        if apart > 0.0 && apart < 2.0 * pitch {
            return Err(reader.refused(
                "patch_deg",
                apart.to_degrees(),
                "0, or two pitches or more",
            ));
        }
        #[expect(clippy::cast_possible_truncation, reason = "at most 300")]
        let patches = (apart > 0.0).then(|| {
            let all = (apart / pitch).round();
            (all as i64, (bare * all).round().max(1.0) as i64)
        });
        if peak_nm < base_nm {
            return Err(reader.refused("peak_nm", peak_nm, "base_nm or more"));
        }
        let (height_nm, width) = (peak_nm - base_nm, share * pitch);
        if sigma * width < height_nm {
            let expected = "2(peak_nm − base_nm)/(width_share·pitch) or more";
            return Err(reader.refused("stiffness_nm_per_rad", sigma, expected));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole and in range"
        )]
        let seed = seed as u32;
        Ok(Self {
            base_nm,
            height_nm,
            pitch,
            width,
            irregularity,
            patches,
            key: seed.wrapping_mul(0x9E37_79B9),
            last: 0,
            play: Play::closed(sigma),
        })
    }

    /// h_k, from 0 to 1.
    fn share(&self, k: i64) -> f64 {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "all 32-bit wrapping"
        )]
        let k = k as u32;
        f64::from(lowbias32(k ^ self.key) >> 8) / f64::from(1_u32 << 24)
    }

    /// φ_n, rad.
    fn angle(&self, n: i64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "below 2^53")]
        let place = n as f64;
        self.pitch * (place + self.irregularity * (self.share(n.wrapping_mul(2)) - 0.5))
    }

    /// Returns whether asperity n is one: not beside the patches.
    fn is_there(&self, n: i64) -> bool {
        match self.patches {
            Some((all, there)) => n.rem_euclid(all) < there,
            None => true,
        }
    }

    /// The limit in front of asperity n, in the direction of `end`.
    fn limit(&self, n: i64, end: End) -> Limit {
        let odd = n.wrapping_mul(2).wrapping_add(1);
        let height = self.height_nm * (1.0 - self.irregularity * self.share(odd));
        Limit::Ramp {
            base: self.base_nm,
            height: if self.is_there(n) { height } else { 0.0 },
            peak: end.sign() * self.angle(n),
            width: self.width,
        }
    }

    fn limits(&self) -> Limits {
        Limits {
            upper: self.limit(self.last + 1, End::Upper),
            lower: self.limit(self.last, End::Lower),
        }
    }
}

impl Law for Texture {
    type Action = Action;

    fn arm(&mut self, at: &Instant) {
        #[expect(clippy::cast_possible_truncation, reason = "clamped")]
        let place = (at.x / self.pitch).floor().clamp(-MOST, MOST) as i64;
        self.last = place;
        while self.angle(self.last) > at.x && self.last > place - 2 {
            self.last -= 1;
        }
        while self.angle(self.last + 1) <= at.x && self.last < place + 2 {
            self.last += 1;
        }
        self.play.change(0.0, &self.limits(), at);
    }

    fn watches(&self, watches: &mut Watches<Action>) {
        for (end, guard) in [
            (End::Upper, Guard::above(self.angle(self.last + 1))),
            (End::Lower, Guard::below(self.angle(self.last))),
        ] {
            watches.push((When::Crosses(guard), Action::Cross(end)));
        }
        self.play.watches(&self.limits(), |when, action| {
            watches.push((when, Action::Play(action)));
        });
    }

    fn act(&mut self, action: Action, at: &Instant) -> Option<Reported> {
        match action {
            Action::Cross(end) => {
                let torque_nm = self.play.torque_nm(&self.limits(), at);
                let is_at_limit = self.play.mode == Mode::Flow(end);
                let crossed = if end == End::Upper {
                    self.last + 1
                } else {
                    self.last
                };
                self.last += if end == End::Upper { 1 } else { -1 };
                let limit_nm = self.limits().torque_nm(end, at);
                let falls = end.sign() * (torque_nm - limit_nm) > FELT_NM;
                if is_at_limit || falls {
                    self.play.change(torque_nm, &self.limits(), at);
                }
                (is_at_limit && self.is_there(crossed)).then(|| Kind::Snap.into())
            }
            Action::Play(action) => {
                self.play.act(action, &self.limits(), at);
                None
            }
        }
    }

    fn torque_nm(&self, at: &Instant) -> f64 {
        self.play.torque_nm(&self.limits(), at)
    }
}

fn lowbias32(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7FEB_352D);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}
