//! `clonus`: beats that a quick stretch starts, while it is held.
//!
//! ```text
//! start where φ crosses φh in the stretch's sense with s·Ω ≥ Ωon; first beat after τd
//! interval n:   P = (1/f)·(1 + ε·2⁻ⁿ)
//! a beat:       T = s·A·sin(πx/(D·P))      for x from 0 to D·P
//! stop  where s·(φh − φ) ≥ hysteresis: no new beat, the one under way runs out
//! ```
//!
//! A slow crossing is passed over until the joint has returned. Time is counted in
//! ticks and fractions of one, so long clonus keeps its rhythm. It gives energy: a
//! tank pays for it.
//!
//! Sources: 5 to 8 Hz and a push for 45 % of the time (Physiopedia), 3.8 to 5.8 Hz
//! under load (Hidler & Rymer), the first beat the longest; the amplitude is an
//! estimate.

use super::symptom::{Bounds, Change, ClinicWords, Hear, Law, Word, sense, way_back};
use super::{EffectSpec, Owner, PhaseSpec, Timing};
use crate::joint::SettingsError;
use crate::parameters::{Tabled, settings};
use crate::real::Real;
use crate::render::position::{Position, Scale, Travel};

settings! {
    /// Clonus of one muscle group.
    pub struct ClonusSettings, group "clonus" {
        render (104 always) ["off", "on"], 0, "whether a quick stretch starts clonus";
    } chosen {
        muscles (105 always) ["extensors", "flexors"], 0,
            "which muscles: extensors beat against flexion, flexors against extension";
    } {
        frequency_hz (106 always) "f" "Hz", 3.0..=10.0, 6.0, "beats a second, once they are steady (sourced)";
        push_share (107 always) "D" "1", 0.2..=0.8, 0.45, "share of the time in which the muscle pushes (sourced)";
        first_stretch (108 always) "ε" "1", 0.0..=1.0, 0.3,
            "by how much the first interval is longer; half as much with every further one (sourced in kind)";
        amplitude_nm (109 always) "A" "N·m", 0.0..=4.5, 1.5, "height of a beat (estimate)";
        hold_deg (110 always) "φh" "deg", 0.0..=140.0, 60.0, "angle beyond which the stretch is held (estimate)";
        hysteresis_deg (111 always) "Δh" "deg", 1.0..=30.0, 5.0, "return that stops the beats (estimate)";
        start_velocity_deg_s (112 always) "Ωon" "deg/s", 20.0..=400.0, 100.0,
            "least speed of the stretch that starts them (estimate)";
        delay_s (113 always) "τd" "s", 0.0..=0.2, 0.05, "time from the stretch to the first beat (sourced)";
        beats (114 always) "n" "1", 0.0..=200.0, 0.0, "beats of one stretch; 0 goes on while it is held";
    }
}

/// Coefficients of [`Clonus`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClonusCoefficients<F> {
    scale: Scale<F>,
    sense: F,
    hold: Position<F>,
    back_rad: F,
    least_rad_s: F,
    amplitude_nm: F,
    /// 1/f, ticks.
    period: F,
    push_share: F,
    first_stretch: F,
    /// τd, ticks.
    delay: F,
    beats: u32,
}

/// State of the muscle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Waits for a stretch.
    Ready,
    /// Beats, or is about to.
    Beating,
    /// Waits for the joint's return: after a slow crossing or the last beat.
    Over,
}

/// Time since something began, ticks: whole ones, and a fraction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Since<F> {
    whole: u32,
    rest: F,
}

impl<F: Real> Since<F> {
    const NOW: Self = Self {
        whole: 0,
        rest: F::ZERO,
    };

    #[inline]
    fn ticks(&self) -> F {
        F::from_whole(u64::from(self.whole)) + self.rest
    }

    /// This time in ticks of another length, `ratio` of them in one of these.
    fn stretched(&self, ratio: f64) -> Self {
        let ticks = (f64::from(self.whole) + self.rest.to_f64()) * ratio;
        let whole = u32::try_from(ticks.whole()).unwrap_or(u32::MAX);
        Self {
            whole,
            rest: F::from_f64(ticks - f64::from(whole)),
        }
    }

    /// Time since an instant that is so many ticks later.
    fn later(&self, ticks: F) -> Self {
        let whole = ticks.whole();
        Self {
            whole: self
                .whole
                .saturating_sub(u32::try_from(whole).unwrap_or(u32::MAX)),
            rest: self.rest - (ticks - F::from_whole(whole)),
        }
    }
}

/// Beats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clonus<F> {
    with: ClonusCoefficients<F>,
    stage: Stage,
    /// Time since the interval began.
    interval_since: Since<F>,
    /// Time since the last beat began, which outlives its interval where the muscle is let
    /// go and stretched again.
    beat_since: Since<F>,
    /// The interval, ticks.
    interval: F,
    /// ε·2⁻ⁿ of the next interval.
    stretch: F,
    /// Beats so far; in the delay none.
    beaten: u32,
    /// 1/(D·P), per tick; 0 where no beat is under way.
    per_tick: F,
    torque_nm: F,
}

