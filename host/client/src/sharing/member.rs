//! A connected program, as the hub knows it.

use crate::sharing::left_open::LeftOpen;
use crate::sharing::note::Program;
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, TrySendError};

/// Bytes for a program, in whole frames.
pub(crate) type Chunk = Arc<[u8]>;

/// A connected program.
#[derive(Debug)]
pub(crate) struct Member {
    program: Program,
    outbox: SyncSender<Chunk>,
    pub(crate) open: LeftOpen,
}

impl Member {
    pub(crate) fn new(outbox: SyncSender<Chunk>) -> Self {
        Self {
            program: Program::default(),
            outbox,
            open: LeftOpen::default(),
        }
    }

    /// Takes the program's introduction.
    pub(crate) fn introduce(&mut self, program: Program) {
        self.program = program;
    }

    /// Passes it bytes from the device. Those that it does not read in time are
    /// dropped, a chunk of whole frames at a time; its accounting shows them as
    /// lost on the connection.
    pub(crate) fn pass(&self, chunk: &Chunk) {
        match self.outbox.try_send(chunk.clone()) {
            // The reader notices that a program has gone.
            Ok(()) | Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {}
        }
    }

    /// Returns whether it is this program.
    pub(crate) fn is_this(&self) -> bool {
        self.program.pid == std::process::id()
    }

    /// The program, as of now.
    pub(crate) fn program(&self) -> Program {
        Program {
            session: self.open.session(),
            is_armed: self.open.renews(),
            ..self.program.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::sync_channel;

    #[test]
    fn what_a_program_does_not_read_is_dropped() {
        let (outbox, inbox) = sync_channel(2);
        let member = Member::new(outbox);
        let chunk = Chunk::from([1, 0].as_slice());
        for _ in 0..5 {
            member.pass(&chunk);
        }
        assert_eq!(inbox.try_iter().count(), 2);
        drop(inbox);
        member.pass(&chunk);
    }
}
