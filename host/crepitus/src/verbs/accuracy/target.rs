//! Costs of the ladder on the target: `--target`.

use crate::failure::Failure;
use crate::output::to_stderr;
use crate::studying::Watch;
use crepitus_emulator::on_target::{self, OnTarget};
use crepitus_studies::accuracy::target::inputs::Lengths;
use crepitus_studies::accuracy::target::table::target_table;
use crepitus_studies::accuracy::target::{self, TargetError};
use crepitus_studies::accuracy::{Study, StudyScene};

/// The program on an emulated core.
pub(super) fn ladder() -> Result<OnTarget, Failure> {
    on_target::ladder(|| to_stderr("building firmware/ladder, if it is not up to date"))
        .map_err(|error| Failure::Work(format!("--target: {error}")))
}

/// Adds cycles and instructions to a study.
pub(super) fn add(
    study: &mut Study,
    scenes: &[StudyScene],
    is_quick: bool,
    ladder: &mut OnTarget,
) -> Result<(), Failure> {
    let lengths = if is_quick {
        Lengths::QUICK
    } else {
        Lengths::FULL
    };
    let costs = target::costs(
        &mut study.points,
        scenes,
        lengths,
        ladder,
        &mut Watch::new(),
    );
    let costs = costs.map_err(|error: TargetError<String>| match error {
        TargetError::Study(error) => crate::studying::failed(error),
        other => Failure::Work(format!("--target: {other}")),
    })?;
    study.target = Some(costs);
    Ok(())
}

/// Criterion by which the target chooses, where it does.
pub(super) fn chooses_by(on: &target::OnTarget) -> String {
    format!(
        "By mean cycles on the target ({}), equal means by the worst observed; that must fit {:.0} % of a tick, {:.0} \
         cycles.\n",
        on.label,
        100.0 * target::STEP_SHARE,
        target::STEP_SHARE * on.tick_cycles
    )
}

/// Returns the costs on the target as a table, for the terminal and for a page of the book.
pub(super) fn table(on: &target::OnTarget) -> String {
    format!(
        "A step on the target, in f32 at the device's tick ({}; a tick has {}):\n\n{}\n\
         {} steps, every output the same to the bit as on the host.\n",
        on.label,
        on.tick_cycles,
        target_table(&on.rows).to_markdown(),
        on.steps
    )
}
