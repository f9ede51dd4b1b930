//! One direction of the link between the controllers: 21 bytes a tick, one frame
//! after the other; with the faults that the input asks for.

use crate::from_comms::is_block;
use crepitus_protocol::frame::Frame;
use std::collections::VecDeque;

/// Bytes in a tick: 4.2 Mbaud, ten bits a byte, 50 µs.
const BYTES_PER_TICK: usize = 21;

/// Frame buffers of the sender.
const PLACES: usize = 3;

/// A fault of the next frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    Lose,
    /// Changes the byte at this place, modulo the length.
    Corrupt(u8),
    /// Delays by ticks.
    Delay(u16),
    Duplicate,
}

/// A frame on the wire.
struct InFlight {
    /// The tick in which its last byte arrives.
    due: u64,
    frame: Frame,
    is_intact: bool,
    /// Blocks that were lost or changed before it.
    lost_before: u32,
}

/// A frame that has arrived.
pub(super) struct Arrival {
    pub(super) frame: Frame,
    /// Blocks lost before it; of a block that is intact.
    pub(super) lost_before: Option<u32>,
}

/// The wire.
#[derive(Default)]
pub(super) struct Wire {
    in_flight: VecDeque<InFlight>,
    /// Blocks that were lost or changed.
    lost_blocks: u32,
    busy_until: u64,
    faults: Option<(Fault, u8)>,
}

impl Wire {
    /// The next `count` frames have this fault.
    pub(super) fn set_fault(&mut self, fault: Fault, count: u8) {
        self.faults = Some((fault, count));
    }

    /// True if the sender has a buffer for another frame.
    pub(super) fn has_room(&self, now: u64) -> bool {
        let waiting = self.in_flight.iter().filter(|frame| frame.due > now);
        waiting.count() < PLACES
    }

    /// Takes a frame.
    pub(super) fn send(&mut self, mut frame: Frame, now: u64) {
        let ticks = frame.len().div_ceil(BYTES_PER_TICK) as u64;
        self.busy_until = self.busy_until.max(now) + ticks;
        let fault = self.faults.take();
        if let Some((fault, count)) = fault
            && count > 1
        {
            self.faults = Some((fault, count - 1));
        }
        let fault = fault.map(|(fault, _)| fault);
        let is_intact = !matches!(fault, Some(Fault::Lose | Fault::Corrupt(_)));
        let is_lost_block = !is_intact && is_block(&frame);
        let mut copies = 1;
        match fault {
            None => {}
            Some(Fault::Lose) => copies = 0,
            Some(Fault::Duplicate) => copies = 2,
            Some(Fault::Delay(ticks)) => self.busy_until += u64::from(ticks),
            Some(Fault::Corrupt(place)) => {
                // Not into a delimiter, and not the delimiter: the frames around
                // it are not touched.
                let places = frame.len() - 1;
                let byte = &mut frame[usize::from(place) % places];
                *byte = if *byte == 1 { 2 } else { *byte ^ 1 };
            }
        }
        for _ in 0..copies {
            self.in_flight.push_back(InFlight {
                due: self.busy_until,
                frame: frame.clone(),
                is_intact,
                lost_before: self.lost_blocks,
            });
        }
        self.lost_blocks += u32::from(is_lost_block);
    }

    /// The next frame that has arrived.
    pub(super) fn receive(&mut self, now: u64) -> Option<Arrival> {
        let arrived = self.in_flight.pop_front_if(|frame| frame.due <= now)?;
        let is_counted = arrived.is_intact && is_block(&arrived.frame);
        Some(Arrival {
            lost_before: is_counted.then_some(arrived.lost_before),
            frame: arrived.frame,
        })
    }

    /// The sender has restarted: what it has not sent is gone. What is delayed
    /// still arrives.
    pub(super) fn sender_reset(&mut self, now: u64) {
        self.busy_until = now;
    }
}
