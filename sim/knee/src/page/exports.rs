//! Functions that a page calls. Columns are addresses in its memory, of [`ROOM`](super::ROOM) numbers each,
//! or a number for each sign.
#![allow(
    unsafe_code,
    reason = "names that a page can call, and the one knee that it has"
)]

use super::{Columns, Findings, Page};
use core::panic::PanicInfo;
use crepitus_protocol::ValueError;

static mut PAGE: Page = Page::new();

/// Runs `work` with the page's knee.
fn with<R>(work: impl FnOnce(&mut Page) -> R) -> R {
    let page = &raw mut PAGE;
    // SAFETY: a page has one thread, and no function here calls another one: nobody else holds a reference.
    work(unsafe { &mut *page })
}

/// Address of a column.
fn column<T>(of: impl FnOnce(&Columns) -> &[T]) -> *const T {
    with(|page| of(page.columns()).as_ptr())
}

/// Address of a column of findings.
fn of_findings<T>(of: impl FnOnce(&Findings) -> &[T]) -> *const T {
    with(|page| of(page.findings()).as_ptr())
}

/// 0, or 1 + the id of the parameter to change: 256 for a rule between several.
fn code(result: Result<(), ValueError>) -> u32 {
    match result {
        Ok(()) => 0,
        Err(error) => 1 + u32::from(error.parameters().first().copied().unwrap_or(u8::MAX)),
    }
}

/// Begins, also again: a healthy knee, straight, held by the hand. Returns 0.
#[unsafe(no_mangle)]
extern "C" fn begin() -> u32 {
    code(with(Page::begin))
}

/// Stages a value of a parameter. Returns 0, or 1 if there is no such id.
#[unsafe(no_mangle)]
extern "C" fn set(id: u32, value: f64) -> u32 {
    with(|page| u32::from(!page.set(id, value)))
}

/// Applies what is staged. Returns 0, or 1 + the id of the parameter that is refused: then nothing changes.
#[unsafe(no_mangle)]
extern "C" fn commit() -> u32 {
    code(with(Page::commit))
}

/// Moves the hand towards an angle, or lets go of the leg where `holds` is 0.
#[unsafe(no_mangle)]
extern "C" fn hand(angle_rad: f32, holds: u32) {
    with(|page| page.hand(angle_rad, holds != 0));
}

/// Advances by so many ticks of 50 µs. Returns the number of samples in the columns.
#[unsafe(no_mangle)]
extern "C" fn advance(ticks: u32) -> u32 {
    with(|page| page.advance(ticks))
}

/// Torque of the device.
#[unsafe(no_mangle)]
extern "C" fn torque_nm() -> *const f32 {
    column(|columns| &columns.torque_nm)
}

/// Angle of the knee.
#[unsafe(no_mangle)]
extern "C" fn angle_rad() -> *const f32 {
    column(|columns| &columns.angle_rad)
}

/// Velocity of the knee.
#[unsafe(no_mangle)]
extern "C" fn speed_rad_s() -> *const f32 {
    column(|columns| &columns.speed_rad_s)
}

/// Angle at which the hand wants the leg.
#[unsafe(no_mangle)]
extern "C" fn hand_rad() -> *const f32 {
    column(|columns| &columns.hand_rad)
}

/// Angle of the imaginary object.
#[unsafe(no_mangle)]
extern "C" fn object_rad() -> *const f32 {
    column(|columns| &columns.object_rad)
}

/// Torque of its spring.
#[unsafe(no_mangle)]
extern "C" fn spring_nm() -> *const f32 {
    column(|columns| &columns.spring_nm)
}

/// States of the symptoms.
#[unsafe(no_mangle)]
extern "C" fn states() -> *const u32 {
    column(|columns| &columns.states)
}

/// Phase of the imaginary object.
#[unsafe(no_mangle)]
extern "C" fn phase() -> *const u32 {
    column(|columns| &columns.phase)
}

/// Measures of the examination.
#[unsafe(no_mangle)]
extern "C" fn examination() -> *const f32 {
    with(|page| page.measures().as_ptr())
}

/// Number of the knee's signs, each with a row in the columns of findings.
#[unsafe(no_mangle)]
extern "C" fn findings() -> u32 {
    with(|page| page.findings().count)
}

/// Outcome of each sign: its place in [`OUTCOMES`](super::OUTCOMES).
#[unsafe(no_mangle)]
extern "C" fn outcomes() -> *const u32 {
    of_findings(|findings| &findings.outcomes)
}

/// Reached speed, angle or time of each sign.
#[unsafe(no_mangle)]
extern "C" fn reached() -> *const f32 {
    of_findings(|findings| &findings.reached)
}

/// Speed, angle or time that each sign takes.
#[unsafe(no_mangle)]
extern "C" fn needed() -> *const f32 {
    of_findings(|findings| &findings.needed)
}

/// Steps of the examination that were done, a bit each.
#[unsafe(no_mangle)]
extern "C" fn steps() -> u32 {
    with(|page| page.steps())
}

/// Ticks since `begin` in which a stick broke.
#[unsafe(no_mangle)]
extern "C" fn breaks() -> u32 {
    with(|page| page.breaks())
}

/// Ends the page's engine: the call of the page throws an error.
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}
