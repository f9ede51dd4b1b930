//! Symptoms besides crepitus: laws of disorders that depend on the joint's angle.

use super::{EffectSpec, Observe, Timing};
use crate::joint::SettingsError;
use crate::real::Real;
use crate::render::position::{Position, Travel};
use crate::render::{Limit, Shown};

crate::named! {
    /// Kind of a symptom's event; the names are those of `events.csv`.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Word {
        /// The joint enters the wall.
        Contact => "contact",
        /// The joint leaves the wall.
        Leave => "leave",
        /// The torque has reached its largest.
        Cap => "cap",
        /// The torque falls below its largest again.
        Uncap => "uncap",
        /// A catch.
        Catch => "catch",
        /// The resistance gives way.
        Give => "give",
        /// The resistance can catch or build up again.
        Rearm => "rearm",
        /// Torque begins to build up.
        Onset => "onset",
        /// There is none any more.
        Offset => "offset",
        /// The resistance collapses.
        Release => "release",
        /// Turned back before it collapsed.
        Back => "back",
        /// Clonus starts.
        Start => "start",
        /// A beat.
        Beat => "beat",
        /// The muscle was let go: no further beat.
        Stop => "stop",
        /// All beats are over.
        Done => "done",
        /// An asperity is crossed.
        Snap => "snap",
        /// A play is dragged along.
        Flow => "flow",
        /// A play stops being dragged.
        Turn => "turn",
        /// The torque of a play has fallen to zero.
        Slack => "slack",
        /// A play takes up torque again.
        Take => "take",
        /// A beat or a reflex is over, of which the tank held a part back.
        Weak => "weak",
        /// A beat or a reflex is over, of which less than half the height was shown: too little
        /// to count.
        Unfelt => "unfelt",
    }
}

impl Word {
    /// Returns whether it is of the play under a symptom, of interest on request.
    pub fn is_of_play(self) -> bool {
        match self {
            Self::Flow | Self::Turn | Self::Slack | Self::Take => true,
            Self::Contact
            | Self::Leave
            | Self::Cap
            | Self::Uncap
            | Self::Catch
            | Self::Give
            | Self::Rearm
            | Self::Onset
            | Self::Offset
            | Self::Release
            | Self::Back
            | Self::Start
            | Self::Beat
            | Self::Stop
            | Self::Done
            | Self::Snap
            | Self::Weak
            | Self::Unfelt => false,
        }
    }
}

/// An event of a symptom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change<F> {
    /// Kind of the event.
    pub word: Word,
    /// Share of the travel at which it happened, 0 to 1.
    pub fraction: F,
    /// Torque just before, N·m; like what follows, against growing angle.
    pub before_nm: F,
    /// Torque just after, N·m.
    pub after_nm: F,
}

impl<F: Real> Change<F> {
    /// Made of its parts.
    #[inline]
    pub fn at(word: Word, fraction: F, before_nm: F, after_nm: F) -> Self {
        Self {
            word,
            fraction,
            before_nm,
            after_nm,
        }
    }
}

/// Hears what happens to a symptom.
pub trait Hear<F> {
    /// Whether it needs more than snaps. A device does not, and need not find out when
    /// all else was.
    const LISTENS: bool;

    /// Something has happened.
    fn hear(&mut self, change: Change<F>);

    /// The share of a travel at which an event happens, for events whose time changes no
    /// torque in f32: located in f64, or for a listener, and zero otherwise.
    #[inline]
    fn when(&self, when: impl FnOnce() -> F) -> F
    where
        F: Real,
    {
        if Self::LISTENS || !F::IS_SINGLE {
            when()
        } else {
            F::ZERO
        }
    }

    /// Tells of an event; when it was is found out only if somebody needs it.
    #[inline]
    fn tell(&mut self, word: Word, when: impl FnOnce() -> F, before_nm: F, after_nm: F) {
        if Self::LISTENS {
            self.hear(Change {
                word,
                fraction: when(),
                before_nm,
                after_nm,
            });
        }
    }
}

impl<F> Hear<F> for () {
    const LISTENS: bool = false;

    #[inline]
    fn hear(&mut self, _: Change<F>) {}
}

