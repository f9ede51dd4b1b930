//! `range-limit`: the end of the range of motion, and how it feels: soft, firm,
//! hard, springy, or empty.
//!
//! On each side, with p = s·(φ − φw) and s = +1 in flexion, −1 in extension:
//!
//! ```text
//! env(p) = min(Tcap, K1·p + K2·p²)   p > 0        T = s·play(σ, 0 … env(p))
//! σ = √(K1² + 4·K2·Tcap)/(1 − ψ)
//! ```
//!
//! The play loses energy by hysteresis, as tissue does: a share ψ of what goes in
//! comes back less. A damper would make a sampled wall less stable, not more. The
//! wall yields past its cap on purpose: no motor of this size stops a leg.
//!
//! The end of the spring is an absolute angle. So a wall that is moved under the
//! leg, or armed inside, pushes nobody, and one that is moved away lets go.
//!
//! Sources: slopes of the healthy knee after Riener & Edrich 1999; end-feels after
//! Cyriax; the numbers here are derived or estimates.

mod wall;

use super::symptom::{Bounds, ClinicWords, Hear, Law, Word};
use super::{EffectSpec, Owner, PhaseSpec, Timing};
use crate::joint::SettingsError;
use crate::parameters::{Tabled, settings};
use crate::real::Real;
use crate::render::position::{Position, Scale, Travel};
use wall::Wall;

settings! {
    /// Both ends of the range.
    pub struct RangeLimitSettings, group "range-limit" {
        render (40 always) ["off", "on"], 0, "whether the range of motion is limited";
    } {
        extension_limit_deg (41 always) "φE" "deg", -10.0..=150.0, 10.0,
            "angle at which the range ends in extension (estimate)";
        flexion_limit_deg (42 always) "φF" "deg", 0.0..=160.0, 120.0,
            "angle at which the range ends in flexion, 5 deg or more beyond the other (estimate)";
        extension_stiffness_nm_per_rad (43 always) "K1" "N·m/rad", 1.0..=600.0, 60.0,
            "stiffness as the end in extension is met (derived)";
        extension_stiffening_nm_per_rad2 (44 always) "K2" "N·m/rad²", 0.0..=5000.0, 400.0,
            "how it grows stiffer beyond the end in extension (derived)";
        extension_loss (45 always) "ψ" "1", 0.0..=0.9, 0.3,
            "share of its energy that the end in extension does not return (estimate)";
        extension_torque_nm (46 always) "Tcap" "N·m", 0.0..=6.5, 4.0,
            "torque at which the end in extension yields (derived)";
        flexion_stiffness_nm_per_rad (47 always) "K1" "N·m/rad", 1.0..=600.0, 60.0,
            "stiffness as the end in flexion is met (derived)";
        flexion_stiffening_nm_per_rad2 (48 always) "K2" "N·m/rad²", 0.0..=5000.0, 400.0,
            "how it grows stiffer beyond the end in flexion (derived)";
        flexion_loss (49 always) "ψ" "1", 0.0..=0.9, 0.3,
            "share of its energy that the end in flexion does not return (estimate)";
        flexion_torque_nm (50 always) "Tcap" "N·m", 0.0..=6.5, 4.0,
            "torque at which the end in flexion yields (derived)";
    }
}

/// The stiffest spring of an end, N·m/rad.
pub const MOST_SPRING_NM_PER_RAD: f64 = 1000.0;

/// Stiffness beyond which a spring needs a loss to be quiet, N·m/rad.
const LOSSLESS_SPRING_NM_PER_RAD: f64 = 400.0;

/// The loss that it needs.
const LEAST_LOSS: f64 = 0.1;

/// The least distance of the two ends, deg.
pub const LEAST_RANGE_DEG: f64 = 5.0;

/// The numbers of one end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndFeel {
    /// K1, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// K2, N·m/rad².
    pub stiffening_nm_per_rad2: f64,
    /// ψ.
    pub loss: f64,
    /// Tcap, N·m.
    pub torque_nm: f64,
}

impl EndFeel {
    /// K_u, the stiffness of its spring, N·m/rad: no less than the steepest slope
    /// up to the cap.
    pub fn spring_nm_per_rad(&self) -> f64 {
        let (k1, k2) = (self.stiffness_nm_per_rad, self.stiffening_nm_per_rad2);
        libm::sqrt(k1 * k1 + 4.0 * k2 * self.torque_nm) / (1.0 - self.loss)
    }

