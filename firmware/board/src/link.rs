//! The link between the controllers: USART6 at 4.2 Mbaud, DMA both ways.
//!
//! ```text
//! PC7 ─> USART6 ─> DMA2 stream 1 ─> ring of 2 KB (4.9 ms)        ─> Link::next_byte
//! PC6 <─ USART6 <─ DMA2 stream 6 <─ a frame, and the one after it <─ Link::send
//! ```
//!
//! 84 MHz / 20 = 4.2 MHz exactly, with 16 samples a bit (1 + 4/16).
//!
//! A frame takes 0.8 of the millisecond to be sent, and about as long to be
//! made: so there are three places, one whose frame is on its way, one that
//! waits, and one in which the next is made. The DMA reads where it was made.
//!
//! The end of a frame that was sent is an interrupt (`DMA2_STREAM6`); what has
//! been received is looked for, several times a millisecond. There is no
//! interrupt for an idle line: to clear its flag one has to read the data
//! register, and that takes a byte from under the DMA now and then.

use crate::raw;
use core::sync::atomic::{AtomicU8, Ordering, fence};
use crepitus_protocol::frame::{FRAME_BYTES, Frame, Made, Place};
use stm32f4xx_hal::gpio::{PC6, PC7, Pull};
use stm32f4xx_hal::pac::{DMA2, USART6};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// Bytes that may wait to be taken.
const RING_BYTES: usize = 2048;

/// Places for frames: see the module.
pub const PLACES: usize = 3;

/// A place for a frame, in RAM that DMA reaches.
pub type DmaPlace = &'static mut Place;

/// What places are made of.
pub const PLACE: Place = [0; FRAME_BYTES];

const RECEIVE: usize = 1;
const SEND: usize = 6;

/// Both streams serve USART6 on this channel.
const CHANNEL: u8 = 5;

// Written by DMA, so in RAM that it reaches, and atomic.
static RING: [AtomicU8; RING_BYTES] = [const { AtomicU8::new(0) }; RING_BYTES];

/// The link.
pub struct Link {
    dma: DMA2,
    /// The next byte of the ring to be taken.
    next: usize,
    spare: [Option<DmaPlace>; PLACES],
    /// In their order; never more than there are places.
    waiting: [Option<Made<DmaPlace>>; PLACES],
    sending: Option<DmaPlace>,
}

impl Link {
    /// Receives from now on.
    pub fn new(
        usart: &USART6,
        dma: DMA2,
        (sends, receives): (PC6, PC7),
        places: [DmaPlace; PLACES],
        rcc: &mut Rcc,
    ) -> Self {
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
            spare: places.map(Some),
            waiting: [const { None }; PLACES],
            sending: None,
        }
    }

    /// The task that the end of a frame has started has begun: if a frame
    /// waits, it goes now.
    pub fn acknowledge(&mut self) {
        self.dma.hifcr().write(|w| w.ctcif6().clear());
        self.go_on();
    }

    /// Bytes that have been received and not taken: 2,047 at most.
    pub fn received(&self) -> usize {
        let left = usize::from(self.dma.st(RECEIVE).ndtr().read().ndt().bits());
        let end = RING_BYTES.wrapping_sub(left);
        end.wrapping_sub(self.next) % RING_BYTES
    }

    /// Takes one of them.
    pub fn take_byte(&mut self) -> Option<u8> {
        let byte = RING.get(self.next)?.load(Ordering::Relaxed);
        self.next = (self.next + 1) % RING_BYTES;
        Some(byte)
    }

    /// A place for the next frame, if there is one.
    pub fn spare(&mut self) -> Option<DmaPlace> {
        self.spare.iter_mut().find_map(Option::take)
    }

    /// Whether there is a place.
    pub fn can_send(&self) -> bool {
        self.spare.iter().any(Option::is_some)
    }

    /// Sends a copy of a frame, if there is a place.
    pub fn send_copy(&mut self, frame: &Frame) {
        if let Some(place) = self.spare() {
            if let Some(bytes) = place.get_mut(..frame.len()) {
                bytes.copy_from_slice(frame);
            }
            let length = frame.len();
            self.send(Made { place, length });
        }
    }

    /// Sends a frame once those before have gone.
    pub fn send(&mut self, frame: Made<DmaPlace>) {
        put(&mut self.waiting, frame);
        self.go_on();
    }

    /// Starts what waits, if nothing is on its way.
    fn go_on(&mut self) {
        let is_sending = self.dma.st(SEND).cr().read().en().is_enabled();
        if is_sending {
            return;
        }
        if let Some(sent) = self.sending.take() {
            put(&mut self.spare, sent);
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
        let place = raw::dma_place(stream, frame.place);
        stream.ndtr().write(|w| w.ndt().set(length(frame.length)));
        // The bytes are there before the stream reads them.
        fence(Ordering::SeqCst);
        stream.cr().modify(|_, w| w.en().enabled());
        self.sending = Some(place);
    }
}

/// Behind those that are there.
fn put<T>(slots: &mut [Option<T>; PLACES], one_more: T) {
    if let Some(free) = slots.iter_mut().find(|free| free.is_none()) {
        *free = Some(one_more);
    }
}

fn length(bytes: usize) -> u16 {
    u16::try_from(bytes).unwrap_or(u16::MAX)
}
