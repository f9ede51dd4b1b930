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
use crepitus_client::Client;
use crepitus_identify::Estimate;
use crepitus_identify::brace::{Quantity, QuantityResult, Refusal, TORQUE_DEVIATION, identify};
use crepitus_identify::files::recording;
use crepitus_model::parameters::Source;
use crepitus_model::render::effects::MOST_SHARE_AT_A_WALL;
use crepitus_model::render::effects::friction_compensation::FrictionCompensationSettings;
use crepitus_protocol::DeviceSettings;

/// The parameters that follow from a friction that was found.
pub(super) const FRICTION: &str = "friction-compensation.friction_nm";
const SHARE: &str = "friction-compensation.share";
const RENDER: &str = "friction-compensation.render";

/// Friction that is never compensated, N·m: more than twice what any shipped joint needs for a hand that rests on it
/// to stay quiet.
const LEFT_NM: f64 = 0.05;

/// The least share that is worth switching on.
const LEAST_SHARE: f64 = 0.1;

/// The share of this friction that may be cancelled: a fifth of the least that it can be is left, as before a wall, and no
/// less than [`LEFT_NM`]. In steps of a percent, downwards; 0 if nothing may be.
fn safe_share(friction: &Estimate) -> f64 {
    let least_nm = friction.value - friction.half_width;
    let most_nm = (MOST_SHARE_AT_A_WALL * least_nm).min(least_nm - LEFT_NM);
    if most_nm <= 0.0 {
        return 0.0;
    }
    (100.0 * most_nm / friction.value).floor() / 100.0
}

/// Proposes the friction that was found, and its compensation at the safe share.
pub(super) fn compensated(finding: Finding, friction: &Estimate) -> Finding {
    let share = safe_share(friction);
    let finding = finding.propose(FRICTION, friction.value);
    if share < LEAST_SHARE {
        return finding.propose(RENDER, 0.0).remark(format!(
            "friction compensation off: of so little friction, known so well, nothing may be cancelled that would be felt; {LEFT_NM} N·m \
             have to stay"
        ));
    }
    let left_nm = (1.0 - share) * friction.value;
    finding.propose(SHARE, share).propose(RENDER, 1.0).remark(format!(
        "friction compensation on, share {share}: of {:.2} N·m the hand feels {left_nm:.2}, which keeps a leg at rest quiet",
        friction.value
    ))
}

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
    let finding = finding.remark(format!("{FRICTION} is {} N·m", assumed.friction_nm));
    Ok(compensated(finding, &friction))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::render::effects::friction_compensation::least_left_nm;
    use crepitus_scene::preset::shipped;

    fn friction(value: f64, half_width: f64) -> Estimate {
        Estimate { value, half_width }
    }

    #[test]
    fn the_least_that_the_friction_can_be_keeps_a_fifth() {
        for (value, half_width, share) in [
            (0.5, 0.0, 0.8),
            (0.42, 0.02, 0.76),
            (0.5, 0.1, 0.64),
            (0.1, 0.0, 0.5),
            (0.05, 0.0, 0.0),
            (0.3, 0.4, 0.0),
        ] {
            let found = safe_share(&friction(value, half_width));
            assert!(
                (found - share).abs() < 1e-9,
                "{value} ± {half_width}: {found}"
            );
        }
    }

    #[test]
    fn what_is_left_keeps_every_shipped_joint_quiet_twice_over() {
        let need_nm = shipped()
            .iter()
            .filter_map(|preset| preset.joint())
            .map(|joint| least_left_nm(joint, 210.4e-6, 0.061))
            .fold(0.0, f64::max);
        assert!(need_nm > 0.02 && 2.0 * need_nm < LEFT_NM, "{need_nm}");
    }

    #[test]
    fn too_little_friction_switches_the_compensation_off() {
        let new = || Finding::new(Step::Friction, Verdict::Good);
        let little = compensated(new(), &friction(0.05, 0.01));
        assert_eq!(
            little.proposals,
            [(FRICTION.to_owned(), 0.05), (RENDER.to_owned(), 0.0)]
        );
        let enough = compensated(new(), &friction(0.5, 0.0));
        let (share, on) = ((SHARE.to_owned(), 0.8), (RENDER.to_owned(), 1.0));
        assert_eq!(enough.proposals[1..], [share, on]);
    }
}
