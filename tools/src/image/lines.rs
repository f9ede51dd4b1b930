//! Source lines of addresses, where the image has debug information.

use addr2line::Loader;
use std::path::Path;

/// Source lines of an image.
#[derive(Default)]
pub struct Lines {
    loader: Option<Loader>,
}

/// A function at an address, by itself or inlined.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Frame {
    /// Name of the function, demangled.
    pub function: String,
    /// The file.
    pub file: String,
    /// The line in it that the address belongs to, or where the next was
    /// inlined; 0 for what the compiler made of several lines.
    pub line: u32,
    /// The file belongs to a library.
    pub library: bool,
    /// The package of the library that the function was written in; `None` for
    /// this repository's and the compiler's.
    package: Option<String>,
    /// The function is the compiler's: `core` and the like.
    standard: bool,
}

impl Frame {
    /// File and line.
    pub fn place(&self) -> String {
        format!("{}:{}", self.file, self.line)
    }
}

impl Lines {
    /// The lines of an image; none if it has no debug information.
    pub fn of(elf: &Path) -> Self {
        Self {
            loader: Loader::new(elf).ok(),
        }
    }

    /// The functions at an address, from the one with a symbol to the
    /// innermost that was inlined. Empty where nothing is known.
    pub fn frames(&self, address: u32) -> Vec<Frame> {
        let mut frames = Vec::new();
        let found = self.loader.as_ref();
        let Some(Ok(mut found)) = found.map(|loader| loader.find_frames(address.into())) else {
            return frames;
        };
        while let Ok(Some(frame)) = found.next() {
            let (Some(function), Some(location)) = (frame.function, frame.location) else {
                continue;
            };
            let (Ok(name), Some(file)) = (function.raw_name(), location.file) else {
                continue;
            };
            let function = format!("{:#}", rustc_demangle::demangle(&name));
            let line = location.line.unwrap_or(0);
            // The file of line 0 is that of any of the merged lines.
            let merged = line == 0 && is_library(file);
            frames.push(Frame {
                package: if merged {
                    named(&function)
                } else {
                    package(file)
                },
                standard: if merged {
                    named(&function).is_none()
                } else {
                    is_standard(file)
                },
                function,
                file: short(file),
                line,
                library: is_library(file),
            });
        }
        frames.reverse();
        frames
    }

    /// The package of the library that the code at an address was written in. A
    /// function of the compiler's library belongs to the code that it is inlined
    /// into. `None` for this repository's code, and where nothing is known.
    pub fn library(&self, address: u32) -> Option<String> {
        let frames = self.frames(address);
        let writer = frames.into_iter().rev().find(|frame| !frame.standard)?;
        writer.package
    }

    /// The line of an address: the innermost that is not from a library, and
    /// in brackets the innermost of all, if that is another.
    pub fn at(&self, address: u32) -> Option<String> {
        let frames = self.frames(address);
        let inner = frames.last()?.place();
        let own = frames.iter().rev().find(|frame| !frame.library);
        Some(match own.map(Frame::place) {
            Some(own) if own == inner => own,
            Some(own) => format!("{own} ({inner})"),
            None => inner,
        })
    }
}

fn is_library(file: &str) -> bool {
    is_standard(file) || file.contains("/registry/src/")
}

fn is_standard(file: &str) -> bool {
    !file.contains("/registry/src/") && (file.starts_with("/rustc/") || file.contains("/library/"))
}

/// The package of a file of the registry: `…/registry/src/INDEX/NAME-VERSION/…`.
fn package(file: &str) -> Option<String> {
    let (_, behind) = file.split_once("/registry/src/")?;
    let folder = behind.split('/').nth(1)?;
    let version = folder
        .match_indices('-')
        .find(|(dash, _)| folder[dash + 1..].starts_with(|c: char| c.is_ascii_digit()));
    let end = version.map_or(folder.len(), |(dash, _)| dash);
    Some(folder[..end].to_owned())
}

/// The package by a function's path; `None` for the compiler's.
fn named(function: &str) -> Option<String> {
    let path = function.trim_start_matches(['<', '&', '[', '(']);
    let root = path.split("::").next().unwrap_or(path);
    let standard = ["core", "alloc", "std", "compiler_builtins"].contains(&root);
    (!standard).then(|| root.replace('_', "-"))
}

/// A path without the folder of the registry or toolchain.
fn short(file: &str) -> String {
    if let Some((_, behind)) = file.split_once("/registry/src/") {
        return behind.split_once('/').map_or(behind, |(_, b)| b).to_owned();
    }
    if let Some((_, behind)) = file.split_once("/library/") {
        return behind.to_owned();
    }
    let here = std::env::current_dir().unwrap_or_default();
    let path = Path::new(file);
    let path = path.strip_prefix(&here).unwrap_or(path);
    path.display().to_string()
}

#[cfg(test)]
mod tests {
    use super::{is_standard, named, package};

    #[test]
    fn a_package_is_known_by_its_folder() {
        let registry = "/home/x/.cargo/registry/src/index.crates.io-1949cf8c6b5b557f";
        for (folder, name) in [
            ("usb-device-0.3.2", "usb-device"),
            ("serde_core-1.0.229", "serde_core"),
            ("stm32f4-0.16.0-rc.1", "stm32f4"),
        ] {
            let file = format!("{registry}/{folder}/src/lib.rs");
            assert_eq!(package(&file).as_deref(), Some(name));
            assert!(!is_standard(&file));
        }
        assert_eq!(package("device/src/usb_port.rs"), None);
        assert_eq!(package("/rustc/ab12/library/core/src/cell.rs"), None);
        assert!(is_standard("/rustc/ab12/library/core/src/cell.rs"));
        // A package may have a folder of that name.
        assert!(!is_standard(&format!("{registry}/a-1.0.0/library/core.rs")));
    }

    #[test]
    fn merged_lines_belong_to_their_function() {
        for (function, name) in [
            ("usb_device::device::UsbDevice<B>::poll", Some("usb-device")),
            (
                "<usbd_serial::SerialPort<B> as usb_device::class::UsbClass<B>>::reset",
                Some("usbd-serial"),
            ),
            ("core::option::Option<T>::unwrap", None),
            (
                "<core::ops::Range<usize> as core::slice::SliceIndex<[T]>>::index",
                None,
            ),
        ] {
            assert_eq!(named(function).as_deref(), name, "{function}");
        }
    }
}
