//! The thread that has the device: the only one that talks to it.
//!
//! The thread executes the orders of pages one after another, makes frames of the samples, and
//! disarms when the watchdog of the controlling page expires.
//!
//! | part | look in |
//! |---|---|
//! | torque on and off, connection | `device_thread.rs` |
//! | whether an order is executed, control | `device_thread/orders.rs` |
//! | who ended torque, and when | `device_thread/torque_end.rs` |
//! | parameters and presets | `device_thread/knee.rs` |
//! | lessons | `device_thread/lessons.rs`, `device_thread/resumed.rs` |
//! | sessions of experiments | `device_thread/experiments.rs` |
//! | students who answer by phone | `device_thread/students.rs` |
//! | recordings | `device_thread/recording.rs` |
//! | frames of the curves, and what a blind trial hides of them | `device_thread/frames.rs` |
//! | torques that pages play as sound | `device_thread/heard.rs` |
//! | notes | `device_thread/notes.rs` |
//! | the target of a hand, and its score | `device_thread/target.rs` |
//! | the hand on a simulated leg | `device_thread/hand.rs` |
//! | what is measured, and what was missed | `device_thread/examination.rs` |
//! | status as a message | `device_thread/status.rs` |

mod examination;
mod experiments;
mod frames;
mod hand;
mod heard;
mod knee;
mod lessons;
mod notes;
mod orders;
mod program;
mod recording;
mod resumed;
mod status;
mod students;
mod target;
#[cfg(test)]
mod tests;
mod torque_end;

use crate::class::Class;
use crate::experiment::Experiments;
use crate::live::{Envelope, Pace, Pain};
use crate::request::Request;
use crate::shared::{Latest, Order, Outcome, Shared};
use axum::extract::ws::Utf8Bytes;
use crepitus_client::connection::HandInput;
use crepitus_client::{Client, Error, Event, Transport};
use crepitus_protocol::telemetry::{Block, SampleFlags};
use crepitus_protocol::{Revision, TICKS_PER_S, Values};
use crepitus_recording::Samples;
use crepitus_scene::preset::Preset;
use examination::Examined;
use experiments::Experiment;
use hand::Hand;
use heard::Heard;
use lessons::Held;
use notes::Note;
pub use program::Program;
use recording::Recorded;
use serde_json::Value;
use status::Speed;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use tokio::sync::oneshot;
use torque_end::Torque;

/// Samples of a bin, 5 ms.
const ROWS_PER_BIN: u32 = TICKS_PER_S / 200;

/// Interval of the status, and of a target's score.
const STATUS_EVERY: Duration = Duration::from_millis(500);
const SCORE_EVERY: Duration = Duration::from_millis(100);

/// Interval of measures.
const MEASURES_EVERY: Duration = Duration::from_millis(200);

/// Timeout of a poll for events: the longest time that an order waits.
const POLL: Duration = Duration::from_millis(2);

/// Interval of attempts to connect again.
const RECONNECT_EVERY: Duration = Duration::from_millis(500);

/// The thread that has the device.
pub(crate) struct DeviceThread<'p, T> {
    client: Client<T>,
    program: &'p dyn Program<T>,
    shared: Arc<Shared>,
    inbox: Receiver<Order>,
    /// Orders that have been received, and not executed yet.
    waiting: VecDeque<Order>,
    /// Folder in which sessions are stored.
    sessions: Option<PathBuf>,
    samples: Samples,
    /// Parameters of the last block, as far as they are known.
    in_force: Option<Revision>,
    values: Values,
    /// Revision and values committed last.
    committed: Revision,
    /// The preset applied last, and the revision that it made.
    preset: Option<(String, Revision)>,
    /// The user's own presets, as pages know them.
    own: Vec<Preset>,
    envelope: Envelope,
    pain: Pain,
    /// Hand on the leg of a simulated device.
    hand: Option<Hand>,
    heard: Heard,
    /// Time of the newest sample, s.
    now_s: f64,
    missing: u64,
    frame_number: u32,
    frame_at: Instant,
    pace: Option<Pace>,
    score_at: Instant,
    examined: Examined,
    recording: Option<Recorded>,
    /// Files that are being made.
    sealing: Vec<JoinHandle<Result<(), String>>>,
    lesson: Option<Held>,
    experiment: Experiment,
    class: Class,
    /// Replies to answers that wait for the disk.
    unstored: Vec<oneshot::Sender<Outcome>>,
    /// Pages do not see the parameters now.
    hides: bool,
    notes: Vec<Note>,
    /// Something that happened by itself.
    message: Option<String>,
    torque: Torque,
    status_at: Instant,
    status_is_due: bool,
    is_lost: bool,
    reconnect_at: Instant,
    speed: Speed,
}

