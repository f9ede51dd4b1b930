//! All `unsafe` code of the boards, but for the entries of [`exceptions`](crate::exceptions).
//!
//! | what | why it is sound |
//! |---|---|
//! | [`record_words`], [`store_record_words`] | words that the start-up code leaves alone; any bits are a `u32`; accessed as a whole, by `init` before there are tasks, or by a function that never returns |
//! | [`CRASH`], [`LAST_TICKS`] | words that the start-up code leaves alone; atomic, so that any bits are a `u32`; what they say is checked by a checksum |
//! | [`image`] | symbols of the linker script around the program in flash, which is not written while it runs |
//! | [`outputs_off`] | called when nothing else runs any more; only switches off outputs, and the MPU that protects them |
//! | [`mpu_region`], [`mpu_attributes`], [`mpu_control`] | change no memory; an access that is forbidden faults, and never returns |
//! | [`dma_register`], [`dma_destination`] | the stream writes a `'static` buffer of atomic bytes in RAM that DMA reaches, within the length that `link.rs` sets |
//! | [`dma_source`] | the stream reads a buffer that `link.rs` owns and keeps until the stream is done, in RAM that DMA reaches, within its length |
//! | [`converter_channel`], [`injected_channel`], [`converter_sampling`] | a channel that the converter has, at most four times, and one of its eight sampling times |
//! | [`crystal_to_timer`] | a value of the option register that the manual has |
//! | [`sleep`] | the assembly declares that the FPU's registers are lost |
//! | [`set_cycle_count`] | a number, by which only the tasks' times are measured |
//! | [`paint_stack`] | the stack's RAM below its pointer, which nobody has: interrupts are disabled, and the function calls none |
//! | [`stack`], [`fault_registers`] | words of the stack's RAM, and registers whose reading has no effect |
#![allow(unsafe_code)]

use crate::crash_record::{CheckedRecord, Ring, empty_ring};
use crate::enable_line;
use crate::reset_record;
use core::mem::MaybeUninit;
use core::sync::atomic::AtomicU8;
use cortex_m::peripheral::{MPU, SCB};
use crepitus_protocol::frame::FrameBuffer;
use stm32f4xx_hal::pac;

/// The reset record, in a section that is neither cleared nor loaded.
#[unsafe(link_section = ".uninit.kept")]
static mut RECORD: MaybeUninit<[u32; reset_record::WORDS]> = MaybeUninit::uninit();

/// Reads the words that survive a reset; undefined after power was off.
pub(crate) fn record_words() -> [u32; reset_record::WORDS] {
    // SAFETY: see the table.
    unsafe {
        (&raw const RECORD)
            .cast::<[u32; reset_record::WORDS]>()
            .read_volatile()
    }
}

/// Stores words for the next start.
pub(crate) fn store_record_words(words: [u32; reset_record::WORDS]) {
    // SAFETY: see the table.
    unsafe {
        (&raw mut RECORD)
            .cast::<[u32; reset_record::WORDS]>()
            .write_volatile(words);
    }
}

/// The post-mortem record.
#[unsafe(link_section = ".uninit.crash")]
pub(crate) static CRASH: CheckedRecord = CheckedRecord::empty();

/// The last ticks.
#[unsafe(link_section = ".uninit.ticks")]
pub(crate) static LAST_TICKS: Ring = empty_ring();

/// Bytes of flash that hold the vector table.
const VECTOR_BYTES: usize = 512;

unsafe extern "C" {
    static __vector_table: u8;
    static __stext: u8;
    static __sidata: u8;
    static __sdata: u8;
    static __edata: u8;
}

/// The beginning of flash, with the vector table.
pub(crate) fn vectors() -> &'static [u8; VECTOR_BYTES] {
    // SAFETY: see the table.
    unsafe { &*(&raw const __vector_table).cast() }
}

/// The program in flash: code, constants, and initial values.
pub(crate) fn image() -> &'static [u8] {
    // SAFETY: see the table.
    unsafe {
        let begin = &raw const __stext;
        let data_bytes = (&raw const __edata).addr() - (&raw const __sdata).addr();
        let end = (&raw const __sidata).addr() + data_bytes;
        core::slice::from_raw_parts(begin, end - begin.addr())
    }
}

/// Switches enable line, bridge and coil off. The line has the same pin on both
/// boards; comms has neither of the others, and the clocks of their timers are off: there
/// these writes have no effect.
pub(crate) fn outputs_off() {
    // SAFETY: see the table.
    let (gpio, timer, coil, mpu) = unsafe {
        let core = cortex_m::Peripherals::steal();
        (
            pac::GPIOB::steal(),
            pac::TIM1::steal(),
            pac::TIM8::steal(),
            core.MPU,
        )
    };
    mpu_control(&mpu, 0);
    gpio.bsrr().write(|w| w.br(enable_line::PIN).set_bit());
    timer.bdtr().modify(|_, w| w.moe().clear_bit());
    coil.bdtr().modify(|_, w| w.moe().clear_bit());
}

/// Sets a region of the MPU, and selects it.
pub(crate) fn mpu_region(mpu: &MPU, address: u32, attributes: u32) {
    // SAFETY: see the table.
    unsafe { mpu.rbar.write(address) };
    mpu_attributes(mpu, attributes);
}

