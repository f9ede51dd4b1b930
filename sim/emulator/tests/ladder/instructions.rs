//! Instructions as another emulator counts them.

use crate::{ladder, qemu};
use crepitus_emulator::firmware::{Program, path};
use crepitus_ladder::{Cost, Subject};
use crepitus_studies::accuracy::scenes::standard;
use crepitus_studies::accuracy::target::inputs::{Lengths, tasks};

/// Steps of each subject: enough for breaks, matches and reversals.
const STEPS: usize = 400;

#[test]
fn qemu_goes_through_the_same_instructions_to_the_same_bits() {
    let Some(mut ladder) = ladder() else { return };
    if !qemu::is_there() {
        return;
    }
    let image = path(Program::Ladder).unwrap();
    let home = tempfile::tempdir().unwrap();
    let scenes = standard().unwrap();
    let mut all = Cost::default();
    for subject in Subject::all() {
        let tasks = tasks(subject, &scenes, Lengths::QUICK).unwrap();
        // White velocities have an event in most steps.
        let task = tasks
            .iter()
            .find(|task| task.name.starts_with("white velocities"))
            .unwrap();
        let inputs = &task.inputs[..STEPS];
        let here = ladder.run(&task.plan, inputs).unwrap();
        let (outputs, calls) = qemu::run(&image, home.path(), &task.plan, inputs, here.entry);
        let name = subject.name();
        assert_eq!(outputs, here.outputs, "{name}");
        assert_eq!(calls.len(), here.calls.len(), "{name}");
        for (n, (there, here)) in calls.iter().zip(&here.calls).enumerate() {
            let both = (there.instructions, there.path);
            assert_eq!(both, (here.instructions, here.path), "{name}, step {n}");
        }
        all.add(&Cost::of(&here.calls));
    }
    println!(
        "{} calls, {} instructions: the same ones in QEMU",
        all.calls, all.instructions
    );
}
