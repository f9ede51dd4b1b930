//! Costs of the ladder on the target: `--target`.

use crate::failure::Failure;
use crate::output::to_stderr;
use crate::studying::Watch;
use crepitus_emulator::on_target::{self, OnTarget};
use crepitus_studies::accuracy::target::inputs::Lengths;
use crepitus_studies::accuracy::target::{self, TargetError};
use crepitus_studies::accuracy::{Study, StudyScene, scenes};

/// The program on an emulated core.
pub(in crate::verbs) fn ladder() -> Result<OnTarget, Failure> {
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
    // The standard ones, with which the full set begins: each run there takes seconds.
    let standard = scenes::standard().map_or(0, |standard| standard.len());
    let scenes = scenes.get(..standard).unwrap_or(scenes);
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
