use super::*;
use crate::accuracy::point::tests::point;
use crate::accuracy::target::{LABEL, Row, STEP_SHARE, TICK_CYCLES};

/// A rung on two scenes: cost of a step, torque error, interval error.
fn rung(solver: &'static str, step_s: f64, ns: f64, torque: f64, interval: f64) -> [Point; 2] {
    ["slow", "fast"].map(|scene| Point {
        scene: scene.to_owned(),
        ns_per_step: ns,
        us_per_simulated_s: ns * 1e-3 / step_s,
        rms_held_torque_error_nm: torque,
        max_interval_error_s: interval,
        ..point(solver, step_s)
    })
}

fn ask(points: &[Point], need: &str, step_s: Option<f64>) -> Answer {
    let question = Question {
        convention: "frozen",
        precision: "f32",
        step_s,
        target: None,
    };
    answer(points, &need.parse().unwrap(), &question)
}

fn name(candidate: Option<&Candidate>) -> Option<(&'static str, f64)> {
    candidate.map(|c| (c.solver, c.step_s))
}

#[test]
fn the_cheapest_that_meets_the_need_is_chosen_and_the_rest_explained() {
    let points = [
        rung("a", 5e-5, 2.0, 9e-3, 1e-4),
        rung("b", 5e-5, 3.0, 4e-3, 4e-4),
        rung("c", 5e-5, 4.0, 4e-3, 1e-5),
        rung("d", 5e-5, 9.0, 1e-3, 1e-5),
    ]
    .concat();
    let a = ask(&points, "torque=5e-3,interval=5e-4", Some(5e-5));
    assert_eq!(name(a.chosen.as_ref()), Some(("b", 5e-5)));
    // Both are used to 80 %; c is as tight in torque, d is not.
    assert_eq!(a.chosen.as_ref().unwrap().tightest().unwrap().ratio(), 0.8);
    assert_eq!(a.cheaper.len(), 1);
    let why = a.cheaper[0].tightest().unwrap();
    assert_eq!(why.limit.criterion, Criterion::Torque);
    assert!((why.ratio() - 1.8).abs() < 1e-12);
    assert!(a.equals.is_empty() && a.nearest.is_none() && a.longest.is_empty());
    let a = ask(&points, "torque=5e-3", Some(5e-5));
    assert_eq!(name(a.better.as_ref()), Some(("d", 5e-5)));
    assert!((a.chosen.unwrap().core_share() - 60e-6).abs() < 1e-12);
}

#[test]
fn a_need_holds_on_all_scenes_or_not_at_all() {
    let mut points = [
        rung("a", 5e-5, 2.0, 1e-3, 1e-5),
        rung("b", 5e-5, 3.0, 1e-3, 1e-5),
    ]
    .concat();
    points[1].rms_held_torque_error_nm = 6e-3;
    let a = ask(&points, "torque=5e-3", Some(5e-5));
    assert_eq!(name(a.chosen.as_ref()), Some(("b", 5e-5)));
    assert_eq!(a.cheaper[0].tightest().unwrap().scene, "fast");
}

#[test]
fn what_the_encoder_costs_is_no_solver_s_fault() {
    let mut points = rung("a", 5e-5, 2.0, 1e-3, 1e-5).to_vec();
    let behind = points.clone().into_iter().map(|p| Point {
        input: "encoder",
        unmatched: 3,
        rms_held_torque_error_nm: 1.0,
        ..p
    });
    points.extend(behind.collect::<Vec<_>>());
    let a = ask(&points, "torque=5e-3", Some(5e-5));
    assert_eq!(name(a.chosen.as_ref()), Some(("a", 5e-5)));
}

#[test]
fn unmatched_events_fail_however_small_the_errors() {
    let mut points = [
        rung("a", 5e-5, 2.0, 1e-9, 1e-9),
        rung("b", 5e-5, 3.0, 1e-3, 1e-5),
    ]
    .concat();
    points[0].unmatched = 3;
    let a = ask(&points, "torque=5e-3", Some(5e-5));
    assert_eq!(name(a.chosen.as_ref()), Some(("b", 5e-5)));
    let lost = a.cheaper[0].unmatched.as_ref().unwrap();
    assert_eq!((lost.events, lost.scene.as_str()), (3, "slow"));
}

