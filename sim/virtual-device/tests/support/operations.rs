//! Operations of a host by name, each with the answer that is due.

use super::{Accounting, Host, set};
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::host::{Answer, Operation, Refusal, Status};
use crepitus_protocol::link::DriveRefusal;
use crepitus_protocol::{Decoder, Revision, Session, Values};

impl Host {
    pub(crate) fn status(&mut self) -> Status {
        match self.ask(Operation::Status) {
            Ok(Answer::Status(status)) => status,
            other => panic!("no status but {other:?}"),
        }
    }

    pub(crate) fn parameters(&mut self) -> (Revision, Values) {
        match self.ask(Operation::Parameters) {
            Ok(Answer::Parameters { revision, values }) => (revision, values),
            other => panic!("no parameters but {other:?}"),
        }
    }

    pub(crate) fn commit(&mut self, change: impl FnOnce(&mut Values)) -> Result<Revision, Refusal> {
        let (base, mut values) = self.parameters();
        change(&mut values);
        self.ask(Operation::Commit { base, values })
            .map(|answer| match answer {
                Answer::Committed { revision } => revision,
                other => panic!("no commit but {other:?}"),
            })
    }

    pub(crate) fn subscribe(&mut self) {
        // Blocks that were on their way are in no accounting.
        self.accounting = None;
        match self.ask(Operation::Subscribe) {
            Ok(Answer::Subscribed {
                first_tick,
                dropped,
                start,
            }) => {
                self.accounting = Some(Accounting {
                    first_tick,
                    end_tick: first_tick,
                    dropped_before: dropped,
                    start: Some(start),
                    ..Accounting::default()
                });
            }
            other => panic!("no subscription but {other:?}"),
        }
    }

    /// Plugs the device in again, as soon as it can be, and begins again as
    /// another host.
    pub(crate) fn reconnect(&mut self) {
        let found = (0..400).any(|_| {
            self.run(20);
            self.device.board().comms_runs() && self.device.plug_in().is_ok()
        });
        assert!(found, "the device can be found again");
        self.decoder = Decoder::new();
        self.replies.clear();
        self.answers.clear();
        (self.accounting, self.last_block) = (None, None);
        self.session = Session(self.session.0.wrapping_add(1));
        self.number = 0;
    }

    /// Asks until nothing else is being done for a host any more.
    pub(crate) fn ask_patiently(&mut self, operation: Operation) -> Result<Answer, Refusal> {
        for _ in 0..20 {
            let answer = self.ask(operation);
            if answer != Err(Refusal::Busy) {
                return answer;
            }
            self.run(500);
        }
        Err(Refusal::Busy)
    }

    /// Asks for no more torque, and does not wait for the answer.
    pub(crate) fn disarm(&mut self) {
        let disarm = self.request(Operation::Disarm);
        self.say(&disarm);
    }

    /// Sets the parameter of this name.
    pub(crate) fn set(&mut self, name: &str, value: f64) {
        self.commit(|values| set(values, name, value))
            .expect("a commit");
    }

    /// The drive's counter.
    pub(crate) fn drive_count(&self, counter: DriveCounter) -> u32 {
        self.device.board().drive().counters().get(counter)
    }

    /// The counter of comms.
    pub(crate) fn comms_count(&self, counter: CommsCounter) -> u32 {
        self.device.board().comms().counters().get(counter)
    }

    /// Waits until the drive has its parameters, sets the angle's zero here if there
    /// is none, then arms and keeps the lease.
    pub(crate) fn arm(&mut self) {
        self.renew_every = Some(1_000);
        let armed = (0..20).any(|_| {
            let answer = self.ask(Operation::Arm);
            match answer {
                Ok(Answer::Done) => {}
                Err(Refusal::Drive(DriveRefusal::NotZeroed)) => {
                    assert_eq!(self.ask(Operation::Zero), Ok(Answer::Done));
                }
                _ => {
                    assert_eq!(answer, Err(Refusal::Busy), "arming");
                    self.run(200);
                }
            }
            answer.is_ok()
        });
        assert!(armed);
    }
}
