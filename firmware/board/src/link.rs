//! The link between the controllers: USART6 at 4.2 Mbaud, DMA both ways.
//!
//! ```text
//! RX  ─> USART6 ─> DMA2 stream 1 ─> ring of 2 KB (4.9 ms)        ─> Link::take
//! TX  <─ USART6 <─ DMA2 stream 6 <─ a frame, and the one after it <─ Link::send
//! ```
//!
//! 84 MHz / 20 = 4.2 MHz exactly, with 16 samples a bit (1 + 4/16).
//!
//! Sending a frame takes 0.9 of the millisecond, and encoding it about as
//! long: so there are three buffers, one being sent, one pending, and one for
//! encoding the next frame in place. The DMA reads it there.
//!
//! The end of a sent frame is an interrupt (`DMA2_STREAM6`); received bytes are
//! polled several times a millisecond. There is no interrupt for an idle
//! line: clearing its flag reads the data register, which now and then takes
//! a byte from the DMA.

use crate::clocks::APB2_HZ;
use crate::pins::resistor;
use crate::raw;
use core::sync::atomic::{AtomicU8, Ordering, fence};
use crepitus_device::board::LINK_BAUD;
use crepitus_device::board::pins::drive::LINK_RECEIVES;
use crepitus_protocol::frame::{DELIMITER, EncodedFrame, FRAME_BYTES, Frame, FrameBuffer};
use stm32f4xx_hal::gpio::alt::usart6::{Rx, Tx};
use stm32f4xx_hal::gpio::{PinPull, PinSpeed, Speed};
use stm32f4xx_hal::pac::{DMA2, USART6};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// Capacity of the receive ring, bytes.
const RING_BYTES: usize = 2048;

/// Number of frame buffers: see the module.
pub const BUFFERS: usize = 3;

/// A buffer for a frame, in RAM that DMA reaches.
pub type DmaBuffer = &'static mut FrameBuffer;

/// Initial value of a buffer.
pub const EMPTY_BUFFER: FrameBuffer = [0; FRAME_BYTES];

const RECEIVE: usize = 1;
const SEND: usize = 6;

/// Both streams serve USART6 on this channel.
const CHANNEL: u8 = 5;

// Written by DMA, so in RAM that it reaches, and atomic.
static RING: [AtomicU8; RING_BYTES] = [const { AtomicU8::new(0) }; RING_BYTES];

// 1 + 4/16 clocks of APB2 a sample.
const _: () = assert!(APB2_HZ == 20 * LINK_BAUD);

/// The link.
pub struct Link {
    dma: DMA2,
    /// The next byte of the ring to be taken.
    next: usize,
    /// The place after the last one that may be.
    end: usize,
    spare: [Option<DmaBuffer>; BUFFERS],
    /// Pending frames in order; never more than there are buffers.
    waiting: [Option<EncodedFrame<DmaBuffer>>; BUFFERS],
    sending: Option<DmaBuffer>,
}

impl Link {
    /// Sets up the link and starts receiving.
    pub fn new(
        usart: &USART6,
        dma: DMA2,
        (sends, receives): (impl Into<Tx>, impl Into<Rx>),
        buffers: [DmaBuffer; BUFFERS],
        rcc: &mut Rcc,
    ) -> Self {
        USART6::enable(rcc);
        USART6::reset(rcc);
        DMA2::enable(rcc);
        DMA2::reset(rcc);
        // A bit is 238 ns; at the slowest setting an edge may take 100.
        let mut sends: Tx = sends.into();
        sends.set_speed(Speed::Medium);
        // Without a sender the line is idle.
        let mut receives: Rx = receives.into();
        receives.set_internal_resistor(resistor(LINK_RECEIVES.pull));
        let data = usart.dr().as_ptr();
        let stream = dma.st(RECEIVE);
        raw::dma_register(stream, data);
        raw::dma_destination(stream, &RING);
        stream.ndtr().write(|w| w.ndt().set(length(RING_BYTES)));
        stream.cr().write(|w| {
            w.chsel().set(CHANNEL).dir().peripheral_to_memory();
            w.minc().incremented().circ().enabled().pl().high();
            w.en().enabled()
        });
        let stream = dma.st(SEND);
        raw::dma_register(stream, data);
        stream.cr().write(|w| {
            w.chsel().set(CHANNEL).dir().memory_to_peripheral();
            w.minc().incremented().tcie().enabled()
        });
        usart
            .brr()
            .write(|w| w.div_mantissa().set(1).div_fraction().set(4));
        usart.cr3().write(|w| w.dmat().set_bit().dmar().set_bit());
        usart
            .cr1()
            .write(|w| w.ue().set_bit().te().set_bit().re().set_bit());
        Self {
            dma,
            next: 0,
            end: 0,
            spare: buffers.map(Some),
            waiting: [const { None }; BUFFERS],
            sending: None,
        }
    }

    /// Acknowledges the interrupt of a sent frame, and sends the next one.
    pub fn acknowledge(&mut self) {
        self.dma.hifcr().write(|w| w.ctcif6().clear());
        self.start_next();
    }

