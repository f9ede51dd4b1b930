//! The laws on the target: `--target`.

use crate::failure::Failure;
use crate::studying::{self, Watch};
pub(super) use crate::verbs::accuracy::target::ladder;
use crepitus_emulator::on_target::OnTarget;
use crepitus_studies::accuracy::target::TargetError;
use crepitus_studies::laws::{LawStudy, Plan, controller};

/// Adds cycles and instructions to a study, on the first joint of its plan.
pub(super) fn add(study: &mut LawStudy, plan: &Plan, ladder: &mut OnTarget) -> Result<(), Failure> {
    let joint = plan.joints.first().map(|joint| joint.parameters);
    let joint = joint.unwrap_or_default();
    let added = controller::add(study, &joint, ladder, &mut Watch::new());
    added.map_err(|error: TargetError<String>| match error {
        TargetError::Study(error) => studying::failed(error),
        other => Failure::Work(format!("--target: {other}")),
    })
}
