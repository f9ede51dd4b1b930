//! The knee of the page as WebAssembly: `sim/knee`, the same bytes in every folder.
//!
//! ```text
//! sim/knee ── cargo, folders renamed ──> host/panel/assets/knee.wasm, committed
//! ```
//!
//! The file is committed, so that one `cargo build` builds the program; the gate builds it again and compares.
//! What would tell one computer from another are names of folders in the messages of panics: of this
//! repository, of downloaded crates, and of the library's sources where they are installed.

use std::env;
use std::fs;
use std::io;
use std::path::{Path, PathBuf, absolute};
use std::process::{Command, Stdio};

/// The file, from the root of the repository.
pub const FILE: &str = "host/panel/assets/knee.wasm";

const TARGET: &str = "wasm32-unknown-unknown";

/// Profile of the build.
const PROFILE: &str = "page";

/// Folder of the build, from the root of the repository: by itself, as other builds run beside this one.
const SCRATCH: &str = "target/knee-page";

/// Reason why there is no file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// A program cannot be run.
    #[error("{program}: {source}")]
    Program {
        /// The program.
        program: &'static str,
        /// The cause.
        source: io::Error,
    },
    /// A program has failed.
    #[error("{program} failed; `rustup target add wasm32-unknown-unknown` installs the target")]
    Failed {
        /// The program.
        program: &'static str,
    },
    /// A file or folder cannot be read.
    #[error("{}: {source}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
}

/// Builds the file of the repository at `root`, and returns its bytes.
///
/// # Errors
/// [`BuildError`] if a program fails, or left no file.
pub fn build(root: &Path) -> Result<Vec<u8>, BuildError> {
    let root = &absolute(root).map_err(|source| not_read(root, source))?;
    let mut rustc = Command::new("rustc");
    let about = output(rustc.arg("-vV").current_dir(root), "rustc")?;
    let mut rustc = Command::new("rustc");
    rustc.args(["--print", "sysroot"]).current_dir(root);
    let sysroot = output(&mut rustc, "rustc")?;
    let names = names(root, Path::new(sysroot.trim()), &about, &registries());
    let mut cargo = Command::new("cargo");
    cargo.args(["rustc", "--locked", "-p", "crepitus-knee", "--lib"]);
    cargo.args(["--profile", PROFILE, "--target", TARGET]);
    cargo.args(["--crate-type", "cdylib", "--target-dir", SCRATCH]);
    cargo.env("CARGO_ENCODED_RUSTFLAGS", flags(&names));
    output(cargo.current_dir(root), "cargo")?;
    let folder = root.join(SCRATCH).join(TARGET).join(PROFILE);
    let file = folder.join("crepitus_knee.wasm");
    fs::read(&file).map_err(|source| not_read(&file, source))
}

fn not_read(path: &Path, source: io::Error) -> BuildError {
    let path = path.to_owned();
    BuildError::File { path, source }
}

/// Runs a program, whose complaints are shown. Returns what it prints.
fn output(command: &mut Command, program: &'static str) -> Result<String, BuildError> {
    let output = command
        .stderr(Stdio::inherit())
        .output()
        .map_err(|source| BuildError::Program { program, source })?;
    if !output.status.success() {
        return Err(BuildError::Failed { program });
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Folders of downloaded crates; none where nothing was downloaded.
fn registries() -> Vec<PathBuf> {
    let own = || env::home_dir().map(|home| home.join(".cargo"));
    let home = env::var_os("CARGO_HOME").map(PathBuf::from).or_else(own);
    let entries = home.and_then(|home| fs::read_dir(home.join("registry/src")).ok());
    let entries = entries.into_iter().flatten().flatten();
    entries.map(|entry| entry.path()).collect()
}

/// Folders of this computer, and the name of each in the file.
fn names(
    root: &Path,
    sysroot: &Path,
    about: &str,
    registries: &[PathBuf],
) -> Vec<(PathBuf, String)> {
    let mut lines = about.lines();
    let hash = lines.find_map(|line| line.strip_prefix("commit-hash: "));
    // As the library itself is compiled.
    let library = format!("/rustc/{}", hash.unwrap_or("unknown"));
    let mut names = vec![
        (root.to_owned(), "/crepitus".to_owned()),
        (sysroot.join("lib/rustlib/src/rust"), library),
    ];
    let of_crates = |folder: &PathBuf| (folder.clone(), "/crates".to_owned());
    names.extend(registries.iter().map(of_crates));
    names
}

/// Flags of the compiler, separated as cargo does where a path may have a space.
fn flags(names: &[(PathBuf, String)]) -> String {
    let flags: Vec<_> = names
        .iter()
        .map(|(folder, name)| format!("--remap-path-prefix={}={name}", folder.display()))
        .collect();
    flags.join("\x1f")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_folder_of_this_computer_has_another_name() {
        let (root, sysroot) = (Path::new("/home/two words"), Path::new("/toolchain"));
        let about = "rustc 1.0.0\nbinary: rustc\ncommit-hash: 0123abc\nhost: here\n";
        let registries = [PathBuf::from("/home/me/.cargo/registry/src/index-1")];
        let all = flags(&names(root, sysroot, about, &registries));
        let each: Vec<_> = all.split('\x1f').collect();
        assert_eq!(
            each,
            [
                "--remap-path-prefix=/home/two words=/crepitus",
                "--remap-path-prefix=/toolchain/lib/rustlib/src/rust=/rustc/0123abc",
                "--remap-path-prefix=/home/me/.cargo/registry/src/index-1=/crates",
            ]
        );
    }

    #[test]
    fn a_program_that_is_not_there_or_fails_is_an_error() {
        let run = |program, argument| output(Command::new(program).arg(argument), program);
        let missing = run("crepitus-no-such-program", "--version");
        assert!(matches!(missing, Err(BuildError::Program { .. })));
        let failed = run("rustc", "--no-such-flag");
        assert!(matches!(failed, Err(BuildError::Failed { .. })));
    }
}
