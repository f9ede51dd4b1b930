//! "Did you mean …?": the most similar of the known names.

use crate::preset;
use crate::shipped::SHIPPED;

/// The least Jaro-Winkler similarity, from 0 to 1, of a suggestion.
const ALIKE: f64 = 0.85;

/// The name that is most similar to `given`, regardless of case; `None` if no name is similar.
pub fn similar<'n>(names: impl Iterator<Item = &'n str>, given: &str) -> Option<&'n str> {
    let given = given.to_lowercase();
    names
        .map(|name| (strsim::jaro_winkler(&name.to_lowercase(), &given), name))
        .filter(|(likeness, _)| *likeness > ALIKE)
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, name)| name)
}

/// The most similar name of a scene that ships.
pub fn scene(given: &str) -> Option<&'static str> {
    similar(SHIPPED.iter().map(|scene| scene.name), given)
}

/// The most similar name of a preset that ships.
pub fn preset(given: &str) -> Option<&'static str> {
    let names = preset::shipped().iter().map(|preset| preset.name.as_str());
    similar(names, given)
}

/// " (did you mean NAME?)", to follow what was given in a message; empty without a name.
pub fn question(name: Option<&str>) -> String {
    name.map(|name| format!(" (did you mean {name}?)"))
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_finger_leads_to_the_name() {
        for (given, meant) in [
            ("slow-examinatoin", Some("slow-examination")),
            ("Slow-Examination", Some("slow-examination")),
            ("tardieu-fats", Some("tardieu-fast")),
            ("", None),
            ("q", None),
            ("no-such-scene", None),
        ] {
            assert_eq!(scene(given), meant, "{given:?}");
        }
        assert_eq!(preset("mas-2-katch"), Some("mas-2-catch"));
        assert_eq!(preset("nothing-like-it"), None);
        assert_eq!(question(Some("a")), " (did you mean a?)");
        assert_eq!(question(None), "");
    }
}
