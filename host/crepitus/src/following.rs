//! The loop of verbs that keep a connection open: telemetry blocks, state
//! changes, reconnection, and disarming at the end.
//!
//! Ctrl-C, SIGTERM, SIGHUP and a panic disarm first. A lost connection is opened again, but the device is
//! not armed again.

use crate::cli::Arming;
use crate::failure::Failure;
use crate::interrupt;
use crate::line::{Line, failure, failure_with};
use crate::output::to_stderr;
use crepitus_client::connection::device_text;
use crepitus_client::{Begin, Client, Error, Event};
use crepitus_protocol::State;
use crepitus_protocol::telemetry::Block;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::time::Duration;

/// Timeout of a poll for events; Ctrl-C is checked between polls.
const POLL_TIMEOUT: Duration = Duration::from_millis(20);

/// The longest that the drive takes to tell that it has disarmed.
const DISARM_TIMEOUT: Duration = Duration::from_millis(100);

/// Timeout of reconnection.
const RECONNECT_TIMEOUT: Duration = Duration::from_secs(10);

/// Reason for the end of the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// The duration has elapsed.
    Time,
    /// Ctrl-C, or the follower asked for it.
    Requested,
}

/// Work that a verb does with the device in the loop.
pub(crate) trait Follower {
    /// Handles a telemetry block; requests to `client` are allowed.
    fn block(&mut self, client: &mut Client<Line>, block: &Block) -> Result<(), Failure>;

    /// The connection was opened again, and the subscription goes on here.
    fn resumed(&mut self, _: Begin) -> Result<(), Failure> {
        Ok(())
    }

    /// Called every few milliseconds; returns whether to stop.
    fn pause(&mut self, client: &mut Client<Line>) -> Result<bool, Failure>;

    /// Tells the user that something has happened.
    fn tell(&mut self, text: &str) {
        to_stderr(text);
    }
}

/// Runs until the duration has elapsed or a stop is requested; disarms at the
/// end if it has armed, also after an error.
pub(crate) fn follow(
    client: &mut Client<Line>,
    time: Option<Duration>,
    arming: Arming,
    follower: &mut impl Follower,
) -> Result<End, Failure> {
    let Arming { arm, zero } = arming;
    interrupt::listen();
    if interrupt::requested() {
        return Ok(End::Requested);
    }
    if zero {
        client.zero().map_err(|error| failure_with(client, error))?;
    }
    if arm {
        client.arm().map_err(|error| failure_with(client, error))?;
    }
    let end = disarming(client, |client| run(client, time, arm, follower))?;
    if arm && client.is_connected() {
        refuse_fault(client)?;
    }
    Ok(end)
}

/// Runs until the follower asks for the end, with a device that is armed or not, and stays so: the caller disarms.
pub(crate) fn follow_as_it_is(
    client: &mut Client<Line>,
    follower: &mut impl Follower,
) -> Result<End, Failure> {
    let is_armed = client.is_armed();
    run(client, None, is_armed, follower)
}

/// A fault of the last moment before the end was not seen as a change of the state.
fn refuse_fault(client: &mut Client<Line>) -> Result<(), Failure> {
    let until = client.now() + DISARM_TIMEOUT;
    loop {
        let status = client.status().map_err(failure)?;
        let faults = device_text::faults(&status);
        if !faults.is_empty() {
            return Err(Failure::Work(faults.join("\n")));
        }
        // The drive's own word comes some milliseconds after the answer of the other controller.
        if status.state == State::Disarmed || client.now() >= until {
            return Ok(());
        }
    }
}

/// Does what may arm, and disarms behind it: also after an error or a panic.
pub(crate) fn disarming<T>(
    client: &mut Client<Line>,
    work: impl FnOnce(&mut Client<Line>) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let result = catch_unwind(AssertUnwindSafe(|| work(client)));
    let disarmed = if client.is_armed() {
        client.disarm().map_err(failure)
    } else {
        Ok(())
    };
    match result {
        Ok(result) => result.and_then(|done| disarmed.map(|()| done)),
        Err(panic) => resume_unwind(panic),
    }
}

