//! `differential-equations`: Hairer's explicit methods, events by Brent and Dekker.
//!
//! The library's stepping traits are driven directly: its `solve_ode` clones states and pushes
//! every step into a fresh `Solution`. States are arrays, so a step allocates nothing.
//!
//! Each mode has a time of its own that begins at zero. The event search stops at 1e-12·|t|,
//! which at t = 10 s is 1e-11 s an event and, added up, above 1e-9 s; near zero it stops at
//! 1e-14 s. `max_steps` counts over the life of a method, not from its `init`.

use super::{Setting, Steps};
use crate::work::{DURATION_S, Delivery, Mode, Runner, START, Sampler, Task, Work};
use differential_equations::control::ControlFlag;
use differential_equations::interpolate::Interpolation;
use differential_equations::methods::{DormandPrince, ExplicitRungeKutta, Ordinary};
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use differential_equations::solout::{CrossingDirection, Event, EventConfig, EventSolout, Solout};
use differential_equations::solution::Solution;
use differential_equations::status::Status;

type Method<const O: usize, const S: usize, const I: usize> =
    ExplicitRungeKutta<Ordinary, DormandPrince, f64, [f64; 2], O, S, I>;

/// The method of order 5.
pub(super) fn dopri5(work: Work, setting: Setting) -> Runner {
    runner(ExplicitRungeKutta::dopri5(), work, setting)
}

/// The method of order 8.
pub(super) fn dop853(work: Work, setting: Setting) -> Runner {
    runner(ExplicitRungeKutta::dop853(), work, setting)
}

struct System {
    work: Work,
    mode: Mode,
}

impl ODE<f64, [f64; 2]> for System {
    #[inline]
    fn diff(&self, _: f64, y: &[f64; 2], dydt: &mut [f64; 2]) {
        self.work.derivative(self.mode, y, dydt);
    }
}

impl Event<f64, [f64; 2]> for System {
    fn config(&self) -> EventConfig {
        EventConfig::new(CrossingDirection::Negative, Some(1))
    }

    #[inline]
    fn event(&self, _: f64, y: &[f64; 2]) -> f64 {
        self.work.event(self.mode, y)
    }
}

fn runner<const O: usize, const S: usize, const I: usize>(
    method: Method<O, S, I>,
    work: Work,
    setting: Setting,
) -> Runner {
    let mut method = method
        .rtol(setting.tolerance)
        .atol(setting.tolerance)
        .max_steps(usize::MAX);
    Box::new(move |task, out| {
        run(&mut method, work, setting, task, out).map_err(|e| format!("{e:?}"))
    })
}

type Failure = differential_equations::error::Error<f64, [f64; 2]>;

fn run<const O: usize, const S: usize, const I: usize>(
    method: &mut Method<O, S, I>,
    work: Work,
    setting: Setting,
    task: Task,
    out: &mut Delivery,
) -> Result<(), Failure> {
    let mut steps = Steps::new(&work, setting);
    let mut system = System {
        work,
        mode: Mode::Stick,
    };
    let mut solution = Solution::new();
    let (mut y, mut begun_s) = (START, 0.0);
    let Delivery { events, torque } = out;
    let mut sampler = Sampler::new(&work, task, torque);
    events.clear();
    loop {
        let mode = system.mode;
        method.h_max = steps.limit(mode);
        method.h0 = steps.first(mode).unwrap_or(0.0);
        method.init(&system, 0.0, DURATION_S, &y)?;
        solution.t.clear();
        solution.y.clear();
        let mut detector = EventSolout::new(&system, 0.0, DURATION_S);
        // The first call only looks at the sign; without it the first step has no event.
        detector.solout(0.0, 0.0, &y, &y, method, &mut solution);
        let event_s = loop {
            method.step(&system)?;
            if matches!(method.status(), Status::RejectedStep) {
                continue;
            }
            let (from_s, to_s) = (method.t_prev(), method.t());
            let (before, after) = (*method.y_prev(), *method.y());
            let found = matches!(
                detector.solout(to_s, from_s, &after, &before, method, &mut solution),
                ControlFlag::Terminate
            );
            let until_s = if found { solution.t[0] } else { to_s };
            sampler.deliver(mode, begun_s + until_s, |time_s| {
                method
                    .interpolate((time_s - begun_s).clamp(from_s, to_s))
                    .map_or(f64::NAN, |y| work.torque(mode, &y))
            });
            if begun_s + until_s >= DURATION_S {
                return Ok(());
            }
            if found {
                break until_s;
            }
        };
        begun_s += event_s;
        events.push(begun_s);
        steps.note(mode, method.h());
        y = Work::restart(solution.y[0]);
        system.mode = mode.next();
    }
}
