//! Warnings about a run.

use super::TorqueLimitSummary;
use super::parts::torque_limit;
use crate::run::Totals;
use crate::run::held_back::TankTotals;
use crate::scene::{Crepitus, Scene, SolverChoice};
use crepitus_model::render::effects::FELT_SHARE;
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, EVENTS_PER_STEP, Parameters};

/// Warnings about the run.
pub(super) fn run_warnings(scene: &Scene, totals: &Totals) -> Vec<String> {
    let mut warnings = totals
        .plant
        .as_ref()
        .map(|p| p.warnings.clone())
        .unwrap_or_default();
    if let Some(plant) = &totals.plant {
        warnings.extend(balance_warning(plant.balance.relative_residual()));
    }
    warnings.extend(tank_warning(scene, &totals.tank));
    warnings.extend(torque_limit(scene, &totals.beyond).map(|limit| limit_warning(&limit)));
    if totals.crowded_steps > 0 {
        warnings.push(format!(
            "{} steps had {EVENTS_PER_STEP} events, the most that a step takes in, and more may have followed: events and cycles are not those of the joint, and no frequency is given; choose a shorter step",
            totals.crowded_steps
        ));
    }
    let missed_s = scene.duration_s - totals.end_s;
    if missed_s > 1e-9 * scene.duration_s {
        warnings.push(format!(
            "duration_s = {} s is not a whole number of steps of {} s: the run ends at {} s",
            scene.duration_s,
            scene.step_s(),
            totals.end_s
        ));
    }
    warnings.extend(lead_warning(scene, totals));
    if let (Some(crepitus), SolverChoice::Ladder { solver, step_s, .. }) =
        (&scene.crepitus, scene.solver)
    {
        warnings.extend(step_warnings(
            crepitus,
            solver,
            step_s,
            totals.fastest_rad_s,
        ));
    }
    warnings.extend(pitch_warnings(scene, totals.fastest_rad_s));
    warnings
}

/// Beats and reflexes that the tank held back.
fn tank_warning(scene: &Scene, totals: &TankTotals) -> Option<String> {
    let first_s = totals.first_s?;
    let law = match scene.solver {
        SolverChoice::Reference => {
            "; `reference` has the tank as a continuous law, which a device takes tick by tick"
        }
        SolverChoice::Ladder { .. } => "",
    };
    Some(format!(
        "the energy tank held back torque of {} from t = {first_s:.4} s on, for {:.3} s in all, by up to {:.0} %: of {} beats and \
         reflexes that ended {} were weak and {} not felt (less than {:.0} % of their height){law}",
        totals.effects.join(" and "),
        totals.held_back_s,
        1e2 * totals.most_share,
        totals.pushes,
        totals.weak,
        totals.unfelt,
        1e2 * FELT_SHARE,
    ))
}

/// Torque that no device shows.
fn limit_warning(limit: &TorqueLimitSummary) -> String {
    let TorqueLimitSummary {
        limit_nm,
        first_s,
        beyond_s,
        most_nm,
        ..
    } = limit;
    let when = format!(
        "from t = {first_s:.4} s on, for {beyond_s:.3} s in all, up to {:.2} N·m",
        most_nm.abs()
    );
    if limit.is_applied {
        format!(
            "the torque asked for was above the device's limit of {limit_nm} N·m {when}: the device showed {limit_nm} N·m then"
        )
    } else {
        format!(
            "the torque is above the {limit_nm} N·m that a device shows at most {when}: this scene has no device and no limit (`--as-device` applies it)"
        )
    }
}

/// Slips that went on after their end.
fn lead_warning(scene: &Scene, totals: &Totals) -> Option<String> {
    let convention = scene.crepitus?.settings.convention;
    let lead = totals.tally.as_ref()?.lead;
    let missed = convention != Convention::Frozen && lead.behind_s > 0.0;
    missed.then(|| {
        format!(
            "for {:.3e} s the shaft was slower than the object it slips over, by up to {:.3e} rad/s: the solver \
             missed the end of a slip, and friction gave {:.3e} J",
            lead.behind_s, lead.worst_rad_s, lead.behind_j
        )
    })
}

/// The share of a plant's energy that may be missing: a tenth of a percent of
/// all that moved.
const MOST_MISSING: f64 = 1e-3;

/// An energy balance that does not close.
fn balance_warning(share: f64) -> Option<String> {
    // Written so that NaN warns.
    let closes = share.abs() <= MOST_MISSING;
    (!closes).then(|| {
        format!(
            "the energy of the plant balances to {:.1e} of all that moved only, above {MOST_MISSING:e}: the step is too long for a part of it, and its torques are not to be trusted; choose a shorter step",
            share.abs()
        )
    })
}

/// Steps in which the shaft turns by more than what comes once in an angle: a law takes in one of them a step.
fn pitch_warnings(scene: &Scene, fastest_rad_s: f64) -> Vec<String> {
    if scene.solver == SolverChoice::Reference {
        return Vec::new();
    }
    let effects = scene.effect_settings();
    let texture = effects.texture.map(|s| ("texture", s.pitch_deg));
    let teeth = effects.cogwheel.filter(|s| s.mode == 1);
    let teeth = teeth.map(|s| ("cogwheel", s.pitch_deg));
    let step_s = scene.step_s();
    let turn_deg = (fastest_rad_s * step_s).to_degrees();
    let passed = [texture, teeth].into_iter().flatten();
    passed
        .filter(|(_, pitch_deg)| turn_deg > *pitch_deg)
        .map(|(name, pitch_deg)| {
            format!(
                "{name}: step longer than its pitch: at the highest speed, {fastest_rad_s:.3} rad/s, the joint turns by \
                 {turn_deg:.3} degrees in a step of {:.1} µs, and its pitch is {pitch_deg} degrees; of several in a step \
                 one is felt: choose a shorter step, or --solver reference",
                step_s * 1e6
            )
        })
        .collect()
}

/// Steps too long to see what happens within them.
fn step_warnings(
    crepitus: &Crepitus,
    solver: Solver,
    step_s: f64,
    fastest_rad_s: f64,
) -> Vec<String> {
    let p: &Parameters = &crepitus.settings.parameters;
    let mut warnings = Vec::new();
    // 2(Ts − Tk)/(kr·Ω): the shortest stick of the run.
    let stick_s =
        2.0 * (p.static_torque_nm - p.kinetic_torque_nm) / (p.stiffness_nm_per_rad * fastest_rad_s);
    // That rung locates every event inside the step.
    if stick_s < step_s && solver != Solver::ExactEvents {
        warnings.push(format!(
            "step longer than a stick phase: at the highest speed, {fastest_rad_s:.3} rad/s, a stick lasts \
             {:.1} µs and a step {:.1} µs; a solver that does not locate events inside the step misses cycles",
            stick_s * 1e6,
            step_s * 1e6
        ));
    }
    let radians = p.natural_rad_s() * step_s;
    if radians > std::f64::consts::FRAC_PI_4 {
        warnings.push(format!(
            "step long against the object's swing: ωn·h = {radians:.2}, above π/4; a shorter step shows the slip"
        ));
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::{MOST_MISSING, balance_warning};

    #[test]
    fn a_balance_that_is_open_or_no_number_is_warned_of() {
        for closed in [0.0, MOST_MISSING, -MOST_MISSING] {
            assert_eq!(balance_warning(closed), None, "{closed}");
        }
        for open in [MOST_MISSING.next_up(), -0.5, f64::INFINITY, f64::NAN] {
            assert!(balance_warning(open).is_some(), "{open}");
        }
    }
}
