//! The `frozen` convention: a slip lasts a time that is known when it begins.
//!
//! Nothing is integrated. In stick the torque is kr·θ and θ follows the shaft
//! by position; at |T| = Ts the slip begins, shows s·Tk for the closed-form
//! time of eqs. (10)–(11), and ends with θ at the restart angle. A step inside
//! a slip is one comparison and one decrement; the time itself is computed in
//! the step after the break, where nothing else is to be done, so that no step
//! pays for both. The object's own motion during
//! a slip is a closed form too, computed only on demand.

use core::marker::PhantomData;

use crate::joint::compensated::Compensated;
use crate::joint::shaft::{Linear, ShaftPath, ShaftStep};
use crate::joint::ticks::Ticks;
use crate::joint::{
    Coast, EVENTS_PER_STEP, Event, EventKind, Phase, Sense, StepCoefficients, StickSlip,
};
use crate::real::Real;
use crate::solver::locate::{Locate, StickPath, first_break};

/// The stick-slip object under the `frozen` convention; `L` finds its breaks.
#[derive(Clone, Debug)]
pub struct Frozen<F, L> {
    coefficients: StepCoefficients<F>,
    /// Whole ticks before the one in which a slip ends; 0 in stick. It stands
    /// beside the state so that a step in a slip touches nothing else.
    ticks_left: u64,
    slip_number: u32,
    state: State<F>,
    omega_rad_s: F,
    locator: PhantomData<L>,
}

/// A free period of fewer ticks: a slip may end in the step in which it begins,
/// or in the next.
const SHORT_PERIOD: u64 = 8;

#[derive(Clone, Debug)]
enum State<F> {
    Stick { theta: Compensated<F> },
    Slip(Slip<F>),
}

/// A slip in progress.
#[derive(Clone, Copy, Debug)]
struct Slip<F> {
    sense: Sense,
    /// Fraction of its last tick at which it ends; while it is open, that at which it began.
    end_fraction: F,
    /// The slip began in the step before, and its end is not known yet.
    is_open: bool,
    /// Time from its anchor, where x and v are known, to its end.
    duration: Ticks<F>,
    /// θ − s·Tk/kr at the anchor, rad.
    x: F,
    /// Velocity at the anchor, rad/s.
    v: F,
    /// The largest |θ| it may end at, rad: what the spring held at its break.
    limit_rad: F,
}

impl<F: Real, L: Locate<F, Shape = Linear>> Frozen<F, L> {
    /// An object in stick at θ = 0 on a shaft that moves with `omega_rad_s`.
    pub fn new(coefficients: StepCoefficients<F>, omega_rad_s: F) -> Self {
        Self {
            coefficients,
            ticks_left: 0,
            slip_number: 0,
            state: State::Stick {
                theta: Compensated::new(F::ZERO),
            },
            omega_rad_s,
            locator: PhantomData,
        }
    }

    /// Number of slips begun, modulo 2³². A slip that continues because it
    /// would break at once (Ts = Tk) counts again.
    #[inline]
    pub fn slip_number(&self) -> u32 {
        self.slip_number
    }

    /// Goes on with other numbers, between two steps.
    ///
    /// The energy that the object stores never rises: with
    /// θ ← θ·min(1, kr/kr′) the spring's torque stays where the spring gets
    /// stiffer and falls where it gets softer, and kr·θ²/2 falls in both. In
    /// a slip θ̇ ← θ̇·min(1, √(J/J′)) does the same for J·θ̇²/2; the slip keeps
    /// its end. In stick the object's speed is the hand's, and nothing of it
    /// ever comes back: the torque of a frozen stick has no inertia in it.
    #[inline]
    pub fn adjust(&mut self, next: StepCoefficients<F>) {
        let scale = (self.coefficients.stiffness / next.stiffness).at_most(F::ONE);
        match &mut self.state {
            State::Stick { theta } => {
                // Untouched where nothing changes, to the last rounding error.
                if scale < F::ONE {
                    *theta = Compensated::new(theta.value() * scale);
                }
            }
            State::Slip(slip) => {
                if slip.is_open {
                    self.ticks_left = slip.close(&self.coefficients).saturating_sub(1);
                }
                let end = Ticks {
                    whole: self.ticks_left,
                    fraction: slip.end_fraction,
                };
                let (x, v) = slip.motion(&self.coefficients, slip.duration.less(end));
                let theta = x + slip.sense.of_signed(self.coefficients.kinetic_angle_rad);
                let slower = (self.coefficients.inertia / next.inertia)
                    .at_most(F::ONE)
                    .sqrt();
                *slip = Slip {
                    duration: end,
                    x: theta * scale - slip.sense.of_signed(next.kinetic_angle_rad),
                    v: v * slower,
                    limit_rad: slip.limit_rad * scale,
                    ..*slip
                };
            }
        }
        self.coefficients = next;
    }

