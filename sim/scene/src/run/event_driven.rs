//! A run of the `reference` solver: from event to event, rows read off in
//! between.

use super::held_back::{Beyond, TankAccounting};
use super::lead::Lead;
use super::tally::{StickEnd, Tally};
use super::watch::{Ended, Stopped, Watch};
use super::{Totals, steps};
use crate::reference::symptoms::{ListedSymptoms, NamedEvent, Paid};
use crate::reference::{Follow, Reference};
use crate::scene::Scene;
use crate::trace::{EventRecord, SymptomEvent};
use crate::walk::Clock;
use crepitus_model::{Event, Phase, Settings, SettingsError};
use crepitus_plant::{Motion, ShaftState};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// Number of rows between two reports of progress.
const PROGRESS_ROWS: u64 = 1 << 12;

/// Number of looks at a slip in a swing of the object, however far apart
/// the rows are.
const LOOKS_PER_SWING: f64 = 64.0;

/// The most looks between two rows.
const MOST_LOOKS: f64 = 1e6;

pub(super) fn simulate(scene: &Scene, watch: &mut dyn Watch) -> Result<Totals, Ended> {
    let (rows, _) = steps(scene);
    let wants_rows = watch.wants_rows();
    let clock = Clock::new(scene.trace_step_s);
    let first = scene.motion.at(0.0);
    let mut fastest_rad_s = first.omega_rad_s.abs();
    let mut joint = scene.crepitus.map(|crepitus| {
        let reference = Reference::new(&crepitus.settings, &scene.motion);
        let touches = reference.touches();
        let accounting = EventAccounting::new(*crepitus.settings, &scene.motion, &first, touches);
        (reference, accounting)
    });
    let mut symptoms = ListedSymptoms::new(&scene.listed, &scene.motion)
        .map_err(|_| SettingsError::Contradiction { reason: UNSOLVED })?;
    let mut unshown = Unshown {
        tank: TankAccounting::default(),
        beyond: Beyond::new(),
    };
    let mut row = Vec::new();

    for n in 0..=rows {
        let time_s = clock.time_s(n);
        tell(scene, &mut symptoms, time_s, &mut unshown, watch)?;
        let mut sum_nm = symptoms.torques().map(|(_, nm)| nm).sum::<f64>();
        row.clear();
        if let Some((reference, accounting)) = &mut joint {
            accounting.follow(time_s, reference, watch)?;
            accounting.end_row(time_s, reference);
            sum_nm += reference.torque_nm();
            let shaft = reference.shaft();
            fastest_rad_s = fastest_rad_s.max(shaft.omega_rad_s.abs());
            if wants_rows {
                row.extend([
                    time_s,
                    shaft.phi_rad,
                    shaft.omega_rad_s,
                    f64::from(reference.phase().sign()),
                    reference.theta_rad(),
                    reference.theta_dot_rad_s(),
                    reference.torque_nm(),
                ]);
            }
        } else {
            let shaft = scene.motion.at(time_s);
            fastest_rad_s = fastest_rad_s.max(shaft.omega_rad_s.abs());
            if wants_rows {
                row.extend([time_s, shaft.phi_rad, shaft.omega_rad_s]);
            }
        }
        if n > 0 {
            unshown.beyond.note(sum_nm, (time_s, scene.trace_step_s));
        }
        if wants_rows {
            row.extend(symptoms.torques().map(|(_, nm)| nm));
            row.extend(symptoms.held_back());
            watch.row(&row)?;
        }
        if n.is_multiple_of(PROGRESS_ROWS) {
            watch.progress(time_s)?;
        }
    }
    // What is left after the last row has events, too.
    let end_s = scene.duration_s.max(clock.time_s(rows));
    tell(scene, &mut symptoms, end_s, &mut unshown, watch)?;
    if let Some((reference, accounting)) = &mut joint {
        accounting.follow(end_s, reference, watch)?;
        accounting.end_row(end_s, reference);
    }
    let tally = joint.map(|(reference, mut accounting)| {
        let phi = reference.shaft().phi_rad - accounting.phi_start_rad;
        accounting.tally.finish(
            end_s,
            phi,
            reference.theta_rad(),
            reference.theta_dot_rad_s(),
        );
        accounting.tally
    });
    Ok(Totals {
        steps: rows,
        end_s,
        tally,
        fastest_rad_s,
        crowded_steps: 0,
        tank: unshown.tank.totals(),
        beyond: unshown.beyond,
        plant: None,
    })
}

/// A scene checks its numbers before it runs.
const UNSOLVED: &str = "the numbers of a symptom have no solution";

/// Accounts of torque that is held back, or beyond what a device shows.
struct Unshown {
    tank: TankAccounting,
    beyond: Beyond,
}

