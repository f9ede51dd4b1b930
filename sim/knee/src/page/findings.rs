//! Findings of a page, a column each: whether the movement was made that shows a sign of the knee.

use crate::examination::{Examination, Outcome};
use crepitus_model::Real;

/// Numbers of a column: more than a knee has signs.
const MOST_FINDINGS: usize = 16;

/// Names of outcomes, in the order of their numbers.
pub const OUTCOMES: [&str; 6] = [
    "shown",
    "not-moved",
    "too-slow",
    "too-short",
    "not-there",
    "not-held",
];

/// Findings of the knee's examination, in the order of its [signs](crate::examination::signs()).
#[derive(Debug)]
pub struct Findings {
    /// Number of signs.
    pub count: u32,
    /// Outcome of each: its place in [`OUTCOMES`].
    pub outcomes: [u32; MOST_FINDINGS],
    /// Reached speed, angle or time, in the unit of its [`Outcome`]; NaN without one.
    pub reached: [f32; MOST_FINDINGS],
    /// Speed, angle or time that it takes; NaN without one.
    pub needed: [f32; MOST_FINDINGS],
}

impl Findings {
    /// No findings.
    pub(super) const EMPTY: Self = Self {
        count: 0,
        outcomes: [0; MOST_FINDINGS],
        reached: [0.0; MOST_FINDINGS],
        needed: [0.0; MOST_FINDINGS],
    };

    /// Findings of an examination; one without a place is left out.
    pub(super) fn of(examination: &Examination) -> Self {
        let mut all = Self::EMPTY;
        let numbers = all.reached.iter_mut().zip(&mut all.needed);
        let places = (1..).zip(all.outcomes.iter_mut().zip(numbers));
        for (finding, (count, (outcome, numbers))) in examination.findings().zip(places) {
            all.count = count;
            *outcome = number(&finding.outcome);
            let [reached, needed] = finding.outcome.numbers();
            *numbers.0 = or_none(reached);
            *numbers.1 = or_none(needed);
        }
        all
    }
}

/// Place of an outcome in [`OUTCOMES`].
fn number(outcome: &Outcome) -> u32 {
    match outcome {
        Outcome::Shown => 0,
        Outcome::NotMoved => 1,
        Outcome::TooSlow { .. } => 2,
        Outcome::TooShort { .. } => 3,
        Outcome::NotThere { .. } => 4,
        Outcome::NotHeld { .. } => 5,
    }
}

fn or_none(number: Option<f64>) -> f32 {
    number.map_or(f32::NAN, f32::from_f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_of_an_outcome_is_the_place_of_its_name() {
        let (fastest_deg_s, least_deg_s) = (1.0, 2.0);
        let (furthest_deg, needed_deg) = (1.0, 2.0);
        let (held_s, needed_s) = (1.0, 2.0);
        let all = [
            Outcome::Shown,
            Outcome::NotMoved,
            Outcome::TooSlow {
                fastest_deg_s,
                least_deg_s,
            },
            Outcome::TooShort {
                furthest_deg,
                needed_deg,
            },
            Outcome::NotThere { needed_deg },
            Outcome::NotHeld { held_s, needed_s },
        ];
        for outcome in all {
            let place = usize::try_from(number(&outcome)).unwrap();
            assert_eq!(OUTCOMES[place], outcome.name());
        }
    }
}
