//! The torque at the hand in bands of frequency: a row a variant, a column a
//! band, on one logarithmic axis.

use crate::effects::influence::BANDS_HZ;
use crate::effects::variant::Change;
use crate::effects::{EffectsStudy, Row};

use super::look;
use crepitus_pages::plot::number::rounded;
use crepitus_pages::plot::palette::{AXIS, LEVEL, TEXT};
use crepitus_pages::plot::{Anchor, Axis, Chart, Drawing, Figure, Stroke, extent};

/// CSS pixels.
const WIDTH: f64 = 950.0;
const NAMES: f64 = 220.0;
const COLUMN: f64 = 236.0;
const GAP: f64 = 7.0;
const HEAD: f64 = 32.0;
const LINE: f64 = 26.0;
const FOOT: f64 = 48.0;

/// Less than this is nothing, mN·m.
const LEAST_MNM: f64 = 1e-2;

/// The figure; nothing where the run is too short for a spectrum.
pub(super) fn figure(study: &EffectsStudy) -> Option<Figure> {
    let rows: Vec<(&Row, [f64; 3])> = study
        .rows
        .iter()
        .filter_map(|row| Some((row, row.ran()?.torque.bands_nm.map(|nm| 1e3 * nm))))
        .collect();
    let values = || rows.iter().flat_map(|(_, bands)| *bands);
    if rows.len() < 2 || !values().any(|mnm| mnm > LEAST_MNM) {
        return None;
    }
    let (low, high) = extent(values().filter(|mnm| *mnm > LEAST_MNM));
    let axis = axis(low, high);
    let height = HEAD + LINE * rows.len() as f64 + FOOT;
    let label = "RMS torque at the hand in three bands of frequency, a row a variant";
    Some(Figure {
        name: "bands",
        title: "What vibrates, by band",
        legend: look::legend(rows.iter().map(|(row, _)| *row)),
        charts: vec![Chart::full(draw(&rows, &axis).svg((WIDTH, height), label))],
        caption: "The torque at the hand within each band of frequency, as RMS by Welch's method. The dashed line is \
                  the scene; a stroke leads from it to the variant: to the left if it vibrates less there, to the \
                  right if more. An arrow to the left: next to nothing is left."
            .to_owned(),
    })
}

fn axis(low: f64, high: f64) -> Axis {
    let (low, high) = (low / 1.6, high * 1.6);
    if high / low > 100.0 {
        return Axis::decades(low, high, 4);
    }
    Axis::one_two_five(low, high)
}

fn draw(rows: &[(&Row, [f64; 3])], axis: &Axis) -> Drawing {
    let mut over = Drawing::default();
    let bottom = HEAD + LINE * rows.len() as f64;
    let heights = || (0..).map(|row| HEAD + LINE * (f64::from(row) + 0.5));
    for (band, (low, high)) in BANDS_HZ.into_iter().enumerate() {
        let left = NAMES + band as f64 * (COLUMN + GAP);
        let middle = left + 0.5 * COLUMN;
        let heading = format!("{}–{} Hz", rounded(low), rounded(high));
        over.label((middle, HEAD - 19.0), Anchor::Middle, TEXT, &heading);
        scale(&mut over, axis, left, bottom);
        let x = |mnm: f64| left + COLUMN * axis.place(mnm);
        let scene = rows.first().map_or(f64::NAN, |(_, bands)| bands[band]);
        if scene > LEAST_MNM {
            over.line(
                &[(x(scene), HEAD - 6.0), (x(scene), bottom)],
                Stroke::dashed(LEVEL, 1.75),
            );
        }
        for ((row, bands), y) in rows.iter().zip(heights()) {
            let style = look::of(row.change);
            let mnm = bands[band];
            let title = format!("{}: {} mN·m", row.name(), rounded(mnm));
            if mnm.is_finite() {
                let at = (x(mnm.max(LEAST_MNM)), y);
                if scene > LEAST_MNM {
                    over.line(&[(x(scene), y), at], style.stroke());
                }
                if mnm <= axis.low() {
                    over.arrow_left(at, style.ink);
                }
                over.marker(at, style, true, &title);
            } else {
                over.label((middle, y), Anchor::Middle, TEXT, "not known");
            }
        }
        over.label((middle, bottom + 35.0), Anchor::Middle, TEXT, "mN·m RMS");
    }
    for ((row, _), y) in rows.iter().zip(heights()) {
        let name = match row.change {
            Change::Scene => row.name(),
            change => format!("{} {}", change.name(), look::short(row)),
        };
        over.label((4.0, y), Anchor::Start, TEXT, &name);
    }
    over
}

/// Frame and ticks of a column.
fn scale(over: &mut Drawing, axis: &Axis, left: f64, bottom: f64) {
    for (mark, label) in axis.labels() {
        let x = left + COLUMN * axis.place(mark);
        over.leader((x, HEAD - 6.0), (x, bottom + 4.0), AXIS);
        over.label((x, bottom + 16.0), Anchor::Middle, TEXT, &label);
    }
    over.leader((left, bottom), (left + COLUMN, bottom), AXIS);
}
