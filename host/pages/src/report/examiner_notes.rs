//! Notes that an examiner would make on each symptom, in words.

use crate::plot::number::{count, fixed, rounded};
use crate::plot::page::Section;
use crate::report::collector::Figures;
use crate::report::symptoms::movement::Movement;
use crate::report::symptoms::occurrences::{Bout, Met, Occurrences};
use crate::report::symptoms::{Symptom, Symptoms};
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::effects::clonus::ClonusSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_scene::static_limits::spasticity;
use crepitus_scene::trace::Word;

/// Catches, collapses and stretches that are noted one by one.
const MOST: usize = 8;

/// A table for each symptom.
pub(crate) fn sections(figures: &Figures) -> Vec<Section> {
    let Some(Symptoms { settings, list, .. }) = &figures.symptoms else {
        return Vec::new();
    };
    let drawn = |symptom: &&Symptom| !symptom.timeline.line.is_empty();
    list.iter()
        .filter(drawn)
        .map(|symptom| section(symptom, settings))
        .collect()
}

type Row = (String, String);

fn section(symptom: &Symptom, settings: &EffectSettings) -> Section {
    let found = &symptom.found;
    let mut rows = Vec::new();
    match symptom.words.effect() {
        "range-limit" => ends(found, &mut rows),
        "spasticity" => catches(found, settings, &mut rows),
        "clasp-knife" => collapses(found, &mut rows),
        "clonus" => beats(found, settings.clonus.as_ref(), &mut rows),
        _ => {}
    }
    rates(&found.movement, &mut rows);
    let (nm, rad) = found.most;
    let against = if nm < 0.0 { "straightening" } else { "bending" };
    let largest = if nm == 0.0 {
        "none".to_owned()
    } else {
        format!("{} against {against}, at {}", torque(nm), angle(rad))
    };
    let row = |name: &str, value: String| (name.to_owned(), value);
    rows.push(row("largest resistance", largest));
    if let Some(whole) = found.loops.latest()
        && whole.area_j.abs() > 1e-4
    {
        let value = format!(
            "{} J, between {} and {}",
            rounded(whole.area_j),
            angle(whole.from_rad),
            angle(whole.to_rad)
        );
        rows.push(row("taken by one movement to and fro", value));
    }
    if symptom.shares_torque() {
        let value = "of everything that was rendered together".to_owned();
        rows.push(row("resistance", value));
    }
    if found.left_out > 0 {
        let value = format!("{} more, not shown one by one", count(found.left_out));
        rows.push(row("events", value));
    }
    Section {
        title: format!("On examination: {}", lower(symptom.words.title())),
        rows,
    }
}

/// A title within a sentence.
fn lower(title: &str) -> String {
    let mut letters = title.chars();
    match letters.next() {
        Some(first) => first.to_lowercase().chain(letters).collect(),
        None => String::new(),
    }
}

fn angle(rad: f64) -> String {
    format!("{}°", fixed(rad.to_degrees(), 1))
}

fn speed(rad_s: f64) -> String {
    format!("{} °/s", rounded(rad_s.abs().to_degrees()))
}

fn torque(nm: f64) -> String {
    format!("{} N·m", fixed(nm.abs(), 2))
}

fn ends(found: &Occurrences, rows: &mut Vec<Row>) {
    for (name, is_flexion) in [
        ("end met in extension", false),
        ("end met in flexion", true),
    ] {
        let met = found.met.iter();
        let of: Vec<&Met> = met
            .filter(|met| (met.event.omega_rad_s > 0.0) == is_flexion)
            .collect();
        let Some(hardest) = of
            .iter()
            .max_by(|a, b| a.beyond_rad.total_cmp(&b.beyond_rad))
        else {
            rows.push((name.to_owned(), "not met".to_owned()));
            continue;
        };
        let times = match of.len() {
            1 => String::new(),
            n => format!("; met {n} times"),
        };
        let value = format!(
            "at {}, at {}; {}{times}",
            angle(hardest.event.angle_rad),
            speed(hardest.event.omega_rad_s),
            pressed(hardest)
        );
        rows.push((name.to_owned(), value));
    }
}

/// Largest torque of an end, the angle within which it had that, and how far the joint was pressed on.
fn pressed(met: &Met) -> String {
    let (within, beyond) = (angle(met.within_rad), angle(met.beyond_rad));
    let on = if within == beyond {
        String::new()
    } else {
        format!(", pressed on to {beyond}")
    };
    format!("{} within {within}{on}", torque(met.most_nm))
}

