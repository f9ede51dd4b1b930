//! The pty as a serial program sees it: opened, read, written, closed, opened again.

use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::os::unix::fs::{OpenOptionsExt, symlink};
use std::path::Path;
use std::time::{Duration, Instant};

use crepitus_device::usb_port::{HostBytes, UsbIdentity, UsbPort};
use crepitus_virtual_device::usb::bus::SoftBus;
use crepitus_virtual_device::usb::cable::SoftCable;
use crepitus_virtual_device::usb::host::CdcHost;
use crepitus_virtual_device::usb::pty::Pty;
use rustix::fs::OFlags;
use usb_device::bus::UsbBusAllocator;

/// Sends back what arrives, in capitals; optionally has a lot to say on its own.
#[derive(Default)]
struct Shout {
    queue: Vec<u8>,
    chatter: usize,
}

impl HostBytes for Shout {
    fn received(&mut self, bytes: &[u8]) {
        self.queue.extend(bytes.to_ascii_uppercase());
    }

    fn to_send(&self) -> &[u8] {
        if self.queue.is_empty() {
            &[b'.'; 64][..self.chatter.min(64)]
        } else {
            &self.queue
        }
    }

    fn sent(&mut self, count: usize) {
        if self.queue.is_empty() {
            self.chatter -= count;
        } else {
            self.queue.drain(..count);
        }
    }

    fn host_lost(&mut self) {
        self.queue.clear();
    }
}

/// A device, its host and its pty.
struct Port<'b> {
    device: UsbPort<'b, SoftBus>,
    end: Shout,
    cable: SoftCable,
    host: CdcHost,
    pty: Pty,
}

impl Port<'_> {
    fn frames(&mut self, count: usize) {
        for _ in 0..count {
            self.pty.exchange(&mut self.host).expect("the pty works");
            let (device, end) = (&mut self.device, &mut self.end);
            self.host
                .frame(&mut self.cable, &mut |_| device.poll(end))
                .expect("the bus works");
        }
        self.pty.exchange(&mut self.host).expect("the pty works");
    }

    /// Runs until the program has read this many bytes; the kernel hands them over in its own
    /// time, usually at once.
    fn read(&mut self, program: &mut File, count: usize) -> Vec<u8> {
        let deadline = Instant::now() + Duration::from_secs(20);
        let mut bytes = Vec::new();
        while bytes.len() < count {
            assert!(Instant::now() < deadline, "only {} bytes", bytes.len());
            self.frames(1);
            let mut chunk = [0; 4_096];
            match program.read(&mut chunk) {
                Ok(got) => bytes.extend(&chunk[..got]),
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    std::thread::sleep(Duration::from_micros(100));
                }
                Err(error) => panic!("{error}"),
            }
        }
        bytes
    }
}

