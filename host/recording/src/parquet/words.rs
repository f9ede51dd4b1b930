//! The columns of words: phase, event, limit, notes.

use crate::column::{COLUMNS, Cell};
use crate::row::{HELD_BACK, NOTES, Row};
use crepitus_model::render::effects::Phases;
use crepitus_protocol::LimitReason;
use crepitus_protocol::telemetry::SampleFlags;
use std::io;

/// Phase, event, limit and notes.
pub(super) type Words = [String; 4];

/// The words of a row, in the order of their columns.
pub(super) fn of(row: &Row) -> Words {
    let mut words = Words::default();
    let appends = COLUMNS.iter().filter_map(|column| match column.cell {
        Cell::Word(append) => Some(append),
        _ => None,
    });
    for (word, append) in words.iter_mut().zip(appends) {
        append(row, word);
    }
    words
}

/// Reads flags and phases of effects back from their words.
pub(super) fn read([phase, event, limit, notes]: &Words) -> io::Result<(SampleFlags, Phases)> {
    let wrong = |column: &str, word: &str| {
        io::Error::new(
            io::ErrorKind::InvalidData,
            format!("column {column}: {word:?} is none of its words"),
        )
    };
    let sign = match phase.as_str() {
        "stick" => 0,
        "slip+" => 1,
        "slip-" => -1,
        _ => return Err(wrong("phase", phase)),
    };
    let (breaks, sticks) = match event.as_str() {
        "" => (false, false),
        "break" => (true, false),
        "stick" => (false, true),
        "both" => (true, true),
        _ => return Err(wrong("event", event)),
    };
    let reason = LimitReason::ALL
        .into_iter()
        .find(|reason| reason.name() == limit)
        .ok_or_else(|| wrong("limit", limit))?;
    let mut flags = SampleFlags::default()
        .with_phase(sign)
        .with(SampleFlags::BREAK, breaks)
        .with(SampleFlags::STICK, sticks)
        .with(SampleFlags::ENERGISED, reason != LimitReason::NotArmed)
        .with_limit(reason);
    let mut phases = Phases::default();
    for note in notes.split('+').filter(|note| !note.is_empty()) {
        let known = match note.split_once(':') {
            Some((HELD_BACK, eighths)) => (1..8_u16)
                .find(|n| n.to_string() == eighths)
                .map(|n| flags.0 |= n << SampleFlags::HELD_BACK_SHIFT),
            Some((effect, phase)) => phases
                .with_named(effect, phase)
                .map(|with_it| phases = with_it),
            None => NOTES
                .iter()
                .find(|(_, known)| *known == note)
                .map(|(bit, _)| flags = flags.with(*bit, true)),
        };
        known.ok_or_else(|| wrong("notes", notes))?;
    }
    Ok((flags, phases))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::render::effects::{EffectSpec, SPECS};

    /// All effects at rest, each of them in each of its phases, and all in their last one.
    fn all_phases() -> Vec<Phases> {
        let mut all = vec![Phases::default()];
        for spec in SPECS {
            for name in spec.phases.iter().flat_map(|phases| phases.names).skip(1) {
                all.push(Phases::default().with_named(spec.name, name).unwrap());
            }
        }
        let last = |phases: Phases, spec: &EffectSpec| {
            let name = spec.phases.and_then(|phases| phases.names.last());
            name.map_or(phases, |name| phases.with_named(spec.name, name).unwrap())
        };
        all.push(SPECS.iter().fold(Phases::default(), last));
        all
    }

    #[test]
    fn flags_read_back_from_their_words() {
        for reason in LimitReason::ALL {
            for bits in [
                0,
                SampleFlags::SETTLING | SampleFlags::LATE,
                SampleFlags::LOST | SampleFlags::BREAK,
                SampleFlags::BREAK | SampleFlags::STICK,
                SampleFlags::STICK | SampleFlags::CHIRP,
                SampleFlags::CHIRP | 1 << SampleFlags::HELD_BACK_SHIFT,
                SampleFlags::LATE | 7 << SampleFlags::HELD_BACK_SHIFT,
            ] {
                for sign in [-1, 0, 1] {
                    let flags = SampleFlags(bits)
                        .with_phase(sign)
                        .with(SampleFlags::ENERGISED, reason != LimitReason::NotArmed)
                        .with_limit(reason);
                    for phases in all_phases() {
                        let row = Row {
                            flags,
                            phases,
                            ..Row::default()
                        };
                        assert_eq!(read(&of(&row)).unwrap(), (flags, phases));
                    }
                }
            }
        }
    }

    #[test]
    fn a_word_that_there_is_not_is_refused() {
        let good = of(&Row::default());
        for (column, word) in [
            (0, "slip"),
            (1, "breaks"),
            (2, ""),
            (3, "no-effect:contact"),
            (3, "bone-shaping:"),
            (3, "later"),
            (3, "tank:0"),
            (3, "tank:8"),
        ] {
            let mut words = good.clone();
            words[column] = word.to_owned();
            let error = read(&words).unwrap_err().to_string();
            assert!(error.contains(&format!("{word:?}")), "{error}");
        }
    }
}
