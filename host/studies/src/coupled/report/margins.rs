//! Stiffness margins: how much stiffer a joint may be before its shaft rings.

use crate::coupled::{Margin, Verdict};
use crepitus_pages::plot::page::scrolling;
use crepitus_pages::table::Table;
use maud::{Markup, html};

pub(super) fn table(
    title: &str,
    first: &str,
    margins: &[Margin],
    name: fn(&Margin) -> &str,
) -> Markup {
    let table = Table::of(margins)
        .people(first, name)
        .people("gear’s friction", |margin| margin.setting.gear.name)
        .people("cuff, N·m·s/rad", |margin| {
            margin.setting.damping_nms_per_rad
        })
        .left()
        .people("as it is", |margin| margin.verdict.name())
        .people("rings from", onset);
    html! {
        section.margins {
            h2 { (title) }
            (scrolling(title, &table.to_html()))
        }
    }
}

/// Onset in words: how many times the joint's own stiffness.
fn onset(margin: &Margin) -> String {
    match (margin.onset, margin.verdict) {
        (Some(factor), Verdict::Rings) => format!("{factor:.2} times its stiffness: it rings"),
        (Some(factor), _) => format!("{factor:.2} times its stiffness"),
        (None, _) => format!(
            "not up to {:.1} times, the most the device takes",
            margin.most
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coupled::Setting;

    #[test]
    fn a_margin_is_described_in_words() {
        let margin = |onset, verdict| Margin {
            setting: Setting::shipped(),
            verdict,
            onset,
            most: 5.66,
        };
        let told = onset(&margin(None, Verdict::Quiet));
        assert_eq!(told, "not up to 5.7 times, the most the device takes");
        assert_eq!(
            onset(&margin(Some(1.41), Verdict::Settles)),
            "1.41 times its stiffness"
        );
        assert!(onset(&margin(Some(0.5), Verdict::Rings)).ends_with("it rings"));
    }
}
