//! Every criterion is shown an observation that is right and one that is
//! wrong: a criterion that cannot fail is not a criterion.

use super::*;
use crate::stability::criterion::Limits;
use crate::stability::input::{Input, Shaft};
use crepitus_model::{Convention, EventKind, Sense};
use crepitus_plant::Extremes;
use crepitus_scene::scene::Precision;

const SUBJECT: Subject = Subject {
    solver: Rung::Ladder(Solver::ExactEvents),
    convention: Convention::Physical,
    precision: Precision::F64,
};

fn event(time_s: f64, kind: EventKind) -> TimedEvent {
    TimedEvent {
        time_s,
        kind,
        sense: Sense::Positive,
    }
}

/// Ten cycles of 30 ms in 0.3 s of steps of 1 ms; each sticks after 20 ms.
fn truth() -> Vec<TrueEvent> {
    (0..10_u8)
        .flat_map(|n| {
            let start = 1e-3 + 30e-3 * f64::from(n);
            [
                (event(start, EventKind::Break), 0.2),
                (event(start + 20e-3, EventKind::Stick), 0.0),
            ]
        })
        .map(|(event, torque_after_nm)| TrueEvent {
            event,
            torque_before_nm: 0.4,
            theta_rad: 0.0,
            torque_after_nm,
        })
        .collect()
}

/// Observation of a run in which `events` happen.
fn seen(events: &[TrueEvent]) -> Observation {
    let mut seen = Observation {
        steps: 300,
        step_s: 1e-3,
        peak: 1.0,
        ..Observation::default()
    };
    for e in events {
        seen.tally.add(&e.event);
        seen.events.push(e.event);
        seen.torques_after_nm.push(e.torque_after_nm);
    }
    seen
}

fn find(criterion: &Criterion, seen: &Observation, twin: Option<&Observation>) -> Verdict {
    let truth = truth();
    let evidence = Evidence {
        subject: SUBJECT,
        seen,
        truth: &truth,
        twin,
    };
    judge(criterion, &evidence).verdict(false)
}

/// `criterion` holds as things should be; what comes of `change`.
fn after(criterion: &Criterion, change: impl Fn(&mut Observation)) -> Verdict {
    let mut run = seen(&truth());
    run.late_torque.add(0.1);
    run.swing_rad = Some((1e-3, 2e-3));
    let right = find(criterion, &run, None);
    assert!(right.holds(), "{criterion}: {right}");
    change(&mut run);
    let wrong = find(criterion, &run, None);
    assert!(!wrong.holds(), "{criterion}: {wrong}");
    wrong
}

#[test]
fn bounds_come_first_and_say_when() {
    let bounds = |change: fn(&mut Observation)| {
        let mut run = seen(&truth());
        change(&mut run);
        let evidence = Evidence {
            subject: SUBJECT,
            seen: &run,
            truth: &[],
            twin: None,
        };
        common(&evidence).map(|f| f.verdict(true).to_string())
    };
    assert_eq!(bounds(|_| ()), None);
    let text = |change| bounds(change).unwrap();
    assert_eq!(
        text(|run| run.overflow_s = Some(0.5)),
        "fails, flagged: overflow at t = 0.500 s"
    );
    assert!(text(|run| run.above_s = Some(0.5)).contains("above its limit"));
    assert!(text(|run| run.imbalance = Some(1e-9)).starts_with("degrades"));
    assert!(text(|run| run.imbalance = Some(f64::NAN)).starts_with("degrades"));
    assert_eq!(bounds(|run| run.imbalance = Some(1e-11)), None);
}

#[test]
fn events_are_counted_and_timed() {
    let criterion = Criterion::Events {
        within_s: Limits::both(1e-6),
    };
    let late = after(&criterion, |run| run.events[3].time_s += 1e-5);
    assert!(matches!(late, Verdict::Degrades { .. }), "{late}");
    let lost = after(&criterion, |run| {
        let mut events = truth();
        events.drain(4..6);
        *run = seen(&events);
    });
    assert_eq!(lost.to_string(), "fails: 18 events instead of 20");
    let other = after(&criterion, |run| {
        run.events[3].kind = EventKind::Reverse;
    });
    assert!(other.to_string().contains("same number"), "{other}");
    let torque = Criterion::EventTorques {
        within_nm: Limits::both(1e-6),
    };
    after(&torque, |run| run.torques_after_nm[5] += 1e-5);
}

#[test]
fn counts_and_rates_have_both_sides() {
    for (what, least, most) in [
        (Counted::Events, 20, 20),
        (Counted::Breaks, 9, 10),
        (Counted::Reverses, 0, 0),
    ] {
        let criterion = Criterion::Count { what, least, most };
        after(&criterion, |run| {
            run.tally.breaks += 1;
            run.tally.reverses += 1;
        });
    }
    let some = Criterion::Count {
        what: Counted::Events,
        least: 20,
        most: 30,
    };
    after(&some, |run| run.tally.sticks = 0);
    after(&Criterion::EventsPerStep { most: 4 }, |run| {
        run.tally.most_in_step = 5;
    });
    after(&Criterion::EventsPerSecond { most: 70.0 }, |run| {
        run.tally.breaks += 2;
    });
    let rate = |hz| Criterion::CycleRate {
        hz,
        within: Limits::both(1e-6),
    };
    let run = seen(&truth());
    assert!(find(&rate(1.0 / 0.03), &run, None).holds());
    let off = find(&rate(1.0 / 0.031), &run, None);
    assert!(matches!(off, Verdict::Degrades { .. }), "{off}");
    let chatter = find(&rate(1.0), &run, None);
    assert!(matches!(chatter, Verdict::Fails { .. }), "{chatter}");
    let silent = find(&rate(1.0 / 0.03), &seen(&[]), None);
    assert!(matches!(silent, Verdict::Fails { .. }), "{silent}");
}

