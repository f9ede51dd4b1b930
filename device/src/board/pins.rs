//! Pins of both boards, as rows of two lists.
//!
//! `with_drive_pins!` and `with_comms_pins!` hand their rows to a macro: here they become
//! constants, in `firmware/board` fields with the HAL's types, where a pin that lacks the function of its
//! part does not compile.
//!
//! ```text
//! constant  field: port.pin of type;  mode;  resistor in the chip;  function;  part;  other end;  level at rest
//! ```

use core::fmt;

/// A pin: PB12 is port 'B', number 12.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pin {
    /// Port, a capital letter.
    pub port: char,
    /// Number in its port, 0 to 15.
    pub number: u8,
}

impl Pin {
    /// The pin of a name such as "PB12".
    ///
    /// # Panics
    /// At compile time, if that is the name of none.
    #[expect(clippy::panic, reason = "evaluated at compile time only")]
    const fn named(name: &str) -> Self {
        let (port, number) = match name.as_bytes() {
            [b'P', port, ones] => (*port, ones.wrapping_sub(b'0')),
            [b'P', port, b'1', ones] => (*port, ones.wrapping_sub(b'0').saturating_add(10)),
            _ => panic!("no pin"),
        };
        assert!(port.is_ascii_uppercase() && number < 16, "no pin");
        Self {
            port: port as char,
            number,
        }
    }
}

impl fmt::Display for Pin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "P{}{}", self.port, self.number)
    }
}

/// Mode of a pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// Read by the program.
    Input,
    /// Driven by the program.
    Output,
    /// Connected to a peripheral, by the number of the alternate function.
    Alternate(u8),
    /// Connected to a converter.
    Analog,
}

/// Resistor in the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pull {
    /// None needed; what the chip has is not checked.
    Any,
    /// Resistor to the supply.
    Up,
    /// Resistor to ground.
    Down,
}

/// A connection between a pin and a part of the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Connection {
    /// The pin.
    pub pin: Pin,
    /// Its mode.
    pub mode: Mode,
    /// Resistor in the chip.
    pub pull: Pull,
    /// Function of the chip, as the data sheet names it; empty of a plain pin.
    pub function: &'static str,
    /// Its purpose.
    pub part: &'static str,
    /// The other end of its wire.
    pub to: &'static str,
    /// Level without a program.
    pub at_rest: &'static str,
}