fn run(
    client: &mut Client<Line>,
    time: Option<Duration>,
    arm: bool,
    follower: &mut impl Follower,
) -> Result<End, Failure> {
    let end = time.map(|time| client.now() + time);
    loop {
        if interrupt::requested() || follower.pause(client)? {
            return Ok(End::Requested);
        }
        if end.is_some_and(|end| client.now() >= end) {
            return Ok(End::Time);
        }
        // All pending events, then the pause again: at the latest after the same time, as a
        // program that falls behind always has one pending.
        let mut timeout = POLL_TIMEOUT;
        let pause_at = client.now() + POLL_TIMEOUT;
        while let Some(event) = client.pump(timeout).map_err(failure)? {
            timeout = Duration::ZERO;
            match event {
                Event::Block(arrival) => follower.block(client, &arrival.block)?,
                // What ends an armed device is reported below.
                Event::State(change) if !arm => {
                    // Of a device that this program has not armed.
                    for fault in device_text::faults(&change.now) {
                        follower.tell(&format!("warning: {fault}"));
                    }
                }
                Event::DriveRestarted => follower.tell("warning: the drive has restarted"),
                Event::Silent(silence) => follower.tell(&match client.transport_mut().hanging() {
                    Some(why) => {
                        format!("warning: no samples for {} ms: {why}", silence.as_millis())
                    }
                    None => format!(
                        "warning: no samples for {} ms, but the connection is open",
                        silence.as_millis()
                    ),
                }),
                Event::Lost(error) => {
                    follower.tell(&format!(
                        "warning: {error}; reconnecting for up to {} s",
                        RECONNECT_TIMEOUT.as_secs()
                    ));
                    if !reconnect(client, arm, follower)? {
                        return Ok(End::Requested);
                    }
                    break;
                }
                _ => {}
            }
            let now = client.now();
            if now >= pause_at || end.is_some_and(|end| now >= end) {
                break;
            }
        }
        if arm && client.is_connected() && !client.is_armed() {
            return Err(disarmed(client));
        }
    }
}

/// Failure that says why an armed device has disarmed by itself. The change of its state may have been
/// too quick to be seen as one.
fn disarmed(client: &mut Client<Line>) -> Failure {
    let status = match client.status() {
        Ok(status) => status,
        Err(error) => return failure(error),
    };
    let faults = device_text::faults(&status);
    Failure::Work(if faults.is_empty() {
        "another program has disarmed the device".to_owned()
    } else {
        faults.join("\n")
    })
}

