//! The client library at the USB cable of the pair.

use crepitus_client::{Client, Event, Options, Transport, TransportError};
use crepitus_emulator::firmware::{Program, image_for_test};
use crepitus_emulator::pair::Boards;
use crepitus_emulator::{Image, Pair};
use crepitus_protocol::Session;
use crepitus_scene::values::values;
use crepitus_scene::{Overrides, Scene};
use crepitus_virtual_device::Leg;
use std::path::Path;
use std::time::Duration;

/// Ticks in a millisecond.
pub(crate) const MS: u64 = 20;

/// Timeout of a write that the device does not accept, ticks.
const TIMEOUT_TICKS: u64 = 2_000;

/// The cable.
pub(crate) struct Cable {
    pub(crate) pair: Pair,
    /// Bytes that the host has sent, write by write, if they are wanted.
    pub(crate) sent: Option<Vec<Vec<u8>>>,
    /// Says after a tick whether power fails now.
    pub(crate) power_fails: Option<PowerFails>,
    is_torn: bool,
}

pub(crate) type PowerFails = Box<dyn FnMut(&Boards) -> bool>;

pub(crate) type Host = Client<Cable>;

pub(crate) fn scene() -> Scene {
    let text = include_str!("../drive_image/examination.toml");
    Scene::parse(Path::new("examination.toml"), text, &Overrides::default()).expect("a scene")
}

/// The images of drive and comms.
pub(crate) fn images() -> Option<[Image; 2]> {
    Some([
        image_for_test(Program::Drive)?,
        image_for_test(Program::Comms)?,
    ])
}

pub(crate) fn leg() -> Leg {
    Leg::new(&scene())
}

/// The pair with the scene's parameters stored, not plugged in.
pub(crate) fn pair() -> Option<Pair> {
    let [drive, comms] = images()?;
    let values = values(&scene()).expect("a scene for the device");
    Some(Pair::of(&drive, &comms, leg(), &values))
}

/// Plugs a pair in.
pub(crate) fn plugged_in(mut pair: Pair) -> Cable {
    pair.plug_in().expect("a device");
    Cable {
        pair,
        sent: None,
        power_fails: None,
        is_torn: false,
    }
}

/// A client of a pair, which it plugs in first.
pub(crate) fn client(pair: Pair) -> Host {
    connect_as(plugged_in(pair), 0x1234)
}

/// A client with this session, which no other may have had.
pub(crate) fn connect_as(cable: Cable, session: u32) -> Host {
    let options = Options {
        session: Session(session),
        ..Options::default()
    };
    Client::connect_with(cable, options).expect("a connection")
}

/// A client of the pair as it is switched on.
pub(crate) fn connected() -> Option<Host> {
    Some(client(pair()?))
}

/// A client of the pair under torque: zeroed where the leg is, armed, and the hand moves.
pub(crate) fn under_torque() -> Option<Host> {
    let mut host = connected()?;
    arm(&mut host);
    Some(host)
}

/// Arms, and waits until the motor is driven.
pub(crate) fn arm(host: &mut Host) {
    host.zero().expect("a zero");
    host.arm().expect("armed");
    let is_driven = (0..100).any(|_| {
        run(host, 1);
        boards(host).is_driven()
    });
    assert!(is_driven, "armed, and not driven");
}

pub(crate) fn boards(host: &mut Host) -> &mut Boards {
    host.transport_mut().pair.boards_mut()
}

/// Lets the device run for these milliseconds, as a program that has it open
/// does: receives, and renews the lease. Returns what has happened.
pub(crate) fn run(host: &mut Host, milliseconds: u64) -> Vec<Event> {
    let mut events = Vec::new();
    for _ in 0..milliseconds {
        while let Ok(Some(event)) = host.pump(Duration::ZERO) {
            events.push(event);
        }
        host.transport_mut().wait(Duration::from_millis(1));
    }
    events
}

/// Ticks until the motor is no longer driven, while the host goes on (or not); at
/// most so many.
pub(crate) fn ticks_until_off(host: &mut Host, most: u64, is_pumped: bool) -> u64 {
    for ticks in 0..=most {
        if !boards(host).is_driven() {
            return ticks;
        }
        if is_pumped {
            // A lost connection is found out later.
            let _ = host.pump(Duration::ZERO);
        }
        host.transport_mut().pair.tick();
    }
    panic!("still driven after {most} ticks");
}

impl Cable {
    fn tick(&mut self) {
        self.pair.tick();
        self.pair
            .check()
            .expect("a program that keeps to the manual");
        if let Some(fails) = &mut self.power_fails
            && fails(self.pair.boards())
        {
            self.power_fails = None;
            self.pair.power_cycle();
        }
    }

    fn lost() -> TransportError {
        TransportError::Lost {
            port: "the pair".into(),
            detail: "its cable is out".into(),
        }
    }
}

impl Transport for Cable {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        if let Some(sent) = &mut self.sent {
            sent.push(bytes.to_vec());
        }
        let delimiter: &[u8] = if self.is_torn { &[0] } else { &[] };
        let mut rest = [delimiter, bytes].concat();
        self.is_torn = true;
        for _ in 0..TIMEOUT_TICKS {
            let host = self.pair.host().ok_or_else(Self::lost)?;
            let taken = host.queue(&rest);
            rest.drain(..taken);
            if rest.is_empty() {
                self.is_torn = false;
                return Ok(());
            }
            self.tick();
        }
        Err(TransportError::Stalled {
            port: self.name(),
            patience: Duration::from_millis(100),
        })
    }

    fn receive(&mut self, buffer: &mut [u8], patience: Duration) -> Result<usize, TransportError> {
        let end = self.now() + patience;
        loop {
            let is_over = self.now() >= end;
            let host = self.pair.host().ok_or_else(Self::lost)?;
            let received = host.received();
            if !received.is_empty() || is_over {
                let count = received.len().min(buffer.len());
                buffer[..count].copy_from_slice(&received[..count]);
                host.consume(count);
                return Ok(count);
            }
            self.tick();
        }
    }

    fn now(&self) -> Duration {
        Duration::from_micros(50 * self.pair.now())
    }

    fn wait(&mut self, time: Duration) {
        let end = self.now() + time;
        while self.now() < end {
            self.tick();
        }
    }

    fn reopen(&mut self) -> Result<(), TransportError> {
        self.pair.plug_in().map_err(|error| TransportError::Open {
            port: self.name(),
            detail: error.to_string(),
        })
    }

    fn name(&self) -> String {
        "the pair".into()
    }
}
