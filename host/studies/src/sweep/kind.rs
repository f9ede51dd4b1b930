//! Kinds of columns.

/// Kind of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Integers.
    Whole,
    /// Numbers.
    Number,
    /// Texts.
    Text,
}

impl Kind {
    const ALL: [(Self, &'static str); 3] = [
        (Self::Whole, "whole"),
        (Self::Number, "number"),
        (Self::Text, "text"),
    ];

    /// Name in a part file.
    pub(crate) fn name(self) -> &'static str {
        Self::ALL
            .iter()
            .find(|(kind, _)| *kind == self)
            .map_or("", |(_, name)| name)
    }

    /// Returns the kind with this name.
    pub(crate) fn of(name: &str) -> Option<Self> {
        Self::ALL
            .iter()
            .find(|(_, its)| *its == name)
            .map(|(kind, _)| *kind)
    }

    /// Returns the kind of a column with cells of both kinds.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (a, b) if a == b => a,
            (Self::Text, _) | (_, Self::Text) => Self::Text,
            _ => Self::Number,
        }
    }
}
