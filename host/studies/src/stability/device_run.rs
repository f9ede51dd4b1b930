//! A frozen joint as the device renders it, with lost samples and parameters committed during the
//! run, and the energy that a hand gets back that shakes it.

use super::criterion::BOUND_SLACK;
use super::input::Lost;
use super::observation::Observation;
use super::parameter_changes::SLEW_NM_PER_S;
use super::subject::Subject;
use super::view::View;
use crate::sampling::Sampling;
use crate::true_events::TimedEvent;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::joint::shaft::Linear;
use crepitus_model::render::Limit;
use crepitus_model::render::input_check::InputLimits;
use crepitus_model::solver::locate::Locate;
use crepitus_model::solver::{LocatorVisitor, with_frozen_locator};
use crepitus_model::{
    EnergyObserver, Event, Parameters, Real, Renderer, Settings, SettingsError, StepCoefficients,
    StickSlip, Validated,
};

/// A run of a joint in a device.
pub(super) struct DeviceRun<'a> {
    pub(super) settings: Validated<Settings>,
    pub(super) sampling: Sampling<'a>,
    /// Whether the joint gets counts of the device's encoder, or the true motion.
    pub(super) counts: bool,
    pub(super) lost: Lost,
    /// Ticks from one commit to the next, 0 for none, and the committed parameters, in turn.
    pub(super) commits: (u64, &'a [Parameters]),
}

/// Values of a tick.
pub(super) struct Tick<'a> {
    travel_rad: f64,
    is_lost: bool,
    events: &'a [TimedEvent],
    pub(super) shown_nm: f64,
    /// The joint's torque, without the turn-back guard, N·m.
    pub(super) model_nm: f64,
    /// The static limit in force, N·m.
    limit_nm: f64,
    is_turned_back: bool,
}

/// The largest share of the bound's first term that was returned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Returned {
    /// Share as the device renders the joint.
    pub(super) guarded: f64,
    /// Share without the turn-back guard.
    pub(super) unguarded: f64,
}

impl DeviceRun<'_> {
    /// Observes torque and events.
    pub(super) fn observe<F: Real>(
        self,
        subject: Subject,
        late_step: u64,
    ) -> Result<Observation, SettingsError> {
        let step_s = self.sampling.step_s();
        let mut seen = Observation::of_steps(step_s);
        self.follow::<F>(subject, &mut |tick| {
            for event in tick.events {
                seen.tally.add(event);
            }
            let now_s = f64::from_whole(seen.steps) * step_s;
            seen.row::<F>(now_s, tick.shown_nm, tick.limit_nm, late_step);
            seen.guard_ticks += u64::from(tick.is_turned_back);
        })?;
        Ok(seen)
    }

    /// Observes the energy that a hand gets back.
    pub(super) fn observe_hand<F: Real>(
        self,
        subject: Subject,
        delay_ticks: usize,
    ) -> Result<Observation, SettingsError> {
        let limit_nm = self.settings.parameters.static_torque_nm;
        let mut seen = Observation {
            steps: self.sampling.steps(),
            ..Observation::of_steps(self.sampling.step_s())
        };
        let returned = self.shake::<F>(subject, delay_ticks, &mut |tick, _| {
            seen.peak = seen.peak.max(tick.shown_nm.abs() / limit_nm);
        })?;
        seen.above_s = (seen.peak > 1.0 + BOUND_SLACK).then_some(0.0);
        seen.returned = returned.guarded;
        Ok(seen)
    }

    /// Shakes the joint, whose torque gets to the hand so many ticks late. `on_tick` gets the
    /// hand's work, J: against the torque shown, and against the joint's.
    pub(super) fn shake<F: Real>(
        self,
        subject: Subject,
        delay_ticks: usize,
        on_tick: &mut dyn FnMut(&Tick<'_>, [f64; 2]),
    ) -> Result<Returned, SettingsError> {
        let exact = StepCoefficients::<f64>::new(&self.settings, self.sampling.step_s())?;
        let mut hand = EnergyObserver::new(&exact, delay_ticks);
        let mut unguarded = hand;
        self.follow::<F>(subject, &mut |tick| {
            if tick.is_lost {
                hand.tick_unseen(tick.travel_rad, tick.shown_nm);
                unguarded.tick_unseen(tick.travel_rad, tick.model_nm);
            } else {
                hand.tick(tick.travel_rad, tick.shown_nm);
                unguarded.tick(tick.travel_rad, tick.model_nm);
            }
            on_tick(tick, [hand.work_j(), unguarded.work_j()]);
        })?;
        Ok(Returned {
            guarded: hand.share(),
            unguarded: unguarded.share(),
        })
    }

    fn follow<F: Real>(
        self,
        subject: Subject,
        on_tick: &mut dyn FnMut(&Tick<'_>),
    ) -> Result<(), SettingsError> {
        with_frozen_locator::<F, _>(subject.solver.of_a_device(), Watched(self, on_tick))
    }
}

/// A run and what looks at its ticks: of no type of its own, which would make the run once for each.
struct Watched<'a>(DeviceRun<'a>, &'a mut dyn FnMut(&Tick<'_>));

