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
    /// Its name, demangled.
    pub function: String,
    /// The file.
    pub file: String,
    /// The line in it that the address belongs to, or where the next was
    /// inlined; 0 for what the compiler made of several lines.
    pub line: u32,
    /// The file belongs to a library.
    pub library: bool,
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
            frames.push(Frame {
                function: format!("{:#}", rustc_demangle::demangle(&name)),
                file: short(file),
                line: location.line.unwrap_or(0),
                library: is_library(file),
            });
        }
        frames.reverse();
        frames
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
    file.starts_with("/rustc/") || file.contains("/registry/src/") || file.contains("/library/")
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
