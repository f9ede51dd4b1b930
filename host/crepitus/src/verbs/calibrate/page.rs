//! The calibration as one HTML page, complete in itself.

use super::change::Change;
use super::finding::{Finding, Verdict};
use crepitus_client::values::{full_name, show_value};
use crepitus_pages::plot::page::{
    Section, document, figure as drawn, footer, notes, tables, warnings,
};
use crepitus_pages::plot::palette::{OBJECT, SHAFT};
use crepitus_pages::plot::{Axis, Chart, Figure, Key, Panel, Point, Sign, stack};
use maud::html;

/// Size of the chart, CSS pixels.
const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 320.0;

/// The page.
pub(super) fn html(
    findings: &[Finding],
    changes: &[Change],
    figure: Option<&Figure>,
    last_line: &str,
) -> String {
    let bad: Vec<String> = findings
        .iter()
        .filter(|finding| matches!(finding.verdict, Verdict::Bad | Verdict::Unknown))
        .map(|finding| {
            let remedy = finding.remedy.as_deref().unwrap_or("see below");
            format!(
                "{}: {}: {}; to do: {remedy}",
                finding.name(),
                finding.verdict.name(),
                finding.remarks.join("; ")
            )
        })
        .collect();
    let mut sections: Vec<Section> = findings.iter().map(section).collect();
    if !changes.is_empty() {
        sections.push(Section {
            title: "Parameters".to_owned(),
            rows: changes
                .iter()
                .map(|c| (full_name(c.parameter), show_value(c.parameter, c.value)))
                .collect(),
        });
    }
    let remarks: Vec<String> = findings
        .iter()
        .flat_map(|finding| {
            finding
                .remarks
                .iter()
                .map(|remark| format!("{}: {remark}", finding.name()))
        })
        .collect();
    let body = html! {
        header {
            p.kicker { "Crepitus · calibration" }
            h1 { "Calibration of a brace" }
            p.description { "Values with their 95 % intervals, where they have one." }
        }
        main {
            (warnings("Steps that are not good", &bad))
            (tables(&sections))
            @if let Some(figure) = figure { (drawn(figure)) }
            (notes(&remarks))
        }
        (footer(last_line))
    };
    document("Calibration of a brace", "", &[], &body)
}

fn section(finding: &Finding) -> Section {
    let mut rows = vec![("result".to_owned(), finding.verdict.name().to_owned())];
    rows.extend(
        finding
            .values
            .iter()
            .map(|value| (value.name.to_owned(), value.text())),
    );
    Section {
        title: finding.name().to_owned(),
        rows,
    }
}

/// Current against angle of the hanging weight, if there was one.
pub(super) fn figure(findings: &[Finding]) -> Option<Figure> {
    let curve = findings
        .iter()
        .map(|finding| &finding.curve)
        .find(|curve| !curve.is_empty())?;
    let points = |of: fn(&[f64; 3]) -> f64| -> Vec<Point> {
        curve
            .iter()
            .map(|row| Point::new(row[0].to_degrees(), of(row)))
            .collect()
    };
    let (measured, fitted) = (points(|row| row[1]), points(|row| row[2]));
    let x = Axis::covering(measured.iter().map(|point| point.x), 8);
    let y = Axis::covering(measured.iter().chain(&fitted).map(|point| point.y), 5);
    let panel = Panel::new(HEIGHT, x, ("Current (A)", y), move |plot| {
        plot.grid();
        plot.line(&measured, OBJECT, 2.5);
        plot.line(&fitted, SHAFT, 1.25);
    })
    .x_title(Some("Angle of the joint (°)"));
    Some(Figure {
        name: "currents",
        title: "The current that lifts the weight, and lets it down",
        legend: vec![
            Key::new(Sign::Line(OBJECT), "measured, mean over a degree"),
            Key::new(Sign::Line(SHAFT), "computed with what was found"),
        ],
        charts: vec![Chart::full(stack(WIDTH, "Current against angle, there and back", vec![panel]))],
        caption: "Half of what is between both ways is friction; what their middle grows by with the weight's torque is the torque constant. \
                  Waves of the measured curve are a weight that swings or sticks, a bump is something that touches it."
            .to_owned(),
    })
}
