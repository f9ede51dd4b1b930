//! Both implementations of the flash interface, over random reads.

use crate::reference_flash::ReferenceFlash;
use crepitus_emulator::flash_interface::{FlashInterface, Kind};
use fastrand::Rng;

const READS: u64 = 200_000;

#[test]
fn two_implementations_wait_alike() {
    for register in (0..8).flat_map(|bits| [1, 3, 5, 7].map(|latency| bits << 8 | latency)) {
        let mut random = Rng::with_seed(u64::from(register));
        let mut model = FlashInterface::default();
        model.set_register(register);
        let mut reference = ReferenceFlash::new(register);
        let (mut at, mut pc, mut sum) = (0, 0, 0);
        for read in 0..READS {
            let (kind, offset) = if random.u32(..8) == 0 {
                (Kind::Data, 16 * random.u32(..12) + 0x4000)
            } else {
                // Some 80 lines, more of them in the first half.
                pc = match random.u32(..12) {
                    0 => 16 * random.u32(..80),
                    1 => 16 * random.u32(..40) + 2 * random.u32(..8),
                    _ => pc + 2,
                };
                (Kind::Instruction, pc)
            };
            let waits = model.read(kind, offset, at);
            let expected = reference.read(kind, offset, at);
            assert_eq!(waits, expected, "{register:#x}: {kind:?} number {read}");
            at += waits + random.u64(..4);
            sum += waits;
        }
        assert!(sum > READS / 20, "{register:#x}: {sum}");
    }
}
