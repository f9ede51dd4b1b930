use super::{Keeper, Program};
use crate::shared::Shared;
use crate::tokens::Tokens;
use crepitus_client::{Client, Error, Transport, TransportError};
use crepitus_connection::Simulated;
use crepitus_protocol::Session;
use crepitus_scene::preset::Preset;
use crepitus_scene::{Overrides, shipped};
use serde_json::Value;
use std::path::Path;
use std::sync::{Arc, mpsc};
use std::time::Duration;

/// A device that sends a block in the time in which this computer takes one.
struct Flood {
    device: Simulated,
    /// From now on, and how often bytes were asked for since.
    received: Option<u32>,
}

impl Transport for Flood {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
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

/// A program without presets, that nobody ends.
struct Alone;

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
        false
    }
}

#[test]
fn pages_have_their_turn_while_samples_come_faster_than_they_are_taken() {
    let scene =
        shipped::scene(Path::new("passive-examination"), &Overrides::default()).expect("a scene");
    let flood = Flood {
        device: Simulated::of(&scene).expect("a device"),
        received: None,
    };
    let client = Client::connect(flood).expect("a connection");
    let (orders, inbox) = mpsc::channel();
    let (questions, _) = mpsc::channel();
    let tokens = Tokens::draw().expect("a secret");
    let shared = Arc::new(Shared::new(tokens, Value::Null, orders, questions));
    let mut keeper = Keeper::new(client, &Alone, shared, inbox, None).expect("it answers");
    for _ in 0..100 {
        keeper.client.transport_mut().received = Some(0);
        keeper.step();
    }
    assert!(keeper.now_s > 0.05, "{} s of samples", keeper.now_s);
}
