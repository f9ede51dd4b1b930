//! What a tick may cost: modelled cycles, 0 wait states, of 8,400.

use crate::host::{Host, examination, image, scene};
use crepitus_emulator::cycles::Cycles;
use crepitus_scene::Scene;

/// Modelled cycles of a tick.
const TICK_CYCLES: u64 = 8_400;

/// Ticks that are watched, with some twenty cycles of stick and slip.
const TICKS: u64 = 4_000;

/// `render_torque`, of `frozen` crepitus alone.
const RENDER_CYCLES: u64 = 800;

/// Exception of `render_torque`.
const RENDER: u16 = 16 + 49;

/// What the tasks have taken while the hand felt the joint of a scene.
fn under_torque(scene: &Scene) -> Option<Cycles> {
    let mut host = Host::new(&image()?, scene);
    host.arm();
    host.run_until_torque();
    let mut cycles = Cycles::default();
    host.board.watch(TICKS, &mut cycles);
    Some(cycles)
}

#[test]
fn a_tick_with_crepitus_and_a_ringing_bone_takes_two_fifths_of_its_time_at_most() {
    let Some(cycles) = under_torque(&scene("[effects.bone-shaping]")) else {
        return;
    };
    let (mean, worst) = (cycles.mean_busy_cycles(), cycles.worst_busy_cycles());
    println!(
        "all tasks: {mean:.0} cycles of a tick, worst {worst} of {TICK_CYCLES} \
         (modelled, 0 wait states)"
    );
    assert!(worst > 1_500, "something was left out");
    assert!(worst * 5 <= TICK_CYCLES * 2, "{worst}");
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