#[test]
fn intervals_and_slips_have_a_length() {
    let mut uneven = truth();
    uneven[10].event.time_s += 5e-3;
    let uneven = seen(&uneven);
    let variation = Criterion::IntervalVariation { most: 0.03 };
    after(&variation, |run| *run = uneven.clone());
    after(&variation, |run| *run = seen(&[]));
    let slip = Criterion::SlipTime {
        slip_s: 20e-3,
        within: Limits::both(1e-6),
    };
    after(&slip, |run| *run = uneven.clone());
    after(&slip, |run| *run = seen(&[]));
    after(&Criterion::SilentAfter { time_s: 0.292 }, |run| {
        run.tally.last_s = Some(0.293);
    });
}

#[test]
fn torques_stay_return_and_keep_their_band() {
    let band = Criterion::TorqueWithin {
        from_s: 0.0,
        low_nm: 0.0,
        high_nm: 0.4,
        slack_nm: 1e-5,
    };
    after(&band, |run| run.late_torque.add(0.400_02));
    after(&band, |run| run.late_torque.add(-2e-5));
    // Nothing was looked at.
    let none = after(&band, |run| run.late_torque = Extremes::default());
    assert!(none.to_string().contains("no torque"), "{none}");
    let quiet = Criterion::TorqueQuiet {
        from_s: 0.0,
        most_nm: 1e-3,
    };
    after(&quiet, |run| run.late_torque.add(0.102));
    after(&quiet, |run| run.late_torque = Extremes::default());
    let stays = Criterion::TorqueStays { from_s: 0.1 };
    after(&stays, |run| run.last_change = 102);
    let limits = Limits::both(1e-9);
    let returns = Criterion::TorqueReturns { within_nm: limits };
    after(&returns, |run| run.last_torque_nm = 2e-9);
    after(&Criterion::LoopArea { most_j: limits }, |run| {
        run.work_j = -2e-9;
    });
    after(&Criterion::Survives, |run| run.peak = 1.001);
    after(&Criterion::NoBreakAtRest, |run| {
        run.tally.breaks_at_rest = 1;
    });
    let leads = Criterion::SlipsWithShaft {
        within_rad_s: limits,
    };
    after(&leads, |run| run.lag_rad_s = 1e-6);
}

#[test]
fn bits_hands_and_refusals_are_compared() {
    let mut run = seen(&truth());
    run.torque_bits.add(1);
    let criterion = Criterion::TorqueBits(run.torque_bits.0);
    assert!(find(&criterion, &run, None).holds());
    let other = Input::Sampled {
        shaft: Shaft::Constant(1.0),
        duration_s: 1.0,
        step_s: 1e-3,
    };
    let same = Criterion::SameAs(other.clone());
    let mirror = Criterion::MirrorOf(other);
    let mut twin = run.clone();
    twin.mirrored_bits = run.torque_bits;
    assert!(find(&same, &run, Some(&twin)).holds());
    assert!(find(&mirror, &run, Some(&twin)).holds());
    twin.torque_bits.add(2);
    twin.mirrored_bits.add(2);
    assert!(!find(&same, &run, Some(&twin)).holds());
    assert!(!find(&mirror, &run, Some(&twin)).holds());
    assert!(!find(&criterion, &twin, None).holds());
    let swing = Criterion::SwingRatio {
        theory: 2.0,
        within: 0.01,
    };
    after(&swing, |run| run.swing_rad = Some((1e-3, 2.1e-3)));
    after(&swing, |run| run.swing_rad = None);
    let refused = after(&Criterion::Refused, |run| run.accepted = vec!["kr = 0"]);
    assert_eq!(refused.to_string(), "fails: kr = 0");
    after(&Criterion::Subnormals { most: 10 }, |run| {
        run.subnormals = 11;
    });
}

#[test]
fn a_device_is_held_to_its_rules() {
    let first = Criterion::FirstBreakAfter {
        from_s: 0.265,
        at_s: 0.271,
        within_s: Limits::both(1e-6),
    };
    let late = after(&first, |run| run.events[18].time_s += 1e-5);
    assert!(matches!(late, Verdict::Degrades { .. }), "{late}");
    let other = after(&first, |run| run.events[18].kind = EventKind::Stick);
    assert!(other.to_string().contains("no break"), "{other}");
    after(&first, |run| run.events.truncate(18));
    let most = Limits::both(1e-9);
    after(&Criterion::SlipEnergy { most }, |run| {
        run.slip_energy = 1e-8;
    });
    after(&Criterion::GuardTicks { least: 0, most: 0 }, |run| {
        run.guard_ticks = 1;
    });
    let run = seen(&truth());
    let some = Criterion::GuardTicks { least: 1, most: 9 };
    assert!(!find(&some, &run, None).holds());
}
