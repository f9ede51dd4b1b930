//! The report of a session: one page to print.

use crate::session::Session;

/// Looks a text up by its key: the caller's table of the reader's language.
pub type Text<'a> = &'a dyn Fn(&str) -> String;

/// The report as HTML, complete in itself.
pub fn report(session: &Session, text: Text<'_>) -> String {
    format!("{} {}", text("report.title"), session.started)
}
