//! Causes of the faults that the drive notices.

use super::reset;
use crate::breakage::{
    board, break_down, break_monitor, break_sensor, drive_line_on, hang_and_bite, jump_count,
    mend_converters, mend_down, mend_drive_line, mend_encoder, mend_sensors, once, restart_comms,
    stop_converter, stop_monitor, supply_off, supply_on, swap_encoder, unplug_encoder,
};
use crate::case::Moment::{Arming, Disarmed};
use crate::case::{
    Case, ESTIMATE_TICKS, SLOW_LOOP, case, disagrees, heartbeat, is_disarmed, renewal,
};
use crate::support::Host;
use crepitus_model::Sense;
use crepitus_protocol::TICK_US;
use crepitus_protocol::management::ResetCause::{BrownOut, Panic, Requested, Watchdog};
use crepitus_virtual_device::Faults;
use crepitus_virtual_device::board::Controller::{self, Comms, Drive};
use crepitus_virtual_device::leg::CurrentPath;
use crepitus_virtual_device::leg::CurrentSensor::{Gain, Offset, StuckAt};

/// More than a condition that comes and goes takes beside one that holds for a few ticks.
const RECURRING_TICKS: u64 = 6;

/// Ticks without a count after which it is lost.
const LOST_TICKS: u64 = 20;

pub(super) fn comms_silent() -> Vec<Case> {
    vec![
        case(
            "the wire to the drive is cut",
            |host, _| {
                let is_cut = true;
                break_down(
                    host,
                    Faults {
                        is_cut,
                        ..Faults::default()
                    },
                );
            },
            mend_down,
        )
        .settled(heartbeat),
        case(
            "every frame is corrupted",
            |host, _| {
                let corruption = 1.0;
                break_down(
                    host,
                    Faults {
                        corruption,
                        ..Faults::default()
                    },
                );
            },
            mend_down,
        )
        .settled(heartbeat),
        case(
            "every frame is late",
            |host, _| {
                // Few arrive, and none is fresh.
                let delay_ticks = 1_000_000;
                break_down(
                    host,
                    Faults {
                        delay_ticks,
                        ..Faults::default()
                    },
                );
            },
            mend_down,
        )
        .settled(heartbeat),
        Case {
            phases: 0..20,
            ..case(
                "the last two heartbeats come again and again",
                |host, _| board(host).down().repeats = true,
                |host| board(host).down().repeats = false,
            )
            .settled(heartbeat)
        },
        case(
            "comms hangs",
            |host, since| once(since, host, |board| board.hang(Comms)),
            restart_comms,
        )
        .settled(heartbeat),
        reset("comms is reset", |host, since| {
            once(since, host, |b| b.reset(Comms, Requested));
        }),
    ]
}

pub(super) fn lease_expired() -> Vec<Case> {
    vec![
        reset("the host does not renew", |host, _| host.renew_every = None).settled(renewal),
        reset("the plug is pulled", |host, since| {
            if since == 0 {
                host.device.unplug();
            }
        })
        .settled(renewal),
    ]
}

pub(super) fn speed_mismatch() -> Vec<Case> {
    vec![
        case("the encoder is unplugged", unplug_encoder, mend_encoder),
        case("the encoder is swapped", swap_encoder, mend_encoder),
        case("the supply is off, little torque", supply_off, supply_on),
        case("the supply is off, much torque", supply_off, supply_on).heavy(),
    ]
}

pub(super) fn current_missing() -> Vec<Case> {
    vec![
        case("the converter stops", stop_converter, mend_converters),
        case("that of the monitor stops", stop_monitor, mend_converters),
        case(
            "that of the monitor stops in every second tick",
            |host, since| {
                let runs = since.is_multiple_of(2);
                board(host).set_converter(CurrentPath::Monitor, runs);
            },
            mend_converters,
        )
        .lag(RECURRING_TICKS),
        case(
            "the converter does not run",
            stop_converter,
            mend_converters,
        )
        .when(Arming),
        case(
            "that of the monitor does not",
            stop_monitor,
            mend_converters,
        )
        .when(Arming),
    ]
}

