//! A fully associative cache of lines that replaces the least recently used.

#[derive(Clone, Copy, Debug)]
struct Slot {
    line: u32,
    /// Number of its last use.
    used: u64,
}

#[derive(Clone, Debug)]
pub(super) struct LineCache<const LINES: usize> {
    slots: [Option<Slot>; LINES],
    /// Number of uses until now.
    uses: u64,
}

impl<const LINES: usize> Default for LineCache<LINES> {
    fn default() -> Self {
        Self {
            slots: [None; LINES],
            uses: 0,
        }
    }
}

impl<const LINES: usize> LineCache<LINES> {
    pub(super) fn clear(&mut self) {
        self.slots = [None; LINES];
    }

    pub(super) fn contains(&self, line: u32) -> bool {
        self.slots.iter().flatten().any(|slot| slot.line == line)
    }

    /// Uses a line; returns whether it is there.
    pub(super) fn touch(&mut self, line: u32) -> bool {
        self.uses += 1;
        let mut slots = self.slots.iter_mut().flatten();
        let Some(slot) = slots.find(|slot| slot.line == line) else {
            return false;
        };
        slot.used = self.uses;
        true
    }

    /// Adds a line, in an empty slot or instead of the least recently used one.
    pub(super) fn insert(&mut self, line: u32) {
        self.uses += 1;
        let used = self.uses;
        let oldest = self
            .slots
            .iter_mut()
            .min_by_key(|slot| slot.map(|slot| slot.used));
        if let Some(slot) = oldest {
            *slot = Some(Slot { line, used });
        }
    }
}
