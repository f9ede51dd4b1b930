//! The images over USB/IP: what a client on another computer sees of them.

use crate::client::{Client, Reply, setup};
use crate::host::{MS, pair};
use crepitus_emulator::Pair;
use crepitus_emulator::mcu::Reset;
use crepitus_virtual_device::usb::cabled::CabledDevice as _;
use crepitus_virtual_device::usb::usbip::Server;
use crepitus_virtual_device::usb::wire::UsbWire as _;

/// The pair with a server.
struct Bench {
    pair: Pair,
    server: Server,
    log: Vec<String>,
}

impl Bench {
    /// Lets time pass until the client has what it waits for.
    fn until<T>(
        &mut self,
        client: &mut Client,
        mut what: impl FnMut(&mut Client) -> Option<T>,
    ) -> T {
        for _ in 0..2_000 {
            client.exchange();
            if let Some(value) = what(client) {
                return value;
            }
            let events = self.pair.serve(&mut self.server);
            self.log
                .extend(events.iter().map(|event| format!("{event:?}")));
        }
        panic!("nothing for two seconds");
    }

    fn import(&mut self) -> Client {
        let mut client = Client::connect(self.server.local_address().expect("it listens"));
        client.request_import("1-1");
        let record = self.until(&mut client, Client::imported);
        assert_eq!(record.expect("it is free").vendor, 0x16c0);
        client
    }

    fn control(&mut self, client: &mut Client, setup: [u8; 8], data: &[u8]) -> Reply {
        client.submit_control(setup, data);
        self.until(client, Client::reply)
    }

    /// Frames without a client.
    fn frames(&mut self, count: usize) {
        for _ in 0..count {
            let events = self.pair.serve(&mut self.server);
            self.log
                .extend(events.iter().map(|event| format!("{event:?}")));
        }
    }
}

fn bench() -> Option<Bench> {
    let mut pair = pair()?;
    pair.plug_in().expect("a device");
    let address = "127.0.0.1:0".parse().expect("an address");
    Some(Bench {
        pair,
        server: Server::bind(address).expect("a free port"),
        log: Vec::new(),
    })
}

#[test]
fn the_images_are_a_device_over_usbip() {
    let Some(mut bench) = bench() else { return };
    let mut client = bench.import();
    assert!(
        !bench.pair.is_plugged_in(),
        "not for the host in this process"
    );
    let device = bench.control(&mut client, setup(0x80, 6, 0x0100, 0, 18), &[]);
    assert_eq!((device.status, device.data.len()), (0, 18));
    assert_eq!(device.data[..4], [18, 1, 0x00, 0x02]);
    let unknown = bench.control(&mut client, setup(0x80, 6, 0x0600, 0, 10), &[]);
    assert_eq!(unknown.status, -32, "DEVICE_QUALIFIER");
    assert_eq!(
        bench.control(&mut client, setup(0, 9, 1, 0, 0), &[]).status,
        0
    );
    let coding = [0x80, 0x25, 0, 0, 2, 2, 7];
    let set = bench.control(&mut client, setup(0x21, 0x20, 0, 0, 7), &coding);
    assert_eq!((set.status, set.actual), (0, 7));
    let got = bench.control(&mut client, setup(0xa1, 0x21, 0, 0, 7), &[]);
    assert_eq!(got.data, coding);
    // A read that waits, and is withdrawn.
    let pending = client.submit_in(2, 128, 0);
    let unlink = client.unlink(pending);
    let reply = bench.until(&mut client, Client::reply);
    assert_eq!((reply.sequence, reply.status), (unlink, -104));
    // A halt, a stall, and the end of both.
    let halt = |request| setup(0x02, request, 0, 0x82, 0);
    assert_eq!(bench.control(&mut client, halt(3), &[]).status, 0);
    client.submit_in(2, 128, 0);
    assert_eq!(bench.until(&mut client, Client::reply).status, -32);
    assert_eq!(bench.control(&mut client, halt(1), &[]).status, 0);
    assert!(!bench.log.iter().any(|event| event.starts_with("Released")));
}

#[test]
fn a_client_that_leaves_is_an_idle_bus_and_a_reset_a_device_that_disconnects() {
    let Some(mut bench) = bench() else { return };
    for _ in 0..3 {
        let mut client = bench.import();
        assert_eq!(
            bench.control(&mut client, setup(0, 9, 1, 0, 0), &[]).status,
            0
        );
        client.submit_in(2, 128, 0);
        client.exchange();
        bench.frames(2);
        drop(client);
        while bench.server.importer().is_some() {
            bench.frames(1);
        }
    }
    let mut client = bench.import();
    client.submit_in(2, 128, 0);
    client.exchange();
    bench.pair.boards_mut().comms_mut().reset(Reset::Pin);
    bench.until(&mut client, |client| client.is_closed.then_some(()));
    assert!(
        bench
            .log
            .last()
            .is_some_and(|event| event.contains("DeviceDisconnected"))
    );
    // Once it has started it can be imported again.
    let ticks = bench.pair.now();
    while !bench.pair.boards().is_connected() {
        bench.frames(1);
        assert!(bench.pair.now() - ticks < 2_000 * MS, "it has not started");
    }
    bench.import();
}
