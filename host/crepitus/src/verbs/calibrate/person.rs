//! The person at the brace: gets instructions, and says when each is done.

use super::step::Step;
use crate::failure::Failure;
use crate::interrupt;
use crate::keys::{Key, Keys};
use crate::line::{Line, failure};
use crate::output::to_stderr;
use crepitus_client::{Client, Event};
use std::io::{IsTerminal, stdin};
use std::time::Duration;

/// Time between two looks at the keys.
const POLL: Duration = Duration::from_millis(20);

/// Answer of the person.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// Take the step.
    Go,
    /// Leave it out.
    Skip,
}

/// Somebody at a terminal, or nobody.
#[derive(Clone, Copy, Debug)]
pub(super) struct Person {
    is_there: bool,
    for_s: Duration,
}

impl Person {
    /// `for_s`: how long motions are looked at if nobody is there.
    pub(super) fn new(yes: bool, for_s: Duration) -> Result<Self, Failure> {
        if !yes && !stdin().is_terminal() {
            return Err(Failure::input(
                "calibrate asks for each step on a terminal, and there is none: expected --yes, which takes each step at once",
            ));
        }
        Ok(Self {
            is_there: !yes,
            for_s,
        })
    }

    /// Returns whether motions end by a key.
    pub(super) fn is_there(&self) -> bool {
        self.is_there
    }

    /// Time for which a motion is looked at; `None` if somebody is there: then until a key is pressed.
    pub(super) fn time(&self) -> Option<Duration> {
        (!self.is_there).then_some(self.for_s)
    }

    /// Says what to do, and waits until it is done.
    pub(super) fn ask(&self, client: &mut Client<Line>, step: Step) -> Result<Answer, Failure> {
        to_stderr(&format!("\n{}: {}", step.name(), step.instruction()));
        if !self.is_there {
            return Ok(Answer::Go);
        }
        let end = if step.ends_by_hand() {
            "begins, Enter again ends it"
        } else {
            "goes on"
        };
        to_stderr(&format!(
            "Enter {end}, s skips the step, Ctrl-C ends the program"
        ));
        let keys = Keys::listen();
        loop {
            if interrupt::requested() {
                return Err(interrupted());
            }
            match keys.next() {
                Some(Key::Enter) => return Ok(Answer::Go),
                Some(Key::Character('s')) => return Ok(Answer::Skip),
                Some(Key::Interrupt) => return Err(interrupted()),
                Some(Key::Character(_) | Key::Other) | None => {}
            }
            // Samples of this time are of no use.
            if let Some(Event::Lost(error)) = client.pump(POLL).map_err(failure)? {
                return Err(Failure::Work(error.to_string()));
            }
        }
    }
}

/// Ctrl-C.
pub(super) fn interrupted() -> Failure {
    Failure::Work("interrupted: torque is off, nothing was written or applied".to_owned())
}
