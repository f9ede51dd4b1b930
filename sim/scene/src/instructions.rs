//! Instructions of a step, counted by valgrind, where a clock is too noisy: a program starts
//! itself again under callgrind, which notes a sum each time a run of a scene returns.
//!
//! Counts are those of the program's own build; a step's is what twice the steps need more.

use crate::error::SceneError;
use crate::run::{Blind, run};
use crate::scene::{Overrides, Scene};
use crate::shipped;
use std::ffi::OsStr;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs, io};

/// Set for the program that is counted.
const COUNTED_VARIABLE: &str = "CREPITUS_COUNTED";

/// The name that callgrind looks for.
const COUNTED: &str = "crepitus_scene::instructions::counted";

/// Effects of the standard scenes on a motion at constant speed, each one's own row.
const COMPOSED: [&[&str]; 6] = [
    &[],
    &["crepitus"],
    &["crepitus", "encoder"],
    &["crepitus", "lead-pipe"],
    &["crepitus", "motor"],
    &["crepitus", "drivetrain"],
];

/// Standard scenes that ship, from their start.
const SHIPPED: [&str; 4] = [
    "catch-and-clonus",
    "pressed-into-a-hard-end",
    "fig8-5-limb",
    "everything",
];

/// The ten standard scenes with their names: their steps are a table that the tests compare.
///
/// # Errors
/// If one is no scene any more.
pub fn standard() -> Result<Vec<(String, Scene)>, SceneError> {
    let composed = COMPOSED.iter().map(|effects| {
        let mut text = String::from(
            "version = 1\ntitle = \"standard\"\nduration_s = 1\n[motion]\nkind = \"constant\"\n\
             velocity_rad_s = 1.0\n[solver]\nkind = \"exact-events\"\nstep_s = 5e-5\nprecision = \"f32\"\n",
        );
        text.extend(effects.iter().map(|effect| format!("[effects.{effect}]\n")));
        let name: Vec<_> = ["motion"].iter().chain(*effects).copied().collect();
        let scene = Scene::parse(Path::new("standard.toml"), &text, &Overrides::default());
        scene.map(|scene| (name.join(" + "), scene))
    });
    let shipped = SHIPPED.iter().map(|name| {
        let scene = shipped::scene(Path::new(name), &Overrides::default());
        scene.map(|scene| ((*name).to_owned(), scene))
    });
    composed.chain(shipped).collect()
}

/// Returns whether this program is counted: all that it has to do is [`run_counted`].
pub fn is_counted() -> bool {
    env::var_os(COUNTED_VARIABLE).is_some()
}

/// Returns whether there is a valgrind.
pub fn can_count() -> bool {
    Command::new("valgrind")
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

/// Runs each scene for so many steps and for twice as many.
pub fn run_counted(scenes: &[Scene], steps: u32) {
    for scene in scenes {
        for times in [1.0, 2.0] {
            let mut scene = scene.clone();
            scene.duration_s = times * f64::from(steps) * scene.step_s();
            // One that fails counts up to there.
            counted(&mut || {
                let _ = black_box(run(&scene, &mut Blind));
            });
        }
    }
}

/// Does `work`, which callgrind counts.
#[inline(never)]
pub fn counted(work: &mut dyn FnMut()) {
    work();
    // Otherwise the call is the function's last, a jump, which ends the count.
    let _ = black_box(work);
}

/// Instructions of a step of each subject of a program that does so many steps of each, and twice
/// as many, under [`counted`]; of scenes as [`run_counted`] does.
///
/// # Errors
/// If the program or valgrind fails, or counts other runs than expected.
pub fn per_step<S: AsRef<OsStr>>(
    program: &Path,
    arguments: impl IntoIterator<Item = S>,
    (subjects, steps): (usize, u32),
) -> io::Result<Vec<f64>> {
    let folder = Folder::new()?;
    let out = folder.0.join("counts");
    let status = Command::new("valgrind")
        .arg("--tool=callgrind")
        .args([
            format!("--dump-before={COUNTED}"),
            format!("--dump-after={COUNTED}"),
            format!("--callgrind-out-file={}", out.display()),
        ])
        .arg(program)
        .args(arguments)
        .env(COUNTED_VARIABLE, "1")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()?;
    if !status.success() {
        return Err(io::Error::other(format!("valgrind ended with {status}")));
    }
    // Each run has two files: what was before it, and its own.
    let count = |run: usize| {
        let file = folder.0.join(format!("counts.{}", 2 * run));
        total(&fs::read_to_string(file)?).ok_or_else(|| io::Error::other("no count"))
    };
    (0..subjects)
        .map(|subject| {
            let (once, twice) = (count(2 * subject + 1)?, count(2 * subject + 2)?);
            Ok((twice - once) / f64::from(steps))
        })
        .collect()
}

/// The sum of a file of callgrind's.
fn total(text: &str) -> Option<f64> {
    let sum = text.lines().find_map(|line| line.strip_prefix("summary:"));
    sum?.trim().parse().ok()
}

/// A folder of this process, which goes with it.
struct Folder(PathBuf);

impl Folder {
    fn new() -> io::Result<Self> {
        let name = format!("crepitus-instructions-{}", std::process::id());
        let folder = env::temp_dir().join(name);
        fs::create_dir(&folder)?;
        Ok(Self(folder))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_is_that_of_the_file() {
        assert_eq!(
            total("events: Ir\nsummary: 1234\ntotals: 5\n"),
            Some(1234.0)
        );
        assert_eq!(total("events: Ir\n"), None);
    }
}
