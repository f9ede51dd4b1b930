//! Self-test of a controller at its start: image, crystal and option bytes.

/// Brown-out level in the option bytes: 0 is level 3, the highest, 2.7 V.
const BROWN_OUT_LEVEL: u32 = 0b11 << 2;

/// The watchdog is started by software. One that hardware starts would bite while
/// flash is erased.
const SOFTWARE_WATCHDOG: u32 = 1 << 5;

/// Result of the tests at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SelfTest {
    /// No error.
    #[default]
    Passed,
    /// Flash does not hold the image that was sealed.
    ImageBroken,
    /// The crystal has another frequency than the board's.
    CrystalWrong,
    /// The chip is not set up as this board needs it.
    OptionBytesWrong,
}

impl SelfTest {
    /// Compares the image's seal with the checksum of flash, and looks at crystal and option
    /// bytes, as in `FLASH_OPTCR`. A seal of 0 is none: a build that nobody has sealed.
    pub const fn of(seal: u32, checksum: u32, option_bytes: u32, has_its_crystal: bool) -> Self {
        if seal != 0 && seal != checksum {
            Self::ImageBroken
        } else if !has_its_crystal {
            Self::CrystalWrong
        } else if option_bytes & (BROWN_OUT_LEVEL | SOFTWARE_WATCHDOG) != SOFTWARE_WATCHDOG {
            Self::OptionBytesWrong
        } else {
            Self::Passed
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Brown-out level 3, software watchdog, no read-out protection.
    const RIGHT: u32 = 0x0fff_aae1;

    #[test]
    fn a_seal_fits_or_there_is_none() {
        assert_eq!(SelfTest::of(7, 7, RIGHT, true), SelfTest::Passed);
        assert_eq!(SelfTest::of(0, 8, RIGHT, true), SelfTest::Passed);
        assert_eq!(SelfTest::of(7, 8, RIGHT, true), SelfTest::ImageBroken);
    }

    #[test]
    fn another_crystal_is_named() {
        assert_eq!(SelfTest::of(7, 7, RIGHT, false), SelfTest::CrystalWrong);
        assert_eq!(SelfTest::of(7, 8, RIGHT, false), SelfTest::ImageBroken);
    }

    #[test]
    fn option_bytes_are_those_of_the_board() {
        // As they come from the factory: no brown-out reset.
        for wrong in [
            0x0fff_aaed,
            RIGHT | 1 << 2,
            RIGHT | 1 << 3,
            RIGHT & !(1 << 5),
        ] {
            assert_eq!(SelfTest::of(7, 7, wrong, true), SelfTest::OptionBytesWrong);
        }
        // Read-out protection and write protection are the builder's.
        for right in [0x0fff_00e1, 0x0000_aae1, RIGHT & !1] {
            assert_eq!(SelfTest::of(7, 7, right, true), SelfTest::Passed);
        }
    }
}
