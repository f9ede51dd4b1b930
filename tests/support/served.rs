//! A simulated device in a process of its own, and other processes.

use super::{crepitus, stderr, stdout};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// `serve-sim`, until it is dropped.
pub(crate) struct Served {
    child: Child,
    others: Vec<Child>,
    pub(crate) home: tempfile::TempDir,
}

impl Served {
    pub(crate) fn new() -> Self {
        Self::at(tempfile::tempdir().unwrap())
    }

    /// Serves in a folder that is there.
    pub(crate) fn at(home: tempfile::TempDir) -> Self {
        Self::of(home, &[])
    }

    /// Serves a device with the leg and the parameters of a scene.
    pub(crate) fn with_scene(scene: &str) -> Self {
        Self::of(tempfile::tempdir().unwrap(), &["--scene", scene])
    }

    fn of(home: tempfile::TempDir, more: &[&str]) -> Self {
        let child = serve(&home, "knee", more);
        Self {
            child,
            others: Vec::new(),
            home,
        }
    }

    /// Serves another one beside it, of this name.
    pub(crate) fn add(&mut self, name: &str) {
        self.others.push(serve(&self.home, name, &[]));
    }

    /// Kills it; its files stay.
    pub(crate) fn kill(mut self) -> tempfile::TempDir {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        std::mem::replace(&mut self.home, tempfile::tempdir().unwrap())
    }

    pub(crate) fn port(&self) -> PathBuf {
        self.home.path().join("crepitus/knee")
    }

    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = crepitus();
        command
            .args(arguments)
            .env("XDG_RUNTIME_DIR", self.home.path());
        command
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    pub(crate) fn info(&self) -> Value {
        let output = self.run(&["info", "--json"]);
        assert!(output.status.success(), "{}", stderr(&output));
        serde_json::from_str(&stdout(&output)).unwrap()
    }
}

fn serve(home: &tempfile::TempDir, name: &str, more: &[&str]) -> Child {
    let mut child = crepitus()
        .args(["serve-sim", "--name", name])
        .args(more)
        .env("XDG_RUNTIME_DIR", home.path())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let out = child.stdout.as_mut().unwrap();
    BufReader::new(out).read_line(&mut line).unwrap();
    assert!(line.contains("is served as"), "{line}");
    child
}

impl Drop for Served {
    fn drop(&mut self) {
        // Also after a test that has failed.
        for child in self.others.iter_mut().chain([&mut self.child]) {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

pub(crate) fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill")
        .args([name, &child.id().to_string()])
        .status()
        .unwrap();
    assert!(sent.success());
}

/// Waits for the end of a program that was signalled; one that goes on is a failure, not a test
/// without an end.
pub(crate) fn ended(child: &mut Child) -> ExitStatus {
    const PATIENCE: Duration = Duration::from_mins(1);
    let begun = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        assert!(
            begun.elapsed() < PATIENCE,
            "process {} obeys no signal",
            child.id()
        );
        sleep(Duration::from_millis(1));
    }
}

/// Signals that end a program in order. Without those that these tests, and so their
/// children, ignore, as under `nohup` or in the background of a shell.
pub(crate) fn ending_signals() -> Vec<&'static str> {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let ignored = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .unwrap();
    // One that is ignored to begin with is lost until the program handles it.
    let mut names = vec!["-TERM"];
    for (name, bit) in [("-HUP", 1), ("-INT", 2)] {
        if ignored & bit == 0 {
            names.push(name);
        } else {
            eprintln!("left out: SIG{}, which is ignored here", &name[1..]);
        }
    }
    names
}

/// Waits for something that another process does.
pub(crate) fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < Duration::from_secs(20), "{what}");
        sleep(Duration::from_millis(20));
    }
}
