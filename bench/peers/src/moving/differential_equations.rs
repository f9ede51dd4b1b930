//! `differential-equations` on a moving hand; driven as at a constant speed, see
//! `peers/differential_equations.rs`.

use super::integrator::{Integrator, PhaseEnd, Step};
use super::phases::Phases;
use super::{Runner, Setting};
use differential_equations::control::ControlFlag;
use differential_equations::methods::{DormandPrince, ExplicitRungeKutta, Ordinary};
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use differential_equations::solout::{CrossingDirection, Event, EventConfig, EventSolout, Solout};
use differential_equations::solution::Solution;
use differential_equations::status::Status;

type Method<const O: usize, const S: usize, const I: usize> =
    ExplicitRungeKutta<Ordinary, DormandPrince, f64, [f64; 2], O, S, I>;

/// The method of order 5.
pub(super) fn dopri5(phases: Phases, setting: Setting) -> Runner {
    runner(ExplicitRungeKutta::dopri5(), phases, setting)
}

/// The method of order 8.
pub(super) fn dop853(phases: Phases, setting: Setting) -> Runner {
    runner(ExplicitRungeKutta::dop853(), phases, setting)
}

fn runner<const O: usize, const S: usize, const I: usize>(
    method: Method<O, S, I>,
    phases: Phases,
    setting: Setting,
) -> Runner {
    let mut library = Library {
        method: method
            .rtol(setting.tolerance)
            .atol(setting.tolerance)
            .max_steps(usize::MAX),
        solution: Solution::new(),
    };
    Box::new(move |_, out| {
        let mut phase = Phase {
            library: &mut library,
            phases: &phases,
        };
        phases.run(&mut phase, setting.slip_limit_s, &mut out.events)
    })
}

struct Library<const O: usize, const S: usize, const I: usize> {
    method: Method<O, S, I>,
    solution: Solution<f64, [f64; 2]>,
}

struct Phase<'a, const O: usize, const S: usize, const I: usize> {
    library: &'a mut Library<O, S, I>,
    phases: &'a Phases,
}

/// A phase, whose time begins at zero.
struct System<'a> {
    phases: &'a Phases,
    begun_s: f64,
}

impl ODE<f64, [f64; 2]> for System<'_> {
    #[inline]
    fn diff(&self, t: f64, y: &[f64; 2], dydt: &mut [f64; 2]) {
        self.phases.derivative(self.begun_s + t, y, dydt);
    }
}

impl Event<f64, [f64; 2]> for System<'_> {
    fn config(&self) -> EventConfig {
        EventConfig::new(CrossingDirection::Negative, Some(1))
    }

    #[inline]
    fn event(&self, t: f64, y: &[f64; 2]) -> f64 {
        self.phases.event(self.begun_s + t, y)
    }
}

impl<const O: usize, const S: usize, const I: usize> Integrator for Phase<'_, O, S, I> {
    fn phase(&mut self, from_s: f64, y: [f64; 2], step: Step) -> Result<Option<PhaseEnd>, String> {
        let Library { method, solution } = &mut *self.library;
        let system = System {
            phases: self.phases,
            begun_s: from_s,
        };
        let duration_s = self.phases.duration_s();
        method.h_max = step.longest_s;
        method.h0 = step.first_s.unwrap_or(0.0);
        method
            .init(&system, 0.0, duration_s, &y)
            .map_err(|e| format!("{e:?}"))?;
        solution.t.clear();
        solution.y.clear();
        let mut detector = EventSolout::new(&system, 0.0, duration_s);
        // The first call only looks at the sign; without it the first step has no event.
        detector.solout(0.0, 0.0, &y, &y, method, solution);
        loop {
            method.step(&system).map_err(|e| format!("{e:?}"))?;
            if matches!(method.status(), Status::RejectedStep) {
                continue;
            }
            let (until_s, since_s) = (method.t(), method.t_prev());
            let (before, after) = (*method.y_prev(), *method.y());
            let found = detector.solout(until_s, since_s, &after, &before, method, solution);
            if matches!(found, ControlFlag::Terminate) {
                return Ok(Some(PhaseEnd {
                    time_s: from_s + solution.t[0],
                    y: solution.y[0],
                    step_s: method.h(),
                }));
            }
            if from_s + until_s >= duration_s {
                return Ok(None);
            }
        }
    }
}
