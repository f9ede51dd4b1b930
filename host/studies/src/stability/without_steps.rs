//! The event-driven reference as a subject: from row to row of a prescribed
//! motion, without samples.

use super::criterion::BOUND_SLACK;
use super::input::Input;
use super::observation::Observation;
use crate::true_events::TimedEvent;
use crepitus_model::{Event, EventKind, Phase, Real, Settings, SettingsError};
use crepitus_plant::{Motion, ShaftState};
use crepitus_scene::reference::Reference;

/// No case has as many events: a run that reaches this is stuck.
const MOST_EVENTS: u64 = 2_000_000;

/// Runs the reference with `settings` on `input`; rows are at the ends of the
/// input's steps, and the late torque is that after `late_step`.
pub(super) fn without_steps(
    settings: &Settings,
    input: &Input,
    late_step: u64,
) -> Result<Observation, SettingsError> {
    let settings = settings.validate()?;
    let motion = input.motion();
    let sampling = input.sampling(&motion);
    let mut reference = Reference::new(&settings, &motion);
    let limit_nm = settings.parameters.static_torque_nm * (1.0 + BOUND_SLACK);
    let first_nm = reference.torque_nm();
    let mut seen = Observation {
        first_torque_nm: first_nm,
        last_torque_nm: first_nm,
        ..Observation::of_steps(input.step_s)
    };
    let mut angle_rad = motion.at(0.0).phi_rad;
    for n in 1..=sampling.steps() {
        let time_s = sampling.time_s(n, 0.0);
        reference.advance(time_s, |event| {
            note(&mut seen, &event, &motion, limit_nm);
        });
        let before_nm = seen.last_torque_nm;
        row(&mut seen, &reference, limit_nm, late_step);
        let shaft = reference.shaft();
        let mean_nm = f64::midpoint(before_nm, seen.last_torque_nm);
        seen.work_j += mean_nm * (shaft.phi_rad - angle_rad);
        angle_rad = shaft.phi_rad;
        if seen.overflow_s.is_some() || seen.tally.events() > MOST_EVENTS {
            seen.overflow_s.get_or_insert(time_s);
            break;
        }
    }
    if settings.parameters.static_torque_nm > 0.0 {
        let most_nm = seen.torque.high.max(-seen.torque.low);
        seen.peak = most_nm / settings.parameters.static_torque_nm;
    }
    Ok(seen)
}

/// Records the state at a row.
fn row(seen: &mut Observation, reference: &Reference<'_>, limit_nm: f64, late_step: u64) {
    let torque_nm = reference.torque_nm();
    let (theta, v) = (reference.theta_rad(), reference.theta_dot_rad_s());
    let step = seen.steps + 1;
    let now_s = f64::from_whole(step) * seen.step_s;
    if !(theta.is_finite() && v.is_finite()) {
        seen.overflow_s.get_or_insert(now_s);
    }
    if let Phase::Slip(sense) = reference.phase() {
        let lag = sense.of_signed(v - reference.shaft().omega_rad_s);
        seen.lag_rad_s = seen.lag_rad_s.max(lag);
    }
    if torque_nm.to_bits() != seen.last_torque_nm.to_bits() {
        seen.last_change = step;
    }
    seen.row::<f64>(now_s, torque_nm, limit_nm, late_step);
}

/// Records an event, whose fraction is its time.
fn note(seen: &mut Observation, event: &Event<f64>, motion: &Motion, limit_nm: f64) {
    let timed = TimedEvent::new(event.fraction, event);
    let torques = [event.torque_before_nm, event.torque_after_nm];
    if torques.iter().any(|t| t.abs() > limit_nm) {
        seen.above_s.get_or_insert(timed.time_s);
    }
    if !(timed.time_s.is_finite() && torques.iter().all(|t| t.is_finite())) {
        seen.overflow_s.get_or_insert(timed.time_s);
    }
    let ShaftState {
        omega_rad_s,
        omega_dot,
        ..
    } = motion.at(timed.time_s);
    if event.kind == EventKind::Break && omega_rad_s == 0.0 && omega_dot == 0.0 {
        seen.tally.breaks_at_rest += 1;
    }
    seen.event(timed, event.torque_after_nm);
}
