//! Flash and its controller (RM0090 3.6, 3.9).

use crate::bench::Bench;
use crepitus_emulator::Reset;
use crepitus_emulator::refusal::Refusal;

const FLASH: u32 = 0x4002_3c00;
const KEYR: u32 = FLASH + 0x04;
const SR: u32 = FLASH + 0x0c;
const CR: u32 = FLASH + 0x10;

const PG: u32 = 1;
const SER: u32 = 1 << 1;
const WORDS: u32 = 2 << 8;
const STRT: u32 = 1 << 16;
const LOCK: u32 = 1 << 31;

const BSY: u32 = 1 << 16;
const PGSERR: u32 = 1 << 7;
const PGPERR: u32 = 1 << 6;

/// Address in sector 2, and the number of that sector, 2, in CR.
const PLACE: u32 = 0x0800_8000;
const SECTOR: u32 = 2 << 3;

fn unlocked() -> Bench {
    let mut bench = Bench::new();
    bench.write(KEYR, 0x4567_0123);
    bench.write(KEYR, 0xcdef_89ab);
    assert_eq!(bench.read(CR) & LOCK, 0);
    bench
}

fn erase(bench: &mut Bench) {
    bench.write(CR, SER | SECTOR | STRT);
}

#[test]
fn a_word_takes_sixteen_microseconds_and_only_clears_bits() {
    let mut bench = unlocked();
    bench.write(CR, PG | WORDS);
    bench.write(PLACE, 0xffff_0f0f);
    assert_eq!(bench.read(SR), BSY);
    bench.run_us(15);
    assert_eq!(bench.read(SR), BSY);
    bench.run_us(2);
    assert_eq!(bench.read(SR), 0);
    assert_eq!(bench.read(PLACE), 0xffff_0f0f);
    bench.write(PLACE, 0xf0f0_ffff);
    bench.run_us(20);
    assert_eq!(bench.read(PLACE), 0xf0f0_0f0f);
}

#[test]
fn a_sector_takes_four_tenths_of_a_second_and_its_neighbours_stay() {
    let mut bench = unlocked();
    for place in [PLACE - 4, PLACE, PLACE + 0x3ffc, PLACE + 0x4000] {
        bench.0.patch_flash(place, &[0; 4]);
    }
    erase(&mut bench);
    bench.run_us(399_000);
    assert_eq!(bench.read(SR), BSY);
    bench.run_us(2_000);
    assert_eq!(bench.read(SR), 0);
    let words = [PLACE - 4, PLACE, PLACE + 0x3ffc, PLACE + 0x4000];
    assert_eq!(
        words.map(|place| bench.read(place)),
        [0, u32::MAX, u32::MAX, 0]
    );
}

#[test]
fn without_keys_or_with_wrong_ones_nothing_is_written() {
    let mut bench = Bench::new();
    bench.write(CR, PG | WORDS);
    assert_eq!(bench.read(CR), LOCK);
    bench.write(PLACE, 0);
    assert_eq!(bench.read(SR), PGSERR);
    bench.write(SR, PGSERR);
    assert_eq!(bench.read(SR), 0);
    bench.write(KEYR, 1);
    bench.write(KEYR, 0x4567_0123);
    bench.write(KEYR, 0xcdef_89ab);
    assert_eq!(bench.read(CR), LOCK, "until the next reset");
    bench.0.reset(Reset::Pin);
    bench.0.set_hung(true);
    bench.write(KEYR, 0x4567_0123);
    bench.write(KEYR, 0xcdef_89ab);
    assert_eq!(bench.read(CR), 0);
    bench.write(CR, LOCK);
    bench.write(CR, PG | WORDS);
    assert_eq!(bench.read(CR), LOCK);
    bench.run_us(20);
    assert_eq!(bench.read(PLACE), u32::MAX);
}

#[test]
fn what_is_set_up_wrongly_is_an_error() {
    let mut bench = unlocked();
    // A byte at a time, and a word is written.
    bench.write(CR, PG);
    bench.write(PLACE, 0);
    assert_eq!(bench.read(SR), PGPERR);
    bench.write(SR, PGPERR);
    // Started without a sector, or one that is not there.
    bench.write(CR, STRT);
    assert_eq!(bench.read(SR), PGSERR);
    bench.write(SR, PGSERR);
    bench.write(CR, SER | 12 << 3 | STRT);
    assert_eq!(bench.read(SR), PGSERR);
    assert_eq!(bench.0.not_modelled(), [""; 0]);
    // Mass erase.
    bench.write(CR, 1 << 2 | STRT);
    assert_eq!(bench.0.not_modelled(), ["FLASH"]);
}

