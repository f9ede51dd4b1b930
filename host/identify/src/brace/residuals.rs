//! Effective standard deviation of correlated residuals.

/// Least standard deviation of an angle, rad: that of a count.
pub(crate) const LEAST_DEVIATION: f64 = 1e-4;

pub(crate) fn rms(residuals: &[Vec<f64>]) -> f64 {
    let all = residuals.iter().flatten().filter(|r| !r.is_nan());
    let (sum, n) = all.fold((0.0, 0.0), |(sum, n), r| (sum + r * r, n + 1.0));
    if n > 0.0 { f64::sqrt(sum / n) } else { 0.0 }
}

/// Returns the standard deviation of an angle in the cost, rad, enlarged by the integral
/// correlation time of the residuals.
pub(crate) fn effective_deviation(residuals: &[Vec<f64>]) -> f64 {
    let all = rms(residuals).max(LEAST_DEVIATION);
    let at = |lag: usize| -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        for swing in residuals {
            for (a, b) in swing.iter().zip(swing.iter().skip(lag)) {
                if !a.is_nan() && !b.is_nan() {
                    (sum, n) = (sum + a * b, n + 1.0);
                }
            }
        }
        if n > 0.0 { sum / n } else { 0.0 }
    };
    let zero = at(0).max(1e-30);
    let longest = residuals.iter().map(Vec::len).max().unwrap_or(1) / 4;
    let correlated: f64 = (1..longest)
        .map(|lag| at(lag) / zero)
        .take_while(|rho| *rho > 0.05)
        .sum();
    all * (1.0 + 2.0 * correlated).sqrt()
}
