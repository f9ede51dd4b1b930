//! `clasp-knife`: resistance that builds, melts away at once, and stays away until
//! the limb is returned.
//!
//! ```text
//! out     u = 0                                              until s·(φ − φon) ≥ 0
//! build   u = T0 + k·s·(φ − φon)                             until s·(φ − φr) ≥ 0, or T ≥ Tr
//! fallen  u = Lr·[r + (1 − r)·e^(−(t − tr)/τ)], Lr the u at the release, at any angle
//!                                                            until s·(φon − φ) ≥ Δ
//! T = s·play(σ, 0 … u)
//! ```
//!
//! Turned back below φon while it builds, it is out again. In the tick of the
//! release the decay is linear.
//!
//! Sources: all numbers are estimates; the collapse to a fifth takes 85 ms.

mod building;

use super::play::{Limits, Part, Play};
use super::symptom::{Bounds, Change, ClinicWords, Hear, Law, Word, sense, way_back};
use super::{EffectSpec, Owner, PhaseSpec, Timing};
use crate::joint::SettingsError;
use crate::parameters::{Tabled, settings};
use crate::real::Real;
use crate::render::position::{Position, Scale, Travel, decay};

settings! {
    /// The clasp-knife phenomenon.
    pub struct ClaspKnifeSettings, group "clasp-knife" {
        render (90 always) ["off", "on"], 0, "whether a muscle's resistance collapses";
    } chosen {
        muscles (91 always) ["extensors", "flexors"], 0, "which muscles: extensors resist flexion, flexors extension";
        trigger (92 always) ["angle", "torque"], 0, "what makes it collapse";
    } {
        onset_deg (93 always) "φon" "deg", 0.0..=150.0, 30.0, "angle at which resistance begins to build (estimate)";
        release_deg (94 always) "φr" "deg", 0.0..=150.0, 75.0,
            "angle at which it collapses, further in the stretch's sense (estimate); trigger angle";
        onset_torque_nm (95 always) "T0" "N·m", 0.0..=4.5, 0.8, "resistance at its onset (estimate)";
        slope_nm_per_rad (96 always) "k" "N·m/rad", 0.0..=20.0, 3.0, "how it grows from there (estimate)";
        residual_share (97 always) "r" "1", 0.0..=0.9, 0.15, "share of it that is left after the collapse (estimate)";
        collapse_s (98 always) "τ" "s", 0.005..=0.3, 0.03, "time in which it collapses (estimate)";
        rearm_deg (99 always) "Δ" "deg", 2.0..=60.0, 10.0,
            "how far below the onset the limb is returned before it builds again (estimate)";
        catch_stiffness_nm_per_rad (100 always) "σ" "N·m/rad", 10.0..=300.0, 60.0,
            "stiffness with which it builds up (estimate)";
        release_torque_nm (101 always) "Tr" "N·m", 0.2..=4.5, 2.5,
            "torque at which it collapses (estimate); trigger torque";
    }
}

impl ClaspKnifeSettings {
    /// The torque with which it collapses, the largest, N·m.
    pub fn largest_torque_nm(&self) -> f64 {
        if self.trigger == 0 {
            let travel_rad = (self.release_deg - self.onset_deg).to_radians().abs();
            self.onset_torque_nm + self.slope_nm_per_rad * travel_rad
        } else {
            // Where it collapses while the play is still elastic, the torque rises on to the
            // limit of that place.
            let travel_rad = self.release_torque_nm / self.catch_stiffness_nm_per_rad;
            let limit_nm = self.onset_torque_nm + self.slope_nm_per_rad * travel_rad;
            self.release_torque_nm.max(limit_nm)
        }
    }
}

/// Coefficients of [`ClaspKnife`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClaspKnifeCoefficients<F> {
    scale: Scale<F>,
    sense: F,
    onset: Position<F>,
    /// Place of the collapse; `None` if a torque decides.
    release: Option<Position<F>>,
    release_nm: F,
    onset_nm: F,
    slope: F,
    residual: F,
    /// −h/τ, and the share that a tick loses.
    rate: F,
    lost: F,
    stiffness: F,
    rearm_rad: F,
}

/// State of the muscle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage<F> {
    Out,
    Build,
    Fallen {
        /// Lr·r, N·m.
        left_nm: F,
        /// Lr·(1 − r)·e^(−(t − tr)/τ), N·m.
        decaying_nm: F,
    },
    /// Fallen before the settings in force were committed: its limits may be above theirs.
    Outdated {
        left_nm: F,
        decaying_nm: F,
    },
}

/// The blade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClaspKnife<F> {
    with: ClaspKnifeCoefficients<F>,
    play: Play<F>,
    stage: Stage<F>,
    torque_nm: F,
}