#[test]
fn at_equal_cost_the_more_exact_wins() {
    let mut points = [
        rung("a", 5e-5, 3.00, 4e-3, 1e-5),
        rung("b", 5e-5, 3.02, 1e-4, 1e-5),
        rung("c", 5e-5, 3.50, 1e-6, 1e-5),
    ]
    .concat();
    let a = ask(&points, "torque=5e-3", Some(5e-5));
    assert_eq!(name(a.chosen.as_ref()), Some(("b", 5e-5)));
    assert_eq!(name(a.equals.first()), Some(("a", 5e-5)));
    assert!(a.cheaper.is_empty());
    for p in &mut points {
        p.time_spread = 0.001;
    }
    let a = ask(&points, "torque=5e-3", Some(5e-5));
    assert_eq!(name(a.chosen.as_ref()), Some(("a", 5e-5)));
}

#[test]
fn without_a_step_the_longest_of_each_rung_is_reported() {
    let points = [
        rung("a", 1e-3, 2.0, 9e-3, 1e-5),
        rung("a", 1e-4, 2.0, 4e-3, 1e-5),
        rung("a", 1e-5, 2.0, 8e-3, 1e-5),
        rung("b", 1e-3, 8.0, 1e-3, 1e-5),
        rung("c", 1e-3, 1.0, 1.0, 1e-5),
    ]
    .concat();
    let a = ask(&points, "torque=5e-3", None);
    // 8 ns a millisecond are less than 2 ns a tenth of it.
    assert_eq!(name(a.chosen.as_ref()), Some(("b", 1e-3)));
    let reported: Vec<_> = a
        .longest
        .iter()
        .map(|l| (l.solver, name(l.candidate.as_ref()).map(|n| n.1)))
        .collect();
    assert_eq!(
        reported,
        [("a", Some(1e-4)), ("b", Some(1e-3)), ("c", None)]
    );
    assert_eq!(a.longest[0].fails_below_s, [1e-5]);
    // Of each rung the costliest that is still cheaper.
    let cheaper: Vec<_> = a.cheaper.iter().map(|c| (c.solver, c.step_s)).collect();
    assert_eq!(cheaper, [("a", 1e-3), ("c", 1e-3)]);
}

#[test]
fn where_nothing_is_enough_the_nearest_is_reported() {
    let mut points = [
        rung("a", 5e-5, 2.0, 9e-3, 1e-5),
        rung("b", 5e-5, 3.0, 7e-3, 1e-5),
        rung("c", 5e-5, 3.0, 1e-9, 1e-5),
    ]
    .concat();
    points[5].unmatched = 1;
    let a = ask(&points, "torque=5e-3", Some(5e-5));
    assert!(a.chosen.is_none() && a.cheaper.is_empty() && a.better.is_none());
    assert_eq!(name(a.nearest.as_ref()), Some(("b", 5e-5)));
}

#[test]
fn other_conventions_precisions_and_steps_do_not_count() {
    let mut points = [
        rung("a", 5e-5, 1.0, 1e-3, 1e-5),
        rung("b", 5e-5, 2.0, 1e-3, 1e-5),
        rung("c", 1e-3, 1.0, 1e-3, 1e-5),
        rung("d", 5e-5, 3.0, 1e-3, 1e-5),
    ]
    .concat();
    points[0].convention = "physical";
    points[1].convention = "physical";
    points[2].precision = "f64";
    points[3].precision = "f64";
    let a = ask(&points, "torque=5e-3", Some(5e-5));
    assert_eq!(name(a.chosen.as_ref()), Some(("d", 5e-5)));
    assert!(a.equals.is_empty() && a.cheaper.is_empty());
}

#[test]
fn what_is_not_known_fails_in_torque_and_passes_where_there_is_no_event() {
    let mut points = rung("a", 5e-5, 2.0, 1e-3, f64::NAN).to_vec();
    assert!(ask(&points, "interval=1e-9", None).chosen.is_some());
    points[0].rms_held_torque_error_nm = f64::NAN;
    assert!(ask(&points, "torque=1", None).chosen.is_none());
}

