//! The energy balance of a plant, as its author hands it over.

/// Kind of a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Account {
    /// Work done on the plant from outside.
    Given,
    /// Increase of stored energy.
    Stored,
    /// Dissipated energy.
    Lost,
    /// Work that the rendered torque has taken out of the mechanics.
    Rendered,
}

impl Account {
    /// All, in the order of the balance.
    pub(crate) const ALL: [Self; 4] = [Self::Given, Self::Stored, Self::Lost, Self::Rendered];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Given => "given",
            Self::Stored => "stored",
            Self::Lost => "lost",
            Self::Rendered => "rendered",
        }
    }
}

/// One term.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// The effect that it belongs to.
    pub effect: String,
    /// Description.
    pub what: String,
    /// Account in which it counts.
    pub account: Account,
    /// J.
    pub joule: f64,
}

impl Term {
    /// Energy supplied to the balance, J; negative: taken from it.
    pub(crate) fn inflow_j(&self) -> f64 {
        match self.account {
            Account::Given => self.joule,
            Account::Stored | Account::Lost | Account::Rendered => -self.joule,
        }
    }

    pub(crate) fn name(&self) -> String {
        format!("{}: {}", self.effect, self.what)
    }
}

/// The terms of a run: supplied = stored + lost + rendered.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Balance {
    /// Terms in order from the hand to the motor and back.
    pub terms: Vec<Term>,
    /// Residual, J.
    pub residual_j: f64,
    /// That, as a share of all that moved.
    pub residual_relative: f64,
}

impl Balance {
    /// The sum of an account; none if nothing was ever booked there.
    pub(crate) fn sum_j(&self, account: Account) -> Option<f64> {
        let terms = || self.terms.iter().filter(|t| t.account == account);
        terms()
            .any(|t| t.joule != 0.0)
            .then(|| terms().map(|t| t.joule).sum())
    }
}
