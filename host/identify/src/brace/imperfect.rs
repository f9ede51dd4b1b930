//! Imperfections that a recording shows: a result names the assumption that fails.
//!
//! The intervals hold them in any case, as the fit marginalises over them ([`Sought`](super::problem::Sought)).

use crate::brace::fit::Fit;
use crate::brace::numbers::place;
use crate::estimate::DEVIATIONS;
use crepitus_plant::swing::BY_ANGLE;

/// Standard deviations from none at which an imperfection is named.
const SURE: f64 = 3.3;

/// Compliance of teeth, links or friction from which it is named, rad/(N·m), and friction at rest or by angle, as a
/// share.
const COMPLIANT_RAD_PER_NM: f64 = 3e-5;
const UNEVEN: f64 = 0.03;

/// Error of the encoder's scale from which it is named, as a share.
const SCALED: f64 = 0.003;

/// RMS residual that whole counts do not leave, rad.
const MORE_THAN_COUNTS_RAD: f64 = 4e-5;

/// Returns whether a fit leaves more than whole counts do.
pub(crate) fn is_more_than_counts(fit: &Fit) -> bool {
    fit.rms_rad > MORE_THAN_COUNTS_RAD
}

/// Returns whether the encoder's scale is surely wrong.
pub(crate) fn is_scaled(fit: &Fit) -> bool {
    is_sure(fit, place::ENCODER) && fit.numbers[place::ENCODER].abs() > SCALED
}

fn is_sure(fit: &Fit, at: usize) -> bool {
    fit.numbers[at].abs() > SURE * fit.deviation(at)
}

/// Returns a note for each imperfection that shows.
pub(crate) fn notes(fit: &Fit) -> Vec<String> {
    let value = |at: usize| (fit.numbers[at], DEVIATIONS * fit.deviation(at));
    let mut notes = Vec::new();
    for (at, what) in [
        (place::TEETH, "teeth and links give way"),
        (
            place::PRESLIDING,
            "friction gives way before it slips (microslip)",
        ),
    ] {
        let (compliance, half_width) = value(at);
        if is_sure(fit, at) && compliance > COMPLIANT_RAD_PER_NM {
            notes.push(format!(
                "misfit of the rigid model: {what}: {:.1} kN·m/rad ± {:.0} %; the values hold it, a scene does not",
                1e-3 / compliance,
                100.0 * half_width / compliance
            ));
        }
    }
    let (stribeck, half_width) = value(place::STRIBECK);
    if is_sure(fit, place::STRIBECK) && stribeck.abs() > UNEVEN {
        notes.push(format!(
            "misfit of Coulomb's friction: it is {:+.0} ± {:.0} % at rest against that of a fast motion; dry friction \
             is that of the motion",
            100.0 * stribeck,
            100.0 * half_width
        ));
    }
    let terms = place::BY_ANGLE..place::BY_ANGLE + BY_ANGLE;
    let is_uneven = |at: usize| is_sure(fit, at) && fit.numbers[at].abs() > UNEVEN;
    if terms.clone().any(is_uneven) {
        let greatest = terms.map(|at| fit.numbers[at].abs()).fold(0.0, f64::max);
        notes.push(format!(
            "misfit of a constant friction: it changes with the angle by {:.0} % or more; dry friction is its mean \
             over the swing",
            100.0 * greatest
        ));
    }
    let (scale, half_width) = value(place::ENCODER);
    if is_scaled(fit) {
        notes.push(format!(
            "misfit of the encoder: by period and amplitude its angles are {:+.1} ± {:.1} % off: check gear ratio and \
             lines of the parameters; the values are corrected for it",
            100.0 * scale,
            100.0 * half_width
        ));
    }
    if is_more_than_counts(fit) {
        notes.push(format!(
            "misfit of the whole model: it leaves {:.4}° rms, more than whole counts do; the intervals are wider for it",
            fit.rms_rad.to_degrees()
        ));
    }
    notes
}
