//! Observation of a run.

use crate::symptoms::SymptomEvent;
use crate::true_events::TimedEvent;
use crepitus_model::{EventKind, Real, Sense};
use crepitus_plant::Extremes;

/// The most events that are stored; the rest is counted.
const MOST_KEPT: usize = 200_000;

/// Observation of a run.
#[derive(Clone, Debug, Default)]
pub(super) struct Observation {
    /// Steps made and their length, s.
    pub(super) steps: u64,
    pub(super) step_s: f64,
    /// The first events, and the torque just after each, N·m.
    pub(super) events: Vec<TimedEvent>,
    pub(super) torques_after_nm: Vec<f64>,
    pub(super) tally: Tally,
    /// First time that something was NaN or infinite, s.
    pub(super) overflow_s: Option<f64>,
    /// First time that the torque or a stick's angle was above its limit, s.
    pub(super) above_s: Option<f64>,
    /// Largest |T|/Ts.
    pub(super) peak: f64,
    pub(super) torque: Extremes<f64>,
    /// Torque from the time that the trial sets.
    pub(super) late_torque: Extremes<f64>,
    pub(super) first_torque_nm: f64,
    pub(super) last_torque_nm: f64,
    /// The last step that changed the torque.
    pub(super) last_change: u64,
    /// Steps whose travel exceeds a stick's: kr·|Δφ| > 2(Ts − Tk).
    pub(super) unresolved_steps: u64,
    /// Hash of the bits of T, and of −T.
    pub(super) torque_bits: Hash,
    pub(super) mirrored_bits: Hash,
    /// ∫T dφ, J.
    pub(super) work_j: f64,
    /// Worst s·(v − Ω) at the end of a step in a slip, rad/s.
    pub(super) lag_rad_s: f64,
    /// Steps that end with a subnormal velocity.
    pub(super) subnormals: u64,
    /// Worst share of missing energy, if audited.
    pub(super) imbalance: Option<f64>,
    /// First and last swing of the hand, rad.
    pub(super) swing_rad: Option<(f64, f64)>,
    /// Largest change of torque from one step to the next, N·m.
    pub(super) largest_step_nm: f64,
    /// Largest relative rise of the stored energy in an adjustment.
    pub(super) energy_rise: f64,
    /// Fastest change of torque without an event, as a share of the slew limit.
    pub(super) slew: f64,
    /// Largest energy returned to the hand, as a share of the bound.
    pub(super) returned: f64,
    /// Largest relative excess of the spring's energy at the end of a slip over
    /// that at its break.
    pub(super) slip_energy: f64,
    /// Ticks in which the turn-back guard switched the torque off.
    pub(super) guard_ticks: u64,
    /// Attempts that were accepted by mistake.
    pub(super) accepted: Vec<&'static str>,
    /// Observation of symptoms besides crepitus.
    pub(super) symptoms: SymptomObservation,
    /// Observation of the vibration actuator.
    pub(super) actuator: ActuatorObservation,
}

/// Observation of the vibration actuator.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ActuatorObservation {
    pub(super) whole: ActuatorPart,
    /// Observation of the run from the time that the trial sets.
    pub(super) late: ActuatorPart,
}

/// Observation of the actuator over a part of the run.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ActuatorPart {
    pub(super) ticks: f64,
    pub(super) acceleration_squares: f64,
    pub(super) current_squares: f64,
    /// Largest excursion of the mass, voltage, change of it in a tick, and speed of the shaft.
    pub(super) excursion_m: f64,
    pub(super) volts: f64,
    pub(super) volts_a_tick: f64,
    pub(super) shaft_rad_s: f64,
    /// Largest gain of the loop from the actuator to the encoder, at gain 1, and the largest
    /// where it is in phase.
    pub(super) loop_gain: f64,
    pub(super) loop_in_phase: f64,
}

impl ActuatorPart {
    /// Root of the mean of squares.
    pub(super) fn rms(&self, squares: f64) -> f64 {
        (squares / self.ticks.max(1.0)).sqrt()
    }
}

/// Observation of symptoms besides crepitus.
#[derive(Clone, Debug, Default)]
pub(super) struct SymptomObservation {
    /// Their own events.
    pub(super) events: Vec<SymptomEvent>,
    /// Events of the reference, if it solves the input.
    pub(super) truth: Option<Vec<SymptomEvent>>,
    /// Largest error of the torque at the end of a step, if the reference solves the
    /// input, N·m.
    pub(super) torque_error_nm: Option<f64>,
    /// The most that a hand got back at once beyond what sampling generates, as a share
    /// of what the stretched springs hold at the largest torque.
    pub(super) returned: f64,
    /// The most that a hand got back within two seconds, J.
    pub(super) net_returned_j: f64,
}

impl Observation {
    /// A run in steps of `step_s` that has not begun.
    pub(super) fn of_steps(step_s: f64) -> Self {
        Self {
            step_s,
            ..Self::default()
        }
    }

    /// A run that was refused.
    pub(super) fn refused() -> Self {
        Self {
            overflow_s: Some(0.0),
            ..Self::default()
        }
    }

    /// Records the torque of a step, at `now_s`, N·m: it is late after `late_step`, and its bound
    /// is `limit_nm`.
    pub(super) fn row<F: Real>(
        &mut self,
        now_s: f64,
        torque_nm: f64,
        limit_nm: f64,
        late_step: u64,
    ) {
        self.steps += 1;
        if !torque_nm.is_finite() {
            self.overflow_s.get_or_insert(now_s);
        }
        if torque_nm.abs() > limit_nm {
            self.above_s.get_or_insert(now_s);
        }
        if self.steps > late_step {
            self.late_torque.add(torque_nm);
        }
        self.add_torque::<F>(torque_nm);
        self.peak = self.peak.max(torque_nm.abs() / limit_nm);
    }