impl<'p, T: Transport> DeviceThread<'p, T> {
    /// Subscribes to the device.
    ///
    /// # Errors
    /// The device does not answer.
    pub(crate) fn new(
        mut client: Client<T>,
        program: &'p dyn Program<T>,
        shared: Arc<Shared>,
        inbox: Receiver<Order>,
        sessions: Option<PathBuf>,
        experiments: Option<Experiments>,
        hand: Option<HandInput>,
    ) -> Result<Self, Error> {
        let (committed, values) = client.parameters()?;
        client.subscribe()?;
        let now = Instant::now();
        let speed = Speed::new(client.now());
        let by_person = hand.is_none();
        let hand = hand.map(Hand::new);
        let mut device_thread = Self {
            client,
            program,
            shared,
            inbox,
            waiting: VecDeque::new(),
            sessions,
            samples: Samples::default(),
            in_force: None,
            values,
            committed,
            preset: None,
            own: Vec::new(),
            envelope: Envelope::new(ROWS_PER_BIN),
            pain: Pain::of(&values),
            hand,
            heard: Heard::default(),
            now_s: 0.0,
            missing: 0,
            frame_number: 0,
            frame_at: now,
            pace: None,
            score_at: now,
            examined: Examined::new(by_person, now),
            recording: None,
            sealing: Vec::new(),
            lesson: None,
            experiment: Experiment::new(experiments),
            class: Class::default(),
            unstored: Vec::new(),
            hides: false,
            notes: Vec::new(),
            message: None,
            torque: Torque::Off(None),
            status_at: now,
            status_is_due: true,
            is_lost: false,
            reconnect_at: now,
            speed,
        };
        device_thread.publish_presets();
        device_thread.publish_parameters();
        device_thread.publish_lesson();
        device_thread.publish_experiment();
        device_thread.publish_class();
        device_thread.publish_target();
        device_thread.restart_examination();
        Ok(device_thread)
    }

    /// Runs until the program is asked to end; then disarms, also after a panic, and closes what
    /// is open.
    ///
    /// # Errors
    /// The device did not disarm.
    pub(crate) fn run(mut self) -> Result<(), Error> {
        let result = catch_unwind(AssertUnwindSafe(|| {
            while !self.program.has_ended() {
                self.step();
            }
        }));
        // Torque first, then files.
        let closed = if self.client.is_armed() {
            self.client.disarm()
        } else {
            Ok(())
        };
        if let Err(panic) = result {
            resume_unwind(panic);
        }
        self.end_recording();
        self.save_lesson();
        self.wait_for_files();
        if self.is_lost {
            return Ok(());
        }
        self.end_experiment();
        closed?;
        self.client.close().map(|_| ())
    }

    /// Orders, events, frames: some milliseconds.
    pub(crate) fn step(&mut self) {
        self.take_orders();
        self.store_answers();
        self.supervise_page();
        if self.is_lost {
            self.try_to_reconnect();
        } else {
            self.pump();
        }
        self.move_hand();
        self.check_files();
        self.notice_torque_end();
        self.supervise_experiment();
        if self.hides != self.is_hidden() {
            self.hides = !self.hides;
            self.publish_parameters();
        }
        self.publish_frame();
        if self.pace.is_some() && self.score_at.elapsed() >= SCORE_EVERY {
            self.publish_target();
        }
        if self.examined.published_at.elapsed() >= MEASURES_EVERY {
            self.publish_examination();
        }
        if self.status_is_due || self.status_at.elapsed() >= STATUS_EVERY {
            self.publish_status();
        }
    }

    /// Takes what has come, for no longer than a poll waits: if the device sends faster than
    /// this takes it, the pages have their turn all the same.
    fn pump(&mut self) {
        let mut patience = POLL;
        let end = self.client.now() + POLL;
        loop {
            match self.client.pump(patience) {
                Ok(Some(event)) => self.take(event),
                Ok(None) => return,
                Err(error) => {
                    self.message = Some(error.to_string());
                    self.lost();
                    return;
                }
            }
            if self.is_lost || self.client.now() >= end {
                return;
            }
            patience = Duration::ZERO;
        }
    }

    fn take(&mut self, event: Event) {
        match event {
            Event::Block(arrival) => {
                self.missing += arrival.missing;
                self.block(&arrival.block);
            }
            Event::State(_) => self.status_is_due = true,
            Event::DriveRestarted => self.message = Some("the drive has restarted".to_owned()),
            Event::Silent(silence) => {
                self.message = Some(format!(
                    "no samples for {} ms, but the connection is open",
                    silence.as_millis()
                ));
            }
            Event::Lost(error) => {
                self.message = Some(error.to_string());
                self.lost();
            }
            _ => {}
        }
    }

    fn lost(&mut self) {
        self.is_lost = true;
        self.status_is_due = true;
        self.reconnect_at = Instant::now();
    }