impl<F, O: FnMut(Change<F>)> Hear<F> for O {
    const LISTENS: bool = true;

    #[inline]
    fn hear(&mut self, change: Change<F>) {
        self(change);
    }
}

/// Receives a symptom's events on a device: by how much its torque has jumped.
struct Heard<'a, F, O> {
    spec: &'static EffectSpec,
    jump_nm: &'a mut F,
    observe: &'a mut O,
}

impl<F: Real, O: Observe<F>> Hear<F> for Heard<'_, F, O> {
    const LISTENS: bool = O::LISTENS;

    #[inline]
    fn hear(&mut self, change: Change<F>) {
        if change.word == Word::Snap {
            *self.jump_nm += change.after_nm - change.before_nm;
        }
        self.observe.change(self.spec, change);
    }
}

/// A symptom in the words of a clinic, and how its states follow each other: for reports,
/// no firmware has them.
#[derive(Clone, Copy, Debug)]
pub struct ClinicWords {
    /// Title above its charts.
    pub title: &'static str,
    /// States of the symptom, in the order of the numbers of its phases; the first one is at
    /// rest.
    pub states: &'static [&'static str],
    /// Changes from one state to another, by an event with this name.
    pub changes: &'static [(u16, u16, Word, &'static str)],
    /// Events within a state.
    pub within: &'static [(Word, &'static str)],
}

/// Bounds of a symptom's demand in any movement: the limits of the device, the pages of
/// a report and the supervision by comms are made of the sums.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Largest torque, but for what grows with the angle, N·m.
    pub torque_nm: f64,
    /// Slope of the torque that grows with the angle without end, N·m/rad.
    pub slope_nm_per_rad: f64,
    /// Stiffness where the symptom is a spring, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Whether it is a wall that a hand presses against: what keeps it quiet is the gear's
    /// friction.
    pub is_wall: bool,
}

/// The law of a symptom, with its state.
pub trait Law: Sized {
    /// The numbers that it computes with.
    type Real: Real;

    /// Parameters of the symptom.
    type Settings;

    /// Part of the law that a commit replaces; the default is that of a law that is off.
    type Coefficients: Copy + core::fmt::Debug + Default + PartialEq;

    /// Description of the symptom.
    const SPEC: EffectSpec;

    /// Words for the symptom in a report.
    const WORDS: ClinicWords;

    /// Checks ranges, and what holds between the settings.
    ///
    /// # Errors
    /// The first rule that is broken.
    fn check(settings: &Self::Settings) -> Result<(), SettingsError>;

    /// Bounds of its demand.
    fn bounds(settings: &Self::Settings) -> Bounds;

    /// Coefficients for settings; computed in f64 and rounded once.
    ///
    /// # Errors
    /// [`SettingsError`] if a setting or the tick is out of range.
    fn coefficients(
        settings: &Self::Settings,
        timing: &Timing,
    ) -> Result<Self::Coefficients, SettingsError>;

    /// Returns the law with these coefficients; [`Self::rest`] places it.
    fn new(coefficients: Self::Coefficients) -> Self;

    /// Puts it at rest as at arming: without torque at this place of the joint, whatever the place.
    fn rest(&mut self, place: &Position<Self::Real>);

    /// Follows the joint: its torque then, N·m.
    fn follow(
        &mut self,
        travel: &Travel<Self::Real>,
        on_change: &mut impl Hear<Self::Real>,
    ) -> Self::Real;

    /// The symptom's torque now, N·m.
    fn torque_nm(&self) -> Self::Real;

    /// The symptom's torque on a joint that rests at a place, N·m: of most none.
    fn resting_nm(&self, _place: &Position<Self::Real>) -> Self::Real {
        Self::Real::ZERO
    }

    /// Adopts these coefficients from now on; its torque goes on, and falls by at
    /// most `slew_nm` a tick to what they allow.
    fn adopt(&mut self, coefficients: Self::Coefficients, slew_nm: Self::Real);

    /// Goes on in ticks of another length, of which there were `ratio` in one of these before: a
    /// simulator splits a tick so where the shaft's motion breaks. The default is that of a law
    /// that counts no time.
    fn retime(&mut self, _settings: &Self::Settings, _timing: &Timing, _ratio: f64) {}

