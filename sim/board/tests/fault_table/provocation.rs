//! What causes each fault here.

use crate::breakage::{
    board, break_down, break_sensor, comms_line_off, comms_line_on, cut_up, drive_line_off,
    drive_line_on, hang_and_bite, jump_count, mend_comms_line, mend_converter, mend_down,
    mend_drive_line, mend_encoder, mend_sensor, mend_up, nothing, once, restart_comms,
    restart_drive, stop_converter, supply_off, supply_on, swap_encoder, unplug_encoder,
};
use crate::case::Moment::{Arming, Disarmed};
use crate::case::{
    Case, ESTIMATE_TICKS, OVER_TICKS, case, heartbeat, is_disarmed, is_over, renewal,
};
use crate::support::Host;
use crepitus_board::Faults;
use crepitus_board::board::Controller::{Comms, Drive};
use crepitus_board::leg::CurrentSensor::{Offset, StuckAt};
use crepitus_protocol::management::ResetCause::{BrownOut, Panic, Power, Requested, Watchdog};
use crepitus_protocol::{Fault, schema};

/// How a fault comes about.
pub(crate) enum Provocation {
    /// Each of these causes it.
    Cases(Vec<Case>),
    /// It cannot be caused here: why.
    None(&'static str),
}

/// What causes a fault. A new one has to find its place.
pub(crate) fn provocation(fault: Fault) -> Provocation {
    Provocation::Cases(match fault {
        Fault::CommsSilent => comms_silent(),
        Fault::LeaseExpired => lease_expired(),
        Fault::CommsRestarted => vec![case(
            "comms is reset, and back at once",
            |host, since| once(since, host, |b| b.reset_for(Comms, Requested, 10)),
            nothing,
        )],
        Fault::EncoderLost => encoder_lost(),
        Fault::Overspeed => vec![overspeed()],
        Fault::SpeedMismatch => vec![
            case("the encoder is unplugged", unplug_encoder, mend_encoder),
            case("the encoder is swapped", swap_encoder, mend_encoder),
            case("the supply is off, little torque", supply_off, supply_on),
        ],
        Fault::EncoderPolarity => {
            vec![case("the encoder is swapped", swap_encoder, mend_encoder).when(Arming)]
        }
        Fault::CurrentOffset => current_offset(),
        Fault::Overcurrent => overcurrent(),
        Fault::CurrentMissing => vec![
            case("the converter stops", stop_converter, mend_converter),
            case("the converter does not run", stop_converter, mend_converter).when(Arming),
        ],
        Fault::CurrentMismatch => {
            vec![case("the supply is off, much torque", supply_off, supply_on).heavy()]
        }
        Fault::EnableStuckOn => enable_stuck_on(),
        Fault::EnableStuckOff => vec![
            case("while armed", drive_line_off, mend_drive_line),
            case("at arming", drive_line_off, mend_drive_line).when(Arming),
        ],
        Fault::RenderingLate => vec![case(
            "the model is never ready",
            |host, _| board(host).set_rendering(false),
            |host| board(host).set_rendering(true),
        )],
        Fault::NotANumber => {
            return Provocation::None(
                "no count, current or parameter that is let in makes the torque other than finite",
            );
        }
        Fault::DriveWatchdog => vec![
            reset("it hung, and its watchdog bit", |host, since| {
                hang_and_bite(host, since, Drive);
            })
            .when(Disarmed),
            reset("it is reset while armed", |host, since| {
                once(since, host, |b| b.reset(Drive, Watchdog));
            }),
        ],
        Fault::DriveBrownOut => vec![
            reset("its supply falls", |host, since| {
                once(since, host, |b| b.reset(Drive, BrownOut));
            })
            .when(Disarmed),
        ],
        Fault::DrivePanic => vec![
            reset("it panics", |host, since| {
                once(since, host, |b| b.reset(Drive, Panic));
            })
            .when(Disarmed),
        ],
        Fault::DriveSilent => drive_silent(),
        Fault::DriveRestarted => vec![reset(
            "the drive is reset, and back at once",
            |host, since| once(since, host, |b| b.reset_for(Drive, Watchdog, 10)),
        )],
        Fault::CommsEnableStuckOn => comms_enable_stuck_on(),
        Fault::CommsEnableStuckOff => vec![
            case("while armed", comms_line_off, mend_comms_line),
            case("while armed, much torque", comms_line_off, mend_comms_line).heavy(),
            case("at arming", comms_line_off, mend_comms_line).when(Arming),
        ],
        Fault::VersionMismatch => vec![version_mismatch()],
        Fault::CommsWatchdog => vec![
            reset("it hung, and its watchdog bit", |host, since| {
                hang_and_bite(host, since, Comms);
            })
            .when(Disarmed),
            reset("it is reset while armed", |host, since| {
                once(since, host, |b| b.reset(Comms, Watchdog));
            }),
        ],
        Fault::CommsBrownOut => vec![
            reset("its supply falls", |host, since| {
                once(since, host, |b| b.reset(Comms, BrownOut));
            })
            .when(Disarmed),
        ],
        Fault::CommsPanic => vec![
            reset("it panics", |host, since| {
                once(since, host, |b| b.reset(Comms, Panic));
            })
            .when(Disarmed),
        ],
    })
}

/// What repairs itself.
fn reset(name: &'static str, cause: fn(&mut Host, u64)) -> Case {
    case(name, cause, nothing)
}

fn comms_silent() -> Vec<Case> {
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

fn lease_expired() -> Vec<Case> {
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

fn encoder_lost() -> Vec<Case> {
    vec![
        reset("interference in every tick", |host, since| {
            let counts = if since.is_multiple_of(2) {
                90_000
            } else {
                -70_000
            };
            jump_count(board(host), counts);
        }),
        reset("a disturbed counter", |host, since| {
            once(since, host, |board| jump_count(board, 90_000));
        }),
    ]
}

fn overspeed() -> Case {
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

fn current_offset() -> Vec<Case> {
    vec![
        case(
            "the sensor has drifted",
            |host, _| break_sensor(host, Offset(0.15)),
            mend_sensor,
        )
        .when(Arming),
        case(
            "the sensor is stuck",
            |host, _| break_sensor(host, StuckAt(-1.0)),
            mend_sensor,
        )
        .when(Arming),
    ]
}

/// A sensor that is stuck opens the loop, and the comparator lets go at the
/// current that there is.
fn overcurrent() -> Vec<Case> {
    let dead = |name| {
        case(
            name,
            |host, _| break_sensor(host, StuckAt(0.0)),
            mend_sensor,
        )
    };
    vec![
        case(
            "the sensor is stuck at 2.5 A",
            |host, _| break_sensor(host, StuckAt(2.5)),
            mend_sensor,
        ),
        case(
            "the sensor is stuck at 1 A",
            |host, _| break_sensor(host, StuckAt(1.0)),
            mend_sensor,
        )
        .onset(is_over),
        dead("the sensor shows nothing")
            .onset(is_over)
            .lag(OVER_TICKS),
        dead("the sensor shows nothing, much torque")
            .onset(is_over)
            .heavy(),
        dead("the sensor shows nothing at arming").when(Arming),
    ]
}

fn enable_stuck_on() -> Vec<Case> {
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

fn drive_silent() -> Vec<Case> {
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

fn comms_enable_stuck_on() -> Vec<Case> {
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

fn version_mismatch() -> Case {
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
