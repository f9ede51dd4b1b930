//! `cogwheel`: rigidity with regular catches and gives, like a ratchet.
//!
//! ```text
//! T = play(σ, ±u) + ke·(φ − φ₀)        u = Th while high, ρ·Th while low        σ = Th/δ
//! mode time:   high for D/f, low for (1 − D)/f, from arming on
//! mode space:  high while φ/λ mod 1 < D
//! ```
//!
//! A *give* drops the torque at once; after a *catch* it rises as the hand moves. Its
//! full height needs Ω ≥ (1 − ρ)·δ·f/D; at rest there is one give, then silence.
//!
//! Both clocks are 64-bit fractions of a tooth: they lose nothing, however long.
//!
//! Sources: 6 to 6.5 Hz, in a second form 7.5 to 9 Hz (Findley, Gresty, Halmagyi
//! 1981); torques are estimates.

mod turn;

use super::play::{Hold, Limits, Part, Play, dragged};
use super::symptom::{Bounds, Change, ClinicWords, Hear, Law, Word};
use super::{EffectSpec, Owner, PhaseSpec, Timing};
use crate::joint::SettingsError;
use crate::parameters::{Tabled, settings};
use crate::real::Real;
use crate::render::position::{Position, Scale, Travel};
use turn::Turn;

settings! {
    /// Cogwheel rigidity.
    pub struct CogwheelSettings, group "cogwheel" {
        render (60 always) ["off", "on"], 0, "whether the joint resists as a ratchet does";
    } chosen {
        mode (61 always) ["time", "space"], 0, "whether teeth follow each other in time or in angle";
    } {
        torque_nm (62 always) "Th" "N·m", 0.0..=4.5, 2.0, "resistance at the height of a tooth (estimate)";
        low_share (63 always) "ρ" "1", 0.0..=1.0, 0.4, "share of it that is left between two teeth (estimate)";
        presliding_deg (64 always) "δ" "deg", 0.2..=10.0, 1.5, "travel over which the resistance builds up (sourced)";
        frequency_hz (65 always) "f" "Hz", 3.0..=12.0, 6.25, "teeth a second, in mode time (sourced)";
        duty (66 always) "D" "1", 0.1..=0.9, 0.5, "share of a tooth that is high (estimate)";
        pitch_deg (67 always) "λ" "deg", 1.0..=30.0, 7.5, "angle from tooth to tooth, in mode space (estimate)";
        elastic_nm_per_rad (68 always) "ke" "N·m/rad", 0.0..=10.0, 0.0,
            "stiffness about the neutral angle (estimate)";
        neutral_deg (69 always) "φ₀" "deg", 0.0..=140.0, 45.0,
            "angle at which the stiffness has no torque (estimate)";
    }
}

/// 2⁶⁴: a whole tooth.
const TOOTH: f64 = 18_446_744_073_709_551_616.0;

/// Drive of the wheel: time, or the angle of the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Clock {
    /// 2⁻⁶⁴ of a tooth in a tick.
    Time(u64),
    /// 2⁻⁶⁴ of a tooth in a count; and in 2⁻³² rad.
    Space(u64, u64),
}

impl Default for Clock {
    fn default() -> Self {
        Self::Time(0)
    }
}

/// Coefficients of [`Cogwheel`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CogwheelCoefficients<F> {
    scale: Scale<F>,
    clock: Clock,
    /// A tooth is low from here on.
    low_from: u64,
    /// Noise of the angle, 2⁻⁶⁴ of a tooth.
    flicker: u64,
    flicker_rad: F,
    high_nm: F,
    low_nm: F,
    stiffness: F,
    elastic: F,
    neutral: Position<F>,
}

/// The wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cogwheel<F> {
    with: CogwheelCoefficients<F>,
    play: Play<F>,
    elastic_nm: F,
    /// Place of the wheel within its tooth, 2⁻⁶⁴ of a tooth.
    at: u64,
    is_high: bool,
    /// Place of the joint as the height changed last.
    switched: Position<F>,
}

impl<F: Real> Law for Cogwheel<F> {
    type Real = F;
    type Settings = CogwheelSettings;
    type Coefficients = CogwheelCoefficients<F>;

    const SPEC: EffectSpec = EffectSpec {
        name: "cogwheel",
        adds: "rigidity with regular catches and gives",
        states: &["stretch", "place in the tooth"],
        column: "cogwheel_nm",
        unit: "N·m",
        title: "Cogwheel rigidity, part of the model’s torque",
        phases: Some(PhaseSpec {
            column: "cogwheel_phase",
            names: &["low", "high"],
        }),
        needs: &[],
        parameters: CogwheelSettings::TABLE,
        choices: CogwheelSettings::CHOICES,
        of: Owner::Knee,
        sides: &[],
    };

    const WORDS: ClinicWords = ClinicWords {
        title: "Cogwheel rigidity",
        states: &["between two teeth", "at a tooth"],
        changes: &[(0, 1, Word::Catch, "catch"), (1, 0, Word::Give, "give")],
        within: &[],
    };

