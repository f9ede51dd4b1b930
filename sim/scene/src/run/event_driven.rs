//! A run of the `reference` solver: from event to event, rows read off in
//! between.

use super::tally::{StickEnd, Tally};
use super::{Observer, RunError, Totals, steps};
use crate::reference::Reference;
use crate::scene::Scene;
use crate::trace::EventRecord;
use crate::walk::Clock;
use crepitus_model::{Event, Phase, Settings};
use crepitus_plant::{Motion, ShaftState};

/// How many rows go by between two reports of progress.
const PROGRESS_ROWS: u64 = 1 << 12;

pub(super) fn simulate<O: Observer>(
    scene: &Scene,
    observer: &mut O,
) -> Result<Totals, RunError<O::Error>> {
    let (rows, _) = steps(scene);
    let clock = Clock::new(scene.trace_step_s);
    let first = scene.motion.at(0.0);
    let mut fastest_rad_s = first.omega_rad_s.abs();
    let mut joint = scene.crepitus.map(|crepitus| {
        (
            Reference::new(&crepitus.settings, &scene.motion),
            Books::new(*crepitus.settings, &scene.motion, &first),
        )
    });
    let mut row = Vec::new();

    for n in 0..=rows {
        let time_s = clock.time_s(n);
        row.clear();
        if let Some((reference, books)) = &mut joint {
            let mut result = Ok(());
            reference.advance(time_s, |event| books.pass_on(event, observer, &mut result));
            result.map_err(RunError::Observer)?;
            books.end_row(time_s, reference);
            let shaft = reference.shaft();
            fastest_rad_s = fastest_rad_s.max(shaft.omega_rad_s.abs());
            if O::WANTS_ROWS {
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
            if O::WANTS_ROWS {
                row.extend([time_s, shaft.phi_rad, shaft.omega_rad_s]);
            }
        }
        if O::WANTS_ROWS {
            observer.row(&row).map_err(RunError::Observer)?;
        }
        if n.is_multiple_of(PROGRESS_ROWS) {
            observer.progress(time_s).map_err(RunError::Observer)?;
        }
    }
    // What is left after the last row has events, too.
    let end_s = scene.duration_s.max(clock.time_s(rows));
    if let Some((reference, books)) = &mut joint {
        let mut result = Ok(());
        reference.advance(end_s, |event| books.pass_on(event, observer, &mut result));
        result.map_err(RunError::Observer)?;
        books.end_row(end_s, reference);
    }
    let tally = joint.map(|(reference, mut books)| {
        let phi = reference.shaft().phi_rad - books.phi_start_rad;
        books.tally.finish(
            end_s,
            phi,
            reference.theta_rad(),
            reference.theta_dot_rad_s(),
        );
        books.tally
    });
    Ok(Totals {
        steps: rows,
        end_s,
        tally,
        fastest_rad_s,
        crowded_steps: 0,
        plant: None,
    })
}

/// Keeps the tally of an event-driven run.
struct Books<'a> {
    tally: Tally,
    motion: &'a Motion,
    phi_start_rad: f64,
    /// The last point that is booked: its time, angle and stick.
    booked: (f64, f64, StickEnd),
}

impl<'a> Books<'a> {
    fn new(settings: Settings, motion: &'a Motion, first: &ShaftState) -> Self {
        Self {
            tally: Tally::new(settings, first.omega_rad_s),
            motion,
            phi_start_rad: first.phi_rad,
            booked: (0.0, first.phi_rad, stick_end(0.0, first)),
        }
    }

    /// Books an event, whose `fraction` is its time, and tells the observer.
    fn pass_on<O: Observer>(
        &mut self,
        event: Event<f64>,
        observer: &mut O,
        result: &mut Result<(), O::Error>,
    ) {
        let time_s = event.fraction;
        let shaft = self.motion.at(time_s);
        if event.from == Phase::Stick {
            self.book_stick(time_s, event.theta_rad, &shaft);
        }
        self.tally
            .event(time_s, shaft.phi_rad - self.phi_start_rad, &event);
        self.booked = (time_s, shaft.phi_rad, stick_end(event.theta_rad, &shaft));
        if result.is_ok() {
            *result = observer.event(&EventRecord::new(time_s, &event));
        }
    }

    /// Books the time up to a row, or to the end.
    fn end_row(&mut self, time_s: f64, reference: &Reference<'_>) {
        self.tally.shown(reference.torque_nm());
        if reference.phase() == Phase::Stick {
            self.book_stick(time_s, reference.theta_rad(), &reference.shaft());
        }
    }

    /// Books the stick from the last booked point to `time_s`.
    fn book_stick(&mut self, time_s: f64, theta: f64, shaft: &ShaftState) {
        let (from_s, from_rad, start) = self.booked;
        let end = stick_end(theta, shaft);
        self.tally
            .stick(time_s - from_s, shaft.phi_rad - from_rad, start, end);
        self.booked = (time_s, shaft.phi_rad, end);
    }
}

fn stick_end(theta_rad: f64, shaft: &ShaftState) -> StickEnd {
    StickEnd {
        theta_rad,
        omega_rad_s: shaft.omega_rad_s,
        omega_dot: shaft.omega_dot,
    }
}
