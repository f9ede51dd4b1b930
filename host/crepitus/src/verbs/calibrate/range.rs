//! The range of motion, by hand.

use super::finding::{Finding, Verdict};
use super::person::Person;
use super::step::Step;
use super::watched::motion;
use crate::failure::Failure;
use crate::line::{Line, failure};
use crepitus_client::Client;
use crepitus_model::control::device_limits::RangeSettings;
use crepitus_model::parameters::Source;
use crepitus_model::render::effects::range_limit::RangeLimitSettings;
use crepitus_protocol::Values;

/// A knee bends to about 140 deg, and hyperextends by some 10: beyond these it is not a knee.
const KNEE_DEG: (f64, f64) = (-15.0, 160.0);

/// A brace that bends less than this was not moved to its stop, or is not one for an examination.
const LEAST_FLEXION_DEG: f64 = 90.0;

/// Least change of the angle that counts as motion, deg.
const LEAST_DEG: f64 = 5.0;

/// Looks at a motion by hand.
pub(super) fn found(client: &mut Client<Line>, person: &Person) -> Result<Finding, Failure> {
    let samples = motion(client, person)?;
    let (_, values) = client.parameters().map_err(failure)?;
    let deg = |count: i32| (f64::from(count) * values.rad_per_count()).to_degrees();
    let counts = samples
        .iter()
        .filter(|sample| !sample.is_lost)
        .map(|sample| sample.count);
    let (Some(least), Some(most)) = (counts.clone().min(), counts.max()) else {
        return Ok(Finding::new(Step::Range, Verdict::Unknown)
            .remark("no sample arrived")
            .remedy("run `crepitus doctor`"));
    };
    let lost = samples.iter().filter(|sample| sample.is_lost).count();
    let mut finding = judged(deg(least), deg(most), &values);
    if lost > 0 {
        finding.verdict = Verdict::Bad;
        finding = finding
            .remark(format!("the drive rejected {lost} counts of the encoder"))
            .remedy("look at the encoder's cable, supply and shield");
    }
    Ok(finding)
}

/// Judges the brace by the angles that it reached, from least to most.
fn judged(least_deg: f64, most_deg: f64, values: &Values) -> Finding {
    let range: RangeSettings = values.read();
    let finding = |verdict| {
        Finding::new(Step::Range, verdict)
            .value("lowest angle", least_deg, None, "deg")
            .value("highest angle", most_deg, None, "deg")
    };
    if most_deg - least_deg < LEAST_DEG {
        return finding(Verdict::Bad)
            .remark("the angle did not change")
            .remedy(
                "move the joint; if you did, the encoder is not connected, or its coupling slips",
            );
    }
    if -least_deg > most_deg {
        return finding(Verdict::Bad).remark("the angle falls in flexion, or the zero is that of a bent joint").remedy(
            "take the step zero with the joint straight; if it was, the encoder's sign is reversed: swap A and B of the encoder, and \
             take the step polarity after this one",
        );
    }
    if least_deg < KNEE_DEG.0 || most_deg > KNEE_DEG.1 {
        return finding(Verdict::Bad)
            .remark(format!("no knee moves beyond {} to {} deg", KNEE_DEG.0, KNEE_DEG.1))
            .remedy("encoder.lines or encoder.gear_ratio are not those of this motor and gear, or the zero is that of a bent joint");
    }
    if most_deg < LEAST_FLEXION_DEG {
        return finding(Verdict::Bad)
            .remark(format!("a knee bends to about 140 deg, this brace to less than {LEAST_FLEXION_DEG}"))
            .remedy(
                "move it to its flexion stop; if that was it, open the stop, or compare encoder.lines and encoder.gear_ratio with the data sheets",
            );
    }
    if least_deg + range.fade_deg > 0.0 {
        return finding(Verdict::Bad)
            .remark(format!(
                "a range that ends {} deg before what was reached leaves out the zero, where the device could not be armed",
                range.fade_deg
            ))
            .remedy("move it to its extension stop; if that was it, set the stop some 10 deg beyond straight");
    }
    proposed(
        finding(Verdict::Good),
        least_deg,
        most_deg,
        &range,
        &values.read(),
    )
}

/// Stops have to be as far beyond the ends of the range as the torque takes to fade.
fn proposed(
    mut finding: Finding,
    least_deg: f64,
    most_deg: f64,
    range: &RangeSettings,
    symptom: &RangeLimitSettings,
) -> Finding {
    let least = range.least_deg.max((least_deg + range.fade_deg).ceil());
    let most = range.most_deg.min((most_deg - range.fade_deg).floor());
    for (name, end, own) in [
        ("range.least_deg", least, range.least_deg),
        ("range.most_deg", most, range.most_deg),
    ] {
        if (end - own).abs() > 1e-9 {
            finding = finding
                .remark(format!("{name} is {own} deg; with {} deg of fading before what was reached it is {end} deg", range.fade_deg))
                .propose(name, end);
        }
    }
    let reaches = |deg: f64| (least_deg..=most_deg).contains(&deg);
    if !reaches(symptom.extension_limit_deg) || !reaches(symptom.flexion_limit_deg) {
        finding = finding.remark(format!(
            "a range-limit from {} to {} deg, as it is set, would not be felt at both of its ends",
            symptom.extension_limit_deg, symptom.flexion_limit_deg
        ));
    }
    finding.remark("what was reached by hand is no proof of where the stops are: bring-up row 27 of the hardware page is")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_judged() {
        let judged = |least, most| judged(least, most, &Values::default());
        for (least, most, verdict, word) in [
            (-10.0, 130.0, Verdict::Good, ""),
            (0.0, 1.0, Verdict::Bad, "did not change"),
            (-120.0, 3.0, Verdict::Bad, "falls in flexion"),
            (-10.0, 260.0, Verdict::Bad, "no knee"),
            (-30.0, 130.0, Verdict::Bad, "no knee"),
            (-2.0, 60.0, Verdict::Bad, "bends to about 140"),
            (-4.9, 130.0, Verdict::Bad, "leaves out the zero"),
        ] {
            let finding = judged(least, most);
            assert_eq!(finding.verdict, verdict, "{least} {most}");
            assert!(finding.text().contains(word), "{}", finding.text());
            assert!(verdict == Verdict::Good || finding.remedy.is_some());
        }
        // The stops that the hardware page wants need no change.
        assert!(judged(-10.0, 130.0).proposals.is_empty());
        let narrow = judged(-7.5, 110.5);
        assert_eq!(
            narrow.proposals,
            [
                ("range.least_deg".to_owned(), -2.0),
                ("range.most_deg".to_owned(), 105.0)
            ]
        );
    }
}
