//! Lists, imports, and who has the device.

use crate::bench::{Bench, with_bench};
use crate::client::{Client, setup};
use crate::rig::Echo;
use crepitus_virtual_device::usb::usbip::Event;

const DEVICE_DESCRIPTOR: [u8; 8] = [0x80, 6, 0, 1, 0, 0, 18, 0];

fn status_of(bench: &mut Bench<'_, Echo>, bus_id: &str) -> (Client, u32) {
    let mut client = bench.connect();
    client.request_import(bus_id);
    let answer = bench.until(&mut client, Client::imported);
    (client, answer.expect_err("it is refused"))
}

#[test]
fn a_list_names_the_device_as_it_describes_itself() {
    with_bench(Echo::default(), |bench| {
        for round in 1..=3 {
            let mut client = bench.connect();
            client.request_list();
            let devices = bench.until(&mut client, Client::list);
            let [(record, interfaces)] = devices.as_slice() else {
                panic!("{devices:?}");
            };
            assert_eq!(record.bus_id, "1-1");
            assert_eq!((record.bus, record.number, record.speed), (1, 5, 2));
            assert_eq!((record.vendor, record.product), (0x16c0, 0x27dd));
            assert_eq!(record.class, [2, 0, 0]);
            assert_eq!(record.counts, [0, 1, 2], "not configured, one, two");
            assert_eq!(*interfaces, [[2, 2, 0, 0], [10, 0, 0, 0]]);
            bench.until_closed(&mut client);
            assert_eq!(bench.tap.resets, round, "it is read each time");
            assert!(bench.tap.is_suspended);
        }
        assert!(bench.events.is_empty(), "{:?}", bench.events);
    });
}

#[test]
fn an_imported_device_answers_with_its_own_descriptors() {
    with_bench(Echo::default(), |bench| {
        let (mut client, record) = bench.import();
        assert_eq!((record.vendor, record.product), (0x16c0, 0x27dd));
        let reply = bench.control(&mut client, DEVICE_DESCRIPTOR, &[]);
        assert_eq!((reply.status, reply.actual), (0, 18));
        let expected = [18, 1, 0x00, 0x02, 2, 0, 0, 64, 0xc0, 0x16, 0xdd, 0x27];
        assert_eq!(reply.data[..12], expected);
        // Only the first bytes, as before the size of control packets is known.
        let reply = bench.control(&mut client, setup(0x80, 6, 0x0100, 0, 8), &[]);
        assert_eq!((reply.status, reply.actual), (0, 8));
        // Asked for more than there is.
        let reply = bench.control(&mut client, setup(0x80, 6, 0x0200, 0, 1_000), &[]);
        assert_eq!((reply.status, reply.actual), (0, 67));
        assert_eq!(reply.data[1..4], [2, 67, 0]);
        assert_eq!(
            bench.server.importer().map(|peer| peer.ip().is_loopback()),
            Some(true)
        );
    });
}

#[test]
fn a_name_that_is_not_there_is_refused() {
    with_bench(Echo::default(), |bench| {
        for name in [
            "1-2",
            "",
            "1-11",
            "1-1.1",
            "\u{1b}[2J",
            "1234567890123456789012345678901x",
        ] {
            let (mut client, status) = status_of(bench, name);
            assert_eq!(status, 4, "ST_NODEV");
            bench.until_closed(&mut client);
            let expected = format!("refused: there is no device {name:?}, only \"1-1\"");
            assert_eq!(bench.last_event(), expected);
        }
        assert_eq!(bench.tap.resets, 0, "the device was left alone");
    });
}

#[test]
fn a_second_importer_is_refused_and_the_first_goes_on() {
    with_bench(Echo::default(), |bench| {
        let mut first = bench.configured();
        let (mut second, status) = status_of(bench, "1-1");
        assert_eq!(status, 2, "ST_DEV_BUSY");
        bench.until_closed(&mut second);
        assert!(bench.last_event().contains("another client"));
        // What is taken cannot be imported, so it is not listed.
        let mut third = bench.connect();
        third.request_list();
        assert_eq!(bench.until(&mut third, Client::list), []);
        assert_eq!(bench.tap.resets, 1);
        let reply = bench.control(&mut first, DEVICE_DESCRIPTOR, &[]);
        assert_eq!(reply.actual, 18);
    });
}

