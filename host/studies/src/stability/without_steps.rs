//! The event-driven reference as a subject: from row to row of a prescribed
//! motion, without samples.

use super::criterion::BOUND_SLACK;
use super::input::Input;
use super::observation::{MOST_KEPT, Observation};
use super::source::motion;
use crate::sampling::Sampling;
use crate::true_events::TimedEvent;
use crepitus_model::{Event, EventKind, Phase, Real, Settings, SettingsError};
use crepitus_plant::{Motion, ShaftState};
use crepitus_scene::reference::Reference;

/// No case has as many events: a run that reaches this is stuck.
const MOST_EVENTS: u64 = 2_000_000;

/// Runs the reference with `settings` on `input`; rows are at the ends of the
/// input's steps, and the late torque is that after `late_s`.
pub(super) fn without_steps(
    settings: &Settings,
    input: &Input,
    late_s: f64,
) -> Result<Observation, SettingsError> {
    let settings = settings.validate()?;
    let (duration_s, step_s) = input.duration_and_step_s().unwrap_or((0.0, 1.0));
    let motion = motion(input);
    let sampling = Sampling::new(&motion, duration_s, step_s);
    let mut reference = Reference::new(&settings, &motion);
    let limit_nm = settings.parameters.static_torque_nm * (1.0 + BOUND_SLACK);
    let first_nm = reference.torque_nm();
    let mut seen = Observation {
        step_s,
        first_torque_nm: first_nm,
        last_torque_nm: first_nm,
        ..Observation::default()
    };
    let late_step = (late_s / step_s).ceil().whole();
    let mut angle_rad = motion.at(0.0).phi_rad;
    for n in 1..=sampling.steps() {
        let time_s = sampling.time_s(n, 0.0);
        reference.advance(time_s, |event| {
            note(&mut seen, &event, &motion, limit_nm);
        });
        seen.steps = n;
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
    let now_s = f64::from_whole(seen.steps) * seen.step_s;
    if !(torque_nm.is_finite() && theta.is_finite() && v.is_finite()) {
        seen.overflow_s.get_or_insert(now_s);
    }
    if torque_nm.abs() > limit_nm {
        seen.above_s.get_or_insert(now_s);
    }
    if let Phase::Slip(sense) = reference.phase() {
        let lag = sense.of_signed(v - reference.shaft().omega_rad_s);
        seen.lag_rad_s = seen.lag_rad_s.max(lag);
    }
    if torque_nm.to_bits() != seen.last_torque_nm.to_bits() {
        seen.last_change = seen.steps;
    }
    if seen.steps > late_step {
        seen.late_torque.add(torque_nm);
    }
    seen.add_torque::<f64>(torque_nm);
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
    seen.tally.add(&timed);
    if seen.events.len() < MOST_KEPT {
        seen.events.push(timed);
        seen.torques_after_nm.push(event.torque_after_nm);
    }
}
