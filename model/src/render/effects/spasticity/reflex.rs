//! The form `reflex`.
//!
//! ```text
//! u = min(Tmax, k·max(0, s·(φ − λ + μΩ)))        τa·ẏ + y = u(t − τd)        T = s·y
//! ```
//!
//! The answer is solved exactly for an input that is linear within a tick, and in f64 where
//! it jumps with the joint's velocity, too, as it does in a simulator. The lag of the
//! device's own velocity counts as part of τd. Passive below and active above some hertz;
//! with μ ≥ τd + τa it takes energy from a steady stretch.

use super::{SpasticitySettings, Threshold};
use crate::joint::SettingsError;
use crate::real::{InDouble, Real};
use crate::render::effects::Timing;
use crate::render::effects::symptom::{Hear, Word};
use crate::render::position::{Scale, Travel};

/// Ticks that are remembered: 0.1 s at 20 kHz, and one to interpolate.
const REMEMBERED: usize = 2048;

/// Jumps of the input that may be on their way: one more is answered as if it took a tick.
const JUMPS: usize = 8;

/// Coefficients of [`Reflex`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReflexCoefficients<F> {
    scale: Scale<F>,
    threshold: Threshold<F>,
    gain: F,
    most_nm: F,
    /// Tmax/k, rad: where the torque is largest; zero where there is none to give.
    most_rad: F,
    /// Whole ticks of the delay, and the rest of one.
    delay: usize,
    delay_rest: F,
    /// e = y − u ← e − lost·e − mean·(u1 − u0): y itself would come to rest short of u, where
    /// what it gains in a tick is less than its last digit.
    lost: F,
    mean: F,
}

impl<F: Real> ReflexCoefficients<F> {
    pub(super) fn new(
        s: &SpasticitySettings,
        threshold: Threshold<F>,
        timing: &Timing,
    ) -> Result<Self, SettingsError> {
        let lag_s = (s.delay_s - timing.sensing.velocity_lag_s).max(0.0);
        let ticks = lag_s / timing.step_s;
        // What is a whole number of ticks but for rounding is one.
        let whole = libm::floor(ticks + 1e-9);
        let delay = usize::try_from(whole.whole()).unwrap_or(usize::MAX);
        if delay > REMEMBERED.saturating_sub(2) {
            return Err(SettingsError::Contradiction {
                reason: "spasticity: in the form reflex delay_s may be 2046 steps at most: a shorter delay, or a \
                         longer step",
            });
        }
        let x = timing.step_s / s.activation_s;
        let lost = -libm::expm1(-x);
        Ok(Self {
            scale: timing.scale()?,
            threshold,
            gain: F::from_f64(s.gain_nm_per_rad),
            most_nm: F::from_f64(s.torque_nm),
            most_rad: F::from_f64(if s.gain_nm_per_rad > 0.0 {
                s.torque_nm / s.gain_nm_per_rad
            } else {
                0.0
            }),
            delay,
            delay_rest: F::from_f64((ticks - whole).max(0.0)),
            lost: F::from_f64(lost),
            mean: F::from_f64(lost / x),
        })
    }

    /// A tick in units of τa.
    fn tick(&self) -> F {
        self.lost / self.mean
    }

    /// u of a joint that is so far beyond the threshold, N·m.
    #[inline]
    fn input(&self, beyond: F) -> (Drive, F) {
        if beyond <= F::ZERO || self.most_rad == F::ZERO {
            (Drive::Silent, F::ZERO)
        } else if beyond < self.most_rad {
            (Drive::Rising, self.gain * beyond)
        } else {
            (Drive::Most, self.most_nm)
        }
    }
}

/// A jump of u within a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Jump<F> {
    /// Ticks since the end of its own.
    ago: usize,
    /// Share of its tick at which it is.
    at: F,
    /// Height of the jump, N·m; zero for none.
    nm: F,
}

impl<F: Real> Jump<F> {
    /// By how much u(t − τd) at the end of this tick is more than a straight line through the
    /// ends of the jump's own, and e for a jump that does not take all of this tick; forgets
    /// itself when that is over. N·m.
    fn passes(&mut self, with: &ReflexCoefficients<F>) -> (F, F) {
        // The share of the jump's tick that is answered, or that was a tick ago.
        let answered = F::ONE - with.delay_rest;
        let is_past = answered >= self.at;
        let nm = self.nm;
        let gained_nm = |since: F| nm * (with.mean - (-(with.tick() * since)).exp());
        if self.ago < with.delay {
            return (F::ZERO, F::ZERO);
        }
        if self.ago > with.delay {
            self.nm = F::ZERO;
            let is_now = !is_past && self.ago == with.delay.wrapping_add(1);
            let since = F::ONE + answered - self.at;
            return (F::ZERO, if is_now { gained_nm(since) } else { F::ZERO });
        }
        if is_past {
            (nm - nm * answered, gained_nm(answered - self.at))
        } else {
            (-(nm * answered), F::ZERO)
        }
    }
}

