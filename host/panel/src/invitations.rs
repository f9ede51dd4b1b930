//! Links that a teacher's page hands on: to students, to the teacher's own phone, to a wall.

use serde_json::{Value, json};

/// Links, each with its QR code where phones can reach this computer.
#[derive(Clone, Debug, Default)]
pub(crate) struct Invitations {
    /// For students' phones.
    pub(crate) student: Value,
    /// For the teacher's own phone.
    pub(crate) remote: Value,
    /// For a projector: the viewers' link, in its view for a wall.
    pub(crate) projector: Value,
}

impl Invitations {
    /// Invitations of these links; `is_lan` if other computers reach them.
    pub(crate) fn new(student: &str, remote: &str, projector: &str, is_lan: bool) -> Self {
        let phone = |link: &str| json!({ "link": link, "qr": code(link).filter(|_| is_lan) });
        Self {
            student: phone(student),
            remote: phone(remote),
            projector: json!({ "link": projector }),
        }
    }
}

#[cfg(feature = "lan")]
fn code(link: &str) -> Option<Value> {
    crate::qr::picture(link)
}

/// Without TLS no phone reaches it.
#[cfg(not(feature = "lan"))]
fn code(_: &str) -> Option<Value> {
    None
}
