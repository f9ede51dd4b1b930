//! Pictures as PDF, and as SVG without text, with the feature `pdf`.

use crate::plot::picture::Picture;

/// Errors of the conversion to PDF.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PdfError {
    /// This build cannot.
    NotBuilt,
    /// No font is installed.
    NoFont,
    /// The converter refused.
    Refused(String),
}

impl std::fmt::Display for PdfError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotBuilt => {
                f.write_str("this build has no fonts, and so no PDF and no pictures for a paper: build it with `--features pdf`")
            }
            Self::NoFont => {
                f.write_str("no font is installed: install one, DejaVu Sans for example")
            }
            Self::Refused(why) => f.write_str(why),
        }
    }
}

impl std::error::Error for PdfError {}

impl Picture {
    /// Whether this build makes PDF.
    pub const HAS_PDF: bool = cfg!(feature = "pdf");

    /// The picture as a PDF of one page of its size, in light colours, with the
    /// glyphs that it needs embedded.
    ///
    /// # Errors
    /// [`PdfError`] without the feature, or without any font.
    pub fn pdf(&self) -> Result<Vec<u8>, PdfError> {
        convert(&self.svg, true)
    }

    /// The picture with its letters as outlines, in light colours: an SVG that needs no font and
    /// looks the same in every program. (An embedded font would be smaller, but most programs that
    /// draw SVG, those of publishers among them, do not read it.)
    ///
    /// # Errors
    /// [`PdfError`] without the feature, or without any font.
    pub fn outlined(&self) -> Result<String, PdfError> {
        let drawn = outlines(&self.svg)?;
        // The size as it is meant, in mm, not in pixels.
        let size = |svg: &str| {
            let from = svg.find(" width=\"")?;
            let height = from + svg.get(from..)?.find(" height=\"")? + " height=\"".len();
            let end = height + svg.get(height..)?.find('"')? + 1;
            Some(from..end)
        };
        match (size(&self.svg), size(&drawn)) {
            (Some(meant), Some(written)) => {
                let mut svg = drawn;
                svg.replace_range(written, &self.svg[meant]);
                Ok(svg)
            }
            _ => Ok(drawn),
        }
    }
}

#[cfg(not(feature = "pdf"))]
fn convert(_: &str, _: bool) -> Result<Vec<u8>, PdfError> {
    Err(PdfError::NotBuilt)
}

#[cfg(not(feature = "pdf"))]
fn outlines(_: &str) -> Result<String, PdfError> {
    Err(PdfError::NotBuilt)
}

#[cfg(feature = "pdf")]
fn convert(svg: &str, compress: bool) -> Result<Vec<u8>, PdfError> {
    use svg2pdf::{ConversionOptions, PageOptions, to_pdf};

    let conversion = ConversionOptions {
        compress,
        ..ConversionOptions::default()
    };
    // A CSS pixel is a 96th of an inch.
    to_pdf(&tree(svg)?, conversion, PageOptions { dpi: 96.0 })
        .map_err(|e| PdfError::Refused(e.to_string()))
}

#[cfg(feature = "pdf")]
fn outlines(svg: &str) -> Result<String, PdfError> {
    let written = svg2pdf::usvg::WriteOptions {
        // Thousandths of a pixel.
        coordinates_precision: 3,
        transforms_precision: 6,
        ..svg2pdf::usvg::WriteOptions::default()
    };
    Ok(tree(svg)?.to_string(&written))
}

/// The picture with every text set in an installed font.
#[cfg(feature = "pdf")]
fn tree(svg: &str) -> Result<svg2pdf::usvg::Tree, PdfError> {
    use svg2pdf::usvg;

    /// Fonts with all the letters that charts have.
    const FONTS: [&str; 4] = ["Noto Sans", "DejaVu Sans", "Arial", "Helvetica"];

    let mut options = usvg::Options::default();
    let fonts = options.fontdb_mut();
    fonts.load_system_fonts();
    if fonts.is_empty() {
        return Err(PdfError::NoFont);
    }
    let is_there = |name: &&str| {
        fonts
            .faces()
            .any(|face| face.families.iter().any(|f| f.0 == *name))
    };
    if let Some(name) = FONTS.into_iter().find(is_there) {
        fonts.set_sans_serif_family(name);
    }
    usvg::Tree::from_str(svg, &options).map_err(|e| PdfError::Refused(e.to_string()))
}

#[cfg(all(test, feature = "pdf"))]
mod tests {
    use super::*;
    use crate::plot::palette::TORQUE;
    use crate::plot::{Axis, Panel, Point, stack};

    #[test]
    fn a_picture_is_one_page_of_its_size_with_lines_and_letters() {
        let axis = || Axis::linear(0.0, 1.0, 5);
        let panel = Panel::new(300.0, axis(), ("Torque (N·m)", axis()), |plot| {
            plot.line(&[Point::new(0.0, 0.0), Point::new(1.0, 1.0)], TORQUE, 2.0);
        });
        let picture = Picture::new("x".to_owned(), &stack(400.0, "x", vec![panel]), &[], &[]);
        assert!(picture.pdf().expect("a PDF").starts_with(b"%PDF-"));
        let pdf = convert(&picture.svg, false).expect("a PDF");
        let pdf = String::from_utf8_lossy(&pdf);
        assert_eq!(pdf.matches("/Type /Page\n").count(), 1, "pages");
        assert!(
            pdf.contains("/MediaBox [0 0 300 225]"),
            "400 × 300 px in points"
        );
        assert!(pdf.contains("/FontFile"), "glyphs are embedded");
        // Colours, strokes, shown text.
        for operator in [" SCN\n", "\nS\n", " Tf\n", " Tj\n"] {
            assert!(pdf.contains(operator), "{operator:?}");
        }
    }
}
