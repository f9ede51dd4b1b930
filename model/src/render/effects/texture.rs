//! `texture`: asperities fixed to the angle, whose pitch rises with speed.
//!
//! ```text
//! φn = λ·(n + j·(h₂ₙ − ½))     Hn = (Tp − Tb)·(1 − j·h₂ₙ₊₁)     h: a hash of its number and the seed
//!  u = Tb + Hnext·max(0, 1 − (φnext − φ)/(wλ))
//! −ℓ = Tb + Hlast·max(0, 1 − (φ − φlast)/(wλ))                  T = play(σ, ℓ … u)
//! ```
//!
//! Clicks come at the same angles there and back: Ω/λ *snaps* a second, mean torque
//! Tb + w·(Tp − Tb)/2. Stick-slip alone has one pitch. With patches, P apart, of every N = P/λ
//! asperities only the first M = q·N are there: bone creaks on bone, and then glides again.
//!
//! Sources: detection of torque variation follows the spatial, not the temporal
//! specification (Tan et al.); torques in the paper's range; pitches are estimates.

mod asperities;

use super::play::{End, Hold, Limits, Part, Play};
use super::symptom::{Bounds, Change, ClinicWords, Hear, Law, Word};
use super::{EffectSpec, Owner, PhaseSpec, Timing};
use crate::joint::SettingsError;
use crate::parameters::{Tabled, settings};
use crate::real::Real;
use crate::render::position::{Position, Scale, Travel};
use asperities::{Beside, Pair};

settings! {
    /// A rough joint.
    pub struct TextureSettings, group "texture" {
        render (118 always) ["off", "on"], 0, "whether the joint has asperities at fixed angles";
    } {
        base_nm (119 always) "Tb" "N·m", 0.0..=2.0, 0.1,
            "resistance between asperities (estimate, in the paper's range)";
        peak_nm (120 always) "Tp" "N·m", 0.0..=4.0, 0.4,
            "resistance at an asperity, no less than between them (estimate, in the paper's range)";
        pitch_deg (121 always) "λ" "deg", 0.2..=20.0, 1.5, "angle from asperity to asperity (estimate)";
        width_share (122 always) "w" "1", 0.1..=1.0, 0.6,
            "share of the pitch over which the resistance rises (estimate)";
        irregularity (123 always) "j" "1", 0.0..=0.9, 0.3,
            "how much asperities differ in place and height (estimate)";
        seed (124 always) "seed" "1", 0.0..=4_294_967_295.0, 1.0, "another whole number is another joint";
        stiffness_nm_per_rad (125 always) "σ" "N·m/rad", 1.0..=400.0, 200.0,
            "stiffness of the joint within an asperity, no less than 2(Tp − Tb)/(wλ) (derived)";
        patch_deg (139 always) "P" "deg", 0.0..=60.0, 0.0,
            "angle from one patch of asperities to the next, two pitches or more; 0: they are everywhere (estimate)";
        patch_share (140 always) "q" "1", 0.05..=1.0, 0.4,
            "share of that angle in which there are asperities (estimate)";
    }
}

impl TextureSettings {
    /// Of how many asperities in a row how many are there: all of one without patches.
    pub fn patches(&self) -> (i32, i32) {
        let whole = |x: f64| i32::try_from(libm::round(x).whole()).unwrap_or(1);
        let all = whole(self.patch_deg / self.pitch_deg).max(1);
        let there = whole(self.patch_share * f64::from(all)).max(1);
        if self.patch_deg > 0.0 {
            (all, there)
        } else {
            (1, 1)
        }
    }
}

/// Parts of a count in which a pitch is known: 2⁻²⁰.
const PARTS: u32 = 20;

/// Coefficients of [`Texture`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TextureCoefficients<F> {
    scale: Scale<F>,
    base_nm: F,
    height_nm: F,
    /// λ in 2⁻²⁰ counts.
    pitch: i64,
    /// λ, rad, and its reciprocal.
    pitch_rad: F,
    per_pitch: F,
    /// Angle of 2⁻²⁰ counts, rad.
    rad_per_part: F,
    /// 1/(wλ), 1/rad.
    per_width: F,
    irregularity: F,
    /// Of `patch` asperities in a row the first `there` are there.
    patch: i32,
    there: i32,
    /// The seed, hashed.
    key: u32,
    stiffness: F,
    flicker_rad: F,
}

/// The rough joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texture<F> {
    with: TextureCoefficients<F>,
    play: Play<F>,
    /// The number of the last asperity, the one below, and its place in its patch.
    number: i32,
    place: i32,
    pair: Pair<F>,
    /// Place where the joint was seen last.
    at: Position<F>,
}

impl<F: Real> Law for Texture<F> {
    type Real = F;
    type Settings = TextureSettings;
    type Coefficients = TextureCoefficients<F>;