    /// The time since the anchor of a slip.
    #[inline]
    fn since_anchor(&self, mut slip: Slip<F>) -> Ticks<F> {
        let whole = if slip.is_open {
            slip.close(&self.coefficients).saturating_sub(1)
        } else {
            self.ticks_left
        };
        slip.duration.less(Ticks {
            whole,
            fraction: slip.end_fraction,
        })
    }

    /// A step that has an event, or is in stick.
    #[inline]
    fn step_with_events(&mut self, shaft: &ShaftStep<F>, mut on_event: impl FnMut(Event<F>)) {
        let mut at = Place::start_of(shaft, &self.coefficients);
        let is_stick = matches!(self.state, State::Stick { .. });
        if !(is_stick && self.stick(&mut at, &mut on_event)) {
            self.end_of_slip(&mut at, &mut on_event);
        }
    }

    /// The end of a slip, and what follows it or a break in the same step. By
    /// itself, so that a step in stick does not carry its load.
    #[inline(never)]
    fn end_of_slip(&mut self, at: &mut Place<F>, on_event: &mut impl FnMut(Event<F>)) {
        // Once without a loop, as there is hardly ever more.
        if !(self.slip(at, on_event) || self.stick(at, on_event)) {
            self.further_phases(at, on_event);
        }
    }

    /// Continues through further phases to the step's end: at most [`EVENTS_PER_STEP`] events in a step.
    #[inline(never)]
    fn further_phases(&mut self, at: &mut Place<F>, on_event: &mut impl FnMut(Event<F>)) {
        loop {
            if self.slip(at, on_event) || self.stick(at, on_event) {
                return;
            }
        }
    }

    /// Continues in stick from here on; returns whether that is the rest of the step.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "as `first_break`")]
    fn stick(&mut self, at: &mut Place<F>, on_event: &mut impl FnMut(Event<F>)) -> bool {
        let State::Stick { theta } = &mut self.state else {
            return false;
        };
        let a = &self.coefficients;
        let theta_from = theta.value();
        let found = if at.events < EVENTS_PER_STEP {
            find_break::<F, L>(a, &at.path, theta_from, at.from_s)
        } else {
            None
        };
        let Some((after_s, sense)) = found else {
            theta.add(if at.events == 0 {
                at.delta_phi_rad
            } else {
                at.path.travel(at.from_s, a.step_s)
            });
            return true;
        };
        let theta = theta_from + at.path.travel(at.from_s, at.from_s + after_s);
        at.from_s += after_s;
        let omega = at.path.omega(at.from_s);
        // Rounding must not put an event before the last one.
        let fraction = (at.from_s * a.per_step).at_least(at.from_fraction);
        let fraction = fraction.at_most(F::ONE);
        at.from_fraction = fraction;
        at.events += 1;
        on_event(Event {
            kind: EventKind::Break,
            fraction,
            from: Phase::Stick,
            to: Phase::Slip(sense),
            theta_rad: theta,
            theta_dot_rad_s: omega,
            omega_rad_s: omega,
            torque_before_nm: a.limited(a.stiffness * theta),
            torque_after_nm: sense.of_signed(a.kinetic_nm),
        });
        self.begin_slip(sense, fraction, theta, omega)
    }

