//! Frames of the curves.

use super::{DeviceThread, unix_ms};
use crate::frame::{Header, Kind, Masks, frame};
use crate::live::Marks;
use crepitus_client::Transport;
use std::time::{Duration, Instant};

/// Interval of frames: 60 a second.
const FRAME_EVERY: Duration = Duration::from_millis(16);

/// Interval of frames without samples, which keep the watchdog fed.
const BEAT_EVERY: Duration = Duration::from_millis(50);

impl<T: Transport> DeviceThread<'_, T> {
    /// The newest bins, or none to be answered.
    pub(super) fn publish_frame(&mut self) {
        let since = self.frame_at.elapsed();
        if since < FRAME_EVERY {
            return;
        }
        let (first, mut bins) = self.envelope.complete();
        if bins.is_empty() && since < BEAT_EVERY {
            return;
        }
        for bin in bins.iter_mut().filter(|bin| self.pain.is_felt(bin)) {
            bin.marks.0 |= Marks::HURTS;
        }
        if self.experiment.is_hidden(self.now_s) {
            // How long parameters ramp, and whether torque meets a limit, tells the level.
            for bin in &mut bins {
                bin.marks.0 &= !(Marks::SETTLING | Marks::LIMITED);
            }
        }
        self.frame_at = Instant::now();
        self.frame_number = self.frame_number.wrapping_add(1);
        self.shared.watchdog.made(self.frame_number);
        let bin_s = self.envelope.bin_s();
        #[expect(clippy::cast_precision_loss, reason = "years of bins")]
        let begin_s = first as f64 * bin_s;
        let header = Header {
            kind: Kind::Live,
            number: self.frame_number,
            unix_ms: unix_ms(),
            begin_s,
            bin_s,
            missing: std::mem::take(&mut self.missing),
            masks: self.masks(),
        };
        // Without a page nobody receives it.
        let _ = self.shared.frames.send(frame(&header, &bins));
        self.publish_samples();
    }

    /// Data that pages must not see: in a blind trial the knee.
    pub(super) fn masks(&self) -> Masks {
        let held = self.lesson.as_ref();
        let hidden = held.filter(|held| held.is_hidden(self.now_s));
        let is_session = self.experiment.is_hidden(self.now_s);
        Masks {
            torque: is_session || hidden.is_some_and(|held| !held.shows_curves()),
            states: is_session || hidden.is_some(),
        }
    }
}
