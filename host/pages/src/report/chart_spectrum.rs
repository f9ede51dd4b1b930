//! The amplitude spectrum of the torque, and of that at the hand.

use crate::plot::number::{count, rounded};
use crate::plot::palette::{BAND, Ink, TEXT, TORQUE};
use crate::plot::{
    Anchor, Axis, Chart, Drawing, Figure, Key, Panel, Paper, Plot, Point, Sign, Svg, extent, stack,
    text,
};

use crate::report::collector::Figures;
use crate::report::plant::LEG;
use crate::report::spectrum::{Spectrum, Welch};

/// Room above the plot, CSS pixels: at its foot, and for a row of numbers.
/// Right of the axes, for the last name, CSS pixels.
const ROOM: f64 = 22.0;
const STRIP: f64 = 4.0;
const STRIP_ROW: f64 = 22.0;

const LOWEST_HZ: f64 = 0.5;
const HIGHEST_HZ: f64 = 500.0;
/// Frequency below which lines belong to the motion rather than to the joint.
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
    spectrum: &'s Spectrum,
    /// Amplitudes in mN·m at the frequencies that are shown.
    points: Vec<Point>,
}

impl<'s> Curve<'s> {
    fn new(name: &'static str, ink: Ink, spectrum: Option<&'s Spectrum>) -> Option<Self> {
        spectrum.map(|spectrum| Self {
            name,
            ink,
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

pub(crate) fn figure(figures: &Figures, paper: Paper) -> Option<Figure> {
    let hand = figures.plant.as_ref().filter(|p| !p.hand.is_empty());
    if !(figures.has_torque || hand.is_some()) || figures.rows == 0 {
        return None;
    }
    let title = match (figures.has_torque, hand) {
        (true, Some(_)) => "Spectra of the torques",
        (true, None) => "Spectrum of the torque",
        (false, _) => "Spectrum of the hand torque",
    };
    let nothing = |caption: String| {
        Some(Figure {
            name: "spectrum",
            title,
            legend: Vec::new(),
            charts: Vec::new(),
            caption,
        })
    };
    let mut curves: Vec<Curve> = [
        Curve::new("model", TORQUE, figures.spectrum.as_ref()),
        Curve::new(HAND, LEG, hand.and_then(|p| p.hand_spectrum.as_ref())),
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
    let svg = chart(&curves, hand.is_some(), paper);
    let legend = if hand.is_some() {
        curves
            .iter()
            .map(|curve| Key::new(Sign::Line(curve.ink), curve.name))
            .collect()
    } else {
        Vec::new()
    };
    Some(Figure {
        name: "spectrum",
        title,
        legend,
        charts: vec![Chart::full(svg)],
        caption: caption(&curves, &method, (figures.has_torque, hand.is_some())),
    })
}

/// Criterion of a line: a peak that is so many times as high as the lowest point
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

/// Method of the spectra, in words.
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

/// The curves; optionally with the RMS of each band above it.
fn chart(curves: &[Curve], with_numbers: bool, paper: Paper) -> Svg {
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
    let strip = if with_numbers {
        STRIP + STRIP_ROW * curves.len() as f64
    } else {
        0.0
    };
    let x = Axis::logarithmic(from, to, &FREQUENCIES);
    let y = Axis::logarithmic(bottom, top, &decades);
    let panel = Panel::new(340.0, x, ("Amplitude (mN·m)", y), |plot| {
        let shaded = BANDS
            .into_iter()
            .filter(|(low, .., shaded)| *shaded && *low < to);
        plot.shade(shaded.map(|(low, high, ..)| (low, high)), BAND);
        plot.grid();
        for curve in curves {
            plot.line(&curve.points, curve.ink, 1.25);
        }
        names(plot, if with_numbers { curves } else { &[] }, to);
    });
    let panel = panel
        .x_title(Some("Frequency (Hz)"))
        .head(strip, None)
        .right(ROOM + 2.0);
    stack(
        paper.width(960.0),
        "Amplitude of the torque against frequency",
        vec![panel],
    )
}

/// The name of each band, and in rows above it the root mean square of each
/// curve in it.
fn names(plot: &mut Plot, curves: &[Curve], to: f64) {
    let frame = plot.frame();
    let height =
        |row: usize| frame.top - STRIP - 10.0 - STRIP_ROW * ((curves.len() - row) as f64 - 0.5);
    let middle = |low: f64, high: f64| (low * high.min(to)).sqrt();
    let bands = || BANDS.into_iter().filter(|(low, ..)| *low < to);
    // Left of the first number there may be room for the short name alone.
    let room = bands().next().map_or(0.0, |(low, high, ..)| {
        plot.at((middle(low, high), 1.0)).0 - frame.left - 30.0
    });
    for (row, curve) in curves.iter().enumerate() {
        let long = format!("{}, RMS in the band (mN·m)", curve.name);
        let name = if Drawing::label_width(&long) < room {
            long
        } else {
            format!("{} (mN·m)", curve.name)
        };
        plot.over.text(
            (frame.left + 4.0, height(row)),
            Anchor::Start,
            curve.ink,
            &name,
        );
    }
    let mut end = f64::NEG_INFINITY;
    for (low, high, name, _) in bands() {
        let (x, top) = plot.at((middle(low, high), plot.y().high()));
        let half = 0.5 * text::width(name, text::SIZE);
        let x = x.min(frame.right + ROOM - half);
        // Below the one before, where the two would touch.
        let down = if x - half < end + 6.0 { 32.0 } else { 12.0 };
        end = x + half;
        plot.over.text((x, top + down), Anchor::Middle, TEXT, name);
        for (row, curve) in curves.iter().enumerate() {
            let rms = rounded(1e3 * curve.spectrum.rms(low, high));
            plot.over
                .text((x, height(row)), Anchor::Middle, curve.ink, &rms);
        }
    }
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