impl<F: Real> LocatorVisitor<F> for Watched<'_> {
    type Output = Result<(), SettingsError>;

    fn visit<L: Locate<F, Shape = Linear>>(self) -> Self::Output {
        let Self(run, on_tick) = self;
        let (sampling, step_s) = (run.sampling, run.sampling.step_s());
        let mut view = View::<F>::new(&sampling, run.counts)?;
        let mut renderer = Renderer::<F, L>::of(
            StepCoefficients::new(&run.settings, step_s)?,
            InputLimits::device(step_s),
            F::from_f64(EncoderSettings::default().rad_per_count()),
            view.omega_rad_s(),
        );
        let (commit_every, commits) = run.commits;
        let coefficients = |&parameters: &Parameters| {
            let next = Settings {
                parameters,
                ..*run.settings
            };
            StepCoefficients::<F>::new(&next.validate()?, step_s)
        };
        let commits: Result<Vec<_>, SettingsError> = commits.iter().map(coefficients).collect();
        let commits = commits?;
        let mut next = commits.iter().cycle();
        let (mut events, mut missed) = (Vec::new(), 0);
        for n in 1..=sampling.steps() {
            if commit_every > 0
                && n.is_multiple_of(commit_every)
                && let Some(coefficients) = next.next()
            {
                renderer.commit(*coefficients, SLEW_NM_PER_S);
            }
            let is_lost = run.lost.takes(n, step_s);
            let (sample, travel_rad) = view.sample(is_lost);
            let (since, span) = (n - 1 - missed, f64::from_whole(missed + 1));
            events.clear();
            let shown = renderer.render(&sample, |event: Event<F>| {
                let time_s = sampling.time_s(since, span * event.fraction.to_f64());
                events.push(TimedEvent::new(time_s, &event));
            });
            missed = if is_lost { missed + 1 } else { 0 };
            on_tick(&Tick {
                travel_rad,
                is_lost,
                events: &events,
                shown_nm: shown.torque_nm.to_f64(),
                model_nm: shown.model_torque_nm.to_f64(),
                limit_nm: renderer.joint().coefficients().static_nm.to_f64(),
                is_turned_back: shown.limit == Limit::TurnedBack,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_plant::Motion;
    use crepitus_plant::recording::{AngleUnit, Angles, Quantity, Source, read, smooth};
    use crepitus_scene::preset::joints;
    use crepitus_scene::scene::Precision;
    use std::path::Path;

    /// Recorded knees, if they are beside the repository.
    fn recordings() -> Vec<(String, Motion, f64)> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
        let Ok(files) = std::fs::read_dir(&folder) else {
            eprintln!("left out: no recordings beside the repository");
            return Vec::new();
        };
        let mut all = Vec::new();
        for file in files.flatten().map(|file| file.path()) {
            let angles = Quantity::Angles(Angles::of(Some(AngleUnit::Deg)));
            let source = Source::new(&file, "time_s", "knee_flexion_deg", angles);
            if let Ok(samples) = read(&source) {
                let motion = Motion::recording(&smooth(&samples, 6.0).unwrap());
                let name = file.file_name().unwrap_or_default();
                all.push((name.display().to_string(), motion, samples.duration_s()));
            }
        }
        assert!(all.len() > 2, "of {}", folder.display());
        all
    }

    #[test]
    fn recorded_knees_get_no_more_back_than_the_bound() {
        let firmware = Subject::all()
            .into_iter()
            .find(|s| s.is_firmware())
            .unwrap();
        assert_eq!(firmware.precision, Precision::F32);
        let count_rad = EncoderSettings::default().rad_per_count();
        for (name, motion, duration_s) in recordings() {
            for preset in joints() {
                let p = preset.parameters;
                let settings = Settings {
                    parameters: p,
                    ..Settings::default()
                };
                for (delay_ticks, counts) in [(0, false), (2, true)] {
                    let hand = DeviceRun {
                        settings: settings.validate().unwrap(),
                        sampling: Sampling::new(&motion, duration_s, 5e-5),
                        counts,
                        lost: Lost::NONE,
                        commits: (0, &[]),
                    };
                    let returned = hand.shake::<f32>(firmware, delay_ticks, &mut |_, _| {});
                    let returned = returned.unwrap();
                    let stroke_rad = p.static_torque_nm / p.stiffness_nm_per_rad;
                    let most = if counts {
                        1.0 + count_rad / stroke_rad
                    } else {
                        1.0
                    };
                    println!(
                        "{name} {} {delay_ticks} {counts}: {returned:?}",
                        preset.name
                    );
                    assert!(
                        returned.guarded <= most,
                        "{name} {}: {returned:?}",
                        preset.name
                    );
                }
            }
        }
    }
}
