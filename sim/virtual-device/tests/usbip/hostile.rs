//! Clients that send nonsense, too much or nothing: the server says why, the next one is served.

use crate::bench::{BULK_IN, BULK_OUT, Bench, with_bench};
use crate::client::{Client, setup};
use crate::rig::Echo;
use proptest::prelude::*;

/// The words of a command, with its SETUP packet as two words.
fn message(words: [u32; 12]) -> Vec<u8> {
    words.into_iter().flat_map(u32::to_be_bytes).collect()
}

const DEVICE: u32 = 0x0001_0005;

/// The device can be imported, and it works.
fn assert_serves(bench: &mut Bench<'_, Echo>) {
    let mut client = bench.configured();
    client.submit_out(BULK_OUT, b"still there?", 0);
    client.submit_in(BULK_IN, 64, 0);
    assert_eq!(bench.reply(&mut client).actual, 12);
    assert_eq!(bench.reply(&mut client).data, b"still there?");
    bench.leave(client);
}

#[test]
fn a_request_that_is_none_ends_the_connection() {
    with_bench(Echo::default(), |bench| {
        for (request, cause) in [
            (b"GET / HTTP/1.1\r\n".to_vec(), "got 0x4745"),
            (vec![0, 0], "got 0x0000"),
            (vec![0x01, 0x06, 0x80, 0x05, 0, 0, 0, 0], "got 0x0106"),
            (vec![0x01, 0x11, 0x00, 0x05, 0, 0, 0, 0], "got 0x0005"),
            (vec![0x01, 0x11, 0xff, 0xff], "got 0xffff"),
            (vec![0xff; 10_000], "got 0xffff"),
        ] {
            let mut client = bench.connect();
            client.send(&request);
            bench.until_closed(&mut client);
            assert_eq!(client.unread(), b"");
            assert!(bench.last_event().contains(cause), "{}", bench.last_event());
        }
        assert_eq!(bench.tap.resets, 0, "the device was left alone");
        assert_serves(bench);
    });
}

#[test]
fn a_request_that_is_cut_off_is_reported() {
    with_bench(Echo::default(), |bench| {
        let mut import = vec![0x01, 0x11, 0x80, 0x03, 0, 0, 0, 0];
        import.resize(40, 0);
        for length in 1..40 {
            let mut client = bench.connect();
            client.send(&import[..length]);
            client.end();
            bench.until_closed(&mut client);
            let expected = format!("after {length} bytes of a message");
            assert!(
                bench.last_event().contains(&expected),
                "{}",
                bench.last_event()
            );
        }
        // One that only looks whether somebody listens is no event.
        bench.events.clear();
        drop(bench.connect());
        bench.frames(2);
        assert!(bench.events.is_empty(), "{:?}", bench.events);
        // One that ends its half after the request gets the reply.
        let mut client = bench.connect();
        client.request_list();
        client.end();
        assert_eq!(bench.until(&mut client, Client::list).len(), 1);
    });
}

#[test]
fn a_command_that_is_none_ends_the_import() {
    with_bench(Echo::default(), |bench| {
        for (words, cause) in [
            ([0; 12], "got command 0x0"),
            ([3, 1, DEVICE, 0, 0, 0, 0, 0, 0, 0, 0, 0], "got command 0x3"),
            (
                [1, 1, 0x0001_0006, 1, 2, 0, 64, 0, 0, 0, 0, 0],
                "0x00010005 is imported",
            ),
            (
                [2, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0],
                "0x00010005 is imported",
            ),
            ([1, 1, DEVICE, 7, 2, 0, 64, 0, 0, 0, 0, 0], "got 7"),
            ([1, 1, DEVICE, 1, 16, 0, 64, 0, 0, 0, 0, 0], "got 16"),
            (
                [1, 1, DEVICE, 0, 1, 0, 262_145, 0, 0, 0, 0, 0],
                "a transfer of 262145 bytes",
            ),
            (
                [1, 1, DEVICE, 0, 1, 0, u32::MAX, 0, 0, 0, 0, 0],
                "a transfer of 4294967295 bytes",
            ),
            (
                [1, 1, DEVICE, 1, 2, 0, 64, 0, 4, 0, 0, 0],
                "4 isochronous packets",
            ),
        ] {
            let mut client = bench.configured();
            client.submit_in(BULK_IN, 64, 0);
            client.send(&message(words));
            client.submit_in(BULK_IN, 64, 0);
            bench.until_closed(&mut client);
            assert!(bench.last_event().contains(cause), "{}", bench.last_event());
            assert!(
                !bench
                    .tap
                    .seen
                    .contains(&crate::bench::Transaction::Stall(2))
            );
        }
        assert_serves(bench);
    });
}

#[test]
fn a_client_killed_within_a_message_is_reported() {
    with_bench(Echo::default(), |bench| {
        let submit = message([1, 1, DEVICE, 0, 1, 0, 1_000, 0, 0, 0, 0, 0]);
        let whole = [submit, vec![0x42; 1_000]].concat();
        for length in [1, 20, 47, 48, 49, 1_047] {
            let mut client = bench.configured();
            client.submit_in(BULK_IN, 64, 0);
            client.send(&whole[..length]);
            client.write();
            bench.leave(client);
            let expected =
                format!("released: the client closed the connection after {length} bytes");
            assert!(
                bench.last_event().starts_with(&expected),
                "{}",
                bench.last_event()
            );
            assert_eq!(bench.tap.seen, [], "half a message is not executed");
        }
        assert_serves(bench);
    });
}

