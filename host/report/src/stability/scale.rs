//! The colours of verdicts. Darker on light paper, and brighter on dark, is
//! nearer to trouble: a sequential blue for what holds, by how much of its
//! limit it takes up, then two colours of their own.

use std::fmt::Write as _;

use crate::number::power;
use crate::palette::Variable;

/// A colour of a cell, as a class of the style sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tone {
    pub(super) class: &'static str,
    /// Ground and text.
    light: (&'static str, &'static str),
    dark: (&'static str, &'static str),
}

const fn tone(
    class: &'static str,
    light: (&'static str, &'static str),
    dark: (&'static str, &'static str),
) -> Tone {
    Tone { class, light, dark }
}

const INK: &str = "#1f2428";
const CHALK: &str = "#eef0f2";

/// What holds, up to this share of the limit.
pub(super) const HOLDS: [(f64, Tone); 5] = [
    (1e-4, tone("h0", ("#f0f7fc", INK), ("#15232c", CHALK))),
    (1e-2, tone("h1", ("#d6eaf6", INK), ("#16323f", CHALK))),
    (0.1, tone("h2", ("#b0d6ee", INK), ("#174355", CHALK))),
    (0.5, tone("h3", ("#82bde2", INK), ("#19566f", CHALK))),
    (1.0, tone("h4", ("#559fd0", INK), ("#1b6a8c", CHALK))),
];
pub(super) const DEGRADES: Tone = tone("degrades", ("#f6c766", INK), ("#7d5a12", "#fff3d8"));
pub(super) const FAILS: Tone = tone("fails", ("#a8320c", "#ffffff"), ("#e2663a", "#140a06"));

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

/// Ground and text of every tone.
pub(super) fn variables() -> Vec<Variable> {
    tones()
        .flat_map(|tone| {
            let ground = Variable {
                name: tone.class.to_owned(),
                light: tone.light.0,
                dark: tone.dark.0,
            };
            let text = Variable {
                name: format!("on-{}", tone.class),
                light: tone.light.1,
                dark: tone.dark.1,
            };
            [ground, text]
        })
        .collect()
}

/// The classes.
pub(super) fn rules() -> String {
    let mut rules = String::new();
    for Tone { class, .. } in tones() {
        // Writing to a String cannot fail.
        let _ = writeln!(
            rules,
            ".{class}{{background-color:var(--{class});color:var(--on-{class});fill:var(--{class})}}\
             text.on-{class}{{fill:var(--on-{class})}}path.on-{class}{{fill:var(--on-{class})}}"
        );
    }
    rules
}

/// The style sheet: variables for light and dark, and the classes. Print is
/// always light.
pub(super) fn style() -> String {
    let (mut light, mut dark) = (String::new(), String::new());
    for variable in variables() {
        let name = &variable.name;
        let _ = write!(light, "--{name}:{};", variable.light);
        let _ = write!(dark, "--{name}:{};", variable.dark);
    }
    format!(
        ":root{{{light}}}\n@media screen and (prefers-color-scheme:dark){{:root{{{dark}}}}}\n{}",
        rules()
    )
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
            assert!(contrast(tone.light.0, tone.light.1) > 4.5, "{tone:?}");
            assert!(contrast(tone.dark.0, tone.dark.1) > 4.5, "{tone:?}");
        }
        for pair in tones.windows(2) {
            assert!(contrast(pair[0].light.0, pair[1].light.0) > 1.1);
            assert!(contrast(pair[0].dark.0, pair[1].dark.0) > 1.1);
            assert!(luminance(pair[0].light.0) > luminance(pair[1].light.0));
            assert!(luminance(pair[0].dark.0) < luminance(pair[1].dark.0));
        }
        assert_eq!(holds(0.0).class, "h0");
        assert_eq!(holds(0.3).class, "h3");
        assert_eq!(holds(1.0).class, "h4");
        assert_eq!(holds(f64::NAN).class, "h4");
    }
}