fn with_port(end: Shout, link: Option<&Path>, test: impl FnOnce(Port<'_>)) {
    let identity = UsbIdentity {
        manufacturer: "Crepitus project",
        product: "Crepitus",
        serial_number: "1",
    };
    let (bus, mut cable) = SoftBus::new();
    let allocator = UsbBusAllocator::new(bus);
    let mut device = UsbPort::new(&allocator, &identity).expect("the identity is valid");
    let mut end = end;
    let host =
        CdcHost::enumerate(&mut cable, &mut |_| device.poll(&mut end)).expect("it enumerates");
    let pty = Pty::new(link).expect("there is a pty");
    test(Port {
        device,
        end,
        cable,
        host,
        pty,
    });
}

fn open(path: &Path) -> File {
    let flags = OFlags::NOCTTY | OFlags::NONBLOCK;
    File::options()
        .read(true)
        .write(true)
        .custom_flags(i32::try_from(flags.bits()).expect("a flag word"))
        .open(path)
        .expect("the port opens")
}

#[test]
fn every_byte_value_passes_unchanged() {
    with_port(Shout::default(), None, |mut port| {
        let mut program = open(port.pty.path());
        // Raw mode: no echo, no line editing, no signals, no newline translation.
        let bytes: Vec<u8> = (0..=255).rev().collect();
        program.write_all(&bytes).expect("it takes them");
        let expected = bytes.to_ascii_uppercase();
        assert_eq!(port.read(&mut program, 256), expected);
    });
}

#[test]
fn it_knows_whether_a_program_has_it_open() {
    let pty = Pty::new(None).expect("there is a pty");
    let is_open = || pty.is_open().expect("it can tell");
    assert!(!is_open());
    let first = open(pty.path());
    assert!(is_open());
    let second = open(pty.path());
    drop(first);
    assert!(is_open(), "the second program still has it");
    drop(second);
    assert!(!is_open());
    let _third = open(pty.path());
    assert!(is_open());
}

#[test]
fn closed_and_opened_again() {
    with_port(Shout::default(), None, |mut port| {
        for round in 0..3 {
            let mut program = open(port.pty.path());
            program.write_all(b"hello").expect("it takes them");
            assert_eq!(port.read(&mut program, 5), b"HELLO", "round {round}");
            // The answer to this one is never read by the program that asked.
            program.write_all(b"unread").expect("it takes them");
            port.frames(5);
            drop(program);
            port.frames(5);
        }
    });
}

#[test]
fn a_last_word_before_closing_is_delivered() {
    with_port(Shout::default(), None, |mut port| {
        let mut program = open(port.pty.path());
        port.frames(1);
        program.write_all(b"stop").expect("it takes them");
        drop(program);
        port.frames(3);
        // The device took it; its answer waits for the next program, as on a real port.
        assert_eq!(port.host.unsent(), 0);
        assert_eq!(port.host.traffic().bytes_out, 4);
        let mut program = open(port.pty.path());
        assert_eq!(port.read(&mut program, 4), b"STOP");
    });
}

#[test]
fn a_program_that_does_not_read_stops_nobody() {
    const CHATTER: usize = 1_000_000;
    let end = Shout {
        chatter: CHATTER,
        ..Shout::default()
    };
    with_port(end, None, |mut port| {
        let mut program = open(port.pty.path());
        port.frames(500);
        let fetched = usize::try_from(port.host.traffic().bytes_in).expect("it fits");
        assert!(fetched < 300_000, "{fetched} bytes fetched for nobody");
        // What stands in the device is nearly all of it; what was fetched is not lost.
        let left = CHATTER - fetched - port.end.chatter;
        assert!(left <= 512 + 64, "{left} bytes in the device's port");
        let bytes = port.read(&mut program, CHATTER);
        assert!(bytes.iter().all(|&byte| byte == b'.'));
    });
}

#[test]
fn without_a_program_nothing_is_fetched() {
    let end = Shout {
        chatter: 10_000,
        ..Shout::default()
    };
    with_port(end, None, |mut port| {
        port.frames(100);
        assert_eq!(port.host.traffic().bytes_in, 0);
        let mut program = open(port.pty.path());
        assert_eq!(port.read(&mut program, 10_000).len(), 10_000);
    });
}

#[test]
fn the_link_comes_and_goes_with_the_pty() {
    let folder = tempfile::tempdir().expect("a folder");
    let link = folder.path().join("crepitus");
    symlink("/dev/pts/999999", &link).expect("a leftover link");
    with_port(Shout::default(), Some(&link), |mut port| {
        assert_eq!(port.pty.path(), link);
        let mut program = open(&link);
        program.write_all(b"via link").expect("it takes them");
        assert_eq!(port.read(&mut program, 8), b"VIA LINK");
        // A second simulator takes the name over; the first does not remove it then.
        let second = Pty::new(Some(&link)).expect("a second pty");
        drop(port);
        assert!(link.exists());
        drop(second);
        assert!(std::fs::symlink_metadata(&link).is_err());
    });
}

#[test]
fn what_is_not_ours_is_not_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("notes");
    std::fs::write(&file, "mine").expect("a file");
    let elsewhere = folder.path().join("elsewhere");
    symlink(&file, &elsewhere).expect("a link");
    for taken in [&file, &elsewhere] {
        let error = Pty::new(Some(taken)).expect_err("refused");
        assert_eq!(error.kind(), ErrorKind::AlreadyExists);
        assert_eq!(std::fs::read_to_string(taken).expect("still there"), "mine");
    }
}

#[test]
fn two_ptys_are_two_ports() {
    let one = Pty::new(None).expect("there is a pty");
    let two = Pty::new(None).expect("there is another");
    assert_ne!(one.path(), two.path());
    let _program = open(one.path());
    assert!(one.is_open().expect("it can tell"));
    assert!(!two.is_open().expect("it can tell"));
}
