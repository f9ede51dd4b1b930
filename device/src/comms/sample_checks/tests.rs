use super::*;
use crepitus_protocol::parameters::find;
use crepitus_protocol::telemetry::BlockFlags;
use crepitus_protocol::{DeviceSettings, LimitReason, Values};

fn bounds() -> Bounds {
    bounds_with(&[])
}

fn bounds_with(parameters: &[(&str, f64)]) -> Bounds {
    let mut values = Values::default();
    for (name, value) in parameters {
        values.set(find(name).unwrap().0, *value);
    }
    Bounds::of(&DeviceSettings::of(&values).unwrap())
}

/// Blocks of one sample until a fault.
fn blocks_until(sample: impl Fn(i32) -> Sample, state: State) -> Option<(Fault, usize)> {
    blocks_within(&bounds(), sample, state)
}

fn blocks_within(
    bounds: &Bounds,
    sample: impl Fn(i32) -> Sample,
    state: State,
) -> Option<(Fault, usize)> {
    let mut checks = SampleChecks::default();
    (0..50).find_map(|n| {
        let block = Block {
            first_tick: u64::try_from(n).unwrap() * 20,
            flags: BlockFlags::new(state, true, 1),
            samples: core::array::from_fn(|k| sample(n * 20 + i32::try_from(k).unwrap())),
            ..Block::default()
        };
        let fault = checks.check(&block, bounds, state == State::Armed)?;
        Some((fault, usize::try_from(n).unwrap() + 1))
    })
}

fn armed(sample: impl Fn(i32) -> Sample) -> Option<(Fault, usize)> {
    assert_eq!(blocks_until(&sample, State::Disarmed), None);
    blocks_until(sample, State::Armed)
}

/// A sample whose torque is its model torque.
fn energised(torque_nm: f32) -> Sample {
    Sample {
        torque_nm,
        model_torque_nm: torque_nm,
        #[expect(clippy::cast_possible_truncation, reason = "a small number")]
        current_ma: (-torque_nm / (0.0389 * 86.0) * 1e3) as i16,
        flags: SampleFlags(SampleFlags::ENERGISED),
        ..Sample::default()
    }
}

/// A wall of 4 N·m beside the joint.
const WALL: &[(&str, f64)] = &[("range-limit.render", 1.0)];

#[test]
fn what_parameters_allow_is_no_fault() {
    for torque_nm in [-4.4, -0.4, 0.0, 4.4] {
        let sample = |n| Sample {
            count: n * 9,
            ..energised(torque_nm)
        };
        assert_eq!(
            blocks_within(&bounds_with(WALL), sample, State::Armed),
            None
        );
    }
}

/// The torque is that of the model and what is added to it, or less.
#[test]
fn torque_that_the_model_does_not_give_is_a_fault() {
    let beyond = Some((Fault::TorqueBeyondBounds, 1));
    let torque = |model_torque_nm, torque_nm, limit| Sample {
        model_torque_nm,
        flags: energised(0.0).flags.with_limit(limit),
        ..energised(torque_nm)
    };
    let compensated = bounds_with(&[("friction-compensation.render", 1.0)]);
    let wall = bounds_with(WALL);
    for (bounds, sample, expected) in [
        (bounds(), torque(0.1, 0.3, LimitReason::None), beyond),
        (bounds(), torque(0.1, -0.1, LimitReason::None), beyond),
        (bounds(), torque(0.3, 0.1, LimitReason::Range), None),
        (bounds(), torque(0.3, 0.0, LimitReason::TurnedBack), None),
        (bounds(), torque(0.1, 0.3, LimitReason::Tank), beyond),
        (bounds(), torque(0.1, 0.3, LimitReason::Holding), None),
        (compensated, torque(0.1, -0.3, LimitReason::None), None),
        (compensated, torque(0.1, -0.45, LimitReason::None), beyond),
        // A joint of 0.4 N·m, whose hand has turned back, beside a wall.
        (wall, torque(1.6, 2.0, LimitReason::TurnedBack), None),
        (wall, torque(1.6, 2.0, LimitReason::None), beyond),
        (wall, torque(1.6, 2.1, LimitReason::TurnedBack), beyond),
        (wall, torque(4.4, 4.4, LimitReason::None), None),
    ] {
        let found = blocks_within(&bounds, |_| sample, State::Armed);
        assert_eq!(found, expected, "{sample:?}");
    }
}