/// Sets the attributes of the selected region of the MPU, for all accesses that
/// follow.
pub(crate) fn mpu_attributes(mpu: &MPU, attributes: u32) {
    // SAFETY: see the table.
    unsafe { mpu.rasr.write(attributes) };
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Switches the MPU on or off, for all accesses that follow.
pub(crate) fn mpu_control(mpu: &MPU, control: u32) {
    // SAFETY: see the table.
    unsafe { mpu.ctrl.write(control) };
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Sets the register that a DMA stream serves.
pub(crate) fn dma_register(stream: &pac::dma2::ST, register: *const u16) {
    // SAFETY: see the table.
    unsafe { stream.par().write(|w| w.bits(address(register.addr()))) };
}

/// Sets the frame that a DMA stream sends. The caller must keep the returned
/// buffer, and not access it, until the stream is done.
pub(crate) fn dma_source(
    stream: &pac::dma2::ST,
    buffer: &'static mut FrameBuffer,
) -> &'static mut FrameBuffer {
    let begin = address(buffer.as_mut_ptr().expose_provenance());
    // SAFETY: see the table.
    unsafe { stream.m0ar().write(|w| w.bits(begin)) };
    buffer
}

/// Sets the bytes that a DMA stream fills.
pub(crate) fn dma_destination(stream: &pac::dma2::ST, bytes: &'static [AtomicU8]) {
    let begin = address(bytes.as_ptr().addr());
    // SAFETY: see the table.
    unsafe { stream.m0ar().write(|w| w.bits(begin)) };
}

fn address(address: usize) -> u32 {
    u32::try_from(address).unwrap_or_default()
}

/// Connects the divided crystal to the first input of TIM11.
pub(crate) fn crystal_to_timer(timer: &pac::TIM11) {
    // SAFETY: see the table.
    timer.or().write(|w| unsafe { w.rmp().bits(0b10) });
}

/// Sets the sampling time of a channel after a reset, by its code.
pub(crate) fn converter_sampling(converter: &pac::adc1::RegisterBlock, channel: u8, code: u8) {
    let time = u32::from(code & 7) << (3 * (channel % 10));
    // SAFETY: see the table.
    if channel < 10 {
        let register = converter.smpr2();
        register.modify(|r, w| unsafe { w.bits(r.bits() | time) });
    } else {
        let register = converter.smpr1();
        register.modify(|r, w| unsafe { w.bits(r.bits() | time) });
    }
}

/// Selects the channel that is converted.
pub(crate) fn converter_channel(converter: &pac::adc1::RegisterBlock, channel: u8) {
    // SAFETY: see the table.
    converter.sqr3().write(|w| unsafe { w.sq1().bits(channel) });
}

/// Selects the channel of the injected group, which converts it so many times.
pub(crate) fn injected_channel(converter: &pac::adc1::RegisterBlock, channel: u8, conversions: u8) {
    // SAFETY: see the table. The group is the end of its list.
    converter.jsqr().write(|w| unsafe {
        w.jsq1().bits(channel).jsq2().bits(channel);
        w.jsq3().bits(channel).jsq4().bits(channel);
        w.jl().bits(conversions - 1)
    });
}

/// Sleeps until the next interrupt, which has no registers of the FPU to save: the
/// caller keeps nothing there. With them it would take 17 cycles to store and 18 to
/// load them, twice a tick.
pub fn sleep() {
    // SAFETY: see the table.
    unsafe {
        core::arch::asm!(
            "mrs {control}, control",
            "bic {control}, {control}, #4",
            "msr control, {control}",
            "isb",
            "wfi",
            control = out(reg) _,
            out("d0") _, out("d1") _, out("d2") _, out("d3") _,
            out("d4") _, out("d5") _, out("d6") _, out("d7") _,
            out("d8") _, out("d9") _, out("d10") _, out("d11") _,
            out("d12") _, out("d13") _, out("d14") _, out("d15") _,
        );
    }
}

/// Sets the core's cycle counter.
#[inline]
pub(crate) fn set_cycle_count(cycles: u32) {
    // SAFETY: see the table.
    unsafe { (*cortex_m::peripheral::DWT::PTR).cyccnt.write(cycles) };
}

/// The stack's RAM.
pub(crate) const STACK: core::ops::Range<u32> = 0x1000_0000..0x1001_0000;
const CCM: core::ops::Range<usize> = STACK.start as usize..STACK.end as usize;

/// Value of a word of the stack that was never written.
pub(crate) const PAINT: u32 = 0xcccc_cccc;

/// Distance of the paint from the stack's pointer, bytes.
const PAINT_DISTANCE: usize = 128;

/// Paints the stack below the pointer, before there are tasks.
#[inline(never)]
pub(crate) fn paint_stack() {
    let end = (cortex_m::register::msp::read() as usize).saturating_sub(PAINT_DISTANCE);
    for address in (CCM.start..end.min(CCM.end)).step_by(size_of::<u32>()) {
        let place = core::ptr::with_exposed_provenance_mut::<u32>(address);
        // SAFETY: see the table.
        unsafe { place.write_volatile(PAINT) };
    }
}

/// The stack's words from an address up; 0 where there is no stack.
pub(crate) fn stack<const N: usize>(begin: u32) -> [u32; N] {
    let mut address = begin as usize;
    [(); N].map(|()| {
        let place = core::ptr::with_exposed_provenance::<u32>(address);
        address = address.wrapping_add(size_of::<u32>());
        if CCM.contains(&place.addr()) && place.is_aligned() {
            // SAFETY: within the stack's RAM; any bits are a `u32`.
            unsafe { place.read_volatile() }
        } else {
            0
        }
    })
}

/// CFSR, HFSR, MMFAR, BFAR.
pub(crate) fn fault_registers() -> [u32; 4] {
    // SAFETY: see the table.
    let block = unsafe { &*SCB::PTR };
    [
        block.cfsr.read(),
        block.hfsr.read(),
        block.mmfar.read(),
        block.bfar.read(),
    ]
}
