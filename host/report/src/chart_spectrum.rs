//! The amplitude spectrum of the torque, and of that at the hand.

use plotters::element::Text;
use plotters::style::text_anchor::{HPos, VPos};

use crate::ReportError;
use crate::axis::{Axis, extent};
use crate::canvas::{Area, Drawn, Fault, Panel, px, svg, text_style};
use crate::collector::Figures;
use crate::figure::{Chart, Figure, Key, Sign};
use crate::number::{count, rounded};
use crate::palette::{BAND, Ink, TEXT, TORQUE};
use crate::plant::LEG;
use crate::spectrum::{Spectrum, Welch};
use crate::thinned::Point;

/// Room above the plot, CSS pixels: at its foot, and for a row of numbers.
const STRIP: u32 = 4;
const STRIP_ROW: u32 = 22;

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

/// Name of the curve of the torque at the hand.
const HAND: &str = "hand";

/// A torque's spectrum, as it is drawn.
struct Curve<'s> {
    name: &'static str,
    ink: Ink,
    /// Of the ink, in the style sheet.
    class: &'static str,
    spectrum: &'s Spectrum,
    /// Amplitudes in mN·m at the frequencies that are shown.
    points: Vec<Point>,
}

impl<'s> Curve<'s> {
    fn new(
        name: &'static str,
        (class, ink): (&'static str, Ink),
        spectrum: Option<&'s Spectrum>,
    ) -> Option<Self> {
        spectrum.map(|spectrum| Self {
            name,
            ink,
            class,
            spectrum,
            points: spectrum
                .points
                .iter()
                .filter(|p| (LOWEST_HZ..=HIGHEST_HZ).contains(&p.x))
                .map(|p| Point::new(p.x, 1e3 * p.y))
                .collect(),
        })
    }

    fn vibrates(&self) -> bool {
        self.points.iter().any(|p| p.y > 1e-9)
    }
}

pub(crate) fn figure(figures: &Figures) -> Result<Option<Figure>, ReportError> {
    let hand = figures.plant.as_ref().filter(|p| !p.hand.is_empty());
    if !(figures.has_torque || hand.is_some()) || figures.rows == 0 {
        return Ok(None);
    }
    let title = match (figures.has_torque, hand) {
        (true, Some(_)) => "Spectra of the torques",
        (true, None) => "Spectrum of the torque",
        (false, _) => "Spectrum of the hand torque",
    };
    let nothing = |caption: String| {
        Ok(Some(Figure {
            name: "spectrum",
            title,
            legend: Vec::new(),
            charts: Vec::new(),
            caption,
        }))
    };
    let mut curves: Vec<Curve> = [
        Curve::new("model", ("torque", TORQUE), figures.spectrum.as_ref()),
        Curve::new(
            HAND,
            ("green", LEG),
            hand.and_then(|p| p.hand_spectrum.as_ref()),
        ),
    ]
    .into_iter()
    .flatten()
    .collect();
    let Some(first) = curves.first() else {
        return nothing(format!(
            "Not drawn: {} evenly spaced rows are too few for a spectrum; it takes at least {}.",
            count(figures.rows),
            Welch::SHORTEST
        ));
    };
    let method = method(first.spectrum);
    curves.retain(Curve::vibrates);
    if curves.is_empty() {
        return nothing("Not drawn: the torque does not vibrate.".to_owned());
    }
    let strip = if hand.is_some() {
        STRIP + u32::try_from(curves.len()).unwrap_or(0) * STRIP_ROW
    } else {
        0
    };
    let svg = svg(
        (960, 340 + strip),
        "Amplitude of the torque against frequency",
        |area| {
            let (above, below) = area.split_vertically(px(strip));
            let centres = draw(&below, &curves)?;
            if strip > 0 {
                draw_strip(&above, &curves, &centres)?;
            }
            Ok(())
        },
    )?;
    let legend = if hand.is_some() {
        curves
            .iter()
            .map(|curve| Key::new(Sign::Line(curve.class), curve.name))
            .collect()
    } else {
        Vec::new()
    };
    Ok(Some(Figure {
        name: "spectrum",
        title,
        legend,
        charts: vec![Chart {
            heading: None,
            svg,
            half: false,
        }],
        caption: caption(&curves, &method, (figures.has_torque, hand.is_some())),
    }))
}

/// What makes a peak a line: it is so many times as high as the lowest point
/// of either side within so many bins.
#[derive(Clone, Copy)]
struct Line {
    times: f64,
    bins: usize,
}

/// Both neighbours are lower: a slope is not a line.
const PEAK: Line = Line {
    times: 1.0,
    bins: 1,
};

/// Nor is a ripple on the slope that a moved leg makes.
const OUTSTANDING: Line = Line {
    times: 1.5,
    bins: 4,
};

/// The highest line above the frequencies of the motion.
fn strongest_line(points: &[Point], Line { times, bins }: Line) -> Option<Point> {
    let lowest = |side: &[Point]| extent(side.iter().map(|p| p.y)).0;
    points
        .windows(2 * bins + 1)
        .filter(|w| {
            let (before, peak, after) = (&w[..bins], w[bins], &w[bins + 1..]);
            peak.x >= MOTION_HZ
                && peak.y > before[bins - 1].y
                && peak.y > after[0].y
                && peak.y > times * lowest(before).max(lowest(after))
        })
        .map(|w| w[bins])
        .reduce(|best, p| if p.y > best.y { p } else { best })
}

/// How the spectra came about.
fn method(spectrum: &Spectrum) -> String {
    let windows = match spectrum.segments {
        1 => "one Hann window".to_owned(),
        n => format!("{} half-overlapping Hann windows", count(n)),
    };
    format!(
        "Welch's method over {windows}, resolution {} Hz; the marked bands are those in use for \
         the vibration of joints.",
        rounded(spectrum.resolution_hz)
    )
}

fn caption(curves: &[Curve], method: &str, (model, names): (bool, bool)) -> String {
    let line = if names { OUTSTANDING } else { PEAK };
    let strongest: Vec<String> = curves
        .iter()
        .filter_map(|curve| Some((curve.name, strongest_line(&curve.points, line)?)))
        .map(|(name, line)| {
            let of = if names {
                format!(" of the {name} torque")
            } else {
                String::new()
            };
            format!(
                " Above {} Hz the strongest line{of} is at {} Hz with {} mN·m.",
                rounded(MOTION_HZ),
                rounded(line.x),
                rounded(line.y)
            )
        })
        .collect();
    let bands = if names {
        " From 2.5 Hz on taken of second differences, which is undone, so that the weight of a leg does \
         not leak into the bands. The numbers above are the root mean square of what vibrates in each."
    } else {
        ""
    };
    let comb = if model {
        " Regular cycles make a comb: the cycle frequency and its multiples."
    } else {
        ""
    };
    format!(
        "How strongly the torque vibrates at each frequency, as the amplitude of a sine.{comb}{} \
         {method}{bands}",
        strongest.concat()
    )
}

/// Draws the curves, and says where the middles of the bands are, in grid
/// lines; none for a band beyond the axis.
fn draw(area: &Area, curves: &[Curve]) -> Result<[Option<i32>; 3], Fault> {
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let (low, high) = extent(points().map(|p| p.y));
    let top = 10_f64.powf(high.log10().ceil());
    // Five decades at most: below is rounding. The weight of a leg takes three
    // more.
    let deepest = if curves.iter().any(|curve| curve.name == HAND) {
        1e-8
    } else {
        1e-5
    };
    let bottom = 10_f64
        .powf(low.max(1e-300).log10().floor())
        .clamp(top * deepest, top * 1e-2);
    let decades: Vec<f64> = (0..9_i32).map(|i| top * 10_f64.powi(-i)).collect();
    let (lowest, highest) = extent(points().map(|p| p.x));
    // Up to the round number if the last bin just misses it.
    let to = if highest > 0.95 * HIGHEST_HZ {
        HIGHEST_HZ
    } else {
        highest
    };
    let (from, to) = (LOWEST_HZ.max(lowest.min(1.0)), to.max(10.0));
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
    for curve in curves {
        plot.line(&curve.points, curve.ink, 5)?;
    }
    let mut centres = [None; 3];
    for ((low, high, name, _), centre) in BANDS.into_iter().zip(&mut centres) {
        if low < to {
            let middle = (low * high.min(to)).sqrt();
            plot.text((middle, top), (0, 16), name, &style)?;
            *centre = Some(plot.at((middle, top)).0);
        }
    }
    Ok(centres)
}

/// The root mean square of each band above its middle, a curve a row.
fn draw_strip(area: &Area, curves: &[Curve], centres: &[Option<i32>; 3]) -> Drawn {
    let write = |x: i32, row: u32, words: String, ink: Ink, side: HPos| {
        let y = px(STRIP_ROW * row + STRIP_ROW / 2 + 4);
        let style = text_style(ink, side, VPos::Center);
        area.draw(&Text::new(words, (x, i32::try_from(y).unwrap_or(0)), style))
    };
    for (row, curve) in (0..).zip(curves) {
        let name = format!("{}, RMS in the band (mN·m)", curve.name);
        write(
            i32::try_from(px(78)).unwrap_or(0),
            row,
            name,
            curve.ink,
            HPos::Left,
        )?;
        for ((low, high, ..), centre) in BANDS.into_iter().zip(centres) {
            if let Some(x) = centre {
                let rms = rounded(1e3 * curve.spectrum.rms(low, high));
                write(*x, row, rms, curve.ink, HPos::Center)?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_stands_out() {
        // A slope with a ripple, and a line further up.
        let amplitude = |hz: f64| {
            let ripple = 1.0 + 0.05 * (hz * 1.3).sin();
            let line = if hz == 96.0 { 3.0 } else { 1.0 };
            ripple * line * 1e4 / (hz * hz)
        };
        let points = |to: u32| -> Vec<Point> {
            (1..to)
                .map(|hz| Point::new(f64::from(hz), amplitude(f64::from(hz))))
                .collect()
        };
        assert_eq!(
            strongest_line(&points(200), OUTSTANDING).map(|p| p.x),
            Some(96.0)
        );
        assert_eq!(strongest_line(&points(90), OUTSTANDING), None);
        assert!(strongest_line(&points(90), PEAK).is_some());
        assert_eq!(strongest_line(&points(3), PEAK), None);
    }
}
