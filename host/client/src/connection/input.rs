//! Classification of failed requests: invalid input or failed work.

use crate::Error;
use crepitus_protocol::ValueError;
use crepitus_protocol::host::Refusal;

/// Returns whether an error is invalid input: an unknown parameter, or values that no device
/// accepts. All other errors are failed work.
pub fn is_input(error: &Error) -> bool {
    match error {
        Error::UnknownParameter { .. } => true,
        Error::Refused(refused) => match refused.refusal {
            Refusal::Values(ValueError::NeedsDisarmed { .. }) => false,
            Refusal::Values(_) => true,
            _ => false,
        },
        _ => false,
    }
}