    /// Records an event and the torque just after it, N·m.
    pub(super) fn event(&mut self, event: TimedEvent, torque_after_nm: f64) {
        self.tally.add(&event);
        if self.events.len() < MOST_KEPT {
            self.events.push(event);
            self.torques_after_nm.push(torque_after_nm);
        }
    }

    /// Simulated time, s.
    pub(super) fn duration_s(&self) -> f64 {
        f64::from_whole(self.steps) * self.step_s
    }

    /// Adds the torque at the end of a step, N·m, which was computed in `F`.
    #[inline]
    pub(super) fn add_torque<F: Real>(&mut self, torque_nm: f64) {
        let moved_nm = (torque_nm - self.last_torque_nm).abs();
        self.largest_step_nm = self.largest_step_nm.max(moved_nm);
        self.last_torque_nm = torque_nm;
        self.torque.add(torque_nm);
        self.torque_bits.add(bits::<F>(torque_nm));
        self.mirrored_bits.add(bits::<F>(-torque_nm));
    }

    /// Returns whether the run itself detects that its step is too long.
    pub(super) fn is_flagged(&self) -> bool {
        self.unresolved_steps > 0
    }
}

/// The bits of a torque in the precision it was computed in; −0 and 0 are one
/// torque.
#[inline]
#[expect(clippy::cast_possible_truncation, reason = "it was an f32")]
fn bits<F: Real>(torque_nm: f64) -> u64 {
    let torque_nm = torque_nm + 0.0;
    if F::NAME == <f32 as Real>::NAME {
        u64::from((torque_nm as f32).to_bits())
    } else {
        torque_nm.to_bits()
    }
}

/// FNV-1a of 64 bits, one round for each torque, whose bits are taken as one
/// word: two runs whose torques are the same to the bit have the same hash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Hash(pub(super) u64);

impl Hash {
    #[inline]
    pub(super) fn add(&mut self, bits: u64) {
        self.0 = (self.0 ^ bits).wrapping_mul(0x0000_0100_0000_01b3);
    }
}

impl Default for Hash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

/// Statistics of all events, stored or not.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    pub(super) breaks: u64,
    pub(super) sticks: u64,
    pub(super) reverses: u64,
    pub(super) most_in_step: u32,
    pub(super) last_s: Option<f64>,
    pub(super) breaks_at_rest: u64,
    /// Times from break to break in one sense, s.
    pub(super) cycles: Spread,
    /// Times from break to stick, s.
    pub(super) slips: Extremes<f64>,
    last_break: Option<(f64, Sense)>,
    slip_began_s: Option<f64>,
}

impl Tally {
    pub(super) fn events(&self) -> u64 {
        self.breaks + self.sticks + self.reverses
    }

    pub(super) fn add(&mut self, event: &TimedEvent) {
        let now_s = event.time_s;
        self.last_s = Some(now_s);
        match event.kind {
            EventKind::Break => {
                self.breaks += 1;
                if let Some((before_s, sense)) = self.last_break
                    && sense == event.sense
                {
                    self.cycles.add(now_s - before_s);
                }
                self.last_break = Some((now_s, event.sense));
                self.slip_began_s = Some(now_s);
            }
            EventKind::Stick => {
                self.sticks += 1;
                if let Some(began_s) = self.slip_began_s.take() {
                    self.slips.add(now_s - began_s);
                }
            }
            EventKind::Reverse => {
                self.reverses += 1;
                self.slip_began_s = None;
                self.last_break = None;
            }
        }
    }
}

/// Running mean and variance (Welford).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spread {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Spread {
    fn add(&mut self, x: f64) {
        self.count += 1.0;
        let off = x - self.mean;
        self.mean += off / self.count;
        self.squares += off * (x - self.mean);
    }

    /// Number of values.
    pub(super) fn count(&self) -> f64 {
        self.count
    }

    /// The mean; `None` without values.
    pub(super) fn mean(&self) -> Option<f64> {
        (self.count > 0.0).then_some(self.mean)
    }

    /// Standard deviation over mean; `None` of fewer than two.
    pub(super) fn variation(&self) -> Option<f64> {
        (self.count > 1.0).then(|| (self.squares / self.count).sqrt() / self.mean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cycles_and_slips_are_distinguished() {
        let mut tally = Tally::default();
        let mut add = |time_s, kind, sense| {
            tally.add(&TimedEvent {
                time_s,
                kind,
                sense,
            });
        };
        let up = Sense::Positive;
        add(1.0, EventKind::Break, up);
        add(1.75, EventKind::Stick, up);
        add(2.0, EventKind::Break, up);
        add(2.75, EventKind::Stick, up);
        add(4.0, EventKind::Break, up);
        add(5.0, EventKind::Reverse, Sense::Negative);
        add(5.5, EventKind::Stick, Sense::Negative);
        add(7.0, EventKind::Break, up);
        assert_eq!((tally.breaks, tally.sticks, tally.reverses), (4, 3, 1));
        assert_eq!(tally.cycles.mean(), Some(1.5));
        assert!((tally.cycles.variation().unwrap() - 1.0 / 3.0).abs() < 1e-15);
        assert_eq!((tally.slips.low, tally.slips.high), (0.75, 0.75));
    }
}
