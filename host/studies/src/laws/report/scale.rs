//! Colours of errors. Darker on light paper, and brighter on dark, is a larger error: a sequential
//! blue up to an error as large as the effect, then two colours of their own.

use super::share::Share;
use crepitus_pages::plot::palette::{Ink, PAPER, TEXT};
use crepitus_pages::plot::{Key, Sign};

/// Largest share, colour and legend of each stretch.
const STRETCHES: [(f64, Ink, &str); 5] = [
    (
        1e-4,
        Ink::new("h0", "#f0f7fc", "#15232c"),
        "up to 10⁻⁴ of the scale",
    ),
    (1e-3, Ink::new("h1", "#d6eaf6", "#16323f"), "10⁻³"),
    (1e-2, Ink::new("h2", "#b0d6ee", "#174355"), "10⁻²"),
    (0.1, Ink::new("h3", "#82bde2", "#19566f"), "0.1"),
    (1.0, Ink::new("h4", "#559fd0", "#1b6a8c"), "1"),
];

const BEYOND: Ink = Ink::new("beyond", "#f6c766", "#7d5a12");
const CANNOT: Ink = Ink::new("cannot", "#a8320c", "#e2663a");

/// Ground, colour of the sign, and sign; `None` for nothing.
pub(super) fn tone(share: Share) -> Option<(Ink, Ink, &'static str)> {
    match share {
        Share::Unknown => None,
        Share::Cannot => Some((CANNOT, PAPER, "✗")),
        Share::Of(share) => {
            let found = STRETCHES.iter().find(|(up_to, ..)| share <= *up_to);
            Some(found.map_or((BEYOND, TEXT, "!"), |(_, ink, _)| (*ink, TEXT, "")))
        }
    }
}

/// The legend.
pub(super) fn legend() -> Vec<Key> {
    let stretches = STRETCHES
        .iter()
        .map(|(_, ink, text)| Key::new(Sign::Patch(*ink), text));
    let more = [
        Key::new(Sign::Patch(BEYOND), "! beyond: larger than the effect"),
        Key::new(Sign::Patch(CANNOT), "✗ cannot do it"),
    ];
    stretches.chain(more).collect()
}

/// All colours.
pub(super) fn inks() -> Vec<Ink> {
    let stretches = STRETCHES.iter().map(|(_, ink, _)| *ink);
    stretches.chain([BEYOND, CANNOT]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_has_the_colour_of_its_stretch() {
        let name = |share| tone(share).map(|(ink, ..)| ink.name);
        assert_eq!(name(Share::Of(0.0)), Some("h0"));
        assert_eq!(name(Share::Of(1e-3)), Some("h1"));
        assert_eq!(name(Share::Of(0.9)), Some("h4"));
        assert_eq!(name(Share::Of(1.1)), Some("beyond"));
        assert_eq!(name(Share::Cannot), Some("cannot"));
        assert_eq!(name(Share::Unknown), None);
        assert_eq!(legend().len(), inks().len());
    }
}
