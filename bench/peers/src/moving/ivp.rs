//! `ivp` on a moving hand; driven as at a constant speed, see `peers/ivp.rs`.

use super::integrator::{Integrator, PhaseEnd, Step};
use super::phases::Phases;
use super::{Runner, Setting};
use crate::peers::falls_at::falls_at;
use ivp::methods::{DOP853, DOPRI5};
use ivp::prelude::{ControlFlag, FirstOrderSystem, StepInterpolant};
use ivp::solout::SolOut;

/// The method of order 5.
pub(super) fn dopri5(phases: Phases, setting: Setting) -> Runner {
    runner(
        phases,
        setting,
        move |system, y, step, duration_s, watch| {
            DOPRI5::builder()
                .max_steps(usize::MAX)
                .maybe_first_step(step.first_s)
                .max_step(step.longest_s)
                .build()
                .solve(
                    system,
                    0.0,
                    y,
                    duration_s,
                    setting.tolerance.into(),
                    setting.tolerance.into(),
                    Some(watch),
                )
                .map(|_| ())
                .map_err(|e| format!("{e:?}"))
        },
    )
}

/// The method of order 8.
pub(super) fn dop853(phases: Phases, setting: Setting) -> Runner {
    runner(
        phases,
        setting,
        move |system, y, step, duration_s, watch| {
            DOP853::builder()
                .max_steps(usize::MAX)
                .maybe_first_step(step.first_s)
                .max_step(step.longest_s)
                .build()
                .solve(
                    system,
                    0.0,
                    y,
                    duration_s,
                    setting.tolerance.into(),
                    setting.tolerance.into(),
                    Some(watch),
                )
                .map(|_| ())
                .map_err(|e| format!("{e:?}"))
        },
    )
}

/// A phase, whose time begins at zero.
#[derive(Clone, Copy)]
struct System<'a> {
    phases: &'a Phases,
    begun_s: f64,
}

impl System<'_> {
    fn event(&self, t: f64, y: &[f64]) -> f64 {
        self.phases.event(self.begun_s + t, y)
    }
}

impl FirstOrderSystem for System<'_> {
    #[inline]
    fn derivative(&self, t: f64, y: &[f64], dydt: &mut [f64]) {
        self.phases.derivative(self.begun_s + t, y, dydt);
    }
}

struct Watch<'a> {
    system: System<'a>,
    before: f64,
    end: Option<PhaseEnd>,
}

impl SolOut for Watch<'_> {
    fn solout(
        &mut self,
        from_s: f64,
        to_s: &mut f64,
        y: &mut [f64],
        interpolant: Option<&StepInterpolant<'_>>,
    ) -> ControlFlag {
        let system = self.system;
        let after = system.event(*to_s, y);
        let before = std::mem::replace(&mut self.before, after);
        let (Some(interpolant), true) = (interpolant, *to_s > from_s) else {
            return ControlFlag::Continue;
        };
        if !(before > 0.0 && after <= 0.0) {
            return if system.begun_s + *to_s >= system.phases.duration_s() {
                ControlFlag::Interrupt
            } else {
                ControlFlag::Continue
            };
        }
        let mut at = [0.0; 2];
        let time_s = falls_at((from_s, *to_s), (before, after), |t| {
            interpolant.interpolate(t, &mut at);
            system.event(t, &at)
        });
        self.end = Some(PhaseEnd {
            time_s: system.begun_s + time_s,
            y: at,
            step_s: *to_s - from_s,
        });
        ControlFlag::Interrupt
    }
}

struct Phase<'a, F> {
    phases: &'a Phases,
    solve: &'a F,
}

impl<F> Integrator for Phase<'_, F>
where
    F: Fn(&System<'_>, &[f64], Step, f64, &mut Watch<'_>) -> Result<(), String>,
{
    fn phase(&mut self, from_s: f64, y: [f64; 2], step: Step) -> Result<Option<PhaseEnd>, String> {
        let system = System {
            phases: self.phases,
            begun_s: from_s,
        };
        let duration_s = self.phases.duration_s();
        // The library takes the whole length for "no limit".
        let step = Step {
            longest_s: step.longest_s.min(duration_s),
            ..step
        };
        let mut watch = Watch {
            system,
            before: 0.0,
            end: None,
        };
        (self.solve)(&system, &y, step, duration_s, &mut watch)?;
        Ok(watch.end)
    }
}

fn runner(
    phases: Phases,
    setting: Setting,
    solve: impl Fn(&System<'_>, &[f64], Step, f64, &mut Watch<'_>) -> Result<(), String> + 'static,
) -> Runner {
    Box::new(move |_, out| {
        let mut phase = Phase {
            phases: &phases,
            solve: &solve,
        };
        phases.run(&mut phase, setting.slip_limit_s, &mut out.events)
    })
}
