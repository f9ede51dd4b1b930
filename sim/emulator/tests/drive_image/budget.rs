//! Cycles of a tick, of 8,400: modelled with 0 wait states, and with the modelled
//! flash. Shares of a tick are reported; a tick has to end within it.

use crate::book::on_record;
use crate::host::{Flash, Host, examination, image, is_long, judged, scene};
use crate::tasks::RENDER;
use crepitus_emulator::Image;
use crepitus_emulator::cycles::Cycles;
use crepitus_protocol::Revision;
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::parameters;
use crepitus_scene::Scene;

/// Modelled cycles of a tick.
pub(crate) const TICK_CYCLES: u64 = 8_400;

/// Ticks that are watched, with some twenty cycles of stick and slip.
const TICKS: u64 = 4_000;

/// Commits, each at another phase to the tasks and to the joint; and with
/// `CREPITUS_LONG` set.
const COMMITS: usize = 15;
const MANY_COMMITS: usize = 60;

/// Upper limits.
struct Limits {
    flash: Flash,
    /// `render_torque`: the velocity and `frozen` crepitus, cycles.
    render_cycles: u64,
}

const LIMITS: [Limits; 2] = [
    Limits {
        flash: Flash::ZeroWaitStates,
        render_cycles: 940,
    },
    // Figures with the modelled flash move by a percent of a tick or two with the place of the
    // code, which differs between two builds of one source.
    Limits {
        flash: Flash::Modelled,
        render_cycles: 1_310,
    },
];

/// The drive while the hand feels the joint of a scene.
fn under_torque(image: &Image, scene: &Scene, flash: Flash) -> Host {
    let mut host = Host::timed(image, scene, &[], flash);
    host.arm();
    host.run_until_torque();
    host
}

#[expect(clippy::cast_precision_loss, reason = "for people")]
pub(crate) fn percent(cycles: u64) -> f64 {
    cycles as f64 / TICK_CYCLES as f64 * 100.0
}

#[test]
fn a_tick_with_crepitus_and_a_ringing_bone_ends_within_it() {
    let Some(image) = image() else { return };
    for limits in judged(LIMITS) {
        let mut host = under_torque(&image, &scene("[effects.bone-shaping]"), limits.flash);
        let mut cycles = Cycles::default();
        host.board.watch(TICKS, &mut cycles);
        let (mean, worst) = (cycles.mean_busy_cycles(), cycles.worst_busy_cycles());
        let what = "a tick with crepitus and a ringing bone";
        on_record(what, limits.flash, Some(mean), worst);
        assert!(worst > 1_500, "something was left out");
        assert!(worst <= TICK_CYCLES, "{worst}");
    }
}

#[test]
fn a_tick_with_a_commit_ends_within_it() {
    let Some(image) = image() else { return };
    let commits = if is_long() { MANY_COMMITS } else { COMMITS };
    for limits in judged(LIMITS) {
        let mut host = under_torque(&image, &scene("[effects.bone-shaping]"), limits.flash);
        let mut worst = 0;
        for commit in 0..commits {
            let added_nm = [0.05, -0.05, 0.02, -0.02][commit % 4];
            worst = worst.max(worst_while_committing(&mut host, added_nm));
            host.run(37);
        }
        let what = format!(
            "a tick with crepitus and a ringing bone, while one of {commits} commits arrives"
        );
        on_record(&what, limits.flash, None, worst);
        assert!(worst <= TICK_CYCLES, "{worst}");
    }
}

/// Requests a commit that adds this to the static torque; returns the revision before it.
pub(crate) fn begin_commit(host: &mut Host, added_nm: f64) -> Revision {
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
    revision
}

/// The worst tick while a commit arrives and takes effect.
fn worst_while_committing(host: &mut Host, added_nm: f64) -> u64 {
    let revision = begin_commit(host, added_nm);
    // From the first piece on the link to the end of the ramp.
    let mut cycles = Cycles::default();
    host.board.watch(600, &mut cycles);
    host.run(400);
    let now = host.blocks.last().expect("a block").revision;
    assert_ne!(now, revision, "not applied");
    cycles.worst_busy_cycles()
}

/// The image's own runs leave something in the caches. Here they are empty,
/// 200 times, in the middle and at the end of a tick alternately.
#[test]
fn a_tick_with_cold_caches_ends_within_it() {
    let Some(image) = image() else { return };
    for limits in judged(LIMITS) {
        let mut host = under_torque(&image, &scene("[effects.bone-shaping]"), limits.flash);
        let mut worst = 0;
        for _ in 0..200 {
            host.board.half(None);
            host.board.mcu_mut().clear_flash_caches();
            let mut cycles = Cycles::default();
            host.board.watch(2, &mut cycles);
            worst = worst.max(cycles.worst_busy_cycles());
        }
        let what = "a tick with crepitus and a ringing bone, caches emptied";
        on_record(what, limits.flash, None, worst);
        assert!(worst <= TICK_CYCLES, "{worst}");
    }
}

#[test]
fn rendering_crepitus_takes_its_cycles_at_most() {
    let Some(image) = image() else { return };
    for limits in judged(LIMITS) {
        let mut host = under_torque(&image, &examination(), limits.flash);
        let mut cycles = Cycles::default();
        host.board.watch(TICKS, &mut cycles);
        let cost = cycles.costs()[&RENDER];
        let worst = cost.worst_cycles;
        on_record(
            "`render_torque` with crepitus",
            limits.flash,
            Some(cost.mean_cycles()),
            worst,
        );
        assert!(cost.worst_cycles <= limits.render_cycles, "{cost:?}");
    }
}
