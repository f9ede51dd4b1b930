//! What a tick may cost: modelled cycles, 0 wait states, of 8,400.

use crate::host::{Host, examination, image, scene};
use crepitus_emulator::cycles::Cycles;
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::parameters;
use crepitus_scene::Scene;

/// Modelled cycles of a tick.
const TICK_CYCLES: u64 = 8_400;

/// Ticks that are watched, with some twenty cycles of stick and slip.
const TICKS: u64 = 4_000;

/// `render_torque`: the encoder and `frozen` crepitus.
const RENDER_CYCLES: u64 = 900;

/// Exception of `render_torque`.
const RENDER: u16 = 16 + 30;

/// What the tasks have taken while the hand felt the joint of a scene.
fn under_torque(scene: &Scene) -> Option<Cycles> {
    let mut host = Host::new(&image()?, scene);
    host.arm();
    host.run_until_torque();
    let mut cycles = Cycles::default();
    host.board.watch(TICKS, &mut cycles);
    Some(cycles)
}

/// Share of a tick that all tasks may take, and in a tick with a commit, percent.
const SHARE: u64 = 45;
const COMMIT_SHARE: u64 = 55;

#[test]
fn a_tick_with_crepitus_and_a_ringing_bone_takes_its_share_at_most() {
    let Some(cycles) = under_torque(&scene("[effects.bone-shaping]")) else {
        return;
    };
    let (mean, worst) = (cycles.mean_busy_cycles(), cycles.worst_busy_cycles());
    println!(
        "all tasks: {mean:.0} cycles of a tick, worst {worst} of {TICK_CYCLES} \
         (modelled, 0 wait states)"
    );
    assert!(worst > 1_500, "something was left out");
    assert!(worst * 100 <= TICK_CYCLES * SHARE, "{worst}");
}

#[test]
fn a_tick_with_a_commit_takes_its_share_at_most() {
    let Some(image) = image() else { return };
    let mut host = Host::new(&image, &scene("[effects.bone-shaping]"));
    host.arm();
    host.run_until_torque();
    let mut worst = 0;
    for added_nm in [0.05, -0.05, 0.02] {
        let Ok(Answer::Parameters {
            revision,
            mut values,
        }) = host.ask(Operation::Parameters)
        else {
            panic!("no parameters");
        };
        let (id, _) = parameters::find("crepitus.static_torque_nm").expect("a parameter");
        values.set(id, values.get(id).expect("a value") + added_nm);
        let commit = Operation::Commit {
            base: revision,
            values,
        };
        host.request(commit);
        // From the first piece on the link to the end of the ramp.
        let mut cycles = Cycles::default();
        host.board.watch(600, &mut cycles);
        worst = worst.max(cycles.worst_busy_cycles());
        host.run(400);
        let now = host.blocks.last().expect("a block").revision;
        assert_ne!(now, revision, "not applied");
    }
    println!(
        "all tasks, with a commit: worst {worst} cycles of {TICK_CYCLES} \
         (modelled, 0 wait states)"
    );
    assert!(worst * 100 <= TICK_CYCLES * COMMIT_SHARE, "{worst}");
}

#[test]
fn rendering_crepitus_takes_its_share_at_most() {
    let Some(cycles) = under_torque(&examination()) else {
        return;
    };
    let cost = cycles.costs()[&RENDER];
    println!(
        "render_torque: {:.0} cycles, worst {} (modelled, 0 wait states)",
        cost.mean_cycles(),
        cost.worst_cycles,
    );
    assert!(cost.worst_cycles <= RENDER_CYCLES, "{cost:?}");
}
