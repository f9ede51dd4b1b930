//! A table on a page.

use crate::table::show::superscript;
use crate::table::{Column, Table, groups};
use maud::{Markup, html};

impl<R> Table<'_, R> {
    /// The columns that have a heading, rounded, as a `table` element. The
    /// first is the heading of its row; cells of numbers have the class
    /// `number`, headings of groups `group`, remarks `remark`.
    pub fn to_html(&self) -> Markup {
        let columns: Vec<_> = self.for_people().collect();
        html! {
            table.grid {
                thead {
                    @if columns.iter().any(|(_, column)| !column.group.is_empty()) {
                        tr {
                            @for (heading, count) in groups(&columns) {
                                th.group colspan=(count) scope="colgroup" { (heading) }
                            }
                        }
                    }
                    tr {
                        @for (heading, column) in &columns {
                            th.number[column.right] scope="col" { (heading) }
                        }
                    }
                }
                tbody { @for row in 0..self.rows.len() { (self.line(&columns, row)) } }
            }
        }
    }

    fn line(&self, columns: &[(&str, &Column)], row: usize) -> Markup {
        let remark = self.remark_of(row);
        let kept = remark.map_or(columns.len(), |(from, _)| from);
        html! {
            tr {
                @for (place, (_, column)) in columns.iter().take(kept).enumerate() {
                    @if place == 0 { th scope="row" { (column.text(row)) } }
                    @else if column.right { td.number { (typeset(&column.text(row))) } }
                    @else { td { (column.text(row)) } }
                }
                @if let Some((_, text)) = remark {
                    td.remark colspan=(columns.len().saturating_sub(kept)) { (text) }
                }
            }
        }
    }
}

/// A number as on paper: −2.7·10⁻⁷ for `-2.7e-7`; anything else as it is.
fn typeset(text: &str) -> String {
    let minus = |number: &str| number.replace('-', "\u{2212}");
    match text.split_once('e') {
        Some((mantissa, exponent)) if is_number(mantissa) && is_number(exponent) => {
            let raised: String = exponent.chars().map(superscript).collect();
            format!("{}·10{raised}", minus(mantissa))
        }
        _ if is_number(text) => minus(text),
        _ => text.to_owned(),
    }
}

fn is_number(text: &str) -> bool {
    text.ends_with(|c: char| c.is_ascii_digit()) && text.parse::<f64>().is_ok()
}