    const SPEC: EffectSpec = EffectSpec {
        name: "texture",
        adds: "asperities at fixed angles, whose pitch rises with speed",
        states: &["stretch", "the asperities beside it"],
        column: "texture_nm",
        unit: "N·m",
        title: "Texture, part of the model’s torque",
        phases: Some(PhaseSpec {
            column: "texture_phase",
            names: &["held", "sliding"],
        }),
        needs: &[],
        parameters: TextureSettings::TABLE,
        choices: TextureSettings::CHOICES,
        of: Owner::Knee,
        sides: &[],
    };

    const WORDS: ClinicWords = ClinicWords {
        title: "Rough joint",
        states: &["held at an asperity", "slides"],
        changes: &[],
        within: &[(Word::Snap, "snap over an asperity")],
    };

    fn check(s: &TextureSettings) -> Result<(), SettingsError> {
        s.validate()?;
        if libm::trunc(s.seed) < s.seed {
            return Err(SettingsError::Contradiction {
                reason: "texture: seed must be a whole number",
            });
        }
        let height_nm = s.peak_nm - s.base_nm;
        if height_nm < 0.0 {
            return Err(SettingsError::Contradiction {
                reason: "texture: peak_nm must be no less than base_nm",
            });
        }
        let width_rad = s.width_share * s.pitch_deg.to_radians();
        // Rounding must not refuse the least stiffness itself.
        if s.stiffness_nm_per_rad * (1.0 + 1e-9) < 2.0 * height_nm / width_rad {
            return Err(SettingsError::Contradiction {
                reason: "texture: stiffness_nm_per_rad must be no less than \
                         2(peak_nm − base_nm)/(width_share·pitch_deg), the angle in rad",
            });
        }
        if s.patch_deg > 0.0 && s.patch_deg < 2.0 * s.pitch_deg {
            return Err(SettingsError::Contradiction {
                reason: "texture: patch_deg must be 0 or two pitches or more",
            });
        }
        Ok(())
    }

    fn bounds(s: &TextureSettings) -> Bounds {
        Bounds {
            torque_nm: s.peak_nm,
            slope_nm_per_rad: 0.0,
            stiffness_nm_per_rad: s.stiffness_nm_per_rad,
            is_wall: false,
        }
    }

    fn coefficients(
        settings: &TextureSettings,
        timing: &Timing,
    ) -> Result<TextureCoefficients<F>, SettingsError> {
        Self::check(settings)?;
        let s = settings;
        let pitch_rad = s.pitch_deg.to_radians();
        let width_rad = s.width_share * pitch_rad;
        let height_nm = s.peak_nm - s.base_nm;
        let rad_per_count = timing.sensing.rad_per_count;
        let parts = pitch_rad / rad_per_count * f64::from(1_u32 << PARTS);
        let seed = u32::try_from(s.seed.whole()).unwrap_or(u32::MAX);
        let (patch, there) = s.patches();
        Ok(TextureCoefficients {
            scale: timing.scale()?,
            base_nm: F::from_f64(s.base_nm),
            height_nm: F::from_f64(height_nm),
            pitch: i64::try_from(libm::round(parts).whole()).unwrap_or(i64::MAX),
            pitch_rad: F::from_f64(pitch_rad),
            per_pitch: F::from_f64(1.0 / pitch_rad),
            rad_per_part: F::from_f64(rad_per_count / f64::from(1_u32 << PARTS)),
            per_width: F::from_f64(1.0 / width_rad),
            irregularity: F::from_f64(s.irregularity),
            patch,
            there,
            key: seed.wrapping_mul(0x9E37_79B9),
            stiffness: F::from_f64(s.stiffness_nm_per_rad),
            flicker_rad: F::from_f64(timing.sensing.flicker_rad),
        })
    }

    fn new(coefficients: TextureCoefficients<F>) -> Self {
        Self {
            with: coefficients,
            play: Play::new(),
            number: 0,
            place: 0,
            pair: coefficients.pair(0, 0),
            at: Position::at(0),
        }
    }

    fn rest(&mut self, place: &Position<F>) {
        self.play.rest(place);
        self.at = *place;
        self.seek(place);
    }

    // By name in a profile: a test looks for it where it should not be.
    #[cfg_attr(target_os = "none", inline)]
    #[cfg_attr(not(target_os = "none"), inline(never))]
    fn follow(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        self.at = travel.to;
        let beside = self.pair.beside(&travel.to, travel.rad_per_count);
        let upwards = beside.to_next_rad <= F::ZERO;
        if upwards || beside.from_last_rad < -self.with.flicker_rad {
            return self.cross(upwards, &beside, travel, on_change);
        }
        self.slide(&beside, Part::whole(F::ONE), travel)
    }

    fn torque_nm(&self) -> F {
        self.play.torque_nm()
    }

    fn adopt(&mut self, coefficients: TextureCoefficients<F>, slew_nm: F) {
        let (from, to) = (self.with.stiffness, coefficients.stiffness);
        self.play.change(from, to, slew_nm);
        self.with = coefficients;
        let place = self.at;
        self.seek(&place);
    }

