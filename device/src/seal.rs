//! Whether a controller's image is the one that was sealed after it was built.

/// What the seal in the vector table says of the image in flash.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Seal {
    /// There is none: a build that nobody has sealed.
    #[default]
    Absent,
    /// It fits the image.
    Intact,
    /// It does not.
    Broken,
}

impl Seal {
    /// Compares the seal with the checksum of the image. 0 is no seal.
    pub const fn of(seal: u32, checksum: u32) -> Self {
        if seal == 0 {
            Self::Absent
        } else if seal == checksum {
            Self::Intact
        } else {
            Self::Broken
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seal_fits_or_is_broken() {
        assert_eq!(Seal::of(7, 7), Seal::Intact);
        assert_eq!(Seal::of(7, 8), Seal::Broken);
        assert_eq!(Seal::of(0, 8), Seal::Absent);
    }
}
