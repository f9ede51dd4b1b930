//! The `paper` and `physical` conventions: a slip ends when the object's
//! velocity meets the shaft's, eq. (8).
//!
//! At that velocity match the static limit is checked, which the paper leaves
//! out: if the torque that stick needs is above Ts, the object slips on in the
//! other sense (`reverse`). Both conventions share everything but the torque
//! of a stick, which is their [`StickTorque`].

use core::marker::PhantomData;

use crate::joint::compensated::Compensated;
use crate::joint::shaft::{ShaftPath, ShaftStep, VelocityShape};
use crate::joint::{
    EVENTS_PER_STEP, Event, EventKind, Phase, Sense, SlipLane, StepCoefficients, StickSlip,
};
use crate::real::Real;
use crate::solver::locate::{Locate, SlipPath, StickPath, earlier, first_break};
use crate::solver::propagate::Propagate;

/// Terms of a stick's torque besides the spring's.
pub trait StickTorque<F: Real>: Copy + Send + 'static {
    /// The part that comes from the object's own motion, N·m.
    fn inertial(coefficients: &StepCoefficients<F>, omega: F, omega_dot: F) -> F;
}

/// `paper`: T = kr·θ, eq. (7).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Paper;

/// `physical`: T = kr·θ + J·Ω̇ + c·Ω.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Physical;

impl<F: Real> StickTorque<F> for Paper {
    #[inline]
    fn inertial(_: &StepCoefficients<F>, _: F, _: F) -> F {
        F::ZERO
    }
}

impl<F: Real> StickTorque<F> for Physical {
    #[inline]
    fn inertial(coefficients: &StepCoefficients<F>, omega: F, omega_dot: F) -> F {
        coefficients.inertia * omega_dot + coefficients.damping * omega
    }
}

/// The stick-slip object whose slips end at a velocity match: `C` is its stick
/// torque, `P` moves it in a slip, `L` finds its events.
#[derive(Clone, Debug)]
pub struct VelocityMatch<F, C, P, L> {
    coefficients: StepCoefficients<F>,
    propagator: P,
    state: State<F>,
    /// Ω at the end of the last step.
    omega_rad_s: F,
    rules: PhantomData<(C, L)>,
}

#[derive(Clone, Copy, Debug)]
enum State<F> {
    Stick {
        theta: Compensated<F>,
        /// The part of the torque that is not the spring's, N·m.
        inertial_nm: F,
    },
    Slip {
        sense: Sense,
        /// x = θ − s·Tk/kr, rad.
        x: F,
        /// θ̇, rad/s.
        v: F,
    },
}

/// Point in a step that the object has reached.
struct Here<F> {
    time_s: F,
    omega: F,
    fraction: F,
}

impl<F: Real, C: StickTorque<F>, P: Propagate<F>, L: Locate<F>> VelocityMatch<F, C, P, L> {
    /// An object in stick at θ = 0 on a shaft that moves with `omega_rad_s`.
    pub fn new(coefficients: StepCoefficients<F>, omega_rad_s: F) -> Self {
        Self {
            propagator: P::new(&coefficients),
            state: State::Stick {
                theta: Compensated::new(F::ZERO),
                inertial_nm: C::inertial(&coefficients, omega_rad_s, F::ZERO),
            },
            coefficients,
            omega_rad_s,
            rules: PhantomData,
        }
    }

    /// Begins a slip and reports how.
    #[inline]
    fn begin_slip(
        &mut self,
        sense: Sense,
        (theta, v): (F, F),
        here: &Here<F>,
        on_event: &mut impl FnMut(Event<F>),
    ) {
        let a = &self.coefficients;
        let (kind, from, torque_before_nm) = match self.state {
            State::Stick { inertial_nm, .. } => (
                EventKind::Break,
                Phase::Stick,
                a.limited(a.stiffness * theta + inertial_nm),
            ),
            State::Slip { sense, .. } => (
                EventKind::Reverse,
                Phase::Slip(sense),
                sense.of_signed(a.kinetic_nm),
            ),
        };
        on_event(Event {
            kind,
            fraction: here.fraction,
            from,
            to: Phase::Slip(sense),
            theta_rad: theta,
            theta_dot_rad_s: v,
            omega_rad_s: here.omega,
            torque_before_nm,
            torque_after_nm: sense.of_signed(a.kinetic_nm),
        });
        self.state = State::Slip {
            sense,
            x: theta - sense.of_signed(a.kinetic_angle_rad),
            v,
        };
    }