    /// Takes back what the last part of a tick has added to a memory of whole ticks: `before` is
    /// the law as that part began.
    fn forget_part(&mut self, _before: &Self) {}

    /// There are no samples: its torque falls by `slew_nm`.
    fn release(&mut self, slew_nm: Self::Real);

    /// Returns whether it gives energy: it is then paid from the tank.
    fn is_active(&self) -> bool;

    /// The number of its phase.
    fn phase(&self) -> u16;
}

/// Outputs of the symptoms in a tick besides their torque. They are rarely set, so they
/// live in memory and not in registers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Besides<F> {
    /// Jump of their torque where an asperity was crossed, N·m.
    pub(super) jump_nm: F,
    /// Their torque for which a tank pays, N·m.
    pub(super) active_nm: F,
    /// Sum of the magnitudes of what the tank holds back of each, N·m.
    pub(super) held_back_nm: F,
    /// One is on its way to other parameters.
    pub(super) is_settling: bool,
}

impl<F: Real> Besides<F> {
    /// No output.
    pub(super) const NOTHING: Self = Self {
        jump_nm: F::ZERO,
        active_nm: F::ZERO,
        held_back_nm: F::ZERO,
        is_settling: false,
    };

    /// Adds it to what is shown, of which a tank pays this share.
    #[inline]
    pub(super) fn add_to(&self, paid_share: F, shown: &mut Shown<F>) {
        shown.jump_nm += self.jump_nm;
        shown.active_nm += self.active_nm;
        shown.settling |= self.is_settling;
        if self.held_back_nm > F::ZERO {
            hold_back(paid_share, shown);
        }
    }

    /// Takes this share of the torque that a symptom asks for from the tank: returns it, N·m.
    #[inline]
    pub(super) fn pay(&mut self, asked_nm: F, paid_share: F) -> F {
        let paid_nm = paid_share * asked_nm;
        self.held_back_nm += (asked_nm - paid_nm).abs();
        paid_nm
    }
}

/// Notes that the tank pays no more than this share. A reason of the joint's stands: its torque is
/// supervised by that.
#[cold]
fn hold_back<F: Real>(paid_share: F, shown: &mut Shown<F>) {
    shown.held_back = F::ONE - paid_share;
    if shown.limit == Limit::None {
        shown.limit = Limit::Tank;
    }
}

/// Returns the torque of a law in a tick, N·m, before the tank scales it. Without a sample
/// to follow it is held.
#[inline]
pub(super) fn law_nm<L: Law>(
    law: &mut L,
    travel: Option<&Travel<L::Real>>,
    besides: &mut Besides<L::Real>,
    observe: &mut impl Observe<L::Real>,
) -> L::Real {
    let Some(travel) = travel else {
        return law.torque_nm();
    };
    let mut heard = Heard {
        spec: const { &<L as Law>::SPEC },
        jump_nm: &mut besides.jump_nm,
        observe,
    };
    law.follow(travel, &mut heard)
}

/// The sense of φ in which muscles are stretched: extensors in flexion.
pub(super) fn sense<F: Real>(muscles: u8) -> F {
    if muscles == 0 { F::ONE } else { -F::ONE }
}

/// The way back after which a muscle is armed again, rad: one that is only just reached counts, and
/// rounding of the place does not decide.
pub(super) fn way_back<F: Real>(deg: f64) -> F {
    const ROUNDINGS: f64 = 4.0;
    F::from_f64(deg.to_radians() - ROUNDINGS * F::EPSILON.to_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share of an event without and with a listener: one that shows in no torque is located in f64, or if
    /// somebody asks.
    fn located<F: Real>() -> [f64; 2] {
        let listener = |_: Change<F>| {};
        let half = || F::HALF;
        [Hear::<F>::when(&(), half), Hear::<F>::when(&listener, half)].map(F::to_f64)
    }

    #[test]
    fn a_time_that_nobody_needs_is_not_found() {
        assert_eq!(located::<f64>(), [0.5, 0.5]);
        assert_eq!(located::<f32>(), [0.0, 0.5]);
    }
}
