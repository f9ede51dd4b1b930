//! The linker's `memory.x`: which memories there are.
//!
//! Understood is `MEMORY { NAME (attributes) : ORIGIN = n, LENGTH = n }` with
//! the linker's abbreviations, numbers in decimal or hexadecimal with `K` and
//! `M`, sums and differences of them, and both kinds of comment. Anything
//! outside `MEMORY` is skipped.

use crate::image::error::ImageError;

/// A memory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Region {
    /// Name of the memory.
    pub name: String,
    /// First address of the memory.
    pub origin: u32,
    /// Size of the memory in bytes.
    pub length: u32,
}

impl Region {
    /// Returns whether `size` bytes at an address lie inside.
    pub fn holds(&self, address: u32, size: u32) -> bool {
        address >= self.origin
            && u64::from(address) + u64::from(size)
                <= u64::from(self.origin) + u64::from(self.length)
    }

    /// Returns whether two regions share a byte.
    pub fn overlaps(&self, other: &Self) -> bool {
        let end = |r: &Self| u64::from(r.origin) + u64::from(r.length);
        u64::from(self.origin) < end(other) && u64::from(other.origin) < end(self)
    }
}

/// Reads a linker script.
///
/// # Errors
///
/// [`ImageError::Memory`] with the line that is not understood.
pub fn parse(script: &str) -> Result<Vec<Region>, ImageError> {
    let text = without_comments(script);
    let error = |at: usize, what: &str| ImageError::Memory {
        line: text[..at].matches('\n').count() + 1,
        what: what.to_owned(),
    };
    let mut regions = Vec::new();
    let mut from = 0;
    while let Some(found) = text[from..].find("MEMORY") {
        let name_end = from + found + "MEMORY".len();
        let Some(body) = text[name_end..].trim_start().strip_prefix('{') else {
            from = name_end;
            continue;
        };
        let start = text.len() - body.len();
        let Some(length) = body.find('}') else {
            return Err(error(start, "no } behind MEMORY {"));
        };
        let mut rest = &body[..length];
        while !rest.trim().is_empty() {
            let at = start + length - rest.trim_start().len();
            let (region, behind) = region(rest).map_err(|what| error(at, &what))?;
            regions.push(region);
            rest = behind;
        }
        from = start + length;
    }
    if regions.is_empty() {
        return Err(error(0, "no MEMORY { … } with a region"));
    }
    Ok(regions)
}

/// One region and what stands behind it.
fn region(text: &str) -> Result<(Region, &str), String> {
    let (head, behind) = text
        .split_once(':')
        .ok_or_else(|| format!("no ':' behind {:?}", text.trim()))?;
    let name = head.split(['(', ' ', '\t', '\n', '!']);
    let name = name.map(str::trim).find(|part| !part.is_empty());
    let name = name.ok_or("a region without a name")?;
    let (origin, behind) = assignment(behind, &["ORIGIN", "org", "o"])?;
    let behind = behind
        .strip_prefix(',')
        .ok_or_else(|| format!("region {name}: no ',' behind ORIGIN"))?;
    let (length, behind) = assignment(behind, &["LENGTH", "len", "l"])?;
    let region = Region {
        name: name.to_owned(),
        origin,
        length,
    };
    Ok((region, behind.strip_prefix(',').unwrap_or(behind)))
}

/// `KEY = expression`, and what stands behind it.
fn assignment<'a>(text: &'a str, keys: &[&str]) -> Result<(u32, &'a str), String> {
    let [key, ..] = keys else {
        return Err(String::new());
    };
    let (found, behind) = text
        .split_once('=')
        .ok_or_else(|| format!("no {key} = …"))?;
    if !keys.contains(&found.trim()) {
        return Err(format!("{key} expected, found {:?}", found.trim()));
    }
    expression(behind)
}

/// A sum, as far as it goes.
fn expression(text: &str) -> Result<(u32, &str), String> {
    let mut rest = text.trim_start();
    let mut total = 0_i64;
    let mut sign = 1;
    loop {
        let end = rest
            .find(|c: char| !c.is_ascii_alphanumeric())
            .unwrap_or(rest.len());
        let (term, behind) = rest.split_at(end);
        total += sign * number(term)?;
        let behind = behind.trim_start();
        (sign, rest) = match (behind.strip_prefix('+'), behind.strip_prefix('-')) {
            (Some(more), _) => (1, more.trim_start()),
            (_, Some(more)) => (-1, more.trim_start()),
            _ => {
                let total = u32::try_from(total).map_err(|_| format!("{total} is no address"))?;
                return Ok((total, behind));
            }
        };
    }
}

fn number(term: &str) -> Result<i64, String> {
    let not = || format!("{term:?} is not a number");
    if let Some(digits) = term.strip_prefix("0x").or(term.strip_prefix("0X")) {
        return i64::from_str_radix(digits, 16).map_err(|_| not());
    }
    let (digits, unit) = match term.strip_suffix(['K', 'k']) {
        Some(digits) => (digits, 1 << 10),
        None => match term.strip_suffix(['M', 'm']) {
            Some(digits) => (digits, 1 << 20),
            None => (term, 1),
        },
    };
    let value: i64 = digits.parse().map_err(|_| not())?;
    value.checked_mul(unit).ok_or_else(not)
}

/// The script with its comments blanked, line for line.
fn without_comments(script: &str) -> String {
    let mut text = String::with_capacity(script.len());
    let mut rest = script;
    while let Some(at) = rest.find("/*").into_iter().chain(rest.find("//")).min() {
        text.push_str(&rest[..at]);
        let comment = &rest[at..];
        let end = if comment.starts_with("/*") {
            comment.find("*/").map_or(comment.len(), |end| end + 2)
        } else {
            comment.find('\n').unwrap_or(comment.len())
        };
        text.extend(comment[..end].matches('\n'));
        text.push(' ');
        rest = &comment[end..];
    }
    text + rest
}

#[cfg(test)]
mod tests;
