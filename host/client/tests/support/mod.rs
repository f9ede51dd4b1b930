//! A device in this process: both controllers, a winding, a shaft that turns
//! as prescribed, and wires with noise.
//!
//! ```text
//! client ── Port ── noise ── Comms ══ link ══ Drive ── winding, shaft
//! ```

mod device;
mod noise;
mod port;

pub use device::Device;
pub use port::Port;

use crepitus_client::{Client, Error, Event, Options};
use crepitus_protocol::Session;
use crepitus_protocol::host::Refusal;
use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

/// A device that several hosts can share.
pub type Shared = Rc<RefCell<Device>>;

/// Milliseconds.
pub fn ms(count: u64) -> Duration {
    Duration::from_millis(count)
}

/// A device just after power-on, and a connection to it.
pub fn device() -> (Shared, Port) {
    let device = Rc::new(RefCell::new(Device::new()));
    let port = Port::new(&device);
    (device, port)
}

/// A client that always has the same session, and whose numbers pass 65,535 soon.
pub fn client(port: Port, session: u32) -> Client<Port> {
    Client::connect_with(port, options(session)).unwrap()
}

/// Options that make a test repeatable.
pub fn options(session: u32) -> Options {
    Options {
        session: Session(session),
        first_number: u32::from(u16::MAX) - 3,
    }
}

/// A device whose shaft turns like this from the start, and a client of it.
pub fn turning(shaft: fn(f64) -> f64) -> (Shared, Client<Port>) {
    let (device, port) = device();
    device.borrow_mut().shaft = shaft;
    let client = client(port, 0x0bad_cafe);
    (device, client)
}

/// A device and a client of it.
pub fn connected() -> (Shared, Client<Port>) {
    let (device, port) = device();
    let client = client(port, 0x0bad_cafe);
    (device, client)
}

/// Pumps for this long; returns all events except blocks.
pub fn pump_for(client: &mut Client<Port>, time: Duration) -> Vec<Event> {
    let end = client.now() + time;
    let mut events = Vec::new();
    while client.now() < end {
        let left = end.saturating_sub(client.now());
        match client.pump(left.min(ms(20))).unwrap() {
            Some(Event::Block(_)) | None => {}
            Some(event) => events.push(event),
        }
    }
    events
}

/// The reason of a rejection.
pub fn refusal<R: std::fmt::Debug>(result: Result<R, Error>) -> Refusal {
    match result.unwrap_err() {
        Error::Refused(refused) => refused.refusal,
        other => panic!("{other}"),
    }
}

/// Checks the sample accounting, with the expected losses.
pub fn check_accounting(client: &Client<Port>) -> [u64; 4] {
    let accounting = client.accounting().unwrap();
    assert_eq!(accounting.violations(), 0);
    assert_eq!(
        accounting.produced(),
        accounting.received() + accounting.dropped()
    );
    assert_eq!(
        accounting.dropped(),
        accounting.dropped_by_device() + accounting.lost_on_line()
    );
    if accounting.gap_count() <= 1_000 {
        let missing: u64 = accounting.gaps().map(|gap| gap.samples).sum();
        assert_eq!(missing, accounting.dropped());
    }
    [
        accounting.produced(),
        accounting.received(),
        accounting.dropped_by_device(),
        accounting.lost_on_line(),
    ]
}

/// Texts for people stand in files, where a change of them is seen. With
/// `UPDATE_GOLDEN` set, the files are written.
pub fn golden(name: &str, text: &str) {
    let path = format!("{}/tests/golden/{name}.txt", env!("CARGO_MANIFEST_DIR"));
    let text = format!("{text}\n");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    assert_eq!(text, std::fs::read_to_string(&path).unwrap(), "{path}");
}