fn catches(found: &Occurrences, settings: &EffectSettings, rows: &mut Vec<Row>) {
    let caught: Vec<&Met> = found.caught().collect();
    for (n, met) in (1..).zip(caught.iter().take(MOST)) {
        let event = &met.event;
        let (name, met_at) = if event.word == Word::Catch {
            ("catch", "caught at")
        } else {
            ("reflex", "began at")
        };
        let catches = settings.spasticity.filter(SpasticitySettings::catches);
        let height = catches.map_or(String::new(), |settings| {
            let nm = spasticity::catch_nm(&settings, event.omega_rad_s);
            format!(" with {}", torque(nm))
        });
        let value = format!(
            "{met_at} {} at {}{height}; {} were felt",
            angle(event.angle_rad),
            speed(event.omega_rad_s),
            torque(met.most_nm)
        );
        rows.push((format!("{name} {n}"), value));
    }
    match caught.len() {
        0 => {
            let value = "none: no stretch met the threshold".to_owned();
            rows.push(("catch".to_owned(), value));
        }
        n if n > MOST => rows.push(("catches".to_owned(), format!("{n} in all"))),
        _ => {}
    }
}

fn collapses(found: &Occurrences, rows: &mut Vec<Row>) {
    for (n, met) in (1..).zip(found.met.iter().take(MOST)) {
        let event = &met.event;
        let at = angle(event.angle_rad);
        let value = if event.word == Word::Release {
            let fifth = met.fifth_s.map_or(String::new(), |s| {
                format!("; a fifth was left after {} ms", rounded(1e3 * s))
            });
            format!(
                "collapsed at {at} from {}{fifth}",
                torque(event.torque_before_nm)
            )
        } else {
            format!(
                "began at {at}, rose to {}, did not collapse",
                torque(met.most_nm)
            )
        };
        rows.push((format!("stretch {n}"), value));
    }
    if found.met.is_empty() {
        rows.push(("stretch".to_owned(), "resistance never began".to_owned()));
    }
}

fn beats(found: &Occurrences, settings: Option<&ClonusSettings>, rows: &mut Vec<Row>) {
    for (n, bout) in (1..).zip(found.bouts.iter().take(MOST)) {
        let event = &bout.start;
        let stretch = format!("{} at {}", angle(event.angle_rad), speed(event.omega_rad_s));
        rows.push((
            format!("stretch {n}"),
            format!("{stretch}: {}", lasted(bout, found.beats_are_counted)),
        ));
    }
    if found.bouts.is_empty() {
        let threshold = settings.map_or_else(
            || "the threshold".to_owned(),
            |settings| {
                let hold = rounded(settings.hold_deg);
                let least = rounded(settings.start_velocity_deg_s);
                format!("{hold}° at {least} °/s or more")
            },
        );
        let value = format!("none: no stretch passed {threshold}");
        rows.push(("beats".to_owned(), value));
    }
    let pairs = found.beats.iter().zip(found.beats.iter().skip(1));
    let intervals: Vec<f64> = pairs
        .filter(|(from, to)| to.number == from.number + 1)
        .map(|(from, to)| 1e3 * (to.time_s - from.time_s))
        .collect();
    if let (Some(first), Some(last)) = (intervals.first(), intervals.last()) {
        let value = format!("first {} ms, last {} ms", rounded(*first), rounded(*last));
        rows.push(("from beat to beat".to_owned(), value));
    }
}

