//! The sets of parameters that there may be, and which of them are valid.

use crepitus_protocol::{DeviceSettings, Values, pieces};

/// Sets of parameters that were saved or committed, and the defaults.
pub(crate) struct KnownValues(Vec<Known>);

struct Known {
    values: Values,
    /// Seal of the values for start 0 of comms, which stands for any start.
    seal: u32,
    is_valid: bool,
}

impl KnownValues {
    /// The defaults, and a set that was saved.
    pub(crate) fn new(saved: Option<Values>) -> Self {
        let mut known = Self(Vec::new());
        known.add(&Values::default());
        if let Some(values) = saved {
            known.add(&values);
        }
        known
    }

    /// A host has sent these.
    pub(crate) fn add(&mut self, values: &Values) {
        self.0.push(Known {
            values: *values,
            seal: pieces::seal(&values.0, 0),
            is_valid: DeviceSettings::of(values).is_ok(),
        });
    }

    /// They were refused: forgets them once.
    pub(crate) fn withdraw(&mut self, values: &Values) {
        let seal = pieces::seal(&values.0, 0);
        // The newest; there may be the same from before.
        if let Some(place) = self.0.iter().rposition(|known| known.seal == seal) {
            self.0.remove(place);
        }
    }

    /// Returns whether these are known, and valid.
    pub(crate) fn has(&self, values: &Values) -> bool {
        self.valid().any(|known| known.values == *values)
    }

    /// The valid set with this seal of a start of comms.
    pub(crate) fn by_seal(&self, seal: u32, comms_start: u16) -> Option<&Values> {
        let empty = pieces::seal(&[], comms_start) ^ pieces::seal(&[], 0);
        self.valid()
            .find(|known| known.seal ^ empty == seal)
            .map(|known| &known.values)
    }

    fn valid(&self) -> impl Iterator<Item = &Known> {
        self.0.iter().filter(|known| known.is_valid)
    }
}
