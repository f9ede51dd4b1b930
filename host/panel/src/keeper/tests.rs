use super::{Keeper, Program};
use crate::shared::Shared;
use crate::tokens::Tokens;
use crepitus_client::{Client, Error, Transport, TransportError};
use crepitus_connection::Simulated;
use crepitus_protocol::host::{Operation, Request};
use crepitus_protocol::{Decoder, Lane, Session};
use crepitus_scene::preset::Preset;
use crepitus_scene::{Overrides, shipped};
use serde_json::Value;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, mpsc};
use std::time::Duration;

/// A device that sends a block in the time in which this computer takes one.
struct Flood {
    device: Simulated,
    /// Number of times that bytes were asked for since the flood began; none before it.
    received: Option<u32>,
    /// Decoder of what is sent to it, and the requests to disarm in it.
    ear: Decoder,
    disarms: Arc<AtomicU32>,
}

impl Transport for Flood {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        for byte in bytes {
            let body = self.ear.push(*byte).and_then(Result::ok);
            let request = body.filter(|body| body.lane() == Some(Lane::Request));
            let request: Option<Request> = request.and_then(|body| body.message());
            if request.is_some_and(|request| request.operation == Operation::Disarm) {
                self.disarms.fetch_add(1, Ordering::Relaxed);
            }
        }
        self.device.send(bytes)
    }

    fn receive(&mut self, buffer: &mut [u8], patience: Duration) -> Result<usize, TransportError> {
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

/// A program without presets, that nobody ends; it may end with a panic.
#[derive(Default)]
struct Alone {
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
        false
    }
}

/// A keeper of a simulated device, to which nobody gives orders.
fn keeper(program: &Alone) -> Keeper<'_, Flood> {
    let scene =
        shipped::scene(Path::new("passive-examination"), &Overrides::default()).expect("a scene");
    let flood = Flood {
        device: Simulated::of(&scene).expect("a device"),
        received: None,
        ear: Decoder::new(),
        disarms: Arc::default(),
    };
    let client = Client::connect(flood).expect("a connection");
    let (orders, inbox) = mpsc::channel();
    let (questions, _) = mpsc::channel();
    let tokens = Tokens::draw().expect("a secret");
    let shared = Arc::new(Shared::new(tokens, Value::Null, orders, questions));
    Keeper::new(client, program, shared, inbox, None).expect("it answers")
}

/// Torque ends with what the keeper sends, not with the lease.
#[test]
fn a_panic_disarms_first() {
    let program = Alone { panics: true };
    let mut keeper = keeper(&program);
    keeper.client.zero().expect("a zero");
    keeper.client.arm().expect("armed");
    let disarms = keeper.client.transport_mut().disarms.clone();
    assert!(catch_unwind(AssertUnwindSafe(|| keeper.run())).is_err());
    assert_eq!(disarms.load(Ordering::Relaxed), 1);
}

#[test]
fn pages_have_their_turn_while_samples_come_faster_than_they_are_taken() {
    let program = Alone::default();
    let mut keeper = keeper(&program);
    for _ in 0..100 {
        keeper.client.transport_mut().received = Some(0);
        keeper.step();
    }
    assert!(keeper.now_s > 0.05, "{} s of samples", keeper.now_s);
}

#[test]
fn a_knee_that_asks_for_more_than_the_device_shows_is_told() {
    let program = Alone::default();
    let mut keeper = keeper(&program);
    keeper.apply("healthy", false).expect("a knee");
    assert_eq!(keeper.message, None);
    keeper.apply("texture-bone-on-bone", false).expect("a knee");
    let message = keeper.message.clone().expect("a warning");
    assert!(
        message.contains("the symptoms can ask for 5.1 N·m together"),
        "{message}"
    );
}
