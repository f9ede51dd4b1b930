//! A program on a terminal of its own.

use std::io::{Read, Write};
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};
use std::thread::{sleep, spawn};
use std::time::{Duration, Instant};

/// A program on a terminal of its own, and what it has written so far.
pub(crate) struct Terminal {
    child: std::process::Child,
    shown: Arc<Mutex<String>>,
}

impl Terminal {
    /// `script` of util-linux gives it the terminal.
    pub(crate) fn new(arguments: &str, runtime: Option<&std::path::Path>) -> Self {
        let program = env!("CARGO_BIN_EXE_crepitus");
        let mut command = Command::new("script");
        command
            .args(["--quiet", "--return", "--command"])
            .arg(format!("stty rows 40 cols 120; {program} {arguments}"))
            .arg("/dev/null")
            .env("TERM", "xterm-256color")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        if let Some(runtime) = runtime {
            command.env("XDG_RUNTIME_DIR", runtime);
        }
        let mut child = command.spawn().expect("script of util-linux");
        let shown = Arc::new(Mutex::new(String::new()));
        let mut out = child.stdout.take().unwrap();
        let text = shown.clone();
        spawn(move || {
            let mut buffer = [0; 4_096];
            while let Ok(count @ 1..) = out.read(&mut buffer) {
                let part = String::from_utf8_lossy(&buffer[..count]).into_owned();
                if let Ok(mut text) = text.lock() {
                    text.push_str(&part);
                }
            }
        });
        Self { child, shown }
    }

    pub(crate) fn press(&mut self, keys: &str) {
        let input = self.child.stdin.as_mut().unwrap();
        input.write_all(keys.as_bytes()).unwrap();
        input.flush().unwrap();
    }

    /// Waits for a text. Blanks of an empty screen are not written.
    pub(crate) fn until(&self, text: &str) {
        let end = Instant::now() + Duration::from_secs(20);
        loop {
            let shown = self.shown.lock().unwrap();
            if shown.contains(text) {
                return;
            }
            let last: String = shown.chars().rev().take(600).collect();
            let last: String = last.chars().rev().collect();
            assert!(
                Instant::now() < end,
                "{text:?} is not in the last of {last:?}"
            );
            drop(shown);
            sleep(Duration::from_millis(10));
        }
    }

    /// All that it has written so far.
    pub(crate) fn shown(&self) -> String {
        self.shown.lock().unwrap().clone()
    }

    pub(crate) fn end(&mut self) -> (i32, String) {
        let code = self.child.wait().unwrap().code().unwrap();
        sleep(Duration::from_millis(50));
        (code, self.shown())
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        let _ = self.child.kill();
    }
}
