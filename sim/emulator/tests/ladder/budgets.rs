//! Modelled cycles, 0 wait states, and what they may be at most.

use crate::ladder;
use crepitus_emulator::ladder::LABEL;
use crepitus_ladder::{Cost, Subject};
use crepitus_model::Convention;
use crepitus_study::accuracy::scenes::standard;
use crepitus_study::accuracy::target::inputs::{Lengths, tasks};

/// Worst observed cycles of a subject over all its inputs.
fn worst(subject: Subject) -> Option<u32> {
    let mut ladder = ladder()?;
    let scenes = standard().unwrap();
    let mut all = Cost::default();
    for task in tasks(subject, &scenes, Lengths::FULL).unwrap() {
        let run = ladder.run(&task.plan, &task.inputs).unwrap();
        let cost = Cost::of(&run.calls);
        println!(
            "{} on {}: mean {:.0}, worst {} ({LABEL})",
            subject.name(),
            task.name,
            cost.mean_cycles(),
            cost.worst_cycles
        );
        all.add(&cost);
    }
    Some(all.worst_cycles)
}

#[test]
fn what_the_firmware_renders_stays_within_its_budget() {
    let Some(worst) = worst(Subject::Renderer) else {
        return;
    };
    assert!(worst <= 800, "{worst} cycles");
}

#[test]
fn exact_events_behind_its_check_stays_within_its_budget() {
    let Some(worst) = worst(Subject::Checked(Convention::Physical)) else {
        return;
    };
    assert!(worst <= 1_600, "{worst} cycles");
}