    fn check(s: &CogwheelSettings) -> Result<(), SettingsError> {
        s.validate()?;
        Ok(())
    }

    fn bounds(s: &CogwheelSettings) -> Bounds {
        Bounds {
            torque_nm: s.torque_nm,
            slope_nm_per_rad: s.elastic_nm_per_rad,
            stiffness_nm_per_rad: s.torque_nm / s.presliding_deg.to_radians()
                + s.elastic_nm_per_rad,
            is_wall: false,
        }
    }

    fn coefficients(
        settings: &CogwheelSettings,
        timing: &Timing,
    ) -> Result<CogwheelCoefficients<F>, SettingsError> {
        Self::check(settings)?;
        let s = settings;
        let pitch_rad = s.pitch_deg.to_radians();
        Ok(CogwheelCoefficients {
            scale: timing.scale()?,
            clock: if s.mode == 0 {
                Clock::Time((s.frequency_hz * timing.step_s * TOOTH).whole())
            } else {
                Clock::Space(
                    (timing.sensing.rad_per_count / pitch_rad * TOOTH).whole(),
                    (TOOTH / (pitch_rad * RESTS)).whole(),
                )
            },
            low_from: (s.duty * TOOTH).whole(),
            flicker: (timing.sensing.flicker_rad / pitch_rad * TOOTH).whole(),
            flicker_rad: F::from_f64(timing.sensing.flicker_rad),
            high_nm: F::from_f64(s.torque_nm),
            low_nm: F::from_f64(s.low_share * s.torque_nm),
            stiffness: F::from_f64(s.torque_nm / s.presliding_deg.to_radians()),
            elastic: F::from_f64(s.elastic_nm_per_rad),
            neutral: timing.sensing.position(s.neutral_deg.to_radians()),
        })
    }

    fn new(coefficients: CogwheelCoefficients<F>) -> Self {
        Self {
            with: coefficients,
            play: Play::new(),
            elastic_nm: F::ZERO,
            at: 0,
            is_high: true,
            switched: Position::at(0),
        }
    }

    fn rest(&mut self, place: &Position<F>) {
        self.play.rest(place);
        self.elastic_nm = F::ZERO;
        self.at = match self.with.clock {
            Clock::Time(_) => 0,
            Clock::Space(per_count, per_rest) => {
                let at = self.angle(place, per_count, per_rest);
                // Exactly on an edge it is on its upper side.
                let edges = [0, self.with.low_from];
                let on = edges.into_iter().find(|edge| edge.wrapping_sub(at) < EDGE);
                if F::IS_SINGLE { at } else { on.unwrap_or(at) }
            }
        };
        self.is_high = self.at < self.with.low_from;
        self.switched = *place;
    }

    // By name in a profile: a test looks for it where it should not be.
    #[cfg_attr(target_os = "none", inline)]
    #[cfg_attr(not(target_os = "none"), inline(never))]
    fn follow(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        let before = self.at;
        let low_from = self.with.low_from;
        let (turned, back) = match self.with.clock {
            Clock::Time(per_tick) => {
                let turned = per_tick.wrapping_mul(u64::from(travel.ticks));
                self.at = before.wrapping_add(turned);
                (turned, false)
            }
            Clock::Space(per_count, per_rest) => {
                self.at = self.angle(&travel.to, per_count, per_rest);
                let turned = self.at.wrapping_sub(before);
                let back = travel.delta_rad < F::ZERO;
                (if back { turned.wrapping_neg() } else { turned }, back)
            }
        };
        let is_high = self.at < low_from;
        let mut from = F::ZERO;
        if is_high != self.is_high {
            let turn = Turn {
                before,
                turned,
                back,
            };
            from = self.switch(is_high, &turn, travel, on_change);
        }
        let with = &self.with;
        self.elastic_nm = with.elastic * travel.end_beyond(&with.neutral);
        let limits = self.limits();
        let part = Part::since(F::ONE, from);
        self.play
            .follow(travel, part, with.stiffness, |_| limits, on_change)
            + self.elastic_nm
    }

    fn torque_nm(&self) -> F {
        self.play.torque_nm() + self.elastic_nm
    }

    fn resting_nm(&self, place: &Position<F>) -> F {
        let with = &self.with;
        with.elastic * place.beyond(&with.neutral, with.scale.rad_per_count)
    }

    fn adopt(&mut self, coefficients: CogwheelCoefficients<F>, slew_nm: F) {
        let (from, to) = (self.with.stiffness, coefficients.stiffness);
        self.play.change(from, to, slew_nm);
        self.with = coefficients;
    }

    fn retime(&mut self, settings: &CogwheelSettings, timing: &Timing, _: f64) {
        if let Clock::Time(per_tick) = &mut self.with.clock {
            *per_tick = (settings.frequency_hz * timing.step_s * TOOTH).whole();
        }
    }

