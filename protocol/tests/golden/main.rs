//! The bytes of every message, as `protocol/golden/vectors.txt` has them, and
//! the pages of the book that are made of the same tables.
//!
//! Where they are meant to change, `CREPITUS_BLESS=1` rewrites them:
//!
//! ```sh
//! CREPITUS_BLESS=1 cargo test -p crepitus-protocol --test golden
//! ```

mod book;
mod examples;
mod faults;
mod hex;
mod management;
mod messages;
mod pages;
mod source;
mod vectors;
mod walk;

use crepitus_protocol::Decoder;
use crepitus_protocol::host::{Reply, Request};
use crepitus_protocol::link::{FromDrive, ToDrive};
use crepitus_protocol::task_times::DeviceTimes;
use crepitus_protocol::telemetry::Block;
use examples::Example;
use postcard_schema::Schema;
use postcard_schema::schema::NamedType;
use std::collections::BTreeSet;

/// The postcard messages of both wires.
const ROOTS: [&NamedType; 6] = [
    Request::SCHEMA,
    Reply::SCHEMA,
    Block::SCHEMA,
    ToDrive::SCHEMA,
    FromDrive::SCHEMA,
    DeviceTimes::SCHEMA,
];

/// Returns whether files are to be rewritten.
fn is_blessed() -> bool {
    std::env::var_os("CREPITUS_BLESS").is_some_and(|value| value != "0")
}

/// The rules of the page read every message, and together the examples choose
/// everything that can be chosen.
#[test]
fn every_variant_has_an_example() {
    let mut chosen = BTreeSet::new();
    for example in examples::all() {
        if let Some(schema) = example.schema {
            chosen.extend(walk::read(schema, example.message()).choices);
        }
    }
    let can_be: BTreeSet<_> = ROOTS.into_iter().flat_map(walk::choices).collect();
    let missing: Vec<_> = can_be.difference(&chosen).collect();
    assert!(
        missing.is_empty(),
        "\nThese have no example in protocol/tests/golden/examples.rs: {missing:#?}\n\
         Add one to each, then {}\n",
        vectors::BLESS
    );
}

/// All frames in one stream, behind the end of something else.
#[test]
fn a_stream_of_every_frame_is_received() {
    let examples = examples::all();
    let mut decoder = Decoder::new();
    let mut received = Vec::new();
    let stream = examples.iter().flat_map(|example| &example.frame);
    for byte in b"of another life\0".iter().chain(stream) {
        if let Some(Ok(body)) = decoder.push(*byte) {
            received.push(body.payload.to_vec());
            assert!(body.lane().is_some());
        }
    }
    assert_eq!(decoder.discarded().total(), 1);
    assert!(received.iter().eq(examples.iter().map(Example::message)));
}
