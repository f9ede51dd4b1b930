//! Where the energy of a plant came from and where it went, as bars.

use plotters::element::{Rectangle, Text};
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, VPos};

use crate::ReportError;
use crate::balance::{Account, Balance};
use crate::canvas::{Area, Fault, px, svg, text_style};
use crate::collector::Figures;
use crate::figure::{Chart, Figure, Key, Sign};
use crate::number::rounded;
use crate::palette::{AXIS, CURVES, Ink, OBJECT, TEXT, TORQUE};

/// CSS pixels.
const WIDTH: u32 = 960;
const HEAD: u32 = 34;
const ROW: u32 = 27;
const BAR: u32 = 17;
/// Where bars begin, and where the longest ends.
const LEFT: u32 = 250;
const RIGHT: u32 = 850;

/// Terms below this share of the whole are one bar together.
const SMALL: f64 = 0.002;

/// What each account is drawn in, with its name in the style sheet.
fn ink(account: Account) -> (&'static str, Ink) {
    match account {
        Account::Given => ("object", OBJECT),
        Account::Stored => ("green", CURVES[2]),
        Account::Lost => ("vermillion", CURVES[0]),
        Account::Rendered => ("torque", TORQUE),
    }
}

#[derive(Debug, PartialEq)]
struct Bar {
    name: String,
    joule: f64,
    /// None of one that stands for several.
    account: Option<Account>,
}

pub(crate) fn figure(figures: &Figures) -> Result<Option<Figure>, ReportError> {
    let Some(balance) = &figures.balance else {
        return Ok(None);
    };
    let (from, to) = (bars(balance, 1.0), bars(balance, -1.0));
    let total: f64 = from.iter().map(|bar| bar.joule).sum();
    if total.is_nan() || total <= 0.0 || to.is_empty() {
        return Ok(None);
    }
    let rows = u32::try_from(from.len() + to.len()).unwrap_or(0);
    let svg = svg(
        (WIDTH, 2 * HEAD + rows * ROW + 8),
        "Where the energy came from and where it went",
        |area| {
            let longest = from
                .iter()
                .chain(&to)
                .map(|bar| bar.joule)
                .fold(0.0, f64::max);
            let next = group(area, 0, "It came from", &from, longest)?;
            group(area, next, "It went to", &to, longest).map(|_| ())
        },
    )?;
    let small = if from.iter().chain(&to).any(|bar| bar.account.is_none()) {
        format!(
            " Terms of less than {} % are one bar; the table below has all.",
            rounded(1e2 * SMALL)
        )
    } else {
        String::new()
    };
    let drawn = |account| {
        from.iter()
            .chain(&to)
            .any(|bar| bar.account == Some(account))
    };
    let legend = Account::ALL
        .into_iter()
        .filter(|account| drawn(*account))
        .map(|account| Key::new(Sign::Patch(ink(account).0), words(account)))
        .collect();
    Ok(Some(Figure {
        name: "energy",
        title: "Where the energy went",
        legend,
        charts: vec![Chart {
            heading: None,
            svg,
            half: false,
        }],
        caption: format!(
            "Over the whole run {} mJ came in and went out. Both halves are on one scale and have \
             the same sum: what a part stored at the start and no longer holds at the end came \
             from it, what was given to the plant and taken back went there.{small}",
            rounded(1e3 * total),
        ),
    }))
}

fn words(account: Account) -> &'static str {
    match account {
        Account::Given => "work from outside",
        Account::Stored => "stored",
        Account::Lost => "lost as heat",
        Account::Rendered => "rendered: taken out by the actuator",
    }
}

/// The terms of one direction, 1 in and −1 out, largest first.
fn bars(balance: &Balance, direction: f64) -> Vec<Bar> {
    let mut bars: Vec<Bar> = balance
        .terms
        .iter()
        .map(|term| Bar {
            name: term.name(),
            joule: direction * term.inflow_j(),
            account: Some(term.account),
        })
        .filter(|bar| bar.joule > 0.0)
        .collect();
    bars.sort_by(|a, b| b.joule.total_cmp(&a.joule));
    let total: f64 = bars.iter().map(|bar| bar.joule).sum();
    let large = bars
        .iter()
        .take_while(|bar| bar.joule >= SMALL * total)
        .count();
    if bars.len() > large + 1 {
        let rest = bars.split_off(large);
        bars.push(Bar {
            name: format!("{} smaller terms", rest.len()),
            joule: rest.iter().map(|bar| bar.joule).sum(),
            account: None,
        });
    }
    bars
}

/// Draws a heading and its bars, and says where the next heading goes.
fn group(area: &Area, top: u32, heading: &str, bars: &[Bar], longest: f64) -> Result<u32, Fault> {
    let text = |x: u32, y: u32, words: String, side| {
        let style = text_style(TEXT, side, VPos::Center);
        area.draw(&Text::new(words, (at(x), at(y)), style))
    };
    text(4, top + HEAD / 2 + 2, heading.to_owned(), HPos::Left)?;
    for (i, bar) in (0..).zip(bars) {
        let y = top + HEAD + i * ROW;
        let middle = y + ROW / 2;
        text(LEFT - 10, middle, bar.name.clone(), HPos::Right)?;
        let ink = bar.account.map_or(AXIS, |account| ink(account).1);
        let length = bar.joule / longest * f64::from(px(RIGHT - LEFT));
        // At most the width of the picture.
        #[allow(clippy::cast_possible_truncation)]
        let end = at(LEFT) + length.round().max(1.0) as i32;
        let edge = (ROW - BAR) / 2;
        area.draw(&Rectangle::new(
            [(at(LEFT), at(y + edge)), (end, at(y + edge + BAR))],
            ink.marker().filled(),
        ))?;
        let style = text_style(TEXT, HPos::Left, VPos::Center);
        let value = format!("{} mJ", rounded(1e3 * bar.joule));
        area.draw(&Text::new(value, (end + at(8), at(middle)), style))?;
    }
    let rows = u32::try_from(bars.len()).unwrap_or(0);
    Ok(top + HEAD + rows * ROW)
}

fn at(pixels: u32) -> i32 {
    i32::try_from(px(pixels)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::balance::Term;

    #[test]
    fn both_halves_have_the_same_sum() {
        let term = |effect: &str, account, joule| Term {
            effect: effect.to_owned(),
            what: "x".to_owned(),
            account,
            joule,
        };
        let balance = Balance {
            terms: vec![
                term("hand", Account::Given, -1.0),
                term("motor", Account::Given, 5.0),
                term("limb", Account::Stored, -3.0),
                term("gear", Account::Lost, 6.998),
                term("cuff", Account::Lost, 0.001),
                term("actuator", Account::Rendered, 0.001),
            ],
            residual_j: 0.0,
            residual_relative: 0.0,
        };
        let (from, to) = (bars(&balance, 1.0), bars(&balance, -1.0));
        let sum = |bars: &[Bar]| bars.iter().map(|bar| bar.joule).sum::<f64>();
        assert!((sum(&from) - 8.0).abs() < 1e-12);
        assert!((sum(&to) - 8.0).abs() < 1e-12);
        let names: Vec<&str> = to.iter().map(|bar| bar.name.as_str()).collect();
        assert_eq!(names, ["gear: x", "hand: x", "2 smaller terms"]);
        assert_eq!(from[1].account, Some(Account::Stored));
    }
}
