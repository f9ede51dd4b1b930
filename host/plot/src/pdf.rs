//! Pictures as PDF, with the feature `pdf`.

use crate::picture::Picture;

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
                f.write_str("this build has no PDF: it takes one with `--features pdf`")
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
}

#[cfg(not(feature = "pdf"))]
fn convert(_: &str, _: bool) -> Result<Vec<u8>, PdfError> {
    Err(PdfError::NotBuilt)
}

#[cfg(feature = "pdf")]
fn convert(svg: &str, compress: bool) -> Result<Vec<u8>, PdfError> {
    use svg2pdf::{ConversionOptions, PageOptions, to_pdf, usvg};

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
    let refused = |e: &dyn std::fmt::Display| PdfError::Refused(e.to_string());
    let tree = usvg::Tree::from_str(svg, &options).map_err(|e| refused(&e))?;
    let conversion = ConversionOptions {
        compress,
        ..ConversionOptions::default()
    };
    // A CSS pixel is a 96th of an inch.
    to_pdf(&tree, conversion, PageOptions { dpi: 96.0 }).map_err(|e| refused(&e))
}

#[cfg(all(test, feature = "pdf"))]
mod tests {
    use super::*;
    use crate::palette::TORQUE;
    use crate::{Axis, Panel, Point, stack};

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