    /// Checks that a sampled wall stays quiet.
    fn check(&self) -> Result<(), SettingsError> {
        let spring = self.spring_nm_per_rad();
        if spring > MOST_SPRING_NM_PER_RAD {
            return Err(SettingsError::Contradiction {
                reason: "range-limit: √(K1² + 4·K2·Tcap)/(1 − loss) must be at most 1000 N·m/rad",
            });
        }
        if spring > LOSSLESS_SPRING_NM_PER_RAD && self.loss < LEAST_LOSS {
            return Err(SettingsError::Contradiction {
                reason: "range-limit: an end whose √(K1² + 4·K2·Tcap)/(1 − loss) is above 400 N·m/rad must have \
                         a loss of at least 0.1",
            });
        }
        Ok(())
    }

    /// Distance beyond its place at which the end reaches its cap, rad.
    pub fn cap_rad(&self) -> f64 {
        let (k1, k2) = (self.stiffness_nm_per_rad, self.stiffening_nm_per_rad2);
        2.0 * self.torque_nm / (k1 + libm::sqrt(k1 * k1 + 4.0 * k2 * self.torque_nm))
    }
}

impl RangeLimitSettings {
    /// The end in extension.
    pub fn extension(&self) -> EndFeel {
        EndFeel {
            stiffness_nm_per_rad: self.extension_stiffness_nm_per_rad,
            stiffening_nm_per_rad2: self.extension_stiffening_nm_per_rad2,
            loss: self.extension_loss,
            torque_nm: self.extension_torque_nm,
        }
    }

    /// The end in flexion.
    pub fn flexion(&self) -> EndFeel {
        EndFeel {
            stiffness_nm_per_rad: self.flexion_stiffness_nm_per_rad,
            stiffening_nm_per_rad2: self.flexion_stiffening_nm_per_rad2,
            loss: self.flexion_loss,
            torque_nm: self.flexion_torque_nm,
        }
    }
}

/// Coefficients of one end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct End<F> {
    place: Position<F>,
    slope: F,
    bend: F,
    cap_nm: F,
    /// Distance beyond its place at which the cap is reached, rad.
    cap_rad: F,
    spring: F,
}

impl<F: Real> End<F> {
    fn new(limit_deg: f64, feel: &EndFeel, timing: &Timing) -> Self {
        Self {
            place: timing.sensing.position(limit_deg.to_radians()),
            slope: F::from_f64(feel.stiffness_nm_per_rad),
            bend: F::from_f64(feel.stiffening_nm_per_rad2),
            cap_nm: F::from_f64(feel.torque_nm),
            cap_rad: F::from_f64(feel.cap_rad()),
            spring: F::from_f64(feel.spring_nm_per_rad()),
        }
    }

    /// env(p), N·m.
    #[inline]
    fn envelope_nm(&self, beyond_rad: F) -> F {
        let p = beyond_rad.at_least(F::ZERO);
        (p * (self.slope + p * self.bend)).at_most(self.cap_nm)
    }
}

/// Coefficients of [`RangeLimit`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RangeLimitCoefficients<F> {
    scale: Scale<F>,
    flicker_rad: F,
    extension: End<F>,
    flexion: End<F>,
}

/// The ends of the range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeLimit<F> {
    with: RangeLimitCoefficients<F>,
    extension: Wall<F>,
    flexion: Wall<F>,
    torque_nm: F,
}

impl<F: Real> RangeLimit<F> {
    /// Releases what both ends have in common where they push against each other, as they may after a
    /// commit: nobody feels it. What one of them then loses is lost of the sum, too.
    fn cancel(&mut self) {
        let (extension, flexion) = (&mut self.extension.play, &mut self.flexion.play);
        let common_nm = extension.torque_nm().at_most(flexion.torque_nm());
        extension.release(common_nm);
        flexion.release(common_nm);
    }
}

impl<F: Real> Law for RangeLimit<F> {
    type Real = F;
    type Settings = RangeLimitSettings;
    type Coefficients = RangeLimitCoefficients<F>;

    const SPEC: EffectSpec = EffectSpec {
        name: "range-limit",
        adds: "the ends of a limited range of motion, with their end-feel",
        states: &["stretch in extension", "stretch in flexion"],
        column: "range_limit_nm",
        unit: "N·m",
        title: "End of the range, part of the model’s torque",
        phases: Some(PhaseSpec {
            column: "range_limit_phase",
            names: &["free", "in-the-wall", "at-its-cap"],
        }),
        needs: &[],
        parameters: RangeLimitSettings::TABLE,
        choices: RangeLimitSettings::CHOICES,
        of: Owner::Knee,
        sides: &["extension_", "flexion_"],
    };

