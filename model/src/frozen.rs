//! The `frozen` convention: a slip lasts a time that is known when it begins.
//!
//! Nothing is integrated. In stick the torque is kr·θ and θ follows the shaft
//! by position; at |T| = Ts the slip begins, shows s·Tk for the closed-form
//! time of eqs. (10)–(11), and ends with θ at the restart angle. A step inside
//! a slip is one comparison and one decrement. The object's own motion during
//! a slip is a closed form too, computed only when it is asked for.

use core::marker::PhantomData;

use crate::active::Active;
use crate::compensated::Compensated;
use crate::event::{EVENTS_PER_STEP, Event};
use crate::locate::{Locate, StickPath, first_break};
use crate::phase::{EventKind, Phase, Sense};
use crate::real::Real;
use crate::shaft::{ShaftPath, ShaftStep};
use crate::stick_slip::StickSlip;
use crate::ticks::Ticks;

/// The stick-slip object under the `frozen` convention; `L` finds its breaks.
#[derive(Clone, Debug)]
pub struct Frozen<F, L> {
    active: Active<F>,
    state: State<F>,
    omega_rad_s: F,
    locator: PhantomData<L>,
}

#[derive(Clone, Debug)]
enum State<F> {
    Stick { theta: Compensated<F> },
    Slip(Slip<F>),
}

/// A slip on its way.
#[derive(Clone, Debug)]
struct Slip<F> {
    sense: Sense,
    /// From the start of the current step to the end of the slip.
    end: Ticks<F>,
    /// From its beginning to its end.
    duration: Ticks<F>,
    /// θ − s·Tk/kr at its beginning, rad.
    x: F,
    /// Velocity at its beginning, rad/s.
    v: F,
}

impl<F: Real, L: Locate<F>> Frozen<F, L> {
    /// An object in stick at θ = 0 on a shaft that moves with `omega_rad_s`.
    pub fn new(active: Active<F>, omega_rad_s: F) -> Self {
        Self {
            active,
            state: State::Stick {
                theta: Compensated::new(F::ZERO),
            },
            omega_rad_s,
            locator: PhantomData,
        }
    }

    /// The slip that begins at `fraction` of this step in state (θ, Ω).
    fn slip(&self, sense: Sense, fraction: F, theta: F, omega: F) -> Slip<F> {
        let duration = self.active.slip_time(sense.of_signed(omega));
        Slip {
            sense,
            end: duration.later_by(fraction),
            duration,
            x: theta - sense.of_signed(self.active.kinetic_angle_rad),
            v: omega,
        }
    }

    /// Where and in which sense a stick at `theta` breaks after `from_s`.
    fn find_break(&self, path: &ShaftPath<F>, theta: F, from_s: F) -> Option<(F, Sense)> {
        let a = &self.active;
        let stick = StickPath {
            torque_nm: a.stiffness * theta,
            rate: a.stiffness * path.rate(from_s),
            curvature: a.stiffness * path.omega_dot,
        };
        first_break::<F, L>(&stick, a.static_nm, a.step_s - from_s)
    }

    /// The steps that have an event, or are in stick.
    fn step_with_events(&mut self, shaft: &ShaftStep<F>, mut on_event: impl FnMut(Event<F>)) {
        let a = self.active;
        let path = ShaftPath::new(shaft, &a);
        let mut from_s = F::ZERO;
        let mut events = 0;
        loop {
            match &mut self.state {
                State::Stick { theta } => {
                    let theta_from = theta.value();
                    let found = if events < EVENTS_PER_STEP {
                        self.find_break(&path, theta_from, from_s)
                    } else {
                        None
                    };
                    let Some((after_s, sense)) = found else {
                        if let State::Stick { theta } = &mut self.state {
                            theta.add(if events == 0 {
                                shaft.delta_phi_rad
                            } else {
                                path.travel(from_s, a.step_s)
                            });
                        }
                        return;
                    };
                    let theta = theta_from + path.travel(from_s, from_s + after_s);
                    from_s += after_s;
                    let omega = path.omega(from_s);
                    let fraction = (from_s * a.per_step).at_most(F::ONE);
                    self.state = State::Slip(self.slip(sense, fraction, theta, omega));
                    events += 1;
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
                }
                State::Slip(slip) if slip.end.whole > 0 || events >= EVENTS_PER_STEP => {
                    slip.end.whole = slip.end.whole.saturating_sub(1);
                    return;
                }
                State::Slip(slip) => {
                    let (sense, fraction) = (slip.sense, slip.end.fraction);
                    from_s = fraction * a.step_s;
                    let omega = path.omega(from_s);
                    let theta = sense.of_signed(a.restart_angle_rad);
                    let torque = a.stiffness * theta;
                    events += 1;
                    // Ts = Tk: the stick would break where it begins. The slip
                    // goes on, and nothing is felt or reported.
                    if a.touches() && sense.of_signed(path.rate(from_s)) > F::ZERO {
                        self.state = State::Slip(self.slip(sense, fraction, theta, omega));
                        continue;
                    }
                    self.state = State::Stick {
                        theta: Compensated::new(theta),
                    };
                    on_event(Event {
                        kind: EventKind::Stick,
                        fraction,
                        from: Phase::Slip(sense),
                        to: Phase::Stick,
                        theta_rad: theta,
                        theta_dot_rad_s: omega,
                        omega_rad_s: omega,
                        torque_before_nm: sense.of_signed(a.kinetic_nm),
                        torque_after_nm: a.limited(torque),
                    });
                }
            }
        }
    }
}

impl<F: Real> Slip<F> {
    /// (x, v) of the object `after` the slip began.
    fn motion(&self, active: &Active<F>, after: Ticks<F>) -> (F, F) {
        active
            .oscillator
            .transition(after.value() * active.step_s)
            .apply(self.x, self.v)
    }
}

impl<F: Real, L: Locate<F>> StickSlip<F> for Frozen<F, L> {
    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>, on_event: impl FnMut(Event<F>)) {
        match &mut self.state {
            State::Slip(slip) if slip.end.whole > 0 => slip.end.whole -= 1,
            _ => self.step_with_events(shaft, on_event),
        }
        self.omega_rad_s = shaft.omega_end_rad_s;
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
            State::Stick { theta } => self.active.limited(self.active.stiffness * theta.value()),
            State::Slip(slip) => slip.sense.of_signed(self.active.kinetic_nm),
        }
    }

    fn theta_rad(&self) -> F {
        match &self.state {
            State::Stick { theta } => theta.value(),
            State::Slip(slip) => {
                let (x, _) = slip.motion(&self.active, slip.duration.less(slip.end));
                x + slip.sense.of_signed(self.active.kinetic_angle_rad)
            }
        }
    }

    fn theta_dot_rad_s(&self) -> F {
        match &self.state {
            State::Stick { .. } => self.omega_rad_s,
            State::Slip(slip) => slip.motion(&self.active, slip.duration.less(slip.end)).1,
        }
    }
}