    /// The stick's torque from `here` on.
    #[inline]
    fn stick_path(
        &self,
        path: &ShaftPath<F, L::Shape>,
        theta: F,
        here: &Here<F>,
    ) -> StickPath<F, L::Shape> {
        let a = &self.coefficients;
        let (omega_dot, shape) = (path.omega_dot(here.time_s), path.shape());
        let still = C::inertial(a, here.omega, omega_dot);
        // The inertial part grows by its own change of Ω and Ω̇: linear, so exact.
        let grown = C::inertial(a, here.omega + omega_dot, shape.plus(omega_dot, || F::ONE));
        StickPath {
            torque_nm: a.stiffness * theta + still,
            rate: a.stiffness * path.rate(here.time_s) + (grown - still),
            curvature: shape.plus(a.stiffness * omega_dot, || C::inertial(a, F::ONE, F::ZERO)),
            shape: shape.times(a.stiffness),
        }
    }

    /// Can the object slip in `sense` at all, when stick shows `torque_nm`?
    ///
    /// A slip needs the shaft to overtake the object: d(Ω − θ̇)/dt =
    /// (kr·θ + J·Ω̇ + c·Ω − s·Tk)/J must have the sign s. Under `physical` this
    /// follows from reaching Ts ≥ Tk. The paper's torque leaves the inertia
    /// out, so while the hand brakes harder than (Ts − Tk)/J it would break
    /// and re-stick without end; there the stick is held, shown at its limit.
    #[inline]
    fn slips(&self, sense: Sense, torque_nm: F, omega: F, omega_dot: F) -> bool {
        let hidden = Physical::inertial(&self.coefficients, omega, omega_dot)
            - C::inertial(&self.coefficients, omega, omega_dot);
        sense.of_signed(torque_nm + hidden)
            >= self.coefficients.kinetic_nm * (F::ONE - F::LIMIT_SLACK)
    }

    /// The first break in the rest of the step.
    #[inline]
    fn find_break(
        &self,
        path: &ShaftPath<F, L::Shape>,
        theta: F,
        here: &Here<F>,
    ) -> Option<(F, Sense)> {
        let stick = self.stick_path(path, theta, here);
        let length_s = self.coefficients.step_s - here.time_s;
        let (after_s, sense) = first_break::<F, L>(&stick, self.coefficients.static_nm, length_s)?;
        let break_s = here.time_s + after_s;
        let (omega, omega_dot) = (path.omega(break_s), path.omega_dot(break_s));
        if self.slips(sense, stick.at(after_s), omega, omega_dot) {
            return Some((after_s, sense));
        }
        earlier(
            self.held_break(Sense::Positive, &stick, path, here),
            self.held_break(Sense::Negative, &stick, path, here),
        )
    }

    /// The first break in `sense` of a stick that may have to be held: at its
    /// limit it waits for the true torque to reach Tk, unless the spring comes
    /// back below the limit first.
    #[inline]
    fn held_break(
        &self,
        sense: Sense,
        stick: &StickPath<F, L::Shape>,
        path: &ShaftPath<F, L::Shape>,
        here: &Here<F>,
    ) -> Option<(F, Sense)> {
        // A parabola or a cubic is above a limit in two stretches at most.
        const STRETCHES: u32 = 2;
        let a = &self.coefficients;
        let length_s = a.step_s - here.time_s;
        let mut from_s = F::ZERO;
        for _ in 0..STRETCHES {
            let left_s = length_s - from_s;
            from_s += L::break_time(&stick.from(from_s), sense, a.static_nm, left_s)?;
            let now_s = here.time_s + from_s;
            let (omega, omega_dot) = (path.omega(now_s), path.omega_dot(now_s));
            if self.slips(sense, stick.at(from_s), omega, omega_dot) {
                return Some((from_s, sense));
            }
            let shape = path.shape();
            let mut truth = stick.from(from_s);
            truth.torque_nm +=
                Physical::inertial(a, omega, omega_dot) - C::inertial(a, omega, omega_dot);
            truth.rate += shape.plus(a.damping * omega_dot, || a.inertia);
            truth.curvature = shape.plus(truth.curvature, || a.damping);
            from_s += L::break_time(&truth, sense, a.kinetic_nm, length_s - from_s)?;
            if sense.of_signed(stick.at(from_s)) >= a.static_nm * (F::ONE - F::LIMIT_SLACK) {
                return Some((from_s, sense));
            }
        }
        None
    }

