mod examination;
mod experiments;
mod lessons;
mod orders;

use super::{DeviceThread, Program};
use crate::control::{Holder, Page};
use crate::frame::Masks;
use crate::invitations::Invitations;
use crate::request::{LessonBegin, Request as FromPage, SavePreset};
use crate::shared::{Outcome, Shared};
use crate::tokens::{Role, Tokens};
use crepitus_client::connection::Simulated;
use crepitus_client::{Client, Error, Transport, TransportError};
use crepitus_protocol::host::{Operation, Request};
use crepitus_protocol::parameters::id;
use crepitus_protocol::{Decoder, Lane, Session, State};
use crepitus_scene::preset::Preset;
use crepitus_scene::{Overrides, shipped};
use serde_json::{Value, json};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, mpsc};
use std::time::{Duration, Instant};
use tokio::sync::oneshot::Receiver;

/// Delay of the answer to a disarm that is slow: less than the timeout of a request.
const SLOW_DISARM_MS: u32 = 20;

/// A device that sends a block in the time in which this computer takes one.
struct Flood {
    device: Simulated,
    /// Number of times that bytes were asked for since the flood began; none before it.
    received: Option<u32>,
    /// Decoder of what is sent to it, and the requests to disarm in it.
    ear: Decoder,
    disarms: Arc<AtomicU32>,
    /// Called in every millisecond of an answer to a disarm that is delayed.
    while_disarming: Option<Box<dyn FnMut()>>,
    /// Delay of the answers to come, ms.
    delay_ms: u32,
}

impl Transport for Flood {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        for byte in bytes {
            let body = self.ear.push(*byte).and_then(Result::ok);
            let request = body.filter(|body| body.lane() == Some(Lane::Request));
            let request: Option<Request> = request.and_then(|body| body.message());
            if request.is_some_and(|request| request.operation == Operation::Disarm) {
                self.disarms.fetch_add(1, Ordering::Relaxed);
                if self.while_disarming.is_some() {
                    self.delay_ms = SLOW_DISARM_MS;
                }
            }
        }
        self.device.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], patience: Duration) -> Result<usize, TransportError> {
        if let (1.., Some(meanwhile)) = (self.delay_ms, &mut self.while_disarming) {
            self.delay_ms -= 1;
            meanwhile();
            self.device.wait(Duration::from_millis(1));
            return Ok(0);
        }
        if let Some(received) = &mut self.received {
            *received += 1;
            assert!(*received < 1_000, "pages never have their turn");
            self.device.wait(Duration::from_millis(1));
        }
        self.device.receive(buffer, patience)
    }

    fn now(&self) -> Duration {
        self.device.now()
    }

    fn wait(&mut self, time: Duration) {
        self.device.wait(time);
    }

    fn reopen(&mut self) -> Result<(), TransportError> {
        self.device.reopen()
    }

    fn name(&self) -> String {
        self.device.name()
    }
}

/// A program without presets, that nobody ends; it may end by itself at once, or with a panic.
#[derive(Default)]
struct Alone {
    ends: bool,
    panics: bool,
}

impl Program<Flood> for Alone {
    fn explain(&self, _: &mut Client<Flood>, error: Error) -> String {
        error.to_string()
    }

    fn holder(&self, _: &mut Client<Flood>, _: Session) -> String {
        String::new()
    }

    fn own_presets(&self) -> Vec<Preset> {
        Vec::new()
    }

    fn save_preset(&self, _: &str, _: &Preset, _: bool) -> Result<(), String> {
        Ok(())
    }

    fn has_ended(&self) -> bool {
        assert!(!self.panics, "as a mistake would");
        self.ends
    }
}

/// A device_thread of a simulated device, to which nobody gives orders.
fn device_thread(program: &Alone) -> DeviceThread<'_, Flood> {
    let scene =
        shipped::scene(Path::new("passive-examination"), &Overrides::default()).expect("a scene");
    let device = Simulated::of(&scene).expect("a device");
    let hand = device.hand();
    let flood = Flood {
        device,
        received: None,
        ear: Decoder::new(),
        disarms: Arc::default(),
        while_disarming: None,
        delay_ms: 0,
    };
    let client = Client::connect(flood).expect("a connection");
    let (orders, inbox) = mpsc::channel();
    let (questions, _) = mpsc::channel();
    let tokens = Tokens::draw().expect("a secret");
    let links = Invitations::default();
    let shared = Shared::new(tokens, Value::Null, links, orders, questions);
    let shared = Arc::new(shared);
    DeviceThread::new(client, program, shared, inbox, None, None, hand).expect("it answers")
}

