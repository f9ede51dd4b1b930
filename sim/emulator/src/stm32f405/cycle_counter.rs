//! Loads of the core's cycle counter: where a program measures itself.

use rsemu::cpu::arm::v7m::ArmV7m;

/// `DWT_CYCCNT`.
const CYCCNT: u32 = 0xe000_1004;

/// The address of a load of a word by the instruction of these half words; `None` if it is none of
/// those that a compiler makes for a register.
fn loaded(first: u32, second: u32, register: impl Fn(u32) -> u32) -> Option<u32> {
    let low = |place: u32| register(first >> place & 7);
    let base = register(first & 15);
    match (first, second) {
        // LDR Rt, [Rn, #imm5]
        (0x6800..=0x6fff, _) => Some(low(3).wrapping_add((first >> 6 & 31) * 4)),
        // LDR Rt, [Rn, Rm]
        (0x5800..=0x59ff, _) => Some(low(3).wrapping_add(low(6))),
        // LDR.W Rt, [Rn, #imm12]
        (0xf8d0..=0xf8df, _) => Some(base.wrapping_add(second & 0xfff)),
        // LDR.W Rt, [Rn, Rm, LSL #imm2]
        (0xf850..=0xf85f, _) if second & 0xfc0 == 0 => {
            Some(base.wrapping_add(register(second & 15) << (second >> 4 & 3)))
        }
        // LDR.W Rt, [Rn, #-imm8]
        (0xf850..=0xf85f, _) if second & 0xf00 == 0xc00 => Some(base.wrapping_sub(second & 0xff)),
        _ => None,
    }
}

/// Returns whether the core's next instruction loads the counter.
pub(super) fn is_read(core: &ArmV7m, peek: impl Fn(u32) -> Option<u32>) -> bool {
    let Some(words) = peek(core.pc()) else {
        return false;
    };
    let register = |number: u32| u8::try_from(number).map_or(0, |number| core.reg(number));
    loaded(words & 0xffff, words >> 16, register) == Some(CYCCNT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_way_to_load_it_is_recognised() {
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
            let address = loaded(first, second, with(base, index));
            assert_eq!(address, Some(CYCCNT), "{first:04x} {second:04x}");
        }
        // A store, and a load of a byte.
        assert_eq!(loaded(0x6048, 0, with(0xe000_1000, 0)), None);
        assert_eq!(loaded(0x7908, 0, with(0xe000_1000, 0)), None);
    }
}