    /// Looks how far the ring is filled. Some 50 clocks before bytes are taken, so that they are in memory then; one
    /// that comes meanwhile is left for the next run.
    pub fn look(&mut self) {
        self.end = self.end_of_ring();
    }

    /// Number of received bytes not yet taken, as of the last [`Self::look`]: 2,047 at most.
    pub fn received(&self) -> usize {
        self.end.wrapping_sub(self.next) % RING_BYTES
    }

    /// The place after the newest byte that NDTR counts. It does so when the byte is read from the USART
    /// (RM0090, DMA_SxNDTR); some clocks later it is in memory.
    fn end_of_ring(&self) -> usize {
        let left = usize::from(self.dma.st(RECEIVE).ndtr().read().ndt().bits());
        RING_BYTES.wrapping_sub(left)
    }

    /// The oldest received byte; while there is none, what was there before.
    pub fn next_byte(&self) -> Option<u8> {
        Some(RING.get(self.next)?.load(Ordering::Relaxed))
    }

    /// Takes the oldest received byte.
    fn take_byte(&mut self) -> Option<u8> {
        let byte = self.next_byte()?;
        self.next = (self.next + 1) % RING_BYTES;
        Some(byte)
    }

    /// Takes the oldest received bytes, as many as there is room for; returns those.
    pub fn take<'a>(&mut self, into: &'a mut [u8]) -> &'a [u8] {
        let count = self.received().min(into.len());
        for place in into.iter_mut().take(count) {
            *place = self.take_byte().unwrap_or_default();
        }
        into.get(..count).unwrap_or_default()
    }

    /// Takes the oldest of these received bytes before the next delimiter, as many as there is
    /// room for; or that delimiter, if it is the oldest.
    pub fn take_part<'a>(&mut self, received: usize, into: &'a mut [u8]) -> &'a [u8] {
        let most = into.len().min(received);
        let mut taken = 0;
        // Up to the ring's end, and on from its beginning.
        for ring in [RING.get(self.next..).unwrap_or_default(), &RING] {
            let places = into.get_mut(taken..most).unwrap_or_default();
            let (count, is_end) = copy_part(ring, places);
            taken += count;
            if is_end {
                break;
            }
        }
        // Nothing before it: the delimiter itself.
        taken = taken.max(1).min(most);
        self.next = (self.next + taken) % RING_BYTES;
        into.get(..taken).unwrap_or_default()
    }

    /// Takes a free buffer, if there is one.
    pub fn spare(&mut self) -> Option<DmaBuffer> {
        self.spare.iter_mut().find_map(Option::take)
    }

    /// Returns whether a buffer is free.
    pub fn can_send(&self) -> bool {
        self.spare.iter().any(Option::is_some)
    }

    /// Sends a copy of a frame, if a buffer is free.
    pub fn send_copy(&mut self, frame: &Frame) {
        if let Some(buffer) = self.spare() {
            if let Some(bytes) = buffer.get_mut(..frame.len()) {
                bytes.copy_from_slice(frame);
            }
            let length = frame.len();
            self.send(EncodedFrame { buffer, length });
        }
    }

    /// Sends a frame after those pending.
    pub fn send(&mut self, frame: EncodedFrame<DmaBuffer>) {
        push(&mut self.waiting, frame);
        self.start_next();
    }

    /// Starts sending the next pending frame, if none is being sent.
    fn start_next(&mut self) {
        let is_sending = self.dma.st(SEND).cr().read().en().is_enabled();
        if is_sending {
            return;
        }
        if let Some(sent) = self.sending.take() {
            push(&mut self.spare, sent);
        }
        let Some(frame) = self.waiting.iter_mut().next().and_then(Option::take) else {
            return;
        };
        self.waiting.rotate_left(1);
        let stream = self.dma.st(SEND);
        self.dma.hifcr().write(|w| {
            w.ctcif6().clear().chtif6().clear().cteif6().clear();
            w.cdmeif6().clear().cfeif6().clear()
        });
        let buffer = raw::dma_source(stream, frame.buffer);
        stream.ndtr().write(|w| w.ndt().set(length(frame.length)));
        // Completes all writes before the stream reads them.
        fence(Ordering::SeqCst);
        stream.cr().modify(|_, w| w.en().enabled());
        self.sending = Some(buffer);
    }
}

/// Copies bytes up to a delimiter; returns how many, and whether one was met. It is copied,
/// too, and counts for nothing.
#[inline]
fn copy_part(ring: &[AtomicU8], into: &mut [u8]) -> (usize, bool) {
    let mut count = 0;
    for (place, byte) in into.iter_mut().zip(ring) {
        *place = byte.load(Ordering::Relaxed);
        if *place == DELIMITER {
            return (count, true);
        }
        count += 1;
    }
    (count, false)
}

/// Appends to the occupied slots.
fn push<T>(slots: &mut [Option<T>; BUFFERS], one_more: T) {
    if let Some(free) = slots.iter_mut().find(|free| free.is_none()) {
        *free = Some(one_more);
    }
}

fn length(bytes: usize) -> u16 {
    u16::try_from(bytes).unwrap_or(u16::MAX)
}