    /// One attempt. It never arms.
    fn try_to_reconnect(&mut self) {
        if self.reconnect_at.elapsed() < RECONNECT_EVERY {
            std::thread::sleep(POLL);
            return;
        }
        self.reconnect_at = Instant::now();
        if let Ok(back) = self.client.reconnect(Duration::ZERO) {
            self.is_lost = false;
            self.in_force = None;
            self.message = Some("connected again; the motor is off".to_owned());
            if let Some(resubscribed) = back.resubscribed {
                self.resume_recording(resubscribed.begin);
            }
            self.reload_parameters();
            self.status_is_due = true;
        }
    }

    fn block(&mut self, block: &Block) {
        if self.in_force != Some(block.revision) {
            // Of this revision or a later one: the drive applies it within milliseconds.
            self.reload_parameters();
            self.samples.set(&self.values);
            self.in_force = Some(block.revision);
            self.announce_parameters(block.revision);
        }
        self.record(block);
        let by_person = self.notice_mover();
        let is_heard = self.is_heard();
        for row in self.samples.rows(block) {
            self.now_s = row.time_s;
            self.envelope.take(&row);
            if is_heard {
                self.heard.take(&row);
            }
            if let Some(held) = &mut self.lesson {
                held.take(row.flags.has(SampleFlags::ENERGISED));
            }
            row.examined_by(&mut self.examined.examination);
            if let Some(pace) = &mut self.pace
                && by_person
            {
                pace.take(&row);
            }
            if let Some(hand) = &mut self.hand {
                hand.see(&row);
            }
        }
        if let Some(angle_rad) = self.hand.as_ref().and_then(Hand::angle_rad) {
            self.envelope.hold(angle_rad);
        }
    }

    /// Executes a request of a page that may make it.
    fn execute(&mut self, request: Request) -> Outcome {
        match request {
            Request::Zero => self.done(Client::zero),
            Request::Arm => self.arm(),
            Request::ClearFault => self.done(Client::clear_fault),
            Request::Save => {
                self.check_open()?;
                self.done(Client::save)
            }
            Request::Apply { preset, add } => self.apply(&preset, add),
            Request::Set { changes } => self.set(&changes),
            Request::Reset => self.reset(),
            Request::SavePreset(what) => self.save_preset(&what),
            Request::Target { target } => self.set_target(target),
            Request::Score { running } => self.set_scoring(running),
            Request::Examine => {
                self.restart_examination();
                Ok(Value::Null)
            }
            Request::Note { text } => self.add_note(&text),
            Request::Record { running, name } => self.set_recording(running, &name),
            Request::LessonBegin(what) => self.begin_lesson(&what),
            Request::LessonStart => self.start_trial(),
            Request::LessonAnswer {
                student,
                disorder,
                level,
                confidence,
            } => self.answer(&student, &disorder, level.as_deref(), confidence),
            Request::LessonNext => self.next_trial(),
            Request::LessonEnd { language } => self.end_lesson(&language),
            Request::LessonClose => self.close_lesson(),
            Request::LessonResume { folder } => self.resume_lesson(&folder),
            Request::Experiment(step) => self.step_experiment(&step),
            Request::Severity { worse } => self.change_severity(worse),
            Request::Class { open } => {
                self.open_class(open);
                Ok(Value::Null)
            }
            Request::FreeSeat { student } => {
                self.free_seat(&student);
                Ok(Value::Null)
            }
            Request::Report { language } => self.report(&language),
            // Of the check of orders, the server and the archive.
            Request::Take
            | Request::Release
            | Request::Stop
            | Request::Disarm
            | Request::Join { .. }
            | Request::Answer { .. }
            | Request::Fault { .. }
            | Request::Lessons
            | Request::Experiments
            | Request::ExperimentResults
            | Request::Recordings
            | Request::Open { .. }
            | Request::Trace { .. } => Err("this is not for the device".to_owned()),
        }
    }

    /// A request to the device that has no answer but an error.
    fn done(&mut self, request: impl FnOnce(&mut Client<T>) -> Result<(), Error>) -> Outcome {
        let result = request(&mut self.client);
        result
            .map(|()| Value::Null)
            .map_err(|error| self.explained(error))
    }

    fn explained(&mut self, error: Error) -> String {
        self.program.explain(&mut self.client, error)
    }

    fn arm(&mut self) -> Outcome {
        if self.shared.watchdog.has_expired() {
            return Err(
                "the page does not answer quickly enough to turn the motor on: close other programs, or \
                 reload it"
                    .to_owned(),
            );
        }
        self.message = None;
        self.done(Client::arm)?;
        self.torque = Torque::On;
        Ok(Value::Null)
    }

    /// Publishes a message if it has changed.
    fn publish(&self, place: impl Fn(&mut Latest) -> &mut Utf8Bytes, message: &Value) {
        let message = Utf8Bytes::from(message.to_string());
        self.shared.latest.send_if_modified(|latest| {
            let place = place(latest);
            let has_changed = *place != message;
            if has_changed {
                *place = message;
            }
            has_changed
        });
    }
}

/// Now, ms since 1970.
fn unix_ms() -> f64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    now.unwrap_or_default().as_secs_f64() * 1e3
}