#[test]
fn a_client_that_says_nothing_is_sent_away_after_five_seconds() {
    with_bench(Echo::default(), |bench| {
        let mut silent: Vec<Client> = (0..8).map(|_| bench.connect()).collect();
        silent[3].send(&[0x01, 0x11]);
        silent.iter_mut().for_each(Client::exchange);
        bench.frames(10);
        // The places are taken; who comes now waits.
        let mut late = bench.connect();
        late.request_list();
        late.exchange();
        bench.frames(4_980);
        late.exchange();
        assert_eq!(late.unread(), b"");
        assert!(bench.events.is_empty(), "{:?}", bench.events);
        bench.until_events(8);
        let devices = bench.until(&mut late, Client::list);
        assert_eq!(devices.len(), 1);
        assert_eq!(bench.events.len(), 8);
        assert_eq!(
            bench.last_event(),
            "refused: no complete request within 5 s"
        );
        for client in &mut silent {
            client.exchange();
            assert!(client.is_closed);
        }
    });
}

#[test]
fn too_much_at_once_is_refused_and_the_rest_is_done() {
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        let numbers: Vec<u32> = (0..300).map(|_| client.submit_in(BULK_IN, 64, 0)).collect();
        for number in &numbers[256..] {
            let reply = bench.reply(&mut client);
            assert_eq!((reply.sequence, reply.status), (*number, -12), "-ENOMEM");
        }
        for number in &numbers[1..256] {
            client.unlink(*number);
            assert_eq!(bench.reply(&mut client).status, -104);
        }
        // Data to a device that takes none: four times 256 KiB wait, the fifth does not.
        let long = vec![0x33; 256 * 1024];
        let numbers = [(); 5].map(|()| client.submit_out(BULK_OUT, &long, 0));
        while client.unsent() > 0 {
            client.write();
            bench.hang(1);
        }
        bench.hang_until(&mut client, 48);
        let reply = client.reply().expect("an answer");
        assert_eq!(
            (reply.sequence, reply.status, reply.actual),
            (numbers[4], -12, 0)
        );
        assert_eq!(client.reply(), None);
        bench.leave(client);
        assert_serves(bench);
    });
}

#[test]
fn a_client_that_does_not_read_stops_only_itself() {
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        let configuration = setup(0x80, 6, 0x0200, 0, 67);
        let mut sent = 0_u32;
        // Until neither the server nor the system between them takes more.
        let mut stuck = 0;
        while stuck < 20 {
            if client.unsent() < 4_096 {
                client.submit_control(configuration, &[]);
                sent += 1;
                stuck = 0;
            } else {
                client.write();
                bench.frame();
                stuck += 1;
            }
            assert!(sent < 2_000_000, "nothing is ever full");
        }
        let turns = bench.turns;
        bench.frames(10);
        assert_eq!(bench.turns - turns, 200, "the device goes on");
        let mut other = bench.connect();
        other.request_list();
        assert_eq!(
            bench.until(&mut other, Client::list),
            [],
            "others are served"
        );
        // The client reads at last: one answer for each, in order but for those that were refused.
        let mut answered = 0_u32;
        let mut last = 0;
        let mut rounds = 0;
        while answered < sent {
            client.exchange();
            while let Some(reply) = client.reply() {
                answered += 1;
                if reply.status == 0 {
                    assert!(reply.sequence > last && reply.data.len() == 67);
                    last = reply.sequence;
                } else {
                    assert_eq!(reply.status, -12);
                }
            }
            bench.frame();
            rounds += 1;
            assert!(rounds < 100_000, "{answered} of {sent}");
        }
        bench.silence(&mut client, 5);
    });
}

/// A command that may be valid, to this device.
fn any_command() -> impl Strategy<Value = Vec<u8>> {
    let words = (
        1..3_u32,
        0..20_u32,
        0..2_u32,
        0..5_u32,
        any::<u32>(),
        0..200_u32,
    );
    let setup = prop_oneof![
        any::<[u8; 8]>(),
        (
            prop::sample::select(vec![0x00, 0x80, 0x02, 0x82, 0x21, 0xa1]),
            0..12_u8,
            any::<[u8; 4]>(),
            0..200_u8
        )
            .prop_map(|(kind, request, [a, b, c, d], length)| [
                kind, request, a, b, c, d, length, 0
            ]),
    ];
    let command = (words, setup).prop_map(
        |((code, sequence, direction, endpoint, flags, length), setup)| {
            let words = [
                code, sequence, DEVICE, direction, endpoint, flags, length, 0, 0, 0,
            ];
            let mut bytes: Vec<u8> = words.into_iter().flat_map(u32::to_be_bytes).collect();
            bytes.extend(setup);
            if code == 1 && direction == 0 {
                bytes.extend(vec![0x5a; length as usize]);
            }
            bytes
        },
    );
    prop_oneof![
        60 => command,
        1 => prop::collection::vec(any::<u8>(), 0..100),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn any_commands_leave_a_server_that_serves(
        commands in prop::collection::vec((any_command(), 0..3_usize), 0..60),
        unplugs in prop::option::of(0..60_usize),
    ) {
        with_bench(Echo::default(), |bench| {
            let (mut client, _) = bench.import();
            for (index, (command, frames)) in commands.into_iter().enumerate() {
                client.send(&command);
                client.exchange();
                bench.frames(frames);
                if unplugs == Some(index) {
                    bench.tap.cable.unplug();
                    bench.frame();
                    bench.tap.cable.plug_in();
                }
            }
            drop(client);
            bench.wait(|bench| bench.server.importer().is_none().then_some(()));
            assert_serves(bench);
        });
    }
}
