//! Friction, and what else a swinging weight shows.

use super::finding::{Finding, Verdict};
use super::person::{Person, interrupted};
use super::step::Step;
use super::watched::motion;
use super::weight::Known;
use crate::failure::Failure;
use crate::interrupt;
use crate::line::{Line, failure};
use crate::progress::Progress;
use crate::verbs::identify::recordings::recording;
use crepitus_client::Client;
use crepitus_identify::brace::{Quantity, QuantityResult, Refusal, TORQUE_DEVIATION, identify};
use crepitus_model::parameters::Source;
use crepitus_model::render::effects::friction_compensation::FrictionCompensationSettings;
use crepitus_protocol::DeviceSettings;

/// The parameter that this step finds.
pub(super) const FRICTION: &str = "friction-compensation.friction_nm";

/// Watches a weight swing, and identifies the brace.
pub(super) fn found(
    client: &mut Client<Line>,
    person: &Person,
    weight: &Known,
) -> Result<Finding, Failure> {
    let samples = motion(client, person)?;
    let (_, values) = client.parameters().map_err(failure)?;
    let settings = DeviceSettings::of(&values).map_err(|error| {
        Failure::Work(format!(
            "the device's own parameters are invalid: {error:?}"
        ))
    })?;
    let mut progress = Progress::of_study();
    let brace = identify(
        &[recording(samples, &settings)],
        &weight.swinging(),
        TORQUE_DEVIATION,
        &mut |share| {
            progress.reached(share);
            !interrupt::requested()
        },
    );
    drop(progress);
    let brace = match brace {
        Ok(brace) => brace,
        Err(Refusal::Interrupted) => return Err(interrupted()),
        Err(refusal) => {
            return Ok(Finding::new(Step::Friction, Verdict::Unknown)
                .remark(format!("nothing is identified: {refusal}"))
                .remedy("take the step again; the page on identification says what to look at"));
        }
    };
    let assumed: FrictionCompensationSettings = values.read();
    let mut finding = Finding::new(Step::Friction, Verdict::Unknown);
    for shown in &brace.shown {
        // This step has no torque, so these two are never visible in it.
        if matches!(
            shown.quantity,
            Quantity::LoadLoss | Quantity::TorqueConstant
        ) {
            continue;
        }
        finding = match &shown.result {
            QuantityResult::Seen(estimate) => {
                finding.estimate(shown.quantity.name(), estimate, shown.quantity.spec())
            }
            QuantityResult::NotVisible { why } => finding.remark(format!(
                "{}: not visible in this swing, because {why}",
                shown.quantity.name()
            )),
        };
    }
    finding.remarks.extend(brace.notes.iter().cloned());
    let Some(friction) = brace.value(Quantity::Friction) else {
        return Ok(finding.remedy("take a heavier weight, or another swing"));
    };
    finding.verdict = Verdict::Good;
    Ok(finding
        .remark(format!("{FRICTION} is {} N·m", assumed.friction_nm))
        .propose(FRICTION, friction.value))
}
