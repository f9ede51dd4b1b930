//! # Fuzz targets and their laws
//!
//! One file a fuzz target. Each has a `body` that turns any bytes into inputs
//! and panics when a law is broken; the law stands at the head of its file.
//! `cargo fuzz` searches with them on the nightly toolchain, and
//! `bounded.rs` replays the corpus and its near neighbours on stable.
//!
//! | target | input made of the bytes |
//! |---|---|
//! | [`step`] | settings, a solver, and steps of the shaft, raw or smooth |
//! | [`guarded`] | the same with samples that are lost or no numbers at all |
//! | [`renderer`] | samples, and changes of parameters under way |
//! | [`encoder`] | counts, and ticks without one |
//! | [`scene`] | the text of a scene file |
//! | [`recording`] | the text of a recording |
//! | [`frames`] | bytes on a wire |
//! | [`drive`] | messages and sensor values for the drive controller |
//! | [`comms`] | messages of hosts and of the drive for the comms controller |
//! | [`symptoms`] | samples, and changes of all symptoms under way |
//! | [`chain`] | requests of hosts, faults of the wires, restarts: host, comms, link, drive |

#![cfg_attr(test, allow(dead_code, unreachable_pub))]

mod block_frames;
#[cfg(test)]
mod bounded;
mod bytes;
pub mod chain;
pub mod comms;
pub mod drive;
mod drive_model;
pub mod encoder;
pub mod frames;
mod from_comms;
pub mod guarded;
mod host_oracle;
mod known_values;
mod laws;
mod lease_oracle;
mod link_inputs;
pub mod mutate;
pub mod recording;
pub mod renderer;
mod rung;
pub mod scene;
mod sent;
mod shaft;
pub mod step;
pub mod symptoms;
mod winding;

/// Turns bytes into inputs, and panics where a law is broken.
pub type Body = fn(&[u8]);

/// All targets: the name of each, which is also its folder in the corpus, and
/// its body.
pub const TARGETS: [(&str, Body); 11] = [
    ("chain", chain::body),
    ("comms", comms::body),
    ("drive", drive::body),
    ("encoder", encoder::body),
    ("frames", frames::body),
    ("guarded", guarded::body),
    ("recording", recording::body),
    ("renderer", renderer::body),
    ("scene", scene::body),
    ("step", step::body),
    ("symptoms", symptoms::body),
];
