//! The catalogue of hard cases as data, in the order of their numbers.
//!
//! From H38 to H56 are those that were added to detect planted faults, from H57 on those
//! of symptoms besides crepitus, from H76 on those of the vibration actuator,
//! from H88 on those that others have found. A case that
//! ends in `L` is the long version of the one before it: hours of simulated
//! time. To add a case, write one like its neighbours into the table of its theme;
//! tests, matrix and report follow.

mod actuator;
mod arithmetic;
mod commits;
mod damping;
mod device;
mod encoder;
mod ends;
mod extremes;
mod gaps;
mod motions;
mod off_grid;
mod refusals;
mod reversals;
mod rounding;
mod steady;
mod symptom_energy;
mod symptom_muscles;
mod symptom_rigidity;
mod symptom_tools;
mod symptom_walls;
mod tank_empty;
mod ties;
mod time;
mod tools;

use super::case::Case;

pub(crate) use motions::WANDER;

/// The tables of the themes.
const TABLES: [&[Case]; 21] = [
    actuator::CASES,
    arithmetic::CASES,
    commits::CASES,
    damping::CASES,
    device::CASES,
    encoder::CASES,
    ends::CASES,
    extremes::CASES,
    gaps::CASES,
    off_grid::CASES,
    refusals::CASES,
    reversals::CASES,
    rounding::CASES,
    steady::CASES,
    symptom_energy::CASES,
    symptom_muscles::CASES,
    symptom_rigidity::CASES,
    symptom_walls::CASES,
    tank_empty::CASES,
    ties::CASES,
    time::CASES,
];

/// All cases, in the order of their numbers.
pub fn all() -> Vec<Case> {
    let mut all = TABLES.concat();
    // H03L follows H03.
    all.sort_by_key(|case| (case.id.trim_end_matches('L').len(), case.id));
    all
}

/// Finds a case by its number or its name.
///
/// # Errors
/// Names similar to `wanted`, the likeliest first; none if none is.
pub fn find(wanted: &str) -> Result<Case, Vec<&'static str>> {
    let all = all();
    let wanted = wanted.to_lowercase();
    if let Some(case) = all
        .iter()
        .find(|case| case.name == wanted || case.id.to_lowercase() == wanted)
    {
        return Ok(case.clone());
    }
    let mut near: Vec<(usize, &'static str)> = all
        .iter()
        .map(|case| (strsim::levenshtein(case.name, &wanted), case.name))
        .filter(|(distance, name)| 2 * distance <= name.len() || name.contains(&wanted))
        .collect();
    near.sort_unstable();
    Err(near.into_iter().map(|(_, name)| name).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::path::Path;

    #[test]
    fn cases_are_found_by_number_and_name_and_slips_of_the_pen_lead_there() {
        assert_eq!(find("h01").unwrap().name, "constant-speed");
        assert_eq!(find("constant-speed").unwrap().id, "H01");
        assert_eq!(find("constant-sped").unwrap_err()[0], "constant-speed");
        assert!(find("velocity").unwrap_err().len() > 1);
        assert_eq!(find("xyzzy").unwrap_err(), [""; 0]);
    }

    /// Pages, source files and reference cases that a case names, and the part of a page after a comma.
    #[test]
    fn every_source_is_there() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let references = fs::read_dir(root.join("tests/reference-cases")).unwrap();
        let references: Vec<_> = references.map(|f| f.unwrap().file_name()).collect();
        let (mut pages, mut cases) = (0, 0);
        for case in all() {
            let stops = |c: char| c == ' ' || ",;:".contains(c);
            for word in case.source.split(stops) {
                if ["docs/", "model/", "tests/"]
                    .iter()
                    .any(|folder| word.starts_with(folder))
                {
                    assert!(
                        root.join(word).exists(),
                        "{}: {word} does not exist",
                        case.name
                    );
                }
                if case.source.contains("reference-cases") && is_reference(word) {
                    cases += 1;
                    let mut files = references.iter().map(|file| file.to_string_lossy());
                    assert!(
                        files.any(|file| file.starts_with(word)),
                        "{}: {word}",
                        case.name
                    );
                }
            }
            if let Some((page, part)) = case.source.split_once(".md, ") {
                pages += 1;
                let page = page.rsplit(' ').next().unwrap_or_default();
                let text = fs::read_to_string(root.join(page).with_extension("md")).unwrap();
                let part = part.split([',', ';', ':']).next().unwrap_or_default();
                let has = text.to_lowercase().contains(&part.to_lowercase());
                assert!(has, "{}: {page}.md has no \"{part}\"", case.name);
            }
        }
        assert!(pages > 20 && cases > 20, "{pages} {cases}");
    }

    /// A letter and two digits, and not a precision.
    fn is_reference(word: &str) -> bool {
        let is_case = |[letter, a, b]: [u8; 3]| {
            letter.is_ascii_lowercase() && a.is_ascii_digit() && b.is_ascii_digit()
        };
        let begin = word.as_bytes().first_chunk();
        begin.is_some_and(|begin| is_case(*begin)) && !["f32", "f64"].contains(&word)
    }
}
