//! The colours of verdicts. Darker on light paper, and brighter on dark, is
//! nearer to trouble: a sequential blue for what holds, by how much of its
//! limit it takes up, then two colours of their own.

use std::fmt::Write as _;

use crepitus_pages::plot::number::power;
use crepitus_pages::plot::palette::{Ink, PAPER, TEXT};

/// A colour of a cell: its ground, whose name is a class of the style sheet,
/// and what is written on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tone {
    pub(super) ground: Ink,
    pub(super) text: Ink,
}

const fn tone(name: &'static str, light: &'static str, dark: &'static str) -> Tone {
    Tone {
        ground: Ink::new(name, light, dark),
        text: TEXT,
    }
}

/// Tones of what holds, each up to this share of the limit.
pub(super) const HOLDS: [(f64, Tone); 5] = [
    (1e-4, tone("h0", "#f0f7fc", "#15232c")),
    (1e-2, tone("h1", "#d6eaf6", "#16323f")),
    (0.1, tone("h2", "#b0d6ee", "#174355")),
    (0.5, tone("h3", "#82bde2", "#19566f")),
    (1.0, tone("h4", "#559fd0", "#1b6a8c")),
];
pub(super) const DEGRADES: Tone = tone("degrades", "#f6c766", "#7d5a12");
pub(super) const FAILS: Tone = Tone {
    text: PAPER,
    ..tone("fails", "#a8320c", "#e2663a")
};

/// The tone of a share of the limit that holds.
pub(super) fn holds(share: f64) -> Tone {
    let [.., (_, last)] = HOLDS;
    HOLDS
        .into_iter()
        .find(|(up_to, _)| share <= *up_to)
        .map_or(last, |(_, tone)| tone)
}

/// The stretch of each tone, for the legend.
pub(super) fn stretches() -> Vec<(Tone, String)> {
    HOLDS
        .iter()
        .map(|(up_to, tone)| {
            let share = match *up_to {
                x if x >= 1.0 => "1".to_owned(),
                x if x > 0.2 => "½".to_owned(),
                x => power(x),
            };
            (*tone, format!("≤ {share}"))
        })
        .collect()
}

fn tones() -> impl Iterator<Item = Tone> {
    let tones = HOLDS.into_iter().map(|(_, tone)| tone);
    tones.chain([DEGRADES, FAILS])
}

/// The grounds of all tones.
pub(super) fn inks() -> Vec<Ink> {
    tones().map(|tone| tone.ground).collect()
}

/// A class for each tone.
pub(super) fn rules() -> String {
    let mut rules = String::new();
    for Tone { ground, text } in tones() {
        let (class, text) = (ground.name, text.name);
        // Writing to a String cannot fail.
        let _ = writeln!(
            rules,
            ".{class}{{background-color:var(--{class});color:var(--{text})}}"
        );
    }
    rules
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of `#rrggbb`.
    fn luminance(css: &str) -> f64 {
        let part = |i| f64::from(u8::from_str_radix(&css[i..i + 2], 16).expect("hex")) / 255.0;
        0.2126 * part(1).powf(2.2) + 0.7152 * part(3).powf(2.2) + 0.0722 * part(5).powf(2.2)
    }

    fn contrast(a: &str, b: &str) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn numbers_are_legible_and_tones_in_order() {
        let tones: Vec<Tone> = HOLDS.iter().map(|(_, tone)| *tone).collect();
        for tone in tones.iter().chain([&DEGRADES, &FAILS]) {
            assert!(
                contrast(tone.ground.light, tone.text.light) > 4.5,
                "{tone:?}"
            );
            assert!(contrast(tone.ground.dark, tone.text.dark) > 4.5, "{tone:?}");
        }
        for pair in tones.windows(2) {
            assert!(contrast(pair[0].ground.light, pair[1].ground.light) > 1.1);
            assert!(contrast(pair[0].ground.dark, pair[1].ground.dark) > 1.1);
            assert!(luminance(pair[0].ground.light) > luminance(pair[1].ground.light));
            assert!(luminance(pair[0].ground.dark) < luminance(pair[1].ground.dark));
        }
        assert_eq!(holds(0.0).ground.name, "h0");
        assert_eq!(holds(0.3).ground.name, "h3");
        assert_eq!(holds(1.0).ground.name, "h4");
        assert_eq!(holds(f64::NAN).ground.name, "h4");
    }
}
