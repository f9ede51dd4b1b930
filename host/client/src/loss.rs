//! A lost connection.

use crate::request_kind::RequestKind;

/// State at the loss of the connection.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Loss {
    pub(crate) was_armed: bool,
    pub(crate) unanswered: Option<RequestKind>,
}
