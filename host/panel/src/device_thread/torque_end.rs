//! The last end of torque: who or what ended it, and when. Every page shows it until the next
//! arming.

use super::{DeviceThread, unix_ms};
use crate::tokens::Role;
use crepitus_client::Transport;
use serde_json::{Value, json};

/// Cause of an end of torque.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Cause {
    /// A page with such a link pressed STOP.
    Stop(Role),
    /// The page in control disarmed.
    Disarm,
    /// Another page took control.
    TakeOver,
    /// The page in control was closed, reloaded or has released control.
    PageLeft,
    /// The page in control did not answer.
    Watchdog,
    /// The device has a fault of this code.
    Fault(u8),
    /// This other program has armed or holds the device.
    Program(String),
    /// The connection to the device was lost.
    DeviceLost,
    /// The device says no more than that torque is off: another program has stopped it.
    Elsewhere,
}

impl Cause {
    /// Name in messages and in the texts of the page.
    fn name(&self) -> &'static str {
        match self {
            Self::Stop(Role::Teacher) => "stop-teacher",
            Self::Stop(Role::Remote) => "stop-remote",
            Self::Stop(Role::Viewer) => "stop-viewer",
            Self::Stop(Role::Student) => "stop-student",
            Self::Disarm => "disarm",
            Self::TakeOver => "take-over",
            Self::PageLeft => "page-left",
            Self::Watchdog => "watchdog",
            Self::Fault(_) => "fault",
            Self::Program(_) => "program",
            Self::DeviceLost => "device-lost",
            Self::Elsewhere => "elsewhere",
        }
    }
}

/// Torque of this program, as far as it is recorded.
pub(super) enum Torque {
    /// Given, and no end of it was recorded.
    On,
    /// Off; what ended the last one, and when, ms since 1970.
    Off(Option<(Cause, f64)>),
}

impl Torque {
    /// The last end, as a message; null while there is torque, and before the first.
    pub(super) fn end(&self) -> Value {
        let Self::Off(Some((cause, unix_ms))) = self else {
            return Value::Null;
        };
        let mut message = json!({ "cause": cause.name(), "unix_ms": unix_ms });
        match cause {
            Cause::Fault(code) => message["code"] = json!(code),
            Cause::Program(name) => message["name"] = json!(name),
            _ => {}
        }
        message
    }
}

impl<T: Transport> DeviceThread<'_, T> {
    /// Records why torque ends, if there is any.
    pub(super) fn torque_ends(&mut self, cause: Cause) {
        if matches!(self.torque, Torque::On) {
            self.torque = Torque::Off(Some((cause, unix_ms())));
            self.status_is_due = true;
        }
    }

    /// Records an end of torque that no page has ordered.
    pub(super) fn notice_torque_end(&mut self) {
        if matches!(self.torque, Torque::Off(_)) || self.client.is_armed() && !self.is_lost {
            return;
        }
        let known = if self.is_lost {
            None
        } else {
            self.client.status().ok()
        };
        let own = self.client.session();
        let cause = match known {
            None => Cause::DeviceLost,
            Some(status) => match (status.drive_fault, status.comms_fault, status.lease) {
                (0, 0, Some(session)) if session != own => {
                    Cause::Program(self.program.holder(&mut self.client, session))
                }
                (0, 0, _) => Cause::Elsewhere,
                (0, code, _) | (code, _, _) => Cause::Fault(code),
            },
        };
        self.torque_ends(cause);
    }
}