    fn release(&mut self, slew_nm: F) {
        self.play.release(slew_nm);
    }

    fn is_active(&self) -> bool {
        false
    }

    fn phase(&self) -> u16 {
        u16::from(self.play.hold() != Hold::Elastic)
    }
}

impl<F: Real> Texture<F> {
    /// Finds the asperities beside a place.
    #[cold]
    fn seek(&mut self, place: &Position<F>) {
        let origin = Position::at(0);
        let rad_per_count = self.with.scale.rad_per_count;
        let turns = place.beyond(&origin, rad_per_count) * self.with.per_pitch;
        // Within one of it; asperities are at most half a pitch off their number.
        let number = turns.abs().whole().min(1 << 30);
        let number = i32::try_from(number).unwrap_or(i32::MAX);
        self.number = if turns < F::ZERO { -number } else { number };
        self.place = self.with.place(self.number);
        self.pair = self.with.pair(self.number, self.place);
        for _ in 0..3 {
            let beside = self.pair.beside(place, rad_per_count);
            if beside.to_next_rad <= F::ZERO {
                self.step(true);
            } else if beside.from_last_rad < F::ZERO {
                self.step(false);
            } else {
                break;
            }
        }
    }

    /// Follows the joint to the travel's end, between two asperities.
    #[inline]
    fn slide(&mut self, beside: &Beside<F>, part: Part<F>, travel: &Travel<F>) -> F {
        let (with, pair) = (&self.with, &self.pair);
        let end = End {
            place: travel.to,
            limits: pair.limits(with, beside),
        };
        let limits = |fraction: F| {
            let place = travel.place(fraction);
            pair.limits(with, &pair.beside(&place, travel.rad_per_count))
        };
        // What the play does by itself is the texture, no event.
        self.play
            .follow_to(&end, (travel, part), with.stiffness, limits, &mut ())
    }

    /// Crosses the asperities that lie in a travel, at most one in a tick.
    #[cold]
    fn cross(
        &mut self,
        upwards: bool,
        beside: &Beside<F>,
        travel: &Travel<F>,
        on_change: &mut impl Hear<F>,
    ) -> F {
        let (crossed, beyond_rad) = if upwards {
            (&self.pair.next, -beside.to_next_rad)
        } else {
            (&self.pair.last, beside.from_last_rad)
        };
        let (asperity, is_there) = (crossed.place, crossed.is_there);
        // Noise is waited out, so a joint may have passed it before this travel.
        let start_rad = beyond_rad - travel.delta_rad;
        let place = if (start_rad > F::ZERO) == upwards && start_rad != F::ZERO {
            travel.place(F::ZERO)
        } else {
            asperity
        };
        let fraction = on_change.when(|| travel.reaches(&asperity));
        let before_nm = self.climb(upwards, &place, fraction, travel);
        let is_at_limit = match self.play.hold() {
            Hold::Elastic => false,
            Hold::Upper => upwards,
            Hold::Lower => !upwards,
            Hold::Slack => true,
        };
        self.step(upwards);
        let Limits { lower_nm, upper_nm } = self.pair.limits_at(&self.with, !upwards, &place);
        let after_nm = before_nm.at_most(upper_nm).at_least(lower_nm);
        self.play.put(&place, after_nm, Hold::Elastic);
        if is_at_limit && is_there {
            on_change.hear(Change::at(Word::Snap, fraction, before_nm, after_nm));
        }
        let beside = self.pair.beside(&travel.to, travel.rad_per_count);
        if beside.to_next_rad > F::ZERO && beside.from_last_rad >= -self.with.flicker_rad {
            return self.slide(&beside, Part::since(F::ONE, fraction), travel);
        }
        self.land(after_nm, travel)
    }

    /// Follows the joint up to the asperity that it crosses; returns the torque just before.
    #[inline]
    fn climb(&mut self, upwards: bool, place: &Position<F>, fraction: F, travel: &Travel<F>) -> F {
        let (with, pair) = (&self.with, &self.pair);
        let end = End {
            place: *place,
            limits: pair.limits_at(with, upwards, place),
        };
        let limits = |fraction: F| {
            let place = travel.place(fraction);
            pair.limits(with, &pair.beside(&place, travel.rad_per_count))
        };
        let part = Part::until(F::ONE, fraction);
        self.play
            .follow_to(&end, (travel, part), with.stiffness, limits, &mut ())
    }

    /// Puts the play at the joint's present place, which after a gap may lie several asperities on: no
    /// late snap of each.
    #[cold]
    fn land(&mut self, nm: F, travel: &Travel<F>) -> F {
        self.seek(&travel.to);
        let beside = self.pair.beside(&travel.to, travel.rad_per_count);
        let Limits { lower_nm, upper_nm } = self.pair.limits(&self.with, &beside);
        self.play.put(
            &travel.to,
            nm.at_most(upper_nm).at_least(lower_nm),
            Hold::Elastic,
        );
        self.slide(&beside, Part::since(F::ONE, F::ONE), travel)
    }
}
