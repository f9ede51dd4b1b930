//! HTML page of the result, in one file.

use super::chart;
use crepitus_identify::brace::{Brace, QuantityResult};
use crepitus_pages::plot::page::{document, figure, footer, notes};
use maud::html;

/// Style sheet: tables are aligned to the left.
const LAYOUT: &str = "section.table th, section.table td { text-align: left }";

/// Returns the page as HTML.
pub(super) fn html(brace: &Brace, title: &str, last_line: &str) -> String {
    let (swings, seconds) = brace.swung();
    let body = html! {
        header {
            p.kicker { "Crepitus · identified brace" }
            h1 { (title) }
            p.description {
                (swings) " swings, " (format!("{seconds:.1}")) " s. What the fit leaves of the angle is "
                (format!("{:.4}", brace.rms_rad.to_degrees())) "° rms, of swings up to "
                (format!("{:.0}", brace.amplitude_rad.to_degrees())) "°."
            }
        }
        main {
            section.table {
                h2 { "Values, with 95 % intervals" }
                table {
                    thead { tr { th { "quantity" } th { "parameter" } th { "value" } th { "unit" } } }
                    tbody {
                        @for shown in &brace.shown {
                            tr {
                                td { (shown.quantity.name()) }
                                td { code { (shown.quantity.effect()) "." (shown.quantity.spec().key) } }
                                @match &shown.result {
                                    QuantityResult::Seen(estimate) => {
                                        @let (value, half_width) = estimate.rounded();
                                        td { (value) " ± " (half_width) }
                                        td { (shown.quantity.spec().unit) }
                                    }
                                    QuantityResult::NotVisible { why } => {
                                        td colspan="2" { "not visible in this recording: " (why) }
                                    }
                                }
                            }
                        }
                    }
                }
            }
            (figure(&chart::figure(brace)))
            (notes(&brace.notes))
        }
        (footer(last_line))
    };
    document(title, LAYOUT, &[], &body)
}
