//! Several transfers at once: pending, withdrawn, in order, at the speed of the bus.

use crate::bench::{BULK_IN, BULK_OUT, Bench, NOTIFICATIONS, Transaction, with_bench};
use crate::client::{Client, Reply, setup};
use crate::rig::{Echo, Source, pattern_bytes};

#[test]
fn a_notification_stays_pending_and_is_asked_for_once_in_its_interval() {
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        let sequence = client.submit_in(NOTIFICATIONS, 8, 0);
        bench.silence(&mut client, 1_100);
        let asked = bench.tap.notifications;
        assert!((4..=5).contains(&asked), "{asked}: bInterval is 255 frames");
        // The rest goes on meanwhile.
        client.submit_out(BULK_OUT, b"x", 0);
        client.submit_in(BULK_IN, 64, 0);
        assert_eq!(bench.reply(&mut client).actual, 1);
        assert_eq!(bench.reply(&mut client).data, b"x");
        let unlink = client.unlink(sequence);
        let reply = bench.reply(&mut client);
        assert_eq!(
            (reply.command, reply.sequence, reply.status),
            (4, unlink, -104)
        );
    });
}

#[test]
fn an_unlinked_transfer_has_one_answer() {
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        let first = client.submit_in(BULK_IN, 64, 0);
        let second = client.submit_in(BULK_IN, 64, 0);
        bench.silence(&mut client, 2);
        let unlink = client.unlink(first);
        let reply = bench.reply(&mut client);
        assert_eq!(
            (reply.command, reply.sequence, reply.status),
            (4, unlink, -104)
        );
        // Data goes to the one that is left, and there is no answer for the other.
        client.submit_out(BULK_OUT, b"data", 0);
        assert_eq!(bench.reply(&mut client).actual, 4);
        let reply = bench.reply(&mut client);
        assert_eq!((reply.command, reply.sequence), (3, second));
        assert_eq!(reply.data, b"data");
        bench.silence(&mut client, 5);
        // Too late, again, and for a number that never was.
        for victim in [second, first, 123_456] {
            let unlink = client.unlink(victim);
            let reply = bench.reply(&mut client);
            assert_eq!(
                (reply.command, reply.sequence, reply.status),
                (4, unlink, 0)
            );
        }
        bench.silence(&mut client, 5);
    });
}

#[test]
fn a_control_transfer_can_be_unlinked_in_any_stage() {
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        for turns in 0..6 {
            let victim = client.submit_control(setup(0x80, 6, 0x0200, 0, 67), &[]);
            client.exchange();
            // The device hangs after some turns, so the transfer stays where it is.
            let mut left = turns;
            let Bench {
                server,
                tap,
                port,
                end,
                ..
            } = bench;
            let events = server.frame(tap, &mut |_| {
                if left > 0 {
                    left -= 1;
                    port.poll(end);
                }
            });
            assert!(events.is_empty());
            let unlink = client.unlink(victim);
            let first = bench.reply(&mut client);
            if first.command == 3 {
                assert_eq!((first.sequence, first.data.len()), (victim, 67));
                let late = bench.reply(&mut client);
                assert_eq!((late.sequence, late.status), (unlink, 0));
            } else {
                assert_eq!((first.sequence, first.status), (unlink, -104));
            }
            let reply = bench.control(&mut client, setup(0x80, 6, 0x0100, 0, 18), &[]);
            assert_eq!((reply.status, reply.data.len()), (0, 18), "{turns} turns");
        }
    });
}

#[test]
fn pending_transfers_end_in_order() {
    with_bench(Source::new(16 * 128), |bench| {
        let mut client = bench.configured();
        let numbers: Vec<u32> = (0..16).map(|_| client.submit_in(BULK_IN, 128, 0)).collect();
        let mut received = Vec::new();
        for number in numbers {
            let reply = bench.reply(&mut client);
            assert_eq!(reply.sequence, number);
            received.extend(reply.data);
        }
        // The port ends a transfer at its own places: what is left comes with the next ones.
        while received.len() < 16 * 128 {
            client.submit_in(BULK_IN, 128, 0);
            received.extend(bench.reply(&mut client).data);
        }
        assert_eq!(received, pattern_bytes(16 * 128));
    });
}

