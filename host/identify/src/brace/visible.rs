//! Visibility of each quantity in the recordings, with the reason and the remedy if it is not
//! visible.

use crate::Estimate;
use crate::brace::fit::Fit;
use crate::brace::numbers::place;
use crate::brace::prior::Prior;
use crate::brace::quantity::Quantity;
use crate::brace::recording::Recording;
use crate::brace::shown::Result;
use crate::brace::swing::Swing;
use crate::estimate::DEVIATIONS;

/// Least RMS torque of the motor that shows the load loss of the gear, N·m.
const SOME_TORQUE_NM: f64 = 0.1;

/// Largest interval of a visible quantity, as a share of the prior one.
const NARROWED: f64 = 0.7;

/// Stiffness from which there are no cuffs, N·m/rad.
const RIGID_NM_PER_RAD: f64 = 1500.0;

/// RMS residual of the angle that doubles the allowance for model errors, rad.
const MORE_RAD: f64 = 2e-4;

/// Returns the factor from the unit of the fit to that of the quantity's spec.
fn unit(quantity: Quantity, recording: &Recording) -> f64 {
    match quantity {
        Quantity::Backlash => 1_f64.to_degrees(),
        Quantity::TorqueConstant => recording.torque_constant_nm_per_a,
        _ => 1.0,
    }
}

/// Returns the identification result of a quantity.
pub(crate) fn result(
    quantity: Quantity,
    fit: &Fit,
    prior: &Prior,
    swings: &[Swing],
    recording: &Recording,
) -> Result {
    let at = quantity.place();
    let unit = unit(quantity, recording);
    let value = unit * fit.numbers[at];
    let (share, least) = quantity.model_error();
    // A motion that the model explains less well has more of what it leaves out.
    let more = 1.0 + fit.rms_rad / MORE_RAD;
    let of_model = more * f64::max(share * value.abs(), least);
    let of_data = DEVIATIONS * fit.deviation(at) * unit;
    let estimate = Estimate {
        value,
        half_width: of_data.hypot(of_model),
    };
    let (share, absolute) = quantity.widest();
    let widest = f64::max(share * estimate.value.abs(), absolute);
    let is_narrow = estimate.half_width <= widest;
    let is_from_recording = fit.deviation(at) < NARROWED * prior.deviation[at];
    let is_of_cuffs = matches!(quantity, Quantity::CuffStiffness | Quantity::CuffDamping);
    if is_of_cuffs && fit.numbers[place::STIFFNESS] > RIGID_NM_PER_RAD {
        return Result::NotVisible {
            why: format!(
                "the weight moves with the brace as if it were bolted to it ({RIGID_NM_PER_RAD:.0} N·m/rad or more): strap it in as a leg, \
                 or do without cuffs"
            ),
        };
    }
    if is_narrow && is_from_recording {
        return Result::Seen(estimate);
    }
    let torque_nm = torque_rms(swings);
    let spec = quantity.spec();
    let uncertain = format!(
        "it is known to ± {:.2} {} only (at most {widest:.2})",
        estimate.half_width, spec.unit
    );
    Result::NotVisible {
        why: why(quantity, &uncertain, torque_nm, fit),
    }
}

fn torque_rms(swings: &[Swing]) -> f64 {
    swings.iter().map(Swing::torque_rms_nm).fold(0.0, f64::max)
}

/// Returns the sum of two parameters and the half width of its 95 % confidence interval.
fn sum(fit: &Fit, a: usize, b: usize) -> (f64, f64) {
    let c = &fit.covariance;
    let variance = c[(a, a)] + c[(b, b)] + 2.0 * c[(a, b)];
    (
        fit.numbers[a] + fit.numbers[b],
        DEVIATIONS * variance.max(0.0).sqrt(),
    )
}

fn why(quantity: Quantity, uncertain: &str, torque_nm: f64, fit: &Fit) -> String {
    const ARMED: &str = "record another release with --arm while the device renders a torque that also pushes, such as \
                         lead-pipe.torque_nm = 0.3 with lead-pipe.elastic_nm_per_rad = 3 about where the weight hangs";
    match quantity {
        Quantity::LoadLoss | Quantity::TorqueConstant if torque_nm < SOME_TORQUE_NM => {
            format!("the motor's torque was {torque_nm:.2} N·m rms in the swings: {ARMED}")
        }
        Quantity::LoadLoss | Quantity::TorqueConstant => {
            let loss = fit.numbers[place::LOAD_LOSS];
            let scale = fit.numbers[place::TORQUE_SCALE];
            format!(
                "{uncertain}: a torque that only brakes shows (1 + loss) times the constant, {:.3} of the nominal, and \
                 neither alone: {ARMED}",
                scale * (1.0 + loss)
            )
        }
        Quantity::RotorInertia | Quantity::BraceInertia => {
            let (both, half_width) = sum(fit, place::ROTOR, place::BRACE);
            format!(
                "{uncertain}; of rotor and brace together {both:.4} ± {half_width:.4} kg·m² is visible: a lighter weight \
                 or a longer swing tells more"
            )
        }
        Quantity::Backlash => format!(
            "{uncertain}: no reversal shows the rotor at rest while the weight crosses the gap: release from higher up"
        ),
        Quantity::CuffStiffness | Quantity::CuffDamping => format!(
            "{uncertain}: the teeth strike too softly to make the cuffs ring, or the weight is fastened without cuffs: \
             strap it in as a leg, and release from higher up"
        ),
        Quantity::Friction | Quantity::Viscous => {
            format!("{uncertain}: add a release from another height, for a longer swing")
        }
    }
}

/// Returns warnings about the torque constant, whether it is visible or not.
pub(crate) fn notes(fit: &Fit, prior: &Prior, is_torque_seen: bool) -> Vec<String> {
    if !is_torque_seen {
        return vec![
            "nothing here checks the weight: if moment and inertia are off by one factor, so is every value in N·m; a \
             release with --arm compares them with the motor's torque"
                .to_owned(),
        ];
    }
    let at = place::TORQUE_SCALE;
    let off = fit.numbers[at] - 1.0;
    if off.abs() <= DEVIATIONS * prior.deviation[at] {
        return Vec::new();
    }
    vec![format!(
        "by the weight the motor gives {:+.0} % of torque: either its torque constant is off by that, or the weight's \
         moment, and then every value in N·m is too",
        100.0 * off
    )]
}
