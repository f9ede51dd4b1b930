//! Symptoms besides crepitus under a hand, as the device renders them: the check of its
//! input, its switched effects, and the tank.

mod energy;

use super::input::{Input, SymptomRun};
use super::observation::{Observation, SymptomObservation};
use super::parameter_changes::SLEW_NM_PER_S;
use super::subject::{Rung, Subject};
use super::view::View;
use crate::sampling::Sampling;
use crate::symptoms::errors::{Errors, Truth};
use crate::symptoms::event::{SymptomEvent, own};
use crate::symptoms::truth::{true_events, true_torques};
use crate::symptoms::{Given, follow};
use crate::watcher::StudyError;
use crepitus_model::control::energy_observer::MOST_DELAY_TICKS;
use crepitus_model::render::effects::symptom::Change;
use crepitus_model::render::effects::{EffectSettings, EffectSpec, SwitchedEffects, Timing};
use crepitus_model::render::input_check::{InputCheck, InputLimits};
use crepitus_model::render::position::Position;
use crepitus_model::render::{Addition, Check, ShaftEstimate, Shown};
use crepitus_model::{Real, Sample, SettingsError};
use crepitus_scene::scene::Precision;
use energy::Energy;

/// The torque is compared with the reference's at most so often.
const MOST_COMPARED: u64 = 50_000;

/// Runs symptoms; the late torque is that after `late_step`.
pub(super) fn observe(
    subject: Subject,
    (input, run): (&Input, &SymptomRun),
    late_step: u64,
) -> Result<Observation, StudyError> {
    let motion = run.hand.motion();
    let sampling = input.sampling(&motion);
    let here = Here {
        run,
        sampling,
        late_step,
    };
    if subject.solver == Rung::Reference {
        return here.by_reference();
    }
    let (mut seen, torques_nm) = match subject.precision {
        Precision::F32 => here.stepped::<f32>()?,
        Precision::F64 => here.stepped::<f64>()?,
    };
    if let ([given], true) = (run.symptoms.as_slice(), run.suits_the_reference()) {
        let stride = sampling.steps() / MOST_COMPARED + 1;
        let truth = Truth::new(given, &motion, &sampling, stride)?;
        let mut errors = Errors::default();
        let strided: Vec<f64> = (1_u64..)
            .zip(torques_nm)
            .filter_map(|(n, nm)| n.is_multiple_of(stride).then_some(nm))
            .collect();
        errors.compare(&sampling, &truth, &seen.symptoms.events, &strided);
        seen.symptoms.torque_error_nm = Some(errors.torque_nm.most());
        seen.symptoms.truth = Some(truth.events);
    }
    Ok(seen)
}

struct Here<'a> {
    run: &'a SymptomRun,
    sampling: Sampling<'a>,
    /// First step of the late torque.
    late_step: u64,
}

