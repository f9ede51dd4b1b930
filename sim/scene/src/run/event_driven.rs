//! A run of the `reference` solver: from event to event, rows read off in
//! between.

use super::tally::{StickEnd, Tally};
use super::{Clock, Observer, RunError, Totals, steps};
use crate::reference::Reference;
use crate::scene::Scene;
use crate::trace::EventRecord;
use crepitus_model::{Phase, Settings};
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
    let mut end_s = 0.0;
    for n in 0..=rows {
        let time_s = clock.time_s(n);
        row.clear();
        if let Some((reference, books)) = &mut joint {
            let mut result = Ok(());
            reference.advance(time_s, |event| {
                let mut event = event;
                let at_s = std::mem::take(&mut event.fraction);
                books.event(at_s, &event);
                if result.is_ok() {
                    result = observer.event(&EventRecord::new(at_s, &event));
                }
            });
            result.map_err(RunError::Observer)?;
            let (phase, theta) = (reference.phase(), reference.theta_rad());
            let (shaft, torque) = (reference.shaft(), reference.torque_nm());
            books.end_row(time_s, phase, theta, &shaft, torque);
            fastest_rad_s = fastest_rad_s.max(shaft.omega_rad_s.abs());
            if O::WANTS_ROWS {
                row.extend([
                    time_s,
                    shaft.phi_rad,
                    shaft.omega_rad_s,
                    f64::from(phase.sign()),
                    theta,
                    reference.theta_dot_rad_s(),
                    torque,
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
        end_s = time_s;
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

    fn event(&mut self, time_s: f64, event: &crepitus_model::Event<f64>) {
        let shaft = self.motion.at(time_s);
        if event.from == Phase::Stick {
            self.book_stick(time_s, event.theta_rad, &shaft);
        }
        self.tally
            .event(time_s, shaft.phi_rad - self.phi_start_rad, event);
        self.booked = (time_s, shaft.phi_rad, stick_end(event.theta_rad, &shaft));
    }

    fn end_row(&mut self, time_s: f64, phase: Phase, theta: f64, shaft: &ShaftState, torque: f64) {
        self.tally.shown(torque);
        if phase == Phase::Stick {
            self.book_stick(time_s, theta, shaft);
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
