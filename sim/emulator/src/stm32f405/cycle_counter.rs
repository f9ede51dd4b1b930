//! Accesses to the core's cycle counter: where a program measures itself.

use crate::mcu::CounterAccess;
use rsemu::cpu::arm::v7m::ArmV7m;

/// `DWT_CYCCNT`.
const CYCCNT: u32 = 0xe000_1004;

/// Bits of the first half word by which a load differs from a store of the same form.
const SHORT_LOAD: u32 = 0x0800;
const LONG_LOAD: u32 = 0x0010;

/// The load or store of a word by the instruction of these half words, and its address; `None` if it is
/// none of those that a compiler makes for a register.
fn accessed(
    first: u32,
    second: u32,
    register: impl Fn(u32) -> u32,
) -> Option<(CounterAccess, u32)> {
    let low = |place: u32| register(first >> place & 7);
    let base = register(first & 15);
    let by = |load: u32| match first & load {
        0 => CounterAccess::Store,
        _ => CounterAccess::Load,
    };
    match (first, second) {
        // LDR, STR Rt, [Rn, #imm5]
        (0x6000..=0x6fff, _) => Some((by(SHORT_LOAD), low(3).wrapping_add((first >> 6 & 31) * 4))),
        // LDR, STR Rt, [Rn, Rm]
        (0x5000..=0x51ff | 0x5800..=0x59ff, _) => {
            Some((by(SHORT_LOAD), low(3).wrapping_add(low(6))))
        }
        // LDR.W, STR.W Rt, [Rn, #imm12]
        (0xf8c0..=0xf8df, _) => Some((by(LONG_LOAD), base.wrapping_add(second & 0xfff))),
        // LDR.W, STR.W Rt, [Rn, Rm, LSL #imm2]
        (0xf840..=0xf85f, _) if second & 0xfc0 == 0 => Some((
            by(LONG_LOAD),
            base.wrapping_add(register(second & 15) << (second >> 4 & 3)),
        )),
        // LDR.W, STR.W Rt, [Rn, #-imm8]
        (0xf840..=0xf85f, _) if second & 0xf00 == 0xc00 => {
            Some((by(LONG_LOAD), base.wrapping_sub(second & 0xff)))
        }
        _ => None,
    }
}

/// The access of the core's next instruction to the counter.
pub(super) fn access(core: &ArmV7m, peek: impl Fn(u32) -> Option<u32>) -> Option<CounterAccess> {
    let words = peek(core.pc())?;
    let register = |number: u32| u8::try_from(number).map_or(0, |number| core.reg(number));
    accessed(words & 0xffff, words >> 16, register)
        .filter(|(_, address)| *address == CYCCNT)
        .map(|(access, _)| access)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_way_to_load_or_store_it_is_recognised() {
        // By r1, with r2 as index.
        let with = |base: u32, index: u32| {
            move |number: u32| match number {
                1 => base,
                2 => index,
                _ => 0,
            }
        };
        for (first, second, base, index) in [
            (0x6848, 0, 0xe000_1000, 0),
            (0x6808, 0, 0xe000_1004, 0),
            (0x5888, 0, 0xe000_1000, 4),
            (0xf8d1, 0x0004, 0xe000_1000, 0),
            (0xf851, 0x0022, 0xe000_1000, 1),
            (0xf851, 0x0c04, 0xe000_1008, 0),
        ] {
            let load = accessed(first, second, with(base, index));
            let of = |access| Some((access, CYCCNT));
            assert_eq!(load, of(CounterAccess::Load), "{first:04x} {second:04x}");
            let bit = if first < 0x8000 {
                SHORT_LOAD
            } else {
                LONG_LOAD
            };
            let store = accessed(first & !bit, second, with(base, index));
            assert_eq!(store, of(CounterAccess::Store), "{first:04x} {second:04x}");
        }
        // A load of a byte, and of a half word.
        assert_eq!(accessed(0x7908, 0, with(0xe000_1000, 0)), None);
        assert_eq!(accessed(0x8888, 0, with(0xe000_1000, 0)), None);
    }
}
