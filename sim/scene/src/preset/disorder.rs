//! Disorder and severity of a preset, and the evidence for its numbers.

crepitus_model::named! {
    /// A group of presets: what an examiner tells apart.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Disorder {
        /// Manner in which the range of motion ends.
        EndFeel => "end-feel",
        /// Angle at which the range of motion ends.
        RangeDeficit => "range-deficit",
        /// Lead-pipe rigidity.
        Rigidity => "rigidity",
        /// Cogwheel rigidity.
        Cogwheel => "cogwheel",
        /// Spasticity.
        Spasticity => "spasticity",
        /// The clasp-knife phenomenon.
        ClaspKnife => "clasp-knife",
        /// Clonus.
        Clonus => "clonus",
        /// Roughness fixed to the angle.
        Texture => "texture",
        /// Crepitus by stick and slip.
        Crepitus => "crepitus",
    }
}

impl Disorder {
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

    /// Name that the disorder's scale has for a knee without it: no preset, but the effect's absence.
    pub const fn grade_0(self) -> Option<&'static str> {
        match self {
            Self::Rigidity | Self::Cogwheel => Some("UPDRS 0"),
            Self::Spasticity => Some("MAS 0"),
            Self::Clonus => Some("SCATS 0"),
            _ => None,
        }
    }
}

crepitus_model::named! {
    /// Severity of a preset on one scale for all disorders.
    ///
    /// Grades of different scales cannot be compared; an examiner who does not know the knee can
    /// still tell three levels apart. The mapping from a scale to these levels is ours, an
    /// estimate: `docs/symptoms.md` has it as a table.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
    pub enum Level {
        /// The lowest grades.
        Mild => "mild",
        /// The middle of the scale.
        Moderate => "moderate",
        /// The highest grades.
        Severe => "severe",
    }
}

crepitus_model::named! {
    /// Origin of a number.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Evidence {
        /// Taken from a publication.
        Sourced => "sourced",
        /// Computed from sourced numbers.
        Derived => "derived",
        /// An engineering estimate.
        Estimate => "estimate",
    }
}
