//! The runner of `cargo run`, with a stand-in for `probe-rs`: what is flashed is sealed, and
//! neither a hard fault nor a reset is caught by the probe, so that the firmware's own handlers run.

#![cfg(unix)]

use std::env;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Address of flash, of the first instruction and of the initial values.
const FLASH: u32 = 0x0800_0000;
const CODE: u32 = 512;
const VALUES: u32 = 600;
const BYTES: u32 = 640;
/// Place of the seal in the vector table.
const SEAL_AT: usize = 0x1c;

/// An ELF file as the linker of the firmware leaves it, in the smallest form: one segment, and the
/// symbols between which the program lies.
fn elf() -> (Vec<u8>, usize) {
    let flash: Vec<u8> = (0..BYTES).map(|n| (n * 7 % 251) as u8).collect();
    let symbols = [
        ("__stext", FLASH + CODE),
        ("__sidata", FLASH + VALUES),
        ("__sdata", 0x2000_0000),
        ("__edata", 0x2000_0000 + BYTES - VALUES),
    ];
    let (mut names, mut table) = (vec![0_u8], vec![0_u8; 16]);
    for (name, value) in symbols {
        words(&mut table, &[u32::try_from(names.len()).unwrap(), value, 0]);
        // Global, without a type, in an absolute section.
        table.extend([0x10, 0, 0xf1, 0xff]);
        names.extend(name.as_bytes());
        names.push(0);
    }
    let (header, program) = (52_u32, 32_u32);
    let flash_at = header + program;
    let table_at = flash_at + BYTES;
    let names_at = table_at + u32::try_from(table.len()).unwrap();
    let sections_at = (names_at + u32::try_from(names.len()).unwrap()).next_multiple_of(4);

    let mut elf = b"\x7fELF\x01\x01\x01\0\0\0\0\0\0\0\0\0".to_vec();
    halves(&mut elf, &[2, 40]);
    words(
        &mut elf,
        &[1, FLASH + CODE, header, sections_at, 0x0500_0200],
    );
    halves(&mut elf, &[52, 32, 1, 40, 3, 2]);
    words(&mut elf, &[1, flash_at, FLASH, FLASH, BYTES, BYTES, 5, 4]);
    elf.extend(&flash);
    elf.extend(&table);
    elf.extend(&names);
    elf.resize(sections_at as usize, 0);
    words(&mut elf, &[0; 10]);
    let size = |bytes: &[u8]| u32::try_from(bytes.len()).unwrap();
    words(&mut elf, &[0, 2, 0, 0, table_at, size(&table), 2, 1, 4, 16]);
    words(&mut elf, &[0, 3, 0, 0, names_at, size(&names), 0, 0, 1, 0]);
    (elf, flash_at as usize)
}

fn words(into: &mut Vec<u8>, words: &[u32]) {
    into.extend(words.iter().flat_map(|word| word.to_le_bytes()));
}

fn halves(into: &mut Vec<u8>, halves: &[u16]) {
    into.extend(halves.iter().flat_map(|half| half.to_le_bytes()));
}

/// CRC-32, a bit at a time.
fn crc(bytes: impl IntoIterator<Item = u8>) -> u32 {
    !bytes.into_iter().fold(!0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg())
        })
    })
}

fn firmware() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .unwrap()
        .to_owned()
}

/// A folder of this test, empty.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The runner on a file, with a stand-in that writes what it was called with into `called`, and
/// keeps what it would have flashed.
fn run(folder: &Path, elf: &Path) -> Output {
    let probe = folder.join("probe-rs");
    fs::write(
        &probe,
        "#!/bin/sh\nprintf '%s\\n' \"$@\" >\"$STAND_IN/called\"\nfor last; do :; done\ncp \"$last\" \"$STAND_IN/flashed\"\n",
    )
    .unwrap();
    fs::set_permissions(&probe, fs::Permissions::from_mode(0o755)).unwrap();
    let path = env::join_paths(
        [folder.to_owned()]
            .into_iter()
            .chain(env::split_paths(&env::var_os("PATH").unwrap())),
    )
    .unwrap();
    // As cargo starts it: from the folder of the package.
    Command::new("../seal-and-run.sh")
        .arg(elf)
        .current_dir(firmware().join("seal"))
        .env("PATH", path)
        .env("STAND_IN", folder)
        .output()
        .unwrap()
}

#[test]
fn what_is_flashed_is_sealed_and_catches_no_fault() {
    let folder = folder("runner");
    let file = folder.join("drive");
    let (elf, flash_at) = elf();
    fs::write(&file, &elf).unwrap();
    let done = run(&folder, &file);
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(done.status.success(), "{said}");

    let called = fs::read_to_string(folder.join("called")).unwrap();
    let called: Vec<&str> = called.lines().collect();
    assert_eq!(called[..3], ["run", "--chip", "STM32F405RGTx"]);
    for option in ["--no-catch-hardfault", "--no-catch-reset"] {
        assert!(called.contains(&option), "{option} is missing: {called:?}");
    }
    assert_eq!(
        Path::new(called.last().unwrap()).canonicalize().unwrap(),
        file.canonicalize().unwrap()
    );

    let flashed = fs::read(folder.join("flashed")).unwrap();
    let (mut flash, seal_at) = (
        flashed[flash_at..][..BYTES as usize].to_vec(),
        flash_at + SEAL_AT,
    );
    let seal = u32::from_le_bytes(flashed[seal_at..][..4].try_into().unwrap());
    flash[SEAL_AT..][..4].fill(0);
    assert_eq!(seal, crc(flash.iter().copied()), "{said}");
    // Nothing else of the file has changed.
    let mut unsealed = flashed;
    unsealed[seal_at..][..4].copy_from_slice(&elf[seal_at..][..4]);
    assert_eq!(unsealed, elf);
}

#[test]
fn what_is_no_image_is_not_flashed() {
    let folder = folder("no-image");
    let file = folder.join("drive");
    let (elf, _) = elf();
    for broken in [&b"no image"[..], &elf[..elf.len() - 200]] {
        fs::write(&file, broken).unwrap();
        let done = run(&folder, &file);
        assert!(!done.status.success());
        assert!(
            String::from_utf8_lossy(&done.stderr).starts_with("error: "),
            "{done:?}"
        );
        assert!(!folder.join("called").exists(), "it was flashed");
        assert_eq!(fs::read(&file).unwrap(), broken, "it was changed");
    }
}
