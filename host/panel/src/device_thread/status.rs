//! The device's state as a message.

use super::DeviceThread;
use crepitus_client::Transport;
use crepitus_protocol::host::Status;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// Interval over which the speed of the device's time is measured.
const SPEED_OVER: Duration = Duration::from_secs(2);

/// Speed at which the device's time passes: an emulated device is slower than real time.
pub(super) struct Speed {
    began: Instant,
    device: Duration,
    factor: f64,
}

impl Speed {
    pub(super) fn new(device: Duration) -> Self {
        Self {
            began: Instant::now(),
            device,
            factor: 1.0,
        }
    }

    fn factor(&mut self, device: Duration) -> f64 {
        let passed = self.began.elapsed();
        if passed >= SPEED_OVER {
            let device_s = device.saturating_sub(self.device).as_secs_f64();
            self.factor = device_s / passed.as_secs_f64();
            (self.began, self.device) = (Instant::now(), device);
        }
        self.factor
    }
}

impl<T: Transport> DeviceThread<'_, T> {
    pub(super) fn publish_status(&mut self) {
        self.status_is_due = false;
        self.status_at = Instant::now();
        let known = if self.is_lost {
            None
        } else {
            self.client.status().ok()
        };
        let status = self.status(known.as_ref());
        // What a phone needs to say that a stop has worked.
        let state = json!({ "link": status["link"], "state": status["state"] });
        self.publish(|latest| &mut latest.status, &json!({ "status": status }));
        self.publish(|latest| &mut latest.state, &json!({ "status": state }));
        if let Some(status) = known
            && status.revision != self.committed
        {
            self.reload_parameters();
        }
    }

    fn status(&mut self, known: Option<&Status>) -> Value {
        let mut value = json!({
            "link": if self.is_lost { "lost" } else { "connected" },
            "state": Value::Null,
            "faults": [],
            "recording": self.recording.as_ref().map(|recorded| json!({
                "file": recorded.name(),
                "seconds": recorded.seconds(),
            })),
            "message": self.message,
            "torque_end": self.torque.end(),
            "speed_of_time": self.speed.factor(self.client.now()),
        });
        if let Some(accounting) = self.client.accounting() {
            value["produced"] = json!(accounting.produced());
            value["received"] = json!(accounting.received());
            value["dropped"] = json!(accounting.dropped_by_device());
            value["lost"] = json!(accounting.lost_on_line());
        }
        let Some(status) = known else {
            return value;
        };
        let other = (status.lease)
            .filter(|session| *session != self.client.session())
            .map(|session| self.program.holder(&mut self.client, session));
        let faults = [
            (status.drive_fault, false),
            (status.comms_fault, false),
            (status.coil_fault, true),
        ];
        let faults: Vec<_> = (faults.into_iter())
            .filter(|(code, _)| *code != 0)
            .map(|(code, is_coil)| json!({ "code": code, "coil": is_coil }))
            .collect();
        value["state"] = json!(status.state.name());
        value["zeroed"] = json!(status.zeroed);
        value["polarity_proven"] = json!(status.polarity_proven);
        value["faults"] = json!(faults);
        value["drive_present"] = json!(status.drive_present);
        value["supply_v"] = json!(f64::from(status.measured.supply_cv) / 100.0);
        value["motor_c"] = json!(status.measured.motor_c);
        value["other"] = json!(other);
        value
    }
}
