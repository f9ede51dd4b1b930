//! A simulated device over USB/IP: the program, and a client of its own that drives the device through
//! the protocol, with the project's client library on top.
#![cfg(target_os = "linux")]

#[path = "../sim/virtual-device/tests/usbip/client.rs"]
#[allow(dead_code, reason = "shared with the server's own tests")]
mod client;
mod support;

use client::{Client as UsbIp, setup};
use crepitus_client::{Client, Event, Transport, TransportError};
use crepitus_protocol::parameters::id;
use crepitus_protocol::usb::{PRODUCT_ID, VENDOR_ID};
use serde_json::Value;
use std::collections::VecDeque;
use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::process::{Child, ChildStderr, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use support::served::signal;
use support::{crepitus, stderr, stdout};

/// Timeout of anything that a computer under load does late.
const PATIENCE: Duration = Duration::from_secs(20);

/// URBs that a serial driver keeps pending, and the buffer of each: as Linux's.
const READS: usize = 16;
const READ_LENGTH: u32 = 128;

/// `serve-sim --usbip`, until it is dropped.
struct Served {
    child: Child,
    address: SocketAddr,
    log: BufReader<ChildStderr>,
}

impl Served {
    fn new() -> Self {
        let mut child = crepitus()
            .args(["serve-sim", "--usbip", "127.0.0.1:0", "--json"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut text = String::new();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        while !text.ends_with("}\n") {
            assert_ne!(out.read_line(&mut text).unwrap(), 0, "{text}");
        }
        let said: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(said["bus_id"], "1-1");
        let log = BufReader::new(child.stderr.take().unwrap());
        Self {
            child,
            address: said["usbip"].as_str().unwrap().parse().unwrap(),
            log,
        }
    }

    /// The next line of its log.
    fn logged(&mut self) -> String {
        let mut line = String::new();
        self.log.read_line(&mut line).unwrap();
        line
    }

    /// Ends it in order; returns whether it did.
    fn end(mut self) -> bool {
        signal(&self.child, "-INT");
        self.child.wait().unwrap().success()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Waits until the client has what it waits for, or is disconnected.
fn until<T>(client: &mut UsbIp, mut what: impl FnMut(&mut UsbIp) -> Option<T>) -> Option<T> {
    let begun = Instant::now();
    loop {
        client.exchange();
        if let Some(value) = what(client) {
            return Some(value);
        }
        if client.is_closed {
            return None;
        }
        assert!(begun.elapsed() < PATIENCE, "no answer");
        sleep(Duration::from_micros(200));
    }
}

/// A serial driver, over USB/IP.
struct Driver {
    urbs: UsbIp,
    received: VecDeque<u8>,
    begun: Instant,
}

impl Driver {
    /// Imports the device and opens its port; or the status of the refusal.
    fn open(address: SocketAddr) -> Result<Self, u32> {
        let mut urbs = UsbIp::connect(address);
        urbs.request_import("1-1");
        let record = until(&mut urbs, UsbIp::imported).expect("an answer")?;
        assert_eq!((record.vendor, record.product), (VENDOR_ID, PRODUCT_ID));
        let line_coding = [0, 0xc2, 1, 0, 0, 0, 8];
        for (request, data) in [
            (setup(0x80, 6, 0x0100, 0, 18), &[][..]),
            (setup(0x00, 9, 1, 0, 0), &[]),
            (setup(0x21, 0x20, 0, 0, 7), &line_coding),
            (setup(0x21, 0x22, 3, 0, 0), &[]),
        ] {
            urbs.submit_control(request, data);
            let reply = until(&mut urbs, UsbIp::reply).expect("an answer");
            assert_eq!(reply.status, 0);
        }
        for _ in 0..READS {
            urbs.submit_in(2, READ_LENGTH, 0);
        }
        Ok(Self {
            urbs,
            received: VecDeque::new(),
            begun: Instant::now(),
        })
    }

    fn lost(&self) -> TransportError {
        TransportError::Lost {
            port: self.name(),
            detail: "the server closed the connection".to_owned(),
        }
    }
}

impl Transport for Driver {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        self.urbs.submit_out(1, bytes, 0);
        self.urbs.exchange();
        if self.urbs.is_closed {
            Err(self.lost())
        } else {
            Ok(())
        }
    }

    fn receive(&mut self, buffer: &mut [u8], patience: Duration) -> Result<usize, TransportError> {
        let begun = Instant::now();
        loop {
            self.urbs.exchange();
            while let Some(reply) = self.urbs.reply() {
                assert_eq!(reply.status, 0, "{reply:?}");
                if !reply.data.is_empty() {
                    self.urbs.submit_in(2, READ_LENGTH, 0);
                }
                self.received.extend(reply.data);
            }
            self.urbs.write();
            let count = self.received.len().min(buffer.len());
            for (place, byte) in buffer.iter_mut().zip(self.received.drain(..count)) {
                *place = byte;
            }
            if self.urbs.is_closed && count == 0 {
                return Err(self.lost());
            }
            if count > 0 || begun.elapsed() >= patience {
                return Ok(count);
            }
            sleep(Duration::from_micros(200));
        }
    }

    fn now(&self) -> Duration {
        self.begun.elapsed()
    }

    fn wait(&mut self, time: Duration) {
        sleep(time);
    }

    fn reopen(&mut self) -> Result<(), TransportError> {
        Err(self.lost())
    }

    fn name(&self) -> String {
        "usbip".to_owned()
    }
}

#[test]
fn the_device_works_over_usbip() {
    let mut served = Served::new();
    let mut client = Client::connect(Driver::open(served.address).unwrap()).unwrap();
    assert!(served.logged().contains("has imported the device"));
    assert_eq!(client.handshake().comms.serial, *b"SIM-COMMS-01");
    client.set(&[(id::STATIC_TORQUE, 0.45)]).unwrap();
    client.subscribe().unwrap();
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(1) {
        if let Some(Event::Lost(error)) = client.pump(Duration::from_millis(20)).unwrap() {
            panic!("{error}");
        }
    }
    let sums = client.accounting().unwrap();
    assert_eq!(sums.produced(), sums.received() + sums.dropped());
    // A computer under load may run the device slower than real time, and read late.
    assert!(sums.received() > 5_000, "{sums:?}");
    assert_eq!((sums.old_blocks(), sums.violations()), (0, 0));
    println!("{} samples, {} dropped", sums.received(), sums.dropped());
    // One device, one client.
    assert_eq!(Driver::open(served.address).err(), Some(2), "ST_DEV_BUSY");
    assert!(served.logged().contains("imported by another client"));
    // It is let go, and it is the same device for the next one.
    drop(client);
    assert!(served.logged().contains("the client closed the connection"));
    let mut client = Client::connect(Driver::open(served.address).unwrap()).unwrap();
    let (_, values) = client.parameters().unwrap();
    assert_eq!(values.get(id::STATIC_TORQUE), Some(0.45));
    assert!(served.end());
}

#[test]
fn the_command_line_says_what_it_offers() {
    let help = stdout(&crepitus().args(["serve-sim", "--help"]).output().unwrap());
    assert!(help.contains("usbip attach -r 127.0.0.1 -b 1-1"), "{help}");
    assert!(help.contains("no authentication"), "{help}");
    for (arguments, expected) in [
        (
            &["--usbip", "localhost"][..],
            "expected an IP address and a port",
        ),
        (
            &["--usbip", "127.0.0.1:70000"],
            "expected an IP address and a port",
        ),
        (&["--usbip", "192.0.2.1:3240"], "--usbip 192.0.2.1:3240"),
        (&["--usbip", "--name", "knee"], "cannot be used with"),
    ] {
        let output = crepitus()
            .arg("serve-sim")
            .args(arguments)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
    let served = Served::new();
    let again = ["serve-sim", "--usbip", &served.address.to_string()];
    let output = crepitus().args(again).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("another program listens"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn an_address_that_others_can_reach_has_a_warning() {
    for (address, is_warned) in [("127.0.0.1:0", false), ("0.0.0.0:0", true)] {
        let mut child = crepitus()
            .args(["serve-sim", "--usbip", address])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        out.read_line(&mut line).unwrap();
        assert!(line.contains("is offered over USB/IP at"), "{line}");
        out.read_line(&mut line).unwrap();
        assert!(
            line.contains("modprobe vhci-hcd && usbip --tcp-port"),
            "{line}"
        );
        signal(&child, "-INT");
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success());
        let text = stderr(&output);
        assert_eq!(
            text.contains("warning: USB/IP has no authentication"),
            is_warned,
            "{text}"
        );
    }
}
