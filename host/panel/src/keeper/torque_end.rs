//! The last end of torque: who or what ended it, and when. Every page shows it until the next
//! arming.

use super::{Keeper, unix_ms};
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
            Self::Stop(Role::Viewer) => "stop-viewer",
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

/// An end of torque.
pub(super) struct TorqueEnd {
    cause: Cause,
    unix_ms: f64,
}

impl TorqueEnd {
    pub(super) fn message(&self) -> Value {
        let mut message = json!({ "cause": self.cause.name(), "unix_ms": self.unix_ms });
        match &self.cause {
            Cause::Fault(code) => message["code"] = json!(code),
            Cause::Program(name) => message["name"] = json!(name),
            _ => {}
        }
        message
    }
}

impl<T: Transport> Keeper<'_, T> {
    /// Torque is on: the end of the last one is no longer shown.
    pub(super) fn torque_begins(&mut self) {
        self.has_torque = true;
        self.torque_end = None;
    }

    /// Records why torque ends, if there is any.
    pub(super) fn torque_ends(&mut self, cause: Cause) {
        if std::mem::take(&mut self.has_torque) {
            self.torque_end = Some(TorqueEnd {
                cause,
                unix_ms: unix_ms(),
            });
            self.status_is_due = true;
        }
    }

    /// Records an end of torque that no page has ordered.
    pub(super) fn notice_torque_end(&mut self) {
        if !self.has_torque || self.client.is_armed() && !self.is_lost {
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
