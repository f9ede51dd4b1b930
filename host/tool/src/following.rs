//! A device that is followed for some time: its blocks, its state, and an end
//! in order, whatever ends it.
//!
//! Ctrl-C disarms first. A line that was lost is opened again; what was armed
//! is not armed again.

use crate::failure::Failure;
use crate::interrupt;
use crate::line::{Line, failure};
use crate::told;
use crepitus_client::{Client, Event, StateChange};
use crepitus_protocol::State;
use crepitus_protocol::telemetry::Block;
use std::time::Duration;

/// How long an event is waited for before Ctrl-C is looked at again.
const PATIENCE: Duration = Duration::from_millis(20);

/// How long a lost line is tried.
const RECONNECT: Duration = Duration::from_secs(10);

/// Why it has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// The time is over.
    Time,
    /// Ctrl-C, or whoever wanted it.
    Asked,
}

/// What is to be done meanwhile.
pub(crate) trait Follower {
    /// A block has come; `client` may be asked things.
    fn block(&mut self, client: &mut Client<Line>, block: &Block) -> Result<(), Failure>;

    /// Some milliseconds have gone by: whether it is enough.
    fn pause(&mut self, client: &mut Client<Line>) -> Result<bool, Failure>;
}

/// Follows a device until the time is over, or an end is asked for; then
/// disarms what this has armed, whatever has happened.
pub(crate) fn follow(
    client: &mut Client<Line>,
    time: Option<Duration>,
    arm: bool,
    follower: &mut impl Follower,
) -> Result<End, Failure> {
    interrupt::listen();
    if arm {
        client.arm().map_err(failure)?;
    }
    let result = go(client, time, arm, follower);
    if client.is_armed() {
        let disarmed = client.disarm().map_err(failure);
        return result.and_then(|end| disarmed.map(|()| end));
    }
    result
}

fn go(
    client: &mut Client<Line>,
    time: Option<Duration>,
    arm: bool,
    follower: &mut impl Follower,
) -> Result<End, Failure> {
    let end = time.map(|time| client.now() + time);
    loop {
        if interrupt::asked() || follower.pause(client)? {
            return Ok(End::Asked);
        }
        if end.is_some_and(|end| client.now() >= end) {
            return Ok(End::Time);
        }
        // All that has come, then the pause again.
        let mut patience = PATIENCE;
        while let Some(event) = client.pump(patience).map_err(failure)? {
            patience = Duration::ZERO;
            match event {
                Event::Block(arrival) => follower.block(client, &arrival.block)?,
                Event::State(change) => told_of(&change, arm)?,
                Event::DriveRestarted => eprintln!("warning: the drive has started anew"),
                Event::Silent(silence) => eprintln!(
                    "warning: no samples for {} ms, though the line is open",
                    silence.as_millis()
                ),
                Event::Lost(error) => {
                    eprintln!(
                        "warning: {error}; trying again for {} s",
                        RECONNECT.as_secs()
                    );
                    reconnect(client, arm)?;
                    break;
                }
                _ => {}
            }
            if end.is_some_and(|end| client.now() >= end) {
                break;
            }
        }
    }
}

fn reconnect(client: &mut Client<Line>, arm: bool) -> Result<(), Failure> {
    let back = client.reconnect(RECONNECT).map_err(failure)?;
    eprintln!("the line is open again");
    if arm && back.was_armed {
        return Err(Failure::Work(
            "the device was armed as the line was lost, and has let go: it is not armed again by \
             itself"
                .to_owned(),
        ));
    }
    Ok(())
}

/// A device that was armed and is no more has a reason.
fn told_of(change: &StateChange, arm: bool) -> Result<(), Failure> {
    let faults = told::faults(&change.now);
    if !arm || change.now.state == State::Armed || change.before.state != State::Armed {
        for fault in faults {
            eprintln!("warning: {fault}");
        }
        return Ok(());
    }
    Err(Failure::Work(if faults.is_empty() {
        "the device was disarmed by somebody else".to_owned()
    } else {
        faults.join("\n")
    }))
}
