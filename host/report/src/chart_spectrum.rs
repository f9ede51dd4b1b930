//! The amplitude spectrum of the torque.

use plotters::style::text_anchor::{HPos, VPos};

use crate::ReportError;
use crate::axis::{Axis, extent};
use crate::canvas::{Area, Drawn, Panel, svg, text_style};
use crate::collector::Figures;
use crate::figure::{Chart, Figure};
use crate::number::{count, rounded};
use crate::palette::{BAND, TEXT, TORQUE};
use crate::spectrum::{Spectrum, Welch};
use crate::thinned::Point;

const LOWEST_HZ: f64 = 0.5;
const HIGHEST_HZ: f64 = 500.0;
/// Below this, lines belong to the motion rather than to the joint.
const MOTION_HZ: f64 = 10.0;
/// Bands in use for the vibration of joints; every second one is shaded.
const BANDS: [(f64, f64, &str, bool); 3] = [
    (10.0, 50.0, "10–50 Hz", true),
    (50.0, 250.0, "50–250 Hz", false),
    (250.0, 450.0, "250–450 Hz", true),
];
const FREQUENCIES: [f64; 10] = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0];

pub(crate) fn figure(figures: &Figures) -> Result<Option<Figure>, ReportError> {
    if !figures.has_torque || figures.rows == 0 {
        return Ok(None);
    }
    let title = "Spectrum of the torque";
    let nothing = |caption: String| {
        Ok(Some(Figure {
            name: "spectrum",
            title,
            legend: Vec::new(),
            charts: Vec::new(),
            caption,
        }))
    };
    let Some(spectrum) = &figures.spectrum else {
        return nothing(format!(
            "Not drawn: {} evenly spaced rows are too few for a spectrum; it takes at least {}.",
            count(figures.rows),
            Welch::SHORTEST
        ));
    };
    // In mN·m.
    let points: Vec<Point> = spectrum
        .points
        .iter()
        .filter(|p| (LOWEST_HZ..=HIGHEST_HZ).contains(&p.x))
        .map(|p| Point::new(p.x, 1e3 * p.y))
        .collect();
    if !points.iter().any(|p| p.y > 1e-9) {
        return nothing("Not drawn: the torque does not vibrate.".to_owned());
    }
    let svg = svg(
        (960, 340),
        "Amplitude of the torque against frequency",
        |area| draw(area, &points),
    )?;
    Ok(Some(Figure {
        name: "spectrum",
        title,
        legend: Vec::new(),
        charts: vec![Chart {
            heading: None,
            svg,
            half: false,
        }],
        caption: caption(spectrum, strongest_line(&points)),
    }))
}

/// The highest peak above the frequencies of the motion. A slope is not a
/// line: both neighbours are lower.
fn strongest_line(points: &[Point]) -> Option<Point> {
    points
        .windows(3)
        .filter(|w| w[1].x >= MOTION_HZ && w[1].y > w[0].y && w[1].y > w[2].y)
        .map(|w| w[1])
        .reduce(|best, p| if p.y > best.y { p } else { best })
}

fn caption(spectrum: &Spectrum, line: Option<Point>) -> String {
    let strongest = line.map_or_else(String::new, |line| {
        format!(
            " Above {} Hz the strongest line is at {} Hz with {} mN·m.",
            rounded(MOTION_HZ),
            rounded(line.x),
            rounded(line.y)
        )
    });
    let windows = match spectrum.segments {
        1 => "one Hann window".to_owned(),
        n => format!("{} half-overlapping Hann windows", count(n)),
    };
    format!(
        "How strongly the torque vibrates at each frequency, as the amplitude of a sine. \
         Regular cycles make a comb: the cycle frequency and its multiples.{strongest} Welch's \
         method over {windows}, resolution {} Hz; the marked bands are those in use for the \
         vibration of joints.",
        rounded(spectrum.resolution_hz)
    )
}

fn draw(area: &Area, points: &[Point]) -> Drawn {
    let (low, high) = extent(points.iter().map(|p| p.y));
    let top = 10_f64.powf(high.log10().ceil());
    // Five decades at most: below is rounding.
    let bottom = 10_f64
        .powf(low.max(1e-300).log10().floor())
        .clamp(top * 1e-5, top * 1e-2);
    let decades: Vec<f64> = (0..6_i32).map(|i| top * 10_f64.powi(-i)).collect();
    let (from, to) = points
        .first()
        .zip(points.last())
        .map_or((LOWEST_HZ, HIGHEST_HZ), |(a, b)| {
            // Up to the round number if the last bin just misses it.
            let to = if b.x > 0.95 * HIGHEST_HZ {
                HIGHEST_HZ
            } else {
                b.x
            };
            (LOWEST_HZ.max(a.x.min(1.0)), to.max(10.0))
        });
    let mut plot = Panel {
        x: Axis::logarithmic(from, to, &FREQUENCIES),
        y: Axis::logarithmic(bottom, top, &decades),
        x_title: Some("Frequency (Hz)"),
        y_title: "Amplitude (mN·m)",
        right: 24,
    }
    .on(area)?;
    let style = text_style(TEXT, HPos::Center, VPos::Top);
    for (low, high, _, shaded) in BANDS {
        if shaded && low < to {
            plot.shade(low, high, BAND)?;
        }
    }
    plot.grid()?;
    plot.line(points, TORQUE, 5)?;
    for (low, high, name, _) in BANDS {
        if low < to {
            let middle = (low * high.min(to)).sqrt();
            plot.text((middle, top), (0, 16), name, &style)?;
        }
    }
    Ok(())
}
