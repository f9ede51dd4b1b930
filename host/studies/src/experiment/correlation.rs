//! Intraclass correlation: how far ratings of the same knees agree.
//!
//! `n` knees are each rated by the same `k` raters, or `k` times. Of the two-way analysis of variance without
//! repetition come the mean squares of knees (MSR, n − 1 degrees of freedom), raters (MSC, k − 1) and the rest
//! (MSE, (n − 1)(k − 1)):
//!
//! ```text
//! ICC(2,1) = (MSR − MSE) / (MSR + (k − 1) MSE + k (MSC − MSE) / n)    raters drawn at random; absolute agreement
//! ICC(3,1) = (MSR − MSE) / (MSR + (k − 1) MSE)                        these raters; consistency
//! ```
//!
//! (Shrout and Fleiss, *Intraclass correlations: uses in assessing rater reliability*, Psychological Bulletin 86,
//! 1979.) Both are 1 if all raters agree on knees that differ; they can be below 0.

/// Both forms of a single rating.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correlation {
    /// ICC(2,1), absolute agreement.
    pub agreement: f64,
    /// ICC(3,1), consistency.
    pub consistency: f64,
}

/// Intraclass correlations of a table, a row a knee; `None` with fewer than two knees or raters, rows of
/// different length, or ratings that are all equal.
pub fn correlation<R: AsRef<[f64]>>(rows: &[R]) -> Option<Correlation> {
    let raters = rows.first()?.as_ref().len();
    let is_table = rows.iter().all(|row| row.as_ref().len() == raters);
    if rows.len() < 2 || raters < 2 || !is_table {
        return None;
    }
    let (n, k) = (rows.len() as f64, raters as f64);
    let all = || rows.iter().flat_map(|row| row.as_ref().iter().copied());
    let mean = all().sum::<f64>() / (n * k);
    let squares =
        |sums: &mut dyn Iterator<Item = f64>| sums.map(|x| (x - mean).powi(2)).sum::<f64>();
    let of_knees = k * squares(&mut rows.iter().map(|row| row.as_ref().iter().sum::<f64>() / k));
    let columns = (0..raters).map(|column| {
        let of_column = rows.iter().filter_map(|row| row.as_ref().get(column));
        of_column.sum::<f64>() / n
    });
    let of_raters = n * squares(&mut { columns });
    let whole = squares(&mut all());
    // What is left of ratings that agree is rounding.
    let floor = 1e-12 * whole;
    let rest = (whole - of_knees - of_raters).max(0.0);
    let rest = if rest < floor { 0.0 } else { rest };
    let msr = of_knees / (n - 1.0);
    let msc = of_raters / (k - 1.0);
    let mse = rest / ((n - 1.0) * (k - 1.0));
    let found = Correlation {
        agreement: (msr - mse) / (msr + (k - 1.0) * mse + k * (msc - mse) / n),
        consistency: (msr - mse) / (msr + (k - 1.0) * mse),
    };
    (whole > 0.0 && found.agreement.is_finite() && found.consistency.is_finite()).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The six targets and four judges of Shrout and Fleiss, table 2; their table 4 has .29 and .71.
    #[test]
    fn the_published_example_is_met() {
        let rows = [
            [9.0, 2.0, 5.0, 8.0],
            [6.0, 1.0, 3.0, 2.0],
            [8.0, 4.0, 6.0, 8.0],
            [7.0, 1.0, 2.0, 6.0],
            [10.0, 5.0, 6.0, 9.0],
            [6.0, 2.0, 4.0, 7.0],
        ];
        let found = correlation(&rows).expect("a table");
        assert!((found.agreement - 0.289_763_779_527_559_06).abs() < 1e-12);
        assert!((found.consistency - 0.714_840_714_840_714_8).abs() < 1e-12);
    }

    #[test]
    fn agreement_needs_equal_ratings_and_consistency_equal_differences() {
        let shifted = correlation(&[[1.0, 2.0], [2.0, 3.0], [4.0, 5.0]]).expect("a table");
        assert_eq!(shifted.consistency, 1.0);
        assert!(shifted.agreement < 0.95);
        let equal = correlation(&[[1.0, 1.0], [2.0, 2.0], [4.0, 4.0]]).expect("a table");
        assert_eq!(equal.agreement, 1.0);
    }

    #[test]
    fn what_is_no_table_has_none() {
        assert_eq!(correlation(&[[3.0, 3.0], [3.0, 3.0]]), None);
        assert_eq!(correlation(&[[3.0, 4.0]]), None);
        assert_eq!(correlation(&[vec![3.0], vec![4.0]]), None);
        assert_eq!(correlation(&[vec![3.0, 1.0], vec![4.0]]), None);
    }
}