impl<F: Real> Law for Clonus<F> {
    type Real = F;
    type Settings = ClonusSettings;
    type Coefficients = ClonusCoefficients<F>;

    const SPEC: EffectSpec = EffectSpec {
        name: "clonus",
        adds: "beats that a quick stretch starts",
        states: &["time in the beat", "beats so far"],
        column: "clonus_nm",
        unit: "N·m",
        title: "Clonus, part of the model’s torque",
        phases: Some(PhaseSpec {
            column: "clonus_phase",
            names: &["ready", "beating", "over", "stopping"],
        }),
        needs: &[],
        parameters: ClonusSettings::TABLE,
        choices: ClonusSettings::CHOICES,
        of: Owner::Knee,
        sides: &[],
    };

    const WORDS: ClinicWords = ClinicWords {
        title: "Clonus",
        states: &[
            "no beats",
            "beating",
            "held without beats",
            "let go: the last beat runs out",
        ],
        changes: &[
            (0, 1, Word::Start, "quick stretch"),
            (1, 2, Word::Done, "beats are over"),
            (1, 0, Word::Stop, "let go"),
            (1, 3, Word::Stop, "let go"),
            (3, 1, Word::Start, "quick stretch"),
        ],
        within: &[(Word::Beat, "beat")],
    };

    fn check(s: &ClonusSettings) -> Result<(), SettingsError> {
        s.validate()?;
        if libm::trunc(s.beats) < s.beats {
            return Err(SettingsError::Contradiction {
                reason: "clonus: beats must be a whole number; 0 is without end",
            });
        }
        Ok(())
    }

    fn bounds(s: &ClonusSettings) -> Bounds {
        Bounds {
            torque_nm: s.amplitude_nm,
            ..Bounds::default()
        }
    }

    fn coefficients(
        settings: &ClonusSettings,
        timing: &Timing,
    ) -> Result<ClonusCoefficients<F>, SettingsError> {
        Self::check(settings)?;
        let s = settings;
        let ticks = |seconds: f64| F::from_f64(seconds / timing.step_s);
        Ok(ClonusCoefficients {
            scale: timing.scale()?,
            sense: sense(s.muscles),
            hold: timing.sensing.position(s.hold_deg.to_radians()),
            back_rad: way_back(s.hysteresis_deg),
            least_rad_s: F::from_f64(s.start_velocity_deg_s.to_radians()),
            amplitude_nm: F::from_f64(s.amplitude_nm),
            period: ticks(1.0 / s.frequency_hz),
            push_share: F::from_f64(s.push_share),
            first_stretch: F::from_f64(s.first_stretch),
            delay: ticks(s.delay_s),
            beats: u32::try_from(s.beats.whole()).unwrap_or(u32::MAX),
        })
    }

    fn new(coefficients: ClonusCoefficients<F>) -> Self {
        Self {
            with: coefficients,
            stage: Stage::Ready,
            interval_since: Since::NOW,
            beat_since: Since::NOW,
            interval: F::ZERO,
            stretch: F::ZERO,
            beaten: 0,
            per_tick: F::ZERO,
            torque_nm: F::ZERO,
        }
    }

    fn rest(&mut self, place: &Position<F>) {
        let beyond_rad =
            self.with.sense * place.beyond(&self.with.hold, self.with.scale.rad_per_count);
        *self = Self::new(self.with);
        if beyond_rad >= F::ZERO {
            self.stage = Stage::Over;
        }
    }

    // By name in a profile: a test looks for it where it should not be.
    #[cfg_attr(target_os = "none", inline)]
    #[cfg_attr(not(target_os = "none"), inline(never))]
    fn follow(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        let with = &self.with;
        let beyond_rad = with.sense * travel.end_beyond(&with.hold);
        let is_back = -beyond_rad >= with.back_rad;
        if self.per_tick > F::ZERO {
            self.beat_since.whole = self.beat_since.whole.saturating_add(travel.ticks);
        }
        match self.stage {
            Stage::Ready if beyond_rad >= F::ZERO => self.cross(travel, on_change),
            Stage::Beating => {
                self.interval_since.whole = self.interval_since.whole.saturating_add(travel.ticks);
                if is_back {
                    self.pace_until_stop(travel, on_change);
                } else {
                    self.pace(F::ZERO, travel, on_change);
                }
            }
            Stage::Ready | Stage::Over => {}
        }
        self.push();
        if self.stage != Stage::Ready && is_back {
            self.stop(travel, on_change);
        }
        self.torque_nm
    }

    fn torque_nm(&self) -> F {
        self.torque_nm
    }

    fn adopt(&mut self, coefficients: ClonusCoefficients<F>, _: F) {
        // Another rhythm begins with another stretch.
        *self = Self::new(coefficients);
        self.stage = Stage::Over;
    }

    fn retime(&mut self, settings: &ClonusSettings, timing: &Timing, ratio: f64) {
        let ticks = |seconds: f64| F::from_f64(seconds / timing.step_s);
        self.with.period = ticks(1.0 / settings.frequency_hz);
        self.with.delay = ticks(settings.delay_s);
        self.interval_since = self.interval_since.stretched(ratio);
        self.beat_since = self.beat_since.stretched(ratio);
        self.interval = F::from_f64(self.interval.to_f64() * ratio);
        self.per_tick = F::from_f64(self.per_tick.to_f64() / ratio);
    }

