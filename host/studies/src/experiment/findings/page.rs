//! Results as a page.

use super::Findings;
use crepitus_pages::plot::page::{self, scrolling};
use maud::html;

const LAYOUT: &str = "body{max-width:64rem}table{border-collapse:collapse}th,td{padding:.2rem .8rem .2rem 0;\
text-align:left;vertical-align:top}h2{margin-top:1.8rem}";

/// Results of a study as one HTML page, complete in itself.
pub fn html(all: &[Findings]) -> String {
    let title = all
        .first()
        .map_or("Experiment", |first| first.protocol.title.as_str());
    let body = html! {
        header { p.kicker { "Crepitus · an experiment with people" } }
        main {
            @for findings in all {
                h1 { (findings.protocol.title) }
                p.description { (findings.facts()) }
                @for section in findings.sections() {
                    h2 { (section.heading) }
                    (scrolling(section.heading, &section.table().to_html()))
                }
                @for remark in findings.remarks() { p { (remark) } }
            }
        }
        (page::footer("Participants have pseudonyms. Intervals: see the book, Experiments."))
    };
    page::document(title, LAYOUT, &[], &body)
}
