//! The pins of the [board description](crepitus_device::board), as the HAL's types.
//!
//! A part takes `impl Into<tim5::Ch1>` and the like: a row of the description that names a pin without
//! that function does not compile.

use crepitus_device::board::Pull;
use stm32f4xx_hal::gpio::{self, gpioa, gpiob, gpioc};

/// The ports, split into pins.
pub(crate) struct Ports {
    pub(crate) a: gpioa::Parts,
    pub(crate) b: gpiob::Parts,
    pub(crate) c: gpioc::Parts,
}

macro_rules! fields {
    ($($name:ident $field:ident: $port:ident.$token:ident $type:ident; $mode:expr; $pull:ident;
        $function:literal; $part:literal; $to:literal; $at_rest:literal;)*) => {
        /// The pins, each by what it is for.
        pub(crate) struct Pins {
            $(
                #[doc = $part]
                pub(crate) $field: gpio::$type,
            )*
        }

        impl Pins {
            /// Takes them from their ports.
            pub(crate) fn of(ports: Ports) -> Self {
                Self { $($field: ports.$port.$token,)* }
            }
        }
    };
}

/// Pins of the drive.
pub(crate) mod drive {
    use super::{Ports, gpio};
    crepitus_device::with_drive_pins!(fields);
}

/// Pins of comms.
pub(crate) mod comms {
    use super::{Ports, gpio};
    crepitus_device::with_comms_pins!(fields);
}

/// The resistor in the chip that a connection needs.
pub(crate) const fn resistor(pull: Pull) -> gpio::Pull {
    match pull {
        Pull::Any => gpio::Pull::None,
        Pull::Up => gpio::Pull::Up,
        Pull::Down => gpio::Pull::Down,
    }
}
