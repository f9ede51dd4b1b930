//! Orders of convergence by kind of motion, as a table for the terminal.

use crate::accuracy::orders::{Order, Orders};
use crepitus_pages::table::Table;
use std::fmt::Write;

/// A block a convention, a line a solver, a column a motion; nothing without
/// orders.
pub(super) fn by_motion(orders: &[Orders]) -> String {
    let mut text = String::new();
    for convention in distinct(orders, |o| o.convention) {
        let mine: Vec<&Orders> = orders
            .iter()
            .filter(|o| o.convention == convention)
            .collect();
        let solvers = distinct(mine.iter().copied(), |o| o.solver);
        let mut table = Table::of(&solvers).people("solver", |solver| *solver);
        for motion in distinct(mine.iter().copied(), |o| o.scene.as_str()) {
            let order = |solver: &&str| {
                let here = mine
                    .iter()
                    .find(|o| o.solver == *solver && o.scene == motion);
                here.map(|o| cell(o.event_time_rms))
            };
            table = table.people(motion, order).right();
        }
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            "\n{convention}, order of the event times (root mean square) in f64:\n{}",
            table.to_text()
        );
    }
    text
}

fn cell(order: Order) -> String {
    match order {
        Order::Slope { order, .. } => format!("{order:.1}"),
        Order::RoundOff { .. } => "rounding".to_owned(),
        Order::TooFewPoints { .. } => "wrong events".to_owned(),
    }
}

/// Values of `of` over the orders, each once.
fn distinct<'a, T: PartialEq>(
    orders: impl IntoIterator<Item = &'a Orders>,
    of: impl Fn(&'a Orders) -> T,
) -> Vec<T> {
    let mut all = Vec::new();
    for what in orders.into_iter().map(of) {
        if !all.contains(&what) {
            all.push(what);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_convention_has_its_motions_side_by_side() {
        let of = |scene: &str, convention, solver, event_time_rms| Orders {
            scene: scene.to_owned(),
            convention,
            solver,
            frequency: Order::RoundOff { points: 3 },
            event_time: Order::RoundOff { points: 3 },
            event_time_rms,
        };
        let slope = |order| Order::Slope { order, points: 9 };
        let text = by_motion(&[
            of("steady", "frozen", "exact", slope(1.04)),
            of("sine", "frozen", "exact", slope(0.96)),
            of(
                "steady",
                "physical",
                "exact",
                Order::TooFewPoints { points: 1 },
            ),
            of("steady", "physical", "rk4", Order::RoundOff { points: 3 }),
        ]);
        let lines: Vec<Vec<&str>> = text
            .lines()
            .map(|line| line.split_whitespace().collect())
            .collect();
        assert!(lines.contains(&vec!["solver", "steady", "sine"]), "{text}");
        assert!(lines.contains(&vec!["exact", "1.0", "1.0"]), "{text}");
        assert!(lines.contains(&vec!["exact", "wrong", "events"]), "{text}");
        assert!(lines.contains(&vec!["rk4", "rounding"]), "{text}");
        assert_eq!(by_motion(&[]), "");
    }
}
