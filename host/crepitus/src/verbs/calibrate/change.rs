//! Changes of parameters that the findings of a calibration propose.

use super::finding::Finding;
use crate::failure::Failure;
use crepitus_client::connection::parameters::find;
use crepitus_protocol::parameters::{Kind, Parameter};

/// A parameter, and what it should be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Change {
    pub(super) parameter: &'static Parameter,
    pub(super) value: f64,
}

/// Proposals of all steps; where two propose the same, the first. Within the parameter's range, with four
/// digits.
pub(super) fn changes(findings: &[Finding]) -> Result<Vec<Change>, Failure> {
    let mut changes: Vec<Change> = Vec::new();
    for (name, value) in findings.iter().flat_map(|finding| &finding.proposals) {
        let (id, parameter) = find(name).map_err(Failure::input)?;
        if changes.iter().all(|change| change.parameter.id != id) {
            let value = match parameter.kind {
                Kind::Number(spec) => four_digits(*value).clamp(spec.min, spec.max),
                Kind::Choice(_) => *value,
            };
            changes.push(Change { parameter, value });
        }
    }
    Ok(changes)
}

/// More are never known.
fn four_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