/// Torque ends with what the device thread sends, not with the lease.
#[test]
fn a_panic_disarms_first() {
    let program = Alone {
        panics: true,
        ..Alone::default()
    };
    let mut device_thread = device_thread(&program);
    device_thread.client.zero().expect("a zero");
    device_thread.client.arm().expect("armed");
    let disarms = device_thread.client.transport_mut().disarms.clone();
    assert!(catch_unwind(AssertUnwindSafe(|| device_thread.run())).is_err());
    assert_eq!(disarms.load(Ordering::Relaxed), 1);
}

/// Making a long file takes longer than the lease lasts.
#[test]
fn torque_ends_before_files_are_waited_for() {
    let program = Alone {
        ends: true,
        ..Alone::default()
    };
    let mut device_thread = device_thread(&program);
    device_thread.client.zero().expect("a zero");
    device_thread.client.arm().expect("armed");
    let disarms = device_thread.client.transport_mut().disarms.clone();
    let (sender, seen) = mpsc::channel();
    device_thread.sealing.push(std::thread::spawn(move || {
        let end = Instant::now() + Duration::from_secs(2);
        while disarms.load(Ordering::Relaxed) == 0 && Instant::now() < end {
            std::thread::sleep(Duration::from_millis(1));
        }
        let count = disarms.load(Ordering::Relaxed);
        sender.send(count).map_err(|error| error.to_string())
    }));
    device_thread.run().expect("it ends in order");
    assert_eq!(seen.try_recv(), Ok(1));
}

#[test]
fn pages_have_their_turn_while_samples_come_faster_than_they_are_taken() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    for _ in 0..100 {
        device_thread.client.transport_mut().received = Some(0);
        device_thread.step();
    }
    assert!(
        device_thread.now_s > 0.05,
        "{} s of samples",
        device_thread.now_s
    );
}

#[test]
fn a_knee_that_asks_for_more_than_the_device_shows_is_told() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    device_thread.apply("healthy", false).expect("a knee");
    assert_eq!(device_thread.message, None);
    device_thread
        .apply("texture-bone-on-bone", false)
        .expect("a knee");
    let message = device_thread.message.clone().expect("a warning");
    assert!(
        message.contains("the symptoms can ask for 5.1 N·m together"),
        "{message}"
    );
}

/// Nobody has applied the knee with which a device starts, and numbers may be set one by one.
#[test]
fn a_knee_is_named_by_its_numbers() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let named = |device_thread: &DeviceThread<'_, Flood>| {
        let latest = device_thread.shared.latest.borrow();
        let message: Value = serde_json::from_str(&latest.parameters).expect("JSON");
        message["parameters"]["preset"].clone()
    };
    assert_eq!(named(&device_thread), "coarse");
    for (id, value, expected) in [
        (id::STATIC_TORQUE, 0.45, Value::Null),
        (id::STATIC_TORQUE, 0.4, json!("coarse")),
        (id::CREPITUS, 0.0, json!("healthy")),
    ] {
        device_thread.set(&[(id, value)]).expect("a revision");
        assert_eq!(named(&device_thread), expected);
    }
}

/// A teacher gives a title, and need not know what a file may be called.
#[test]
fn a_preset_is_saved_under_a_name_made_of_its_title() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    for (title, name) in [
        ("Steifes Knie für Übung 1", "steifes-knie-fuer-uebung-1"),
        ("Coarse", "coarse-2"),
        ("Healthy", "healthy-2"),
        ("膝", "knee"),
    ] {
        let what = SavePreset {
            title: title.to_owned(),
            ..SavePreset::default()
        };
        assert_eq!(
            device_thread.save_preset(&what),
            Ok(json!({ "name": name }))
        );
    }
}

