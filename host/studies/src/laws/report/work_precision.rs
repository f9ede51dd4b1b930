//! Work and precision: the error for grating against what a step costs, on the host and on the
//! controller.

use super::spots::{Spot, Spots};
use crate::accuracy::target::LABEL;
use crate::laws::costs::Costs;
use crate::laws::ranking::Answer;
use crate::laws::words::numbers::{costs_of, percent};
use crate::laws::words::scores_table::score;
use crate::laws::{LawStudy, Use};
use crepitus_pages::plot::{Axis, Chart, CurveStyle, Figure, Key, Paper, Sign, extent};

/// Smaller errors are drawn here.
const FLOOR: f64 = 1e-4;

const ERROR: &str = "Mean relative error for grating, at 20 kHz in f32";

/// One figure for the host, one for the controller; none without rows of grating, or without costs.
pub(super) fn figures(study: &LawStudy, answers: &[Answer], paper: Paper) -> Vec<Figure> {
    let Some(answer) = answers.iter().find(|answer| answer.of == Use::Grating) else {
        return Vec::new();
    };
    let host = figure(study, answer, paper, &Host);
    let controller = figure(study, answer, paper, &Controller);
    host.into_iter().chain(controller).collect()
}

/// A cost that can be drawn.
trait Drawn {
    const NAME: &'static str;
    const TITLE: &'static str;
    const AXIS: &'static str;
    const BAR: &'static str;

    /// The cost of a step, and the ends of its bar.
    fn of(&self, costs: &Costs) -> Option<(f64, (f64, f64))>;
}

struct Host;

impl Drawn for Host {
    const NAME: &'static str = "grating-cost";
    const TITLE: &'static str = "What accuracy costs: grating, on this computer";
    const AXIS: &'static str = "CPU time of a step (ns), steady grating";
    const BAR: &'static str =
        "The sign is at the median of the repeats, its bar between their quartiles.";

    fn of(&self, costs: &Costs) -> Option<(f64, (f64, f64))> {
        let time = costs.grating?;
        let [first, third] = time.quartiles_ns;
        Some((time.ns, (first, third)))
    }
}

struct Controller;

impl Drawn for Controller {
    const NAME: &'static str = "grating-cycles";
    const TITLE: &'static str = "What accuracy costs: grating, on the controller";
    const AXIS: &'static str = "Cycles of a step, modelled, 0 wait states; a tick has 8,400";
    const BAR: &'static str =
        "The sign is at the mean, its bar to the right ends at the worst step.";

    fn of(&self, costs: &Costs) -> Option<(f64, (f64, f64))> {
        let cost = costs.controller?;
        let mean = cost.mean_cycles;
        Some((mean, (mean, f64::from(cost.worst_cycles))))
    }
}

fn figure<D: Drawn>(study: &LawStudy, answer: &Answer, paper: Paper, drawn: &D) -> Option<Figure> {
    let spots = spots(study, answer, drawn);
    if spots.is_empty() {
        return None;
    }
    let (cheapest, dearest) = extent(spots.iter().flat_map(|spot| [spot.wide.0, spot.wide.1]));
    let (lowest, _) = extent(spots.iter().flat_map(|spot| [spot.at.1, spot.high.0]));
    let label = format!("{ERROR} against {}, one sign a law", D::AXIS);
    let svg = Spots {
        signs: &spots,
        x: Axis::one_two_five(0.8 * cheapest, 1.25 * dearest),
        y: Axis::decades(0.8 * lowest, 1.3, 9),
        x_title: D::AXIS,
        y_title: ERROR,
        label: &label,
        has_diagonal: false,
    }
    .draw(paper);
    let controller = if D::NAME == Controller::NAME {
        format!(" {LABEL}.")
    } else {
        String::new()
    };
    Some(Figure {
        name: D::NAME,
        title: D::TITLE,
        legend: vec![Key::new(
            Sign::Filled(CurveStyle::NEUTRAL),
            "a law; its bar upwards: quartiles over numbers and joints",
        )],
        charts: vec![Chart::full(svg)],
        caption: format!(
            "Down is more accurate, left is cheaper. An error of 1 is as large as the effect: the law does not grate. \
             {}{controller}",
            D::BAR
        ),
    })
}

fn spots<D: Drawn>(study: &LawStudy, answer: &Answer, drawn: &D) -> Vec<Spot> {
    let laws = study.laws.iter().enumerate();
    laws.filter_map(|(place, (name, _))| {
        let (cost, wide) = costs_of(study, name).and_then(|costs| drawn.of(costs))?;
        let error = score(answer, name)?;
        let (first, third) = quartiles(study, name);
        Some(Spot {
            place,
            name,
            at: (cost, error.max(FLOOR)),
            wide,
            high: (first.max(FLOOR), third.max(FLOOR)),
            title: format!(
                "{name}: mean error {} %, quartiles {} % and {} %, {cost:.1} {}",
                percent(error),
                percent(first),
                percent(third),
                if D::NAME == Host::NAME {
                    "ns"
                } else {
                    "cycles"
                }
            ),
        })
    })
    .filter(|spot| spot.at.0 > 0.0)
    .collect()
}

/// Quartiles of the errors for grating, those beyond 1 as 1.
fn quartiles(study: &LawStudy, law: &str) -> (f64, f64) {
    let rows = study.rows.iter();
    let own = rows.filter(|row| row.law == law && row.of == Use::Grating);
    let mut errors: Vec<f64> = own.map(|row| row.error_or_failed().min(1.0)).collect();
    errors.sort_by(f64::total_cmp);
    let at = |share: usize| {
        let place = (errors.len().saturating_sub(1) * share + 2) / 4;
        errors.get(place).copied().unwrap_or(f64::NAN)
    };
    (at(1), at(3))
}
