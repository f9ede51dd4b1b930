//! The motor's torque constant, by a weight that hangs.

use super::finding::{Finding, Verdict};
use super::friction::compensated;
use super::person::interrupted;
use super::prepared::{Prepared, all_off};
use super::pulled::{MOST, Pulled, spring_at};
use super::step::Step;
use super::watched::watched;
use super::weight::Known;
use crate::cli::Arming;
use crate::failure::Failure;
use crate::following::follow;
use crate::interrupt;
use crate::line::{Line, failure};
use crepitus_client::Client;
use crepitus_identify::brace::Quantity;
use crepitus_identify::hanging::found as identified;
use crepitus_model::parameters::Tabled;
use crepitus_model::render::effects::lead_pipe::LeadPipeSettings;
use crepitus_protocol::parameters::find;
use crepitus_protocol::{DeviceSettings, Values};
use std::time::Duration;

/// The parameter that this step finds.
const TORQUE_CONSTANT: &str = "motor.torque_constant_nm_per_a";

/// Tolerated difference of a motor from its data sheet, as a share: ±10 % are usual. Beyond it a weight that
/// was given wrongly is more likely.
const TOLERANCE: f64 = 0.15;

/// Time for which the weight has to hang still before, and the most that it may move, counts.
const STILL: Duration = Duration::from_millis(500);
const STILL_COUNTS: i32 = 200;

/// Lifts the weight and lets it down, and fits the currents.
pub(super) fn found(client: &mut Client<Line>, weight: &Known) -> Result<Finding, Failure> {
    let nothing = |why: String, remedy: &str| {
        Finding::new(Step::TorqueConstant, Verdict::Unknown)
            .remark(why)
            .remedy(remedy)
    };
    let (_, values) = client.parameters().map_err(failure)?;
    let settings = settings(&values)?;
    let counts: Vec<i32> = watched(client, Some(STILL), false)?
        .iter()
        .map(|sample| sample.count)
        .collect();
    let (Some(least), Some(most)) = (counts.iter().min(), counts.iter().max()) else {
        return Ok(nothing(
            "no sample arrived".to_owned(),
            "run `crepitus doctor`",
        ));
    };
    if most.wrapping_sub(*least) > STILL_COUNTS {
        return Ok(nothing(
            "the weight does not hang still".to_owned(),
            "wait until it does, and take the step again",
        ));
    }
    let from_rad = f64::from(*most) * settings.encoder.rad_per_count();
    let mut changes = all_off();
    changes.extend(on("lead-pipe.render"));
    let spring = spring_at(from_rad);
    let ids = LeadPipeSettings::IDS.into_iter().zip(spring.values());
    changes.extend(ids.filter_map(|(id, value)| Some((id?, value))));
    let mut prepared = Prepared::new(client, &changes)?;
    let pulled = pulled(prepared.client(), from_rad);
    prepared.restored()?;
    let pulled = pulled?;
    let moment = weight.moment_nm();
    let (assumed, ratio) = (
        settings.motor.torque_constant_nm_per_a,
        settings.encoder.gear_ratio,
    );
    let found = match identified(&pulled.means(), moment, from_rad, settings.joint_constant()) {
        Ok(found) => found,
        Err(refusal) => {
            return Ok(nothing(
                format!("no torque constant: {refusal}"),
                "take a weight whose moment is about half of what the motor lifts (0.6 kg at 0.25 m), let it hang still, and take the step again",
            ));
        }
    };
    let constant = found.nm_per_a.times(1.0 / ratio);
    let mut finding = Finding::new(Step::TorqueConstant, Verdict::Good)
        .estimate("torque constant", &constant, Quantity::TorqueConstant.spec())
        .estimate("load-dependent friction", &found.load_loss, Quantity::LoadLoss.spec())
        .estimate("dry friction at 8 deg/s", &found.friction_nm, Quantity::Friction.spec())
        .value("moved by", pulled.arc_rad().to_degrees(), None, "deg")
        .remark(format!("{TORQUE_CONSTANT} is {assumed} N·m/A, what was found is {:+.1} % beside it", 100.0 * (constant.value / assumed - 1.0)))
        .remark(
            "a weight that was weighed wrongly by some percent gives a constant that is wrong by as many; nothing here tells the two apart",
        );
    if !found.tells_stiffness {
        finding = finding.remark(
            "the currents do not tell how much brace and cuffs give way: 100 N·m/rad or stiffer is assumed, and the interval holds that",
        );
    }
    if !pulled.is_done() {
        finding = finding.remark("the way back was not finished in time");
    }
    finding.curve = found.curve;
    if (constant.value / assumed - 1.0).abs() > TOLERANCE {
        finding.verdict = Verdict::Bad;
        return Ok(finding.remedy(format!(
            "motors are within 10 % of their data sheet: weigh the weight again, measure its lever from the axis to its centre of mass, bar included, \
             and compare {TORQUE_CONSTANT}, encoder.gear_ratio and the shunts of the current sensor with their data sheets"
        )));
    }
    let finding = finding.propose(TORQUE_CONSTANT, constant.value);
    Ok(compensated(finding, &found.friction_nm))
}

fn settings(values: &Values) -> Result<DeviceSettings, Failure> {
    DeviceSettings::of(values).map_err(|error| {
        Failure::Work(format!(
            "the device's own parameters are invalid: {error:?}"
        ))
    })
}

/// The change that switches an effect on.
fn on(name: &str) -> Option<(u8, f64)> {
    find(name).map(|(id, _)| (id, 1.0))
}

/// The experiment: armed while it lasts, disarmed also after an error.
fn pulled(client: &mut Client<Line>, from_rad: f64) -> Result<Pulled, Failure> {
    let (revision, values) = client.parameters().map_err(failure)?;
    let mut pulled = Pulled::new(&values, revision, &settings(&values)?, from_rad);
    follow(client, Some(MOST), Arming::armed(false), &mut pulled)?;
    if interrupt::requested() {
        return Err(interrupted());
    }
    Ok(pulled)
}
