//! Sessions of experiments: the page in control asks for intervals and answers; the engine decides what they are.
//!
//! While a session is held no page sees the knee, also between trials, when the device has the healthy one.

use super::lessons::SETTLED_S;
use super::{DeviceThread, unix_ms};
use crate::experiment::{Begin, Experiments, Run};
use crate::lesson::HEALTHY;
use crate::request::{ExperimentStep, Request};
use crate::shared::{Order, Outcome};
use crepitus_client::{Error, Transport};
use crepitus_scene::values::with_named;
use serde_json::{Value, json};
use std::thread;

const NO_SESSION: &str = "no session of an experiment is running: begin one first";
const NO_FOLDER: &str =
    "this panel has no protocols: start it with `--experiments FOLDER` to say where they are";
/// Without a word of the knee, which would not be blind any more.
const NOT_TAKEN: &str = "the device did not take the knee of this trial: leave the session, then try the protocol \
                         with `crepitus experiment run`";

/// The session that is held, and where protocols are.
pub(super) struct Experiment {
    folder: Option<Experiments>,
    run: Option<Run>,
    /// The device still has the knee of an interval that is over.
    has_left_knee: bool,
    /// Time at which the last session was left, s.
    left_s: Option<f64>,
}

impl Experiment {
    pub(super) const fn new(folder: Option<Experiments>) -> Self {
        Self {
            folder,
            run: None,
            has_left_knee: false,
            left_s: None,
        }
    }

    #[cfg(test)]
    pub(super) fn set_folder(&mut self, folder: Experiments) {
        self.folder = Some(folder);
    }

    /// Returns whether pages must not see the knee; for a while after a session, too, while torque ramps.
    pub(super) fn is_hidden(&self, now_s: f64) -> bool {
        // Time begins again where a device restarts.
        let is_fresh = |left_s: f64| (left_s..left_s + SETTLED_S).contains(&now_s);
        self.run.is_some() || self.left_s.is_some_and(is_fresh)
    }

    /// Rejects what would disturb a session, or tell its levels.
    pub(super) fn check_none(&self) -> Result<(), String> {
        if self.run.is_some() {
            return Err("a session of an experiment is running: leave it first".to_owned());
        }
        Ok(())
    }
}

