//! `diffsol`: an explicit method of order 5 and the backward differentiation formulae of orders 1
//! to 5, roots as in SUNDIALS.
//!
//! One solver serves the whole run: at a root the state is changed in place. The problem is built
//! once. The library has no longest step; where one is asked for, the growth of the step is
//! capped before each step so that it cannot exceed it. Its states are on the heap whatever the
//! size, and it has no state of a fixed size.

use super::{Setting, Steps};
use crate::work::{DURATION_S, Delivery, Mode, Runner, START, Sampler, Task, Work};
use diffsol::{
    DiffsolError, NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquations, OdeSolverConfig,
    OdeSolverMethod, OdeSolverStopReason, Vector,
};
use std::cell::Cell;
use std::rc::Rc;

type Matrix = NalgebraMat<f64>;

/// The problem, with the mode in a cell that its closures share.
macro_rules! problem {
    ($work:expr, $setting:expr, $mode:expr) => {{
        let work = $work;
        let (rhs, jacobian, root) = ($mode.clone(), $mode.clone(), $mode.clone());
        OdeBuilder::<Matrix>::new()
            .h0(work.stick_s / 2.0)
            .rtol($setting.tolerance)
            .atol([$setting.tolerance])
            .rhs_implicit(
                move |y, _, _, dydt| work.derivative(rhs.get(), y, dydt),
                move |_, _, _, w, out| work.jacobian_times(jacobian.get(), w, out),
            )
            .init(|_, _, y| y.copy_from_slice(&START), START.len())
            .root(move |y, _, _, g| g[0] = work.event(root.get(), y), 1)
            .build()
            .map_err(|e| e.to_string())?
    }};
}

/// The explicit method.
pub(super) fn tsit45(work: Work, setting: Setting) -> Result<Runner, String> {
    let mode = Rc::new(Cell::new(Mode::Stick));
    let problem = problem!(work, setting, mode);
    Ok(Box::new(move |task, out| {
        mode.set(Mode::Stick);
        problem
            .tsit45()
            .and_then(|solver| run(solver, work, &mode, setting, task, out, |_| {}))
            .map_err(|e| e.to_string())
    }))
}

/// The implicit multistep method.
pub(super) fn bdf(work: Work, setting: Setting) -> Result<Runner, String> {
    let mode = Rc::new(Cell::new(Mode::Stick));
    let problem = problem!(work, setting, mode);
    Ok(Box::new(move |task, out| {
        mode.set(Mode::Stick);
        problem
            .bdf::<NalgebraLU<f64>>()
            .and_then(|solver| {
                // The method starts again at order 1: the step of the old order would be rejected.
                run(solver, work, &mode, setting, task, out, |solver| {
                    let p = &problem;
                    solver
                        .state_mut()
                        .set_step_size(p.h0, &p.atol, p.rtol, &p.eqn, 1);
                })
            })
            .map_err(|e| e.to_string())
    }))
}

fn run<'a, E, S>(
    mut solver: S,
    work: Work,
    mode: &Cell<Mode>,
    setting: Setting,
    task: Task,
    out: &mut Delivery,
    restarted: impl Fn(&mut S),
) -> Result<(), DiffsolError>
where
    E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a,
    S: OdeSolverMethod<'a, E>,
    S::Config: OdeSolverConfig<f64>,
{
    let mut steps = Steps::new(&work, setting);
    let growth = *solver.config().as_base_ref().maximum_timestep_growth;
    let context = *solver.state().y.context();
    let mut y = NalgebraVec::zeros(START.len(), context);
    let Delivery { events, torque } = out;
    let mut sampler = Sampler::new(&work, task, torque);
    events.clear();
    loop {
        let now = mode.get();
        if setting.limited {
            let room = (steps.limit(now) / solver.state().h).min(growth);
            *solver.config_mut().as_base_mut().maximum_timestep_growth = room;
        }
        let event_s = match solver.step()? {
            OdeSolverStopReason::RootFound(time_s, _) => Some(time_s),
            _ => None,
        };
        let reached_s = event_s.unwrap_or(solver.state().t);
        sampler.deliver(now, reached_s, |time_s| {
            match solver.interpolate_inplace(time_s, &mut y) {
                Ok(()) => work.torque(now, y.batch_as_slice(0)),
                Err(_) => f64::NAN,
            }
        });
        if reached_s >= DURATION_S {
            return Ok(());
        }
        let Some(event_s) = event_s else { continue };
        events.push(event_s);
        solver.interpolate_inplace(event_s, &mut y)?;
        steps.note(now, solver.state().h);
        mode.set(now.next());
        let state = solver.state_mut();
        let at = Work::restart([y[0], y[1]]);
        let mut rate = [0.0; 2];
        work.derivative(mode.get(), &at, &mut rate);
        for i in 0..at.len() {
            state.y[i] = at[i];
            state.dy[i] = rate[i];
        }
        *state.t = event_s;
        if let Some(step_s) = steps.first(mode.get()) {
            *state.h = step_s;
        }
        restarted(&mut solver);
    }
}