/// One set's symptoms fade while the other's begin.
#[test]
fn while_parameters_change_torques_of_both_sets_add_up() {
    let rough = bounds_with(&[("crepitus.static_torque_nm", 1.0)]);
    let both = bounds().or(rough);
    let found = |bounds, nm| blocks_within(&bounds, |_| energised(nm), State::Armed);
    let beyond = Some((Fault::TorqueBeyondBounds, 1));
    assert_eq!(found(both, 1.39), None);
    assert_eq!(found(both, 1.41), beyond);
    assert_eq!(found(rough, 1.01), beyond);
}

#[test]
fn too_much_of_anything_is_a_fault() {
    let over = |_| Sample {
        current_ma: -1_960,
        ..Sample::default()
    };
    assert_eq!(armed(over), Some((Fault::CommsOvercurrent, 1)));
    let beyond = Some((Fault::TorqueBeyondBounds, 1));
    assert_eq!(armed(|_| energised(4.51)), beyond);
    assert_eq!(armed(|_| energised(f32::NAN)), beyond);
    assert_eq!(armed(|_| energised(-0.41)), beyond);
    let beside = |_| Sample {
        current_ma: 500,
        ..energised(0.0)
    };
    assert_eq!(armed(beside), Some((Fault::CurrentBesideTorque, 6)));
    // Also of a drive that says that it drives nothing, but for a leg that coasts fast.
    let floating = |counts: i32| {
        move |n: i32| Sample {
            count: n * counts,
            flags: SampleFlags::default(),
            ..beside(n)
        }
    };
    assert_eq!(armed(floating(0)), Some((Fault::CurrentBesideTorque, 6)));
    assert_eq!(armed(floating(3)), Some((Fault::CurrentBesideTorque, 6)));
    assert_eq!(armed(floating(7)), None);
    assert_eq!(blocks_until(floating(0), State::Arming), None);
    // 5.73 rad/s are 8.0 counts a tick, with 15 % and the bound's two counts 9.4.
    let fast = |n: i32| Sample {
        count: n * 10,
        ..energised(0.0)
    };
    assert_eq!(armed(fast), Some((Fault::CommsOverspeed, 4)));
    // Also where the drive says that the voltage is at its limit.
    let limited = |n| Sample {
        flags: fast(n).flags.with_limit(LimitReason::Voltage),
        ..fast(n)
    };
    assert_eq!(armed(limited), Some((Fault::CommsOverspeed, 4)));
}

#[test]
fn torque_outside_the_range_or_without_a_zero_is_a_fault() {
    // 61,155 counts are 125°, −2,446 are −5°.
    let outside = Some((Fault::TorqueOutsideRange, 1));
    for (count, torque_nm, expected) in [
        (61_155, 0.1, None),
        (61_156, 0.1, outside),
        (61_156, 0.0, None),
        (-2_446, -0.1, None),
        (-2_447, -0.1, outside),
        (i32::MIN, 0.1, outside),
    ] {
        let sample = |_| Sample {
            count,
            ..energised(torque_nm)
        };
        assert_eq!(armed(sample), expected, "{count}");
    }
    let block = Block {
        flags: BlockFlags::new(State::Armed, false, 1),
        samples: [energised(0.1); 20],
        ..Block::default()
    };
    let fault = SampleChecks::default().check(&block, &bounds(), true);
    assert_eq!(fault, Some(Fault::TorqueOutsideRange));
}

#[test]
fn what_the_drive_stops_by_itself_is_no_fault_of_comms() {
    // Three samples, and then it has reacted.
    let over = |n: i32| Sample {
        current_ma: if n % 20 < 3 { 2_400 } else { 0 },
        ..Sample::default()
    };
    assert_eq!(armed(over), None);
    let fast = |n: i32| Sample {
        count: n.min(60) * 10,
        ..energised(0.0)
    };
    assert_eq!(armed(fast), None);
}

/// 8 counts in a tick are 5.7 rad/s, beyond which the supply lacks the voltage for 0.37 A.
#[test]
fn a_speed_that_needs_all_voltage_excuses_a_current_and_the_drives_word_does_not() {
    let beside = Some((Fault::CurrentBesideTorque, 6));
    for (counts, expected) in [(0, beside), (4, beside), (7, beside), (8, None)] {
        for limit in [
            LimitReason::None,
            LimitReason::Voltage,
            LimitReason::Current,
        ] {
            let sample = |n: i32| Sample {
                count: n * counts,
                current_ma: 300,
                flags: energised(0.0).flags.with_limit(limit),
                ..energised(0.4)
            };
            assert_eq!(armed(sample), expected, "{counts}, {limit:?}");
        }
    }
}

