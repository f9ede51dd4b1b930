//! Causes of the faults that comms notices.

use super::reset;
use crate::breakage::{
    board, comms_line_on, cut_up, hang_and_bite, mend_comms_line, mend_up, once, restart_drive,
};
use crate::case::Moment::Disarmed;
use crate::case::{Case, case, is_disarmed};
use crepitus_protocol::management::ResetCause::{BrownOut, Panic, Power, Watchdog};
use crepitus_protocol::telemetry::{Block, BlockFlags, Sample, SampleFlags};
use crepitus_protocol::{State, schema};
use crepitus_virtual_device::board::Controller::{Comms, Drive};

pub(super) fn torque_beyond_bounds() -> Vec<Case> {
    vec![
        says("it says 5 N·m", |block| {
            each(block, |sample| {
                sample.torque_nm = 5.0;
                sample.current_ma = 0;
            });
        }),
        says("its model gives more than Ts", |block| {
            each(block, |sample| sample.model_torque_nm = -0.45);
        }),
        says("its torque is not its model's", |block| {
            each(block, |sample| {
                sample.torque_nm = 0.3;
                sample.model_torque_nm = 0.1;
            });
        }),
        says("the same in three samples of four", |block| {
            for (sample, n) in block.samples.iter_mut().zip(0..) {
                if n % 4 != 3 {
                    (sample.torque_nm, sample.model_torque_nm) = (0.3, 0.1);
                }
            }
        }),
        says("its torque is NaN", |block| {
            each(block, |sample| sample.torque_nm = f32::NAN);
        }),
        says("it says that it is not armed", |block| {
            block.flags = BlockFlags::new(State::Disarmed, true, block.flags.start().into());
        }),
    ]
}

pub(super) fn comms_overspeed() -> Vec<Case> {
    vec![says("its count runs away", |block| {
        let ticks = i32::try_from(block.first_tick % 4_000).unwrap_or(0);
        for (sample, n) in block.samples.iter_mut().zip(0..) {
            sample.count = 12 * (ticks + n);
        }
    })]
}

pub(super) fn torque_outside_range() -> Vec<Case> {
    vec![
        says("its count is far outside", |block| {
            each(block, |sample| {
                sample.count = sample.count.wrapping_add(1 << 20);
            });
        }),
        says("it knows no zero", |block| {
            block.flags.0 &= !BlockFlags::ZEROED;
        }),
        says("it has no plausible count", |block| {
            each(block, |sample| {
                sample.flags = sample.flags.with(SampleFlags::LOST, true);
            });
        }),
    ]
}

pub(super) fn comms_watchdog() -> Vec<Case> {
    vec![
        reset("it hung, and its watchdog bit", |host, since| {
            hang_and_bite(host, since, Comms);
        })
        .when(Disarmed),
        reset("it is reset while armed", |host, since| {
            once(since, host, |b| b.reset(Comms, Watchdog));
        }),
    ]
}

pub(super) fn drive_silent() -> Vec<Case> {
    vec![
        case(
            "the drive hangs",
            |host, since| once(since, host, |board| board.hang(Drive)),
            restart_drive,
        ),
        case("the wire to comms is cut", cut_up, mend_up),
        reset("the drive is reset by its watchdog", |host, since| {
            once(since, host, |b| b.reset(Drive, Watchdog));
        }),
        reset("the drive's supply falls", |host, since| {
            once(since, host, |b| b.reset(Drive, BrownOut));
        }),
    ]
}

pub(super) fn comms_enable_stuck_on() -> Vec<Case> {
    vec![
        case("at rest", comms_line_on, mend_comms_line).when(Disarmed),
        case(
            "while armed, then disarmed",
            |host, since| {
                comms_line_on(host, since);
                if since == 0 {
                    host.disarm();
                }
            },
            mend_comms_line,
        )
        .onset(is_disarmed),
    ]
}

/// The drive's blocks say this, whatever it does.
pub(super) fn says(name: &'static str, falsify: fn(&mut Block)) -> Case {
    Case {
        falsify: Some(falsify),
        ..case(name, |_, _| {}, |host| board(host).up().falsify = None)
    }
}

pub(super) fn each(block: &mut Block, change: fn(&mut Sample)) {
    block.samples.iter_mut().for_each(change);
}

pub(super) fn drive_clock() -> Vec<Case> {
    let fast = |name| {
        case(
            name,
            |host, _| board(host).set_fast_drive(true),
            |host| board(host).set_fast_drive(false),
        )
    };
    vec![fast("the drive's crystal has 12 MHz").when(Disarmed)]
}

pub(super) fn version_mismatch() -> Case {
    case(
        "the drive was flashed with another version",
        |host, since| {
            once(since, host, |board| {
                board.set_drive_schema(!schema::HASH);
                board.reset(Drive, Power);
            });
        },
        |host| {
            board(host).set_drive_schema(schema::HASH);
            restart_drive(host);
        },
    )
    .when(Disarmed)
}

pub(super) fn brown_out() -> Case {
    reset("its supply falls", |host, since| {
        once(since, host, |b| b.reset(Comms, BrownOut));
    })
    .when(Disarmed)
}

pub(super) fn panic() -> Case {
    reset("it panics", |host, since| {
        once(since, host, |b| b.reset(Comms, Panic));
    })
    .when(Disarmed)
}
