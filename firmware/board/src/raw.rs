//! All that the compiler cannot check, in one place.
//!
//! | what | why it is right |
//! |---|---|
//! | [`kept_words`], [`keep_words`] | words that the start-up code leaves alone; any bits are a `u32`; read and written whole, by `init` before there are tasks, or by who never returns |
//! | [`image`] | symbols of the linker script around the program in flash, which nobody writes while it runs |
//! | [`outputs_off`] | called where nothing else runs any more; only ever switches off |
//! | [`dma_register`], [`dma_bytes`] | the stream writes a `'static` buffer of atomic bytes in RAM that DMA reaches, within the length that `link.rs` gives it |
//! | [`dma_place`] | the stream reads a place that `link.rs` owns and keeps until the stream is done, in RAM that DMA reaches, within it |
//! | [`converter_channel`] | a channel that the converter has |
//! | `HardFault` | the stack may be of no use, so it begins anew; it never returns |
#![allow(unsafe_code)]

use crate::enable_line;
use crate::kept::{Reason, WORDS};
use crate::link::DmaPlace;
use crate::stop::stop;
use core::mem::MaybeUninit;
use core::sync::atomic::AtomicU8;
use stm32f4xx_hal::pac;

/// In a section that is neither cleared nor loaded.
#[unsafe(link_section = ".uninit.kept")]
static mut KEPT: MaybeUninit<[u32; WORDS]> = MaybeUninit::uninit();

/// The words that outlive a reset; after power was off, anything.
pub(crate) fn kept_words() -> [u32; WORDS] {
    // SAFETY: see the table.
    unsafe { (&raw const KEPT).cast::<[u32; WORDS]>().read_volatile() }
}

/// Leaves words for the next start.
pub(crate) fn keep_words(words: [u32; WORDS]) {
    // SAFETY: see the table.
    unsafe { (&raw mut KEPT).cast::<[u32; WORDS]>().write_volatile(words) }
}

unsafe extern "C" {
    static __stext: u8;
    static __sidata: u8;
    static __sdata: u8;
    static __edata: u8;
}

/// The program in flash: code, constants, and what variables begin with.
pub(crate) fn image() -> &'static [u8] {
    // SAFETY: see the table.
    unsafe {
        let begin = &raw const __stext;
        let data_bytes = (&raw const __edata).addr() - (&raw const __sdata).addr();
        let end = (&raw const __sidata).addr() + data_bytes;
        core::slice::from_raw_parts(begin, end - begin.addr())
    }
}

/// Enable line and bridge off. The line has the same pin on both boards; comms
/// has no bridge, and its timer's clock is off: there the write does nothing.
pub(crate) fn outputs_off() {
    // SAFETY: see the table.
    let (gpio, timer) = unsafe { (pac::GPIOB::steal(), pac::TIM1::steal()) };
    gpio.bsrr().write(|w| w.br(enable_line::PIN).set_bit());
    timer.bdtr().modify(|_, w| w.moe().clear_bit());
}

/// Tells a DMA stream which register it serves.
pub(crate) fn dma_register(stream: &pac::dma2::ST, register: *const u16) {
    // SAFETY: see the table.
    unsafe { stream.par().write(|w| w.bits(address(register.addr()))) };
}

/// Tells a DMA stream where the frame is that it sends. Whoever calls keeps the
/// place, and leaves it alone, until the stream is done.
pub(crate) fn dma_place(stream: &pac::dma2::ST, place: DmaPlace) -> DmaPlace {
    let begin = address(place.as_mut_ptr().expose_provenance());
    // SAFETY: see the table.
    unsafe { stream.m0ar().write(|w| w.bits(begin)) };
    place
}

/// Tells a DMA stream which bytes it fills.
pub(crate) fn dma_bytes(stream: &pac::dma2::ST, bytes: &'static [AtomicU8]) {
    let begin = address(bytes.as_ptr().addr());
    // SAFETY: see the table.
    unsafe { stream.m0ar().write(|w| w.bits(begin)) };
}

fn address(address: usize) -> u32 {
    u32::try_from(address).unwrap_or_default()
}

/// The one channel that is converted.
pub(crate) fn converter_channel(converter: &pac::ADC1, channel: u8) {
    // SAFETY: see the table.
    converter.sqr3().write(|w| unsafe { w.sq1().bits(channel) });
}

/// Where the processor ends up when it cannot go on, at a stack overflow above
/// all.
#[unsafe(naked)]
#[unsafe(no_mangle)]
#[allow(non_snake_case, reason = "the vector's name")]
extern "C" fn HardFault() -> ! {
    core::arch::naked_asm!(
        "mrs r0, msp",
        "movw r1, #:lower16:_stack_start",
        "movt r1, #:upper16:_stack_start",
        "msr msp, r1",
        "b {fault}",
        fault = sym fault,
    )
}

/// The stack's RAM.
const CCM: core::ops::Range<usize> = 0x1000_0000..0x1001_0000;

extern "C" fn fault(frame: *const u32) -> ! {
    outputs_off();
    let program_counter = frame.wrapping_add(6);
    let detail = if CCM.contains(&program_counter.addr()) && program_counter.is_aligned() {
        // SAFETY: within the stack's RAM; any bits are a `u32`.
        unsafe { program_counter.read_volatile() }
    } else {
        0
    };
    stop(Reason::Fault, detail)
}

#[cortex_m_rt::exception]
unsafe fn DefaultHandler(number: i16) -> ! {
    stop(Reason::Unhandled, u32::from(number.unsigned_abs()))
}
