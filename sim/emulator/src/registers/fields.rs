//! Registers and their fields, as rows of a table.

/// A part of the chip.
pub(super) struct Part {
    pub(super) name: &'static str,
    pub(super) base: u32,
    pub(super) registers: &'static [Register],
}

/// A register.
pub(super) struct Register {
    pub(super) name: &'static str,
    pub(super) offset: u32,
    pub(super) reset: u32,
    /// Bits that are not configuration.
    pub(super) ignored: u32,
    pub(super) fields: &'static [Field],
}

/// A field of a register.
pub(super) struct Field {
    pub(super) name: &'static str,
    pub(super) shift: u32,
    pub(super) width: u32,
    /// Meaning of its values, from 0 on; a number where there is none.
    pub(super) words: &'static [&'static str],
    /// Shown only if it differs from its reset value.
    pub(super) is_brief: bool,
}

pub(super) const fn part(name: &'static str, base: u32, registers: &'static [Register]) -> Part {
    Part {
        name,
        base,
        registers,
    }
}

/// A register that is 0 after a reset.
pub(super) const fn register(
    name: &'static str,
    offset: u32,
    fields: &'static [Field],
) -> Register {
    Register {
        name,
        offset,
        reset: 0,
        ignored: 0,
        fields,
    }
}

impl Register {
    /// Returns the register with another value after a reset.
    pub(super) const fn from(mut self, reset: u32) -> Self {
        self.reset = reset;
        self
    }

    /// Returns the register without these bits.
    pub(super) const fn without(mut self, bits: u32) -> Self {
        self.ignored = bits;
        self
    }
}

impl Field {
    /// Shown only if it differs from its reset value.
    pub(super) const fn brief(mut self) -> Self {
        self.is_brief = true;
        self
    }
}

/// A flag.
pub(super) const fn bit(name: &'static str, shift: u32) -> Field {
    Field {
        name,
        shift,
        width: 1,
        words: &["off", "on"],
        is_brief: true,
    }
}

/// A field that is a number.
pub(super) const fn number(name: &'static str, shift: u32, width: u32) -> Field {
    Field {
        name,
        shift,
        width,
        words: &[],
        is_brief: true,
    }
}

/// A field whose values have meanings, shown with its reset value, too.
pub(super) const fn choice(
    name: &'static str,
    shift: u32,
    width: u32,
    words: &'static [&'static str],
) -> Field {
    Field {
        name,
        shift,
        width,
        words,
        is_brief: false,
    }
}
