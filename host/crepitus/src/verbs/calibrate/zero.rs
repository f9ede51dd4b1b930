//! The angle's zero, with the joint straight.

use super::finding::{Finding, Verdict};
use super::step::Step;
use super::watched::watched;
use crate::failure::Failure;
use crate::line::{Line, failure};
use crepitus_client::Client;
use std::time::Duration;

/// Time for which the joint has to stay.
const STAYS: Duration = Duration::from_secs(1);

/// Most that it may move meanwhile, deg: a hand's tremor, and less than what matters to a range of motion.
const MOST_DEG: f64 = 0.5;

/// Sets the zero, and looks whether the angle stays there.
pub(super) fn found(client: &mut Client<Line>) -> Result<Finding, Failure> {
    client.zero().map_err(failure)?;
    let (_, values) = client.parameters().map_err(failure)?;
    let samples = watched(client, Some(STAYS), false)?;
    let counts = samples.iter().map(|sample| sample.count);
    let (Some(least), Some(most)) = (counts.clone().min(), counts.max()) else {
        return Ok(Finding::new(Step::Zero, Verdict::Unknown)
            .remark("no sample arrived")
            .remedy("run `crepitus doctor`"));
    };
    let deg = |count: i32| (f64::from(count) * values.rad_per_count()).to_degrees();
    let away = deg(least).abs().max(deg(most).abs());
    let finding = |verdict| {
        Finding::new(Step::Zero, verdict)
            .value("largest angle from zero in a second", away, None, "deg")
            .value(
                "counts from least to most",
                f64::from(most.wrapping_sub(least)),
                None,
                "counts",
            )
    };
    Ok(if away > MOST_DEG {
        finding(Verdict::Bad).remedy(format!(
            "the joint moved by more than {MOST_DEG} deg: hold it still against its extension stop, and take the step again; if it \
             did not move, look at the encoder's supply and shield"
        ))
    } else {
        finding(Verdict::Good)
            .remark("no sensor tells whether the joint was straight: that is up to you")
    })
}
