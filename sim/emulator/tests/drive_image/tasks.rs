//! The four tasks: which interrupts which, and that none is late.

use crate::book::on_record;
use crate::host::{Flash, Host, examination, image, judged};
use crepitus_emulator::Time;
use crepitus_emulator::cycles::Cycles;
use crepitus_protocol::telemetry::SampleFlags;

/// Exceptions of the tasks, and their priority.
pub(crate) const SAMPLE: u16 = 16 + 30;
pub(crate) const COMMAND: u16 = 16 + 29;
pub(crate) const RENDER: u16 = 16 + 55;
pub(crate) const LINK: u16 = 16 + 69;
const PRIORITIES: [(u16, u8); 4] = [(SAMPLE, 5), (COMMAND, 4), (RENDER, 3), (LINK, 1)];

/// Units of time in a tick.
const TICK_UNITS: u64 = 16_800;

/// Limits of a run with the modelled flash, cycles: about 3 % above what was
/// measured, for `link` while a commit arrives.
const SAMPLE_CYCLES: u64 = 140;
const COMMAND_CYCLES: u64 = 2_315;
const RENDER_CYCLES: u64 = 1_375;
const LINK_CYCLES: u64 = 1_850;

/// Ticks that are watched.
const TICKS: u64 = 1_000;

fn priority(exception: u16) -> u8 {
    let found = PRIORITIES.iter().find(|(task, _)| *task == exception);
    found.unwrap_or_else(|| panic!("exception {exception}")).1
}

/// The interrupts that are enabled once the program runs, and their priorities, are those of
/// the table.
#[test]
fn the_tasks_are_these_four() {
    const NVIC_ISER: u32 = 0xe000_e100;
    const NVIC_IPR: u32 = 0xe000_e400;
    /// Interrupts of the chip.
    const INTERRUPTS: u32 = 82;
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    host.run(10);
    let mcu = host.board.mcu_mut();
    let word = |address: u32| mcu.peek(address).expect("a register of the core");
    let mut found = Vec::new();
    for interrupt in 0..INTERRUPTS {
        let is_enabled = word(NVIC_ISER + interrupt / 32 * 4) >> (interrupt % 32) & 1 == 1;
        if is_enabled {
            let level = word(NVIC_IPR + interrupt / 4 * 4) >> (interrupt % 4 * 8 + 4) & 0xf;
            let exception = 16 + u16::try_from(interrupt).expect("small");
            found.push((exception, u8::try_from(16 - level).expect("small")));
        }
    }
    let mut expected = PRIORITIES.to_vec();
    expected.sort_unstable();
    assert_eq!(found, expected);
}

#[test]
fn a_task_is_interrupted_by_higher_ones_only_and_every_tick_has_all() {
    let Some(image) = image() else { return };
    for flash in judged(Flash::BOTH) {
        let mut host = Host::timed(&image, &examination(), &[], flash);
        host.arm();
        host.run_until_torque();
        let mut cycles = Cycles::default();
        host.board.watch(20, &mut cycles);
        cycles.clear();
        host.board.watch(TICKS, &mut cycles);
        check(&cycles, flash);
    }
}

fn check(cycles: &Cycles, flash: Flash) {
    for ((below, above), count) in cycles.preemptions() {
        assert!(
            priority(*above) > priority(*below),
            "{below} by {above}, {count} times"
        );
    }
    for (name, exception, limit) in [
        ("sample_encoder", SAMPLE, SAMPLE_CYCLES),
        ("command_motor", COMMAND, COMMAND_CYCLES),
        ("render_torque", RENDER, RENDER_CYCLES),
        ("link", LINK, LINK_CYCLES),
    ] {
        let cost = cycles.costs()[&exception];
        let what = format!("`{name}`, armed with crepitus");
        let worst = cost.worst_cycles;
        on_record(&what, flash, Some(cost.mean_cycles()), worst);
        if exception != LINK {
            assert!(cost.calls.abs_diff(TICKS) <= 1, "{name}: {cost:?}");
        }
        assert!(cost.worst_cycles <= limit, "{name}: {cost:?}");
        assert_eq!(cost.waits > 0, flash == Flash::Modelled, "{name}: {cost:?}");
    }
}