/// Returns whether pages see neither the parameters nor the curves, nor what the examiner does with this knee; otherwise
/// they see all.
fn hides(device_thread: &mut DeviceThread<'_, Flood>) -> bool {
    let parameters = device_thread.shared.latest.borrow().parameters.clone();
    let is_hidden = parameters.contains("hidden");
    let Masks { torque, states } = device_thread.masks();
    let hand = device_thread.client.transport_mut().device.hand();
    let is_blind = hand.is_some_and(|hand| hand.is_blind());
    assert_eq!([torque, states, is_blind], [is_hidden; 3]);
    is_hidden
}

/// The torque still ramps down, and would tell which knee it was.
#[test]
fn a_knee_that_was_left_is_hidden_until_its_torque_has_ended() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let knees = json!([{ "preset": "coarse" }, { "preset": "mas-2-catch" }]);
    let plan = json!({ "title": "Two", "blind": true, "feedback": "end", "knees": knees });
    let lesson = LessonBegin {
        lesson: None,
        plan: Some(plan),
        students: vec!["A".to_owned()],
        seed: Some(7),
        repeats: None,
    };
    device_thread.begin_lesson(&lesson).expect("a lesson");
    device_thread.start_trial().expect("a trial");
    device_thread.step();
    assert!(hides(&mut device_thread));
    device_thread.next_trial().expect("the next one");
    let left_s = device_thread.now_s;
    while device_thread.now_s < left_s + 0.5 {
        device_thread.step();
        let later_s = device_thread.now_s - left_s;
        assert!(hides(&mut device_thread), "{later_s} s later");
    }
    while device_thread.now_s < left_s + 2.0 {
        device_thread.step();
    }
    assert!(!hides(&mut device_thread));
}

/// Queues a request as the connection of a page does.
fn order(shared: &Shared, page: Page, request: FromPage) -> Receiver<Outcome> {
    // The page answers its frames: nothing but the right decides.
    shared.watchdog.begin();
    shared.order(request, page, Role::Teacher).expect("a queue")
}

/// Has all orders executed that wait.
fn take_all(device_thread: &mut DeviceThread<'_, Flood>) {
    device_thread.take_orders();
    while !device_thread.waiting.is_empty() {
        device_thread.take_orders();
    }
}

/// Takes as many steps as they need.
fn step_all(device_thread: &mut DeviceThread<'_, Flood>) {
    device_thread.step();
    while !device_thread.waiting.is_empty() {
        device_thread.step();
    }
}

/// Has a request executed.
fn done(device_thread: &mut DeviceThread<'_, Flood>, page: Page, request: FromPage) -> Outcome {
    let mut outcome = order(&device_thread.shared, page, request);
    take_all(device_thread);
    outcome.try_recv().expect("an outcome")
}

/// A page that is taken control from sends `arm` before, in every millisecond of a slow disarm,
/// and after it. None of these orders gives torque to the page that takes control.
#[test]
fn a_take_over_never_ends_armed() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let shared = device_thread.shared.clone();
    let pages = [shared.control.page(), shared.control.page()];
    device_thread.client.zero().expect("a zero");
    let during = Arc::new(Mutex::new(Vec::new()));
    for round in 0..500 {
        let [old, new] = [pages[round % 2], pages[(round + 1) % 2]];
        device_thread.client.transport_mut().while_disarming = None;
        done(&mut device_thread, old, FromPage::Take).expect("control");
        done(&mut device_thread, old, FromPage::Arm).expect("torque");
        let (sent, sender) = (during.clone(), shared.clone());
        device_thread.client.transport_mut().while_disarming = Some(Box::new(move || {
            let outcome = order(&sender, old, FromPage::Arm);
            sent.lock().expect("a list").push(outcome);
        }));
        let mut late: Vec<_> = (0..round % 3)
            .map(|_| order(&shared, old, FromPage::Arm))
            .collect();
        let mut taken = order(&shared, new, FromPage::Take);
        late.extend((0..round % 4).map(|_| order(&shared, old, FromPage::Arm)));
        step_all(&mut device_thread);
        late.push(order(&shared, old, FromPage::Arm));
        step_all(&mut device_thread);
        assert_eq!(taken.try_recv(), Ok(Ok(Value::Null)));
        late.append(&mut during.lock().expect("a list"));
        assert!(late.len() > 15, "{} orders in round {round}", late.len());
        for mut outcome in late {
            let outcome = outcome.try_recv().expect("an outcome");
            assert!(outcome.unwrap_err().contains("take control first"));
        }
        assert!(!device_thread.client.is_armed(), "armed in round {round}");
        let state = device_thread.client.status().expect("a status").state;
        assert_eq!(state, State::Disarmed, "round {round}");
        assert_eq!(shared.control.holder(), Holder::Page(new));
    }
}

