//! A hand that shakes a joint as the device renders it, and its books: how
//! much energy it gets back.

use super::criterion::BOUND_SLACK;
use super::input::Shake;
use super::locators::{WithLocator, with_locator};
use super::observation::Observation;
use super::subject::Subject;
use crepitus_model::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::guarded::InputLimits;
use crepitus_model::locate::Locate;
use crepitus_model::{
    Active, EnergyObserver, Real, Renderer, Sample, Settings, SettingsError, ShaftStep, Validated,
};
use crepitus_plant::encoder::Encoder;

/// A joint and the hand that shakes it.
pub(super) struct Shaken<'a> {
    pub(super) settings: Validated<Settings>,
    pub(super) shake: &'a Shake,
    pub(super) step_s: f64,
    pub(super) steps: u64,
}

/// What a tick shows to whoever draws it.
pub(super) struct Tick {
    pub(super) shown_nm: f64,
    pub(super) model_nm: f64,
    /// Work of the hand, J: against the torque shown, and against the joint's.
    pub(super) work_j: f64,
    pub(super) unguarded_work_j: f64,
}

/// The largest share of the bound's first term that was returned.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Returned {
    /// As the device renders it.
    pub(super) guarded: f64,
    /// Without the turn-back guard.
    pub(super) unguarded: f64,
}

impl Shaken<'_> {
    pub(super) fn observe<F: Real>(self, subject: Subject) -> Result<Observation, SettingsError> {
        let (step_s, steps) = (self.step_s, self.steps);
        let mut peak = 0.0_f64;
        let limit_nm = self.settings.parameters.static_torque_nm;
        let returned = self.run::<F>(subject, |tick| {
            peak = peak.max(tick.shown_nm.abs() / limit_nm);
        })?;
        Ok(Observation {
            steps,
            step_s,
            peak,
            above_s: (peak > 1.0 + BOUND_SLACK).then_some(0.0),
            returned: returned.guarded,
            ..Observation::default()
        })
    }

    /// Shakes, and shows every tick.
    pub(super) fn run<F: Real>(
        self,
        subject: Subject,
        on_tick: impl FnMut(&Tick),
    ) -> Result<Returned, SettingsError> {
        with_locator::<F, _>(subject.solver, Watched(self, on_tick))
    }
}

struct Watched<'a, W>(Shaken<'a>, W);

impl<F: Real, W: FnMut(&Tick)> WithLocator<F> for Watched<'_, W> {
    type Output = Result<Returned, SettingsError>;

    fn run<L: Locate<F>>(self) -> Self::Output {
        let Self(shaken, mut on_tick) = self;
        let Shake {
            amplitude_rad,
            frequency_hz,
            delay_ticks,
            counts,
        } = *shaken.shake;
        let active = Active::<F>::new(&shaken.settings, shaken.step_s)?;
        let settings = EncoderSettings::default();
        let encoder = Encoder::new(&settings);
        let turns_per_s = std::f64::consts::TAU * frequency_hz;
        let at = |n: u64| {
            let angle = turns_per_s * f64::from_whole(n) * shaken.step_s;
            (
                amplitude_rad * angle.sin(),
                amplitude_rad * turns_per_s * angle.cos(),
            )
        };
        let omega = F::from_f64(at(0).1);
        let mut reader = EncoderReader::<F>::new(&settings, shaken.step_s, 0, omega)?;
        let mut renderer = Renderer::<F, L>::new(
            active,
            InputLimits::device(shaken.step_s),
            F::from_f64(settings.rad_per_count()),
            omega,
        );
        let mut hand = EnergyObserver::new(
            &Active::<f64>::new(&shaken.settings, shaken.step_s)?,
            delay_ticks,
        );
        let mut unguarded = hand;
        for n in 0..shaken.steps {
            let ((from, omega_from), (to, omega_to)) = (at(n), at(n + 1));
            let shaft = if counts {
                reader.read(encoder.count(to))
            } else {
                ShaftStep {
                    delta_phi_rad: F::from_f64(to - from),
                    omega_start_rad_s: F::from_f64(omega_from),
                    omega_end_rad_s: F::from_f64(omega_to),
                }
            };
            let shown = renderer.tick(&Sample::Taken(shaft), |_| {});
            let (shown_nm, model_nm) = (shown.torque_nm.to_f64(), shown.model_torque_nm.to_f64());
            hand.tick(to - from, shown_nm);
            unguarded.tick(to - from, model_nm);
            on_tick(&Tick {
                shown_nm,
                model_nm,
                work_j: hand.work_j(),
                unguarded_work_j: unguarded.work_j(),
            });
        }
        Ok(Returned {
            guarded: hand.share(),
            unguarded: unguarded.share(),
        })
    }
}
