//! `ivp`: SciPy's `solve_ivp` in Rust.
//!
//! A solve call with events allocates for every sample, searches its steps from the first for
//! each, and with `t_eval` loses the samples of the step in which a terminal event lies. So its
//! methods are called directly, with its callback after each step, which costs less than half as
//! much. The callback gets the library's interpolant but not its event search, which is private:
//! that is done here (Illinois' rule on the interpolant, to below 1e-13 s).

use super::falls_at::falls_at;
use super::{Setting, Steps};
use crate::work::{DURATION_S, Delivery, Mode, Runner, START, Sampler, Task, Work};
use ivp::methods::{DOP853, DOPRI5};
use ivp::prelude::{ControlFlag, FirstOrderSystem, StepInterpolant};
use ivp::solout::SolOut;

/// The method of order 5.
pub(super) fn dopri5(work: Work, setting: Setting) -> Runner {
    runner(work, setting, move |system, y, first_s, limit_s, watch| {
        DOPRI5::builder()
            .max_steps(usize::MAX)
            .maybe_first_step(first_s)
            .max_step(limit_s)
            .build()
            .solve(
                system,
                0.0,
                y,
                DURATION_S,
                setting.tolerance.into(),
                setting.tolerance.into(),
                Some(watch),
            )
            .map(|_| ())
            .map_err(|e| format!("{e:?}"))
    })
}

/// The method of order 8.
pub(super) fn dop853(work: Work, setting: Setting) -> Runner {
    runner(work, setting, move |system, y, first_s, limit_s, watch| {
        DOP853::builder()
            .max_steps(usize::MAX)
            .maybe_first_step(first_s)
            .max_step(limit_s)
            .build()
            .solve(
                system,
                0.0,
                y,
                DURATION_S,
                setting.tolerance.into(),
                setting.tolerance.into(),
                Some(watch),
            )
            .map(|_| ())
            .map_err(|e| format!("{e:?}"))
    })
}

#[derive(Clone, Copy)]
struct System {
    work: Work,
    mode: Mode,
}

impl FirstOrderSystem for System {
    #[inline]
    fn derivative(&self, _: f64, y: &[f64], dydt: &mut [f64]) {
        self.work.derivative(self.mode, y, dydt);
    }
}

/// Watches one mode, which begins at `begun_s` and has a time of its own.
struct Watch<'a> {
    system: System,
    begun_s: f64,
    before: f64,
    step_s: f64,
    sampler: Sampler<'a>,
    /// Time and state of the event.
    event: Option<(f64, [f64; 2])>,
}

impl Watch<'_> {
    /// Time and state at which the event function falls through zero.
    fn locate(
        &self,
        span_s: (f64, f64),
        values: (f64, f64),
        interpolant: &StepInterpolant<'_>,
    ) -> (f64, [f64; 2]) {
        let mut y = [0.0; 2];
        let time_s = falls_at(span_s, values, |time_s| {
            interpolant.interpolate(time_s, &mut y);
            self.system.work.event(self.system.mode, &y)
        });
        (time_s, y)
    }
}

impl SolOut for Watch<'_> {
    fn solout(
        &mut self,
        from_s: f64,
        to_s: &mut f64,
        y: &mut [f64],
        interpolant: Option<&StepInterpolant<'_>>,
    ) -> ControlFlag {
        let System { work, mode } = self.system;
        let (before, after) = (self.before, work.event(mode, y));
        self.before = after;
        let (Some(interpolant), true) = (interpolant, *to_s > from_s) else {
            return ControlFlag::Continue;
        };
        self.step_s = *to_s - from_s;
        if before > 0.0 && after <= 0.0 {
            self.event = Some(self.locate((from_s, *to_s), (before, after), interpolant));
        }
        let until_s = self.event.map_or(*to_s, |(time_s, _)| time_s);
        let begun_s = self.begun_s;
        self.sampler.deliver(mode, begun_s + until_s, |time_s| {
            let mut y = [0.0; 2];
            interpolant.interpolate(time_s - begun_s, &mut y);
            work.torque(mode, &y)
        });
        if self.event.is_some() || begun_s + until_s >= DURATION_S {
            ControlFlag::Interrupt
        } else {
            ControlFlag::Continue
        }
    }
}

type Solve<'s> =
    &'s dyn Fn(&System, &[f64], Option<f64>, f64, &mut Watch<'_>) -> Result<(), String>;

fn runner(
    work: Work,
    setting: Setting,
    solve: impl Fn(&System, &[f64], Option<f64>, f64, &mut Watch<'_>) -> Result<(), String> + 'static,
) -> Runner {
    Box::new(move |task, out| run(&solve, work, setting, task, out))
}

fn run(
    solve: Solve<'_>,
    work: Work,
    setting: Setting,
    task: Task,
    out: &mut Delivery,
) -> Result<(), String> {
    let mut steps = Steps::new(&work, setting);
    let Delivery { events, torque } = out;
    events.clear();
    let mut y = START;
    let mut watch = Watch {
        system: System {
            work,
            mode: Mode::Stick,
        },
        begun_s: 0.0,
        before: 0.0,
        step_s: 0.0,
        sampler: Sampler::new(&work, task, torque),
        event: None,
    };
    loop {
        let system = watch.system;
        let mode = system.mode;
        // The library takes the whole length for "no limit".
        let limit_s = steps.limit(mode).min(DURATION_S);
        watch.event = None;
        solve(&system, &y, steps.first(mode), limit_s, &mut watch)?;
        let Some((event_s, at)) = watch.event else {
            return Ok(());
        };
        if watch.begun_s + event_s >= DURATION_S {
            return Ok(());
        }
        watch.begun_s += event_s;
        events.push(watch.begun_s);
        steps.note(mode, watch.step_s);
        y = Work::restart(at);
        watch.system.mode = mode.next();
    }
}
