//! Messages of hosts, found in what they have sent.

use crepitus_protocol::Lane;
use crepitus_protocol::decoder::Body;
use crepitus_protocol::host::Request;
use crepitus_protocol::management::ManagementRequest;

/// Content of a frame from a host.
#[expect(clippy::large_enum_variant, reason = "there is one at a time")]
pub(crate) enum Sent {
    Request(Request),
    Question(ManagementRequest),
}

impl Sent {
    pub(crate) fn of(body: &Body<'_>) -> Option<Self> {
        match body.lane() {
            Some(Lane::Request) => body.message().map(Self::Request),
            Some(Lane::Management) => ManagementRequest::of(body.payload).map(Self::Question),
            _ => None,
        }
    }
}
