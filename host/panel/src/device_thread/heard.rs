//! Torques for pages that play them as sound.

use super::{DeviceThread, unix_ms};
use crate::frame::{Header, Kind, samples};
use crepitus_client::Transport;
use crepitus_protocol::TICK_S;
use crepitus_recording::Row;

/// Commanded torques since the last frame.
#[derive(Debug, Default)]
pub(super) struct Heard {
    /// Time of the first one.
    begin_s: f64,
    torques_nm: Vec<f32>,
}

impl Heard {
    pub(super) fn take(&mut self, row: &Row) {
        if self.torques_nm.is_empty() {
            self.begin_s = row.time_s;
        }
        self.torques_nm.push(row.torque_nm);
    }
}

impl<T: Transport> DeviceThread<'_, T> {
    /// Returns whether a page listens.
    pub(super) fn is_heard(&self) -> bool {
        self.shared.samples.receiver_count() > 0
    }

    /// Sends the torques since the last frame to pages that listen; none in a trial that hides them, but of a simulated
    /// leg. A brace is heard and felt, blind or not: whoever moves a leg by pointer hears it, or has nothing that tells
    /// a slight crepitus. In an experiment numbers would tell the level: none at all.
    pub(super) fn publish_samples(&mut self) {
        let heard = std::mem::take(&mut self.heard);
        let masks = self.masks();
        let is_hidden = masks.torque && self.hand.is_none();
        if heard.torques_nm.is_empty() || is_hidden {
            return;
        }
        if self.experiment.is_hidden(self.now_s) {
            return;
        }
        let header = Header {
            kind: Kind::Samples,
            number: self.frame_number,
            unix_ms: unix_ms(),
            begin_s: heard.begin_s,
            bin_s: TICK_S,
            missing: 0,
            masks,
        };
        let frame = samples(&header, &heard.torques_nm);
        // A page may have gone meanwhile.
        let _ = self.shared.samples.send(frame);
    }
}