pub(super) fn rendering_late() -> Vec<Case> {
    let mend = |host: &mut Host| board(host).set_renderings(1);
    vec![
        case(
            "the model is never ready",
            |host, _| board(host).set_renderings(0),
            mend,
        ),
        case(
            "its timer is twice as fast",
            |host, _| board(host).set_renderings(2),
            mend,
        ),
    ]
}

pub(super) fn tick_irregular() -> Vec<Case> {
    vec![
        case(
            "the timer of the tasks runs slow",
            |host, _| board(host).set_interval_us(60),
            |host| board(host).set_interval_us(TICK_US),
        ),
        case(
            "it runs fast",
            |host, _| board(host).set_interval_us(40),
            |host| board(host).set_interval_us(TICK_US),
        ),
    ]
}

pub(super) fn line_of_comms_unseen() -> Vec<Case> {
    let mends: fn(&mut Host) = |host| board(host).set_comms_line_wire(true);
    let breaks: fn(&mut Host, u64) = |host, _| board(host).set_comms_line_wire(false);
    vec![
        case("the wire breaks while armed", breaks, mends),
        case("it is broken at arming", breaks, mends).when(Arming),
    ]
}

pub(super) fn current_mismatch() -> Vec<Case> {
    vec![Case {
        values: SLOW_LOOP,
        ..case(
            "a loop that is too slow",
            |_, _| {},
            |host| host.set("motor.bandwidth_hz", 1_000.0),
        )
        .when(Arming)
    }]
}

pub(super) fn drive_watchdog() -> Vec<Case> {
    vec![
        reset("it hung, and its watchdog bit", |host, since| {
            hang_and_bite(host, since, Drive);
        })
        .when(Disarmed),
        reset("it is reset while armed", |host, since| {
            once(since, host, |b| b.reset(Drive, Watchdog));
        }),
    ]
}

pub(super) fn encoder_lost() -> Vec<Case> {
    vec![
        reset("interference in every tick", |host, since| {
            let counts = if since.is_multiple_of(2) {
                90_000
            } else {
                -70_000
            };
            jump_count(board(host), counts);
        }),
        reset("interference in every second tick", |host, since| {
            let counts = if since.is_multiple_of(2) {
                90_000
            } else {
                -90_000
            };
            jump_count(board(host), counts);
        })
        .lag(2 * LOST_TICKS),
        reset("a disturbed counter", |host, since| {
            once(since, host, |board| jump_count(board, 90_000));
        }),
    ]
}

pub(super) fn overspeed() -> Case {
    Case {
        values: &[("limits.speed_rad_s", 0.8)],
        ..case(
            "a fast motion",
            |_, _| {},
            |host| host.set("limits.speed_rad_s", 7.33),
        )
    }
    // The shaft itself; what the estimate shows comes later.
    .settled(|host| host.device.board().leg().shaft().omega_rad_s > 0.8)
    .lag(ESTIMATE_TICKS)
}

pub(super) fn current_offset() -> Vec<Case> {
    vec![
        case(
            "the sensor has drifted",
            |host, _| break_sensor(host, Offset(0.15)),
            mend_sensors,
        )
        .when(Arming),
        case(
            "the sensor is stuck",
            |host, _| break_sensor(host, StuckAt(-1.0)),
            mend_sensors,
        )
        .when(Arming),
        case(
            "the monitor has drifted",
            |host, _| break_monitor(host, Offset(-0.15)),
            mend_sensors,
        )
        .when(Arming),
    ]
}

/// Overcurrents that the comparator sees, or the program in two ticks.
pub(super) fn overcurrent() -> Vec<Case> {
    vec![
        case(
            "the sensor is stuck at 2.5 A",
            |host, _| break_sensor(host, StuckAt(2.5)),
            mend_sensors,
        ),
        case(
            "the monitor's amplifier is stuck at 2.5 A",
            |host, _| break_monitor(host, StuckAt(-2.5)),
            mend_sensors,
        ),
        case(
            "both show 2.2 A too much",
            |host, _| {
                break_sensor(host, Offset(2.2));
                break_monitor(host, Offset(2.2));
            },
            mend_sensors,
        ),
    ]
}

