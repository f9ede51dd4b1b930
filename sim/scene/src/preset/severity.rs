//! Milder and worse forms of a knee: the scale of its disorder.

use super::{Preset, shipped};
use crepitus_plant::assembly::Listed;

impl Preset {
    /// Returns the next preset that ships of the same disorder and form, worse or milder; `None` at the end of the
    /// scale, and for a preset without a level.
    ///
    /// The scale is that of [`Level`](super::Level), and within a level the order of the list. Presets of one
    /// effect with other choices, as the two forms of spasticity, are other forms.
    pub fn neighbour(&self, worse: bool) -> Option<&'static Self> {
        let is_on_scale = |other: &&Self| {
            other.disorder == self.disorder && other.level.is_some() && self.has_form_of(other)
        };
        let mut scale: Vec<_> = shipped().iter().filter(is_on_scale).collect();
        scale.sort_by_key(|preset| preset.level);
        let place = scale.iter().position(|preset| preset.name == self.name)?;
        let next = if worse {
            place.checked_add(1)
        } else {
            place.checked_sub(1)
        };
        scale.get(next?).copied()
    }

    /// Returns whether no effect that both have differs in a choice.
    fn has_form_of(&self, other: &Self) -> bool {
        let differs = |own: &Listed| {
            let mut effects = other.listed.iter();
            let same = effects.find(|listed| listed.effect.name == own.effect.name);
            same.is_some_and(|same| same.given.choices != own.given.choices)
        };
        !self.listed.iter().any(differs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset::find;

    /// Names from a preset on, in one direction.
    fn walk(name: &str, worse: bool) -> Vec<&'static str> {
        let mut now = find(name).unwrap();
        let mut names = vec![now.name.as_str()];
        while let Some(next) = now.neighbour(worse) {
            let is_ordered = if worse {
                next.level >= now.level
            } else {
                next.level <= now.level
            };
            assert!(is_ordered, "{}", next.name);
            now = next;
            names.push(now.name.as_str());
            assert!(names.len() < 10, "{names:?}");
        }
        names
    }

    #[test]
    fn a_scale_keeps_its_form() {
        let catches = [
            "mas-1-catch",
            "mas-1plus-catch",
            "mas-2-catch",
            "mas-3-catch",
            "mas-4-lead-pipe",
        ];
        assert_eq!(walk("mas-1-catch", true), catches);
        let reflexes = ["mas-2-reflex", "mas-1plus-reflex", "mas-1-reflex"];
        assert_eq!(walk("mas-2-reflex", false), reflexes);
        // The list has another order.
        assert_eq!(walk("fine", true), ["fine", "coarse", "bone-on-bone"]);
        let contractures = [
            "contracture-severe",
            "contracture-moderate",
            "contracture-mild",
        ];
        assert_eq!(walk("contracture-severe", false), contractures);
    }

    #[test]
    fn without_a_level_there_is_no_scale() {
        for name in ["end-feel-soft", "bone-block"] {
            let preset = find(name).unwrap();
            assert!(preset.neighbour(true).is_none() && preset.neighbour(false).is_none());
        }
        assert!(Preset::default().neighbour(true).is_none());
    }
}
