//! The report of what the hand gets.

use crate::story::{PanelData, Scale, Series, Story, figure};
use crate::vibration::{AtSpeed, VibrationStudy, tables};
use crate::{Picture, StudyText};
use crepitus_pages::plot::page::{self, scrolling};
use crepitus_pages::plot::{Figure, Mark, Paper, pictures as of_figures};
use maud::html;

const LAYOUT: &str = concat!(
    include_str!("../accuracy/report/page.css"),
    include_str!("../effects/report/page.css")
);

/// The report as one HTML page, complete in itself.
pub fn html(study: &VibrationStudy, text: &StudyText) -> String {
    let body = html! {
        header {
            p.kicker { "Crepitus · what the hand gets" }
            h1 { (text.title) }
            p.description { (text.intro) }
        }
        main {
            (page::figures(|paper| figures(study, paper)))
            @for speed in &study.speeds {
                section.table {
                    h2 { (speed.speed_rad_s) " rad/s, 15 to 500 Hz" }
                    (scrolling("Table", &tables::steps(&speed.rows).to_html()))
                    @if let Some(draws) = &speed.draws { p { (draws) "." } }
                }
            }
            section.table {
                h2 { "The loop from the actuator to the encoder and back" }
                p { "Linear, with the joint always in a stick and a gear without friction." }
                (scrolling("Table", &tables::margins(&study.margins).to_html()))
            }
            (page::tables(&text.tables))
            (page::notes(&text.notes))
        }
        (page::footer(&text.footer))
    };
    page::document(&text.title, LAYOUT, &[], &body)
}

/// Every figure as a file of its own.
pub fn pictures(study: &VibrationStudy, paper: Paper) -> Vec<Picture> {
    of_figures(&figures(study, paper))
}

/// The least that is drawn, m/s² rms a bin.
const LEAST_M_S2: f64 = 1e-6;

fn figures(study: &VibrationStudy, paper: Paper) -> Vec<Figure> {
    let panels: Vec<PanelData> = study
        .speeds
        .iter()
        .filter(|speed| !speed.spectrum.is_empty())
        .map(panel)
        .collect();
    if panels.is_empty() {
        return Vec::new();
    }
    vec![figure(&Story {
        name: "hand-spectrum",
        title: "What the palm feels, by frequency",
        caption: "Acceleration of the palm, rms in each bin of the spectrum: of a bare knee with the same joint, of the \
                  device without its actuator, and with it at its gain."
            .to_owned(),
        panels,
    }, paper)]
}

fn panel(speed: &AtSpeed) -> PanelData {
    let line = |of: fn(&[f64; 3]) -> f64| {
        let lines = speed.spectrum.iter().filter(|(hz, _)| *hz >= 10.0);
        lines
            .map(|(hz, all)| (*hz, of(all).max(LEAST_M_S2)))
            .collect()
    };
    PanelData {
        heading: format!("at {} rad/s", speed.speed_rad_s),
        x: Scale::logarithmic("Frequency (Hz)").within(10.0, 500.0),
        y: Scale::logarithmic("Acceleration (m/s²)").within(LEAST_M_S2, 1.0),
        series: vec![
            Series::line("with the actuator", line(|all| all[2])),
            Series::line("a bare knee", line(|all| all[0])),
            Series::line("the motor alone", line(|all| all[1])),
        ],
        bounds: vec![Mark {
            at: 15.0,
            name: String::new(),
        }],
        ..PanelData::default()
    }
}
