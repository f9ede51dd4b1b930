//! The colours. Charts are drawn once, in fixed marker colours; a style sheet
//! made here turns each marker into the colour of its role in light, dark and
//! print.
//!
//! Data colours are those of Okabe and Ito, told apart by the colour-blind;
//! the three phases also differ in lightness, for grey prints.

use std::fmt::Write as _;

use plotters::style::RGBColor;

/// A role on the page and its colours.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ink {
    /// The name of the style sheet's variable.
    name: &'static str,
    /// The colour charts are drawn in, unique to the role.
    marker: RGBColor,
    light: &'static str,
    dark: &'static str,
}

const fn ink(
    name: &'static str,
    marker: (u8, u8, u8),
    light: &'static str,
    dark: &'static str,
) -> Ink {
    Ink {
        name,
        marker: RGBColor(marker.0, marker.1, marker.2),
        light,
        dark,
    }
}

impl Ink {
    pub(crate) fn marker(&self) -> RGBColor {
        self.marker
    }

    /// The marker as an attribute's value, which the style sheet finds.
    pub(crate) fn hex(&self) -> String {
        let RGBColor(r, g, b) = self.marker;
        format!("#{r:02X}{g:02X}{b:02X}")
    }
}

/// Text in charts.
pub(crate) const TEXT: Ink = ink("text", (0x22, 0x22, 0x21), "#1f2428", "#e6e8ea");
/// Axis lines and ticks.
pub(crate) const AXIS: Ink = ink("axis", (0x88, 0x88, 0x81), "#7b838a", "#8b949c");
/// Grid lines, over shading.
pub(crate) const GRID: Ink = ink("grid", (0xDD, 0xDD, 0xD1), "#0000001c", "#ffffff1f");
/// The paper behind a marker.
pub(crate) const PAPER: Ink = ink("paper", (0xFF, 0xFF, 0xF1), "#ffffff", "#15181b");
/// The torque.
pub(crate) const TORQUE: Ink = ink("torque", (0x11, 0x11, 0x31), "#16161d", "#f4f4f6");
/// The range of the torque in an overview.
pub(crate) const RANGE: Ink = ink("range", (0x99, 0xAA, 0xB1), "#c8d5e0", "#3d4b57");
/// Torque levels.
pub(crate) const LEVEL: Ink = ink("level", (0x55, 0x55, 0x51), "#454d54", "#b4bcc4");
/// The shaft.
pub(crate) const SHAFT: Ink = ink("shaft", (0xD5, 0x5E, 0x01), "#c95000", "#f2933f");
/// The imaginary object; the angle in the overview.
pub(crate) const OBJECT: Ink = ink("object", (0x01, 0x72, 0xB2), "#0072b2", "#56b4e9");
/// What the encoder says.
pub(crate) const ENCODER: Ink = ink("encoder", (0xCC, 0x79, 0xA7), "#c07ba0", "#d79dbd");
/// Stick.
pub(crate) const STICK: Ink = ink("stick", (0xA9, 0xA9, 0xC1), "#bcc3d3", "#636d80");
/// Slip towards growing angle.
pub(crate) const SLIP_POSITIVE: Ink =
    ink("slip-positive", (0xD9, 0xEE, 0xF9), "#e3f2fb", "#12303f");
/// Slip towards falling angle.
pub(crate) const SLIP_NEGATIVE: Ink =
    ink("slip-negative", (0xFC, 0xE2, 0xC1), "#fbd9ae", "#5a3c14");
/// Frequency bands, every second one.
pub(crate) const BAND: Ink = ink("band", (0xEE, 0xEE, 0xE1), "#eef1f4", "#20262b");

/// Curves of one diagram, in the order in which they are given out: those of
/// Okabe and Ito, the pale ones darker on white paper.
pub(crate) const CURVES: [Ink; 8] = [
    ink("vermillion", (0xD5, 0x5E, 0x03), "#d55e00", "#f0803c"),
    ink("sky", (0x56, 0xB4, 0xE3), "#3a9bd3", "#7cc8f2"),
    ink("green", (0x00, 0x9E, 0x73), "#009068", "#2fc29a"),
    ink("purple", (0xCC, 0x79, 0xA3), "#bb5a94", "#dd93bd"),
    ink("yellow", (0xF0, 0xE4, 0x43), "#a39300", "#f0e442"),
    ink("black", (0x01, 0x01, 0x03), "#16161d", "#f4f4f6"),
    ink("orange", (0xE6, 0x9F, 0x03), "#cf8c00", "#e69f00"),
    ink("blue", (0x03, 0x72, 0xB3), "#0067a8", "#4a90e2"),
];

