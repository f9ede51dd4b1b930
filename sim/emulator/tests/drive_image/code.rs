//! Instructions that tests patch into an image.

/// `b .`
pub(crate) const FOREVER: u16 = 0xe7fe;

/// `bx lr`
pub(crate) const RETURN: u16 = 0x4770;

/// `movw register, #low` and `movt register, #high`
pub(crate) fn load(register: u16, value: u32) -> [u16; 4] {
    let immediate = |operation: u16, half: u32| {
        let half = u16::try_from(half & 0xffff).expect("16 bits");
        [
            operation | (half >> 11 & 1) << 10 | half >> 12,
            (half >> 8 & 7) << 12 | register << 8 | half & 0xff,
        ]
    };
    let [a, b] = immediate(0xf240, value);
    let [c, d] = immediate(0xf2c0, value >> 16);
    [a, b, c, d]
}

/// Stores `value` at `address`, by r0 and r1.
pub(crate) fn store(address: u32, value: u32) -> Vec<u16> {
    // `str r1, [r0]`
    [&load(0, address)[..], &load(1, value), &[0x6001]].concat()
}

/// Returns the instructions as they lie in flash.
pub(crate) fn bytes(instructions: &[u16]) -> Vec<u8> {
    let halves = instructions.iter();
    halves.flat_map(|half| half.to_le_bytes()).collect()
}
