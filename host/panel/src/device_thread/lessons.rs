//! Lessons: a list of knees, one after another.

use super::DeviceThread;
use super::recording::extension;
use crate::class::Keys;
use crate::lesson::{
    By, Feedback, HEALTHY, Knee, Known, Lesson, MOST_SEED, Plan, Session, SessionFolder, Started,
    plans, report,
};
use crate::live::Target;
use crate::request::LessonBegin;
use crate::shared::Outcome;
use crate::strings::Strings;
use crepitus_client::Transport;
use crepitus_scene::preset::Preset;
use serde_json::{Value, json};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// A lesson that is held, and where it is stored.
pub(super) struct Held {
    session: Session,
    folder: Option<SessionFolder>,
    /// Time at which the current trial began, s.
    began_s: f64,
    /// Samples of the current trial, and those of them with torque.
    samples: u64,
    under_torque: u64,
    /// Time at which the healthy knee was applied between two trials, s; none while that of
    /// a trial is on the device.
    left_s: Option<f64>,
    /// Findings of the current trial, as pages get them, once answers have revealed its knee.
    findings: Option<Value>,
    /// Keys of the students' phones, as they are stored.
    keys: Keys,
}

/// Time in which the torque of a knee that was left has ended: parameters ramp.
pub(super) const SETTLED_S: f64 = 1.0;

impl Held {
    fn new(session: Session, folder: Option<SessionFolder>) -> Self {
        Self {
            session,
            folder,
            began_s: 0.0,
            samples: 0,
            under_torque: 0,
            left_s: None,
            findings: None,
            keys: Keys::new(),
        }
    }

    /// A lesson that was interrupted; the device has the healthy knee from now on.
    pub(super) fn resumed(session: Session, folder: SessionFolder, keys: Keys, at_s: f64) -> Self {
        Self {
            left_s: Some(at_s),
            keys,
            ..Self::new(session, Some(folder))
        }
    }

    pub(super) fn lesson(&self) -> &Lesson {
        &self.session.lesson
    }

    pub(super) fn lesson_mut(&mut self) -> &mut Lesson {
        &mut self.session.lesson
    }

    /// Returns whether pages must not see which knee it is.
    pub(super) fn is_hidden(&self, now_s: f64) -> bool {
        let lesson = &self.session.lesson;
        if lesson.began() {
            return lesson.is_hidden();
        }
        // Between two trials the last one is still felt for a while.
        let last = lesson.trial() - 1;
        let is_left = self.left_s.is_some_and(|left_s| now_s > left_s + SETTLED_S);
        last > 0 && !lesson.is_revealed(last) && !is_left
    }

    /// Counts a sample of the current trial.
    pub(super) fn take(&mut self, is_driven: bool) {
        if self.session.lesson.began() {
            self.samples += 1;
            self.under_torque += u64::from(is_driven);
        }
    }

    pub(super) fn findings(&self) -> Option<&Value> {
        self.findings.as_ref()
    }

    pub(super) fn keep_findings(&mut self, findings: Value) {
        self.findings = Some(findings);
    }

    /// Share of the current trial's samples with torque.
    #[expect(clippy::cast_precision_loss, reason = "days of samples are below 2^53")]
    fn torque_share(&self) -> f64 {
        self.under_torque as f64 / self.samples.max(1) as f64
    }

    /// Returns whether they see the torque all the same.
    pub(super) fn shows_curves(&self) -> bool {
        self.session.lesson.plan().curves
    }
}

