//! `range-limit`, one side: a wall with an end-feel (section 2).
//!
//! ```text
//! p = s(φ − φ_w)
//! u = min(Tcap, K1·p + K2·p²) for p > 0, ℓ = 0
//! σ = √(K1² + 4·K2·Tcap)/(1 − ψ)
//! ```
//!
//! Readings: `cap` is where the torque reaches the cap, on the envelope or on
//! the elastic line; it takes the place of `flow` there. To follow the envelope
//! from `contact` on, and to be armed inside, is no event. With K2 = 0 and
//! ψ = 0 the elastic line is the envelope: the torque follows it out to `leave`
//! without `turn` or `slack`. With Tcap = 0 there are only `contact` and
//! `leave`.

use super::guard::{Guard, When};
use super::keys::{Reader, SymptomError};
use super::limit::Limit;
use super::play::{End, Limits, Mode, Play, PlayAction};
use super::runner::{Instant, Law, Reported, Watches};
use super::{Word as Kind, of_one_sided};

/// Rounding of a torque that is at the cap, relative.
const AT_CAP: f64 = 1e-12;

/// A wall that resists growing x.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall {
    /// s·φ_w, rad.
    at: f64,
    /// K1, N·m/rad.
    stiffness: f64,
    /// K2, N·m/rad².
    stiffening: f64,
    /// Tcap, N·m.
    cap: f64,
    is_in: bool,
    /// True if the torque is at its limit and that limit is the cap.
    capped: bool,
    play: Play,
}

/// Actions of a wall.
#[derive(Clone, Copy, Debug)]
pub(super) enum Action {
    Contact,
    Leave,
    Cap,
    Play(PlayAction),
}

/// The extension and the flexion limit, each with its s.
pub(super) fn walls(reader: &Reader<'_>) -> Result<[(Wall, f64); 2], SymptomError> {
    let extension = Wall::read(reader, "extension_", 10.0, -1.0)?;
    let flexion = Wall::read(reader, "flexion_", 120.0, 1.0)?;
    if flexion.at <= -extension.at {
        let value = flexion.at.to_degrees();
        return Err(reader.refused("flexion_limit_deg", value, "more than extension_limit_deg"));
    }
    Ok([(extension, -1.0), (flexion, 1.0)])
}

impl Wall {
    /// The side with this prefix; a number without a prefix is of both sides.
    fn read(
        reader: &Reader<'_>,
        prefix: &str,
        default_deg: f64,
        sign: f64,
    ) -> Result<Self, SymptomError> {
        let own = |key: &str| format!("{prefix}{key}");
        let at_least_zero = |key: &str, default| {
            let both = reader.at_least_zero(key, default)?;
            reader.at_least_zero(&own(key), both)
        };
        let at = sign * reader.angle(&own("limit_deg"), default_deg)?;
        let key = "stiffness_nm_per_rad";
        let stiffness = reader.positive(&own(key), reader.positive(key, 60.0)?)?;
        let stiffening = at_least_zero("stiffening_nm_per_rad2", 400.0)?;
        let cap = at_least_zero("torque_nm", 4.0)?;
        let key = "loss";
        let is_loss = |x: f64| (0.0..1.0).contains(&x);
        let expected = "a number of 0 or more and below 1";
        let both = reader.checked(key, 0.3, expected, is_loss)?;
        let loss = reader.checked(&own(key), both, expected, is_loss)?;
        let sigma = (stiffness * stiffness + 4.0 * stiffening * cap).sqrt() / (1.0 - loss);
        Ok(Self {
            at,
            stiffness,
            stiffening,
            cap,
            is_in: false,
            capped: false,
            play: Play::closed(sigma),
        })
    }

    fn limits(&self) -> Limits {
        Limits::one_sided(Limit::Wall {
            at: self.at,
            stiffness: self.stiffness,
            stiffening: self.stiffening,
            cap: self.cap,
            capped: self.capped,
        })
    }

    /// s·φ where the envelope reaches the cap, rad.
    fn cap_at(&self) -> f64 {
        let (k1, k2) = (self.stiffness, self.stiffening);
        self.at + 2.0 * self.cap / (k1 + (k1 * k1 + 4.0 * k2 * self.cap).sqrt())
    }
}

impl Law for Wall {
    type Action = Action;

    fn arm(&mut self, at: &Instant) {
        self.is_in = at.x > self.at;
        if self.is_in && self.cap > 0.0 {
            self.play.change(0.0, &self.limits(), at);
        }
    }

    fn watches(&self, watches: &mut Watches<Action>) {
        if !self.is_in {
            watches.push((When::Crosses(Guard::above(self.at)), Action::Contact));
            return;
        }
        watches.push((When::Crosses(Guard::below(self.at)), Action::Leave));
        if self.play.mode == Mode::Flow(End::Upper) && !self.capped {
            watches.push((When::Crosses(Guard::above(self.cap_at())), Action::Cap));
        }
        self.play.watches(&self.limits(), |when, action| {
            watches.push((when, Action::Play(action)));
        });
    }

    fn act(&mut self, action: Action, at: &Instant) -> Option<Reported> {
        let kind = match action {
            Action::Contact => {
                self.is_in = true;
                self.capped = false;
                if self.cap > 0.0 {
                    self.play.mode = Mode::Flow(End::Upper);
                }
                Kind::Contact
            }
            Action::Leave => {
                self.is_in = false;
                self.play.mode = Mode::Closed;
                Kind::Leave
            }
            Action::Cap => {
                self.capped = true;
                Kind::Cap
            }
            Action::Play(action) => {
                let was = self.play.mode;
                let torque_nm = self.play.torque_nm(&self.limits(), at);
                self.play.act(action, &self.limits(), at);
                self.capped = action == PlayAction::Meet(End::Upper)
                    && torque_nm >= self.cap * (1.0 - AT_CAP);
                if self.capped {
                    Kind::Cap
                } else {
                    of_one_sided(action, was)
                }
            }
        };
        Some(kind.into())
    }

    fn torque_nm(&self, at: &Instant) -> f64 {
        self.play.torque_nm(&self.limits(), at)
    }
}
