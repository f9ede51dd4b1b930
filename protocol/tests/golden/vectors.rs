//! The file of golden bytes: written, read, compared.

use crate::examples::{self, Example};
use crate::hex::{bytes, hex};
use crate::is_blessed;
use crepitus_protocol::schema;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

/// Command that rewrites the files.
pub(crate) const BLESS: &str = "CREPITUS_BLESS=1 cargo test -p crepitus-protocol --test golden";

const HEAD: &str = "\
# The bytes of every message on both wires: an example of each, by name.
#
#   means   what it says
#   body    lane, tag, message
#   frame   COBS(body, CRC-32), 00: what goes over the wire
#
# cargo test -p crepitus-protocol --test golden compares it with the code, and
# says what to do if the code was meant to change. docs/protocol.md explains it.
";

/// Bytes in a line.
const LINE: usize = 32;

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden/vectors.txt")
}

fn lines(text: &mut String, key: &str, bytes: &[u8]) {
    for (i, line) in bytes.chunks(LINE).enumerate() {
        let key = if i == 0 { key } else { "" };
        let _ = writeln!(text, "{key:<7} {}", hex(line));
    }
}

fn write(examples: &[Example]) -> String {
    let mut text = HEAD.to_owned();
    let _ = writeln!(text, "\nschema  {:016x}", schema::HASH);
    for example in examples {
        let _ = writeln!(text, "\n[{}]\nmeans   {}", example.name, example.means);
        lines(&mut text, "body", &example.body);
        lines(&mut text, "frame", &example.frame);
    }
    text
}

/// Content of a file.
#[derive(Default)]
struct File {
    schema: String,
    /// Body and frame of each name.
    vectors: BTreeMap<String, [Vec<u8>; 2]>,
}

fn read(text: &str) -> File {
    let mut file = File::default();
    let (mut name, mut part) = (String::new(), 0);
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        if let Some(header) = line.strip_prefix('[') {
            header.trim_end_matches(']').clone_into(&mut name);
            file.vectors.entry(name.clone()).or_default();
            continue;
        }
        let (key, rest) = line.split_at_checked(8).unwrap_or((line, ""));
        match key.trim() {
            "schema" => rest.clone_into(&mut file.schema),
            "body" => part = 0,
            "frame" => part = 1,
            "means" => continue,
            _ => {}
        }
        if let Some(vector) = file.vectors.get_mut(&name) {
            vector[part].extend(bytes(rest));
        }
    }
    file
}

/// Differences of the wire from the file, a line each; and whether a message
/// that the file knows is encoded otherwise.
fn differences(file: &File, examples: &[Example]) -> (Vec<String>, bool) {
    let (mut found, mut is_other) = (Vec::new(), false);
    for example in examples {
        let name = &example.name;
        match file.vectors.get(name) {
            None => found.push(format!("{name}: new")),
            Some([body, _]) if body.get(2..) != Some(example.message()) => {
                is_other = true;
                found.push(format!(
                    "{name}: the message\n    was {}\n    is  {}",
                    hex(body.get(2..).unwrap_or_default()),
                    hex(example.message())
                ));
            }
            Some([body, _]) if body != &example.body => {
                found.push(format!("{name}: lane and tag"));
            }
            Some([_, frame]) if frame != &example.frame => {
                is_other = true;
                found.push(format!("{name}: checksum or framing"));
            }
            Some(_) => {}
        }
    }
    for name in file.vectors.keys() {
        if examples.iter().all(|example| example.name != *name) {
            found.push(format!("{name}: gone"));
        }
    }
    (found, is_other)
}

/// Instructions after a change.
fn advice(was: &str) -> String {
    format!(
        "\nThis is a change of the wire: programs from before it and after it do not understand each\n\
         other. If it was not meant, undo it. If it was:\n\
         1. The schema hash, and with it the tag of every frame, has to change: it was {was} and is\n\
            {:016x}. It changes by itself with the names and shapes of messages, parameters, faults\n\
            and counters. It does not see how a field is encoded, what a bit means, or a type's name:\n\
            with such a change, rename the field.\n\
         2. Write file and book anew, look at the difference, and commit both:\n\
            {BLESS}\n\
         3. Drive, comms and host are updated together: another hash is refused, and only the\n\
            management lane (hello, stop, reboot) still works between old and new. Say so in\n\
            CHANGELOG.md.\n",
        schema::HASH
    )
}

#[test]
fn every_message_is_the_bytes_that_it_was() {
    let examples = examples::all();
    let text = fs::read_to_string(path()).unwrap_or_default();
    let file = read(&text);
    let (found, is_other) = differences(&file, &examples);
    let has_same_hash = file.schema == format!("{:016x}", schema::HASH);
    assert!(
        !(is_other && has_same_hash),
        "\n{}\n\nThe schema hash is still the same, so both sides would take the new bytes for the old\n\
         ones. This cannot be blessed.{}",
        found.join("\n"),
        advice(&file.schema)
    );
    if is_blessed() {
        fs::create_dir_all(path().parent().expect("a folder")).expect("the folder");
        fs::write(path(), write(&examples)).expect("the file is written");
        return;
    }
    assert!(
        found.is_empty() && has_same_hash,
        "\n{}\n{}",
        found.join("\n"),
        advice(&file.schema)
    );
    assert!(
        text == write(&examples),
        "protocol/golden/vectors.txt has the right bytes in other words:\n{BLESS}"
    );
}

#[test]
fn the_file_reads_as_it_was_written() {
    let examples = examples::all();
    let file = read(&write(&examples));
    assert_eq!(file.vectors.len(), examples.len(), "a name stands twice");
    assert_eq!(differences(&file, &examples), (Vec::new(), false));
}
