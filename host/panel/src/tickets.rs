//! Pages for printing: each can be fetched once, within a minute, from an address that
//! nobody guesses. A link cannot carry a page's token, and a cookie would be sent along by
//! every page of this computer.

use crate::tokens::secret;
use std::collections::HashMap;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Time for which a page is valid.
const VALID: Duration = Duration::from_mins(1);

/// Maximum number of pages that wait.
const MOST: usize = 16;

/// Pages that wait to be fetched.
#[derive(Debug, Default)]
pub(crate) struct Tickets(Mutex<HashMap<String, (Instant, String)>>);

impl Tickets {
    /// Offers a page; returns its name, or a text for people.
    pub(crate) fn offer(&self, html: String) -> Result<String, String> {
        let name = secret().map_err(|error| format!("no random numbers: {error}"))?;
        if let Ok(mut pages) = self.0.lock() {
            pages.retain(|_, (since, _)| since.elapsed() < VALID);
            if pages.len() >= MOST {
                return Err("too many reports wait to be opened: wait a minute".to_owned());
            }
            pages.insert(name.clone(), (Instant::now(), html));
        }
        Ok(name)
    }

    /// The page of this name, which is then no longer offered.
    pub(crate) fn take(&self, name: &str) -> Option<String> {
        let (since, html) = self.0.lock().ok()?.remove(name)?;
        (since.elapsed() < VALID).then_some(html)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_fetched_once() {
        let tickets = Tickets::default();
        let name = tickets.offer("page".to_owned()).unwrap();
        assert_eq!(tickets.take("another"), None);
        assert_eq!(tickets.take(&name), Some("page".to_owned()));
        assert_eq!(tickets.take(&name), None);
        for _ in 0..MOST {
            tickets.offer(String::new()).unwrap();
        }
        assert!(tickets.offer(String::new()).is_err());
    }
}
