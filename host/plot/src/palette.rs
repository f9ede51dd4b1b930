//! The colours. An element carries the colour of its role on light paper, so
//! that any program shows it; a style sheet made here replaces that by the
//! colour of the role in dark.
//!
//! Data colours are those of Okabe and Ito, distinguishable for the colour-blind;
//! the three phases also differ in lightness, for grey prints.

use std::fmt::Write as _;

use maud::Render;

/// A role on the page and its colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ink {
    /// The name of the style sheet's variable.
    pub name: &'static str,
    /// On light paper, and in print: `#rrggbb`, of one ink only, unless the
    /// dark colours are the same, too.
    pub light: &'static str,
    /// On dark paper.
    pub dark: &'static str,
}

impl Ink {
    /// A role with its colours.
    pub const fn new(name: &'static str, light: &'static str, dark: &'static str) -> Self {
        Self { name, light, dark }
    }
}

/// As the value of an attribute.
impl Render for Ink {
    fn render_to(&self, out: &mut String) {
        out.push_str(self.light);
    }
}

/// Text in charts.
pub const TEXT: Ink = Ink::new("text", "#1f2428", "#e6e8ea");
/// Axis lines and ticks.
pub const AXIS: Ink = Ink::new("axis", "#7b838a", "#8b949c");
/// Grid lines, over shading; they let it show through.
pub const GRID: Ink = Ink::new("grid", "#000000", "#ffffff");
/// The paper behind a marker.
pub const PAPER: Ink = Ink::new("paper", "#ffffff", "#15181b");
/// The torque.
pub const TORQUE: Ink = Ink::new("torque", "#16161d", "#f4f4f6");
/// The range of the torque in an overview.
pub const RANGE: Ink = Ink::new("range", "#c8d5e0", "#3d4b57");
/// Torque levels.
pub const LEVEL: Ink = Ink::new("level", "#454d54", "#b4bcc4");
/// The shaft.
pub const SHAFT: Ink = Ink::new("shaft", "#c95000", "#f2933f");
/// The imaginary object; the angle in the overview.
pub const OBJECT: Ink = Ink::new("object", "#0072b2", "#56b4e9");
/// Encoder data.
pub const ENCODER: Ink = Ink::new("encoder", "#c07ba0", "#d79dbd");
/// Stick.
pub const STICK: Ink = Ink::new("stick", "#bcc3d3", "#636d80");
/// Slip towards growing angle.
pub const SLIP_POSITIVE: Ink = Ink::new("slip-positive", "#e3f2fb", "#12303f");
/// Slip towards falling angle.
pub const SLIP_NEGATIVE: Ink = Ink::new("slip-negative", "#fbd9ae", "#5a3c14");
/// Frequency bands, every second one.
pub const BAND: Ink = Ink::new("band", "#eef1f4", "#20262b");

/// Curves of one diagram, in the order in which they are given out: those of
/// Okabe and Ito, the pale ones darker on white paper.
pub const CURVES: [Ink; 8] = [
    Ink::new("vermillion", "#d55e00", "#f0803c"),
    Ink::new("sky", "#3a9bd3", "#7cc8f2"),
    Ink::new("green", "#009068", "#2fc29a"),
    Ink::new("purple", "#bb5a94", "#dd93bd"),
    Ink::new("yellow", "#a39300", "#f0e442"),
    Ink::new("black", "#16161d", "#f4f4f6"),
    Ink::new("orange", "#cf8c00", "#e69f00"),
    Ink::new("blue", "#0067a8", "#4a90e2"),
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

/// The variables of all roles, and of more, for light and dark, and the rules
/// that apply them to charts. Print is always light.
pub(crate) fn style(more: &[Ink]) -> String {
    let (mut light, mut dark, mut rules) = (String::new(), String::new(), String::new());
    // Writing to a String cannot fail.
    for ink in PAGE.iter().chain(&CURVES).chain(more) {
        let Ink {
            name,
            light: on_light,
            dark: on_dark,
        } = ink;
        let _ = write!(light, "--{name}:{on_light};");
        let _ = write!(dark, "--{name}:{on_dark};");
        rules += &recolour(ink, &format!("var(--{name},{on_light})"));
    }
    format!(
        ":root{{{light}}}\n@media screen and (prefers-color-scheme:dark){{:root{{{dark}}}}}\n{rules}"
    )
}

/// The style sheet of a picture: the inks that it has in dark, for programs
/// that know about it.
pub(crate) fn picture_style(body: &str, more: &[Ink]) -> String {
    let inks = PAGE.iter().chain(&CURVES).chain(more);
    let used = inks.filter(|ink| body.contains(&format!("\"{}\"", ink.light)));
    let rules: String = used.map(|ink| recolour(ink, ink.dark)).collect();
    format!("@media screen and (prefers-color-scheme:dark){{{rules}}}")
}

fn recolour(Ink { light, .. }: &Ink, colour: &str) -> String {
    format!("svg [fill=\"{light}\"]{{fill:{colour}}}svg [stroke=\"{light}\"]{{stroke:{colour}}}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_colour_says_its_role() {
        let all: Vec<&Ink> = PAGE.iter().chain(&CURVES).collect();
        for (i, a) in all.iter().enumerate() {
            assert!(a.light.len() == 7 && a.dark.len() == 7, "{}", a.name);
            for b in all.iter().skip(i + 1) {
                assert_ne!(a.name, b.name);
                assert!(
                    a.light != b.light || a.dark == b.dark,
                    "{} and {}",
                    a.name,
                    b.name
                );
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
