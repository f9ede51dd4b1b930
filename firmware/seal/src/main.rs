//! `crepitus-seal FILE`: seals an image in its place, before it is flashed.

use crepitus_firmware_seal::seal;
use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

const USAGE: &str = "\
usage: crepitus-seal FILE

Seals an image of firmware/: writes the checksum of its flash into its vector table.
`cargo run --release` in firmware/drive or firmware/comms does it.

  crepitus-seal firmware/target/thumbv7em-none-eabihf/release/drive";

fn main() -> ExitCode {
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let [file] = arguments.as_slice() else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    match seal_file(Path::new(file)) {
        Ok(seal) => {
            // The log of the image that follows is what a reader waits for.
            eprintln!("{}: sealed with {seal:08x}", Path::new(file).display());
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("error: {}: {message}", Path::new(file).display());
            ExitCode::from(2)
        }
    }
}

fn seal_file(path: &Path) -> Result<u32, String> {
    let mut elf = fs::read(path).map_err(|error| error.to_string())?;
    let seal = seal(&mut elf).map_err(|error| error.to_string())?;
    // A file that is half written must not be flashed.
    let part = path.with_extension("part");
    fs::write(&part, &elf)
        .and_then(|()| fs::rename(&part, path))
        .map_err(|error| error.to_string())?;
    Ok(seal)
}
