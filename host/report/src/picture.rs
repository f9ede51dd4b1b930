//! Charts as SVG files of their own, for a paper, slides or a document.

use std::fmt::Write as _;

use crate::ReportError;
use crate::collector::Figures;
use crate::escape::escaped;
use crate::figure::{Key, Sign};
use crate::{page, palette};

/// One chart as a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// A name for the file, without extension: `torque`, `zoom-1`.
    pub name: String,
    /// The SVG document. It follows light and dark where it is shown.
    pub svg: String,
}

/// Every chart of the report, with its legend.
///
/// # Errors
/// [`ReportError::Draw`] if the drawing library refuses a chart.
pub fn pictures(figures: &Figures) -> Result<Vec<Picture>, ReportError> {
    let mut pictures = Vec::new();
    for figure in page::draw(figures)? {
        let several = figure.charts.len() > 1;
        for (i, chart) in figure.charts.iter().enumerate() {
            pictures.push(Picture {
                name: if several {
                    format!("{}-{}", figure.name, i + 1)
                } else {
                    figure.name.to_owned()
                },
                svg: document(&chart.svg, &figure.legend),
            });
        }
    }
    Ok(pictures)
}

/// Room at the left, CSS pixels.
const MARGIN: u32 = 8;

/// Height of the legend above a chart, CSS pixels.
const LEGEND_HEIGHT: u32 = 34;

/// Height of every further line of the legend, CSS pixels.
const LEGEND_LINE: u32 = 22;

/// Style rules of charts besides colours.
const RULES: &str = "svg{font-family:system-ui,-apple-system,\"Segoe UI\",Roboto,\"Noto Sans\",sans-serif}\n\
    svg polyline[stroke=\"#555551\"]{stroke-dasharray:24 16}\n";

/// A chart as a document: what the page gave it by its style sheet it now
/// brings along, and its legend stands above it.
pub(crate) fn document(chart: &str, legend: &[Key]) -> String {
    let size = view_box(chart);
    let (width, height) = size.unwrap_or((800.0, 400.0));
    // The chart's own grid is finer than a CSS pixel; the legend is in pixels.
    let scale = 4.0;
    let (chart_width, chart_height) = (width / scale, height / scale);
    let width = chart_width + f64::from(MARGIN);
    let (entries, legend_lines) = entries(legend, width);
    let legend_height = LEGEND_HEIGHT + legend_lines * LEGEND_LINE;
    let height = chart_height + f64::from(legend_height);
    let chart = chart.replacen(
        "<svg ",
        &format!(
            "<svg x=\"{MARGIN}\" overflow=\"visible\" y=\"{legend_height}\" width=\"{chart_width}\" height=\"{chart_height}\" "),
        1,
    );
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\">\n\
         <style>{}</style>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"{}\"/>\n{entries}{chart}\n</svg>\n",
        palette::picture_style(RULES, &[]),
        palette::PAPER.hex(),
    )
}

/// Width and height of a chart's view box.
fn view_box(chart: &str) -> Option<(f64, f64)> {
    let (_, rest) = chart.split_once("viewBox=\"0 0 ")?;
    let (size, _) = rest.split_once('"')?;
    let (width, height) = size.split_once(' ')?;
    Some((width.parse().ok()?, height.parse().ok()?))
}

/// The legend in lines of this width, and how many there are after the first.
fn entries(legend: &[Key], width: f64) -> (String, u32) {
    let mut out = String::new();
    let mut line = 0;
    let mut x = 12.0;
    for key in legend {
        // About eight pixels a letter at this size.
        let letters = key.text.chars().fold(0.0, |n, _| n + 1.0);
        let room = 40.0 + 8.0 * letters;
        if x > 12.0 && x + room - 16.0 > width {
            x = 12.0;
            line += 1;
        }
        let y = f64::from(line * LEGEND_LINE);
        let sign = f64::from(key.sign.width());
        // Writing to a String cannot fail.
        let _ = match key.sign {
            Sign::Line(ink) => writeln!(
                out,
                "<line x1=\"{x}\" x2=\"{}\" y1=\"{middle}\" y2=\"{middle}\" stroke=\"{}\" stroke-width=\"2.5\"/>",
                x + 18.0,
                palette::marker_of(ink),
                middle = y + 17.0
            ),
            Sign::Patch(ink) => writeln!(
                out,
                "<rect x=\"{x}\" y=\"{}\" width=\"18\" height=\"13\" fill=\"{}\" stroke=\"{}\"/>",
                y + 10.0,
                palette::marker_of(ink),
                palette::AXIS.hex()
            ),
            Sign::Mark(mark) => writeln!(
                out,
                "<text x=\"{}\" y=\"{}\" font-size=\"13\" fill=\"{}\">{mark}</text>",
                x + 4.0,
                y + 22.0,
                palette::TEXT.hex()
            ),
            Sign::Curve(hand) => writeln!(
                out,
                "<g transform=\"translate({x} {})\">{}</g>",
                y + 9.0,
                hand.sample()
            ),
            Sign::Filled(hand) => writeln!(
                out,
                "<g transform=\"translate({x} {})\">{}</g>",
                y + 9.0,
                hand.filled_sample()
            ),
        };
        let _ = writeln!(
            out,
            "<text x=\"{}\" y=\"{}\" font-size=\"14\" fill=\"{}\">{}</text>",
            x + sign + 5.0,
            y + 22.0,
            palette::TEXT.hex(),
            escaped(key.text)
        );
        x += room + sign - 18.0;
    }
    (out, line)
}