/// Hands the rows of the drive's pins to a macro.
#[macro_export]
macro_rules! with_drive_pins {
    ($then:path) => {
        $then! {
            UPPER_A upper_a: a.pa8 PA8; Alternate(1); Down; "TIM1 CH1"; "upper switch of half A";
                "gate 1, input 1"; "pulled down";
            LOWER_A lower_a: b.pb13 PB13; Alternate(1); Down; "TIM1 CH1N"; "lower switch of half A";
                "gate 1, input 2"; "pulled down";
            UPPER_B upper_b: a.pa9 PA9; Alternate(1); Down; "TIM1 CH2"; "upper switch of half B";
                "gate 1, input 3; nothing else: on a board with USB this is VBUS, whose wire has to go"; "pulled down";
            LOWER_B lower_b: b.pb14 PB14; Alternate(1); Down; "TIM1 CH2N"; "lower switch of half B";
                "gate 1, input 4"; "pulled down";
            BREAK breaks: b.pb12 PB12; Alternate(1); Down; "TIM1 BKIN"; "break line";
                "comparators and the bridge's nFAULT, low is a break; the filter's 4.7 kΩ *there*, its 1 kΩ and 470 pF at the pin";
                "low if the wire is broken";
            SENSOR sensor: c.pc0 PC0; Analog; Any; "ADC1 IN10"; "amplifier of the sensor";
                "by 100 Ω and 1 nF"; "1.65 V";
            MONITOR monitor: c.pc1 PC1; Analog; Any; "ADC2 IN11"; "amplifier of the monitor";
                "by 100 Ω and 1 nF"; "1.65 V";
            SUPPLY supply: c.pc3 PC3; Analog; Any; "ADC3 IN13"; "divider of the supply";
                "the bridge's supply by 150 kΩ and 10 kΩ, 100 nF at the pin"; "24 V: 1.5 V";
            MOTOR motor: a.pa2 PA2; Analog; Any; "ADC3 IN2"; "temperature of the motor";
                "MCP9700 on the motor's housing, 100 nF at the pin"; "25 °C: 0.75 V";
            JOINT joint: c.pc2 PC2; Analog; Any; "ADC3 IN12"; "sensor of the joint";
                "AS5600 on the hinge, its analog output, 100 nF at the pin; 10 kΩ to ground where there is none"; "";
            COIL coil: a.pa3 PA3; Analog; Any; "ADC3 IN3"; "amplifier of the coil";
                "by 100 Ω and 1 nF; 10 kΩ to ground where there is none"; "1.65 V";
            ENCODER_A encoder_a: a.pa0 PA0; Alternate(2); Up; "TIM5 CH1"; "encoder A";
                "the RS-422 receiver; no button"; "pulled up";
            ENCODER_B encoder_b: a.pa1 PA1; Alternate(2); Up; "TIM5 CH2"; "encoder B";
                "the RS-422 receiver"; "pulled up";
            LINE line: b.pb0 PB0; Output; Any; ""; "enable line";
                "gate 1, 10 kΩ to ground *there*"; "low";
            LINE_BACK line_back: b.pb1 PB1; Input; Down; ""; "read-back of the enable line";
                "PB0's line at gate 1, by a wire of its own and 1 kΩ"; "pulled down";
            COMMS_LINE comms_line: b.pb10 PB10; Input; Down; ""; "enable line of comms";
                "its line at gate 2, by a wire of its own and 1 kΩ"; "pulled down";
            LINK_SENDS link_sends: c.pc6 PC6; Alternate(8); Any; "USART6 TX"; "link to comms";
                "PC7 of comms, 33 Ω here"; "high";
            LINK_RECEIVES link_receives: c.pc7 PC7; Alternate(8); Up; "USART6 RX"; "link from comms";
                "PC6 of comms"; "high";
            COIL_IN1 coil_in1: c.pc8 PC8; Alternate(3); Down; "TIM8 CH3"; "IN1 of the coil's driver";
                "IN1; no SD card"; "pulled down";
            COIL_IN2 coil_in2: c.pc9 PC9; Alternate(3); Down; "TIM8 CH4"; "IN2 of the coil's driver";
                "IN2"; "pulled down";
            COIL_FAULT coil_fault: a.pa6 PA6; Alternate(3); Down; "TIM8 BKIN"; "nFAULT of the coil's driver";
                "nFAULT, low is a break, with the break line's filter"; "low if the wire is broken";
        }
    };
}

/// Hands the rows of the pins of comms to a macro.
#[macro_export]
macro_rules! with_comms_pins {
    ($then:path) => {
        $then! {
            USB_MINUS usb_minus: a.pa11 PA11; Alternate(10); Any; "OTG_FS DM"; "USB D−";
                "the connector, behind the isolator"; "";
            USB_PLUS usb_plus: a.pa12 PA12; Alternate(10); Any; "OTG_FS DP"; "USB D+";
                "the connector, behind the isolator"; "";
            LINE line: b.pb0 PB0; Output; Any; ""; "enable line";
                "gate 2, 10 kΩ to ground *there*"; "low";
            LINE_BACK line_back: b.pb1 PB1; Input; Down; ""; "read-back of the enable line";
                "PB0's line at gate 2, by a wire of its own and 1 kΩ"; "pulled down";
            LINK_SENDS link_sends: c.pc6 PC6; Alternate(8); Any; "USART6 TX"; "link to the drive";
                "PC7 of the drive, 33 Ω here"; "high";
            LINK_RECEIVES link_receives: c.pc7 PC7; Alternate(8); Up; "USART6 RX"; "link from the drive";
                "PC6 of the drive"; "high";
        }
    };
}

macro_rules! constants {
    ($($name:ident $field:ident: $port:ident.$token:ident $type:ident; $mode:expr; $pull:ident;
        $function:literal; $part:literal; $to:literal; $at_rest:literal;)*) => {
        $(
            #[doc = $part]
            pub const $name: Connection = Connection {
                pin: Pin::named(stringify!($type)),
                mode: $mode,
                pull: Pull::$pull,
                function: $function,
                part: $part,
                to: $to,
                at_rest: $at_rest,
            };
        )*
        /// All of them.
        pub const ALL: &[Connection] = &[$($name),*];
    };
}

/// Connections of the drive.
pub mod drive {
    use super::Mode::{Alternate, Analog, Input, Output};
    use super::{Connection, Pin, Pull};
    with_drive_pins!(constants);
}

/// Connections of comms.
pub mod comms {
    use super::Mode::{Alternate, Input, Output};
    use super::{Connection, Pin, Pull};
    with_comms_pins!(constants);
}