impl<F: Real> Law for ClaspKnife<F> {
    type Real = F;
    type Settings = ClaspKnifeSettings;
    type Coefficients = ClaspKnifeCoefficients<F>;

    const SPEC: EffectSpec = EffectSpec {
        name: "clasp-knife",
        adds: "resistance that builds and collapses, and stays away until the limb is returned",
        states: &["stretch", "its decay"],
        column: "clasp_knife_nm",
        unit: "N·m",
        title: "Clasp-knife, part of the model’s torque",
        phases: Some(PhaseSpec {
            column: "clasp_knife_phase",
            names: &["out", "building", "fallen"],
        }),
        needs: &[],
        parameters: ClaspKnifeSettings::TABLE,
        choices: ClaspKnifeSettings::CHOICES,
        of: Owner::Knee,
        sides: &[],
    };

    const WORDS: ClinicWords = ClinicWords {
        title: "Clasp-knife phenomenon",
        states: &["relaxed", "resistance builds up", "collapsed"],
        changes: &[
            (0, 1, Word::Onset, "resistance begins"),
            (1, 2, Word::Release, "collapse"),
            (1, 0, Word::Back, "turned back before"),
            (2, 0, Word::Rearm, "can build again"),
        ],
        within: &[],
    };

    fn check(s: &ClaspKnifeSettings) -> Result<(), SettingsError> {
        s.validate()?;
        let along = if s.muscles == 0 { 1.0 } else { -1.0 };
        if (s.release_deg - s.onset_deg) * along <= 0.0 {
            return Err(SettingsError::Contradiction {
                reason: "clasp-knife: release_deg must be beyond onset_deg in the sense of the stretch: \
                         larger for extensors, smaller for flexors",
            });
        }
        Ok(())
    }

    fn bounds(s: &ClaspKnifeSettings) -> Bounds {
        Bounds {
            torque_nm: s.largest_torque_nm(),
            slope_nm_per_rad: s.slope_nm_per_rad,
            stiffness_nm_per_rad: s.catch_stiffness_nm_per_rad,
            is_wall: false,
        }
    }

    fn coefficients(
        settings: &ClaspKnifeSettings,
        timing: &Timing,
    ) -> Result<ClaspKnifeCoefficients<F>, SettingsError> {
        Self::check(settings)?;
        let s = settings;
        let place = |deg: f64| timing.sensing.position(deg.to_radians());
        Ok(ClaspKnifeCoefficients {
            scale: timing.scale()?,
            sense: sense(s.muscles),
            onset: place(s.onset_deg),
            release: (s.trigger == 0).then(|| place(s.release_deg)),
            release_nm: F::from_f64(s.release_torque_nm),
            onset_nm: F::from_f64(s.onset_torque_nm),
            slope: F::from_f64(s.slope_nm_per_rad),
            residual: F::from_f64(s.residual_share),
            rate: F::from_f64(-timing.step_s / s.collapse_s),
            lost: F::from_f64(-libm::expm1(-timing.step_s / s.collapse_s)),
            stiffness: F::from_f64(s.catch_stiffness_nm_per_rad),
            rearm_rad: way_back(s.rearm_deg),
        })
    }

    fn new(coefficients: ClaspKnifeCoefficients<F>) -> Self {
        Self {
            with: coefficients,
            play: Play::new(),
            stage: Stage::Out,
            torque_nm: F::ZERO,
        }
    }

    fn rest(&mut self, place: &Position<F>) {
        self.play.rest(place);
        self.stage = Stage::Out;
        self.torque_nm = F::ZERO;
    }

    // By name in a profile: a test looks for it where it should not be.
    #[cfg_attr(target_os = "none", inline)]
    #[cfg_attr(not(target_os = "none"), inline(never))]
    fn follow(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        let beyond_rad = self.with.sense * travel.end_beyond(&self.with.onset);
        let nm = match self.stage {
            Stage::Out if beyond_rad < F::ZERO => F::ZERO,
            Stage::Out => {
                let from = self.begin(travel, on_change);
                self.build(from, beyond_rad, travel, on_change)
            }
            Stage::Build if beyond_rad < F::ZERO => self.back(travel, on_change),
            Stage::Build => self.build(F::ZERO, beyond_rad, travel, on_change),
            Stage::Fallen {
                left_nm,
                decaying_nm,
            } => self.follow_fallen((left_nm, decaying_nm), beyond_rad, travel, on_change),
            Stage::Outdated {
                left_nm,
                decaying_nm,
            } => {
                let limits_nm = self.capped(left_nm, decaying_nm, beyond_rad);
                self.follow_fallen(limits_nm, beyond_rad, travel, on_change)
            }
        };
        self.torque_nm = self.with.sense * nm;
        self.torque_nm
    }

