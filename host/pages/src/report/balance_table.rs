//! The energy balance of a plant as a table: a term a row, an account a
//! column.

use crate::plot::page::scrolling;
use maud::{Markup, html};

use crate::plot::number::{fixed, scientific};
use crepitus_plant::energy_balance::Account;
use crepitus_scene::run::{EnergyTerm, PlantEnergySummary};

/// Style sheet of the table.
pub(crate) const STYLE: &str = include_str!("balance_table.css");

/// Name of a term.
pub(crate) fn name(term: &EnergyTerm) -> String {
    format!("{}: {}", term.effect, term.what)
}

/// The sum of an account; none if nothing was ever booked there.
fn sum_j(balance: &PlantEnergySummary, account: Account) -> Option<f64> {
    let terms = || balance.terms.iter().filter(|t| t.account == account);
    terms()
        .any(|t| t.joule != 0.0)
        .then(|| terms().map(|t| t.joule).sum())
}

/// The table; none if nothing moved.
pub(crate) fn table(balance: &PlantEnergySummary) -> Option<Markup> {
    let accounts: Vec<Account> = Account::ALL
        .into_iter()
        .filter(|account| sum_j(balance, *account).is_some())
        .collect();
    if accounts.is_empty() {
        return None;
    }
    let terms = balance
        .terms
        .iter()
        .filter(|term| accounts.contains(&term.account));
    Some(html! {
        section.table {
            h2 { "Energy balance of the plant" }
            (scrolling("Table", &html! {
                table.balance {
                    thead {
                        tr {
                            th scope="col" { "mJ" }
                            @for account in &accounts { th scope="col" { (account.name()) } }
                        }
                    }
                    tbody {
                        @for term in terms {
                            tr {
                                th scope="row" { (name(term)) }
                                @for account in &accounts {
                                    td { @if *account == term.account { (millijoule(term.joule)) } }
                                }
                            }
                        }
                        tr.sum {
                            th scope="row" { "sum" }
                            @for account in &accounts {
                                td { (millijoule(sum_j(balance, *account).unwrap_or(0.0))) }
                            }
                        }
                    }
                }
            }))
            p.caption {
                (sentence(&accounts)) " What they leave over is numerical error: "
                (scientific(1e3 * balance.residual_j)) " mJ, "
                (scientific(balance.residual_relative.abs())) " of all that moved."
            }
        }
    })
}

/// given = stored + lost + rendered, of the accounts that there are.
fn sentence(accounts: &[Account]) -> String {
    let others: Vec<&str> = accounts
        .iter()
        .filter(|account| **account != Account::Given)
        .map(|account| account.name())
        .collect();
    let given = if accounts.contains(&Account::Given) {
        "given"
    } else {
        "0"
    };
    format!(
        "The sums belong together: {given} = {}.",
        others.join(" + ")
    )
}

fn millijoule(joule: f64) -> String {
    fixed(1e3 * joule, 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn term(what: &'static str, account: Account, joule: f64) -> EnergyTerm {
        EnergyTerm {
            effect: "leg",
            what,
            account,
            joule,
        }
    }

    #[test]
    fn only_the_accounts_that_occur_are_columns() {
        let balance = PlantEnergySummary {
            terms: vec![
                term("weight", Account::Stored, -2.5),
                term("damping", Account::Lost, 2.5),
                term("torque", Account::Rendered, 0.0),
            ],
            residual_j: 1e-15,
            residual_relative: 2e-16,
            ..PlantEnergySummary::default()
        };
        let page = table(&balance).expect("terms").into_string();
        assert!(page.contains("−2500.000") && page.contains("leg: weight"));
        assert!(page.contains("0 = stored + lost"));
        assert!(!page.contains("rendered") && !page.contains(">given<"));
        assert!(page.contains("1.0·10⁻¹² mJ"));
        assert!(table(&PlantEnergySummary::default()).is_none());
    }
}