impl<T: Transport> DeviceThread<'_, T> {
    /// Rejects a lesson or a session while another one is running.
    pub(super) fn check_no_lesson(&self) -> Result<(), String> {
        self.experiment.check_none()?;
        if let Some(held) = &self.lesson
            && !held.session.lesson.ended()
        {
            return Err("a lesson is running: end it first".to_owned());
        }
        Ok(())
    }

    pub(super) fn begin_lesson(&mut self, what: &LessonBegin) -> Outcome {
        self.check_no_lesson()?;
        let (name, mut plan) = match (&what.lesson, &what.plan) {
            (Some(name), None) => {
                let file = plans::find(name).ok_or_else(|| format!("no lesson {name:?} ships"))?;
                (name.clone(), file.read().map_err(|e| e.to_string())?)
            }
            (None, Some(plan)) => {
                let plan = Plan::from_json(plan.clone()).map_err(|e| e.to_string())?;
                (plan.title.clone(), plan)
            }
            _ => return Err("expected a lesson or a plan".to_owned()),
        };
        if let Some(repeats) = what.repeats {
            plan.repeats = repeats;
        }
        let own = self.program.own_presets();
        let plan = plan
            .check(Known {
                own_preset: &|name| own.iter().find(|p| p.name == name).map(knee_of),
                target: &|name| Target::find(name).is_some(),
            })
            .map_err(|error| error.to_string())?;
        let seed = match what.seed {
            Some(seed) => seed,
            None => drawn_seed()?,
        };
        let students = self.with_class(&what.students);
        let lesson = Lesson::begin(&name, plan, students, seed);
        let lesson = lesson.map_err(|error| error.to_string())?;
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        let started = Started::from_unix(now.unwrap_or_default().as_secs())
            .ok_or("the computer's clock is wrong: set it first")?;
        let session = Session::new(started, env!("CARGO_PKG_VERSION").to_owned(), lesson);
        let folder = match &self.sessions {
            Some(parent) => {
                let folder = SessionFolder::create(parent, &session);
                let folder = folder.map_err(|error| error.to_string())?;
                folder.save(&session).map_err(|error| error.to_string())?;
                Some(folder)
            }
            None => None,
        };
        self.end_recording();
        self.lesson = Some(Held::new(session, folder));
        self.store_keys();
        self.publish_lesson();
        Ok(json!({ "seed": seed }))
    }

    /// Applies the knee of the current trial, and records it.
    pub(super) fn start_trial(&mut self) -> Outcome {
        self.admit_students();
        let now_s = self.now_s;
        let held = self.lesson.as_mut().ok_or(NO_LESSON)?;
        let before = (held.session.lesson.clone(), held.left_s);
        // The knee is hidden before the device has it.
        let lesson = &mut held.session.lesson;
        let preset = lesson.start().map_err(|e| e.to_string())?.preset.clone();
        let trial = lesson.trial();
        let target = lesson.view(None).target;
        (held.began_s, held.left_s) = (now_s, None);
        (held.samples, held.under_torque, held.findings) = (0, 0, None);
        self.publish_parameters();
        let mut begun = self.record_trial(trial);
        if begun.is_ok() {
            begun = self.apply_unseen(&preset);
            if begun.is_err() {
                self.end_recording();
            }
        }
        if let Err(error) = begun {
            if let Some(held) = &mut self.lesson {
                (held.session.lesson, held.left_s) = before;
            }
            self.publish_parameters();
            return Err(error);
        }
        if let Some(target) = target.and_then(|name| Target::find(&name)) {
            let mut pace = crate::live::Pace::new(target);
            pace.set_scoring(true);
            self.pace = Some(pace);
            self.publish_target();
        }
        self.restart_examination();
        self.note_trial(trial);
        self.publish_parameters();
        self.changed();
        Ok(Value::Null)
    }

    fn record_trial(&mut self, trial: usize) -> Result<(), String> {
        let Some(held) = &self.lesson else {
            return Ok(());
        };
        let Some(folder) = &held.folder else {
            return Ok(());
        };
        let file = folder.next_recording(&held.session, trial, extension());
        self.begin_recording(&file, &format!("Trial {trial}"))?;
        if let (Some(held), Some(name)) = (&mut self.lesson, file.file_name()) {
            held.session.recorded(trial, &name.to_string_lossy());
        }
        Ok(())
    }

    /// Notes a trial on the time line, without a word of the knee.
    fn note_trial(&mut self, trial: usize) {
        let text = format!("Trial {trial}");
        self.push_note(&text, "lesson");
        if let Some(held) = &mut self.lesson {
            // The text of the note is short.
            let _ = held.session.lesson.note(self.now_s, &text, By::Lesson);
        }
    }

    /// An answer that is entered on the teacher's page.
    pub(super) fn answer(
        &mut self,
        student: &str,
        disorder: &str,
        level: Option<&str>,
        confidence: u8,
    ) -> Outcome {
        self.take_answer(student, disorder, level, confidence)?;
        self.publish_parameters();
        self.changed();
        Ok(Value::Null)
    }

    /// Enters an answer, which is not stored yet.
    pub(super) fn take_answer(
        &mut self,
        student: &str,
        disorder: &str,
        level: Option<&str>,
        confidence: u8,
    ) -> Outcome {
        let now_s = self.now_s;
        let held = self.lesson.as_mut().ok_or(NO_LESSON)?;
        let share = held.torque_share();
        let lesson = &mut held.session.lesson;
        lesson.set_torque_share(share);
        let answered = lesson.answer(student, disorder, level, confidence, now_s);
        answered.map_err(|error| error.to_string())?;
        if !lesson.is_hidden() {
            self.keep_findings();
        }
        Ok(Value::Null)
    }

    pub(super) fn next_trial(&mut self) -> Outcome {
        let lesson = self.running_lesson()?;
        lesson.next_trial().map_err(|error| error.to_string())?;
        self.end_recording();
        self.leave_knee();
        self.changed();
        Ok(Value::Null)
    }

    pub(super) fn end_lesson(&mut self, language: &str) -> Outcome {
        let lesson = self.running_lesson()?;
        lesson.end().map_err(|error| error.to_string())?;
        self.end_recording();
        self.leave_knee();
        self.changed();
        self.store_keys();
        let held = self.lesson.as_ref().ok_or(NO_LESSON)?;
        if let Some(folder) = &held.folder {
            let strings = Strings::of(language);
            let written = folder.save_report(&held.session, &|key| strings.text(key));
            let file = written.map_err(|error| error.to_string())?;
            return Ok(json!({ "report": file }));
        }
        Ok(Value::Null)
    }

    pub(super) fn close_lesson(&mut self) -> Outcome {
        let held = self.lesson.as_ref().ok_or(NO_LESSON)?;
        if !held.session.lesson.ended() {
            return Err("the lesson is running: end it first".to_owned());
        }
        self.lesson = None;
        self.publish_lesson();
        Ok(Value::Null)
    }

    /// Makes the knee healthy between trials: the last one could be felt, and read.
    fn leave_knee(&mut self) {
        self.pace = None;
        self.publish_target();
        let left = if self.is_lost {
            Err("the device is not connected: it still has the last knee".to_owned())
        } else {
            self.apply_unseen(HEALTHY)
        };
        match (left, &mut self.lesson) {
            (Ok(()), Some(held)) => held.left_s = Some(self.now_s),
            (Err(error), _) => self.message = Some(error),
            _ => {}
        }
        self.publish_parameters();
    }

    /// The report, as a page that can be opened once.
    pub(super) fn report(&self, language: &str) -> Outcome {
        let held = self.lesson.as_ref().ok_or(NO_LESSON)?;
        let lesson = &held.session.lesson;
        if lesson.plan().blind && !lesson.ended() && lesson.plan().feedback == Feedback::End {
            return Err("the answers are judged at the end of the lesson: end it first".to_owned());
        }
        if !lesson.ended() {
            return Err("the lesson is running: end it first".to_owned());
        }
        let strings = Strings::of(language);
        let html = report::report(&held.session, &|key| strings.text(key));
        let name = self.shared.tickets.offer(html)?;
        Ok(json!({ "path": format!("/report/{name}") }))
    }

    /// A teacher's note belongs to the lesson, if there is one.
    pub(super) fn note_in_lesson(&mut self, text: &str) -> Result<(), String> {
        let Some(held) = &mut self.lesson else {
            return Ok(());
        };
        let noted = held.session.lesson.note(self.now_s, text, By::Teacher);
        noted.map_err(|error| error.to_string())?;
        self.save_lesson();
        Ok(())
    }

    fn running_lesson(&mut self) -> Result<&mut Lesson, String> {
        let held = self.lesson.as_mut().ok_or(NO_LESSON)?;
        Ok(&mut held.session.lesson)
    }

    /// Stores the keys of the students' phones while the lesson runs; then they are of no use.
    pub(super) fn store_keys(&mut self) {
        let Some(held) = &mut self.lesson else {
            return;
        };
        let keys = if held.session.lesson.ended() {
            Keys::new()
        } else {
            self.class.keys()
        };
        if let Some(folder) = held.folder.as_ref().filter(|_| held.keys != keys)
            && let Err(error) = folder.save_keys(&keys)
        {
            self.message = Some(error.to_string());
            self.status_is_due = true;
        }
        held.keys = keys;
    }

    /// Stores the lesson and tells the pages.
    pub(super) fn changed(&mut self) {
        self.save_lesson();
        self.publish_lesson();
    }

    pub(super) fn save_lesson(&mut self) {
        let Some(held) = &self.lesson else {
            return;
        };
        if let Some(folder) = &held.folder
            && let Err(error) = folder.save(&held.session)
        {
            self.message = Some(format!(
                "{error}; the lesson goes on, and is kept in memory"
            ));
            self.status_is_due = true;
        }
    }

    /// Tells every page its part of the lesson.
    pub(super) fn publish_lesson(&mut self) {
        let views = self.lesson.as_ref().map(|held| {
            let stored = held.folder.as_ref().map(|folder| text_of(folder.path()));
            let view = held.lesson().view(stored.as_deref());
            // On the time line of the frames: a page that is reloaded counts on.
            let began_s = held.lesson().began().then_some(held.began_s);
            [view.clone().public(), view].map(|view| {
                let mut view = json!(view);
                view["began_s"] = json!(began_s);
                view
            })
        });
        let [public, lesson] = views.unwrap_or_default();
        self.publish(|latest| &mut latest.lesson, &json!({ "lesson": lesson }));
        let public = json!({ "lesson": public });
        self.publish(|latest| &mut latest.public_lesson, &public);
        self.publish_own();
        self.publish_knee();
    }
}

pub(super) const NO_LESSON: &str = "no lesson is running: begin one first";

fn text_of(path: &Path) -> String {
    path.display().to_string()
}

/// Knee of a preset, which a student has to identify.
fn knee_of(preset: &Preset) -> Knee {
    Knee::from(preset)
}

/// A seed that nobody has chosen.
fn drawn_seed() -> Result<u64, String> {
    let seed = getrandom::u64().map_err(|error| format!("no random numbers: {error}"))?;
    // Short enough to be written down.
    Ok(seed % 1_000_000 % MOST_SEED)
}
