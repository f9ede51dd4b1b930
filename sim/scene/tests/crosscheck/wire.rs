//! Report of a child process on what `reference` said: lines of hexadecimal
//! words, so that every bit arrives.
//!
//! ```text
//! case N COUNT BREACH BREACH_S
//! KIND FROM TO TIME THETA THETA_DOT OMEGA BEFORE AFTER      (COUNT of them)
//! ```

use crate::theirs::Theirs;
use crepitus_model::{Event, EventKind, Phase};
use std::io::{self, BufRead, Write};

fn word(x: f64) -> String {
    format!("{:016x}", x.to_bits())
}

fn number(word: &str) -> Option<f64> {
    u64::from_str_radix(word, 16).ok().map(f64::from_bits)
}

/// Writes one case.
///
/// # Errors
/// Errors of the writer.
pub fn write(out: &mut impl Write, case: u64, theirs: &Theirs) -> io::Result<()> {
    writeln!(
        out,
        "case {case} {} {} {}",
        theirs.events.len(),
        word(theirs.breach),
        word(theirs.breach_s)
    )?;
    for e in &theirs.events {
        let numbers = [
            e.fraction,
            e.theta_rad,
            e.theta_dot_rad_s,
            e.omega_rad_s,
            e.torque_before_nm,
            e.torque_after_nm,
        ];
        writeln!(
            out,
            "{} {} {} {}",
            e.kind.name(),
            e.from.sign(),
            e.to.sign(),
            numbers.map(word).join(" ")
        )?;
    }
    out.flush()
}

/// Reads one case, after what the harness of the tests says; `None` at the end and where a line is broken off.
pub fn read(input: &mut impl BufRead) -> Option<(u64, Theirs)> {
    let mut head = line(input)?;
    while !head.starts_with("case ") {
        head = line(input)?;
    }
    let mut words = head.split(' ');
    if words.next() != Some("case") {
        return None;
    }
    let case = words.next()?.parse().ok()?;
    let count: usize = words.next()?.parse().ok()?;
    let (breach, breach_s) = (number(words.next()?)?, number(words.next()?)?);
    let mut events = Vec::with_capacity(count);
    for _ in 0..count {
        events.push(event(&line(input)?)?);
    }
    Some((
        case,
        Theirs {
            events,
            breach,
            breach_s,
        },
    ))
}

fn line(input: &mut impl BufRead) -> Option<String> {
    let mut line = String::new();
    input.read_line(&mut line).ok()?;
    line.pop().filter(|&c| c == '\n').map(|_| line)
}

fn event(line: &str) -> Option<Event<f64>> {
    let mut words = line.split(' ');
    let kind = match words.next()? {
        "break" => EventKind::Break,
        "stick" => EventKind::Stick,
        "reverse" => EventKind::Reverse,
        _ => return None,
    };
    let from = Phase::from_sign(words.next()?.parse().ok()?);
    let to = Phase::from_sign(words.next()?.parse().ok()?);
    let mut next = || number(words.next()?);
    Some(Event {
        kind,
        from,
        to,
        fraction: next()?,
        theta_rad: next()?,
        theta_dot_rad_s: next()?,
        omega_rad_s: next()?,
        torque_before_nm: next()?,
        torque_after_nm: next()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::Case;

    #[test]
    fn every_bit_arrives() {
        let mut theirs = Theirs::of(&Case::new(3));
        theirs.breach = 0.1;
        theirs.breach_s = -0.0;
        let mut bytes = Vec::new();
        write(&mut bytes, 3, &theirs).unwrap();
        let mut rest = bytes.as_slice();
        assert_eq!(read(&mut rest), Some((3, theirs)));
        assert_eq!(read(&mut rest), None);
        let broken = &bytes[..bytes.len() - 1];
        assert_eq!(read(&mut &*broken), None);
    }
}
