//! Errors of a law as shares of the scale of a number.

use crate::laws::Row;

/// An error of a law in a quantity, over joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Share {
    /// Size of the error over the scale.
    Of(f64),
    /// The law cannot do it.
    Cannot,
    /// Not known, or without a meaning: the law cannot do it converged either.
    Unknown,
}

/// The two errors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Which {
    /// The law converged against what is demanded.
    Model,
    /// The law at the device's tick against itself converged.
    Numerical,
}

impl Which {
    /// The share of a row.
    pub(super) fn of(self, row: &Row) -> Share {
        let failed = match self {
            Self::Model => row.converged_failed,
            Self::Numerical => row.failed,
        };
        let error = match self {
            Self::Model => row.model_error,
            Self::Numerical => row.numerical_error,
        };
        match (self, failed, error) {
            (Self::Numerical, _, _) if row.converged_failed.is_some() => Share::Unknown,
            (_, Some(_), _) => Share::Cannot,
            // Both are beyond a least value, however far apart: neither errs.
            (Self::Numerical, None, Some(_)) if is_without_error(row) => Share::Of(0.0),
            (_, None, Some(error)) => Share::Of(error.abs() / row.scale),
            (_, None, None) => Share::Unknown,
        }
    }

    /// The worst over rows.
    pub(super) fn worst<'r>(self, rows: impl Iterator<Item = &'r Row>) -> Share {
        rows.map(|row| self.of(row))
            .fold(Share::Unknown, |worst, share| match (worst, share) {
                (Share::Cannot, _) | (_, Share::Cannot) => Share::Cannot,
                (Share::Of(a), Share::Of(b)) => Share::Of(a.max(b)),
                (share, Share::Unknown) | (Share::Unknown, share) => share,
            })
    }

    /// The mean over rows: an error beyond 1, and what the law cannot do, count as 1. `None` if
    /// no error is known.
    pub(super) fn mean<'r>(self, rows: impl Iterator<Item = &'r Row>) -> Option<f64> {
        let shares: Vec<f64> = rows
            .filter_map(|row| match self.of(row) {
                Share::Of(share) => Some(share.min(1.0)),
                Share::Cannot => Some(1.0),
                Share::Unknown => None,
            })
            .collect();
        (!shares.is_empty()).then(|| shares.iter().sum::<f64>() / shares.len() as f64)
    }
}

/// Returns whether a number is right at the tick and converged.
fn is_without_error(row: &Row) -> bool {
    row.model_error.is_some_and(|error| error == 0.0)
        && row.relative_error.is_some_and(|error| error == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::words::tests::row;

    #[test]
    fn a_law_that_cannot_do_it_converged_has_no_numerical_error() {
        let good = row("dahl", Some(-0.25));
        let at_the_tick = Row {
            converged: Some(0.5),
            model_error: Some(0.5),
            numerical_error: None,
            ..row("dahl", None)
        };
        let never = Row {
            converged_failed: Some("diverges"),
            ..row("dahl", None)
        };
        let both = [Which::Model, Which::Numerical];
        let of = |row: &Row| both.map(|which| which.of(row));
        assert_eq!(of(&good), [Share::Of(0.25), Share::Of(0.0)]);
        assert_eq!(of(&at_the_tick), [Share::Of(0.5), Share::Cannot]);
        assert_eq!(of(&never), [Share::Cannot, Share::Unknown]);
        let rows = [good, at_the_tick, never];
        let worst = both.map(|which| which.worst(rows.iter()));
        assert_eq!(worst, [Share::Cannot; 2]);
        let worst = both.map(|which| which.worst(rows.iter().take(2)));
        assert_eq!(worst, [Share::Of(0.5), Share::Cannot]);
        let beyond = Row {
            numerical_error: Some(3.0),
            ..row("dahl", Some(0.0))
        };
        assert_eq!(of(&beyond), [Share::Of(0.0); 2]);
        let means = both.map(|which| which.mean(rows.iter()));
        assert_eq!(means, [Some(1.75 / 3.0), Some(0.5)]);
        assert_eq!(Which::Model.mean([].iter()), None);
    }
}