/// A driver that always has sixteen transfers pending, as Linux's serial driver does.
fn read_all(client: &mut Client, replies: &mut Vec<Reply>) -> usize {
    let mut received = 0;
    while let Some(reply) = client.reply() {
        if reply.actual as usize == reply.data.len() {
            received += reply.data.len();
            client.submit_in(BULK_IN, 128, 0);
        }
        replies.push(reply);
    }
    received
}

#[test]
fn the_speed_is_that_of_the_bus() {
    const TOTAL: usize = 300_000;
    with_bench(Source::new(TOTAL), |bench| {
        let mut client = bench.configured();
        for _ in 0..16 {
            client.submit_in(BULK_IN, 128, 0);
        }
        let mut replies = Vec::new();
        let before = bench.turns;
        let mut received = 0;
        while received < TOTAL {
            client.exchange();
            received += read_all(&mut client, &mut replies);
            client.write();
            bench.frame();
            assert!(bench.turns - before < 20 * 1_000, "{received} bytes");
        }
        let bytes: Vec<u8> = replies.into_iter().flat_map(|reply| reply.data).collect();
        assert!(bytes == pattern_bytes(TOTAL), "a byte is wrong");
        let frames = (bench.turns - before) / 20;
        // At most 19 full packets in a frame: 1,216 bytes. Usually 256 frames, and more where the system
        // delivers late.
        assert!((247..=400).contains(&frames), "{frames} frames");
    });
}

#[test]
fn the_last_packet_of_a_frame_is_not_always_for_the_same_direction() {
    const FRAMES: usize = 60;
    with_bench(Source::new(200_000), |bench| {
        let mut client = bench.configured();
        for _ in 0..200 {
            client.submit_in(BULK_IN, 1_024, 0);
        }
        client.submit_out(BULK_OUT, &pattern_bytes(200_000), 0);
        let is_out = |seen: &Transaction| matches!(seen, Transaction::Out(1, _));
        bench.wait(|bench| {
            client.exchange();
            bench.tap.seen.iter().any(is_out).then_some(())
        });
        bench.tap.seen.clear();
        bench.frames(FRAMES);
        let outs = bench.tap.seen.iter().filter(|seen| is_out(seen)).count();
        let ins = bench.tap.seen.len() - outs;
        // 19 packets in a frame: nine for each, and one more.
        assert_eq!(outs + ins, 19 * FRAMES);
        assert!(
            outs > 9 * FRAMES && ins > 9 * FRAMES,
            "{outs} out, {ins} in"
        );
    });
}

#[test]
fn a_long_transfer_to_the_device_shares_the_bus() {
    with_bench(Echo::default(), |bench| {
        let mut client = bench.configured();
        let bytes = pattern_bytes(100_000);
        let out = client.submit_out(BULK_OUT, &bytes, 0);
        for _ in 0..16 {
            client.submit_in(BULK_IN, 128, 0);
        }
        let mut replies = Vec::new();
        let mut received = 0;
        bench.wait(|bench| {
            client.exchange();
            received += read_all(&mut client, &mut replies);
            client.write();
            (received + bench.end.dropped == bytes.len()).then_some(())
        });
        // Both directions have the same share, as far as the client asks in time.
        assert!(
            bench.end.dropped < bytes.len() / 10,
            "{}",
            bench.end.dropped
        );
        let sent: Vec<_> = replies
            .iter()
            .filter(|reply| reply.sequence == out)
            .collect();
        assert!(matches!(
            sent.as_slice(),
            [Reply {
                status: 0,
                actual: 100_000,
                ..
            }]
        ));
        let echo: Vec<u8> = replies
            .iter()
            .flat_map(|reply| reply.data.clone())
            .collect();
        if bench.end.dropped == 0 {
            assert!(echo == bytes, "a byte is wrong");
        }
    });
}