    /// A velocity jump of the shaft at the start of a step: what sticks is
    /// torn loose, what slips may have to slip the other way.
    #[inline]
    fn jump(&mut self, omega: F, on_event: &mut impl FnMut(Event<F>)) {
        let (state, v) = match self.state {
            State::Stick { theta, .. } => ((theta.value(), self.omega_rad_s), self.omega_rad_s),
            State::Slip { sense, x, v } => {
                let theta = x + sense.of_signed(self.coefficients.kinetic_angle_rad);
                ((theta, v), v)
            }
        };
        let here = Here {
            time_s: F::ZERO,
            omega,
            fraction: F::ZERO,
        };
        match (Sense::of(omega - v), self.phase()) {
            (None, _) => {}
            (Some(s), Phase::Slip(now)) if s == now => {}
            (Some(s), _) => self.begin_slip(s, state, &here, on_event),
        }
    }

    /// The velocity match of a slip at `here`, object at x.
    #[inline]
    fn meet(
        &mut self,
        path: &ShaftPath<F, L::Shape>,
        sense: Sense,
        x: F,
        here: &Here<F>,
        on_event: &mut impl FnMut(Event<F>),
    ) {
        let a = &self.coefficients;
        let theta = x + sense.of_signed(a.kinetic_angle_rad);
        let stick = self.stick_path(path, theta, here);
        let omega_dot = path.omega_dot(here.time_s);
        let limit = a.static_nm;
        let beyond = stick.torque_nm.abs() > limit + a.limit_slack_nm(here.omega);
        // The sense in which it slips on, if stick cannot hold it.
        let slips = Sense::of(stick.torque_nm)
            .filter(|s| beyond && self.slips(*s, stick.torque_nm, here.omega, omega_dot));
        if let Some(other) = slips
            && other != sense
        {
            self.begin_slip(other, (theta, here.omega), here, on_event);
            return;
        }
        // With Ts = Tk the stick would break where it begins.
        let breaks_at_once = a.touches()
            && !beyond
            && sense.of_signed(stick.torque_nm) >= limit - a.touch_slack_nm(here.omega)
            && sense.of_signed(stick.rate) >= F::ZERO;
        if slips.is_some() || breaks_at_once {
            // A touch: the velocities meet and part again. The slip continues,
            // and nothing is felt or reported.
            self.state = State::Slip {
                sense,
                x,
                v: here.omega,
            };
            return;
        }
        on_event(Event {
            kind: EventKind::Stick,
            fraction: here.fraction,
            from: Phase::Slip(sense),
            to: Phase::Stick,
            theta_rad: theta,
            theta_dot_rad_s: here.omega,
            omega_rad_s: here.omega,
            torque_before_nm: sense.of_signed(a.kinetic_nm),
            torque_after_nm: a.limited(stick.torque_nm),
        });
        // Beyond the limit by rounding only: at it, so as not to break at once.
        let excess = stick.torque_nm - a.limited(stick.torque_nm);
        let theta = if beyond {
            theta
        } else {
            theta - excess / a.stiffness
        };
        self.state = self.stick(Compensated::new(theta), here.omega, omega_dot);
    }

    /// The place `time_s` into the step, which rounding may have put beyond its
    /// end.
    #[inline]
    fn at(&self, path: &ShaftPath<F, L::Shape>, time_s: F) -> Here<F> {
        let time_s = time_s.at_most(self.coefficients.step_s);
        Here {
            time_s,
            omega: path.omega(time_s),
            fraction: (time_s * self.coefficients.per_step).at_most(F::ONE),
        }
    }

    /// A stick at `theta` on a shaft of this velocity and acceleration.
    #[inline]
    fn stick(&self, theta: Compensated<F>, omega: F, omega_dot: F) -> State<F> {
        State::Stick {
            theta,
            inertial_nm: C::inertial(&self.coefficients, omega, omega_dot),
        }
    }
}