    fn release(&mut self, slew_nm: F) {
        self.play.release(slew_nm);
        self.elastic_nm = self.elastic_nm - self.elastic_nm.within(slew_nm);
    }

    fn is_active(&self) -> bool {
        false
    }

    fn phase(&self) -> u16 {
        u16::from(self.is_high)
    }
}

/// 2⁻³² rad in a radian.
const RESTS: f64 = 4_294_967_296.0;

/// An angle as part of a tooth.
#[inline]
fn angle<F: Real>(place: &Position<F>, per_count: u64, per_rest: u64) -> u64 {
    #[expect(clippy::cast_sign_loss, reason = "modulo a tooth, where −1 is 2⁶⁴ − 1")]
    let counts = (i64::from(place.count) as u64).wrapping_mul(per_count);
    if place.rest_rad == F::ZERO {
        return counts;
    }
    let rest = (place.rest_rad.abs() * F::from_f64(RESTS)).whole();
    let rest = rest.wrapping_mul(per_rest);
    if place.rest_rad < F::ZERO {
        counts.wrapping_sub(rest)
    } else {
        counts.wrapping_add(rest)
    }
}

/// Width of an edge in f64, 2⁻⁶⁴ of a tooth: more than the rounding of an angle of some turns.
const EDGE: u64 = 1 << 26;

impl<F: Real> Cogwheel<F> {
    /// An angle as part of a tooth. In f64 to its rounding, in f32 to 2⁻³² rad.
    #[inline]
    fn angle(&self, place: &Position<F>, per_count: u64, per_rest: u64) -> u64 {
        if F::IS_SINGLE {
            return angle(place, per_count, per_rest);
        }
        let counts = angle(&Position::<F>::at(place.count), per_count, per_rest);
        let rest = place.rest_rad.to_f64() / self.with.scale.rad_per_count.to_f64()
            * f64::from_whole(per_count);
        if rest < 0.0 {
            counts.wrapping_sub((-rest).whole())
        } else {
            counts.wrapping_add(rest.whole())
        }
    }

    /// Returns whether it is at an edge to rounding, on whichever side, or beyond it by so little: it has
    /// not passed it yet.
    fn is_at_edge(&self) -> bool {
        let is_at = |edge: u64| {
            let off = self.at.wrapping_sub(edge);
            off.min(off.wrapping_neg()) < EDGE
        };
        !F::IS_SINGLE && (is_at(0) || is_at(self.with.low_from))
    }

    #[inline]
    fn limits(&self) -> Limits<F> {
        Limits::both(if self.is_high {
            self.with.high_nm
        } else {
            self.with.low_nm
        })
    }

    /// A tooth begins or ends within the travel; the share of it that is behind then.
    #[cold]
    fn switch(
        &mut self,
        is_high: bool,
        turn: &Turn,
        travel: &Travel<F>,
        on_change: &mut impl Hear<F>,
    ) -> F {
        // Forwards it is high from 0 on, backwards from the end of its height.
        let edge = if is_high == turn.back {
            self.with.low_from
        } else {
            0
        };
        // Noise at the edge of a tooth is no edge.
        if matches!(self.with.clock, Clock::Space(..))
            && (turn.distance(edge, self.at) < self.with.flicker || self.is_at_edge())
        {
            return F::ZERO;
        }
        let fraction = turn.share(edge);
        let limits = self.limits();
        let until = Part::until(F::ONE, fraction);
        let before_nm = self
            .play
            .follow(travel, until, self.with.stiffness, |_| limits, on_change);
        self.is_high = is_high;
        let after_nm = before_nm.within(self.limits().upper_nm);
        let place = travel.place(fraction);
        // What is at the limit stays there, what is below is held.
        let Limits { lower_nm, upper_nm } = self.limits();
        let hold = if after_nm == upper_nm {
            dragged(Hold::Upper, upper_nm)
        } else if after_nm == lower_nm {
            Hold::Lower
        } else {
            Hold::Elastic
        };
        self.play.put(&place, after_nm, hold);
        let moved_rad = travel.to.beyond(&self.switched, travel.rad_per_count);
        self.switched = travel.to;
        let flicker_rad = self.with.flicker_rad;
        // A joint that turned back since the last edge may be where it was then, and moves.
        let moves = if F::IS_SINGLE || flicker_rad > F::ZERO {
            moved_rad.abs() > flicker_rad || travel.delta_rad.abs() > flicker_rad
        } else {
            // The joint's true velocity is known.
            travel.omega_start_rad_s != F::ZERO || travel.omega_end_rad_s != F::ZERO
        };
        // At rest one give is felt, then there is silence.
        if moves || after_nm != before_nm {
            let word = if is_high { Word::Catch } else { Word::Give };
            on_change.hear(Change::at(word, fraction, before_nm, after_nm));
        }
        fraction
    }
}

#[cfg(test)]
mod tests;
