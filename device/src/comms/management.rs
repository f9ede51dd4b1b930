//! Management requests from the host.

use crate::comms::Comms;
use crepitus_protocol::Lane;
use crepitus_protocol::frame;
use crepitus_protocol::host::Refusal;
use crepitus_protocol::management::{Action, Answer, ManagementRequest};

/// Delay before a reboot, so that the last reply is sent, ms.
const REBOOT_MS: u64 = 20;

impl Comms {
    /// Answers hello, stop and reboot.
    pub(super) fn answer_management(&mut self, question: ManagementRequest) {
        let token = question.token;
        let answer = match question.action {
            Action::Hello => Answer::Hello {
                token,
                own: self.identity,
                drive: self.drive.identity().copied().unwrap_or_default(),
            },
            Action::Stop => {
                self.release(Refusal::Aborted);
                self.to_drive.queue_management(Action::Stop);
                Answer::Stop { token, done: true }
            }
            Action::Reboot => {
                let done = !self.supervision.is_enable_requested();
                if done {
                    self.to_drive.queue_management(Action::Reboot);
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
