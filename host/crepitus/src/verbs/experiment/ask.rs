//! Questions on a terminal, while the lease of an armed device is renewed.

use crate::failure::Failure;
use crate::following::{Follower, follow_as_it_is};
use crate::interrupt;
use crate::line::Line;
use crate::output::to_stderr;
use crepitus_client::Client;
use crepitus_protocol::telemetry::Block;
use std::io::stdin;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

/// Lines of standard input, read by a thread of their own.
pub(super) struct Lines(Receiver<String>);

impl Lines {
    pub(super) fn listen() -> Self {
        let (sender, receiver) = channel();
        // It ends with the program: nothing interrupts a read of standard input.
        thread::spawn(move || {
            let mut line = String::new();
            while stdin().read_line(&mut line).is_ok_and(|bytes| bytes > 0) {
                if sender.send(line.trim().to_owned()).is_err() {
                    return;
                }
                line.clear();
            }
        });
        Self(receiver)
    }

    /// Asks, and returns the line that follows; `None` if a stop is requested, `q` is given or there are no more.
    pub(super) fn ask(
        &self,
        client: &mut Client<Line>,
        question: &str,
    ) -> Result<Option<String>, Failure> {
        to_stderr(question);
        let mut answer = Answer {
            lines: &self.0,
            line: None,
        };
        follow_as_it_is(client, &mut answer)?;
        let is_left = |line: &String| line != "q" && !interrupt::requested();
        Ok(answer.line.filter(is_left))
    }
}

/// Waits for a line.
struct Answer<'a> {
    lines: &'a Receiver<String>,
    line: Option<String>,
}

impl Follower for Answer<'_> {
    fn block(&mut self, _: &mut Client<Line>, _: &Block) -> Result<(), Failure> {
        Ok(())
    }

    fn pause(&mut self, _: &mut Client<Line>) -> Result<bool, Failure> {
        match self.lines.try_recv() {
            Ok(line) => {
                self.line = Some(line);
                Ok(true)
            }
            Err(TryRecvError::Empty) => Ok(false),
            Err(TryRecvError::Disconnected) => Ok(true),
        }
    }
}