    /// Continues in a slip from here on, if it is one; returns whether that is the rest of the
    /// step.
    #[inline]
    fn slip(&mut self, at: &mut Place<F>, on_event: &mut impl FnMut(Event<F>)) -> bool {
        let State::Slip(slip) = &self.state else {
            return false;
        };
        if self.ticks_left > 0 || at.events >= EVENTS_PER_STEP {
            self.ticks_left = self.ticks_left.saturating_sub(1);
            return true;
        }
        let a = &self.coefficients;
        let (sense, fraction, limit) = (slip.sense, slip.end_fraction, slip.limit_rad);
        at.from_s = fraction * a.step_s;
        at.from_fraction = fraction;
        at.events += 1;
        let omega = at.path.omega(at.from_s);
        let theta = sense.of_signed(a.restart_angle_rad.at_most(limit).at_least(-limit));
        // Ts = Tk: the stick would break where it begins. The slip continues, and
        // nothing is felt or reported.
        if a.touches() && sense.of_signed(at.path.rate(at.from_s)) > F::ZERO {
            return self.begin_slip(sense, fraction, theta, omega);
        }
        on_event(Event {
            kind: EventKind::Stick,
            fraction,
            from: Phase::Slip(sense),
            to: Phase::Stick,
            theta_rad: theta,
            theta_dot_rad_s: omega,
            omega_rad_s: omega,
            torque_before_nm: sense.of_signed(a.kinetic_nm),
            torque_after_nm: a.limited(a.stiffness * theta),
        });
        self.state = State::Stick {
            theta: Compensated::new(theta),
        };
        false
    }

    /// Begins the slip of `sense` at `fraction` of this step in state (θ, Ω):
    /// whether it lasts longer than the step.
    #[inline]
    fn begin_slip(&mut self, sense: Sense, fraction: F, theta: F, omega: F) -> bool {
        let a = &self.coefficients;
        self.slip_number = self.slip_number.wrapping_add(1);
        let mut slip = Slip {
            sense,
            end_fraction: fraction,
            is_open: true,
            duration: Ticks::default(),
            x: theta - sense.of_signed(a.kinetic_angle_rad),
            v: omega,
            limit_rad: a.static_angle_rad,
        };
        // The slip lasts half a period at least.
        let is_long = a.period.whole >= SHORT_PERIOD;
        self.ticks_left = if is_long { 0 } else { slip.close(a) };
        self.state = State::Slip(slip);
        is_long
    }
}

/// Progress within a step.
struct Place<F> {
    path: ShaftPath<F>,
    /// Travel of the whole step, rad.
    delta_phi_rad: F,
    /// Time since its start, s.
    from_s: F,
    /// That time as a fraction of the step.
    from_fraction: F,
    events: usize,
}

impl<F: Real> Place<F> {
    fn start_of(shaft: &ShaftStep<F>, coefficients: &StepCoefficients<F>) -> Self {
        Self {
            path: ShaftPath::new(shaft, coefficients),
            delta_phi_rad: shaft.delta_phi_rad,
            from_s: F::ZERO,
            from_fraction: F::ZERO,
            events: 0,
        }
    }
}

/// Time and sense of the break of a stick at `theta` after `from_s`.
#[inline(always)]
#[expect(clippy::inline_always, reason = "as `first_break`")]
fn find_break<F: Real, L: Locate<F, Shape = Linear>>(
    coefficients: &StepCoefficients<F>,
    path: &ShaftPath<F>,
    theta: F,
    from_s: F,
) -> Option<(F, Sense)> {
    let stick = StickPath {
        torque_nm: coefficients.stiffness * theta,
        rate: coefficients.stiffness * path.rate(from_s),
        curvature: coefficients.stiffness * path.omega_dot(from_s),
        shape: Linear,
    };
    first_break::<F, L>(&stick, coefficients.static_nm, coefficients.step_s - from_s)
}

impl<F: Real> Slip<F> {
    /// Finds its end, with the numbers that it began with: how many whole ticks
    /// are left before the one in which it ends, as its first step begins.
    #[inline]
    fn close(&mut self, coefficients: &StepCoefficients<F>) -> u64 {
        self.is_open = false;
        self.duration = coefficients.slip_time(self.sense.of_signed(self.v));
        let end = self.duration.later_by(self.end_fraction);
        self.end_fraction = end.fraction;
        end.whole
    }

    /// (x, v) of the object `after` the slip began.
    #[inline]
    fn motion(&self, coefficients: &StepCoefficients<F>, after: Ticks<F>) -> (F, F) {
        coefficients
            .oscillator
            .transition(after.value() * coefficients.step_s)
            .apply(self.x, self.v)
    }
}

