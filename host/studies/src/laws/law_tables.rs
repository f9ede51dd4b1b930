//! `leaderboard.csv`: one row a law, joint and quantity. `costs.csv`: one row a law. Numbers read
//! back to the same bits; what is not known is `nan`.

use super::costs::{Costs, StepTime};
use super::row::Row;
use crepitus_pages::table::{Table, show};

fn known(number: Option<f64>) -> f64 {
    number.unwrap_or(f64::NAN)
}

/// A row for each [`Row`].
pub fn leaderboard_table(rows: &[Row]) -> Table<'_, Row> {
    Table::of(rows)
        .column("law", |row| row.law)
        .column("joint", |row| row.joint)
        .column("task", |row| row.task)
        .column("quantity", |row| row.quantity)
        .column("unit", |row| row.unit)
        .column("demanded", |row| row.demanded)
        .column("scale", |row| row.scale)
        .column("value", |row| known(row.value))
        .column("converged", |row| known(row.converged))
        .column("refinement", |row| known(row.refinement))
        .column("settled", |row| row.is_settled)
        .column("parts", |row| row.parts)
        .column("model_error", |row| known(row.model_error))
        .column("numerical_error", |row| known(row.numerical_error))
        .column("relative_error", |row| known(row.relative_error))
        .column("failed", |row| row.failed.unwrap_or(""))
        .column("converged_failed", |row| row.converged_failed.unwrap_or(""))
}

/// A row for each law.
pub fn costs_table(costs: &[Costs]) -> Table<'_, Costs> {
    let ns = |time: &Option<StepTime>| known(time.map(|time| time.ns));
    let spread = |time: &Option<StepTime>| known(time.map(|time| time.spread));
    Table::of(costs)
        .column("law", |c| c.law)
        .headed("law")
        .column("bytes", |c| c.bytes)
        .headed("bytes")
        .column("repeats", |c| c.repeats)
        .group("grating")
        .column("grating_ns_per_step", move |c| ns(&c.grating))
        .headed("ns")
        .rounded(show::fixed::<1>)
        .column("grating_spread", move |c| spread(&c.grating))
        .headed("± %")
        .rounded(show::scaled::<50, 1>)
        .group("knee")
        .column("knee_ns_per_step", move |c| ns(&c.knee))
        .headed("ns")
        .rounded(show::fixed::<1>)
        .column("knee_spread", move |c| spread(&c.knee))
        .headed("± %")
        .rounded(show::scaled::<50, 1>)
        .group("cycles on the controller")
        .column("mean_cycles", |c| {
            known(c.controller.map(|cost| cost.mean_cycles))
        })
        .headed("mean")
        .rounded(show::fixed::<0>)
        .column("worst_cycles", |c| {
            known(c.controller.map(|cost| cost.worst_cycles.into()))
        })
        .headed("worst")
        .rounded(show::fixed::<0>)
        .group("instructions there")
        .column("mean_instructions", |c| {
            known(c.controller.map(|cost| cost.mean_instructions))
        })
        .headed("mean")
        .rounded(show::fixed::<0>)
        .column("worst_instructions", |c| {
            known(c.controller.map(|cost| cost.worst_instructions.into()))
        })
        .headed("worst")
        .rounded(show::fixed::<0>)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::task::Use;

    #[test]
    fn rows_read_back_and_what_is_not_known_is_nan() {
        let row = Row {
            law: "a",
            joint: "coarse",
            task: "creep",
            quantity: "creep",
            unit: "1",
            of: Use::Rest,
            demanded: 0.0,
            scale: 1.0,
            value: Some(0.1 + 0.2),
            converged: None,
            refinement: None,
            is_settled: false,
            parts: 16,
            model_error: None,
            numerical_error: None,
            relative_error: Some(0.1 + 0.2),
            failed: None,
            converged_failed: Some("diverges"),
        };
        let text = leaderboard_table(std::slice::from_ref(&row)).to_csv();
        let mut lines = text.lines();
        let header: Vec<_> = lines.next().unwrap().split(',').collect();
        let cells: Vec<_> = lines.next().unwrap().split(',').collect();
        assert_eq!(header.len(), cells.len());
        let cell = |name| cells[header.iter().position(|h| *h == name).unwrap()];
        assert_eq!(cell("value").parse(), Ok(0.1 + 0.2));
        assert!(cell("converged").parse::<f64>().unwrap().is_nan());
        assert_eq!((cell("failed"), cell("converged_failed")), ("", "diverges"));
    }
}