/// Number of beats, the duration of those that were felt, and the grade that the Spinal Cord Assessment Tool for
/// Spastic Reflexes gives for that. Where the torque is of more than clonus, beats cannot be
/// distinguished, and the phases of clonus say how long it lasted.
fn lasted(bout: &Bout, beats_are_counted: bool) -> String {
    let until_s = match bout.end {
        Some((_, end_s)) if !beats_are_counted => end_s,
        _ => bout.last_s,
    };
    let length_s = until_s - bout.start.time_s;
    // Held longer, the muscle might have beaten.
    if beats_are_counted && bout.beats == 0 {
        match bout.end {
            Some((Word::Done, _)) => {}
            Some(_) => return "let go before the first beat: no grade".to_owned(),
            None => return "the record ends before the first beat: no grade".to_owned(),
        }
    }
    let (grade, words) = match length_s {
        _ if beats_are_counted && bout.felt == 0 => (0, "no reaction"),
        s if s < 3.0 => (1, "mild, less than 3 s"),
        s if s <= 10.0 => (2, "moderate, 3 to 10 s"),
        _ => (3, "severe, more than 10 s"),
    };
    let beats = match bout.beats {
        _ if !beats_are_counted => "beats that cannot be told apart".to_owned(),
        1 => "1 beat".to_owned(),
        n => format!("{n} beats"),
    };
    let beats = match bout.beats - bout.felt {
        unfelt @ 1.. if beats_are_counted => {
            format!("{beats}, {unfelt} not felt as less than half the height was there,")
        }
        _ => beats,
    };
    let end = match bout.end {
        Some((Word::Done, _)) => "ended by itself;",
        Some(_) => "ended as the muscle was let go, so at least",
        None if !beats_are_counted => return format!("{beats}, went on to the end"),
        None => "went on to the end, so at least",
    };
    format!(
        "{beats} in {} s, {end} SCATS {grade}: {words}",
        fixed(length_s, 1)
    )
}

fn rates(movement: &Movement, rows: &mut Vec<Row>) {
    for rate in &movement.rates {
        let name = if rate.word == Word::Snap {
            "snaps"
        } else {
            "gives"
        };
        let value = format!(
            "{}: {} a second while it moved, at a mean speed of {}",
            count(rate.count),
            rounded(rate.count as f64 / movement.moving_s),
            speed(movement.travel_rad / movement.moving_s)
        );
        rows.push((name.to_owned(), value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_scene::trace::SymptomEvent;

    fn bout(beats: u32, last_s: f64, end: Option<(Word, f64)>) -> Bout {
        let start = SymptomEvent {
            time_s: 1.0,
            effect: "clonus",
            word: Word::Start,
            angle_rad: 0.0,
            omega_rad_s: 2.0,
            torque_before_nm: 0.0,
            torque_after_nm: 0.0,
        };
        Bout {
            start,
            beats,
            felt: beats,
            last_s,
            end,
        }
    }

    #[test]
    fn what_the_examiner_ended_or_cannot_be_told_apart_is_no_grade_of_its_own() {
        let done = Some((Word::Done, 5.2));
        let stop = Some((Word::Stop, 5.2));
        for (bout, are_told, expected) in [
            (
                bout(20, 5.0, done),
                true,
                "20 beats in 4.0 s, ended by itself; SCATS 2: moderate, 3 to 10 s",
            ),
            (
                bout(20, 5.0, stop),
                true,
                "20 beats in 4.0 s, ended as the muscle was let go, so at least SCATS 2: moderate, 3 to 10 s",
            ),
            (
                bout(0, 1.0, stop),
                true,
                "let go before the first beat: no grade",
            ),
            (
                bout(0, 1.0, None),
                true,
                "the record ends before the first beat: no grade",
            ),
            (
                bout(0, 1.0, done),
                true,
                "0 beats in 0.0 s, ended by itself; SCATS 0: no reaction",
            ),
            (
                bout(20, 5.0, None),
                true,
                "20 beats in 4.0 s, went on to the end, so at least SCATS 2: moderate, 3 to 10 s",
            ),
            // With crepitus or another disorder in the torque.
            (
                bout(0, 1.0, done),
                false,
                "beats that cannot be told apart in 4.2 s, ended by itself; SCATS 2: moderate, 3 to 10 s",
            ),
            (
                bout(0, 1.0, None),
                false,
                "beats that cannot be told apart, went on to the end",
            ),
        ] {
            assert_eq!(lasted(&bout, are_told), expected);
        }
    }

    #[test]
    fn beats_that_were_not_felt_are_in_no_grade() {
        let done = Some((Word::Done, 5.2));
        let of = |felt, last_s| Bout {
            felt,
            ..bout(20, last_s, done)
        };
        assert_eq!(
            lasted(&of(12, 3.0), true),
            "20 beats, 8 not felt as less than half the height was there, in 2.0 s, ended by itself; SCATS 1: mild, less than 3 s"
        );
        assert!(lasted(&of(0, 1.0), true).ends_with("SCATS 0: no reaction"));
    }
}
