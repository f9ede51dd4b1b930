//! Start by a double-click: Windows opens a window for this program alone, and nobody has typed arguments.
//!
//! The file managers of Linux open no terminal for a program; there a `.desktop` file has the arguments.

use crate::output::to_stderr;
use std::env;
use std::ffi::OsString;
use std::fs;
use std::io::stdin;
use std::path::Path;

/// Folder of lessons, beside the program.
const LESSONS: &str = "my-lessons";

/// Command of a double-click, which opens the panel. None where a person has typed one.
pub(crate) fn command() -> Option<Vec<OsString>> {
    let is_bare = env::args_os().len() == 1;
    (is_bare && has_window_of_its_own()).then(|| {
        let program = env::current_exe().ok();
        panel(program.as_deref().and_then(Path::parent))
    })
}

/// Opens the panel with the attached device or a simulated one; it stores lessons in a folder, if that can be written.
fn panel(folder: Option<&Path>) -> Vec<OsString> {
    let mut command = Vec::from(["crepitus", "panel", "--or-sim"].map(OsString::from));
    if let Some(lessons) = folder.map(|folder| folder.join(LESSONS))
        && fs::create_dir_all(&lessons).is_ok()
    {
        command.extend([OsString::from("--sessions"), lessons.into_os_string()]);
    }
    command
}

/// Keeps the window until a person has read it.
pub(crate) fn keep_window() {
    to_stderr("press Enter to close this window");
    let _ = stdin().read_line(&mut String::new());
}

/// Returns whether no other program uses this one's window; a shell would.
#[cfg(windows)]
#[expect(
    unsafe_code,
    reason = "the standard library does not tell who uses a window"
)]
fn has_window_of_its_own() -> bool {
    unsafe extern "system" {
        fn GetConsoleProcessList(list: *mut u32, room: u32) -> u32;
    }
    let mut list = [0; 2];
    // SAFETY: the list has the room that is stated.
    let programs = unsafe { GetConsoleProcessList(list.as_mut_ptr(), 2) };
    programs == 1
}

#[cfg(not(windows))]
fn has_window_of_its_own() -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Cli;
    use clap::Parser;

    #[test]
    fn a_double_click_opens_the_panel_and_stores_where_it_can() {
        let home = tempfile::tempdir().unwrap();
        let file = home.path().join("file");
        fs::write(&file, "").unwrap();
        for (folder, stores) in [
            (Some(home.path()), true),
            (Some(file.as_path()), false),
            (None, false),
        ] {
            let command = panel(folder);
            assert!(Cli::try_parse_from(&command).is_ok(), "{command:?}");
            assert_eq!(command[..3], ["crepitus", "panel", "--or-sim"]);
            let stored = folder.filter(|_| stores).map(|folder| {
                let lessons = folder.join(LESSONS).into_os_string();
                vec![OsString::from("--sessions"), lessons]
            });
            assert_eq!(command[3..], stored.unwrap_or_default());
        }
        assert!(home.path().join(LESSONS).is_dir());
    }
}