    const WORDS: ClinicWords = ClinicWords {
        title: "End of the range of motion",
        states: &["free in the range", "in the end-feel", "the end yields"],
        changes: &[
            (0, 1, Word::Contact, "end of the range met"),
            (1, 2, Word::Cap, "the end yields"),
            (1, 0, Word::Leave, "out of the end"),
            (2, 0, Word::Leave, "out of the end"),
        ],
        within: &[],
    };

    fn check(s: &RangeLimitSettings) -> Result<(), SettingsError> {
        s.validate()?;
        if s.flexion_limit_deg < s.extension_limit_deg + LEAST_RANGE_DEG {
            return Err(SettingsError::Contradiction {
                reason: "range-limit: flexion_limit_deg must be at least 5 deg beyond extension_limit_deg",
            });
        }
        for end in [s.extension(), s.flexion()] {
            end.check()?;
        }
        Ok(())
    }

    fn bounds(s: &RangeLimitSettings) -> Bounds {
        let (extension, flexion) = (s.extension(), s.flexion());
        // Never at both ends.
        let stiffest = flexion.spring_nm_per_rad();
        Bounds {
            torque_nm: s.extension_torque_nm.max(s.flexion_torque_nm),
            slope_nm_per_rad: 0.0,
            stiffness_nm_per_rad: extension.spring_nm_per_rad().max(stiffest),
            is_wall: true,
        }
    }

    fn coefficients(
        settings: &RangeLimitSettings,
        timing: &Timing,
    ) -> Result<RangeLimitCoefficients<F>, SettingsError> {
        Self::check(settings)?;
        let s = settings;
        Ok(RangeLimitCoefficients {
            scale: timing.scale()?,
            flicker_rad: F::from_f64(timing.sensing.flicker_rad),
            extension: End::new(s.extension_limit_deg, &s.extension(), timing),
            flexion: End::new(s.flexion_limit_deg, &s.flexion(), timing),
        })
    }

    fn new(coefficients: RangeLimitCoefficients<F>) -> Self {
        Self {
            with: coefficients,
            extension: Wall::new(),
            flexion: Wall::new(),
            torque_nm: F::ZERO,
        }
    }

    fn rest(&mut self, place: &Position<F>) {
        let RangeLimitCoefficients {
            scale,
            extension,
            flexion,
            ..
        } = &self.with;
        self.extension.rest(extension, -F::ONE, place, scale);
        self.flexion.rest(flexion, F::ONE, place, scale);
        self.torque_nm = F::ZERO;
    }

    // By name in a profile: a test looks for it where it should not be.
    #[cfg_attr(target_os = "none", inline)]
    #[cfg_attr(not(target_os = "none"), inline(never))]
    fn follow(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        let RangeLimitCoefficients {
            flicker_rad,
            extension,
            flexion,
            ..
        } = &self.with;
        let extension_nm =
            self.extension
                .follow(extension, -F::ONE, *flicker_rad, travel, on_change);
        let flexion_nm = self
            .flexion
            .follow(flexion, F::ONE, *flicker_rad, travel, on_change);
        self.torque_nm = flexion_nm - extension_nm;
        self.torque_nm
    }

    fn torque_nm(&self) -> F {
        self.torque_nm
    }

    fn adopt(&mut self, coefficients: RangeLimitCoefficients<F>, slew_nm: F) {
        self.cancel();
        let (old, new) = (&self.with, &coefficients);
        for (wall, from, to) in [
            (&mut self.extension, &old.extension, &new.extension),
            (&mut self.flexion, &old.flexion, &new.flexion),
        ] {
            wall.play.change(from.spring, to.spring, slew_nm);
        }
        self.with = coefficients;
        self.torque_nm = self.flexion.play.torque_nm() - self.extension.play.torque_nm();
    }

    fn release(&mut self, slew_nm: F) {
        self.cancel();
        self.extension.play.release(slew_nm);
        self.flexion.play.release(slew_nm);
        self.torque_nm = self.flexion.play.torque_nm() - self.extension.play.torque_nm();
    }

    fn is_active(&self) -> bool {
        false
    }

    fn phase(&self) -> u16 {
        self.extension.stage.max(self.flexion.stage) as u16
    }
}
