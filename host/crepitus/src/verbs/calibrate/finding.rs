//! Finding of a step.

use super::step::Step;
use crepitus_identify::Estimate;
use crepitus_model::parameters::ParameterSpec;
use std::fmt::Write;

/// Whether it is as it should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// HangingFit as it should be.
    Good,
    /// HangingFit not as it should be, which the exit code reports.
    Bad,
    /// The step could not tell.
    Unknown,
    /// The step was left out.
    Skipped,
}

impl Verdict {
    /// Name of the verdict, for people and files.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Bad => "bad",
            Self::Unknown => "unknown",
            Self::Skipped => "skipped",
        }
    }
}

/// A number that was found.
#[derive(Clone, Debug)]
pub(super) struct Number {
    pub(super) name: &'static str,
    pub(super) value: f64,
    /// Half width of its 95 % interval; none if it is a count.
    pub(super) half_width: Option<f64>,
    pub(super) unit: &'static str,
}

impl Number {
    /// Value, interval and unit.
    pub(super) fn text(&self) -> String {
        let Self { value, .. } = self;
        // A share has none.
        let unit = match self.unit {
            "1" => String::new(),
            unit => format!(" {unit}"),
        };
        match self.half_width {
            Some(half_width) => {
                let (value, half) = Estimate {
                    value: *value,
                    half_width,
                }
                .rounded();
                format!("{value} ± {half}{unit}")
            }
            None => format!("{value:.2}{unit}"),
        }
    }
}

/// Finding of a step.
#[derive(Clone, Debug)]
pub(super) struct Finding {
    /// None of the connection itself.
    pub(super) step: Option<Step>,
    pub(super) verdict: Verdict,
    pub(super) values: Vec<Number>,
    pub(super) remarks: Vec<String>,
    /// Remedy if the verdict is not good.
    pub(super) remedy: Option<String>,
    /// Full names of parameters, and what they should be.
    pub(super) proposals: Vec<(String, f64)>,
    /// Angle, rad, measured and fitted current, A, of the hanging weight.
    pub(super) curve: Vec<[f64; 3]>,
}

impl Finding {
    /// Finding of which only the step and the verdict are known yet.
    pub(super) fn new(step: impl Into<Option<Step>>, verdict: Verdict) -> Self {
        Self {
            step: step.into(),
            verdict,
            values: Vec::new(),
            remarks: Vec::new(),
            remedy: None,
            proposals: Vec::new(),
            curve: Vec::new(),
        }
    }

    /// A step that was left out.
    pub(super) fn skipped(step: Step, why: &str) -> Self {
        Self::new(step, Verdict::Skipped).remark(why)
    }

    /// Adds a number.
    pub(super) fn value(
        mut self,
        name: &'static str,
        value: f64,
        half_width: Option<f64>,
        unit: &'static str,
    ) -> Self {
        self.values.push(Number {
            name,
            value,
            half_width,
            unit,
        });
        self
    }

    /// Adds an estimate of a value that is a parameter somewhere.
    pub(super) fn estimate(
        self,
        name: &'static str,
        found: &Estimate,
        spec: &ParameterSpec,
    ) -> Self {
        self.value(name, found.value, Some(found.half_width), spec.unit)
    }

    /// Adds a sentence.
    pub(super) fn remark(mut self, text: impl Into<String>) -> Self {
        self.remarks.push(text.into());
        self
    }

    /// Sets the remedy: what to do.
    pub(super) fn remedy(mut self, text: impl Into<String>) -> Self {
        self.remedy = Some(text.into());
        self
    }

    /// Adds a value to propose for a parameter.
    pub(super) fn propose(mut self, name: &str, value: f64) -> Self {
        self.proposals.push((name.to_owned(), value));
        self
    }

    /// Name of the step, for people and files.
    pub(super) fn name(&self) -> &'static str {
        self.step.map_or("connect", Step::name)
    }

    /// Text for people.
    pub(super) fn text(&self) -> String {
        let mut text = format!("{}: {}\n", self.name(), self.verdict.name());
        // Writing to a String cannot fail.
        for value in &self.values {
            let _ = writeln!(text, "  {}  {}", value.name, value.text());
        }
        for remark in &self.remarks {
            let _ = writeln!(text, "  {remark}");
        }
        if let Some(remedy) = &self.remedy {
            let _ = writeln!(text, "  to do: {remedy}");
        }
        text
    }
}
