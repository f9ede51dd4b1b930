//! The files of a study, and the text of its report.

use super::summary::Summary;
use super::{headline, words};
use crate::failure::Failure;
use crate::pictures::Pictures;
use crate::results::{Files, footer, report_files};
use crepitus_model::Convention;
use crepitus_pages::table::show::microseconds;
use crepitus_scene::cpu_time::CLOCK;
use crepitus_studies::accuracy::orders::{Order, Orders};
use crepitus_studies::accuracy::points_table::points_table;
use crepitus_studies::accuracy::report;
use crepitus_studies::accuracy::symptoms::table::symptoms_table;
use crepitus_studies::accuracy::target::table::target_table;
use crepitus_studies::accuracy::{Point, Study};
use crepitus_studies::{Section, StudyText};

/// The files of a study; each diagram as an SVG of its own if asked for.
pub(super) fn files(
    study: &Study,
    summary: &Summary<'_>,
    pictures: &Pictures,
) -> Result<Files, Failure> {
    let page = report::html(study, &text(study, summary));
    let pictures = pictures.files(|paper| report::pictures(&study.points, paper))?;
    let mut files = report_files(page, summary, pictures)?;
    files.push((
        "points.csv".to_owned(),
        points_table(&study.points).to_csv().into(),
    ));
    if !study.symptoms.is_empty() {
        let table = symptoms_table(&study.symptoms);
        files.push(("symptoms.csv".to_owned(), table.to_csv().into()));
    }
    if let Some(on) = &study.target {
        files.push((
            "cycles.csv".to_owned(),
            target_table(&on.rows).to_csv().into(),
        ));
    }
    Ok(files)
}

fn text(study: &Study, summary: &Summary<'_>) -> StudyText {
    let mut tables = vec![studied(study, summary)];
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
             prepared beforehand; the median of {} repeats in which all solvers take turns.",
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
                words::plain(s.reference_behind_s)
            )
        })
        .collect();
    let behind = |p: &&Point| p.convention != may_be_behind && p.behind_s > 0.0;
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
            words::plain(worst.behind_s),
            words::plain(worst.behind_j)
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

fn studied(study: &Study, summary: &Summary<'_>) -> Section {
    let mut rows: Vec<(String, String)> = study
        .scenes
        .iter()
        .map(|s| {
            (
                format!("{}, {}", s.name, s.convention),
                format!("{}; {} events", s.title, s.events_true),
            )
        })
        .collect();
    let steps: Vec<_> = study.steps_s.iter().map(|h| microseconds(*h)).collect();
    rows.push(("steps".to_owned(), steps.join(", ")));
    rows.push(("measured on".to_owned(), summary.measured_on()));
    rows.push((
        "the study took".to_owned(),
        format!("{} s", words::plain(study.wall_s)),
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
