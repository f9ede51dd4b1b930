//! The panel without a device: recordings only.

use crate::frame::{Header, Kind, Masks, frame};
use crate::request::Request;
use crate::shared::{Order, Shared};
use axum::extract::ws::Utf8Bytes;
use serde_json::{Value, json};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

/// Interval of frames, which tell pages that the program is there.
const BEAT_EVERY: Duration = Duration::from_millis(100);

/// Refuses every order but those of control, until the program is asked to end.
pub(crate) fn run(shared: &Shared, inbox: &Receiver<Order>, has_ended: impl Fn() -> bool) {
    let status = json!({ "status": { "link": "replay", "faults": [] } });
    shared.latest.send_modify(|latest| {
        latest.status = Utf8Bytes::from(status.to_string());
        latest.presets =
            Utf8Bytes::from(json!({ "presets": crate::hello::presets(&[]) }).to_string());
    });
    let mut number = 0_u32;
    while !has_ended() {
        match inbox.recv_timeout(BEAT_EVERY) {
            Ok(order) => {
                let outcome = match order.request {
                    Request::Take => {
                        shared.control.give(order.page);
                        Ok(Value::Null)
                    }
                    Request::Release => {
                        shared.control.release(order.page);
                        Ok(Value::Null)
                    }
                    _ => Err("recordings are shown, there is no device".to_owned()),
                };
                let _ = order.reply.send(outcome);
            }
            Err(RecvTimeoutError::Timeout) => {
                number = number.wrapping_add(1);
                let header = Header {
                    kind: Kind::Live,
                    number,
                    unix_ms: 0.0,
                    begin_s: 0.0,
                    bin_s: 0.005,
                    missing: 0,
                    masks: Masks::default(),
                };
                shared.watchdog.made(number);
                let _ = shared.frames.send(frame(&header, &[]));
            }
            Err(RecvTimeoutError::Disconnected) => return,
        }
    }
}