    fn release(&mut self, slew_nm: F) {
        self.torque_nm = self.torque_nm - self.torque_nm.within(slew_nm);
    }

    fn is_active(&self) -> bool {
        true
    }

    fn phase(&self) -> u16 {
        match self.stage {
            Stage::Ready if self.per_tick > F::ZERO => 3,
            Stage::Ready => 0,
            Stage::Beating => 1,
            Stage::Over => 2,
        }
    }
}

impl<F: Real> Clonus<F> {
    /// The joint crosses φh in the stretch's sense.
    #[cold]
    fn cross(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) {
        let fraction = travel.reaches(&self.with.hold);
        let rad_s = self.with.sense * travel.omega_rad_s(fraction);
        if rad_s < self.with.least_rad_s {
            self.stage = Stage::Over;
            return;
        }
        on_change.hear(Change::at(Word::Start, fraction, F::ZERO, F::ZERO));
        self.stage = Stage::Beating;
        self.interval_since = Since {
            whole: travel.ticks,
            rest: -fraction * F::from_whole(u64::from(travel.ticks)),
        };
        self.interval = self.with.delay;
        self.stretch = self.with.first_stretch;
        self.beaten = 0;
        self.pace(fraction, travel, on_change);
    }

    /// Begins the next beat when its time has come, within this tick after `from`.
    #[inline]
    fn pace(&mut self, from: F, travel: &Travel<F>, on_change: &mut impl Hear<F>) {
        let late = self.interval_since.ticks() - self.interval;
        if late >= F::ZERO {
            self.next(late, from, travel, on_change);
        }
    }

    /// Begins the next beat in a tick in which the joint returns: only if its time came before.
    #[inline]
    fn pace_until_stop(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) {
        let late = self.interval_since.ticks() - self.interval;
        if late >= F::ZERO && late >= self.stopped_since(travel) {
            self.next(late, F::ZERO, travel, on_change);
        }
    }

    /// Time since the joint returned within this tick, ticks.
    #[cold]
    fn stopped_since(&self, travel: &Travel<F>) -> F {
        let fraction = travel.reaches(&self.stop_place());
        (F::ONE - fraction) * F::from_whole(u64::from(travel.ticks))
    }

    /// Place at which the muscle is let go.
    fn stop_place(&self) -> Position<F> {
        let with = &self.with;
        with.hold.moved(-with.sense * with.back_rad)
    }

    /// The torque of the beat under way.
    #[inline]
    fn push(&mut self) {
        if self.per_tick == F::ZERO {
            return;
        }
        let share = self.beat_since.ticks() * self.per_tick;
        if share < F::ONE {
            self.torque_nm = self.with.sense * self.with.amplitude_nm * half_wave(share);
        } else {
            self.torque_nm = F::ZERO;
            self.per_tick = F::ZERO;
        }
    }

    /// An interval is over, so many ticks ago: the next beat, if there is one.
    #[cold]
    fn next(&mut self, late: F, from: F, travel: &Travel<F>, on_change: &mut impl Hear<F>) {
        let fraction = (F::ONE - late / F::from_whole(u64::from(travel.ticks))).at_least(from);
        if self.with.beats > 0 && self.beaten >= self.with.beats {
            on_change.hear(Change::at(Word::Done, fraction, F::ZERO, F::ZERO));
            self.stage = Stage::Over;
            return;
        }
        on_change.hear(Change::at(Word::Beat, fraction, F::ZERO, F::ZERO));
        self.interval_since = self.interval_since.later(self.interval);
        self.beat_since = self.interval_since;
        self.interval = self.with.period * (F::ONE + self.stretch);
        self.stretch = self.stretch * F::HALF;
        self.beaten = self.beaten.saturating_add(1);
        self.per_tick = F::ONE / (self.with.push_share * self.interval);
    }

    /// The joint has returned.
    #[cold]
    fn stop(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) {
        let place = self.stop_place();
        if self.beaten > 0 || self.stage == Stage::Beating {
            let nm = self.torque_nm;
            on_change.tell(Word::Stop, || travel.reaches(&place), nm, nm);
        }
        self.beaten = 0;
        self.stage = Stage::Ready;
    }
}

/// sin(πx) for x from 0 to 1, by its series about the middle.
#[inline]
fn half_wave<F: Real>(x: F) -> F {
    let t = (x - F::HALF) * F::from_f64(core::f64::consts::PI);
    let u = t * t;
    SERIES
        .iter()
        .fold(F::ZERO, |sum, part| sum * u + F::from_f64(*part))
}

/// Coefficients of the cosine's series, the smallest first.
const SERIES: [f64; 8] = [
    -1.0 / 87_178_291_200.0,
    1.0 / 479_001_600.0,
    -1.0 / 3_628_800.0,
    1.0 / 40_320.0,
    -1.0 / 720.0,
    1.0 / 24.0,
    -0.5,
    1.0,
];