const PAGE: [Ink; 14] = [
    TEXT,
    AXIS,
    GRID,
    PAPER,
    TORQUE,
    RANGE,
    LEVEL,
    SHAFT,
    OBJECT,
    ENCODER,
    STICK,
    SLIP_POSITIVE,
    SLIP_NEGATIVE,
    BAND,
];

/// A variable of a style sheet: its name and its colours.
#[derive(Clone, Debug)]
pub(crate) struct Variable {
    pub(crate) name: String,
    pub(crate) light: &'static str,
    pub(crate) dark: &'static str,
}

/// The variable of every role.
fn variables() -> Vec<Variable> {
    let inks = PAGE.iter().chain(&CURVES);
    inks.map(|ink| Variable {
        name: ink.name.to_owned(),
        light: ink.light,
        dark: ink.dark,
    })
    .collect()
}

/// The rules that turn markers of charts into colours.
fn chart_rules() -> String {
    let mut rules = String::new();
    for ink in PAGE.iter().chain(&CURVES) {
        let (name, marker) = (ink.name, ink.hex());
        // Writing to a String cannot fail.
        let _ = writeln!(
            rules,
            "svg [fill=\"{marker}\"]{{fill:var(--{name})}}\
             svg [stroke=\"{marker}\"]{{stroke:var(--{name})}}"
        );
    }
    rules
}

/// The style sheet of a page: variables for light and dark, and the rules that
/// apply them. Print is always light.
pub(crate) fn style() -> String {
    let mut rules = chart_rules();
    for Ink { name, .. } in PAGE.iter().chain(&CURVES) {
        let _ = writeln!(
            rules,
            ".swatch-{name}{{background:var(--{name})}}.line-{name}{{border-color:var(--{name})}}"
        );
    }
    let (mut light, mut dark) = (String::new(), String::new());
    for variable in variables() {
        let name = &variable.name;
        let _ = write!(light, "--{name}:{};", variable.light);
        let _ = write!(dark, "--{name}:{};", variable.dark);
    }
    format!(
        ":root{{{light}}}\n\
         @media screen and (prefers-color-scheme:dark){{:root{{{dark}}}}}\n{rules}"
    )
}

/// The style sheet of a picture: what `rules` and the charts ask for, with the
/// colours themselves in place of variables, which only browsers know; and the
/// same in dark for those.
pub(crate) fn picture_style(rules: &str, more: &[Variable]) -> String {
    let rules = chart_rules() + rules;
    let mut variables = variables();
    variables.extend_from_slice(more);
    let with = |colour: fn(&Variable) -> &'static str| {
        variables.iter().fold(rules.clone(), |rules, variable| {
            rules.replace(&format!("var(--{})", variable.name), colour(variable))
        })
    };
    format!(
        "{}\n@media screen and (prefers-color-scheme:dark){{{}}}\n",
        with(|variable| variable.light),
        with(|variable| variable.dark)
    )
}

/// The marker of the role with this name, as an attribute's value.
pub(crate) fn marker_of(name: &str) -> String {
    let inks = PAGE.iter().chain(&CURVES);
    inks.clone()
        .find(|ink| ink.name == name)
        .unwrap_or(&TEXT)
        .hex()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_role_has_its_own_marker() {
        let all: Vec<&Ink> = PAGE.iter().chain(&CURVES).collect();
        for (i, a) in all.iter().enumerate() {
            for b in all.iter().skip(i + 1) {
                assert_ne!(a.marker, b.marker, "{} and {}", a.name, b.name);
                assert_ne!(a.name, b.name);
            }
        }
    }

    /// Relative luminance of `#rrggbb`.
    fn luminance(css: &str) -> f64 {
        let part = |i| f64::from(u8::from_str_radix(&css[i..i + 2], 16).expect("hex")) / 255.0;
        0.2126 * part(1).powf(2.2) + 0.7152 * part(3).powf(2.2) + 0.0722 * part(5).powf(2.2)
    }

    #[test]
    fn phases_differ_in_lightness() {
        for pick in [|i: &Ink| i.light, |i: &Ink| i.dark] {
            let phases = [STICK, SLIP_POSITIVE, SLIP_NEGATIVE].map(|i| luminance(pick(&i)));
            for (a, b) in [(0, 1), (0, 2), (1, 2)] {
                let (low, high) = (phases[a].min(phases[b]), phases[a].max(phases[b]));
                assert!((high + 0.05) / (low + 0.05) > 1.15, "{phases:?}");
            }
        }
    }
}
