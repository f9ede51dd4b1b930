//! The client over a pty, in the wall's time.

use crate::support::{Device, ms};
use crepitus_client::{Client, Error, Event, Holder, Serial, Transport, TransportError};
use crepitus_protocol::State;
use serialport::{SerialPort, TTYPort};
use std::io::{Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// A device at the other end of a pty, in a thread.
struct Pty {
    path: String,
    is_over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Pty {
    fn new() -> Self {
        let (master, slave) = TTYPort::pair().unwrap();
        let path = slave.name().unwrap();
        let is_over = Arc::new(AtomicBool::new(false));
        let flag = is_over.clone();
        // The slave stays open there until the end: otherwise the master fails
        // as long as nobody else has it open.
        let thread = thread::spawn(move || serve(master, &slave, &flag));
        Self {
            path,
            is_over,
            thread: Some(thread),
        }
    }

    fn unplug(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap();
    }
}

fn serve(mut master: TTYPort, _slave: &TTYPort, is_over: &AtomicBool) {
    let mut device = Device::new();
    device.add_host();
    device.room = 4_096;
    master.set_timeout(ms(1)).unwrap();
    let began = Instant::now();
    let mut bytes = [0; 1_024];
    while !is_over.load(Ordering::Relaxed) {
        if let Ok(count) = master.read(&mut bytes) {
            device.hear(&bytes[..count]);
        }
        // The device waits for a busy machine: its buffer would run over.
        if Duration::from_millis(device.now_ms()) < began.elapsed() && device.waiting(0).is_empty()
        {
            device.millisecond();
        }
        let waiting = device.waiting(0);
        if let Ok(count) = master.write(waiting.make_contiguous()) {
            waiting.drain(..count);
        }
    }
}

#[test]
fn a_pty_is_a_port_like_any_other() {
    let mut pty = Pty::new();
    let mut client = Client::connect(Serial::open(&pty.path).unwrap()).unwrap();
    assert_eq!(client.port(), pty.path);
    client.subscribe().unwrap();
    let mut blocks = 0;
    // The device runs in real time on a machine that may be busy.
    let end = client.now() + ms(30_000);
    while blocks <= 50 && client.now() < end {
        blocks += u32::from(matches!(
            client.pump(ms(20)).unwrap(),
            Some(Event::Block(_))
        ));
    }
    client.unsubscribe().unwrap();
    assert!(blocks > 50, "{blocks}");
    let accounting = client.accounting().unwrap();
    assert_eq!((accounting.violations(), accounting.dropped()), (0, 0));
    assert_eq!(client.status().unwrap().state, State::Disarmed);

    // One program at a time.
    match Serial::open(&pty.path).unwrap_err() {
        TransportError::Busy { port, holder } => {
            assert_eq!(port, pty.path);
            if cfg!(target_os = "linux") {
                let Holder { pid, .. } = holder.unwrap();
                assert_eq!(pid, std::process::id());
            }
        }
        other => panic!("{other}"),
    }

    pty.unplug();
    // What had arrived before comes first.
    let lost = (0..1_000).find_map(|_| match client.pump(ms(200)).unwrap() {
        Some(Event::Lost(error)) => Some(error),
        _ => None,
    });
    assert!(
        matches!(lost, Some(TransportError::Lost { .. })),
        "{lost:?}"
    );
    let error = client.reconnect(ms(100)).unwrap_err();
    assert!(
        matches!(error, Error::Transport(TransportError::NotFound { .. })),
        "{error:?}"
    );
}

#[test]
fn errors_of_opening_give_the_cause() {
    assert!(matches!(
        Serial::open("/dev/no-such-port"),
        Err(TransportError::NotFound { .. })
    ));
    let file = tempfile::NamedTempFile::new().unwrap();
    let path = file.path().to_str().unwrap();
    assert!(matches!(
        Serial::open(path),
        Err(TransportError::NotSerial { .. })
    ));
}

#[test]
fn receiving_honours_its_timeout() {
    let pty = Pty::new();
    let mut serial = Serial::open(&pty.path).unwrap();
    let (began, mut buffer) = (serial.now(), [0; 16]);
    assert_eq!(serial.receive(&mut buffer, ms(50)), Ok(1), "a delimiter");
    while serial.receive(&mut buffer, ms(50)).unwrap() > 0 {}
    assert!(serial.now() >= began + ms(50));
    serial.wait(ms(10));
    serial.reopen().unwrap();
}