/// A setpoint beyond the current's limit is cut.
#[test]
fn the_current_is_that_of_the_torque_up_to_its_limit() {
    let mut bounds = bounds_with(WALL);
    bounds.setpoint_a = 0.5;
    let with_current = |current_ma| {
        let sample = |_| Sample {
            current_ma,
            ..energised(4.0)
        };
        blocks_within(&bounds, sample, State::Armed)
    };
    assert_eq!(with_current(-500), None);
    // That of 4 N·m.
    let beside = Some((Fault::CurrentBesideTorque, 6));
    assert_eq!(with_current(-1_196), beside);
}

#[test]
fn what_most_samples_show_is_a_fault_and_what_few_show_is_none() {
    let good = energised(0.1);
    let over = Sample {
        current_ma: 2_000,
        flags: SampleFlags::default(),
        ..good
    };
    let beyond = energised(0.5);
    let beside = Sample {
        current_ma: 500,
        ..good
    };
    let outside = Sample {
        count: 70_000,
        ..good
    };
    let few: [fn(i32) -> bool; 3] = [|n| n % 2 == 0, |n| n % 4 == 0, |n| n % 100 < 3];
    // Blocks until three in four are a fault.
    for (bad, fault, blocks) in [
        (over, Fault::CommsOvercurrent, 1),
        (beyond, Fault::TorqueBeyondBounds, 1),
        (beside, Fault::CurrentBesideTorque, 12),
        (outside, Fault::TorqueOutsideRange, 1),
    ] {
        let mixed = |worse: fn(i32) -> bool| {
            blocks_until(|n| if worse(n) { bad } else { good }, State::Armed)
        };
        assert_eq!(mixed(|n| n % 4 != 3), Some((fault, blocks)));
        for few in few {
            assert_eq!(mixed(few), None, "{fault:?}");
        }
    }
    // Two fast blocks of three.
    let mut checks = SampleChecks::default();
    let mut count = 0;
    let found = (0..40_u64).find_map(|n| {
        let step = if n % 3 == 2 { 0 } else { 12 };
        let samples = core::array::from_fn(|_| {
            count += step;
            Sample { count, ..good }
        });
        let block = Block {
            first_tick: n * 20,
            flags: BlockFlags::new(State::Armed, true, 1),
            samples,
            ..Block::default()
        };
        Some((checks.check(&block, &bounds(), true)?, n))
    });
    assert_eq!(found, Some((Fault::CommsOverspeed, 7)));
}

/// A stiff joint that rises and breaks in turn: the current lags by 0.4 A, and overtakes.
#[test]
fn a_current_that_lags_behind_a_torque_that_breaks_again_and_again_is_no_fault() {
    /// Share of its lag that the current makes up for in a tick: 1 − e^(−2π·f·h).
    const SHARE: f32 = 0.269_6;
    let bounds = bounds_with(&[
        ("crepitus.kinetic_torque_nm", 2.0),
        ("crepitus.static_torque_nm", 4.0),
    ]);
    let mut current_a = 0.0_f32;
    let samples: std::vec::Vec<Sample> = (0..1_000_i16)
        .map(|n| {
            let torque_nm = 0.4 * f32::from(n % 10);
            let sample = Sample {
                #[expect(clippy::cast_possible_truncation, reason = "a small number")]
                current_ma: (current_a * 1e3) as i16,
                ..energised(torque_nm)
            };
            current_a += SHARE * (-torque_nm * bounds.amperes_per_nm - current_a);
            sample
        })
        .collect();
    let far = samples.iter().filter(|sample| {
        let off_a = f32::from(sample.current_ma) * 1e-3 + sample.torque_nm * 0.299;
        off_a.abs() > CURRENT_SLACK_A
    });
    assert!(far.count() > 500, "most of them are beyond the slack");
    let sample = |n: i32| samples[usize::try_from(n).unwrap()];
    assert_eq!(blocks_within(&bounds, sample, State::Armed), None);
}