impl<F: Real, L: Locate<F, Shape = Linear>> StickSlip<F> for Frozen<F, L> {
    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>, on_event: impl FnMut(Event<F>)) {
        if self.ticks_left == 0
            && let State::Slip(slip) = &mut self.state
            && slip.is_open
        {
            self.ticks_left = slip.close(&self.coefficients).saturating_sub(1);
        }
        if self.ticks_left > 0 {
            self.ticks_left -= 1;
        } else {
            self.step_with_events(shaft, on_event);
        }
        self.omega_rad_s = shaft.omega_end_rad_s;
    }

    fn restart(&mut self, torque_nm: F, omega_rad_s: F) {
        let theta = self.coefficients.limited(torque_nm) / self.coefficients.stiffness;
        self.ticks_left = 0;
        self.state = State::Stick {
            theta: Compensated::new(theta),
        };
        self.omega_rad_s = omega_rad_s;
    }

    fn change_step(&mut self, coefficients: StepCoefficients<F>) {
        if let State::Slip(slip) = &mut self.state {
            if slip.is_open {
                self.ticks_left = slip.close(&self.coefficients).saturating_sub(1);
            }
            let ratio = self.coefficients.step_s.to_f64() / coefficients.step_s.to_f64();
            let left = Ticks {
                whole: self.ticks_left,
                fraction: slip.end_fraction,
            };
            let left = left.stretched(ratio);
            self.ticks_left = left.whole;
            slip.end_fraction = left.fraction;
            slip.duration = slip.duration.stretched(ratio);
        }
        self.coefficients = coefficients;
    }

    fn coefficients(&self) -> &StepCoefficients<F> {
        &self.coefficients
    }

    #[inline]
    fn phase(&self) -> Phase {
        match &self.state {
            State::Stick { .. } => Phase::Stick,
            State::Slip(slip) => Phase::Slip(slip.sense),
        }
    }

    #[inline]
    fn torque_nm(&self) -> F {
        match &self.state {
            State::Stick { theta } => self
                .coefficients
                .limited(self.coefficients.stiffness * theta.value()),
            State::Slip(slip) => slip.sense.of_signed(self.coefficients.kinetic_nm),
        }
    }

    fn theta_rad(&self) -> F {
        match &self.state {
            State::Stick { theta } => theta.value(),
            State::Slip(slip) => {
                let (x, _) = slip.motion(&self.coefficients, self.since_anchor(*slip));
                x + slip.sense.of_signed(self.coefficients.kinetic_angle_rad)
            }
        }
    }

    fn theta_dot_rad_s(&self) -> F {
        match &self.state {
            State::Stick { .. } => self.omega_rad_s,
            State::Slip(slip) => slip.motion(&self.coefficients, self.since_anchor(*slip)).1,
        }
    }

    #[inline]
    fn motion(&self) -> (F, F) {
        match &self.state {
            State::Stick { theta } => (theta.value(), self.omega_rad_s),
            State::Slip(slip) => {
                let (x, v) = slip.motion(&self.coefficients, self.since_anchor(*slip));
                let middle = slip.sense.of_signed(self.coefficients.kinetic_angle_rad);
                (x + middle, v)
            }
        }
    }

    #[inline]
    fn coast(&self) -> Option<Coast<F>> {
        match &self.state {
            State::Slip(slip) if self.ticks_left > 0 && !slip.is_open => {
                let since = self.since_anchor(*slip);
                Coast::new(
                    &self.coefficients,
                    self.ticks_left,
                    since,
                    (slip.x, slip.v),
                    slip.sense,
                )
            }
            _ => None,
        }
    }

    #[inline]
    fn skip(&mut self, steps: u32, omega_rad_s: F) {
        self.ticks_left = self.ticks_left.saturating_sub(steps.into());
        self.omega_rad_s = omega_rad_s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Settings;
    use crate::real::counted::{Counted, Operations, operations};
    use crate::solver::locate::ExactEvents;

    /// 1 rad/s: a stick of 20 steps, a slip of 608.
    #[test]
    fn a_step_inside_a_slip_computes_nothing() {
        let f = Counted::from_f64;
        let settings = Settings::default().validate().unwrap();
        let coefficients = StepCoefficients::new(&settings, 5e-5).unwrap();
        let mut joint = Frozen::<Counted, ExactEvents>::new(coefficients, f(1.0));
        let shaft = ShaftStep {
            delta_phi_rad: f(5e-5),
            omega_start_rad_s: f(1.0),
            omega_end_rad_s: f(1.0),
        };
        let mut step = || operations(|| joint.step(&shaft, |_| {})).1;
        let before: u32 = (0..25).map(|_| step().slow).sum();
        assert!(before > 0, "a break and a slip's end are computed");
        for n in 0..500 {
            assert_eq!(step(), Operations::default(), "{n}");
        }
        assert_eq!(joint.phase(), Phase::Slip(Sense::Positive));
    }
}
