//! Energy balance of a plant: what each part was given, stores, and has
//! lost.

crepitus_model::named! {
    /// Kind of a term.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Account {
        /// Work done on the plant from outside.
        Given => "given",
        /// Energy that a part holds.
        Stored => "stored",
        /// Energy that has become heat.
        Lost => "lost",
        /// Work that the rendered torque has taken out of the mechanics.
        Rendered => "rendered",
    }
}

impl Account {
    /// Energy supplied to a balance by `joule` of this account, J; negative: taken from it.
    pub fn inflow_j(self, joule: f64) -> f64 {
        match self {
            Self::Given => joule,
            Self::Stored | Self::Lost | Self::Rendered => -joule,
        }
    }
}

/// One term of the balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// The effect that it belongs to; `motion` for prescribed motion.
    pub effect: &'static str,
    /// Description.
    pub what: &'static str,
    /// Account in which it counts.
    pub account: Account,
    /// Energy, J.
    pub joule: f64,
}

/// The terms at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EnergyBalance {
    terms: Vec<Term>,
    /// Stored energy at the start of a balance, J.
    held_j: f64,
}

impl EnergyBalance {
    /// Adds a term.
    pub fn add(&mut self, effect: &'static str, what: &'static str, account: Account, joule: f64) {
        self.terms.push(Term {
            effect,
            what,
            account,
            joule,
        });
    }

    /// The terms since `start`, of the same plant.
    #[must_use]
    pub fn since(mut self, start: &Self) -> Self {
        let stored = start.terms.iter().filter(|t| t.account == Account::Stored);
        self.held_j = stored.map(|t| t.joule.abs()).sum();
        for (now, then) in self.terms.iter_mut().zip(&start.terms) {
            now.joule -= then.joule;
        }
        self
    }

    /// The terms.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Residual of the balance, J: zero except for numerical error.
    pub fn residual_j(&self) -> f64 {
        self.terms.iter().map(|t| t.account.inflow_j(t.joule)).sum()
    }

    /// All the energy that there was and that moved, J.
    pub fn turnover_j(&self) -> f64 {
        let moved: f64 = self.terms.iter().map(|t| t.joule.abs()).sum();
        self.held_j + moved
    }

    /// The residual as a share of that; NaN if a term is no number.
    pub fn relative_residual(&self) -> f64 {
        let turnover = self.turnover_j();
        if turnover == 0.0 {
            0.0
        } else {
            self.residual_j() / turnover
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn booked(given: f64, stored: f64, lost: f64) -> EnergyBalance {
        let mut balance = EnergyBalance::default();
        balance.add("hand", "work", Account::Given, given);
        balance.add("limb", "kinetic", Account::Stored, stored);
        balance.add("cuff", "damper", Account::Lost, lost);
        balance
    }

    #[test]
    fn supplied_energy_is_stored_or_lost() {
        let balance = booked(5.0, 3.5, 2.0).since(&booked(0.0, 0.5, 0.0));
        assert_eq!(balance.residual_j(), 0.0);
        assert_eq!(balance.relative_residual(), 0.0);
        let open = booked(5.0, 3.0, 1.0);
        assert_eq!(open.residual_j(), 1.0);
        assert!((open.relative_residual() - 1.0 / 9.0).abs() < 1e-15);
        assert_eq!(EnergyBalance::default().relative_residual(), 0.0);
        assert!(booked(5.0, f64::NAN, 2.0).relative_residual().is_nan());
        // Includes the initially stored energy, so that rounding is a small share.
        let still = booked(0.0, 3.0 + 1e-15, 0.0).since(&booked(0.0, 3.0, 0.0));
        assert!(still.relative_residual().abs() < 1e-15);
    }
}
