//! "Did you mean …?": the most similar of the known names.

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

/// " (did you mean NAME?)", to follow what was given in a message; empty without a name.
pub fn question(name: Option<&str>) -> String {
    name.map(|name| format!(" (did you mean {name}?)"))
        .unwrap_or_default()
}