/// Opens the connection again; false if a stop was requested first.
fn reconnect(
    client: &mut Client<Line>,
    arm: bool,
    follower: &mut impl Follower,
) -> Result<bool, Failure> {
    let until = client.now() + RECONNECT_TIMEOUT;
    let back = loop {
        match client.reconnect(POLL_TIMEOUT) {
            Ok(back) => break back,
            Err(_) if interrupt::requested() => return Ok(false),
            Err(error @ Error::Mismatch(_)) => return Err(failure(error)),
            Err(error) if client.now() >= until => return Err(failure(error)),
            Err(_) => {}
        }
    };
    follower.tell("reconnected");
    if let Some(resubscribed) = back.resubscribed {
        follower.resumed(resubscribed.begin)?;
    }
    if arm && back.was_armed {
        return Err(Failure::Work(
            "the connection was lost while the device was armed, so it has disarmed; it is not armed \
             again automatically: check the cable, then arm it again"
                .to_owned(),
        ));
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_client::Transport;
    use crepitus_client::connection::Simulated;
    use crepitus_scene::Overrides;
    use crepitus_scene::shipped;
    use std::path::Path;

    /// Panics once the device is armed.
    struct Panics;

    impl Follower for Panics {
        fn block(&mut self, _: &mut Client<Line>, _: &Block) -> Result<(), Failure> {
            Ok(())
        }

        fn pause(&mut self, client: &mut Client<Line>) -> Result<bool, Failure> {
            assert!(!client.is_armed(), "as a mistake in a verb would");
            Ok(false)
        }
    }

    fn client() -> Client<Line> {
        client_of("passive-examination")
    }

    fn client_of(scene: &str) -> Client<Line> {
        let scene = shipped::scene(Path::new(scene), &Overrides::default()).expect("a scene");
        let device = Simulated::of(&scene).expect("a device");
        Client::connect(Line::Simulated(Box::new(device))).expect("a connection")
    }

    /// Takes longer for a block than the device until the next one.
    #[derive(Default)]
    struct FallsBehind {
        blocks: u32,
        pauses: u32,
    }

    impl Follower for FallsBehind {
        fn block(&mut self, client: &mut Client<Line>, _: &Block) -> Result<(), Failure> {
            self.blocks += 1;
            client.transport_mut().wait(Duration::from_millis(3));
            Ok(())
        }

        fn pause(&mut self, _: &mut Client<Line>) -> Result<bool, Failure> {
            self.pauses += 1;
            Ok(self.pauses > 20)
        }
    }

    /// A signal is looked at where the follower pauses.
    #[test]
    fn a_program_that_falls_behind_still_pauses() {
        let mut client = client();
        client.subscribe().expect("a subscription");
        let mut behind = FallsBehind::default();
        let time = Some(Duration::from_secs(2));
        let end = follow(&mut client, time, Arming::default(), &mut behind);
        assert!(
            matches!(end, Ok(End::Requested)),
            "{} pauses",
            behind.pauses
        );
        assert!(behind.blocks > 100, "{} blocks", behind.blocks);
    }

    /// Does nothing.
    struct Waits;

    impl Follower for Waits {
        fn block(&mut self, _: &mut Client<Line>, _: &Block) -> Result<(), Failure> {
            Ok(())
        }

        fn pause(&mut self, _: &mut Client<Line>) -> Result<bool, Failure> {
            Ok(false)
        }
    }

    #[test]
    fn a_fault_just_before_the_end_is_told() {
        let armed = |time| {
            // The leg of this scene leaves the range of motion.
            let mut client = client_of("high-speed");
            let begun = client.now();
            let end = follow(&mut client, time, Arming::armed(true), &mut Waits);
            let took = client.now().saturating_sub(begun);
            client.transport_mut().wait(Duration::from_millis(20));
            let faults = device_text::faults(&client.status().expect("the status"));
            (end, took, faults)
        };
        let (end, seen, _) = armed(None);
        assert!(matches!(end, Err(Failure::Work(_))), "{end:?}");
        let mut told = 0;
        for ms in 0..40 {
            let time = seen.saturating_sub(Duration::from_millis(5 * ms));
            let (end, _, faults) = armed(Some(time));
            assert_eq!(
                end.is_err(),
                !faults.is_empty(),
                "{ms}: {end:?}, {faults:?}"
            );
            told += u32::from(end.is_err());
        }
        assert!((1..40).contains(&told), "{told}");
    }

    #[test]
    fn a_panic_disarms_first() {
        let mut client = client();
        let panicked = catch_unwind(AssertUnwindSafe(|| {
            follow(&mut client, None, Arming::armed(true), &mut Panics)
        }));
        assert!(panicked.is_err());
        // The drive's own word takes some milliseconds.
        client.transport_mut().wait(Duration::from_millis(20));
        let counters = client.counters().expect("the counters");
        let status = client.status().expect("the status");
        assert_eq!((status.state, status.drive_fault), (State::Disarmed, 0));
        let armings = crepitus_protocol::counters::DriveCounter::Armings;
        assert_eq!(counters.drive[armings.index()], 1);
    }
}