/// Jumps of the velocity, and parts of a tick: a simulator has them.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Within<F> {
    jumps: [Jump<F>; JUMPS],
    /// The one of them where the last travel began.
    jumped: Option<Jump<F>>,
    /// Share of the tick at which the next travel begins, and its length.
    from: F,
    length: F,
    /// Ω at the end of the last travel, rad/s.
    omega_rad_s: Option<F>,
}

impl<F: Real> Default for Within<F> {
    fn default() -> Self {
        Self {
            jumps: [Jump::default(); JUMPS],
            jumped: None,
            from: F::ZERO,
            length: F::ONE,
            omega_rad_s: None,
        }
    }
}

impl<F: Real> Within<F> {
    /// Keeps a jump of u where this travel begins.
    fn look(&mut self, travel: &Travel<F>, with: &ReflexCoefficients<F>) {
        self.jumped = None;
        let was_rad_s = self.omega_rad_s.replace(travel.omega_end_rad_s);
        if was_rad_s == Some(travel.omega_start_rad_s) || travel.ticks != 1 {
            return;
        }
        let input_nm = |omega_rad_s| {
            let travel = Travel {
                omega_start_rad_s: omega_rad_s,
                ..*travel
            };
            with.input(with.threshold.start_beyond(&travel)).1
        };
        // Nothing before the beginning.
        let was_nm = was_rad_s.map_or(F::ZERO, input_nm);
        let jump = Jump {
            ago: 0,
            at: self.from,
            nm: input_nm(travel.omega_start_rad_s) - was_nm,
        };
        self.jumped = Some(jump);
        self.keep(jump);
    }

    fn keep(&mut self, jump: Jump<F>) {
        if let Some(free) = self.jumps.iter_mut().find(|other| other.nm == F::ZERO) {
            *free = jump;
        }
    }

    /// Ends a tick: see [`Jump::passes`], for all of them.
    fn pass(&mut self, with: &ReflexCoefficients<F>) -> (F, F) {
        self.from = F::ZERO;
        let mut sum = (F::ZERO, F::ZERO);
        for jump in self.jumps.iter_mut().filter(|jump| jump.nm != F::ZERO) {
            let (step_nm, gained_nm) = jump.passes(with);
            sum = (sum.0 + step_nm, sum.1 + gained_nm);
            jump.ago = jump.ago.saturating_add(1);
        }
        sum
    }
}

/// Regime of u, the muscle's input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Drive {
    Silent,
    Rising,
    Most,
}

/// A muscle that answers late.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reflex<F: Real> {
    with: ReflexCoefficients<F>,
    /// u of the last ticks, the latest at `latest`.
    line: [F; REMEMBERED],
    latest: usize,
    /// Number of entries of `line` that are of this stretch.
    remembered: usize,
    /// u(t − τd) at the end of the last tick, N·m.
    delayed_nm: F,
    /// e, by how much y differs from it, N·m.
    lag_nm: F,
    drive: Drive,
    within: F::InDouble<Within<F>>,
}

impl<F: Real> Reflex<F> {
    pub(super) fn new(with: ReflexCoefficients<F>) -> Self {
        Self {
            with,
            line: [F::ZERO; REMEMBERED],
            latest: 0,
            remembered: 0,
            delayed_nm: F::ZERO,
            lag_nm: F::ZERO,
            drive: Drive::Silent,
            within: Default::default(),
        }
    }

    pub(super) fn rest(&mut self) {
        self.remembered = 0;
        self.delayed_nm = F::ZERO;
        self.lag_nm = F::ZERO;
        self.drive = Drive::Silent;
        self.within = Default::default();
    }

    pub(super) fn torque_nm(&self) -> F {
        self.with.threshold.sense * (self.delayed_nm + self.lag_nm)
    }

    pub(super) fn phase(&self) -> u16 {
        match self.drive {
            Drive::Silent => 0,
            Drive::Rising => 2,
            Drive::Most => 3,
        }
    }

    pub(super) fn adopt(&mut self, with: ReflexCoefficients<F>) {
        if with.threshold.sense == self.with.threshold.sense {
            self.with = with;
        } else {
            // The input of the other muscles is not for these.
            *self = Self::new(with);
        }
    }

