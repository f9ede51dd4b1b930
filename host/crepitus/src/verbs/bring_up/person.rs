//! The builder: somebody at a terminal, nobody, or one who is simulated.

use super::bench::Builder;
use super::rows::{Check, Row, plain};
use crate::failure::Failure;
use crate::interrupt;
use crate::keys::{Key, Keys};
use crate::line::Line;
use crate::output::to_stderr;
use crepitus_client::Client;
use std::io::{IsTerminal, stdin};
use std::time::Duration;

/// Time between two looks at the keys.
const POLL: Duration = Duration::from_millis(20);

/// Answer of a person.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// Go on; what was seen is as expected.
    Yes,
    /// Something else was seen than is expected.
    No,
    /// Leave the row out.
    Skip,
}

/// The builder.
pub(super) enum Person {
    /// At a terminal.
    There,
    /// Nobody answers; whoever is at the device does what is printed at once.
    Silent,
    /// At a simulated board.
    Simulated(Builder),
}

impl Person {
    /// Somebody at the terminal, unless `yes`.
    pub(super) fn new(yes: bool, builder: Option<Builder>) -> Result<Self, Failure> {
        if let Some(builder) = builder {
            return Ok(Self::Simulated(builder));
        }
        if yes {
            return Ok(Self::Silent);
        }
        if !stdin().is_terminal() {
            return Err(Failure::input(
                "bring-up asks for each row on a terminal, and there is none: expected --yes, which takes each row at once",
            ));
        }
        Ok(Self::There)
    }

    /// Says what to do in a row, and waits until it is prepared. A row that nothing measures is judged at once.
    pub(super) fn ask(
        &self,
        mut client: Option<&mut Client<Line>>,
        row: &Row,
    ) -> Result<Answer, Failure> {
        to_stderr(&format!(
            "\n{} {}: {}",
            row.number,
            row.name,
            plain(row.does)
        ));
        if !row.sees.is_empty() {
            to_stderr(&format!("expect: {}", plain(row.sees)));
        }
        match self {
            Self::There => {}
            Self::Silent => return Ok(Answer::Yes),
            Self::Simulated(builder) => {
                builder.begin(row.check);
                return Ok(Answer::Yes);
            }
        }
        to_stderr(match row.check {
            Check::ByHand => {
                "Enter if it is so, n if not, s skips the row, Ctrl-C ends the program"
            }
            check if check.needs_hands() => {
                "Enter when you are ready: what to do then is printed. s skips the row, Ctrl-C ends the program"
            }
            _ => {
                "Enter when it is prepared: the program measures. s skips the row, Ctrl-C ends the program"
            }
        });
        let keys = Keys::listen();
        loop {
            if interrupt::requested() {
                return Err(interrupted());
            }
            match keys.next() {
                Some(Key::Enter) => return Ok(Answer::Yes),
                Some(Key::Character('s')) => return Ok(Answer::Skip),
                Some(Key::Character('n')) if row.check == Check::ByHand => return Ok(Answer::No),
                Some(Key::Interrupt) => return Err(interrupted()),
                Some(Key::Character(_) | Key::Other) | None => {}
            }
            // Some rows cut the device's power or cable: it is connected again for the next that needs it.
            match client.as_deref_mut().filter(|client| client.is_connected()) {
                Some(client) => drop(client.pump(POLL)),
                None => std::thread::sleep(POLL),
            }
        }
    }

    /// Says that it is time to act.
    pub(super) fn act(&self, what: &str) {
        to_stderr(&format!("now: {what}"));
        if let Self::Simulated(builder) = self {
            builder.act();
        }
    }

    /// The row is over.
    pub(super) fn end(&self) {
        if let Self::Simulated(builder) = self {
            builder.end();
        }
    }

    /// Returns whether somebody can judge what nothing measures.
    pub(super) fn sees(&self) -> bool {
        matches!(self, Self::There)
    }
}

/// Ctrl-C.
pub(super) fn interrupted() -> Failure {
    Failure::Work("interrupted: torque is off".to_owned())
}
