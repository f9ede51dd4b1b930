//! The host's side of the lane that never changes.

use crate::comms::Comms;
use crepitus_protocol::Lane;
use crepitus_protocol::frame;
use crepitus_protocol::host::Refusal;
use crepitus_protocol::management::{Answer, Question, What};

/// Time for what was said last to arrive, ms.
const REBOOT_MS: u64 = 20;

impl Comms {
    /// Who is there, stop, reboot.
    pub(super) fn host_asks(&mut self, question: Question) {
        let token = question.token;
        let answer = match question.what {
            What::Hello => Answer::Hello {
                token,
                own: self.identity,
                drive: self.drive.identity().copied().unwrap_or_default(),
            },
            What::Stop => {
                self.let_go(Refusal::Aborted);
                self.to_drive.ask(What::Stop);
                Answer::Stop { token, done: true }
            }
            What::Reboot => {
                let done = !self.supervision.is_wanted();
                if done {
                    self.to_drive.ask(What::Reboot);
                    self.reboot_ms = Some(self.now_ms.saturating_add(REBOOT_MS));
                }
                Answer::Reboot { token, done }
            }
        };
        if let Ok(frame) = frame::encode_bytes(Lane::ManagementAnswer, &answer.bytes()) {
            self.queue_reply(&frame);
        }
    }
}
