//! Tests of arming.

use super::*;

/// Arms with a line that follows a tick late, and a shaft that is moved
/// by `counts` a tick in the sense of the push, on top of a hand's motion.
fn arm(raw_a: f32, stuck: Option<bool>, counts: i32, hand: i32) -> (ArmingOutput, u32, bool) {
    let mut arming = Arming::default();
    let (mut line, mut count, mut ticks) = (stuck.unwrap_or(false), i32::MAX - 20, 0);
    let mut speed = 0;
    loop {
        let wish = arming.tick(&ArmingInputs {
            raw_a: Some((raw_a, raw_a)),
            line_is_on: stuck.unwrap_or(line),
            comms_line_is_on: arming.awaits_comms(),
            count,
        });
        ticks += 1;
        match wish {
            ArmingOutput::Off => line = false,
            ArmingOutput::Line => line = true,
            ArmingOutput::Proof(_, on) => line = on,
            ArmingOutput::Push(a) => speed += if a > 0.0 { counts } else { -counts },
            ArmingOutput::Armed | ArmingOutput::Failed(_) => {
                return (wish, ticks, arming.is_proven());
            }
        }
        count = count.wrapping_add(hand + speed);
        assert!(ticks < 1000);
    }
}

#[test]
fn all_in_order_is_armed_within_25_milliseconds() {
    let (wish, ticks, proven) = arm(0.05, None, 1, 0);
    assert_eq!((wish, proven), (ArmingOutput::Armed, true));
    assert!(ticks < 500, "{ticks}");
}

#[test]
fn a_hand_that_moves_the_leg_changes_nothing() {
    for hand in [-3, 3] {
        assert_eq!(arm(0.0, None, 0, hand).0, ArmingOutput::Armed);
        assert!(!arm(0.0, None, 0, hand).2);
        assert!(arm(0.0, None, 1, hand).2);
        assert_eq!(
            arm(0.0, None, -1, hand).0,
            ArmingOutput::Failed(Fault::EncoderPolarity)
        );
    }
}

#[test]
fn a_hand_that_speeds_up_changes_nothing() {
    // Up to 100 rad/s², in counts a tick and tick; right, loose and swapped.
    for per_mille in [-7, -2, 2, 7] {
        for (counts, expected, proven) in [
            (1, ArmingOutput::Armed, true),
            (0, ArmingOutput::Armed, false),
            (-1, ArmingOutput::Failed(Fault::EncoderPolarity), false),
        ] {
            let mut arming = Arming::default();
            let (mut line, mut pushed, mut speed) = (false, 0, 0);
            let (wish, is_proven) = (0_i32..1_000)
                .find_map(|tick| {
                    let hand = per_mille * tick * tick / 2_000;
                    let wish = arming.tick(&ArmingInputs {
                        raw_a: Some((0.0, 0.0)),
                        line_is_on: line,
                        comms_line_is_on: arming.awaits_comms(),
                        count: hand + pushed,
                    });
                    match wish {
                        ArmingOutput::Off => line = false,
                        ArmingOutput::Line => line = true,
                        ArmingOutput::Proof(_, on) => line = on,
                        ArmingOutput::Push(a) => speed += if a > 0.0 { counts } else { -counts },
                        _ => return Some((wish, arming.is_proven())),
                    }
                    pushed += speed;
                    None
                })
                .unwrap();
            assert_eq!(
                (wish, is_proven),
                (expected, proven),
                "{per_mille} {counts}"
            );
        }
    }
}

#[test]
fn arming_fails_on_a_defect() {
    for (raw_a, stuck, fault) in [
        (0.11, None, Fault::CurrentOffset),
        (-0.11, None, Fault::CurrentOffset),
        (f32::NAN, None, Fault::CurrentOffset),
        (0.0, Some(true), Fault::EnableStuckOn),
        (0.0, Some(false), Fault::EnableStuckOff),
    ] {
        assert_eq!(arm(raw_a, stuck, 1, 0).0, ArmingOutput::Failed(fault));
    }
    let nothing = ArmingInputs {
        raw_a: None,
        line_is_on: false,
        comms_line_is_on: false,
        count: 0,
    };
    assert_eq!(
        Arming::default().tick(&nothing),
        ArmingOutput::Failed(Fault::CurrentMissing)
    );
}

