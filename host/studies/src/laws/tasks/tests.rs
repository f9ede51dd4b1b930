use super::*;
use crate::laws::cycles::Cycles;
use crate::laws::reference::{demanded, torques};
use crate::laws::runner::{TICK_S, TICKS_HZ};
use crate::laws::task::{Demand, Extent, Reading, Setting};
use crate::true_events::true_events;
use crepitus_ladder::laws::{ENTRIES, Entry};
use crepitus_model::EventKind;
use crepitus_plant::Motion;
use crepitus_scene::preset::{Joint, joints};
use crepitus_scene::scene::Precision;

fn entry(name: &str) -> &'static Entry {
    let mut entries = ENTRIES.iter();
    entries.find(|entry| entry.name == name).unwrap()
}

/// A law in f64 at the device's tick on a task of a joint.
fn measured(task: &dyn Task, law: &str, joint: Joint) -> Vec<(Demand, Reading)> {
    let extent = Extent::Quick;
    let prepared = task.prepare(&Setting { joint, extent }).unwrap();
    let never = || false;
    let runner = Runner::new(entry(law), &joint.parameters, Precision::F64, 1, &never);
    let readings = prepared.measure(&runner).unwrap();
    assert_eq!(runner.trouble(), None);
    prepared.demanded().into_iter().zip(readings).collect()
}

fn value((_, reading): &(Demand, Reading)) -> f64 {
    assert_eq!(reading.failed, None);
    reading.value.unwrap()
}

#[test]
fn names_are_unique_and_all_is_said() {
    let mut names: Vec<&str> = TASKS.iter().map(|task| task.name()).collect();
    let tasks = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), tasks);
    let quantities = TASKS.iter().flat_map(|task| task.quantities());
    let mut names: Vec<&str> = quantities.clone().map(|q| q.name).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
    for quantity in quantities {
        assert!(!quantity.title.is_empty() && !quantity.unit.is_empty());
        assert!(quantity.demands.len() > 10, "{}", quantity.name);
    }
    for task in TASKS {
        for joint in joints() {
            let setting = Setting {
                joint: *joint,
                extent: Extent::Full,
            };
            let prepared = task.prepare(&setting).unwrap();
            assert_eq!(prepared.demanded().len(), task.quantities().len());
            assert!(prepared.demanded().iter().all(|d| d.scale > 0.0));
            assert!(prepared.refinements().is_sorted_by(|a, b| a < b));
        }
    }
}

#[test]
fn cycles_of_a_pass_are_the_breaks_of_the_reference() {
    for joint in joints() {
        for hz in [0.25, 0.1] {
            let settings = demanded(&joint.parameters).unwrap();
            let motion = Motion::sine(45_f64.to_radians(), hz, -90.0);
            let events = true_events(&settings, &motion, 0.5 / hz);
            let breaks = events.iter().filter(|e| e.event.kind == EventKind::Break);
            let breaks = i64::try_from(breaks.count()).unwrap();
            let (mut cycles, mut count) = (Cycles::of(&joint.parameters), 0_i64);
            torques(&settings, &motion, 0.5 / hz, TICKS_HZ, |t, nm| {
                count += i64::from(cycles.see(t, nm).is_some());
            });
            // The last stick may have loaded half, and not broken.
            assert!((0..=1).contains(&(count - breaks)), "{count} {breaks}");
        }
    }
}

#[test]
fn a_stick_swings_a_leg_as_a_spring_of_its_stiffness() {
    for joint in joints() {
        let found = measured(&hand::Rest, "frozen", *joint);
        let [_, onset, swing] = &found[..] else {
            panic!("three numbers")
        };
        let off = value(swing) / swing.0.value - 1.0;
        assert!(off.abs() < 1e-3, "{}: {off}", joint.name);
        let off = value(onset) / onset.0.value - 1.0;
        assert!(off.abs() < 0.01, "{}: {off}", joint.name);
        // By hand: f = √((400 + 16.5)/0.0679 − 5.82²)/2π.
        if joint.name == "coarse" {
            assert!((swing.0.value - 12.43).abs() < 0.02, "{}", swing.0.value);
        }
    }
}

#[test]
fn an_object_under_a_fast_shaft_loses_the_joints_cycles_and_keeps_them_under_a_slow_one() {
    for joint in joints() {
        let found = measured(&knee::Knee, "physical", *joint);
        let [fast, slow, _] = &found[..] else {
            panic!("three numbers")
        };
        assert!(value(fast) < 0.3 * fast.0.value, "{fast:?}");
        assert!((value(slow) - slow.0.value).abs() <= 1.0, "{slow:?}");
    }
}

#[test]
fn a_lost_sample_loses_no_travel() {
    for joint in joints() {
        let found = measured(&lost_samples::Lose, "frozen", *joint);
        let off = value(&found[0]) / found[0].0.value - 1.0;
        // Cycles are timed by the tick that is shown, which may be the one after a gap.
        assert!(off.abs() < 1e-3, "{off}");
        assert_eq!(value(&found[1]), 0.0);
    }
}

#[test]
fn a_law_that_cannot_says_so_without_a_nan() {
    let joint = joints()[0];
    let [creep, slow] = &measured(&creep::Creep, "tanh", joint)[..] else {
        panic!("two numbers")
    };
    // It bears nothing at rest: the load is lost, or never there.
    assert!(creep.1.failed.is_some() || creep.1.value.unwrap() > 0.9);
    assert!(slow.1.value.is_some());
    let [_, _, (demand, swing)] = &measured(&hand::Rest, "tanh", joint)[..] else {
        panic!("three numbers")
    };
    let off = swing
        .value
        .map(|hz| (hz - demand.value).abs() / demand.scale);
    assert!(swing.failed.is_some() || off.is_some_and(|off| off > 0.5));
}

#[test]
fn a_tremor_ends_where_it_began() {
    let joint = Parameters::default();
    let never = || false;
    let runner = Runner::new(entry("frozen"), &joint, Precision::F64, 3, &never);
    let steps = tremor(&runner, 1e-4, 100.0);
    assert_eq!(steps.len(), 600);
    let travel: f64 = steps.iter().map(|step| step.delta_phi_rad).sum();
    assert!(travel.abs() < 1e-18);
    let fastest = TAU * 100.0 * 1e-4;
    assert!((steps[0].omega_start_rad_s - fastest).abs() < 1e-12);
    assert!((runner.step_s() * 3.0 - TICK_S).abs() < 1e-18);
}