/// Rungs with their mean and worst cycles.
fn target(rungs: &[(&'static str, f64, u32)]) -> OnTarget {
    let row = |&(subject, mean_cycles, worst_cycles): &(&'static str, f64, u32)| Row {
        subject,
        form: None,
        convention: Some("frozen"),
        is_rung: true,
        frequency_error_rel: 1e-8,
        mean_cycles,
        worst_cycles,
        worst_on: "white velocities".to_owned(),
        mean_instructions: 40.0,
        worst_instructions: 200,
        mean_share: mean_cycles / TICK_CYCLES,
        worst_share: f64::from(worst_cycles) / TICK_CYCLES,
        steps: 100,
    };
    OnTarget {
        label: LABEL,
        tick_cycles: TICK_CYCLES,
        steps: 100,
        rows: rungs.iter().map(row).collect(),
    }
}

fn ask_on_target(points: &[Point], rungs: &[(&'static str, f64, u32)]) -> Answer {
    let question = Question {
        convention: "frozen",
        precision: "f32",
        step_s: Some(5e-5),
        target: Some(&target(rungs)),
    };
    answer(points, &"torque=5e-3".parse().unwrap(), &question)
}

#[test]
fn on_the_target_its_cycles_choose_and_not_the_hosts_time() {
    let points = [
        rung("exact", 5e-5, 1.0, 9e-3, 1e-4),
        rung("exact-break", 5e-5, 2.0, 4e-3, 1e-5),
        rung("exact-interpolated", 5e-5, 2.6, 4e-3, 1e-5),
    ]
    .concat();
    // The host's time decides without the target.
    let a = ask(&points, "torque=5e-3", Some(5e-5));
    assert_eq!(name(a.chosen.as_ref()), Some(("exact-break", 5e-5)));
    let cycles = [
        ("exact", 90.0, 356),
        ("exact-break", 112.0, 415),
        ("exact-interpolated", 93.0, 359),
    ];
    let a = ask_on_target(&points, &cycles);
    assert_eq!(name(a.chosen.as_ref()), Some(("exact-interpolated", 5e-5)));
    assert_eq!(name(a.runner_up.as_ref()), Some(("exact-break", 5e-5)));
    assert_eq!(a.chosen.unwrap().cycles.unwrap().worst, 359);
    assert_eq!(a.failed.len(), 1);
    assert_eq!(a.failed[0].solver, "exact");
}

#[test]
fn a_worst_step_beyond_its_share_of_a_tick_fails_however_cheap_the_mean() {
    let points = [
        rung("exact-break", 5e-5, 2.0, 4e-3, 1e-5),
        rung("exact-events", 5e-5, 2.0, 4e-3, 1e-5),
    ]
    .concat();
    let most = 1_680;
    assert_eq!(f64::from(most), STEP_SHARE * TICK_CYCLES);
    let a = ask_on_target(
        &points,
        &[
            ("exact-break", 50.0, most + 1),
            ("exact-events", 300.0, most),
        ],
    );
    assert_eq!(name(a.chosen.as_ref()), Some(("exact-events", 5e-5)));
    assert_eq!(a.failed[0].solver, "exact-break");
    assert!(!a.failed[0].cycles.as_ref().unwrap().fits());
    assert!(a.failed[0].tightest().unwrap().ratio() <= 1.0);
}

#[test]
fn equal_means_are_decided_by_the_worst() {
    let points = [
        rung("exact-break", 5e-5, 2.0, 1e-3, 1e-5),
        rung("exact-events", 5e-5, 3.0, 4e-3, 1e-5),
        rung("exact-interpolated", 5e-5, 1.0, 4e-3, 1e-5),
    ]
    .concat();
    let a = ask_on_target(
        &points,
        &[("exact-break", 100.0, 401), ("exact-events", 100.0, 400)],
    );
    assert_eq!(name(a.chosen.as_ref()), Some(("exact-events", 5e-5)));
    assert_eq!(name(a.runner_up.as_ref()), Some(("exact-break", 5e-5)));
    assert!(a.equals.is_empty());
    // What was not run there is no candidate; what costs the same to the cycle
    // is decided by its errors.
    let a = ask_on_target(
        &points,
        &[("exact-break", 100.0, 400), ("exact-events", 100.0, 400)],
    );
    assert_eq!(name(a.chosen.as_ref()), Some(("exact-break", 5e-5)));
    assert_eq!(name(a.equals.first()), Some(("exact-events", 5e-5)));
}

#[test]
fn a_limit_below_the_floor_of_holding_is_called_unreachable() {
    let mut points = rung("a", 5e-5, 2.0, 6e-3, 1e-5).to_vec();
    let a = ask(&points, "torque=5e-3", Some(5e-5));
    assert!(a.chosen.is_none() && a.unreachable.is_none());
    points[1].held_floor_nm = 5.1e-3;
    let a = ask(&points, "torque=5e-3", Some(5e-5));
    let why = a.unreachable.unwrap();
    assert_eq!(
        (why.floor_nm, why.scene.as_str(), why.step_s),
        (5.1e-3, "fast", 5e-5)
    );
    // At the tick there is no floor.
    assert!(
        ask(&points, "torque-at-tick=1e-9", Some(5e-5))
            .unreachable
            .is_none()
    );
}
