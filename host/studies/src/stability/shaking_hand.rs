//! A hand that shakes a joint as the device renders it, and the energy that it
//! gets back.

use super::criterion::BOUND_SLACK;
use super::input::Shake;
use super::locators::with_locator;
use super::observation::Observation;
use super::subject::Subject;
use crate::sampling::Sampling;
use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::joint::shaft::Linear;
use crepitus_model::render::input_check::InputLimits;
use crepitus_model::solver::LocatorVisitor;
use crepitus_model::solver::locate::Locate;
use crepitus_model::{
    EnergyObserver, Real, Renderer, Sample, Settings, SettingsError, ShaftStep, StepCoefficients,
    Validated,
};
use crepitus_plant::encoder::Encoder;

/// A joint and the hand that shakes it.
pub(super) struct ShakingHand<'a> {
    pub(super) settings: Validated<Settings>,
    pub(super) sampling: Sampling<'a>,
    pub(super) shake: Shake,
}

/// Values of a tick for a picture.
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
    /// Share as the device renders the joint.
    pub(super) guarded: f64,
    /// Share without the turn-back guard.
    pub(super) unguarded: f64,
}

impl ShakingHand<'_> {
    pub(super) fn observe<F: Real>(self, subject: Subject) -> Result<Observation, SettingsError> {
        let (step_s, steps) = (self.sampling.step_s(), self.sampling.steps());
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

    /// Runs the hand, calling `on_tick` every tick.
    pub(super) fn run<F: Real>(
        self,
        subject: Subject,
        on_tick: impl FnMut(&Tick),
    ) -> Result<Returned, SettingsError> {
        with_locator::<F, _>(subject, Watched(self, on_tick))
    }
}

struct Watched<'a, W>(ShakingHand<'a>, W);

impl<F: Real, W: FnMut(&Tick)> LocatorVisitor<F> for Watched<'_, W> {
    type Output = Result<Returned, SettingsError>;

    fn visit<L: Locate<F, Shape = Linear>>(self) -> Self::Output {
        let Self(run, mut on_tick) = self;
        let step_s = run.sampling.step_s();
        let coefficients = StepCoefficients::<F>::new(&run.settings, step_s)?;
        let settings = EncoderSettings::default();
        let encoder = Encoder::new(&settings);
        let mut walk = run.sampling.walk_from(0);
        let (mut angle_rad, omega_rad_s) = walk.now();
        let omega = F::from_f64(omega_rad_s);
        let first = encoder.count(angle_rad);
        let mut reader = EncoderReader::<F>::new(&settings, step_s, first, omega)?;
        let mut renderer = Renderer::<F, L>::of(
            coefficients,
            InputLimits::device(step_s),
            F::from_f64(settings.rad_per_count()),
            omega,
        );
        let exact = StepCoefficients::<f64>::new(&run.settings, step_s)?;
        let mut hand = EnergyObserver::new(&exact, run.shake.delay_ticks);
        let mut unguarded = hand;
        let mut chunk = Vec::new();
        // Travel since the last valid sample.
        let mut unseen_rad = F::ZERO;
        for n in 1..=run.sampling.steps() {
            walk.fill(&mut chunk, 1);
            let travel_rad = walk.now().0 - angle_rad;
            angle_rad = walk.now().0;
            let Some(shaft) = chunk.first() else { break };
            let is_lost = run.shake.lost.takes(n, step_s);
            let sample = if is_lost {
                reader.miss();
                unseen_rad += shaft.delta_phi_rad;
                Sample::Lost
            } else if run.shake.counts {
                Sample::Taken(reader.read(encoder.count(angle_rad)))
            } else {
                Sample::Taken(ShaftStep {
                    delta_phi_rad: std::mem::take(&mut unseen_rad) + shaft.delta_phi_rad,
                    ..*shaft
                })
            };
            let shown = renderer.render(&sample, |_| {});
            let (shown_nm, model_nm) = (shown.torque_nm.to_f64(), shown.model_torque_nm.to_f64());
            if is_lost {
                hand.tick_unseen(travel_rad, shown_nm);
                unguarded.tick_unseen(travel_rad, model_nm);
            } else {
                hand.tick(travel_rad, shown_nm);
                unguarded.tick(travel_rad, model_nm);
            }
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

#[cfg(test)]
mod tests {
    use super::super::input::Lost;
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
                    let hand = ShakingHand {
                        settings: settings.validate().unwrap(),
                        sampling: Sampling::new(&motion, duration_s, 5e-5),
                        shake: Shake {
                            amplitude_rad: 0.0,
                            frequency_hz: 0.0,
                            delay_ticks,
                            counts,
                            lost: Lost::NONE,
                        },
                    };
                    let returned = hand.run::<f32>(firmware, |_| {}).unwrap();
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