    /// Goes on in ticks, or parts of a tick, of this length.
    pub(super) fn retime(&mut self, settings: &SpasticitySettings, timing: &Timing) {
        if let Some(within) = self.within.get() {
            let part = F::from_f64(timing.step_s / settings.activation_s);
            within.length = part / self.with.tick();
        }
    }

    /// Answers as it did before a part of a tick, which has no place of its own in its memory: the
    /// answer to the last part is that to the tick, and to the jumps within it.
    pub(super) fn forget_part(&mut self, before: &Self) {
        let mut part = *self;
        *self = Self {
            drive: part.drive,
            ..*before
        };
        if let (Some(within), Some(part)) = (self.within.get(), part.within.get()) {
            within.omega_rad_s = part.omega_rad_s;
            within.from += within.length;
            if let Some(jump) = part.jumped {
                within.keep(jump);
            }
        }
    }

    pub(super) fn release(&mut self, slew_nm: F) {
        let answer_nm = self.delayed_nm + self.lag_nm;
        self.lag_nm -= answer_nm.within(slew_nm);
    }

    /// Follows the joint; returns the torque, N·m. Not inlined: the form `catch` then saves
    /// no registers for it.
    #[inline(never)]
    pub(super) fn follow(&mut self, travel: &Travel<F>, on_change: &mut impl Hear<F>) -> F {
        let with = &self.with;
        let (drive, nm) = with.input(with.threshold.end_beyond(travel));
        if drive != self.drive {
            self.tell(drive, travel, on_change);
        }
        if let Some(within) = self.within.get() {
            within.look(travel, &self.with);
        }
        if travel.ticks == 1 {
            self.answer(nm);
        } else {
            self.answer_over_gap(nm, travel.ticks);
        }
        self.torque_nm()
    }

    #[cold]
    fn answer_over_gap(&mut self, nm: F, ticks: u32) {
        for _ in 0..ticks {
            self.answer(nm);
        }
    }

    /// Advances delay and activation filter by a tick; `nm` is their input.
    #[inline]
    fn answer(&mut self, nm: F) {
        self.remember(nm);
        let mut delayed_nm = self.delayed();
        let mut sooner_nm = F::ZERO;
        if let Some(within) = self.within.get() {
            let (step_nm, gained_nm) = within.pass(&self.with);
            delayed_nm += step_nm;
            sooner_nm = gained_nm;
        }
        let with = &self.with;
        let left_nm = self.lag_nm - with.lost * self.lag_nm + sooner_nm;
        self.lag_nm = (left_nm - with.mean * (delayed_nm - self.delayed_nm)).settled();
        self.delayed_nm = delayed_nm;
    }

    #[inline]
    fn remember(&mut self, nm: F) {
        self.latest = self.latest.wrapping_add(1) % REMEMBERED;
        if let Some(place) = self.line.get_mut(self.latest) {
            *place = nm;
        }
        self.remembered = self.remembered.saturating_add(1).min(REMEMBERED);
    }

    /// u(t − τd), N·m.
    #[inline]
    fn delayed(&self) -> F {
        let late = self.ago(self.with.delay);
        if self.with.delay_rest == F::ZERO {
            return late;
        }
        late + self.with.delay_rest * (self.ago(self.with.delay.wrapping_add(1)) - late)
    }

    /// u so many ticks ago, N·m; nothing before the beginning.
    #[inline]
    fn ago(&self, ticks: usize) -> F {
        if ticks >= self.remembered {
            return F::ZERO;
        }
        let index = self.latest.wrapping_sub(ticks) % REMEMBERED;
        self.line.get(index).copied().unwrap_or_default()
    }

    /// Says what has changed, and when.
    #[cold]
    fn tell(&mut self, drive: Drive, travel: &Travel<F>, on_change: &mut impl Hear<F>) {
        let threshold = &self.with.threshold;
        let start = threshold.start_beyond(travel);
        let nm = self.torque_nm();
        let mut tell = |word, level, rises: bool| {
            let fraction = || {
                if rises {
                    threshold.rises_to(level, start, travel)
                } else {
                    threshold.falls_to(level, start, travel)
                }
            };
            on_change.tell(word, fraction, nm, nm);
        };
        let most_rad = self.with.most_rad;
        if self.drive == Drive::Silent {
            tell(Word::Onset, F::ZERO, true);
        }
        if self.drive == Drive::Most {
            tell(Word::Uncap, most_rad, false);
        }
        if drive == Drive::Most {
            tell(Word::Cap, most_rad, true);
        }
        if drive == Drive::Silent {
            tell(Word::Offset, F::ZERO, false);
        }
        self.drive = drive;
    }
}
