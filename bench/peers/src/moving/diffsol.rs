//! `diffsol` on a moving hand; driven as at a constant speed, see `peers/diffsol.rs`.

use super::integrator::{Integrator, PhaseEnd, Step};
use super::phases::Phases;
use super::{Runner, Setting};
use diffsol::{
    NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquations, OdeSolverConfig,
    OdeSolverMethod, OdeSolverStopReason,
};
use std::marker::PhantomData;
use std::rc::Rc;

type Matrix = NalgebraMat<f64>;

/// The first step of a run, s; each phase sets its own.
const FIRST_STEP_S: f64 = 5e-4;

macro_rules! problem {
    ($setting:expr, $phases:expr) => {{
        let (rhs, jacobian, root) = ($phases.clone(), $phases.clone(), $phases.clone());
        OdeBuilder::<Matrix>::new()
            .h0(FIRST_STEP_S)
            .rtol($setting.tolerance)
            .atol([$setting.tolerance])
            .rhs_implicit(
                move |y, _, t, dydt| rhs.derivative(t, y, dydt),
                move |_, _, _, w, out| jacobian.jacobian_times(w, out),
            )
            .init(|_, _, y| y.fill(0.0), 2)
            .root(move |y, _, t, g| g[0] = root.event(t, y), 1)
            .build()
            .map_err(|e| e.to_string())?
    }};
}

/// The explicit method.
pub(super) fn tsit45(phases: Phases, setting: Setting) -> Result<Runner, String> {
    let phases = Rc::new(phases);
    let problem = problem!(setting, phases);
    Ok(Box::new(move |_, out| {
        let solver = problem.tsit45().map_err(|e| e.to_string())?;
        let mut phase = Phase::new(solver, &phases, |_: &mut _| {});
        phases.run(&mut phase, setting.slip_limit_s, &mut out.events)
    }))
}

/// The implicit multistep method.
pub(super) fn bdf(phases: Phases, setting: Setting) -> Result<Runner, String> {
    let phases = Rc::new(phases);
    let problem = problem!(setting, phases);
    Ok(Box::new(move |_, out| {
        let solver = problem
            .bdf::<NalgebraLU<f64>>()
            .map_err(|e| e.to_string())?;
        // The method starts again at order 1: the step of the old order would be rejected.
        let mut phase = Phase::new(solver, &phases, |solver: &mut _| {
            let p = &problem;
            solver
                .state_mut()
                .set_step_size(p.h0, &p.atol, p.rtol, &p.eqn, 1);
        });
        phases.run(&mut phase, setting.slip_limit_s, &mut out.events)
    }))
}

struct Phase<'p, 'a, E, S, R> {
    solver: S,
    phases: &'p Phases,
    /// State that the method needs at the start of a phase.
    restarted: R,
    /// Largest factor by which a step may grow.
    growth: f64,
    y: NalgebraVec<f64>,
    equations: PhantomData<&'a E>,
}

impl<'p, 'a, E, S, R> Phase<'p, 'a, E, S, R>
where
    E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a,
    S: OdeSolverMethod<'a, E>,
    S::Config: OdeSolverConfig<f64>,
    R: Fn(&mut S),
{
    fn new(solver: S, phases: &'p Phases, restarted: R) -> Self {
        Self {
            growth: *solver.config().as_base_ref().maximum_timestep_growth,
            y: solver.state().y.clone(),
            solver,
            phases,
            restarted,
            equations: PhantomData,
        }
    }
}

impl<'a, E, S, R> Integrator for Phase<'_, 'a, E, S, R>
where
    E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a,
    S: OdeSolverMethod<'a, E>,
    S::Config: OdeSolverConfig<f64>,
    R: Fn(&mut S),
{
    fn phase(&mut self, from_s: f64, y: [f64; 2], step: Step) -> Result<Option<PhaseEnd>, String> {
        let solver = &mut self.solver;
        let mut rate = [0.0; 2];
        self.phases.derivative(from_s, &y, &mut rate);
        let state = solver.state_mut();
        for i in 0..y.len() {
            state.y[i] = y[i];
            state.dy[i] = rate[i];
        }
        *state.t = from_s;
        if let Some(step_s) = step.first_s {
            *state.h = step_s;
        }
        (self.restarted)(solver);
        loop {
            // There is no longest step, so its growth is capped.
            let room = (step.longest_s / solver.state().h).min(self.growth);
            *solver.config_mut().as_base_mut().maximum_timestep_growth = room;
            let event_s = match solver.step().map_err(|e| e.to_string())? {
                OdeSolverStopReason::RootFound(time_s, _) => Some(time_s),
                _ => None,
            };
            let reached_s = event_s.unwrap_or(solver.state().t);
            if reached_s > self.phases.duration_s() {
                return Ok(None);
            }
            let Some(time_s) = event_s else { continue };
            solver
                .interpolate_inplace(time_s, &mut self.y)
                .map_err(|e| e.to_string())?;
            return Ok(Some(PhaseEnd {
                time_s,
                y: [self.y[0], self.y[1]],
                step_s: solver.state().h,
            }));
        }
    }
}