/// Two pages take control at once, and the first one arms in between.
#[test]
fn the_last_of_two_take_overs_does_not_inherit_torque() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let shared = device_thread.shared.clone();
    let [old, first, second] = [(); 3].map(|()| shared.control.page());
    device_thread.client.zero().expect("a zero");
    done(&mut device_thread, old, FromPage::Take).expect("control");
    done(&mut device_thread, old, FromPage::Arm).expect("torque");
    for request in [
        (first, FromPage::Take),
        (first, FromPage::Arm),
        (second, FromPage::Take),
        (first, FromPage::Arm),
    ] {
        drop(order(&shared, request.0, request.1));
    }
    step_all(&mut device_thread);
    assert!(!device_thread.client.is_armed());
    assert_eq!(shared.control.holder(), Holder::Page(second));
}

/// A page whose take-over is still queued when it goes does not keep control.
#[test]
fn a_page_that_goes_while_it_takes_control_has_none() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let shared = device_thread.shared.clone();
    let page = shared.control.page();
    drop(order(&shared, page, FromPage::Take));
    drop(shared.leave(page, Role::Teacher));
    step_all(&mut device_thread);
    assert_eq!(shared.control.holder(), Holder::Nobody);
}

/// Every end of torque names its cause until torque is given again.
#[test]
fn an_end_of_torque_says_who_ended_it() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let shared = device_thread.shared.clone();
    let [page, other] = [shared.control.page(), shared.control.page()];
    device_thread.client.zero().expect("a zero");
    let cause =
        |device_thread: &DeviceThread<'_, Flood>| device_thread.torque.end()["cause"].clone();
    for expected in [
        "stop-viewer",
        "stop-student",
        "disarm",
        "take-over",
        "page-left",
        "watchdog",
        "elsewhere",
    ] {
        done(&mut device_thread, page, FromPage::Take).expect("control");
        done(&mut device_thread, page, FromPage::Arm).expect("torque");
        assert_eq!(cause(&device_thread), Value::Null);
        match expected {
            "stop-viewer" => {
                drop(shared.order(FromPage::Stop, other, Role::Viewer));
            }
            "stop-student" => {
                drop(shared.order(FromPage::Stop, other, Role::Student));
            }
            "disarm" => drop(order(&shared, page, FromPage::Disarm)),
            "take-over" => drop(order(&shared, other, FromPage::Take)),
            "page-left" => drop(shared.leave(page, Role::Teacher)),
            "watchdog" => {
                shared.watchdog.made(1);
                std::thread::sleep(crate::watchdog::TIMEOUT + Duration::from_millis(20));
            }
            // As the stop of another program does, of which the client hears afterwards.
            _ => device_thread.client.stop().expect("stopped"),
        }
        device_thread.step();
        assert_eq!(cause(&device_thread), expected);
        assert!(!device_thread.client.is_armed());
    }
}

/// STOP is pressed while the device keeps the device thread busy, and other orders wait.
#[test]
fn a_stop_goes_before_what_waits_and_nothing_from_before_it_arms() {
    let program = Alone::default();
    let mut device_thread = device_thread(&program);
    let shared = device_thread.shared.clone();
    let [page, viewer] = [shared.control.page(), shared.control.page()];
    device_thread.client.zero().expect("a zero");
    done(&mut device_thread, page, FromPage::Take).expect("control");
    let stop = || drop(shared.order(FromPage::Stop, viewer, Role::Viewer));
    let mut armed = order(&shared, page, FromPage::Arm);
    stop();
    take_all(&mut device_thread);
    let outcome = armed.try_recv().expect("an outcome");
    assert!(outcome.unwrap_err().contains("STOP was pressed"));
    assert!(!device_thread.client.is_armed());
    // After a stop a person may arm again.
    done(&mut device_thread, page, FromPage::Arm).expect("torque");
    // With torque the zero would be refused.
    let mut zeroed = order(&shared, page, FromPage::Zero);
    stop();
    take_all(&mut device_thread);
    assert_eq!(zeroed.try_recv(), Ok(Ok(Value::Null)));
    assert!(!device_thread.client.is_armed());
}
