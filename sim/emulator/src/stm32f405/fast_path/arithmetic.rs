//! Arithmetic of plain instructions.

use rsemu::cpu::arm::v7m::isa::{ShiftType, Size};

/// First of the addresses that are, when branched to, a return from an exception.
const EXCEPTION_RETURNS: u32 = 0xf000_0000;

pub(super) fn it_state(xpsr: u32) -> u8 {
    let [_, high, _, top] = xpsr.to_le_bytes();
    high & 0xfc | top >> 1 & 3
}

/// Returns whether a value that is branched to is an address of code, and neither a return
/// from an exception nor a fault.
pub(super) fn is_jump(address: u32) -> bool {
    address & 1 == 1 && address < EXCEPTION_RETURNS
}

pub(super) fn offset(base: u32, by: u32, is_added: bool) -> u32 {
    if is_added {
        base.wrapping_add(by)
    } else {
        base.wrapping_sub(by)
    }
}

#[expect(clippy::cast_possible_truncation, reason = "that is what it does")]
pub(super) fn low_word(value: u64) -> u32 {
    value as u32
}

/// Result, carry and overflow.
pub(super) fn sum(a: u32, b: u32, carry: bool) -> (u32, bool, bool) {
    let wide = u64::from(a) + u64::from(b) + u64::from(carry);
    let result = low_word(wide);
    let overflow = ((a ^ result) & (b ^ result)) >> 31 == 1;
    (result, wide >> 32 == 1, overflow)
}

#[expect(clippy::cast_possible_truncation, reason = "that is what it does")]
pub(super) fn extended(value: u32, size: Size, signed: bool) -> u32 {
    match (size, signed) {
        (Size::Byte, false) => value & 0xff,
        (Size::Byte, true) => i32::from((value as u8).cast_signed()).cast_unsigned(),
        (Size::Half, false) => value & 0xffff,
        (Size::Half, true) => i32::from((value as u16).cast_signed()).cast_unsigned(),
        (Size::Word, _) => value,
    }
}

/// A value shifted by 0 to 255, and the carry.
pub(super) fn shift(ty: ShiftType, amount: u32, value: u32, carry: bool) -> (u32, bool) {
    if amount == 0 {
        return (value, carry);
    }
    let bit = |number: u32| value.checked_shr(number).unwrap_or(0) & 1 == 1;
    match ty {
        ShiftType::Lsl => {
            let last = 32_u32.checked_sub(amount);
            (
                value.checked_shl(amount).unwrap_or(0),
                last.is_some_and(bit),
            )
        }
        ShiftType::Lsr => (value.checked_shr(amount).unwrap_or(0), bit(amount - 1)),
        ShiftType::Asr => {
            let amount = amount.min(32);
            let shifted = i64::from(value.cast_signed()) >> amount;
            (low_word(shifted.cast_unsigned()), bit(amount - 1))
        }
        ShiftType::Ror => {
            let result = value.rotate_right(amount % 32);
            (result, result >> 31 == 1)
        }
        ShiftType::Rrx => (u32::from(carry) << 31 | value >> 1, bit(0)),
    }
}
