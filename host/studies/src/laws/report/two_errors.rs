//! The two errors of each law against each other, over all numbers.

use super::share::Which;
use super::spots::{Spot, Spots};
use crate::laws::LawStudy;
use crate::laws::words::numbers::percent;
use crepitus_pages::plot::{Axis, Chart, CurveStyle, Figure, Key, Paper, Sign, extent};

/// Smaller errors are drawn here.
const FLOOR: f64 = 1e-5;

const NUMERICAL: &str = "Mean numerical error, at 20 kHz in f32, as a share of the scale";
const MODEL: &str = "Mean model error, converged, as a share of the scale";

/// The figure; none if no law was refined.
pub(super) fn figure(study: &LawStudy, paper: Paper) -> Option<Figure> {
    let spots = spots(study);
    if spots.is_empty() {
        return None;
    }
    let axis = |of: fn(&Spot) -> f64| {
        let (lowest, _) = extent(spots.iter().map(of));
        Axis::decades(0.8 * lowest, 1.3, 9)
    };
    let svg = Spots {
        signs: &spots,
        x: axis(|spot| spot.at.0),
        y: axis(|spot| spot.at.1),
        x_title: NUMERICAL,
        y_title: MODEL,
        label: "Model error against numerical error, one sign a law",
        has_diagonal: true,
    }
    .draw(paper);
    Some(Figure {
        name: "two-errors",
        title: "Model error against numerical error",
        legend: vec![
            Key::new(Sign::Filled(CurveStyle::NEUTRAL), "a law, mean over all numbers and joints"),
            Key::new(Sign::Mark("┄"), "both errors are equal"),
        ],
        charts: vec![Chart::full(svg)],
        caption: "Above the dashed line a law is limited by what it is: a finer step does not help. Below it is limited by \
             the tick: a better step of the same law would help. Errors beyond 1, and what a law cannot do, count as 1."
            .to_owned(),
    })
}

fn spots(study: &LawStudy) -> Vec<Spot> {
    let laws = study.laws.iter().enumerate();
    laws.filter_map(|(place, (name, _))| {
        let rows = || study.rows.iter().filter(|row| row.law == *name);
        let model = Which::Model.mean(rows())?.max(FLOOR);
        let numerical = Which::Numerical.mean(rows())?.max(FLOOR);
        Some(Spot {
            place,
            name,
            at: (numerical, model),
            wide: (numerical, numerical),
            high: (model, model),
            title: format!(
                "{name}: model error {} %, numerical error {} %",
                percent(model),
                percent(numerical)
            ),
        })
    })
    .collect()
}
