//! Words of the study: what its verb prints, and the text of its page.

mod headline;
pub mod need;
mod numbers;
mod orders_table;
mod summary;
mod symptoms;
mod table;
mod target;

#[cfg(test)]
pub(crate) use table::instructions_at_the_tick;
pub(crate) use table::nearest_to_the_tick;

use crate::accuracy::actuator::actuator_table;
use crate::accuracy::orders::{Order, Orders};
use crate::accuracy::points_table::points_table;
use crate::accuracy::symptoms::table::symptoms_table;
use crate::accuracy::target::table::target_table;
use crate::accuracy::{Point, Study, report};
use crate::{Outcome, Picture, Section, StudyText, machine};
use crepitus_model::Convention;
use crepitus_pages::plot::Paper;
use crepitus_pages::table::show::microseconds;
use crepitus_pages::words::footer;
use crepitus_scene::cpu_time::CLOCK;
use crepitus_scene::scene::Precision;
use numbers::plain;
use serde::Serialize;
use summary::Summary;

/// A study, and what was asked for.
#[derive(Clone, Copy, Debug)]
pub struct AccuracyOutcome<'a> {
    /// The study.
    pub study: &'a Study,
    /// Orders of convergence on motions of other kinds, which are part of the study.
    pub by_motion: &'a [Orders],
    /// The studied precisions.
    pub precisions: &'a [Precision],
    /// True if few steps and repeats were asked for.
    pub is_quick: bool,
}

impl Outcome for AccuracyOutcome<'_> {
    const REST: &'static str = "every table";

    fn summary(&self) -> impl Serialize {
        Summary::new(self)
    }

    fn page(&self) -> String {
        report::html(self.study, &text(self.study))
    }

    fn pictures(&self, paper: Paper) -> Vec<Picture> {
        report::pictures(&self.study.points, paper)
    }

    fn tables(&self) -> Vec<(&'static str, String)> {
        let study = self.study;
        let symptoms = (!study.symptoms.is_empty())
            .then(|| ("symptoms.csv", symptoms_table(&study.symptoms).to_csv()));
        let cycles = study.target.as_ref();
        let cycles = cycles.map(|on| ("cycles.csv", target_table(&on.rows).to_csv()));
        let points = ("points.csv", points_table(&study.points).to_csv());
        [points].into_iter().chain(symptoms).chain(cycles).collect()
    }

    fn answer(&self) -> String {
        headline::answer(self.study)
    }

    fn in_short(&self) -> String {
        headline::table(self.study)
    }

    fn in_full(&self) -> String {
        let study = self.study;
        let target = study.target.as_ref().map(target::table);
        [
            table::at_the_tick(study) + "\n" + &orders_table::by_motion(self.by_motion),
            paragraph(&symptoms::table(&study.symptoms)),
            paragraph(&actuator(study)),
            paragraph(&target.unwrap_or_default()),
        ]
        .concat()
    }
}

/// The stage of the vibration actuator; nothing if it was not studied.
fn actuator(study: &Study) -> String {
    if study.actuator.is_empty() {
        return String::new();
    }
    format!(
        "The command of the vibration actuator, 15 to 500 Hz, coarse at 1 rad/s:\n\n{}",
        actuator_table(&study.actuator).to_markdown()
    )
}

/// A paragraph of its own, if there is one.
fn paragraph(text: &str) -> String {
    if text.is_empty() {
        String::new()
    } else {
        format!("\n{text}")
    }
}

fn text(study: &Study) -> StudyText {
    let mut tables = vec![studied(study)];
    tables.extend(convergence(study));
    tables.extend(refused(study));
    StudyText {
        title: "What accuracy costs in time".to_owned(),
        intro: headline::answer(study),
        notes: notes(study),
        tables,
        footer: footer(),
    }
}

fn notes(study: &Study) -> Vec<String> {
    let mut notes = vec![
        "Every solver, in single and double precision and at a range of steps, against the event-driven reference. A \
         solver down and to the left of another is both better and cheaper."
            .to_owned(),
        "Events are matched one to one in the order of time, by kind and sense. Where interior events have no \
         partner a solver has not simulated the same thing: such points are in no curve and are listed beside it."
            .to_owned(),
        "Held torque is what a device shows, from the end of one step to the end of the next, against the true torque \
         over continuous time. Torque at the tick is compared at the ends of steps alone: it jumps at an event, so a \
         step's end that falls between the true event and the found one counts with the whole jump."
            .to_owned(),
        format!(
            "Time is {CLOCK}, of the stepping alone: the step, its events and the torque it leaves, with the motion \
             prepared beforehand; the median of {} repeats in which all solvers take turns, and their quartiles.",
            study.timing_repeats
        ),
    ];
    notes.extend(unsteady(&study.points));
    notes.extend(missed_ends(study));
    notes
}

