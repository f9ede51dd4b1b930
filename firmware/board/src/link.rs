//! The link between the controllers: USART6 at 4.2 Mbaud, DMA both ways.
//!
//! ```text
//! PC7 ─> USART6 ─> DMA2 stream 1 ─> ring of 2 KB (4.9 ms)        ─> Link::next_byte
//! PC6 <─ USART6 <─ DMA2 stream 6 <─ a frame, and the one after it <─ Link::send
//! ```
//!
//! 84 MHz / 20 = 4.2 MHz exactly, with 16 samples a bit (1 + 4/16).
//!
//! A frame of telemetry takes 0.8 of the millisecond, and making one takes
//! another 0.1: so the next is made while one is on its way.
//!
//! The end of a frame that was sent is an interrupt (`DMA2_STREAM6`); what has
//! been received is looked for, several times a millisecond. There is no
//! interrupt for an idle line: to clear its flag one has to read the data
//! register, and that takes a byte from under the DMA now and then.

use crate::raw;
use core::sync::atomic::{AtomicU8, Ordering, fence};
use crepitus_protocol::frame::{FRAME_BYTES, Frame};
use stm32f4xx_hal::gpio::{PC6, PC7, Pull};
use stm32f4xx_hal::pac::{DMA2, USART6};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// Bytes that may wait for [`Link::next_byte`].
pub const RING_BYTES: usize = 2048;
const RECEIVE: usize = 1;
const SEND: usize = 6;

/// Both streams serve USART6 on this channel.
const CHANNEL: u8 = 5;

// Written and read by DMA, so in RAM that it reaches, and atomic.
static RING: [AtomicU8; RING_BYTES] = [const { AtomicU8::new(0) }; RING_BYTES];
static OUTGOING: [[AtomicU8; FRAME_BYTES]; 2] =
    [const { [const { AtomicU8::new(0) }; FRAME_BYTES] }; 2];

/// The link.
pub struct Link {
    dma: DMA2,
    /// The next byte of the ring to be read.
    next: usize,
    /// Which of [`OUTGOING`] is being sent, or was last.
    sending: usize,
    /// The length of what waits in the other.
    waiting: Option<u16>,
}

impl Link {
    /// Receives from now on.
    pub fn new(usart: &USART6, dma: DMA2, sends: PC6, receives: PC7, rcc: &mut Rcc) -> Self {
        USART6::enable(rcc);
        USART6::reset(rcc);
        DMA2::enable(rcc);
        DMA2::reset(rcc);
        sends.into_alternate::<8>();
        // A line without a sender is idle.
        receives
            .into_alternate::<8>()
            .set_internal_resistor(Pull::Up);
        let data = usart.dr().as_ptr();
        let stream = dma.st(RECEIVE);
        raw::dma_register(stream, data);
        raw::dma_bytes(stream, &RING);
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
            sending: 0,
            waiting: None,
        }
    }

    /// The task that the end of a frame has started has begun: if a frame
    /// waits, it goes now.
    pub fn acknowledge(&mut self) {
        self.dma.hifcr().write(|w| w.ctcif6().clear());
        self.go_on();
    }

    /// The next byte that has been received, if there is one. At most
    /// [`RING_BYTES`] come before none does, at 2.4 µs each.
    pub fn next_byte(&mut self) -> Option<u8> {
        let left = usize::from(self.dma.st(RECEIVE).ndtr().read().ndt().bits());
        let end = RING_BYTES.wrapping_sub(left) % RING_BYTES;
        if self.next == end {
            return None;
        }
        let byte = RING.get(self.next)?.load(Ordering::Relaxed);
        self.next = (self.next + 1) % RING_BYTES;
        Some(byte)
    }

    /// Whether there is room for a frame.
    pub fn can_send(&self) -> bool {
        self.waiting.is_none()
    }

    /// Sends a frame once the one before has gone; if [`Self::can_send`].
    pub fn send(&mut self, frame: &Frame) {
        if !self.can_send() {
            return;
        }
        if let Some(place) = OUTGOING.get(1 - self.sending) {
            for (place, byte) in place.iter().zip(frame) {
                place.store(*byte, Ordering::Relaxed);
            }
            self.waiting = Some(length(frame.len()));
        }
        self.go_on();
    }

    /// Starts what waits, if nothing is on its way.
    fn go_on(&mut self) {
        let stream = self.dma.st(SEND);
        let is_sending = stream.cr().read().en().is_enabled();
        if is_sending {
            return;
        }
        let other = 1 - self.sending;
        let (Some(length), Some(bytes)) = (self.waiting.take(), OUTGOING.get(other)) else {
            return;
        };
        self.sending = other;
        // The bytes are there before the stream reads them.
        fence(Ordering::SeqCst);
        self.dma.hifcr().write(|w| {
            w.ctcif6().clear().chtif6().clear().cteif6().clear();
            w.cdmeif6().clear().cfeif6().clear()
        });
        raw::dma_bytes(stream, bytes);
        stream.ndtr().write(|w| w.ndt().set(length));
        stream.cr().modify(|_, w| w.en().enabled());
    }
}

fn length(bytes: usize) -> u16 {
    u16::try_from(bytes).unwrap_or(u16::MAX)
}
