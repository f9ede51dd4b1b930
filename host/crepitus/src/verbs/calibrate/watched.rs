//! Samples of a motion by hand, without torque.

use super::person::{Person, interrupted};
use crate::cli::Arming;
use crate::failure::Failure;
use crate::following::{Follower, follow};
use crate::interrupt;
use crate::keys::{Key, Keys};
use crate::line::{Line, failure};
use crate::status_line::StatusLine;
use crepitus_client::Client;
use crepitus_identify::brace::Sample;
use crepitus_protocol::telemetry::{Block, NO_CURRENT, SampleFlags};
use std::time::Duration;

/// More than anybody swings a weight: 10 minutes. Later samples replace nothing.
const MOST_SAMPLES: usize = 12_000_000;

struct Watch {
    samples: Vec<Sample>,
    is_awaited: bool,
    keys: Option<Keys>,
    status: StatusLine,
}

impl Follower for Watch {
    fn block(&mut self, _: &mut Client<Line>, block: &Block) -> Result<(), Failure> {
        if self.samples.len() < MOST_SAMPLES {
            self.samples
                .extend(block.ticks().map(|(tick, sample, _)| {
                    Sample {
                        tick,
                        count: sample.count,
                        current_a: (sample.current_ma != NO_CURRENT)
                            .then(|| f32::from(sample.current_ma) * 1e-3),
                        is_lost: sample.flags.has(SampleFlags::LOST),
                    }
                }));
        }
        self.status.block(block);
        Ok(())
    }

    fn pause(&mut self, client: &mut Client<Line>) -> Result<bool, Failure> {
        self.status.show(client.accounting());
        if !self.is_awaited {
            return Ok(false);
        }
        match self.keys.get_or_insert_with(Keys::listen).next() {
            Some(Key::Interrupt) => {
                interrupt::request();
                Ok(true)
            }
            Some(_) => Ok(true),
            None => Ok(false),
        }
    }
}

/// The samples until the person presses a key, or for the time of one that is not there.
pub(super) fn motion(client: &mut Client<Line>, person: &Person) -> Result<Vec<Sample>, Failure> {
    watched(client, person.time(), person.is_there())
}

/// The samples of this time.
pub(super) fn watched(
    client: &mut Client<Line>,
    time: Option<Duration>,
    is_awaited: bool,
) -> Result<Vec<Sample>, Failure> {
    // Those that wait are of the time before.
    client.subscribe().map_err(failure)?;
    let mut watch = Watch {
        samples: Vec::new(),
        is_awaited,
        keys: None,
        status: StatusLine::new(),
    };
    follow(client, time, Arming::default(), &mut watch)?;
    if interrupt::requested() {
        return Err(interrupted());
    }
    Ok(watch.samples)
}
