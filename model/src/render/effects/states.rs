//! States of the effects: every phase of every effect that is not its rest, a bit each.

use super::{Phases, SPECS};

/// A state: an effect that is in a phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StateName {
    /// The effect.
    pub effect: &'static str,
    /// Phase of the effect.
    pub phase: &'static str,
}

/// All states; the place of one is its bit in [`Phases::states`].
pub const STATES: [StateName; COUNT] = named();

const COUNT: usize = count();
// The states of a tick have 32 bits.
const _: () = assert!(COUNT <= 32);

const fn count() -> usize {
    let mut specs = SPECS;
    let mut count = 0;
    while let [spec, rest @ ..] = specs {
        if let Some(phases) = &spec.phases {
            count += phases.names.len() - 1;
        }
        specs = rest;
    }
    count
}

#[expect(clippy::indexing_slicing, reason = "at compile time")]
const fn named() -> [StateName; COUNT] {
    let mut names = [StateName {
        effect: "",
        phase: "",
    }; COUNT];
    let mut specs = SPECS;
    let mut at = 0;
    while let [spec, rest @ ..] = specs {
        if let Some(phases) = &spec.phases {
            // The first is the one at rest.
            let mut number = 1;
            while number < phases.names.len() {
                names[at] = StateName {
                    effect: spec.name,
                    phase: phases.names[number],
                };
                at += 1;
                number += 1;
            }
        }
        specs = rest;
    }
    names
}

impl Phases {
    /// The states of these phases, a bit each.
    pub fn states(self) -> u32 {
        if self == Self::default() {
            return 0;
        }
        let mut states = 0;
        let mut first = 0;
        for spec in SPECS {
            let Some(names) = spec.phases.map(|phases| phases.names) else {
                continue;
            };
            let number = u32::from(self.get(spec));
            if number > 0 {
                states |= 1_u32.unbounded_shl(first + number - 1);
            }
            first += u32::try_from(names.len().saturating_sub(1)).unwrap_or(0);
        }
        states
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_state_has_its_bit() {
        assert_eq!(Phases::default().states(), 0);
        for (place, state) in STATES.iter().enumerate() {
            let phases = Phases::default()
                .with_named(state.effect, state.phase)
                .unwrap();
            assert_eq!(phases.states(), 1 << place, "{state:?}");
        }
    }

    #[test]
    fn two_effects_at_once_are_two_bits() {
        let [first, .., last] = STATES;
        let phases = Phases::default()
            .with_named(first.effect, first.phase)
            .and_then(|phases| phases.with_named(last.effect, last.phase))
            .unwrap();
        assert_eq!(phases.states().count_ones(), 2);
    }
}
