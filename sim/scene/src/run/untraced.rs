//! A run of `exact-events` without a trace: from event to event.
//!
//! Where the velocity of a prescribed shaft is linear piece by piece, a step of `exact-events` in
//! f64 makes no error of its own. On a curved motion a `frozen` one makes little: then its error is
//! bounded on the way ([`error_bound`]). So its events are those of the event-driven reference, and what the
//! steps add up has a closed form, or an integral, for each stretch of stick and each slip:
//!
//! ```text
//! Reference ── events ──> Untraced ── stretches ──> Tally
//!                             └─ which steps end in a stretch: what was looked at there, too
//! ```
//!
//! Events are the same to 1e-9 s, and sums to rounding: also what a step gets wrong by its length
//! (T² between its ends, looks at a slip at the ends of steps) is accounted for as it would be. On a curved
//! motion sums differ by what those events make of them: at most 1e-9 s·ωn of the largest of their kind.
//! Where the bound is too large, a step has as many events as it can report, or rounding decides about a
//! velocity match, this run ends ([`Way::Unfit`]), and the steps are made.

mod curved;
mod error_bound;
mod stretches;

use super::held_back::{Beyond, TankTotals};
use super::lead::Lead;
use super::tally::Tally;
use super::watch::{Ended, Stopped, Watch};
use super::{Totals, steps};
use crate::reference::{Follow, Reference};
use crate::scene::{Precision, Scene, SolverChoice};
use crate::trace::{EventRecord, SymptomEvent};
use crate::walk::Clock;
use crepitus_model::joint::oscillator::Oscillator;
use crepitus_model::solver::Solver;
use crepitus_model::{
    Convention, EVENTS_PER_STEP, Event, EventKind, Phase, Sense, Settings, StepCoefficients,
    Validated,
};
use crepitus_plant::{Motion, Piece};
use error_bound::ErrorBound;
use std::ops::ControlFlow;

/// Number of events between two reports of progress.
const PROGRESS_EVENTS: u32 = 1 << 12;

/// Part of a step within which an end of a step counts as at a knot of the motion, as for who steps.
const SAME_TIME: f64 = 1e-6;

/// Acceleration with which velocities may cross in rounding, as a share of the largest of a swing over Ts/kr.
const TIE: f64 = 1e-6;

/// Returns the settings and the step of a scene whose run needs no steps where nobody wants rows.
fn stepless(scene: &Scene) -> Option<(&Validated<Settings>, f64)> {
    let SolverChoice::Ladder {
        solver: Solver::ExactEvents,
        step_s,
        precision: Precision::F64,
    } = scene.solver
    else {
        return None;
    };
    let settings = &scene.crepitus.as_ref()?.settings;
    let p = &settings.parameters;
    let is_closed = match settings.convention {
        Convention::Frozen => true,
        Convention::Physical => scene.motion.is_parabolic(),
        Convention::Paper => false,
    };
    let touches = StepCoefficients::<f64>::new(settings, step_s)
        .ok()?
        .touches();
    // A torque beyond a device's is counted in steps.
    let is_shown = p.static_torque_nm <= Beyond::new().limit_nm;
    let is_alone = !scene.is_coupled() && scene.encoder.is_none() && scene.listed.is_empty();
    (is_closed && !touches && is_shown && is_alone).then_some((settings, step_s))
}

/// Returns whether a run of the scene without a trace goes from event to event.
pub fn is_stepless(scene: &Scene) -> bool {
    stepless(scene).is_some()
}

/// Outcome of a run.
#[expect(clippy::large_enum_variant, reason = "there is one of them in a run")]
pub(super) enum Way {
    /// To its end.
    Whole(Totals),
    /// To an event that steps may have elsewhere, or not at all; so many were reported before.
    Unfit(u64),
    /// Not begun: it needs its steps.
    Steps,
}

/// Runs a scene from event to event, if its steps make no difference.
pub(super) fn simulate(scene: &Scene, watch: &mut dyn Watch) -> Result<Way, Ended> {
    let Some((settings, step_s)) = stepless(scene) else {
        return Ok(Way::Steps);
    };
    watch.progress(0.0)?;
    let (steps, _) = steps(scene);
    let clock = Clock::new(step_s);
    let end_s = clock.time_s(steps);
    let mut reference = Reference::new(settings, &scene.motion);
    let mut untraced = Untraced::new(settings, &scene.motion, (clock, step_s, end_s), watch);
    match reference.follow(end_s, &mut untraced) {
        ControlFlow::Continue(()) => {}
        ControlFlow::Break(End::Stopped(stopped)) => return Err(stopped.into()),
        ControlFlow::Break(End::Unfit) => return Ok(Way::Unfit(untraced.reported)),
    }
    Ok(Way::Whole(untraced.finish(steps, end_s, &reference)))
}

