//! `reference` in a child process with a time limit.
//!
//! A solver that loops for ever is a disagreement like any other, but a thread
//! cannot be ended. So a child runs one case after another and reports each;
//! if a report times out, or the child dies, that is the case's result, and
//! another child continues with the next.

use crate::corpus::Case;
use crate::theirs::Theirs;
use crate::wire;
use std::io::{self, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

/// Default timeout of a case. Cases take milliseconds; on a busy machine they may take a
/// thousand times that.
pub const LIMIT: Duration = Duration::from_secs(10);

/// The test that is the child, and the variable with the cases that it is to write.
pub const CHILD: &str = "watched::what_the_reference_says";
const CASES: &str = "CREPITUS_REFERENCE_CASES";

/// Result of a case.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// The case was solved.
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
    /// Cases `from..to`, by the program `program`, whose test [`CHILD`]
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
            .args(["--exact", CHILD, "--nocapture"])
            .env(CASES, format!("{} {}", self.next, self.end))
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
            // The child may have ended by itself; either way it is reaped.
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

/// The child: alone it has no cases, and writes none.
#[test]
fn what_the_reference_says() {
    let cases = std::env::var(CASES).unwrap_or_else(|_| "0 0".to_owned());
    let (from, to) = cases.split_once(' ').expect("two numbers");
    let [from, to] = [from, to].map(|number| number.parse::<u64>().expect("a number"));
    if to > from {
        // The parent holds our input open. When it has ended, a case that never
        // ends must end, too.
        std::thread::spawn(|| {
            let _ = io::copy(&mut io::stdin(), &mut io::sink());
            std::process::exit(1);
        });
    }
    let mut out = io::stdout().lock();
    // The test's name may stand before it.
    writeln!(out).expect("the parent reads");
    for number in from..to {
        wire::write(&mut out, number, &Theirs::of(&Case::new(number))).expect("the parent reads");
    }
}
