//! Phase of an effect: what it does now, in a word.

use super::{EffectSpec, SPECS};
use crate::parameters::same;

/// The phases of an effect, as traces and telemetry show them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhaseSpec {
    /// Column of a trace: the number of the phase.
    pub column: &'static str,
    /// Their names in the order of their numbers; the first is the one at rest.
    pub names: &'static [&'static str],
}

/// The phase of every effect: in the order of the table, the first lowest, each
/// in its [`EffectSpec::phase_bits`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Phases(pub u16);

impl EffectSpec {
    /// Bits that hold the number of any of its phases.
    pub const fn phase_bits(&self) -> u32 {
        match &self.phases {
            Some(phases) => match phases.names.len().saturating_sub(1).checked_ilog2() {
                Some(log) => log + 1,
                None => 0,
            },
            None => 0,
        }
    }

    /// Place of its bits.
    pub(super) const fn place(&self) -> Place {
        Place {
            shift: bits(SPECS, self.name),
            mask: (1_u16 << self.phase_bits()).wrapping_sub(1),
        }
    }
}

/// Place of the bits of an effect.
#[derive(Clone, Copy)]
pub(super) struct Place {
    shift: u32,
    mask: u16,
}

impl Phases {
    /// Bits in use.
    pub const BITS: u32 = bits(SPECS, "");

    /// The number of an effect's phase.
    pub fn get(self, spec: &EffectSpec) -> u16 {
        let Place { shift, mask } = spec.place();
        self.0.unbounded_shr(shift) & mask
    }

    /// Returns these phases with that of one more effect, which was at rest.
    #[inline]
    #[must_use]
    pub(super) const fn with(self, place: Place, number: u16) -> Self {
        Self(self.0 | (number & place.mask).unbounded_shl(place.shift))
    }

    /// Adds the phase of one more effect, by the names of both; `None` if there is none.
    #[must_use]
    pub fn with_named(self, effect: &str, phase: &str) -> Option<Self> {
        let spec = SPECS.iter().find(|spec| spec.name == effect)?;
        let number = spec.phases?.names.iter().position(|name| *name == phase)?;
        Some(self.with(spec.place(), u16::try_from(number).ok()?))
    }

    /// The effects that are not at rest, with the names of their phases.
    pub fn named(self) -> impl Iterator<Item = (&'static EffectSpec, &'static str)> {
        SPECS.iter().filter_map(move |spec| {
            let number = usize::from(self.get(spec));
            let name = spec.phases?.names.get(number)?;
            (number > 0).then_some((spec, *name))
        })
    }
}

/// Bits of the effects before the one with this name; of all if none has it.
const fn bits(mut specs: &[EffectSpec], name: &str) -> u32 {
    let mut bits = 0;
    while let [spec, rest @ ..] = specs {
        if same(spec.name, name) {
            return bits;
        }
        bits += spec.phase_bits();
        specs = rest;
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn spec(name: &'static str, names: &'static [&'static str]) -> EffectSpec {
        EffectSpec {
            name,
            phases: Some(PhaseSpec {
                column: "phase",
                names,
            }),
            ..SPECS[0]
        }
    }

    #[test]
    fn each_effect_has_as_many_bits_as_its_phases_need() {
        const SIX: [EffectSpec; 6] = [
            spec("none", &[]),
            spec("one", &["rest"]),
            spec("two", &["rest", "contact"]),
            EffectSpec {
                phases: None,
                ..SPECS[0]
            },
            spec("four", &["rest", "a", "b", "c"]),
            spec("five", &["rest", "a", "b", "c", "d"]),
        ];
        assert_eq!(SIX.map(|spec| spec.phase_bits()), [0, 0, 1, 0, 2, 3]);
        assert_eq!(SIX.map(|spec| bits(&SIX, spec.name)), [0, 0, 0, 1, 1, 3]);
        assert_eq!(bits(&SIX, ""), 6);
    }

    #[test]
    fn a_phase_reads_back_and_leaves_the_others() {
        let (low, high) = (Place { shift: 0, mask: 1 }, Place { shift: 1, mask: 3 });
        assert_eq!(Phases::default().with(low, 1).with(high, 2), Phases(0b101));
        // More than there are: cut, not written over its neighbour.
        assert_eq!(Phases::default().with(low, 6), Phases(0));
        assert_eq!(Phases(u16::MAX).with_named("no-effect", "rest"), None);
        for spec in SPECS {
            for name in spec.phases.iter().flat_map(|phases| phases.names).skip(1) {
                let phases = Phases(0).with_named(spec.name, name).unwrap();
                let [(of, is)] = phases.named().collect::<std::vec::Vec<_>>()[..] else {
                    panic!("{name}: one effect is not at rest");
                };
                assert_eq!((of.name, is), (spec.name, *name));
                assert_eq!(Phases(0).with_named(spec.name, "no-phase"), None);
            }
        }
        assert_eq!(Phases(0).named().count(), 0);
    }
}