impl<F: Real, C: StickTorque<F>, P: Propagate<F>, L: Locate<F>> StickSlip<F>
    for VelocityMatch<F, C, P, L>
{
    const HAS_LANES: bool = L::LEAVES_OUT_CHORDS && P::IS_LINEAR;

    #[inline]
    fn step(&mut self, shaft: &ShaftStep<F>, mut on_event: impl FnMut(Event<F>)) {
        let step_s = self.coefficients.step_s;
        let path = ShaftPath::<F, L::Shape>::new(shaft, &self.coefficients);
        let mut here = Here {
            time_s: F::ZERO,
            omega: shaft.omega_start_rad_s,
            fraction: F::ZERO,
        };
        let mut changes = 0;
        if shaft.omega_start_rad_s != self.omega_rad_s {
            self.jump(shaft.omega_start_rad_s, &mut on_event);
            changes += 1;
        }
        loop {
            let left_s = step_s - here.time_s;
            let may_change = changes < EVENTS_PER_STEP;
            match self.state {
                State::Stick { mut theta, .. } => {
                    let found = if may_change {
                        self.find_break(&path, theta.value(), &here)
                    } else {
                        None
                    };
                    let Some((after_s, sense)) = found else {
                        theta.add(if changes == 0 {
                            shaft.delta_phi_rad
                        } else {
                            path.travel(here.time_s, step_s)
                        });
                        self.state =
                            self.stick(theta, shaft.omega_end_rad_s, path.omega_dot(step_s));
                        break;
                    };
                    let from_s = here.time_s;
                    here = self.at(&path, from_s + after_s);
                    if after_s > F::ZERO {
                        theta.add(path.travel(from_s, here.time_s));
                        self.state = self.stick(theta, here.omega, path.omega_dot(here.time_s));
                    }
                    self.begin_slip(sense, (theta.value(), here.omega), &here, &mut on_event);
                }
                State::Slip { sense, x, v } => {
                    let end = if changes == 0 {
                        self.propagator.step(x, v)
                    } else {
                        self.propagator.part(x, v, left_s)
                    };
                    let slip = SlipPath {
                        propagator: &self.propagator,
                        oscillator: &self.coefficients.oscillator,
                        sense,
                        x,
                        v,
                        omega: here.omega,
                        omega_dot: path.omega_dot(here.time_s),
                        shape: path.shape(),
                    };
                    let found = if may_change {
                        L::match_time(&slip, left_s, end.1)
                    } else {
                        None
                    };
                    let Some(after_s) = found else {
                        self.state = State::Slip {
                            sense,
                            x: end.0.settled(),
                            v: end.1.settled(),
                        };
                        break;
                    };
                    let (x, _) = self.propagator.part(x, v, after_s);
                    here = self.at(&path, here.time_s + after_s);
                    self.meet(&path, sense, x, &here, &mut on_event);
                }
            }
            changes += 1;
        }
        self.omega_rad_s = shaft.omega_end_rad_s;
    }

    fn restart(&mut self, torque_nm: F, omega_rad_s: F) {
        let a = &self.coefficients;
        let inertial_nm = C::inertial(a, omega_rad_s, F::ZERO);
        let theta = (a.limited(torque_nm) - inertial_nm) / a.stiffness;
        self.state = self.stick(Compensated::new(theta), omega_rad_s, F::ZERO);
        self.omega_rad_s = omega_rad_s;
    }

    fn change_step(&mut self, coefficients: StepCoefficients<F>) {
        self.propagator = P::new(&coefficients);
        self.coefficients = coefficients;
    }

    fn coefficients(&self) -> &StepCoefficients<F> {
        &self.coefficients
    }

    #[inline]
    fn phase(&self) -> Phase {
        match self.state {
            State::Stick { .. } => Phase::Stick,
            State::Slip { sense, .. } => Phase::Slip(sense),
        }
    }

    #[inline]
    fn torque_nm(&self) -> F {
        let a = &self.coefficients;
        match self.state {
            State::Stick { theta, inertial_nm } => {
                a.limited(a.stiffness * theta.value() + inertial_nm)
            }
            State::Slip { sense, .. } => sense.of_signed(a.kinetic_nm),
        }
    }

    fn theta_rad(&self) -> F {
        match self.state {
            State::Stick { theta, .. } => theta.value(),
            State::Slip { sense, x, .. } => {
                x + sense.of_signed(self.coefficients.kinetic_angle_rad)
            }
        }
    }

    fn theta_dot_rad_s(&self) -> F {
        match self.state {
            State::Stick { .. } => self.omega_rad_s,
            State::Slip { v, .. } => v,
        }
    }

    #[inline]
    fn slip_lane(&self) -> Option<SlipLane<F>> {
        let (State::Slip { sense, x, v }, Some(step)) = (self.state, self.propagator.whole_step())
        else {
            return None;
        };
        let a = &self.coefficients;
        let middle_rad = a.kinetic_angle_rad;
        Self::HAS_LANES.then(|| SlipLane::new(sense, (x, v), step, &a.oscillator, middle_rad))
    }

    #[inline]
    fn set_slip(&mut self, to_x: F, to_v: F, omega_rad_s: F) {
        if let State::Slip { x, v, .. } = &mut self.state {
            (*x, *v) = (to_x, to_v);
        }
        self.omega_rad_s = omega_rad_s;
    }
}
