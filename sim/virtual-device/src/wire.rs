//! One direction of the link between the controllers: 4.2 Mbaud, 21 bytes a
//! tick, one frame after the other, as DMA sends them.

use crate::faults::FaultInjector;
use crepitus_protocol::frame::{self, Frame};
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Decoder, Lane};
use std::collections::VecDeque;

/// Bytes that the UART carries in a tick: 4.2 Mbaud, ten bits a byte, 50 µs.
pub const BYTES_PER_TICK: usize = 21;

const TICKS_PER_MS: u64 = 20;

/// Frame buffers of the sender, including the one being encoded.
const PLACES: usize = 3;

/// Traffic of a wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Frames sent.
    pub frames: u64,
    /// Bytes sent.
    pub bytes: u64,
    /// Ticks in which the wire was busy to its last byte.
    pub full_ticks: u64,
}

/// One direction of the link.
#[derive(Clone, Debug)]
pub struct Wire {
    /// Faults of the wire.
    pub injector: FaultInjector,
    /// Falsification of the sender's blocks: a defect of its program, or
    /// of its memory.
    pub falsify: Option<fn(&mut Block)>,
    /// The sender's program stands still, and its DMA sends the last two frames again and
    /// again, each millisecond.
    pub repeats: bool,
    last: VecDeque<Frame>,
    /// The frame being sent, and the number of bytes sent.
    sending: Option<(Frame, usize)>,
    /// Frames after it.
    waiting: VecDeque<Frame>,
    /// Frames in transit, with the tick of their arrival.
    on_the_way: VecDeque<(u64, Vec<u8>)>,
    traffic: Traffic,
}

impl Wire {
    /// A wire without faults; later ones depend on this seed.
    pub fn new(seed: u64) -> Self {
        Self {
            injector: FaultInjector::new(seed),
            falsify: None,
            repeats: false,
            last: VecDeque::new(),
            sending: None,
            waiting: VecDeque::new(),
            on_the_way: VecDeque::new(),
            traffic: Traffic::default(),
        }
    }

    /// Traffic of the wire.
    pub fn traffic(&self) -> Traffic {
        self.traffic
    }

    /// Resets the sender: the frame being sent ends here.
    pub fn sender_reset(&mut self) {
        self.sending = None;
        self.waiting.clear();
    }

    /// One tick: asks the sender for a frame, with whether a buffer is free for
    /// a new one, and passes arriving bytes to the receiver.
    pub fn tick(
        &mut self,
        now: u64,
        mut next_frame: impl FnMut(bool) -> Option<Frame>,
        mut receive: impl FnMut(u8),
    ) {
        if self.repeats {
            if now.is_multiple_of(TICKS_PER_MS) {
                let again = self.last.iter().map(|frame| (now, frame.to_vec()));
                self.on_the_way.extend(again);
            }
            self.arrive(now, &mut receive);
            return;
        }
        let mut room = BYTES_PER_TICK;
        self.ask(&mut next_frame);
        while room > 0 {
            let (frame, sent) = match self.sending.take() {
                Some(sending) => sending,
                None => match self.waiting.pop_front() {
                    Some(frame) => {
                        self.traffic.frames += 1;
                        self.ask(&mut next_frame);
                        (frame, 0)
                    }
                    None => break,
                },
            };
            let part = room.min(frame.len() - sent);
            room -= part;
            self.traffic.bytes += part as u64;
            if sent + part < frame.len() {
                self.sending = Some((frame, sent + part));
            } else {
                let frame = falsified(frame, self.falsify);
                self.last.truncate(1);
                self.last.push_front(frame.clone());
                let on_the_way = &mut self.on_the_way;
                self.injector.pass(&frame, |late, bytes| {
                    on_the_way.push_back((now + late, bytes.to_vec()));
                });
            }
        }
        self.traffic.full_ticks += u64::from(room == 0);
        self.arrive(now, &mut receive);
    }

    fn ask(&mut self, next_frame: &mut impl FnMut(bool) -> Option<Frame>) {
        let in_use = self.waiting.len() + usize::from(self.sending.is_some());
        self.waiting.extend(next_frame(in_use < PLACES));
    }

    fn arrive(&mut self, now: u64, receive: &mut impl FnMut(u8)) {
        // Delays differ, so one may overtake another.
        let mut i = 0;
        while let Some((due, _)) = self.on_the_way.get(i) {
            if *due > now {
                i += 1;
            } else if let Some((_, bytes)) = self.on_the_way.remove(i) {
                bytes.into_iter().for_each(&mut *receive);
            }
        }
    }
}

/// A frame with another block in it, if it has a block.
fn falsified(frame: Frame, falsify: Option<fn(&mut Block)>) -> Frame {
    let Some(falsify) = falsify else {
        return frame;
    };
    let mut decoder = Decoder::new();
    let block = frame.iter().find_map(|byte| match decoder.push(*byte) {
        Some(Ok(body)) if body.lane() == Some(Lane::Telemetry) => body.message::<Block>(),
        _ => None,
    });
    let Some(mut block) = block else {
        return frame;
    };
    falsify(&mut block);
    frame::encode(Lane::Telemetry, &block).unwrap_or(frame)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_takes_its_time_and_arrives_whole() {
        let mut wire = Wire::new(0);
        let mut frames = vec![
            Frame::from_slice(&[1; 50]).unwrap(),
            Frame::from_slice(&[2; 10]).unwrap(),
        ];
        frames.reverse();
        let mut arrived = Vec::new();
        for tick in 0..4 {
            wire.tick(tick, |_| frames.pop(), |byte| arrived.push((tick, byte)));
        }
        let expected: Vec<_> = [(2, 1); 50].into_iter().chain([(2, 2); 10]).collect();
        assert_eq!(arrived, expected);
        let traffic = wire.traffic();
        assert_eq!(
            (traffic.frames, traffic.bytes, traffic.full_ticks),
            (2, 60, 2)
        );
    }
}
