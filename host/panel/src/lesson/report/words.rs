//! Words and numbers of a report, in the reader's language.

use super::Text;
use crate::lesson::summary::Interval;
use crepitus_scene::preset::Level;
use crepitus_studies::experiment::finding::Finding;

/// Texts by key.
pub(super) struct Words<'a>(pub(super) Text<'a>);

impl Words<'_> {
    /// The text of this key.
    pub(super) fn get(&self, key: &str) -> String {
        (self.0)(key)
    }

    /// The text of this key with its `{names}` replaced by values.
    pub(super) fn with(&self, key: &str, values: &[(&str, &str)]) -> String {
        let text = self.get(key);
        values.iter().fold(text, |text, (name, value)| {
            text.replace(&format!("{{{name}}}"), value)
        })
    }

    /// A disorder with its level, if there is one.
    pub(super) fn finding(&self, finding: Finding, level: Option<Level>) -> String {
        let disorder = self.get(&format!("report.disorder.{}", finding.name()));
        match level {
            Some(level) => {
                let level = self.get(&format!("report.level.{}", level.name()));
                format!("{disorder}, {level}")
            }
            None => disorder,
        }
    }

    /// A number with these decimals.
    pub(super) fn number(&self, number: f64, decimals: usize) -> String {
        let text = format!("{number:.decimals$}");
        // A value that is rounded to zero has no sign.
        let zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
        let text = if zero {
            text.trim_start_matches('-')
        } else {
            &text
        };
        text.replace('-', "−")
            .replace('.', &self.get("report.decimal_point"))
    }

    /// A mean of confidences.
    pub(super) fn mean(&self, mean: Option<f64>) -> String {
        mean.map_or_else(|| self.get("report.undefined"), |mean| self.number(mean, 1))
    }

    /// A kappa with its interval.
    pub(super) fn interval(&self, kappa: Option<Interval>) -> String {
        let Some(Interval { value, low, high }) = kappa else {
            return self.get("report.undefined");
        };
        let [value, low, high] = [value, low, high].map(|number| self.number(number, 2));
        self.with(
            "report.interval",
            &[("value", &value), ("low", &low), ("high", &high)],
        )
    }
}