/// Reason for the early end of a run.
enum End {
    Stopped(Stopped),
    Unfit,
}

/// A watch for the second half of a run: events that were reported are not reported again.
pub(super) struct Later<'w> {
    pub(super) watch: &'w mut dyn Watch,
    /// Number of events to leave out.
    pub(super) reported: u64,
}

impl Watch for Later<'_> {
    fn wants_rows(&self) -> bool {
        self.watch.wants_rows()
    }

    fn needs_steps(&self) -> bool {
        true
    }

    fn row(&mut self, values: &[f64]) -> Result<(), Stopped> {
        self.watch.row(values)
    }

    fn event(&mut self, event: &EventRecord) -> Result<(), Stopped> {
        if self.reported > 0 {
            self.reported -= 1;
            return Ok(());
        }
        self.watch.event(event)
    }

    fn symptom(&mut self, event: &SymptomEvent) -> Result<(), Stopped> {
        self.watch.symptom(event)
    }

    fn progress(&mut self, time_s: f64) -> Result<(), Stopped> {
        self.watch.progress(time_s)
    }
}

/// The object since the last event.
#[derive(Clone, Copy)]
enum Since {
    /// Stick: θ − φ, rad.
    Stick { offset_rad: f64 },
    /// Slip from the event on.
    Slip(Begun),
}

/// Beginning of a slip.
#[derive(Clone, Copy)]
struct Begun {
    sense: Sense,
    time_s: f64,
    /// θ − s·Tk/kr, rad, and θ̇, rad/s.
    state: (f64, f64),
    /// Whether the shaft kept the velocity of the object at the beginning: until it
    /// ends, it is not behind.
    is_steady: bool,
}

/// Keeps the tally of a run from event to event.
struct Untraced<'a, 'w> {
    watch: &'w mut dyn Watch,
    settings: &'a Settings,
    oscillator: Oscillator<f64>,
    tally: Tally,
    motion: &'a Motion,
    piece: Piece,
    place: usize,
    clock: Clock,
    step_s: f64,
    phi_start_rad: f64,
    /// Torque shown at the start, N·m.
    first_nm: f64,
    fastest_rad_s: f64,
    /// Time up to which everything is accounted for, and the end of the run, s.
    time_s: f64,
    end_s: f64,
    since: Since,
    /// End of the step of the last event, s, and the events in it so far.
    crowd: (f64, usize),
    error: ErrorBound,
    reported: u64,
}

impl<'a, 'w> Untraced<'a, 'w> {
    fn new(
        settings: &'a Validated<Settings>,
        motion: &'a Motion,
        (clock, step_s, end_s): (Clock, f64, f64),
        watch: &'w mut dyn Watch,
    ) -> Self {
        let piece = motion.piece(0.0);
        let first = piece.at(0.0);
        let lead = Lead::new(settings, step_s, false);
        let mut tally = Tally::new(**settings, first.omega_rad_s, lead, false);
        // A joint that has just been made does not know of an acceleration yet.
        let first_nm = match settings.convention {
            Convention::Physical => settings.parameters.damping_nms_per_rad * first.omega_rad_s,
            Convention::Frozen | Convention::Paper => 0.0,
        };
        let limit_nm = settings.parameters.static_torque_nm;
        let first_nm = first_nm.clamp(-limit_nm, limit_nm);
        tally.shown(first_nm);
        let mut untraced = Self {
            watch,
            settings,
            oscillator: Oscillator::of(&settings.parameters),
            tally,
            motion,
            piece,
            place: 0,
            clock,
            step_s,
            phi_start_rad: first.phi_rad,
            first_nm,
            fastest_rad_s: first.omega_rad_s.abs(),
            time_s: 0.0,
            end_s,
            since: Since::Stick {
                offset_rad: -first.phi_rad,
            },
            crowd: (f64::NEG_INFINITY, 0),
            error: ErrorBound::new(settings, step_s),
            reported: 0,
        };
        untraced.see_speeds();
        untraced
    }

    /// Looks at a frozen slip at the ends of the steps at which a stepping run does. A slip under
    /// `physical` ends where the shaft would fall behind.
    fn look_back(&mut self, begun: &Begun, end_s: f64, is_over: bool) {
        if self.settings.convention != Convention::Frozen {
            return;
        }
        let first = self.step_from(begun.time_s).max(1);
        let after = self.step_from(if is_over { end_s } else { end_s.next_up() });
        let looks = self.tally.lead.looks_in(after.saturating_sub(first));
        if begun.is_steady {
            return;
        }
        for step in looks {
            let time_s = self.clock.time_s(first + step - 1);
            let piece = self.motion.piece(time_s.next_down());
            let omega_rad_s = piece.angle_and_velocity(time_s).1;
            let (x, v) = begun.state;
            let (_, v) = self
                .oscillator
                .transition(time_s - begun.time_s)
                .apply(x, v);
            let sign = begun.sense.of_signed(1.0);
            self.tally.lead.look(sign, omega_rad_s, v);
        }
    }

