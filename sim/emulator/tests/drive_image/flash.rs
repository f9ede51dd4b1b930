//! The drive's image with the modelled flash.

use crate::host::{Flash, Host, examination, image, scene};
use crate::reference_flash::ReferenceFlash;
use crepitus_emulator::flash_interface::{FlashRead, Kind};
use crepitus_emulator::image::FLASH;
use crepitus_emulator::mcu::{Step, Watch};
use crepitus_protocol::State;
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::host::{Answer, Counters, Operation};
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, SampleFlags};

/// `FLASH_ACR`, and its value: 5 wait states, prefetch, both caches.
const REGISTER: u32 = 0x4002_3c00;
const SETTINGS: u32 = 0x705;

fn under_torque() -> Option<Host> {
    let scene = scene("[effects.bone-shaping]");
    let mut host = Host::timed(&image()?, &scene, &[], Flash::Modelled);
    host.arm();
    host.run_until_torque();
    Some(host)
}

#[test]
fn the_image_enables_prefetch_and_both_caches() {
    let Some(image) = image() else { return };
    let host = Host::new(&image, &examination());
    assert_eq!(host.board.mcu().peek(REGISTER), Some(SETTINGS));
}

#[test]
fn it_arms_and_no_sample_is_late_lost_or_dropped() {
    let Some(mut host) = under_torque() else {
        return;
    };
    assert_eq!(host.board.mcu().peek(REGISTER), Some(SETTINGS));
    // The drive's link may have begun in the middle of a frame.
    let Ok(Answer::Counters(before)) = host.ask(Operation::Counters) else {
        panic!("no counters");
    };
    assert!(before.drive[DriveCounter::Discarded.index()] <= 1);
    host.blocks.clear();
    host.run(10_000);
    assert!(host.board.is_driven());
    assert_eq!(host.board.comms().comms().state(), State::Armed);
    assert!(host.blocks.len() * BLOCK_SAMPLES >= 9_900);
    for pair in host.blocks.windows(2) {
        let ticks = pair[1].first_tick - pair[0].first_tick;
        assert_eq!(ticks, BLOCK_SAMPLES as u64);
        assert_eq!(pair[1].sequence, pair[0].sequence.wrapping_add(1));
    }
    let mut samples = host.blocks.iter().flat_map(|block| block.samples);
    assert!(samples.all(|sample| {
        let flags = sample.flags;
        flags.has(SampleFlags::ENERGISED) && !flags.has(SampleFlags::LATE | SampleFlags::LOST)
    }));
    let Ok(Answer::Counters(counters)) = host.ask(Operation::Counters) else {
        panic!("no counters");
    };
    for counter in [
        DriveCounter::Dropped,
        DriveCounter::Discarded,
        DriveCounter::StaleHeartbeats,
        DriveCounter::StaleCommands,
        DriveCounter::LostSamples,
        DriveCounter::LateTicks,
        DriveCounter::MissedCurrents,
        DriveCounter::Faults,
    ] {
        let counted = |counters: &Counters| counters.drive[counter.index()];
        assert_eq!(counted(&counters), counted(&before), "{counter:?}");
    }
    for counter in [
        CommsCounter::FromDriveDiscarded,
        CommsCounter::LostSamples,
        CommsCounter::DriveRestarts,
        CommsCounter::Faults,
    ] {
        let counted = |counters: &Counters| counters.comms[counter.index()];
        assert_eq!(counted(&counters), counted(&before), "{counter:?}");
    }
    assert!(host.board.resets().is_empty());
    assert_eq!(host.board.mcu().not_modelled(), [""; 0]);
    assert_eq!(host.ask(Operation::Disarm), Ok(Answer::Done));
    host.run(25);
    assert!(!host.board.drive_is_on());
}

/// Steps of the core: where each was, and its waits.
#[derive(Default)]
struct Steps(Vec<(u32, u64)>);

impl Watch for Steps {
    fn step(&mut self, step: &Step) {
        self.0.push((step.pc, step.waits.into()));
    }
}

/// Returns whether the instruction at an offset in flash has 32 bits.
fn is_wide(flash: &[u8], offset: u32) -> bool {
    flash[offset as usize + 1] >> 3 >= 0b11101
}

/// Fetches that these steps need: all but those of entries into exceptions, and
/// of a core that sleeps.
fn check_fetches(steps: &[(u32, u64)], reads: &[FlashRead], flash: &[u8]) {
    let fetched = reads.iter().filter(|read| read.kind == Kind::Instruction);
    let mut fetched = fetched.map(|read| read.offset).peekable();
    let mut instructions = 0;
    for (pc, _) in steps {
        let offset = pc - FLASH;
        if fetched.next_if_eq(&offset).is_some() {
            instructions += 1;
            if is_wide(flash, offset) {
                assert_eq!(fetched.next(), Some(offset + 2));
            }
        }
    }
    assert_eq!(fetched.next(), None, "after {instructions} instructions");
    assert!(instructions * 10 > steps.len() * 9);
}

#[test]
fn another_implementation_waits_alike() {
    let Some(image) = image() else { return };
    let Some(mut host) = under_torque() else {
        return;
    };
    let mcu = host.board.mcu_mut();
    mcu.clear_flash_caches();
    mcu.record_flash_reads();
    let mut steps = Steps::default();
    host.board.watch(200, &mut steps);
    let reads = host.board.mcu_mut().take_flash_reads();
    check_fetches(&steps.0, &reads, &image.flash);
    let mut reference = ReferenceFlash::new(SETTINGS);
    let mut waits = [0; 3];
    for (n, read) in reads.iter().enumerate() {
        let expected = reference.read(read.kind, read.offset, read.at);
        assert_eq!(read.waits, expected, "read {n}: {read:?}");
        waits[read.kind as usize] += read.waits;
    }
    let all: u64 = steps.0.iter().map(|(_, waits)| waits).sum();
    let [instructions, vectors, data] = waits.map(|waits| waits / 200);
    let registers = all / 200 - instructions - vectors - data;
    println!(
        "waits in a tick: {instructions} cycles for instructions, {vectors} for vectors, {data} for \
         data in flash, {registers} for registers (modelled flash)"
    );
    assert!(instructions > 300 && data > 10 && registers > 50 && vectors > 0);
}
