//! The width of pictures: that of a screen's page, or of one or two columns of a journal.
//!
//! A chart is laid out for its medium, not scaled: letters and lines have their sizes in CSS
//! pixels, and a column has so many pixels that the smallest letters are printed at 7 pt.
//!
//! | | IEEE | Elsevier, at most | here |
//! |---|---|---|---|
//! | one column | 88.9 mm | 90 mm | 88.9 mm, 468 px |
//! | two columns | 182 mm | 190 mm | 182 mm, 958 px |
//! | smallest letters | – | 7 pt | 7 pt |
//!
//! Sources: IEEE Author Center, "Size requirements for graphics"; Elsevier, "Artwork sizing".

use crate::plot::drawing::LABEL;

/// The smallest letters of a printed picture, pt.
pub const SMALLEST_PT: f64 = 7.0;

/// The thinnest lines of a printed picture, pt.
pub const THINNEST_PT: f64 = 0.5;

/// Points of a millimetre.
pub(crate) const PT_PER_MM: f64 = 72.0 / 25.4;

/// Charts that stand side by side on a page are no wider than this, CSS pixels.
const HALF: f64 = 480.0;

/// Room that a picture adds at the left of a chart, CSS pixels.
pub(crate) const MARGIN: f64 = 8.0;

/// Width at which a picture is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Width of one column of text.
    One,
    /// Width of both columns.
    Two,
}

impl Column {
    /// Both, from the narrow one.
    pub const ALL: [Self; 2] = [Self::One, Self::Two];

    /// Width in print, mm.
    pub const fn mm(self) -> f64 {
        match self {
            Self::One => 88.9,
            Self::Two => 182.0,
        }
    }

    /// CSS pixels across, with the smallest letters at [`SMALLEST_PT`].
    fn px(self) -> f64 {
        (self.mm() * PT_PER_MM * LABEL / SMALLEST_PT).floor()
    }
}

/// Medium for which charts are laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paper {
    /// A page on a screen.
    Screen,
    /// A journal.
    Print(Column),
}

impl Paper {
    /// Width of a chart that has this width on a screen, CSS pixels. Of charts that stand side by
    /// side there, each takes one column.
    pub fn width(self, screen_px: f64) -> f64 {
        match self {
            Self::Screen => screen_px,
            Self::Print(_) if screen_px <= HALF => Column::One.px() - MARGIN,
            Self::Print(column) => column.px() - MARGIN,
        }
    }

    /// Width of a chart whose names need the room of two columns, CSS pixels.
    pub fn wide(self, screen_px: f64) -> f64 {
        match self {
            Self::Screen => screen_px,
            Self::Print(_) => Column::Two.px() - MARGIN,
        }
    }
}

/// Width in print of a picture with this width and smallest letter, both CSS pixels, in mm: the
/// narrowest column in which its letters are large enough; or as wide as they need.
pub(crate) fn print_mm(width_px: f64, letter_px: f64) -> f64 {
    let needed_mm = width_px / letter_px * SMALLEST_PT / PT_PER_MM;
    let columns = Column::ALL.map(Column::mm).into_iter();
    let mut fit = columns.filter(|mm| *mm >= needed_mm);
    fit.next().unwrap_or(needed_mm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_laid_out_for_a_column_is_printed_in_it() {
        for column in Column::ALL {
            for margin in [0.0, MARGIN] {
                let width = Paper::Print(column).width(960.0) + margin;
                assert_eq!(print_mm(width, LABEL), column.mm());
            }
            assert_eq!(Paper::Print(column).width(470.0), 460.0);
            assert_eq!(
                print_mm(Paper::Print(column).wide(960.0) + MARGIN, LABEL),
                182.0
            );
        }
        assert_eq!(Paper::Screen.width(470.0), 470.0);
        assert_eq!(print_mm(958.0, 13.0), 182.0);
        // 2000 px at 7/13 pt.
        assert!((print_mm(2000.0, 13.0) - 379.915).abs() < 0.01);
    }
}
