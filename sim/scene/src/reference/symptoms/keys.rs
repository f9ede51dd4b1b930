//! Numbers and choices of a symptom, read by key.
//!
//! Ranges are the scene's to check. Refused here is what the equations cannot
//! take: numbers that are not finite, and divisors that are not positive.

/// The numbers and choices that a symptom is given.
pub trait Keys {
    /// The number of a key, in the key's unit; none if it is not given.
    fn number(&self, key: &str) -> Option<f64>;

    /// The name chosen for a key; none if it is not given.
    fn choice(&self, key: &str) -> Option<&str>;
}

/// A symptom that cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SymptomError {
    /// No symptom of this name.
    #[error("no symptom is called \"{0}\"")]
    Unknown(String),
    /// A number that the law cannot take.
    #[error("{effect}: {key} = {value}: expected {expected}")]
    Number {
        /// Name of the symptom.
        effect: &'static str,
        /// Key of the number.
        key: String,
        /// The value given.
        value: f64,
        /// The values allowed.
        expected: &'static str,
    },
    /// A choice that there is not.
    #[error("{effect}: {key} = \"{value}\": expected one of {allowed}")]
    Choice {
        /// Name of the symptom.
        effect: &'static str,
        /// Key of the choice.
        key: &'static str,
        /// The value given.
        value: String,
        /// The names that can be chosen.
        allowed: String,
    },
}

/// The keys of one symptom.
#[derive(Clone, Copy)]
pub(super) struct Reader<'a> {
    pub(super) effect: &'static str,
    pub(super) keys: &'a dyn Keys,
}

impl Reader<'_> {
    /// A finite number, or its default.
    pub(super) fn number(&self, key: &str, default: f64) -> Result<f64, SymptomError> {
        self.checked(key, default, "a finite number", f64::is_finite)
    }

    /// A number ≥ 0.
    pub(super) fn at_least_zero(&self, key: &str, default: f64) -> Result<f64, SymptomError> {
        self.checked(key, default, "a number of 0 or more", |x| {
            x.is_finite() && x >= 0.0
        })
    }

    /// A number > 0.
    pub(super) fn positive(&self, key: &str, default: f64) -> Result<f64, SymptomError> {
        self.checked(key, default, "a number above 0", |x| {
            x.is_finite() && x > 0.0
        })
    }

    /// A share from 0 to 1.
    pub(super) fn share(&self, key: &str, default: f64) -> Result<f64, SymptomError> {
        self.checked(key, default, "a number between 0 and 1", |x| {
            (0.0..=1.0).contains(&x)
        })
    }

    /// An angle, rad, of a key in degrees.
    pub(super) fn angle(&self, key: &str, default: f64) -> Result<f64, SymptomError> {
        self.number(key, default).map(f64::to_radians)
    }

    /// A number that meets a condition, or its default.
    pub(super) fn checked(
        &self,
        key: &str,
        default: f64,
        expected: &'static str,
        is_valid: impl Fn(f64) -> bool,
    ) -> Result<f64, SymptomError> {
        let value = self.keys.number(key).unwrap_or(default);
        if is_valid(value) {
            Ok(value)
        } else {
            Err(self.refused(key, value, expected))
        }
    }

    /// The error of a number that does not go with the others.
    pub(super) fn refused(&self, key: &str, value: f64, expected: &'static str) -> SymptomError {
        SymptomError::Number {
            effect: self.effect,
            key: key.to_owned(),
            value,
            expected,
        }
    }

    /// One of several by name; the first is the default.
    pub(super) fn choice<T: Copy>(
        &self,
        key: &'static str,
        first: (&'static str, T),
        others: &[(&'static str, T)],
    ) -> Result<T, SymptomError> {
        let Some(value) = self.keys.choice(key) else {
            return Ok(first.1);
        };
        let mut options = std::iter::once(&first).chain(others);
        if let Some((_, chosen)) = options.find(|(name, _)| *name == value) {
            return Ok(*chosen);
        }
        let names: Vec<_> = std::iter::once(&first).chain(others).collect();
        let names: Vec<_> = names.iter().map(|(name, _)| *name).collect();
        Err(SymptomError::Choice {
            effect: self.effect,
            key,
            value: value.to_owned(),
            allowed: names.join(", "),
        })
    }

    /// s of the stretched muscles: +1 for extensors, −1 for flexors.
    pub(super) fn muscles(&self) -> Result<f64, SymptomError> {
        self.choice("muscles", ("extensors", 1.0), &[("flexors", -1.0)])
    }
}