/// However the drive says that it has no count, speed and place are checked.
#[test]
fn counts_that_are_said_to_be_lost_switch_no_check_off() {
    let lost = |every: i32, step: i32| {
        move |n: i32| Sample {
            count: n * step,
            flags: energised(0.0).flags.with(SampleFlags::LOST, n % every == 0),
            ..energised(0.0)
        }
    };
    let outside = |blocks| Some((Fault::TorqueOutsideRange, blocks));
    assert_eq!(armed(lost(1, 0)), outside(2));
    // As the drive, in more than one of nine.
    assert_eq!(armed(lost(4, 0)), outside(13));
    assert_eq!(armed(lost(10, 0)), None);
    assert_eq!(armed(lost(20, 12)), Some((Fault::CommsOverspeed, 4)));
}

#[test]
fn gaps_excuse() {
    let mut checks = SampleChecks::default();
    for n in 0..50 {
        let block = Block {
            first_tick: u64::try_from(n).unwrap() * 240,
            flags: BlockFlags::new(State::Armed, true, 1),
            samples: [Sample {
                count: n * 100_000,
                ..Sample::default()
            }; 20],
            ..Block::default()
        };
        assert_eq!(checks.check(&block, &bounds(), true), None);
    }
}

/// The checks do not depend on the state that the drive reports.
#[test]
fn a_drive_that_says_it_is_not_armed_is_checked_while_the_line_is_on() {
    let check = |sample: Sample, line_is_on: bool| {
        let mut checks = SampleChecks::default();
        (0..10).find_map(|n| {
            let block = Block {
                first_tick: n * 20,
                flags: BlockFlags::new(State::Disarmed, true, 1),
                samples: [sample; 20],
                ..Block::default()
            };
            let fault = checks.check(&block, &bounds(), line_is_on)?;
            Some((fault, n + 1))
        })
    };
    let over = Sample {
        current_ma: 2_000,
        ..Sample::default()
    };
    for (sample, found) in [
        (over, (Fault::CommsOvercurrent, 1)),
        (energised(5.0), (Fault::TorqueBeyondBounds, 1)),
        (energised(0.3), (Fault::TorqueBeyondBounds, 2)),
    ] {
        assert_eq!(check(sample, true), Some(found));
        assert_eq!(check(sample, false), None);
    }
    assert_eq!(check(Sample::default(), true), None);
}

/// The last block of an honest drive, wherever in it torque ends, and whatever it has found:
/// that the zero is lost, or a current that stays.
#[test]
fn what_a_drive_has_just_found_is_no_second_fault() {
    for (last, zeroed) in (0..20).flat_map(|last| [(last, true), (last, false)]) {
        let mut checks = SampleChecks::default();
        for n in 0..6 {
            let is_last = n == 3;
            let state = if n < 3 { State::Armed } else { State::Faulted };
            let after = Sample {
                current_ma: if is_last { 2_500 } else { 0 },
                ..Sample::default()
            };
            let block = Block {
                first_tick: n * 20,
                flags: BlockFlags::new(state, zeroed || n < 3, 1),
                samples: core::array::from_fn(|k| {
                    if n < 3 || is_last && k < last {
                        energised(0.3)
                    } else {
                        after
                    }
                }),
                ..Block::default()
            };
            assert_eq!(checks.check(&block, &bounds(), true), None, "{last} {n}");
        }
    }
}

#[test]
fn torque_without_a_current_is_beside_it() {
    let without = |n: i32| Sample {
        current_ma: if n % 4 == 0 { NO_CURRENT } else { 1_200 },
        ..energised(0.2)
    };
    assert_eq!(armed(without), Some((Fault::CurrentBesideTorque, 6)));
}

/// Every second block lost, and every second one with a lost count.
#[test]
fn a_runaway_is_seen_through_gaps() {
    for (step, lost_every) in [(2, 0), (1, 2), (3, 0)] {
        let mut checks = SampleChecks::default();
        let found = (0..40).step_by(step).position(|n: i32| {
            let is_lost = lost_every > 0 && n % lost_every == 1;
            let block = Block {
                first_tick: u64::try_from(n).unwrap() * 20,
                flags: BlockFlags::new(State::Armed, true, 1),
                samples: core::array::from_fn(|k| Sample {
                    count: (n * 20 + i32::try_from(k).unwrap()) * 12,
                    flags: energised(0.0)
                        .flags
                        .with(SampleFlags::LOST, is_lost && k == 7),
                    ..energised(0.0)
                }),
                ..Block::default()
            };
            checks.check(&block, &bounds(), true) == Some(Fault::CommsOverspeed)
        });
        assert!(
            found.is_some_and(|n| n <= 7),
            "{step} {lost_every} {found:?}"
        );
    }
}
