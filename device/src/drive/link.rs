//! State of the link: the last command, and pending messages to comms.

use crate::counters::Counters;
use crepitus_protocol::counters::DriveCounter;
use crepitus_protocol::link::{DriveRefusal, Outcome};
use crepitus_protocol::management::{Action, Answer, Identity, ManagementRequest};

use crate::drive::heartbeat_monitor::is_fresh;

/// Interval of status messages, ticks.
pub const STATUS_TICKS: u64 = 100;

/// The last command, and pending messages to comms.
#[derive(Debug, Default)]
pub struct Link {
    /// The last command that was completed.
    last: Option<Outcome>,
    executing: Option<u16>,
    answer: Option<Answer>,
    status_due: bool,
    next_status_tick: u64,
}

impl Link {
    /// Accepts a command once, if it is newer than the last one and fresh:
    /// `seen_tick` is the drive's tick that it echoes.
    pub fn accepts(&mut self, now: u64, seen_tick: u64, number: u16, counters: &Counters) -> bool {
        let last = self.executing.or(self.last.map(|outcome| outcome.number));
        if last == Some(number) {
            // Repeated: the status carries its outcome.
            return false;
        }
        let is_newer = last.is_none_or(|last| number.wrapping_sub(last).cast_signed() > 0);
        if !(is_newer && is_fresh(now, seen_tick)) {
            counters.count(DriveCounter::StaleCommands);
            return false;
        }
        self.executing = Some(number);
        true
    }

    /// Stores the result of the current command.
    pub fn finish(&mut self, result: Result<(), DriveRefusal>) {
        if let Some(number) = self.executing.take() {
            self.last = Some(Outcome { number, result });
            self.status_due = true;
        }
    }

    /// Resets after a restart of comms, whose sequence numbers restart, too.
    pub fn clear(&mut self) {
        (self.last, self.executing) = (None, None);
    }

    /// Queues the reply to a management request.
    pub fn answer(&mut self, question: ManagementRequest, own: &Identity, done: bool) {
        let token = question.token;
        self.answer = Some(match question.action {
            Action::Hello => Answer::Hello {
                token,
                own: *own,
                drive: *own,
            },
            Action::Stop => Answer::Stop { token, done },
            Action::Reboot => Answer::Reboot { token, done },
        });
    }

    /// Schedules a status at once.
    pub fn request_status(&mut self) {
        self.status_due = true;
    }

    /// Returns whether a management reply is pending.
    pub fn has_answer(&self) -> bool {
        self.answer.is_some()
    }

    /// Takes the pending management reply.
    pub fn take_answer(&mut self) -> Option<Answer> {
        self.answer.take()
    }

    /// Returns whether a status is due.
    pub fn is_status_due(&self, now: u64) -> bool {
        self.status_due || now >= self.next_status_tick
    }

    /// Records that a status is sent now.
    pub fn status_sent(&mut self, now: u64) {
        self.status_due = false;
        self.next_status_tick = now.saturating_add(STATUS_TICKS);
    }

    /// The last command that was completed, and its result.
    pub fn last(&self) -> Option<Outcome> {
        self.last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_accepted_once_newer_than_the_last_and_fresh() {
        let (mut link, counters) = (Link::default(), Counters::new());
        let stale = |counters: &Counters| counters.get(DriveCounter::StaleCommands);
        assert!(link.accepts(1_000, 990, 7, &counters));
        // Repeated while it is executed, and when it has ended.
        assert!(!link.accepts(1_001, 990, 7, &counters));
        link.finish(Ok(()));
        assert!(!link.accepts(1_002, 990, 7, &counters));
        assert_eq!(stale(&counters), 0);
        // Older ones, and one that was on its way for long.
        for number in [6, 0, 7_u16.wrapping_sub(0x7fff)] {
            assert!(!link.accepts(1_003, 1_003, number, &counters), "{number}");
        }
        assert!(!link.accepts(10_000, 1_003, 8, &counters));
        assert_eq!(stale(&counters), 4);
        assert!(link.accepts(10_000, 9_990, 8, &counters));
        link.finish(Err(DriveRefusal::NotZeroed));
        let last = link.last().map(|outcome| (outcome.number, outcome.result));
        assert_eq!(last, Some((8, Err(DriveRefusal::NotZeroed))));
    }

    #[test]
    fn another_boot_of_comms_counts_from_the_beginning() {
        let (mut link, counters) = (Link::default(), Counters::new());
        assert!(link.accepts(100, 90, 7, &counters));
        link.finish(Ok(()));
        link.clear();
        assert_eq!(link.last(), None);
        assert!(link.accepts(100, 90, 1, &counters));
        // What is executed has ended for comms, too.
        link.clear();
        link.finish(Ok(()));
        assert_eq!(link.last(), None);
    }
}
