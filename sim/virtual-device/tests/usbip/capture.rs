//! A session as Wireshark sees it: another program that knows the protocol and what is inside.

use crate::bench::{BULK_IN, BULK_OUT, NOTIFICATIONS, with_bench};
use crate::client::{Chunk, setup};
use crate::rig::Echo;
use std::env;
use std::fs;
use std::process::Command;

/// Returns whether tshark is there; if not, a line about it.
///
/// # Panics
/// If it is not although `CREPITUS_NEEDS_TSHARK` is set.
fn is_there() -> bool {
    let version = Command::new("tshark").arg("--version").output();
    let is_there = version.is_ok_and(|output| output.status.success());
    if !is_there {
        assert!(
            env::var_os("CREPITUS_NEEDS_TSHARK").is_none(),
            "tshark is not installed"
        );
        println!("left out: tshark is not installed");
    }
    is_there
}

/// A capture file (pcap) of these bytes, between two ports of 127.0.0.1.
fn pcap(chunks: &[Chunk]) -> Vec<u8> {
    const LINK_TYPE_RAW_IP: u32 = 101;
    const SERVER: u16 = 3240;
    const CLIENT: u16 = 40_000;
    let mut file = Vec::new();
    for word in [0xa1b2_c3d4, 0x0002_0004_u32.rotate_left(16), 0, 0, 262_144] {
        file.extend(word.to_le_bytes());
    }
    file.extend(LINK_TYPE_RAW_IP.to_le_bytes());
    // What each end has sent: server, client.
    let mut sent = [1_000_u32, 2_000];
    let segments = chunks.iter().flat_map(|chunk| {
        let segments = chunk.bytes.chunks(1_400);
        segments.map(|bytes| (usize::from(chunk.is_to_server), bytes))
    });
    for (number, (from, bytes)) in segments.enumerate() {
        let ports = if from == 1 {
            [CLIENT, SERVER]
        } else {
            [SERVER, CLIENT]
        };
        let length = u16::try_from(40 + bytes.len()).expect("it fits");
        let mut packet = vec![0x45, 0];
        packet.extend(length.to_be_bytes());
        packet.extend([0, 0, 0, 0, 64, 6, 0, 0, 127, 0, 0, 1, 127, 0, 0, 1]);
        packet.extend(ports.into_iter().flat_map(u16::to_be_bytes));
        packet.extend(sent[from].to_be_bytes());
        packet.extend(sent[1 - from].to_be_bytes());
        // Five words of header; PSH and ACK; a window.
        packet.extend([0x50, 0x18, 0xff, 0xff, 0, 0, 0, 0]);
        packet.extend(bytes);
        sent[from] += u32::try_from(bytes.len()).expect("it fits");
        let time = u32::try_from(number).expect("few");
        let size = u32::from(length);
        for word in [time / 1_000, time % 1_000 * 1_000, size, size] {
            file.extend(word.to_le_bytes());
        }
        file.extend(packet);
    }
    file
}

/// Output of tshark for a session.
fn dissect(chunks: &[Chunk], arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("session.pcap");
    fs::write(&file, pcap(chunks)).expect("it can be written");
    let output = Command::new("tshark")
        .arg("-r")
        .arg(&file)
        .args(["-d", "tcp.port==3240,usbip"])
        .args(arguments)
        .output()
        .expect("tshark runs");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    String::from_utf8(output.stdout).expect("text")
}

/// A list, and a session of all kinds of transfers.
fn session() -> [Vec<Chunk>; 2] {
    let mut sessions = [Vec::new(), Vec::new()];
    with_bench(Echo::default(), |bench| {
        let mut client = bench.connect();
        client.request_list();
        bench.until(&mut client, crate::client::Client::list);
        sessions[0] = client.chunks;
        let (mut client, _) = bench.import();
        for (request, data) in [
            (setup(0x80, 6, 0x0100, 0, 18), &[][..]),
            (setup(0x80, 6, 0x0200, 0, 9), &[]),
            (setup(0x80, 6, 0x0200, 0, 67), &[]),
            (setup(0x80, 6, 0x0300, 0, 255), &[]),
            (setup(0x80, 6, 0x0302, 0x0409, 255), &[]),
            (setup(0x00, 9, 1, 0, 0), &[]),
            (setup(0x21, 0x20, 0, 0, 7), &[0x80, 0x25, 0, 0, 0, 0, 8]),
            (setup(0x21, 0x22, 3, 0, 0), &[]),
        ] {
            assert_eq!(bench.control(&mut client, request, data).status, 0);
        }
        // A device of USB 2.0 has no BOS descriptor: a stall.
        let bos = bench.control(&mut client, setup(0x80, 6, 0x0f00, 0, 5), &[]);
        assert_eq!(bos.status, -32);
        let pending = client.submit_in(NOTIFICATIONS, 8, 0);
        // One reply at a time: of several in a segment, tshark 4.0 takes the length of the first for all.
        client.submit_out(BULK_OUT, b"hello", 0);
        bench.reply(&mut client);
        client.submit_in(BULK_IN, 128, 0);
        bench.reply(&mut client);
        client.unlink(pending);
        bench.reply(&mut client);
        sessions[1] = client.chunks;
    });
    sessions
}

#[test]
fn wireshark_reads_a_session_with_its_descriptors() {
    if !is_there() {
        return;
    }
    let [list, import] = session();
    let text = dissect(&list, &["-V"]);
    assert!(!text.contains("Malformed"), "{text}");
    for expected in ["OP_REP_DEVLIST", "1-1", "0x16c0", "0x27dd", "Full Speed"] {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    let text = dissect(&import, &["-V"]);
    assert!(!text.contains("Malformed"), "{text}");
    assert!(!text.contains("Unreassembled"), "{text}");
    for expected in [
        "DEVICE DESCRIPTOR",
        "(0x16c0)",
        "CONFIGURATION DESCRIPTOR",
        "ENDPOINT DESCRIPTOR",
        "bEndpointAddress: 0x81  IN  Endpoint:1",
        "bEndpointAddress: 0x82  IN  Endpoint:2",
        "bEndpointAddress: 0x01  OUT  Endpoint:1",
        "wMaxPacketSize: 64",
        "bInterfaceClass: Communications and CDC Control (0x02)",
        "bString: Crepitus",
        "SET CONFIGURATION",
        "SET LINE CODING",
        "OP_RET_UNLINK",
    ] {
        assert!(text.contains(expected), "{expected}: {text}");
    }
}
