//! Which failed requests are the caller's mistake.

use crepitus_client::Error;
use crepitus_protocol::ValueError;
use crepitus_protocol::host::Refusal;

/// Whether a request was bad input: an unknown parameter, or values that no device
/// takes. All other errors are failed work.
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
