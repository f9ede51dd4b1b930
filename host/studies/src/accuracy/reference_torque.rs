//! The reference's torque at the ends of steps, for comparison.
//!
//! The torque jumps at an event. Where an event falls on the end of a step to
//! within rounding, as the first break at 0.5 rad/s does (2 ms are 40 ticks),
//! both the torque before it and the torque after it are right, and the
//! nearer one is used. Within rounding means: within four roundings, relative
//! to the length of the phase that ends with the event.

use crate::accuracy::scenes::StudyScene;
use crate::sampling::Sampling;
use crate::true_events::TrueEvent;
use crepitus_model::{Phase, Real};
use crepitus_scene::reference::Reference;
use crepitus_scene::run::Lead;

/// Number of steps between two polls.
const STEPS_PER_POLL: u64 = 1 << 16;

/// Largest distance of simultaneous events, in roundings of the phase's length.
const ROUNDINGS: f64 = 4.0;

/// True torque at the end of every step.
#[derive(Clone, Debug)]
pub struct ReferenceTorque {
    /// Torque at the end of step 0, 1, …, N·m.
    at_ends_nm: Vec<f64>,
    /// Steps whose end is simultaneous with an event in f32, in order.
    ties: Vec<Tie>,
    /// Lead of the shaft over the object at the ends of steps.
    pub lead: Lead,
}

/// A step whose end falls on an event.
#[derive(Clone, Copy, Debug)]
struct Tie {
    step: usize,
    /// Distance in time over the length of the phase that the event ends.
    relative: f64,
    before_nm: f64,
    after_nm: f64,
}

impl ReferenceTorque {
    /// Runs the reference along the steps of `sampling`, calling `poll` now
    /// and then.
    ///
    /// # Errors
    /// Error of `poll`.
    pub fn new<E>(
        scene: &StudyScene,
        sampling: &Sampling<'_>,
        events: &[TrueEvent],
        mut poll: impl FnMut() -> Result<(), E>,
    ) -> Result<Self, E> {
        let mut reference = Reference::new(&scene.settings, &scene.motion);
        let mut at_ends_nm = Vec::new();
        let mut lead = Lead::new(&scene.settings, sampling.step_s(), false);
        for n in 1..=sampling.steps() {
            reference.advance(sampling.time_s(n, 0.0), |_| {});
            at_ends_nm.push(reference.torque_nm());
            if let Phase::Slip(sense) = reference.phase()
                && lead.is_due()
            {
                lead.look(
                    sense.of_signed(1.0),
                    reference.shaft().omega_rad_s,
                    reference.theta_dot_rad_s(),
                );
            }
            if n.is_multiple_of(STEPS_PER_POLL) {
                poll()?;
            }
        }
        Ok(Self {
            at_ends_nm,
            ties: ties(sampling, events),
            lead,
        })
    }

    /// The error of `shown_nm` after `step`, in a joint of precision `F`;
    /// `tie` is the position of the search for ties, 0 at the start.
    #[inline]
    pub fn error_nm<F: Real>(&self, step: usize, shown_nm: f64, tie: &mut usize) -> f64 {
        let Some(true_nm) = self.at_ends_nm.get(step) else {
            return f64::NAN;
        };
        let error_nm = (shown_nm - true_nm).abs();
        match self.ties.get(*tie) {
            Some(found) if found.step == step => {
                *tie += 1;
                if found.relative <= ROUNDINGS * F::EPSILON.to_f64() {
                    let before_nm = (shown_nm - found.before_nm).abs();
                    let after_nm = (shown_nm - found.after_nm).abs();
                    error_nm.min(before_nm).min(after_nm)
                } else {
                    error_nm
                }
            }
            _ => error_nm,
        }
    }
}

/// Events that fall on the end of a step, at the coarser precision.
fn ties(sampling: &Sampling<'_>, events: &[TrueEvent]) -> Vec<Tie> {
    let coarsest = ROUNDINGS * f64::from(f32::EPSILON);
    let mut ties: Vec<Tie> = Vec::new();
    let mut phase_start_s = 0.0;
    for TrueEvent {
        event,
        torque_before_nm,
        torque_after_nm,
        ..
    } in events
    {
        let phase_s = event.time_s - phase_start_s;
        phase_start_s = event.time_s;
        let n = (event.time_s / sampling.step_s()).round().whole();
        let relative = (sampling.time_s(n, 0.0) - event.time_s).abs() / phase_s;
        // Step n ends at time n + 1, and the start of the run is no end.
        let step = usize::try_from(n).ok().and_then(|n| n.checked_sub(1));
        if let Some(step) = step
            && relative <= coarsest
            && ties.last().is_none_or(|last| last.step < step)
        {
            ties.push(Tie {
                step,
                relative,
                before_nm: *torque_before_nm,
                after_nm: *torque_after_nm,
            });
        }
    }
    ties
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::scenes::standard;
    use std::convert::Infallible;

    #[test]
    fn a_break_on_the_end_of_a_step_has_two_right_torques() {
        let scene = standard()
            .unwrap()
            .into_iter()
            .find(|s| s.name == "constant-0.5")
            .unwrap();
        let events = scene.true_events();
        let sampling = Sampling::new(&scene.motion, 0.1, 5e-5);
        let torque =
            ReferenceTorque::new(&scene, &sampling, &events, || Ok::<_, Infallible>(())).unwrap();
        // The first break: after 40 ticks the torque is 0.4 or 0.2 N·m.
        let error = |step, shown| torque.error_nm::<f64>(step, shown, &mut 0);
        assert!(error(39, 0.4) < 1e-15 && error(39, 0.2) < 1e-15);
        assert!(error(39, 0.3) > 0.09);
        // One tick earlier there is only one.
        assert!((error(38, 0.39)).abs() < 1e-12);
        assert!((error(38, 0.2) - 0.19).abs() < 1e-12);
        assert!(error(1_000_000, 0.2).is_nan());
    }
}