/// Slips that went on after their end: what no energy balance sees.
fn missed_ends(study: &Study) -> Vec<String> {
    let may_be_behind = Convention::Frozen.name();
    let mut notes: Vec<String> = study
        .scenes
        .iter()
        .filter(|s| s.convention != may_be_behind && s.reference_behind_s > 0.0)
        .map(|s| {
            format!(
                "Do not trust {}, {}: in slips of the reference itself the shaft is slower than the object for {} s, \
                 so it missed the end of a slip.",
                s.name,
                s.convention,
                plain(s.reference_behind_s)
            )
        })
        .collect();
    let behind = |p: &&Point| p.is_exact() && p.convention != may_be_behind && p.behind_s > 0.0;
    if let Some(worst) = study
        .points
        .iter()
        .filter(behind)
        .max_by(|a, b| a.behind_s.total_cmp(&b.behind_s))
    {
        notes.push(format!(
            "At {} of {} points a slip went on after its end, with the shaft slower than the object; for longest with \
             {} at a step of {} on {}, {}: {} s, in which friction gave {} J.",
            study.points.iter().filter(behind).count(),
            study.points.len(),
            worst.solver,
            microseconds(worst.step_s),
            worst.scene,
            worst.convention,
            plain(worst.behind_s),
            plain(worst.behind_j)
        ));
    }
    notes
}

/// Warning if the timings spread: the machine was busy.
fn unsteady(points: &[Point]) -> Option<String> {
    /// Spread from which on two costs that differ by a fifth may be the same.
    const UNSTEADY: f64 = 0.2;
    let count = points.iter().filter(|p| p.time_spread > UNSTEADY).count();
    (count > 0).then(|| {
        format!(
            "The timings of {count} of {} points spread by more than 20 % between their quartiles: the machine was \
             busy.",
            points.len()
        )
    })
}

fn studied(study: &Study) -> Section {
    let mut rows: Vec<(String, String)> = study
        .scenes
        .iter()
        .map(|s| {
            (
                format!("{}, {}{}", s.name, s.convention, table::behind(s.input)),
                format!("{}; {} events", s.title, s.events_true),
            )
        })
        .collect();
    let steps: Vec<_> = study.steps_s.iter().map(|h| microseconds(*h)).collect();
    rows.push(("steps".to_owned(), steps.join(", ")));
    rows.push(("measured on".to_owned(), machine::measured_on()));
    rows.push((
        "the study took".to_owned(),
        format!("{} s", plain(study.wall_s)),
    ));
    Section {
        title: "What was studied".to_owned(),
        rows,
    }
}

/// A table of orders a scene and convention.
fn convergence(study: &Study) -> Vec<Section> {
    let mut sections: Vec<Section> = Vec::new();
    for orders in &study.orders {
        let Orders {
            scene,
            convention,
            solver,
            frequency,
            event_time,
            event_time_rms,
        } = orders;
        let title = format!("Measured orders in f64: {scene}, {convention}");
        let row = (
            (*solver).to_owned(),
            format!(
                "frequency {}, event time {} (root mean square {})",
                order(*frequency),
                order(*event_time),
                order(*event_time_rms)
            ),
        );
        match sections.last_mut().filter(|s| s.title == title) {
            Some(section) => section.rows.push(row),
            None => sections.push(Section {
                title,
                rows: vec![row],
            }),
        }
    }
    sections
}

fn order(order: Order) -> String {
    match order {
        Order::Slope { order, .. } => format!("{order:.1}"),
        Order::RoundOff { .. } => "round-off".to_owned(),
        Order::TooFewPoints { .. } => "–".to_owned(),
    }
}

fn refused(study: &Study) -> Option<Section> {
    (!study.refused.is_empty()).then(|| Section {
        title: "Left out, because it has no meaning".to_owned(),
        rows: study
            .refused
            .iter()
            .map(|r| {
                (
                    format!("{} under {}", r.solver, r.convention),
                    r.reason.to_owned(),
                )
            })
            .collect(),
    })
}