impl Here<'_> {
    fn by_reference(&self) -> Result<Observation, StudyError> {
        let (sampling, motion) = (&self.sampling, self.run.hand.motion());
        let mut seen = Observation::of_steps(sampling.step_s());
        let Some(given) = self.run.symptoms.first() else {
            return Ok(seen);
        };
        let times_s = (1..=sampling.steps()).map(|n| sampling.time_s(n, 0.0));
        for torque_nm in true_torques(given, &motion, times_s)? {
            self.row::<f64>(&mut seen, torque_nm);
        }
        seen.symptoms.events = own(true_events(given, &motion, sampling.end_s())?);
        seen.tally.last_s = seen.symptoms.events.last().map(|event| event.time_s);
        Ok(seen)
    }

    /// Records the torque of a tick.
    fn row<F: Real>(&self, seen: &mut Observation, torque_nm: f64) {
        let now_s = self.sampling.time_s(seen.steps, 0.0);
        seen.row::<F>(now_s, torque_nm, f64::INFINITY, self.late_step);
    }

    /// Runs the device in steps; returns the observation with the torque at the end of each step, N·m.
    fn stepped<F: Real>(&self) -> Result<(Observation, Vec<f64>), SettingsError> {
        let (run, step_s) = (self.run, self.sampling.step_s());
        let mut view = View::<F>::new(&self.sampling, run.counts)?;
        let mut device = Device::<F>::new(run, step_s, &view)?;
        let mut seen = Observation::of_steps(step_s);
        let mut torques_nm = Vec::new();
        let stiffness = device.now.stiffness_nm_per_rad(None);
        let mut energy = Energy::new(stiffness, (run.delay_ticks, run.delay_varies), step_s);
        let mut events = Vec::new();
        for n in 0..self.sampling.steps() {
            let from_s = self.sampling.time_s(n, 0.0);
            for (at_s, symptoms) in &run.commits {
                if (from_s..from_s + step_s).contains(at_s) {
                    device.commit(Given::settings_of(symptoms))?;
                }
            }
            let (sample, travel_rad) = view.sample(false);
            let torque_nm = device.tick(sample, view.place(), |change| {
                let fraction = change.fraction.to_f64();
                events.push(SymptomEvent {
                    time_s: self.sampling.time_s(n, fraction),
                    word: change.word,
                    omega_rad_s: omega_rad_s(&sample, fraction),
                    before_nm: change.before_nm.to_f64(),
                    after_nm: change.after_nm.to_f64(),
                });
            });
            energy.tick(travel_rad, torque_nm);
            self.row::<F>(&mut seen, torque_nm);
            torques_nm.push(torque_nm);
        }
        let events = own(events);
        seen.tally.last_s = events.last().map(|event| event.time_s);
        seen.symptoms = SymptomObservation {
            events,
            returned: energy.returned(),
            net_returned_j: energy.net_returned_j(),
            ..SymptomObservation::default()
        };
        Ok((seen, torques_nm))
    }
}

/// The effects of an armed device.
struct Device<F: Real> {
    effects: SwitchedEffects<F>,
    check: InputCheck<F>,
    now: EffectSettings,
    timing: Timing,
}

impl<F: Real> Device<F> {
    fn new(run: &SymptomRun, step_s: f64, view: &View<'_, F>) -> Result<Self, SettingsError> {
        let timing = Timing {
            delay_ticks: MOST_DELAY_TICKS,
            sensing: view.sensing(),
            ..follow::timing(step_s)
        };
        let limits = InputLimits::device(step_s);
        let mut device = Self {
            effects: SwitchedEffects::new(slew_nm(step_s), &timing),
            check: InputCheck::new(&limits, F::from_f64(step_s), F::ZERO),
            now: EffectSettings::default(),
            timing,
        };
        device.commit(Given::settings_of(&run.symptoms))?;
        device.effects.rest(&view.place());
        Ok(device)
    }

    fn commit(&mut self, next: EffectSettings) -> Result<(), SettingsError> {
        next.check(None)?;
        let changes = next.changes(&self.timing, (&self.now, &self.timing))?;
        self.effects.change(&changes, slew_nm(self.timing.step_s));
        self.now = next;
        Ok(())
    }

    fn tick(
        &mut self,
        sample: Sample<F>,
        place: Position<F>,
        mut on_change: impl FnMut(Change<F>),
    ) -> f64 {
        let input = self.check.check(&sample);
        let seen = ShaftEstimate {
            sample,
            omega_rad_s: F::ZERO,
            place,
            is_driven: true,
        };
        let mut shown = Shown::nothing();
        self.effects.tick(
            &seen,
            &input,
            &mut shown,
            &mut |_: &'static EffectSpec, change: Change<F>| on_change(change),
        );
        shown.torque_nm.to_f64()
    }
}

fn slew_nm<F: Real>(step_s: f64) -> F {
    F::from_f64(SLEW_NM_PER_S * step_s)
}

/// Velocity of the joint at a share of a tick, as it is seen, rad/s.
fn omega_rad_s<F: Real>(sample: &Sample<F>, fraction: f64) -> f64 {
    match sample {
        Sample::Taken(step) => {
            let (from, to) = (step.omega_start_rad_s, step.omega_end_rad_s);
            from.to_f64() + fraction * (to - from).to_f64()
        }
        Sample::Lost => 0.0,
    }
}
