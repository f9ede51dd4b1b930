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
    /// Colour on light paper, and in print: `#rrggbb`, of one ink only, unless the
    /// dark colours are the same, too.
    pub light: &'static str,
    /// Colour on dark paper.
    pub dark: &'static str,
    /// Colour in a paper: lines that stand together differ in lightness, too.
    pub print: &'static str,
}

impl Ink {
    /// A role with its colours.
    pub const fn new(name: &'static str, light: &'static str, dark: &'static str) -> Self {
        Self {
            name,
            light,
            dark,
            print: light,
        }
    }

    /// The role with another colour in a paper.
    const fn in_print(self, print: &'static str) -> Self {
        Self { print, ..self }
    }
}

/// Writes the light colour as the value of an attribute.
impl Render for Ink {
    fn render_to(&self, out: &mut String) {
        out.push_str(self.light);
    }
}

/// Lines that are distinguished by colour alone, in a paper, from dark to light: blue, vermillion,
/// green and purple of Okabe and Ito at lightnesses (CIELAB) of 27, 44, 58 and 71, beside black
/// at 7. So they differ in grey, and to those who see no difference between red and green.
const PRINTED: [&str; 4] = ["#004078", "#b34600", "#2a9d79", "#dd98c2"];

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
pub const SHAFT: Ink = Ink::new("shaft", "#c95000", "#f2933f").in_print(PRINTED[1]);
/// The imaginary object; the angle in the overview.
pub const OBJECT: Ink = Ink::new("object", "#0072b2", "#56b4e9").in_print(PRINTED[0]);
/// The torque of the motor; in a paper darker than the shading that it is drawn on.
pub const MOTOR: Ink = Ink::new("motor", "#ba5993", "#dc92bc").in_print("#a8437f");
/// Encoder data.
pub const ENCODER: Ink = Ink::new("encoder", "#c07ba0", "#d79dbd").in_print(PRINTED[3]);
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
    Ink::new("vermillion", "#d55e00", "#f0803c").in_print(PRINTED[1]),
    Ink::new("sky", "#3a9bd3", "#7cc8f2"),
    Ink::new("green", "#009068", "#2fc29a").in_print(PRINTED[2]),
    Ink::new("purple", "#bb5a94", "#dd93bd").in_print(PRINTED[3]),
    Ink::new("yellow", "#a39300", "#f0e442"),
    Ink::new("black", "#16161d", "#f4f4f6"),
    Ink::new("orange", "#cf8c00", "#e69f00").in_print("#e9b04a"),
    Ink::new("blue", "#0067a8", "#4a90e2").in_print(PRINTED[0]),
];

const PAGE: [Ink; 15] = [
    TEXT,
    AXIS,
    GRID,
    PAPER,
    TORQUE,
    RANGE,
    LEVEL,
    SHAFT,
    OBJECT,
    MOTOR,
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
            ..
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

/// A picture with the inks of a paper in place of those on light paper.
pub(crate) fn printed(svg: &str) -> String {
    let inks = PAGE.iter().chain(&CURVES);
    inks.filter(|ink| ink.print != ink.light)
        .fold(svg.to_owned(), |svg, ink| {
            svg.replace(&format!("\"{}\"", ink.light), &format!("\"{}\"", ink.print))
        })
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

    /// Linear RGB of `#rrggbb`, by the sRGB standard.
    fn linear(css: &str) -> [f64; 3] {
        [1, 3, 5].map(|i| {
            let part = f64::from(u8::from_str_radix(&css[i..i + 2], 16).expect("hex")) / 255.0;
            if part <= 0.040_45 {
                part / 12.92
            } else {
                ((part + 0.055) / 1.055).powf(2.4)
            }
        })
    }

    fn times(matrix: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
        matrix.map(|row| (0..3).map(|i| row[i] * v[i]).sum())
    }

    /// CIELAB under D65.
    fn lab(rgb: [f64; 3]) -> [f64; 3] {
        let xyz = times(
            [
                [0.4124, 0.3576, 0.1805],
                [0.2126, 0.7152, 0.0722],
                [0.0193, 0.1192, 0.9505],
            ],
            rgb,
        );
        let f = |t: f64| {
            if t > 0.008_856 {
                t.cbrt()
            } else {
                7.787 * t + 16.0 / 116.0
            }
        };
        let [x, y, z] = [f(xyz[0] / 0.950_47), f(xyz[1]), f(xyz[2] / 1.088_83)];
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// Vision of a dichromat: Machado, Oliveira and Fernandes, "A physiologically-based model for
    /// simulation of color vision deficiency", IEEE TVCG 15(6), 2009, severity 1.
    const DEUTERANOPIA: [[f64; 3]; 3] = [
        [0.367_322, 0.860_646, -0.227_968],
        [0.280_085, 0.672_501, 0.047_413],
        [-0.011_820, 0.042_940, 0.968_881],
    ];
    const PROTANOPIA: [[f64; 3]; 3] = [
        [0.152_286, 1.052_583, -0.204_868],
        [0.114_503, 0.786_281, 0.099_216],
        [-0.003_882, -0.048_116, 1.051_998],
    ];
    const NONE: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    /// Distance (CIE 1976) of two colours as seen.
    fn distance(eye: [[f64; 3]; 3], a: &str, b: &str) -> f64 {
        let seen = |css| lab(times(eye, linear(css)).map(|part| part.clamp(0.0, 1.0)));
        let (a, b) = (seen(a), seen(b));
        (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
    }

    #[test]
    fn lines_in_a_paper_differ_in_grey_and_to_the_colour_blind() {
        let inks: Vec<&str> = [TORQUE.print].into_iter().chain(PRINTED).collect();
        let lightness = |css| lab(linear(css))[0];
        for (i, a) in inks.iter().enumerate() {
            for b in &inks[i + 1..] {
                let grey = lightness(b) - lightness(a);
                assert!(grey > 12.0, "{a}, {b}: {grey}");
                for eye in [NONE, DEUTERANOPIA, PROTANOPIA] {
                    let distance = distance(eye, a, b);
                    assert!(distance > 20.0, "{a}, {b}: {distance}");
                }
            }
            // And from the paper.
            assert!(lightness("#ffffff") - lightness(a) > 25.0, "{a}");
        }
        // And the motor's from the shading of a stick.
        assert!(lightness(STICK.print) - lightness(MOTOR.print) > 25.0);
        // The colours of a screen would not do: red and blue are one grey.
        assert!((lightness(SHAFT.light) - lightness(OBJECT.light)).abs() < 5.0);
        // The matrices keep white.
        for eye in [DEUTERANOPIA, PROTANOPIA] {
            assert!(times(eye, [1.0; 3]).iter().all(|x| (x - 1.0).abs() < 1e-5));
        }
    }

    #[test]
    fn curves_of_a_diagram_differ_in_grey_or_by_dashes_or_signs() {
        use crate::plot::CurveStyle;
        let lightness = |style: CurveStyle| lab(linear(style.ink.print))[0];
        for i in 0..9 {
            for j in i + 1..9 {
                let (a, b) = (CurveStyle::of(i), CurveStyle::of(j));
                let grey = (lightness(a) - lightness(b)).abs();
                assert!(a.dashes != b.dashes || grey > 12.0, "{i}, {j}: {grey}");
                assert!(a.marker != b.marker);
                for eye in [NONE, DEUTERANOPIA, PROTANOPIA] {
                    let distance = distance(eye, a.ink.print, b.ink.print);
                    assert!(
                        a.dashes != b.dashes || distance > 15.0,
                        "{i}, {j}: {distance}"
                    );
                }
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