/// Passes on what happens to the symptoms up to a time.
fn tell(
    scene: &Scene,
    symptoms: &mut ListedSymptoms<'_>,
    to_s: f64,
    unshown: &mut Unshown,
    watch: &mut dyn Watch,
) -> Result<(), Ended> {
    let mut held_back = Vec::new();
    let mut on_paid = |paid: &Paid| {
        let torques = (paid.asked_nm, paid.paid_nm);
        let step = (paid.end_s, paid.step_s);
        if let Some(ended) = unshown.tank.paid(paid.effect, torques, step) {
            let shaft = scene.motion.at(paid.end_s);
            held_back.push(SymptomEvent {
                time_s: paid.end_s,
                effect: paid.effect,
                word: ended.word,
                angle_rad: shaft.phi_rad,
                omega_rad_s: shaft.omega_rad_s,
                torque_before_nm: ended.asked_nm,
                torque_after_nm: ended.paid_nm,
            });
        }
    };
    let found = symptoms.advance(to_s, &mut on_paid);
    let mut events: Vec<_> = found
        .into_iter()
        .filter(|found| scene.play_events || !found.event.kind.is_of_play())
        .map(|NamedEvent { effect, event }| SymptomEvent {
            time_s: event.time_s,
            effect,
            word: event.kind,
            angle_rad: event.angle_rad,
            omega_rad_s: event.omega_rad_s,
            torque_before_nm: event.torque_before_nm,
            torque_after_nm: event.torque_after_nm,
        })
        .collect();
    if !held_back.is_empty() {
        events.append(&mut held_back);
        events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    }
    for event in &events {
        watch.symptom(event)?;
    }
    Ok(())
}

/// Keeps the tally of an event-driven run.
struct EventAccounting<'a> {
    tally: Tally,
    motion: &'a Motion,
    phi_start_rad: f64,
    /// The last point that is accounted: its time, angle and stick.
    accounted: (f64, f64, StickEnd),
    /// Time up to which the run has been looked at, s, and the time from there to the
    /// next look.
    looked_s: f64,
    look_s: f64,
}

impl<'a> EventAccounting<'a> {
    fn new(settings: Settings, motion: &'a Motion, first: &ShaftState, touches: bool) -> Self {
        let look_s = TAU / settings.parameters.natural_rad_s() / LOOKS_PER_SWING;
        let lead = Lead::new(&settings, look_s, false);
        Self {
            looked_s: 0.0,
            look_s,
            tally: Tally::new(settings, first.omega_rad_s, lead, touches),
            motion,
            phi_start_rad: first.phi_rad,
            accounted: (0.0, first.phi_rad, stick_end(0.0, first)),
        }
    }

    /// Goes on to `to_s`, with looks at slips on the way.
    fn follow(
        &mut self,
        to_s: f64,
        reference: &mut Reference<'_>,
        watch: &mut dyn Watch,
    ) -> Result<(), Ended> {
        let (from_s, span_s) = (self.looked_s, to_s - self.looked_s);
        let looks = (span_s / self.look_s).ceil().clamp(1.0, MOST_LOOKS);
        let mut look = 1.0;
        while look <= looks {
            let time_s = if look < looks {
                from_s + span_s * (look / looks)
            } else {
                to_s
            };
            let mut accounted = Accounted {
                accounting: self,
                watch,
            };
            if let ControlFlow::Break(stopped) = reference.follow(time_s, &mut accounted) {
                return Err(stopped.into());
            }
            if let Phase::Slip(_) = reference.phase() {
                self.tally.lead.look_for(
                    time_s - self.looked_s,
                    f64::from(reference.phase().sign()),
                    reference.shaft().omega_rad_s,
                    reference.theta_dot_rad_s(),
                );
            }
            self.looked_s = time_s;
            look += 1.0;
        }
        Ok(())
    }

    /// Accounts for an event, whose `fraction` is its time.
    fn book(&mut self, event: &Event<f64>) {
        let time_s = event.fraction;
        let shaft = self.motion.at(time_s);
        if event.from == Phase::Stick {
            self.book_stick(time_s, event.theta_rad, &shaft);
        }
        self.tally
            .event(time_s, shaft.phi_rad - self.phi_start_rad, event);
        self.accounted = (time_s, shaft.phi_rad, stick_end(event.theta_rad, &shaft));
    }

    /// Accounts for the time up to a row, or to the end.
    fn end_row(&mut self, time_s: f64, reference: &Reference<'_>) {
        self.tally.shown(reference.torque_nm());
        if reference.phase() == Phase::Stick {
            self.book_stick(time_s, reference.theta_rad(), &reference.shaft());
        }
    }

    /// Accounts for the stick from the last point accounted for to `time_s`.
    fn book_stick(&mut self, time_s: f64, theta: f64, shaft: &ShaftState) {
        let (from_s, from_rad, start) = self.accounted;
        let end = stick_end(theta, shaft);
        self.tally
            .stick(time_s - from_s, shaft.phi_rad - from_rad, start, end);
        self.accounted = (time_s, shaft.phi_rad, end);
    }
}

/// Records events and notifies the observer, which may end the run.
struct Accounted<'b, 'a> {
    accounting: &'b mut EventAccounting<'a>,
    watch: &'b mut dyn Watch,
}

impl Follow for Accounted<'_, '_> {
    type Stop = Stopped;

    fn event(&mut self, event: Event<f64>) -> ControlFlow<Stopped> {
        self.accounting.book(&event);
        flow(self.watch.event(&EventRecord::new(event.fraction, &event)))
    }

    fn poll(&mut self, time_s: f64) -> ControlFlow<Stopped> {
        flow(self.watch.progress(time_s))
    }
}

fn flow<E>(result: Result<(), E>) -> ControlFlow<E> {
    match result {
        Ok(()) => ControlFlow::Continue(()),
        Err(error) => ControlFlow::Break(error),
    }
}

fn stick_end(theta_rad: f64, shaft: &ShaftState) -> StickEnd {
    StickEnd {
        theta_rad,
        omega_rad_s: shaft.omega_rad_s,
        omega_dot: shaft.omega_dot,
    }
}