#[test]
fn two_that_ask_in_the_same_frame_are_one_importer() {
    with_bench(Echo::default(), |bench| {
        let mut clients = [bench.connect(), bench.connect(), bench.connect()];
        for client in &mut clients {
            client.request_import("1-1");
            client.exchange();
        }
        bench.frame();
        let mut answers = clients.each_mut().map(|client| {
            bench
                .until(client, Client::imported)
                .map(|record| record.number)
        });
        answers.sort_unstable();
        assert_eq!(answers, [Ok(5), Err(2), Err(2)]);
    });
}

#[test]
fn the_device_sees_a_client_leave_and_can_be_imported_again() {
    with_bench(Echo::default(), |bench| {
        for round in 1..=20 {
            let mut client = bench.configured();
            assert!(bench.port.is_configured());
            assert_eq!(bench.tap.resets, round);
            // In the middle of transfers in both directions.
            client.submit_in(2, 512, 0);
            client.submit_out(1, &[0x55; 1_280], 0);
            client.write();
            bench.frames(1 + round % 3);
            bench.leave(client);
            bench.frames(2);
            assert!(!bench.port.is_configured());
            assert_eq!(bench.end.hosts_lost, round);
            assert!(bench.tap.is_suspended);
            assert_eq!(bench.server.importer(), None);
            assert_eq!(bench.events.len(), 2 * round);
        }
        // Nothing of all that is left in the device.
        let mut client = bench.configured();
        client.submit_in(2, 512, 0);
        bench.silence(&mut client, 5);
        client.submit_out(1, b"new", 0);
        assert_eq!(bench.reply(&mut client).actual, 3);
        assert_eq!(bench.reply(&mut client).data, b"new");
    });
}

#[test]
fn a_pulled_cable_ends_the_import() {
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        client.submit_in(2, 64, 0);
        bench.silence(&mut client, 2);
        bench.tap.cable.unplug();
        bench.until_closed(&mut client);
        assert_eq!(bench.last_event(), "released: the device disconnected");
        assert_eq!(bench.end.hosts_lost, 1);
        // While it is out there is nothing to list or to import.
        let mut other = bench.connect();
        other.request_list();
        assert_eq!(bench.until(&mut other, Client::list), []);
        assert_eq!(status_of(bench, "1-1").1, 3, "ST_DEV_ERR");
        assert!(
            bench.last_event().contains("does not answer"),
            "{}",
            bench.last_event()
        );
        bench.tap.cable.plug_in();
        let mut client = bench.configured();
        client.submit_in(2, 64, 0);
        client.submit_out(1, b"back", 0);
        assert_eq!(bench.reply(&mut client).actual, 4);
        assert_eq!(bench.reply(&mut client).data, b"back");
    });
}

#[test]
fn a_device_that_hangs_is_not_offered() {
    with_bench(Echo::default(), |bench| {
        // The device is on the bus, but nothing polls it.
        let mut client = bench.connect();
        client.request_list();
        client.exchange();
        bench.hang_until(&mut client, 12);
        assert_eq!(client.list(), Some(vec![]));
    });
}

#[test]
fn the_bus_is_idle_while_nobody_has_the_device() {
    with_bench(Echo::default(), |bench| {
        bench.frames(100);
        assert_eq!(bench.turns, 2_000);
        assert_eq!((bench.tap.resets, bench.tap.seen.len()), (0, 0));
    });
}

#[test]
fn what_happened_is_reported_with_the_client() {
    with_bench(Echo::default(), |bench| {
        let (client, _) = bench.import();
        let importer = bench.server.importer().expect("it has the device");
        bench.leave(client);
        let [
            Event::Imported { client: first },
            Event::Released {
                client: second,
                cause,
            },
        ] = bench.events.as_slice()
        else {
            panic!("{:?}", bench.events);
        };
        assert_eq!([*first, *second], [importer; 2]);
        assert_eq!(cause.to_string(), "the client closed the connection");
    });
}