/// Arms with gates that let pass, with this line off, a share of what they should
/// not, and a line of comms that is `on` from where it is awaited; what came of it.
fn leaks(of_drive: f32, of_comms: f32, on: Option<bool>) -> ArmingOutput {
    leaks_by(
        |volts, is_on| volts * if is_on { of_comms } else { of_drive },
        on,
    )
}

/// Arms with gates that let pass what `passes` says of a voltage, with the drive's line on or off.
fn leaks_by(passes: impl Fn(f32, bool) -> f32, on: Option<bool>) -> ArmingOutput {
    let mut arming = Arming::default();
    let (mut line, mut raw_a) = (false, 0.0);
    (0..5_000)
        .find_map(|_| {
            let comms_line_is_on = on.unwrap_or(arming.awaits_comms());
            let wish = arming.tick(&ArmingInputs {
                raw_a: Some((raw_a, -raw_a)),
                line_is_on: line,
                comms_line_is_on,
                count: 0,
            });
            raw_a = 0.0;
            match wish {
                ArmingOutput::Off => line = false,
                ArmingOutput::Line | ArmingOutput::Push(_) => line = true,
                ArmingOutput::Proof(volts, is_on) => {
                    line = is_on;
                    raw_a = passes(volts, is_on) / 1.23;
                }
                _ => return Some(wish),
            }
            None
        })
        .expect("an end")
}

#[test]
fn a_gate_that_does_not_follow_its_line_is_found() {
    assert_eq!(leaks(0.0, 0.0, None), ArmingOutput::Armed);
    assert_eq!(leaks(0.2, 0.2, None), ArmingOutput::Armed, "noise");
    let failed = ArmingOutput::Failed;
    assert_eq!(leaks(1.0, 0.0, None), failed(Fault::DriveGateStuck));
    assert_eq!(leaks(0.0, 1.0, None), failed(Fault::CommsGateStuck));
    assert_eq!(leaks(f32::NAN, 0.0, None), failed(Fault::DriveGateStuck));
    // One of its outputs, so that current flows one way only.
    for way in [f32::max, f32::min] {
        let of_drive = |volts: f32, is_on| if is_on { 0.0 } else { way(volts, 0.0) };
        assert_eq!(leaks_by(of_drive, None), failed(Fault::DriveGateStuck));
        let of_comms = |volts: f32, is_on| if is_on { way(volts, 0.0) } else { 0.0 };
        assert_eq!(leaks_by(of_comms, None), failed(Fault::CommsGateStuck));
    }
    // The line of comms is on too early, or never.
    assert_eq!(leaks(0.0, 0.0, Some(true)), failed(Fault::CommsGateStuck));
    assert_eq!(leaks(0.0, 0.0, Some(false)), failed(Fault::CommsLineOff));
}

#[test]
fn a_push_that_must_not_move_current_proves_nothing_while_its_line_is_not_as_it_should() {
    // The read-back is wrong in one tick of a push; what that push uses.
    let arm = |of_line: bool, wrong_tick: u32| {
        let mut arming = Arming::default();
        let (mut line, mut ticks) = (false, 0);
        (0..5_000).find_map(|_| {
            let is_wrong = ticks == wrong_tick && ticks > 0;
            let wish = arming.tick(&ArmingInputs {
                raw_a: Some((0.0, 0.0)),
                line_is_on: line != is_wrong,
                comms_line_is_on: arming.awaits_comms(),
                count: 0,
            });
            match wish {
                ArmingOutput::Off => line = false,
                ArmingOutput::Line | ArmingOutput::Push(_) => line = true,
                ArmingOutput::Proof(_, on) => {
                    line = on;
                    ticks += u32::from(on == of_line);
                }
                _ => return Some(wish),
            }
            None
        })
    };
    for (of_line, fault) in [(true, Fault::EnableStuckOff), (false, Fault::EnableStuckOn)] {
        assert_eq!(arm(of_line, 0), Some(ArmingOutput::Armed));
        for wrong_tick in [1, 7, 20, 39] {
            let end = arm(of_line, wrong_tick);
            assert_eq!(end, Some(ArmingOutput::Failed(fault)), "{wrong_tick}");
        }
    }
}

