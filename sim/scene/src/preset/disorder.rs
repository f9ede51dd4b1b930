//! What a preset renders, how severe it is, and how well founded its numbers are.

/// A group of presets: what an examiner tells apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Disorder {
    /// How the range of motion ends.
    EndFeel,
    /// Where it ends.
    RangeDeficit,
    /// Lead-pipe rigidity.
    Rigidity,
    /// Cogwheel rigidity.
    Cogwheel,
    /// Spasticity.
    Spasticity,
    /// The clasp-knife phenomenon.
    ClaspKnife,
    /// Clonus.
    Clonus,
    /// Roughness fixed to the angle.
    Texture,
    /// Crepitus by stick and slip.
    Crepitus,
}

impl Disorder {
    /// All, in the order of lists.
    pub const ALL: [Self; 9] = [
        Self::EndFeel,
        Self::RangeDeficit,
        Self::Rigidity,
        Self::Cogwheel,
        Self::Spasticity,
        Self::ClaspKnife,
        Self::Clonus,
        Self::Texture,
        Self::Crepitus,
    ];

    /// Name in preset files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::EndFeel => "end-feel",
            Self::RangeDeficit => "range-deficit",
            Self::Rigidity => "rigidity",
            Self::Cogwheel => "cogwheel",
            Self::Spasticity => "spasticity",
            Self::ClaspKnife => "clasp-knife",
            Self::Clonus => "clonus",
            Self::Texture => "texture",
            Self::Crepitus => "crepitus",
        }
    }

    /// Heading of its presets.
    pub const fn heading(self) -> &'static str {
        match self {
            Self::EndFeel => "End-feel: how the range ends",
            Self::RangeDeficit => "Range deficit: where the range ends",
            Self::Rigidity => "Rigidity, lead-pipe (UPDRS)",
            Self::Cogwheel => "Rigidity, cogwheel (UPDRS)",
            Self::Spasticity => "Spasticity (modified Ashworth scale, MAS)",
            Self::ClaspKnife => "Clasp-knife phenomenon",
            Self::Clonus => "Clonus (SCATS)",
            Self::Texture => "Roughness at fixed angles",
            Self::Crepitus => "Crepitus by stick and slip",
        }
    }

    /// What its scale calls a knee without it: no preset, but the effect's absence.
    pub const fn grade_0(self) -> Option<&'static str> {
        match self {
            Self::Rigidity | Self::Cogwheel => Some("UPDRS 0"),
            Self::Spasticity => Some("MAS 0"),
            Self::Clonus => Some("SCATS 0"),
            _ => None,
        }
    }
}

/// Severity of a preset on one scale for all disorders.
///
/// Grades of different scales cannot be compared; an examiner who does not know the knee can
/// still tell three levels apart. The mapping from a scale to these levels is ours, an
/// estimate: `docs/symptoms.md` has it as a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Level {
    /// The lowest grades.
    Mild,
    /// The middle of the scale.
    Moderate,
    /// The highest grades.
    Severe,
}

impl Level {
    /// All, in ascending order.
    pub const ALL: [Self; 3] = [Self::Mild, Self::Moderate, Self::Severe];

    /// Name in preset files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mild => "mild",
            Self::Moderate => "moderate",
            Self::Severe => "severe",
        }
    }
}

/// Origin of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Evidence {
    /// Taken from a publication.
    Sourced,
    /// Computed from sourced numbers.
    Derived,
    /// An engineering estimate.
    Estimate,
}

impl Evidence {
    /// All, best first.
    pub const ALL: [Self; 3] = [Self::Sourced, Self::Derived, Self::Estimate];

    /// Name in preset files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sourced => "sourced",
            Self::Derived => "derived",
            Self::Estimate => "estimate",
        }
    }
}
