//! Building and finding the images.
//!
//! `CREPITUS_IMAGES` names a folder with `drive`, `comms` and `ladder`. Without
//! it each is built in `firmware/` by `cargo build --release`, once in a
//! process, into `firmware/target`. If the target `thumbv7em-none-eabihf` is
//! not installed, a test prints that and is skipped;
//! with `CREPITUS_NEEDS_TARGET` set it fails instead.

use crate::image::{Image, ImageError};
use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

const TARGET: &str = "thumbv7em-none-eabihf";

/// Program of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// The drive's.
    Drive,
    /// Program of comms.
    Comms,
    /// The solver ladder, see [`crate::ladder`].
    Ladder,
}

impl Program {
    /// Name of its file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Drive => "drive",
            Self::Comms => "comms",
            Self::Ladder => "ladder",
        }
    }
}

/// Reason why there is no image.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NoImage {
    /// The compiler has no core library for the target.
    #[error("the target {TARGET} is not installed (rustup target add {TARGET})")]
    NoTarget,
    /// Cargo could not build it.
    #[error("firmware/ cannot be built: {0}")]
    NotBuilt(String),
    /// The file is not a valid image.
    #[error(transparent)]
    Image(#[from] ImageError),
}

/// The image of a program.
///
/// # Errors
/// [`NoImage`].
pub fn image(program: Program) -> Result<Image, NoImage> {
    Ok(Image::read(&path(program)?)?)
}

/// Returns whether images come from `firmware/`, and may have to be built.
pub fn is_to_be_built() -> bool {
    env::var_os("CREPITUS_IMAGES").is_none()
}

/// The file of a program.
///
/// # Errors
/// [`NoImage`] if it cannot be built.
pub fn path(program: Program) -> Result<PathBuf, NoImage> {
    let folder = match env::var_os("CREPITUS_IMAGES") {
        Some(folder) => PathBuf::from(folder),
        None => built(program)?,
    };
    Ok(folder.join(program.name()))
}

/// The image of a program, for a test; `None`, and a printed line, if the
/// target is not installed.
///
/// # Panics
/// If there is none although `CREPITUS_NEEDS_TARGET` is set, or for any other
/// reason.
pub fn image_for_test(program: Program) -> Option<Image> {
    match image(program) {
        Ok(image) => Some(image),
        Err(NoImage::NoTarget) if env::var_os("CREPITUS_NEEDS_TARGET").is_none() => {
            println!("left out: {}", NoImage::NoTarget);
            None
        }
        Err(error) => panic!("{error}"),
    }
}

fn built(program: Program) -> Result<PathBuf, NoImage> {
    static BUILT: [OnceLock<Result<(), String>>; 3] = [const { OnceLock::new() }; 3];
    if !is_installed() {
        return Err(NoImage::NoTarget);
    }
    let firmware = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../firmware");
    let folder = firmware.join("target").join(TARGET).join("release");
    BUILT[program as usize]
        .get_or_init(|| build(&firmware, program))
        .clone()
        .map_err(NoImage::NotBuilt)?;
    Ok(folder)
}

fn build(firmware: &Path, program: Program) -> Result<(), String> {
    let output = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["build", "--release", "--target-dir", "target"])
        .args([
            "--package",
            &format!("crepitus-firmware-{}", program.name()),
        ])
        .current_dir(firmware)
        // Cargo's variables for the tests of the host are not for the firmware.
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env_remove("CARGO_BUILD_TARGET")
        .output()
        .map_err(|error| error.to_string())?;
    if output.status.success() {
        Ok(())
    } else {
        Err(String::from_utf8_lossy(&output.stderr).into_owned())
    }
}

fn is_installed() -> bool {
    let compiler = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(compiler)
        .args(["--print", "target-libdir", "--target", TARGET])
        .output();
    output.is_ok_and(|output| {
        let folder = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        output.status.success() && Path::new(&folder).is_dir()
    })
}