    fn torque_nm(&self) -> F {
        self.torque_nm
    }

    fn adopt(&mut self, coefficients: ClaspKnifeCoefficients<F>, slew_nm: F) {
        if coefficients.sense == self.with.sense {
            let (from, to) = (self.with.stiffness, coefficients.stiffness);
            self.play.change(from, to, slew_nm);
            self.torque_nm = coefficients.sense * self.play.torque_nm();
            self.with = coefficients;
            if let Stage::Fallen {
                left_nm,
                decaying_nm,
            } = self.stage
            {
                self.stage = Stage::Outdated {
                    left_nm,
                    decaying_nm,
                };
            }
        } else {
            *self = Self::new(coefficients);
        }
    }

    fn retime(&mut self, settings: &ClaspKnifeSettings, timing: &Timing, _: f64) {
        let share = timing.step_s / settings.collapse_s;
        self.with.rate = F::from_f64(-share);
        self.with.lost = F::from_f64(-libm::expm1(-share));
    }

    fn release(&mut self, slew_nm: F) {
        self.play.release(slew_nm);
        self.torque_nm = self.with.sense * self.play.torque_nm();
    }

    fn is_active(&self) -> bool {
        false
    }

    fn phase(&self) -> u16 {
        match self.stage {
            Stage::Out => 0,
            Stage::Build => 1,
            Stage::Fallen { .. } | Stage::Outdated { .. } => 2,
        }
    }
}

impl<F: Real> ClaspKnife<F> {
    /// Collapses after this share of the travel.
    #[cold]
    fn collapse(&mut self, fraction: F, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        let with = self.with;
        let place = travel.place(fraction);
        let beyond_rad = with.sense * place.beyond(&with.onset, travel.rad_per_count);
        let nm = self.grow(fraction, beyond_rad, travel, on_change);
        let limit_nm = self.limit_nm(beyond_rad);
        let shown_nm = with.sense * nm;
        on_change.hear(Change::at(Word::Release, fraction, shown_nm, shown_nm));
        let left_nm = limit_nm * with.residual;
        self.fall(fraction, (left_nm, limit_nm - left_nm), travel, on_change)
    }

    /// Fallen before this travel; rearmed once the joint has returned.
    #[inline]
    fn follow_fallen(
        &mut self,
        limits_nm: (F, F),
        beyond_rad: F,
        travel: &Travel<F>,
        on_change: &mut impl Hear<F>,
    ) -> F {
        let nm = self.fall(F::ZERO, limits_nm, travel, on_change);
        if -beyond_rad >= self.with.rearm_rad {
            self.rearm(travel, nm, on_change)
        } else {
            nm
        }
    }

    /// The residual and the decaying part of the limit, N·m, each at most that of a collapse
    /// at this angle under the settings in force. The play's torque slews down to them.
    #[cold]
    fn capped(&self, left_nm: F, decaying_nm: F, beyond_rad: F) -> (F, F) {
        let limit_nm = self.limit_nm(beyond_rad);
        let most_left_nm = limit_nm * self.with.residual;
        (
            left_nm.at_most(most_left_nm),
            decaying_nm.at_most(limit_nm - most_left_nm),
        )
    }

    /// Fallen, before this travel or at this share of it.
    #[inline]
    fn fall(
        &mut self,
        from: F,
        (left_nm, before_nm): (F, F),
        travel: &Travel<F>,
        on_change: &mut impl Hear<F>,
    ) -> F {
        let with = self.with;
        let after_nm = if from == F::ZERO {
            travel.decayed(before_nm, with.lost)
        } else {
            before_nm * decay(travel.exponent(with.rate, from, F::ONE))
        };
        let after_nm = after_nm.settled();
        let limits = |fraction: F| {
            let decaying_nm = if fraction == F::ONE {
                after_nm
            } else {
                before_nm * travel.exponent(with.rate, from, fraction).exp()
            };
            Limits {
                lower_nm: F::ZERO,
                upper_nm: left_nm + decaying_nm,
            }
        };
        self.stage = Stage::Fallen {
            left_nm,
            decaying_nm: after_nm,
        };
        let part = Part::since(with.sense, from);
        self.play
            .follow(travel, part, with.stiffness, limits, on_change)
    }

    /// Returned: it can build again.
    #[cold]
    fn rearm(&mut self, travel: &Travel<F>, nm: F, on_change: &mut impl Hear<F>) -> F {
        let sense = self.with.sense;
        let place = self.with.onset.moved(-sense * self.with.rearm_rad);
        let fraction = || travel.reaches(&place);
        on_change.tell(Word::Rearm, fraction, sense * nm, F::ZERO);
        self.stage = Stage::Out;
        self.play.rest(&travel.to);
        F::ZERO
    }
}
