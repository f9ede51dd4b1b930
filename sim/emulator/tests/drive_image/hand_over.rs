//! A reader that comes in the middle of a hand-over: `command_motor` interrupts `render_torque`
//! before each instruction of `Exchange::show`, and sees the result of before or the new one, whole.
//!
//! Two boards run alike, without torque, so that nothing of the one's delays reaches its leg. On the
//! second the core stands before the n-th instruction until the middle of the tick.

use crate::host::{Flash, Host, examination, image};
use crate::tasks::RENDER;
use crepitus_emulator::firmware::{Program, path};
use crepitus_emulator::mcu::{Step, Watch};
use crepitus_emulator::{DriveBoard, Time};
use crepitus_protocol::telemetry::{EffectPhases, Sample, SampleFlags};
use crepitus_tools::image::lines::Lines;
use std::collections::{BTreeMap, BTreeSet};

/// The function, as debug information names it.
const SHOW: &str = "crepitus_device::drive::exchange::Exchange::show";

/// Ticks between two stalls.
const BETWEEN: u64 = 9;

/// Fewest instructions that storing eight words can take.
const FEWEST: usize = 10;

/// Time after the middle until which the core stands: the interrupt of `command_motor` has come, 6.2 µs
/// after it, and no edge of the encoder yet.
const STAND: Time = Time::from_us(8);

/// Within this time after a tick has begun the result is shown, before the first edge of the encoder.
const SHOWN: Time = Time::from_us(10);

/// Addresses that `render_torque` executes.
#[derive(Default)]
struct Executed(BTreeSet<u32>);

impl Watch for Executed {
    fn step(&mut self, step: &Step) {
        if step.exception == RENDER {
            self.0.insert(step.pc);
        }
    }
}

/// The instructions of the function that are executed.
fn instructions(host: &mut Host) -> BTreeSet<u32> {
    let lines = Lines::of(&path(Program::Drive).expect("an image"));
    let mut executed = Executed::default();
    host.watch(40, &mut executed);
    let is_of_show = |pc: &u32| lines.frames(*pc).iter().any(|f| f.function.contains(SHOW));
    executed.0.into_iter().filter(is_of_show).collect()
}

/// A board at the beginning of a tick, its leg in motion.
fn moving() -> Option<Host> {
    let mut host = Host::timed(&image()?, &examination(), &[], Flash::ZeroWaitStates);
    host.run(200);
    for _ in 0..20_000 {
        if host.board.leg().shaft().omega_rad_s > 0.8 {
            host.board.to_the_middle();
            host.board.half(None);
            return Some(host);
        }
        host.run(1);
    }
    panic!("the leg does not move");
}

/// A tick in which the core stands before the `nth` of these instructions, counted as they are
/// executed. Returns whether it came to that.
fn stall(board: &mut DriveBoard, instructions: &BTreeSet<u32>, nth: usize) -> bool {
    let begin = board.mcu().now();
    let (mut count, mut has_come) = (0, false);
    while board.mcu().now() < begin + SHOWN {
        let mcu = board.mcu_mut();
        if mcu.exception() == RENDER && instructions.contains(&mcu.program_counter()) {
            has_come = count == nth;
            if has_come {
                break;
            }
            count += 1;
        }
        mcu.run_until(mcu.now() + Time::from_units(1));
    }
    board.mcu_mut().set_hung(has_come);
    board.half(None);
    let mcu = board.mcu_mut();
    mcu.run_until(mcu.now() + STAND);
    mcu.set_hung(false);
    board.half(None);
    has_come
}

/// Parts of a sample that come from the exchange.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shown {
    count: i32,
    model_torque_bits: u32,
    flags: SampleFlags,
    phases: EffectPhases,
}

fn shown(host: &Host) -> BTreeMap<u64, Shown> {
    let of = |sample: Sample, phases| Shown {
        count: sample.count,
        model_torque_bits: sample.model_torque_nm.to_bits(),
        flags: sample.flags.with(SampleFlags::LATE, false),
        phases,
    };
    let ticks = host.blocks.iter().flat_map(|block| {
        let samples = block.samples.into_iter().zip(block.phases);
        (block.first_tick..).zip(samples)
    });
    ticks
        .map(|(tick, (sample, phases))| (tick, of(sample, phases)))
        .collect()
}

fn late(host: &Host) -> BTreeSet<u64> {
    let ticks = host
        .blocks
        .iter()
        .flat_map(|block| (block.first_tick..).zip(block.samples));
    let late = ticks.filter(|(_, sample)| sample.flags.has(SampleFlags::LATE));
    late.map(|(tick, _)| tick).collect()
}

#[test]
fn a_result_is_seen_whole_whenever_command_motor_comes() {
    let (Some(mut alike), Some(mut stalled)) = (moving(), moving()) else {
        return;
    };
    let instructions = instructions(&mut stalled);
    alike.run(40);
    assert!(instructions.len() >= FEWEST, "{instructions:x?}");
    let (mut nth, mut is_there) = (0, true);
    while is_there {
        stalled.with_board(|board| is_there = stall(board, &instructions, nth));
        alike.run(1);
        stalled.run(BETWEEN);
        alike.run(BETWEEN);
        nth += 1;
    }
    stalled.run(60);
    alike.run(60);
    let (all, late) = (shown(&alike), late(&stalled));
    assert_eq!(self::late(&alike), BTreeSet::new());
    println!(
        "stalled before each of {} instructions: {} results late",
        nth - 1,
        late.len()
    );
    // All before the store that shows the result, and none behind it.
    let stalls = nth - 1;
    assert!(stalls >= FEWEST, "{stalls}");
    assert!((FEWEST - 1..=stalls).contains(&late.len()));
    let mut moved = 0;
    for (tick, sample) in shown(&stalled) {
        let of = if late.contains(&tick) { tick - 1 } else { tick };
        assert_eq!(Some(&sample), all.get(&of), "tick {tick} shows tick {of}");
        moved += usize::from(all.get(&tick) != all.get(&of));
    }
    // A result of before differs, or nothing was seen.
    assert!(moved * 2 > late.len(), "{moved}");
}
