//! Both implementations of the flash interface, over random reads.

use crate::reference_flash::ReferenceFlash;
use crepitus_emulator::flash_interface::{FlashInterface, Kind};

const READS: u64 = 200_000;

/// A generator of numbers (Knuth's MMIX).
struct Random(u64);

impl Random {
    fn below(&mut self, end: u32) -> u32 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        u32::try_from(self.0 >> 33).unwrap() % end
    }
}

#[test]
fn two_implementations_wait_alike() {
    for register in (0..8).flat_map(|bits| [1, 3, 5, 7].map(|latency| bits << 8 | latency)) {
        let mut random = Random(u64::from(register));
        let mut model = FlashInterface::default();
        model.set_register(register);
        let mut reference = ReferenceFlash::new(register);
        let (mut at, mut pc, mut sum) = (0, 0, 0);
        for read in 0..READS {
            let (kind, offset) = if random.below(8) == 0 {
                (Kind::Data, 16 * random.below(12) + 0x4000)
            } else {
                // Some 80 lines, more of them in the first half.
                pc = match random.below(12) {
                    0 => 16 * random.below(80),
                    1 => 16 * random.below(40) + 2 * random.below(8),
                    _ => pc + 2,
                };
                (Kind::Instruction, pc)
            };
            let waits = model.read(kind, offset, at);
            let expected = reference.read(kind, offset, at);
            assert_eq!(waits, expected, "{register:#x}: {kind:?} number {read}");
            at += waits + u64::from(random.below(4));
            sum += waits;
        }
        assert!(sum > READS / 20, "{register:#x}: {sum}");
    }
}
