//! A frozen joint as the device renders it, with lost samples and parameters
//! committed during the run.

use super::input::Rendered;
use super::locators::with_locator;
use super::observation::Observation;
use super::parameter_changes::SLEW_NM_PER_S;
use super::subject::Subject;
use crate::sampling::{Sampling, Walk};
use crate::true_events::TimedEvent;
use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::joint::shaft::Linear;
use crepitus_model::render::Limit;
use crepitus_model::render::input_check::InputLimits;
use crepitus_model::solver::LocatorVisitor;
use crepitus_model::solver::locate::Locate;
use crepitus_model::{
    Event, Real, Renderer, Sample, Settings, SettingsError, ShaftStep, StepCoefficients, StickSlip,
    Validated,
};
use crepitus_plant::encoder::Encoder;

/// A run of a joint in a device.
pub(super) struct RenderedRun<'a> {
    pub(super) settings: Validated<Settings>,
    pub(super) sampling: Sampling<'a>,
    pub(super) rendered: &'a Rendered,
    /// Start of the late torque, s.
    pub(super) late_s: f64,
}

impl RenderedRun<'_> {
    pub(super) fn observe<F: Real>(self, subject: Subject) -> Result<Observation, SettingsError> {
        with_locator::<F, _>(subject, self)
    }

    /// The committed parameters, in turn.
    fn commits<F: Real>(&self) -> Result<Vec<StepCoefficients<F>>, SettingsError> {
        let step_s = self.sampling.step_s();
        let coefficients = |&parameters| {
            let next = Settings {
                parameters,
                ..*self.settings
            };
            StepCoefficients::new(&next.validate()?, step_s)
        };
        self.rendered.commits.iter().map(coefficients).collect()
    }
}

impl<F: Real> LocatorVisitor<F> for RenderedRun<'_> {
    type Output = Result<Observation, SettingsError>;

    fn visit<L: Locate<F, Shape = Linear>>(self) -> Self::Output {
        let (step_s, rendered) = (self.sampling.step_s(), self.rendered);
        let commits = self.commits::<F>()?;
        let mut view = ShaftView::new(self.sampling.walk_from(0), rendered.counts, step_s)?;
        let mut renderer = Renderer::<F, L>::of(
            StepCoefficients::new(&self.settings, step_s)?,
            InputLimits::device(step_s),
            F::from_f64(EncoderSettings::default().rad_per_count()),
            view.omega(),
        );
        let late_step = (self.late_s / step_s).ceil().whole();
        let mut seen = Observation {
            step_s,
            ..Observation::default()
        };
        let mut next = commits.iter().cycle();
        for n in 1..=self.sampling.steps() {
            if rendered.commit_every > 0
                && n.is_multiple_of(rendered.commit_every)
                && let Some(coefficients) = next.next()
            {
                renderer.commit(*coefficients, SLEW_NM_PER_S);
            }
            let sample = view.sample(rendered.lost.takes(n, step_s));
            let (since, sampling) = (seen.steps.saturating_sub(view.missed), &self.sampling);
            let span = f64::from_whole(view.missed + 1);
            let tally = &mut seen.tally;
            let shown = renderer.render(&sample, |event: Event<F>| {
                let time_s = sampling.time_s(since, span * event.fraction.to_f64());
                tally.add(&TimedEvent::new(time_s, &event));
            });
            view.missed = match sample {
                Sample::Lost => view.missed + 1,
                Sample::Taken(_) => 0,
            };
            let limit_nm = renderer.joint().coefficients().static_nm.to_f64();
            observe::<F>(&mut seen, shown.torque_nm.to_f64(), limit_nm, late_step);
            seen.guard_ticks += u64::from(shown.limit == Limit::TurnedBack);
        }
        Ok(seen)
    }
}

/// Records the torque of a tick.
fn observe<F: Real>(seen: &mut Observation, torque_nm: f64, limit_nm: f64, late_step: u64) {
    let now_s = f64::from_whole(seen.steps) * seen.step_s;
    seen.steps += 1;
    if !torque_nm.is_finite() {
        seen.overflow_s.get_or_insert(now_s);
    }
    if torque_nm.abs() > limit_nm {
        seen.above_s.get_or_insert(now_s);
    }
    if seen.steps > late_step {
        seen.late_torque.add(torque_nm);
    }
    seen.add_torque::<F>(torque_nm);
    seen.peak = seen.peak.max(torque_nm.abs() / limit_nm);
}

/// The joint's samples of the shaft: the true motion, or the encoder's counts.
struct ShaftView<'a, F> {
    walk: Walk<'a>,
    chunk: Vec<ShaftStep<F>>,
    encoder: Encoder,
    reader: EncoderReader<F>,
    counts: bool,
    /// Samples lost since the last valid one, and their travel, rad.
    missed: u64,
    travel: F,
}

impl<'a, F: Real> ShaftView<'a, F> {
    fn new(walk: Walk<'a>, counts: bool, step_s: f64) -> Result<Self, SettingsError> {
        let settings = EncoderSettings::default();
        let encoder = Encoder::new(&settings);
        let (angle_rad, omega_rad_s) = walk.now();
        let omega = F::from_f64(omega_rad_s);
        let first = encoder.count(angle_rad);
        Ok(Self {
            walk,
            chunk: Vec::new(),
            reader: EncoderReader::new(&settings, step_s, first, omega)?,
            encoder,
            counts,
            missed: 0,
            travel: F::ZERO,
        })
    }

    fn omega(&self) -> F {
        self.reader.omega_rad_s()
    }

    /// The next sample, if it is not lost.
    fn sample(&mut self, is_lost: bool) -> Sample<F> {
        self.walk.fill(&mut self.chunk, 1);
        let Some(shaft) = self.chunk.first() else {
            return Sample::Lost;
        };
        self.travel += shaft.delta_phi_rad;
        if is_lost {
            self.reader.miss();
            return Sample::Lost;
        }
        let travel = std::mem::take(&mut self.travel);
        Sample::Taken(if self.counts {
            self.reader.read(self.encoder.count(self.walk.now().0))
        } else {
            ShaftStep {
                delta_phi_rad: travel,
                ..*shaft
            }
        })
    }
}
