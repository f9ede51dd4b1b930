//! Opens the page in the user's browser.
//!
//! A program's arguments can be read by every user of a computer, so the link with its
//! secret is not one of them: the browser opens a file that only this user can read, which
//! leads to the page.

use std::io::{self, Write};
use std::process::{Command, Stdio};
use tempfile::NamedTempFile;

/// The file; it is removed with this.
pub(super) struct Opened(#[expect(dead_code, reason = "kept for its end")] NamedTempFile);

/// Opens a link.
///
/// # Errors
/// There is no program to open it, or no folder for the file.
pub(super) fn open(link: &str) -> io::Result<Opened> {
    let mut file = tempfile::Builder::new()
        .prefix("crepitus-panel-")
        .suffix(".html")
        .tempfile()?;
    writeln!(
        file,
        "<!doctype html><meta charset=\"utf-8\"><title>Crepitus</title>\
         <meta http-equiv=\"refresh\" content=\"0; url={link}\"><a href=\"{link}\">Crepitus</a>"
    )?;
    file.flush()?;
    let program = if cfg!(target_os = "macos") {
        "open"
    } else if cfg!(windows) {
        "explorer"
    } else {
        "xdg-open"
    };
    let mut child = Command::new(program)
        .arg(file.path())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()?;
    // The program hands over to the browser and ends; nobody needs its result.
    std::thread::spawn(move || child.wait());
    Ok(Opened(file))
}
