//! The torque at the hand in bands of frequency: a row a variant, a column a
//! band, on one logarithmic axis.

use crepitus_study::effects::influence::BANDS_HZ;
use crepitus_study::effects::variant::Change;
use crepitus_study::effects::{EffectsStudy, Row};

use super::hand;
use crate::ReportError;
use crate::accuracy::hand::Hand;
use crate::accuracy::overlay::{Anchor, Overlay};
use crate::axis::{Axis, extent};
use crate::canvas::svg_with;
use crate::figure::{Chart, Figure};
use crate::number::rounded;
use crate::palette::{AXIS, LEVEL, TEXT};

/// CSS pixels.
const WIDTH: u32 = 960;
/// Grid lines.
const NAMES: i32 = 880;
const COLUMN: i32 = 960;
const GAP: i32 = 28;
const HEAD: i32 = 130;
const LINE: i32 = 104;
const FOOT: u32 = 48;

/// Less than this is nothing, mN·m.
const LEAST_MNM: f64 = 1e-2;

/// The figure; nothing where the run is too short for a spectrum.
pub(super) fn figure(study: &EffectsStudy) -> Result<Option<Figure>, ReportError> {
    let rows: Vec<(&Row, [f64; 3])> = study
        .rows
        .iter()
        .filter_map(|row| Some((row, row.ran()?.torque.bands_nm.map(|nm| 1e3 * nm))))
        .collect();
    let values = || rows.iter().flat_map(|(_, bands)| *bands);
    if rows.len() < 2 || !values().any(|mnm| mnm > LEAST_MNM) {
        return Ok(None);
    }
    let (low, high) = extent(values().filter(|mnm| *mnm > LEAST_MNM));
    let axis = axis(low, high);
    let height = rows.iter().fold(HEAD, |sum, _| sum + LINE);
    let height = u32::try_from(height).unwrap_or(0) / 4 + FOOT;
    let svg = svg_with(
        (WIDTH, height),
        "RMS torque at the hand in three bands of frequency, a row a variant",
        |_| Ok(draw(&rows, &axis)),
    )?;
    Ok(Some(Figure {
        name: "bands",
        title: "What vibrates, by band",
        legend: hand::legend(rows.iter().map(|(row, _)| *row)),
        charts: vec![Chart {
            heading: None,
            svg,
            half: false,
        }],
        caption: "The torque at the hand within each band of frequency, as RMS by Welch's method. The dashed line is \
                  the scene; a stroke leads from it to the variant: to the left if it vibrates less there, to the \
                  right if more. An arrow to the left: next to nothing is left."
            .to_owned(),
    }))
}

fn axis(low: f64, high: f64) -> Axis {
    let (low, high) = (low / 1.6, high * 1.6);
    if high / low > 100.0 {
        return Axis::decades(low, high, 4);
    }
    let marks: Vec<f64> = (-3..6)
        .flat_map(|exponent| [1.0, 2.0, 5.0].map(|m| m * 10_f64.powi(exponent)))
        .collect();
    Axis::logarithmic(low, high, &marks)
}

fn draw(rows: &[(&Row, [f64; 3])], axis: &Axis) -> String {
    let mut over = Overlay::default();
    let bottom = rows.iter().fold(HEAD, |sum, _| sum + LINE);
    for (band, (low, high)) in BANDS_HZ.into_iter().enumerate() {
        let left = NAMES + (0..band).fold(0, |sum, _| sum + COLUMN + GAP);
        let heading = format!("{}–{} Hz", rounded(low), rounded(high));
        over.text(
            (left + COLUMN / 2, HEAD - 76),
            Anchor::Middle,
            TEXT,
            &heading,
        );
        scale(&mut over, axis, left, bottom);
        let x = |mnm: f64| left + offset(axis.place(mnm));
        let scene = rows.first().map_or(f64::NAN, |(_, bands)| bands[band]);
        if scene > LEAST_MNM {
            let level = Hand {
                ink: LEVEL,
                ..hand::of(Change::Scene)
            };
            over.line(&[(x(scene), HEAD - 24), (x(scene), bottom)], level);
        }
        let mut y = HEAD + LINE / 2;
        for (row, bands) in rows {
            let hand = hand::of(row.change);
            let mnm = bands[band];
            let title = format!("{}: {} mN·m", row.name(), rounded(mnm));
            if mnm.is_finite() {
                let at = (x(mnm.max(LEAST_MNM)), y);
                if scene > LEAST_MNM {
                    over.line(&[(x(scene), y), at], hand);
                }
                if mnm <= axis.low() {
                    over.arrow_left(at, hand.ink);
                }
                over.marker(at, hand, true, &title);
            } else {
                over.text((left + COLUMN / 2, y), Anchor::Middle, TEXT, "not known");
            }
            y += LINE;
        }
        let middle = left + COLUMN / 2;
        over.text((middle, bottom + 140), Anchor::Middle, TEXT, "mN·m RMS");
    }
    let mut y = HEAD + LINE / 2;
    for (row, _) in rows {
        let name = match row.change {
            Change::Scene => row.name(),
            change => format!("{} {}", change.name(), hand::short(row)),
        };
        over.text((16, y), Anchor::Start, TEXT, &name);
        y += LINE;
    }
    over.finish()
}

/// Frame and ticks of a column.
fn scale(over: &mut Overlay, axis: &Axis, left: i32, bottom: i32) {
    for mark in axis.marks() {
        let x = left + offset(axis.place(*mark));
        over.leader((x, HEAD - 24), (x, bottom + 16), AXIS);
        over.text((x, bottom + 64), Anchor::Middle, TEXT, &rounded(*mark));
    }
    over.leader((left, bottom), (left + COLUMN, bottom), AXIS);
}

/// A share of a column's width.
fn offset(share: f64) -> i32 {
    // Between 0 and the width.
    #[allow(clippy::cast_possible_truncation)]
    let offset = (share * f64::from(COLUMN)).round() as i32;
    offset
}
