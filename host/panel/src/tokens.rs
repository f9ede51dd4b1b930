//! The links: the holder of one may control, run a lesson, look on, or answer.

use std::fmt::Write;
use subtle::ConstantTimeEq;

crepitus_model::named! {
    /// Rights of a page.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) enum Role {
        /// All.
        Teacher => "teacher",
        /// Run the lesson from a phone while another page controls, see the knee, note, and stop.
        Remote => "remote",
        /// Look on, and stop.
        Viewer => "viewer",
        /// Answer for one student, and stop.
        Student => "student",
    }
}

/// Secrets of this run, 128 bits each.
#[derive(Clone, Debug)]
pub(crate) struct Tokens {
    pub(crate) teacher: String,
    pub(crate) remote: String,
    pub(crate) viewer: String,
    pub(crate) student: String,
}

impl Tokens {
    /// Draws all.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub(crate) fn draw() -> Result<Self, getrandom::Error> {
        Ok(Self {
            teacher: secret()?,
            remote: secret()?,
            viewer: secret()?,
            student: secret()?,
        })
    }

    /// The role of a page with this token; none if it is wrong. Takes the same time for
    /// every wrong token.
    pub(crate) fn role(&self, token: &str) -> Option<Role> {
        Role::ALL
            .into_iter()
            .find(|role| is_same(token, self.of(*role)))
    }

    /// The token of a role.
    fn of(&self, role: Role) -> &str {
        match role {
            Role::Teacher => &self.teacher,
            Role::Remote => &self.remote,
            Role::Viewer => &self.viewer,
            Role::Student => &self.student,
        }
    }
}

/// Compares secrets in a time that tells nothing but their lengths.
pub(crate) fn is_same(given: &str, secret: &str) -> bool {
    bool::from(given.as_bytes().ct_eq(secret.as_bytes()))
}

/// 128 random bits, hexadecimal.
pub(crate) fn secret() -> Result<String, getrandom::Error> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)?;
    Ok(bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a string does not fail.
        let _ = write!(text, "{byte:02x}");
        text
    }))
}

/// Returns whether a text has the form of a [`secret`].
pub(crate) fn is_secret(text: &str) -> bool {
    let is_digit = |c: u8| c.is_ascii_digit() || (b'a'..=b'f').contains(&c);
    text.len() == 32 && text.bytes().all(is_digit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_link_has_its_role() {
        let tokens = Tokens::draw().unwrap();
        for role in Role::ALL {
            let token = tokens.of(role);
            assert!(is_secret(token));
            assert_eq!(tokens.role(token), Some(role));
            let cut = &token[1..];
            let more = format!("{token}0");
            for wrong in [cut, &more, &token.to_uppercase()] {
                // One of digits alone has no other case.
                let role = Some(role).filter(|_| wrong == token);
                assert_eq!(tokens.role(wrong), role, "{wrong}");
            }
        }
        for wrong in ["", "0"] {
            assert_eq!(tokens.role(wrong), None, "{wrong}");
        }
    }
}