/// One of two ways is broken, and the other notices, as soon as they differ.
pub(super) fn current_disagreement() -> Vec<Case> {
    let of = |name, cause| case(name, cause, mend_sensors).onset(disagrees);
    vec![
        of("the sensor shows nothing", |host, _| {
            break_sensor(host, StuckAt(0.0));
        }),
        of("the sensor shows nothing, much torque", |host, _| {
            break_sensor(host, StuckAt(0.0));
        })
        .heavy(),
        of("the sensor shows nothing at arming", |host, _| {
            break_sensor(host, StuckAt(0.0));
        })
        // A push has no current yet in its first tick.
        .lag(1)
        .when(Arming),
        of("the sensor is stuck at 1 A", |host, _| {
            break_sensor(host, StuckAt(1.0));
        }),
        of("the sensor shows half, much torque", |host, _| {
            break_sensor(host, Gain(0.5));
        })
        .heavy(),
        of("the sensor has the wrong sign, much torque", |host, _| {
            break_sensor(host, Gain(-1.0));
        })
        .heavy(),
        of("the monitor shows nothing, much torque", |host, _| {
            break_monitor(host, StuckAt(0.0));
        })
        .heavy(),
        of("the monitor is stuck at 1 A", |host, _| {
            break_monitor(host, StuckAt(1.0));
        }),
        of("the monitor shows double, much torque", |host, _| {
            break_monitor(host, Gain(2.0));
        })
        .heavy(),
    ]
}

pub(super) fn enable_stuck_on() -> Vec<Case> {
    vec![
        case("at rest", drive_line_on, mend_drive_line).when(Disarmed),
        case(
            "while armed, then disarmed",
            |host, since| {
                drive_line_on(host, since);
                if since == 40 {
                    host.disarm();
                }
            },
            mend_drive_line,
        )
        .onset(is_disarmed),
    ]
}

pub(super) fn current_while_floating() -> Vec<Case> {
    vec![
        case(
            "a switch is shorted",
            |host, _| {
                let leg = board(host).leg_mut();
                leg.set_shorted_switch(Some(Sense::Negative));
            },
            |host| board(host).leg_mut().set_shorted_switch(None),
        )
        .when(Disarmed),
    ]
}

/// The hand bends the leg on, through the fade and beyond the end.
pub(super) fn outside_range() -> Case {
    Case {
        values: &[("range.most_deg", 30.0)],
        ..case(
            "the leg is bent too far",
            |_, _| {},
            |host| host.set("range.most_deg", 125.0),
        )
    }
    .onset(|host| {
        // The zero was set at the examination's beginning, at 10°.
        host.device.board().leg().shaft().angle_rad.to_degrees() > 45.0
    })
}

/// All outputs of a gate follow the timer, whatever the line.
pub(super) fn gate_stuck(controller: Controller) -> Case {
    match controller {
        Drive => case(
            "the drive's gate lets all pass",
            |host, _| board(host).set_stuck_gate(Drive, true),
            |host| board(host).set_stuck_gate(Drive, false),
        ),
        Comms => case(
            "the gate of comms lets all pass",
            |host, _| board(host).set_stuck_gate(Comms, true),
            |host| board(host).set_stuck_gate(Comms, false),
        ),
    }
    .when(Arming)
}

pub(super) fn brown_out() -> Case {
    reset("its supply falls", |host, since| {
        once(since, host, |b| b.reset(Drive, BrownOut));
    })
    .when(Disarmed)
}

pub(super) fn panic() -> Case {
    reset("it panics", |host, since| {
        once(since, host, |b| b.reset(Drive, Panic));
    })
    .when(Disarmed)
}
