//! The two links: the holder of one may control, or look on.

use std::fmt::Write;
use subtle::ConstantTimeEq;

/// Rights of a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// All.
    Teacher,
    /// Look on, and stop.
    Viewer,
}

impl Role {
    /// Name in messages.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Teacher => "teacher",
            Self::Viewer => "viewer",
        }
    }
}

/// Secrets of this run, 128 bits each.
#[derive(Clone, Debug)]
pub(crate) struct Tokens {
    pub(crate) teacher: String,
    pub(crate) viewer: String,
}

impl Tokens {
    /// Draws both.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub(crate) fn draw() -> Result<Self, getrandom::Error> {
        Ok(Self {
            teacher: secret()?,
            viewer: secret()?,
        })
    }

    /// The role of a page with this token; none if it is wrong. Takes the same time for
    /// every wrong token.
    pub(crate) fn role(&self, token: &str) -> Option<Role> {
        let is = |secret: &str| bool::from(token.as_bytes().ct_eq(secret.as_bytes()));
        match (is(&self.teacher), is(&self.viewer)) {
            (true, _) => Some(Role::Teacher),
            (_, true) => Some(Role::Viewer),
            _ => None,
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_link_has_its_role() {
        let tokens = Tokens::draw().unwrap();
        assert_ne!(tokens.teacher, tokens.viewer);
        assert_eq!(tokens.teacher.len(), 32);
        assert_eq!(tokens.role(&tokens.teacher), Some(Role::Teacher));
        assert_eq!(tokens.role(&tokens.viewer), Some(Role::Viewer));
        let cut = &tokens.teacher[1..];
        let more = format!("{}0", tokens.teacher);
        for wrong in ["", "0", cut, &more, &tokens.teacher.to_uppercase()] {
            assert_eq!(tokens.role(wrong), None, "{wrong}");
        }
    }
}
