//! `reference` in a child process with a time limit.
//!
//! A solver that loops for ever is a disagreement like any other, but a thread
//! cannot be ended. So a child runs one case after another and reports each;
//! if a report times out, or the child dies, that is the case's result, and
//! another child continues with the next.

use crate::theirs::Theirs;
use crate::wire;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

/// Default timeout of a case. Cases take milliseconds; on a busy machine they may take a
/// thousand times that.
pub const LIMIT: Duration = Duration::from_secs(10);

/// Result of a case.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// It was solved.
    Solved(Theirs),
    /// No answer in time.
    Hung,
    /// The process ended without an answer.
    Died,
}

/// The answers to a range of cases, in order.
pub struct Watched {
    program: PathBuf,
    limit: Duration,
    next: u64,
    end: u64,
    child: Option<(Child, Receiver<(u64, Theirs)>)>,
}

impl Watched {
    /// Cases `from..to`, by the program `program`, whose verb `reference`
    /// writes them; each within `limit`.
    pub fn new(program: &Path, limit: Duration, from: u64, to: u64) -> Self {
        Self {
            program: program.to_owned(),
            limit,
            next: from,
            end: to,
            child: None,
        }
    }

    fn start(&self) -> io::Result<(Child, Receiver<(u64, Theirs)>)> {
        let mut child = Command::new(&self.program)
            .arg("reference")
            .args(["--from", &self.next.to_string()])
            .args(["--to", &self.end.to_string()])
            // Held open: a child ends when its parent has ended.
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        let (sender, receiver) = sync_channel(4);
        if let Some(out) = child.stdout.take() {
            std::thread::spawn(move || {
                let mut lines = BufReader::new(out);
                while let Some(answer) = wire::read(&mut lines) {
                    if sender.send(answer).is_err() {
                        break;
                    }
                }
            });
        }
        Ok((child, receiver))
    }

    fn stop(&mut self) {
        if let Some((mut child, receiver)) = self.child.take() {
            drop(receiver);
            // It may have ended by itself; either way it is reaped.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

impl Iterator for Watched {
    type Item = io::Result<(u64, Answer)>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.next >= self.end {
            return None;
        }
        if self.child.is_none() {
            match self.start() {
                Ok(child) => self.child = Some(child),
                Err(error) => {
                    self.next = self.end;
                    return Some(Err(error));
                }
            }
        }
        let (_, receiver) = self.child.as_ref()?;
        let case = self.next;
        self.next += 1;
        let answer = match receiver.recv_timeout(self.limit) {
            Ok((number, theirs)) if number == case => Answer::Solved(theirs),
            Ok(_) | Err(RecvTimeoutError::Disconnected) => {
                self.stop();
                Answer::Died
            }
            Err(RecvTimeoutError::Timeout) => {
                self.stop();
                Answer::Hung
            }
        };
        Some(Ok((case, answer)))
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        self.stop();
    }
}