impl<T: Transport> DeviceThread<'_, T> {
    pub(super) fn step_experiment(&mut self, step: &ExperimentStep) -> Outcome {
        match step {
            ExperimentStep::Begin {
                file,
                participant,
                consented,
            } => self.begin_experiment(file, participant, consented.as_deref()),
            ExperimentStep::Feel { trial, interval } => self.feel(*trial, *interval),
            ExperimentStep::Choose { trial, answer } => {
                self.answer_trial(|run, unix_s| run.choose(*trial, *answer, unix_s))
            }
            ExperimentStep::Describe { trial, text } => {
                self.answer_trial(|run, unix_s| run.describe(*trial, text, unix_s))
            }
            ExperimentStep::Rate {
                trial,
                realism,
                severity,
                finding,
            } => self
                .answer_trial(|run, unix_s| run.rate(*trial, realism, [severity, finding], unix_s)),
            ExperimentStep::Leave => self.leave_experiment(),
        }
    }

    fn begin_experiment(
        &mut self,
        file: &str,
        participant: &str,
        consented: Option<&str>,
    ) -> Outcome {
        self.check_no_lesson()?;
        let folder = self.experiment.folder.as_ref().ok_or(NO_FOLDER)?;
        let own = self.program.own_presets();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole seconds since 1970"
        )]
        let unix_s = (unix_ms() / 1e3) as u64;
        let begin = Begin {
            file,
            participant,
            consented,
            unix_s,
        };
        let run = folder.begin(&own, begin)?;
        let answered = run.answered();
        self.end_recording();
        self.experiment.run = Some(run);
        self.experiment.left_s = None;
        // The device may still have the knee of a trial that was interrupted.
        if let Err(error) = self.apply_unseen(HEALTHY) {
            self.experiment.run = None;
            return Err(error);
        }
        self.restart_examination();
        self.publish_parameters();
        self.publish_experiment();
        Ok(json!({ "answered": answered }))
    }

    /// Gives an interval of the current trial to the device.
    fn feel(&mut self, trial: usize, interval: usize) -> Outcome {
        let run = self.experiment.run.as_ref().ok_or(NO_SESSION)?;
        let stimulus = run.interval(trial, interval)?;
        if !self.client.is_armed() {
            return Err("the motor is off: turn it on, then feel this one".to_owned());
        }
        let preset = self
            .preset_of(&stimulus.preset)
            .map_err(|_| NOT_TAKEN.to_owned())?;
        let parameters = self.client.parameters();
        let (base, now) = parameters.map_err(|error| self.explained(error))?;
        let named = stimulus.values.iter();
        let named = named.map(|(name, value)| (name.as_str(), *value));
        let values = with_named(&now, &preset, named).map_err(|_| NOT_TAKEN.to_owned())?;
        let committed = self.client.commit(base, &values);
        self.reload_parameters();
        if let Err(error) = committed {
            let is_of_line = matches!(
                error,
                Error::Transport(_) | Error::NotConnected { .. } | Error::NoAnswer { .. }
            );
            return Err(if is_of_line {
                self.explained(error)
            } else {
                NOT_TAKEN.to_owned()
            });
        }
        if let Some(run) = &mut self.experiment.run {
            run.feel(interval);
        }
        // Always: whether it begins again would tell whether the knee is another one.
        self.restart_examination();
        self.publish_experiment();
        Ok(Value::Null)
    }

    /// Hands an answer to the engine; when this returns it is on the disk.
    fn answer_trial(
        &mut self,
        answer: impl FnOnce(&mut Run, f64) -> Result<(), String>,
    ) -> Outcome {
        let run = self.experiment.run.as_mut().ok_or(NO_SESSION)?;
        let before = run.answered();
        answer(run, unix_ms() / 1e3)?;
        if run.answered() != before {
            self.experiment.has_left_knee = true;
            self.clear_interval();
        }
        self.publish_experiment();
        Ok(Value::Null)
    }

    /// Puts the session away.
    fn leave_experiment(&mut self) -> Outcome {
        if self.experiment.run.is_none() {
            return Err(NO_SESSION.to_owned());
        }
        self.apply_unseen(HEALTHY)?;
        self.end_experiment();
        self.experiment.left_s = Some(self.now_s);
        self.restart_examination();
        self.publish_parameters();
        self.publish_experiment();
        Ok(Value::Null)
    }

    /// Drops the session; the program of a page that looks next must not find its knee on the device.
    pub(super) fn end_experiment(&mut self) {
        if self.experiment.run.take().is_some() {
            self.experiment.has_left_knee = true;
            self.clear_interval();
        }
    }

    /// Makes the knee healthy as soon as there is a connection: what is over must not be felt.
    fn clear_interval(&mut self) {
        if !self.experiment.has_left_knee || self.is_lost {
            return;
        }
        self.experiment.has_left_knee = false;
        if let Err(error) = self.apply_unseen(HEALTHY) {
            self.message = Some(error);
            self.status_is_due = true;
        }
    }

    /// Begins the trial again where the motor went off in it.
    pub(super) fn supervise_experiment(&mut self) {
        let is_felt = self.client.is_armed() && !self.is_lost;
        if !is_felt && self.experiment.run.as_mut().is_some_and(Run::interrupt) {
            self.experiment.has_left_knee = true;
            self.publish_experiment();
        }
        self.clear_interval();
    }

    /// Answers what needs a look at the whole study, in a thread of its own: neither the lease nor a page waits for
    /// it.
    pub(super) fn look_at_study(&mut self, order: Order) {
        let Order { request, reply, .. } = order;
        let asks_for_results = request == Request::ExperimentResults;
        let folder = self
            .experiment
            .folder
            .clone()
            .ok_or_else(|| NO_FOLDER.to_owned());
        let allowed = folder.and_then(|folder| {
            let run = self.experiment.run.as_ref();
            if asks_for_results && run.is_some_and(|run| !run.is_over()) {
                return Err(
                    "results tell the levels of the session that is running: leave it first"
                        .to_owned(),
                );
            }
            Ok(folder)
        });
        let folder = match allowed {
            Ok(folder) => folder,
            Err(error) => {
                // The page may be gone.
                let _ = reply.send(Err(error));
                return;
            }
        };
        let own = self.program.own_presets();
        let shared = self.shared.clone();
        let look = move || {
            let outcome = if asks_for_results {
                let page = folder.results(&own);
                page.and_then(|html| shared.tickets.offer(html))
                    .map(|name| json!({ "path": format!("/report/{name}") }))
            } else {
                Ok(folder.list(&own))
            };
            let _ = reply.send(outcome);
        };
        // Without a thread the reply is dropped, and the page told.
        let _ = thread::Builder::new().name("study".to_owned()).spawn(look);
    }

    /// Tells the teacher's pages where the session is.
    pub(super) fn publish_experiment(&self) {
        let view = self.experiment.run.as_ref().map(Run::view);
        self.publish(
            |latest| &mut latest.experiment,
            &json!({ "experiment": view }),
        );
    }
}
