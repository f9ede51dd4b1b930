//! A stream of the DMA that is enabled with the flags of its last transfer (RM0090 10.5.5).

use crate::bench::Bench;
use crepitus_emulator::refusal::Refusal;

const AHB1ENR: u32 = 0x4002_3830;
const DMA2_CLOCK: u32 = 1 << 22;

const DMA2: u32 = 0x4002_6400;
const HISR: u32 = DMA2 + 0x04;
const HIFCR: u32 = DMA2 + 0x0c;

/// Registers of stream 6.
const CR: u32 = DMA2 + 0xa0;
const NDTR: u32 = CR + 0x04;
const PAR: u32 = CR + 0x08;
const M0AR: u32 = CR + 0x0c;

const RAM: u32 = 0x2000_0000;

/// Memory to memory, both addresses incremented.
const SETUP: u32 = 2 << 6 | 1 << 9 | 1 << 10;
const ENABLE: u32 = 1;

/// Flags of stream 6.
const ALL: u32 = 0x3d << 16;

fn begin(bench: &mut Bench) {
    bench.write(NDTR, 4);
    bench.write(CR, SETUP | ENABLE);
}

/// A stream that has copied four bytes.
fn copied() -> Bench {
    let mut bench = Bench::new();
    bench.set(AHB1ENR, DMA2_CLOCK);
    bench.write(RAM, 0x1234_5678);
    bench.write(PAR, RAM);
    bench.write(M0AR, RAM + 64);
    begin(&mut bench);
    bench.run_us(10);
    assert_eq!(bench.read(RAM + 64), 0x1234_5678);
    assert_eq!(bench.read(CR) & ENABLE, 0, "at its end");
    assert_ne!(bench.read(HISR) & ALL, 0);
    assert_eq!(bench.0.refusal(), None);
    bench
}

#[test]
fn a_stream_whose_flags_are_cleared_starts_again() {
    let mut bench = copied();
    bench.write(HIFCR, ALL);
    begin(&mut bench);
    bench.run_us(10);
    assert_eq!(bench.0.refusal(), None);
}

#[test]
fn a_stream_with_one_flag_left_stops_the_core() {
    // Half of the transfer, its end, each alone.
    for left in [1 << 20, 1 << 21] {
        let mut bench = copied();
        bench.write(HIFCR, ALL & !left);
        // As it is enabled, not as it is set up.
        bench.write(CR, SETUP);
        assert_eq!(bench.0.refusal(), None);
        begin(&mut bench);
        let refusal = bench.0.refusal().expect("refused");
        let (controller, stream, flags) = (2, 6, left >> 16);
        let expected = Refusal::StreamFlags {
            controller,
            stream,
            flags,
        };
        assert_eq!(refusal, expected);
        let text = refusal.to_string();
        assert!(text.contains("stream 6 of DMA2"), "{text}");
    }
}