#[test]
fn a_line_that_does_not_fall_again_is_stuck() {
    let mut arming = Arming::default();
    let wish = (0..200)
        .map(|n| {
            arming.tick(&ArmingInputs {
                raw_a: Some((0.0, 0.0)),
                line_is_on: n >= 65,
                comms_line_is_on: false,
                count: 0,
            })
        })
        .find(|wish| matches!(wish, ArmingOutput::Failed(_)));
    assert_eq!(wish, Some(ArmingOutput::Failed(Fault::EnableStuckOn)));
}

/// Arms with sensors that are off by so much, and show so much more in each push that must
/// not move current; what came of it, and the offsets.
fn off(off_a: (f32, f32), leak_a: (f32, f32)) -> (ArmingOutput, Option<(f32, f32)>) {
    let mut arming = Arming::default();
    let (mut line, mut leaks) = (false, false);
    loop {
        let share = if leaks { 1.0 } else { 0.0 };
        let wish = arming.tick(&ArmingInputs {
            raw_a: Some((off_a.0 + share * leak_a.0, off_a.1 + share * leak_a.1)),
            line_is_on: line,
            comms_line_is_on: arming.awaits_comms(),
            count: 0,
        });
        leaks = matches!(wish, ArmingOutput::Proof(..));
        match wish {
            ArmingOutput::Off => line = false,
            ArmingOutput::Line | ArmingOutput::Push(_) => line = true,
            ArmingOutput::Proof(_, on) => line = on,
            _ => return (wish, arming.offsets_a()),
        }
    }
}

#[test]
fn each_sensor_is_judged_by_itself_and_by_its_own_offset() {
    let (wish, offsets_a) = off((0.09, -0.07), (0.1, 0.1));
    assert_eq!(wish, ArmingOutput::Armed);
    let (sensor_a, monitor_a) = offsets_a.unwrap();
    assert!((sensor_a - 0.09).abs() < 1e-6 && (monitor_a + 0.07).abs() < 1e-6);
    let failed = ArmingOutput::Failed;
    for off_a in [(0.11, 0.0), (0.0, 0.11)] {
        // An offset that is refused is none.
        let refused = (failed(Fault::CurrentOffset), None);
        assert_eq!(off(off_a, (0.0, 0.0)), refused);
    }
    // Against its offset; without, it would be a leak of 0.11 A, and none of 0.25.
    for leak_a in [(-0.2, 0.0), (0.0, 0.2)] {
        let (wish, _) = off((0.09, -0.09), leak_a);
        assert_eq!(wish, failed(Fault::CommsGateStuck));
    }
    assert_eq!(off((0.09, -0.09), (0.14, -0.14)).0, ArmingOutput::Armed);
}

#[test]
fn a_line_of_comms_that_falls_within_its_push_ends_the_arming() {
    let mut arming = Arming::default();
    let (mut line, mut pushes) = (false, 0);
    let wish = (0..5_000).find_map(|_| {
        let wish = arming.tick(&ArmingInputs {
            raw_a: Some((0.0, 0.0)),
            line_is_on: line,
            comms_line_is_on: arming.awaits_comms() && pushes < 30,
            count: 0,
        });
        match wish {
            ArmingOutput::Off => line = false,
            ArmingOutput::Line | ArmingOutput::Push(_) => line = true,
            ArmingOutput::Proof(_, on) => {
                line = on;
                pushes += u32::from(!on);
            }
            _ => return Some(wish),
        }
        None
    });
    assert_eq!(wish, Some(ArmingOutput::Failed(Fault::CommsLineOff)));
    assert_eq!(pushes, 30);
}
