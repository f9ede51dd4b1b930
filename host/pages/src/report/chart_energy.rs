//! Energy balance of a plant as bars: where the energy came from and where it went.

use crate::plot::number::rounded;
use crate::plot::palette::{AXIS, CURVES, Ink, OBJECT, TEXT, TORQUE};
use crate::plot::{Anchor, Chart, Drawing, Figure, Key, Sign};

use crate::report::balance_table;
use crate::report::collector::Figures;
use crepitus_plant::energy_balance::Account;
use crepitus_scene::run::PlantEnergySummary;

/// CSS pixels.
const WIDTH: f64 = 960.0;
const HEAD: f64 = 34.0;
const ROW: f64 = 27.0;
const BAR: f64 = 17.0;
/// Start of the bars, and end of the longest.
const LEFT: f64 = 250.0;
const RIGHT: f64 = 850.0;

/// Terms below this share of the whole are one bar together.
const SMALL: f64 = 0.002;

/// Ink of each account.
fn ink(account: Account) -> Ink {
    match account {
        Account::Given => OBJECT,
        Account::Stored => CURVES[2],
        Account::Lost => CURVES[0],
        Account::Rendered => TORQUE,
    }
}

#[derive(Debug, PartialEq)]
struct Bar {
    name: String,
    joule: f64,
    /// None of one that stands for several.
    account: Option<Account>,
}

pub(crate) fn figure(figures: &Figures) -> Option<Figure> {
    let balance = figures.balance.as_ref()?;
    let (from, to) = (bars(balance, 1.0), bars(balance, -1.0));
    let total: f64 = from.iter().map(|bar| bar.joule).sum();
    if total.is_nan() || total <= 0.0 || to.is_empty() {
        return None;
    }
    let longest = from
        .iter()
        .chain(&to)
        .map(|bar| bar.joule)
        .fold(0.0, f64::max);
    let mut drawing = Drawing::default();
    let next = group(&mut drawing, 0.0, "It came from", &from, longest);
    let end = group(&mut drawing, next, "It went to", &to, longest);
    let svg = drawing.svg(
        (WIDTH, end + 8.0),
        "Where the energy came from and where it went",
    );
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
        .map(|account| Key::new(Sign::Patch(ink(account)), words(account)))
        .collect();
    Some(Figure {
        name: "energy",
        title: "Where the energy went",
        legend,
        charts: vec![Chart::full(svg)],
        caption: format!(
            "Over the whole run {} mJ came in and went out. Both halves are on one scale and have \
             the same sum: what a part stored at the start and no longer holds at the end came \
             from it, what was given to the plant and taken back went there.{small}",
            rounded(1e3 * total),
        ),
    })
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
fn bars(balance: &PlantEnergySummary, direction: f64) -> Vec<Bar> {
    let mut bars: Vec<Bar> = balance
        .terms
        .iter()
        .map(|term| Bar {
            name: balance_table::name(term),
            joule: direction * term.account.inflow_j(term.joule),
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

/// Draws a heading and its bars; returns the position of the next heading.
fn group(drawing: &mut Drawing, top: f64, heading: &str, bars: &[Bar], longest: f64) -> f64 {
    drawing.text((4.0, top + HEAD / 2.0 + 2.0), Anchor::Start, TEXT, heading);
    let mut y = top + HEAD;
    for bar in bars {
        let middle = y + ROW / 2.0;
        drawing.text((LEFT - 10.0, middle), Anchor::End, TEXT, &bar.name);
        let end = LEFT + (bar.joule / longest * (RIGHT - LEFT)).max(0.5);
        let corners = [(LEFT, middle - BAR / 2.0), (end, middle + BAR / 2.0)];
        drawing.rectangles([corners], bar.account.map_or(AXIS, ink));
        let value = format!("{} mJ", rounded(1e3 * bar.joule));
        drawing.text((end + 8.0, middle), Anchor::Start, TEXT, &value);
        y += ROW;
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_scene::run::EnergyTerm;

    #[test]
    fn both_halves_have_the_same_sum() {
        let term = |effect, account, joule| EnergyTerm {
            effect,
            what: "x",
            account,
            joule,
        };
        let balance = PlantEnergySummary {
            terms: vec![
                term("hand", Account::Given, -1.0),
                term("motor", Account::Given, 5.0),
                term("limb", Account::Stored, -3.0),
                term("gear", Account::Lost, 6.998),
                term("cuff", Account::Lost, 0.001),
                term("actuator", Account::Rendered, 0.001),
            ],
            ..PlantEnergySummary::default()
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