#[test]
fn an_erasure_that_is_cut_off_near_its_end_does_not_last() {
    let mut bench = unlocked();
    bench.0.patch_flash(PLACE, &[0x5a; 0x4000]);
    erase(&mut bench);
    bench.run_us(390_000);
    let blank = |bench: &mut Bench| {
        let mut words = (PLACE..PLACE + 0x4000).step_by(4);
        words.all(|place| bench.read(place) == u32::MAX)
    };
    bench.0.reset(Reset::PowerOn);
    bench.0.set_hung(true);
    assert_eq!(bench.read(SR), 0);
    assert!(blank(&mut bench), "at first");
    bench.0.reset(Reset::Pin);
    bench.0.set_hung(true);
    assert!(!blank(&mut bench));
    // Erased whole, it is blank for good.
    bench.write(KEYR, 0x4567_0123);
    bench.write(KEYR, 0xcdef_89ab);
    erase(&mut bench);
    bench.run_us(401_000);
    for _ in 0..3 {
        bench.0.reset(Reset::PowerOn);
        bench.0.set_hung(true);
        assert!(blank(&mut bench));
    }
}

const ACR: u32 = FLASH;
const DCEN: u32 = 1 << 10;
const DCRST: u32 = 1 << 12;

/// A sector with content, loaded through the data cache (or not), erased.
fn erased_after_a_load(dcen: u32) -> Bench {
    let mut bench = unlocked();
    bench.0.patch_flash(PLACE, &[0x5a; 32]);
    bench.write(ACR, dcen);
    bench.read(PLACE + 4);
    erase(&mut bench);
    bench.run_us(401_000);
    assert_eq!(bench.0.refusal(), None);
    bench
}

#[test]
fn a_load_from_a_line_that_is_older_than_the_erasure_stops_the_core() {
    let mut bench = erased_after_a_load(DCEN);
    // Another line, which the cache cannot hold.
    bench.read(PLACE + 16);
    assert_eq!(bench.0.refusal(), None);
    bench.read(PLACE + 12);
    let address = PLACE + 12;
    let refusal = Refusal::StaleData { address };
    assert_eq!(bench.0.refusal(), Some(refusal));
    let text = refusal.to_string();
    assert!(text.contains("0x0800800c"), "{text}");
    // For good.
    bench.0.reset(Reset::Pin);
    assert_eq!(bench.0.refusal(), Some(refusal));
    let (before, pc) = (bench.0.cycles(), bench.0.program_counter());
    bench.run_us(100);
    assert_eq!((bench.0.cycles(), bench.0.program_counter()), (before, pc));
}

#[test]
fn what_is_not_in_the_cache_is_not_stale() {
    let mut off = erased_after_a_load(0);
    off.write(ACR, DCEN);
    off.read(PLACE);
    assert_eq!(off.0.refusal(), None, "never enabled");
    let mut disabled = erased_after_a_load(DCEN);
    disabled.write(ACR, 0);
    disabled.read(PLACE);
    assert_eq!(disabled.0.refusal(), None, "disabled");
    let mut reset = erased_after_a_load(DCEN);
    for acr in [0, DCRST, 0, DCEN] {
        reset.write(ACR, acr);
    }
    reset.read(PLACE);
    assert_eq!(reset.0.refusal(), None, "reset");
    // Programming writes the cache, too: just the bytes that are programmed.
    let mut programmed = erased_after_a_load(DCEN);
    programmed.write(CR, PG | WORDS);
    programmed.write(PLACE, 0x1234_5678);
    programmed.run_us(20);
    programmed.read(PLACE);
    assert_eq!(programmed.0.refusal(), None, "programmed");
    programmed.read(PLACE + 4);
    assert!(programmed.0.refusal().is_some());
}

#[test]
fn the_cache_is_reset_only_while_it_is_disabled() {
    let mut bench = unlocked();
    bench.write(ACR, DCEN | DCRST);
    let refusal = Refusal::CacheResetWhileEnabled;
    assert_eq!(bench.0.refusal(), Some(refusal));
    assert!(refusal.to_string().contains("clear DCEN first"));
}