    /// Counts an event in its step; returns whether the step has as many as a step may have.
    fn crowds(&mut self, time_s: f64) -> bool {
        let (step_end_s, count) = self.crowd;
        if time_s <= step_end_s + SAME_TIME * self.step_s {
            self.crowd.1 = count + 1;
        } else {
            self.crowd = (self.clock.time_s(self.step_from(time_s)), 1);
        }
        self.crowd.1 >= EVENTS_PER_STEP
    }

    /// Returns whether rounding decides about a velocity match: with a knot of the motion, where one event may be
    /// two, or because the object has died away on a shaft at rest, so that nothing crosses.
    fn is_tie(&self, event: &Event<f64>, piece: &Piece) -> bool {
        if event.kind == EventKind::Break || self.settings.convention != Convention::Physical {
            return false;
        }
        let p = &self.settings.parameters;
        let (from_s, left_s) = (event.fraction - piece.start_s, piece.end_s - event.fraction);
        let begins = event.kind == EventKind::Stick && piece.start_s > 0.0;
        let same_s = SAME_TIME * self.step_s;
        let is_at_knot = left_s <= same_s || (begins && from_s <= same_s);
        let centre_rad =
            f64::from(event.from.sign()) * p.kinetic_torque_nm / p.stiffness_nm_per_rad;
        let (x, v) = (event.theta_rad - centre_rad, event.theta_dot_rad_s);
        let crossing = piece.at(event.fraction).omega_dot - self.oscillator.acceleration(x, v);
        let swing =
            p.natural_rad_s() * p.natural_rad_s() * p.static_torque_nm / p.stiffness_nm_per_rad;
        is_at_knot || crossing.abs() <= TIE * swing
    }

    fn finish(mut self, steps: u64, end_s: f64, reference: &Reference<'_>) -> Totals {
        self.go_to(end_s, None);
        let shaft = reference.shaft();
        match self.since {
            Since::Stick { .. } => self.tally.shown(reference.torque_nm()),
            Since::Slip(begun) => self.look_back(&begun, end_s, false),
        }
        self.tally.finish(
            end_s,
            shaft.phi_rad - self.phi_start_rad,
            reference.theta_rad(),
            reference.theta_dot_rad_s(),
        );
        Totals {
            steps,
            end_s,
            tally: Some(self.tally),
            fastest_rad_s: self.fastest_rad_s,
            crowded_steps: 0,
            tank: TankTotals::default(),
            beyond: Beyond::new(),
            plant: None,
        }
    }
}

impl Follow for Untraced<'_, '_> {
    type Stop = End;

    fn event(&mut self, mut event: Event<f64>) -> ControlFlow<End> {
        let time_s = event.fraction;
        if time_s == 0.0 && event.from == Phase::Stick {
            event.torque_before_nm = self.first_nm;
        }
        let piece = self.piece_at(time_s);
        self.error.event(&event, &piece);
        if self.crowds(time_s) || !self.error.is_small() || self.is_tie(&event, &piece) {
            return ControlFlow::Break(End::Unfit);
        }
        self.go_to(
            time_s,
            (event.from == Phase::Stick).then_some(event.theta_rad),
        );
        if let Since::Slip(begun) = self.since {
            self.look_back(&begun, time_s, true);
        }
        let shaft = self.piece.at(time_s);
        self.tally
            .event(time_s, shaft.phi_rad - self.phi_start_rad, &event);
        self.since = match event.to {
            Phase::Stick => Since::Stick {
                offset_rad: event.theta_rad - shaft.phi_rad,
            },
            Phase::Slip(sense) => {
                let p = &self.settings.parameters;
                let centre_rad = sense.of_signed(p.kinetic_torque_nm / p.stiffness_nm_per_rad);
                Since::Slip(Begun {
                    sense,
                    time_s,
                    state: (event.theta_rad - centre_rad, event.theta_dot_rad_s),
                    is_steady: self.piece.is_steady()
                        && p.damping_nms_per_rad == 0.0
                        && event.theta_dot_rad_s == event.omega_rad_s
                        && event.from == Phase::Stick,
                })
            }
        };
        self.reported += 1;
        if let Err(stopped) = self.watch.event(&EventRecord::new(time_s, &event)) {
            return ControlFlow::Break(End::Stopped(stopped));
        }
        if self.reported.is_multiple_of(u64::from(PROGRESS_EVENTS)) {
            return self.poll(time_s);
        }
        ControlFlow::Continue(())
    }

    fn poll(&mut self, time_s: f64) -> ControlFlow<End> {
        match self.watch.progress(time_s) {
            Ok(()) => ControlFlow::Continue(()),
            Err(stopped) => ControlFlow::Break(End::Stopped(stopped)),
        }
    }
}