#[test]
fn a_task_gives_way_at_once_to_a_higher_one() {
    let Some(image) = image() else { return };
    // In step no task meets another. So the core stands still, from so many ns
    // after the middle of a tick, where the board stops, until the next timer's
    // interrupt has come: then the second of these has interrupted the first.
    for (from_ns, until_ns, below, above) in [
        (25_700, 55_800, RENDER, COMMAND),
        (16_000, 25_400, LINK, SAMPLE),
    ] {
        let mut host = Host::new(&image, &examination());
        host.arm();
        host.run_until_torque();
        let mut cycles = Cycles::default();
        let mcu = host.board.mcu_mut();
        let begin = mcu.now().units();
        let after = |ns: u64| Time::from_units(begin + ns * 336 / 1_000);
        // Five times: some runs of `link` are over by then.
        for tick_ns in (0..5).map(|n| n * 100_000) {
            mcu.watch_until(after(tick_ns + from_ns), &mut cycles);
            mcu.set_hung(true);
            mcu.run_until(after(tick_ns + until_ns));
            mcu.set_hung(false);
            mcu.watch_until(after(tick_ns + until_ns + 20_000), &mut cycles);
        }
        let preemptions = cycles.preemptions();
        assert!(
            preemptions.contains_key(&(below, above)),
            "{below} by {above}: {preemptions:?}"
        );
        for (below, above) in preemptions.keys() {
            assert!(priority(*above) > priority(*below), "{below} by {above}");
        }
    }
}

#[test]
fn an_interrupt_of_the_idle_loop_saves_no_registers_of_the_fpu() {
    /// EXC_RETURN to the idle loop: a frame of eight words, without the FPU's.
    const BASIC_FRAME: u32 = 0xffff_fff9;
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &examination());
    host.arm();
    host.run_until_torque();
    let mcu = host.board.mcu_mut();
    for task in [SAMPLE, COMMAND, LINK] {
        while mcu.exception() != task {
            mcu.run_until(mcu.now() + Time::from_units(1));
        }
        assert_eq!(mcu.register(14), BASIC_FRAME, "{task}");
    }
}

#[test]
fn no_tick_is_late_under_torque() {
    let Some(image) = image() else { return };
    for flash in judged(Flash::BOTH) {
        let mut host = Host::timed(&image, &examination(), &[], flash);
        host.arm();
        host.run_until_torque();
        host.blocks.clear();
        host.run(2_000);
        let samples = host.blocks.iter().flat_map(|block| block.samples);
        let late = samples.filter(|sample| sample.flags.has(SampleFlags::LATE | SampleFlags::LOST));
        assert_eq!(late.count(), 0, "{flash:?}");
    }
}

#[test]
fn tasks_begin_when_they_should() {
    // Each task acknowledges its timer with its first write.
    const MIDDLE: u32 = 0x4000_0410;
    const BEGIN: u32 = 0x4000_0810;
    let Some(image) = image() else { return };
    for flash in judged(Flash::BOTH) {
        let mut host = Host::timed(&image, &examination(), &[], flash);
        host.arm();
        host.run_until_torque();
        host.board.mcu_mut().listen(&[MIDDLE, BEGIN]);
        host.run(2_000);
        let accesses = host.board.mcu_mut().take_accesses();
        let tick = TICK_UNITS;
        for (name, register, most_us) in [
            ("command_motor", MIDDLE, 3.0),
            ("sample_encoder", BEGIN, 3.0),
        ] {
            let writes = accesses
                .iter()
                .filter(|access| access.address == register && access.is_write);
            let times: Vec<u64> = writes.map(|access| access.at.units()).collect();
            assert!(times.len() >= 1_999, "{name}");
            let spans = times.windows(2).map(|pair| pair[1] - pair[0]);
            let first = times[0];
            let late = times
                .iter()
                .zip(0_u64..)
                .map(|(time, n)| (first + n * tick).abs_diff(*time));
            let jitter_us = Time::from_units(late.max().unwrap_or(0)).as_s() * 1e6;
            println!("{name}: jitter {jitter_us:.2} us ({})", flash.label());
            assert!(jitter_us < most_us, "{name}: {jitter_us} us");
            assert!(spans.min() > Some(tick / 2));
        }
    }
}

#[test]
fn every_tick_is_sampled_and_then_commanded() {
    const ENCODER: u32 = 0x4000_0c24;
    const CONVERTER: u32 = 0x4001_2000;
    let Some(image) = image() else { return };
    let mut host = Host::listening(&image, &examination(), &[ENCODER, CONVERTER]);
    host.run(200);
    let accesses = host.board.mcu_mut().take_accesses();
    let reads = accesses.iter().filter(|access| !access.is_write);
    let tasks = reads.map(|access| access.address);
    // The first count is what the program begins with.
    let tasks: Vec<u32> = tasks
        .skip(1)
        .skip_while(|task| *task == CONVERTER)
        .collect();
    for (n, pair) in tasks.chunks_exact(2).enumerate() {
        assert_eq!(pair, [ENCODER, CONVERTER], "tick {n}");
    }
}
