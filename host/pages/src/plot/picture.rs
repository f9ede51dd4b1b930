//! Charts as SVG files of their own, for a paper, slides or a document.

use maud::{Markup, PreEscaped, html};

use crate::plot::drawing::{Anchor, Drawing, Svg, px};
use crate::plot::figure::{Figure, Key, Sign};
use crate::plot::palette::{AXIS, Ink, PAPER, TEXT, picture_style, printed};
use crate::plot::paper::{MARGIN, print_mm};
use crate::plot::stroke::Stroke;
use crate::plot::text::{SIZE, width};

/// One chart as a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// A name for the file, without extension: `torque`, `zoom-1`.
    pub name: String,
    /// The SVG document. It follows light and dark where it is shown.
    pub svg: String,
    /// CSS pixels.
    size: (f64, f64),
}

/// Every chart of figures, with its legend.
pub fn pictures<'f>(figures: impl IntoIterator<Item = &'f Figure>) -> Vec<Picture> {
    let mut pictures = Vec::new();
    for figure in figures {
        let several = figure.charts.len() > 1;
        for (i, chart) in (1..).zip(&figure.charts) {
            let name = if several {
                format!("{}-{i}", figure.name)
            } else {
                figure.name.to_owned()
            };
            pictures.push(Picture::new(name, &chart.svg, &figure.legend, &[]));
        }
    }
    pictures
}

/// Height of the legend above a chart, and of every further line, CSS pixels.
const LEGEND: f64 = 34.0;
const LEGEND_LINE: f64 = 22.0;

const FONTS: &str = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Noto Sans', sans-serif";

impl Picture {
    /// A chart with its legend above it. `inks` are those that it has beside
    /// the palette's.
    pub fn new(name: String, chart: &Svg, legend: &[Key], inks: &[Ink]) -> Self {
        let width = chart.width + if legend.is_empty() { 0.0 } else { MARGIN };
        let (entries, legend_height) = entries(legend, width);
        let height = chart.height + legend_height;
        let body = html! {
            rect width="100%" height="100%" fill=(PAPER) {}
            (entries)
            g transform=(format!("translate({} {legend_height})", width - chart.width)) { (PreEscaped(&chart.body)) }
        };
        let document = html! {
            svg xmlns="http://www.w3.org/2000/svg" viewBox=(format!("0 0 {width} {height}")) width=(width) height=(height)
                font-family=(FONTS) font-size=(SIZE) stroke-linejoin="round" {
                style { (PreEscaped(picture_style(&body.0, inks))) }
                (body)
            }
        };
        // A line an element, so that changes of a picture can be read.
        Self {
            name,
            svg: document.0.replace("><", ">\n<") + "\n",
            size: (width, height),
        }
    }

    /// Width in print, mm: that of a column, unless its smallest letters need more.
    pub fn print_mm(&self) -> f64 {
        let sizes = self.svg.split("font-size=\"").skip(1);
        let sizes = sizes.filter_map(|rest| rest.split_once('"')?.0.parse::<f64>().ok());
        print_mm(self.size.0, sizes.fold(SIZE, f64::min))
    }

    /// The picture with its [width in print](Self::print_mm) in place of pixels, and the inks of
    /// a paper.
    #[must_use]
    pub fn in_print(self) -> Self {
        let ((width, height), mm) = (self.size, self.print_mm());
        let pixels = format!("width=\"{width}\" height=\"{height}\"");
        let size = format!("width=\"{mm}mm\" height=\"{:.3}mm\"", height / width * mm);
        Self {
            svg: printed(&self.svg).replacen(&pixels, &size, 1),
            ..self
        }
    }
}

/// The legend in lines of this width, and its height.
fn entries(legend: &[Key], total: f64) -> (Markup, f64) {
    let mut drawing = Drawing::default();
    let (mut x, mut y) = (12.0, 17.0);
    for Key { sign, text } in legend {
        let room = sign.width() + 5.0 + width(text, SIZE);
        if x > 12.0 && x + room > total {
            (x, y) = (12.0, y + LEGEND_LINE);
        }
        match *sign {
            Sign::Line(ink) => drawing.line(&[(x, y), (x + 18.0, y)], Stroke::new(ink, 2.5)),
            Sign::Dashed(ink) => drawing.line(
                &[(x, y), (x + 18.0, y)],
                Stroke {
                    dashes: "5 3",
                    ..Stroke::new(ink, 2.5)
                },
            ),
            Sign::Patch(ink) => drawing.push(&html! {
                rect x=(px(x)) y=(y - 6.5) width="18" height="13" fill=(ink) stroke=(AXIS) {}
            }),
            Sign::Mark(mark) => drawing.text((x + 4.0, y), Anchor::Start, TEXT, mark),
            Sign::Curve(style) | Sign::Filled(style) => drawing.push(&html! {
                g transform=(format!("translate({} {})", px(x), y - 8.0)) {
                    (PreEscaped(style.sample(matches!(sign, Sign::Filled(_)))))
                }
            }),
        }
        drawing.text((x + sign.width() + 5.0, y), Anchor::Start, TEXT, text);
        x += room + 14.0;
    }
    let height = if legend.is_empty() {
        0.0
    } else {
        y + LEGEND - 17.0
    };
    (PreEscaped(drawing.finish()), height)
}
