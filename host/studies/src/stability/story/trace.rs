//! A run of the paper's joint, recorded so closely that a line through the points is
//! the run: torque, velocity of the object, breaks.

use super::Line;
use crate::sampling::{CHUNK_STEPS, Sampling};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, EventKind, Real, Settings, SettingsError, StickSlip};
use crepitus_plant::Motion;
use crepitus_scene::any_joint::AnyJoint;

/// Run that is to be recorded.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run<'a> {
    pub(super) convention: Convention,
    pub(super) solver: Solver,
    pub(super) motion: &'a Motion,
    pub(super) duration_s: f64,
    pub(super) step_s: f64,
}

/// Result of a run, in f64.
#[derive(Clone, Debug, Default)]
pub(super) struct Trace {
    /// Torque shown, N·m, against time, s; upright where it jumps.
    pub(super) torque_nm: Line,
    /// Velocity of the object, rad/s, against time, s.
    pub(super) theta_dot_rad_s: Line,
    /// Times at which the object broke loose, s.
    pub(super) breaks_s: Vec<f64>,
}

impl Run<'_> {
    /// Breaks, and lines if they are wanted: a long run needs no memory for them.
    pub(super) fn trace(self, has_lines: bool) -> Result<Trace, SettingsError> {
        let settings = Settings {
            convention: self.convention,
            ..Settings::default()
        }
        .validate()?;
        let omega_rad_s = self.motion.at(0.0).omega_rad_s;
        let mut joint = AnyJoint::<f64>::new(&settings, self.solver, self.step_s, omega_rad_s)?;
        let sampling = Sampling::new(self.motion, self.duration_s, self.step_s);
        let mut trace = Trace::default();
        let mut walk = sampling.walk_from(0);
        let mut chunk = Vec::with_capacity(CHUNK_STEPS);
        let mut n = 0_u64;
        if has_lines {
            trace.row(0.0, &joint);
        }
        loop {
            walk.fill(&mut chunk, CHUNK_STEPS);
            if chunk.is_empty() {
                return Ok(trace);
            }
            for shaft in &chunk {
                joint.step(shaft, |event| {
                    let time_s = sampling.time_s(n, event.fraction);
                    if event.kind == EventKind::Break {
                        trace.breaks_s.push(time_s);
                    }
                    if has_lines {
                        push(&mut trace.torque_nm, time_s, event.torque_before_nm);
                        push(&mut trace.torque_nm, time_s, event.torque_after_nm);
                        trace.theta_dot_rad_s.push((time_s, event.theta_dot_rad_s));
                    }
                });
                n += 1;
                if has_lines {
                    trace.row(sampling.time_s(n, 0.0), &joint);
                }
            }
        }
    }
}

impl Trace {
    fn row(&mut self, time_s: f64, joint: &impl StickSlip<f64>) {
        push(&mut self.torque_nm, time_s, joint.torque_nm());
        self.theta_dot_rad_s
            .push((time_s, joint.theta_dot_rad_s().to_f64()));
    }
}

/// A level stretch keeps its two ends: most of a run is slip, at Tk.
fn push(line: &mut Line, x: f64, y: f64) {
    if let [.., (_, before), (last_x, last)] = line.as_mut_slice()
        && *before == y
        && *last == y
    {
        *last_x = x;
    } else {
        line.push((x, y));
    }
}

/// Mean frequency between the first and the last break, Hz; zero if the
/// object did not break twice.
pub(super) fn frequency_hz(breaks_s: &[f64]) -> f64 {
    match breaks_s {
        [first, .., last] if last > first => {
            let cycles = u64::try_from(breaks_s.len() - 1).unwrap_or(u64::MAX);
            f64::from_whole(cycles) / (last - first)
        }
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steady_shaft_gives_the_cycle_of_the_closed_form() {
        let run = Run {
            convention: Convention::Frozen,
            solver: Solver::ExactEvents,
            motion: &Motion::constant(1.0),
            duration_s: 1.0,
            step_s: 5e-5,
        };
        let trace = run.trace(true).unwrap();
        assert_eq!(trace.breaks_s, run.trace(false).unwrap().breaks_s);
        let (natural, lambda) = (200.0, 0.1_f64);
        let expected = natural / (std::f64::consts::TAU + 2.0 * (lambda - lambda.atan()));
        assert!((frequency_hz(&trace.breaks_s) / expected - 1.0).abs() < 1e-9);
        // Slips are two points, not six hundred.
        assert!(trace.torque_nm.len() < 1500, "{}", trace.torque_nm.len());
        let highest = trace.torque_nm.iter().map(|p| p.1).fold(0.0, f64::max);
        assert!((highest - 0.4).abs() < 1e-12);
        assert_eq!(frequency_hz(&[1.0]), 0.0);
    }
}
