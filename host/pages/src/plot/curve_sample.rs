//! Samples of curves, for legends and between words.

use maud::{Markup, PreEscaped, html};

use crate::plot::curve_style::CurveStyle;
use crate::plot::drawing::Drawing;

impl CurveStyle {
    /// Sample for legends: a stretch of the curve, or its sign, filled.
    pub(crate) fn sample(self, filled: bool) -> String {
        let mut drawing = Drawing::default();
        if !filled {
            drawing.line(&[(2.0, 8.0), (42.0, 8.0)], self.stroke());
        }
        drawing.marker((22.0, 8.0), self, filled, "");
        drawing.finish()
    }

    /// Sample as an element between words.
    pub fn inline(self, filled: bool) -> Markup {
        html! {
            svg.sample width="44" height="16" viewBox="0 0 44 16" stroke-linejoin="round" aria-hidden="true" {
                (PreEscaped(self.sample(filled)))
            }
        }
    }
}
