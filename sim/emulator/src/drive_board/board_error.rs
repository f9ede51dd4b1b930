//! Mismatches between the image and the board.

use crate::pins::{Pin, PinSetup};
use crate::refusal::Refusal;

/// A mismatch between the image and the board's wiring.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BoardError {
    /// A pin is not set up for what it is wired to.
    #[error("{pin} is {is}; its wire, {to}, needs {needs}")]
    Pin {
        /// The pin.
        pin: Pin,
        /// Setup of the pin.
        is: PinSetup,
        /// The other end of its wire.
        to: String,
        /// Mode and pull that this needs.
        needs: String,
    },
    /// Both switches of a half are closed at once: the timer asks for it,
    /// whether or not the gates are open.
    #[error("shoot-through: both switches of half {half} are closed at once")]
    ShootThrough {
        /// 'A' or 'B'.
        half: char,
    },
    /// Undefined level at a gate.
    #[error("a switch of half {half} is neither driven nor pulled down")]
    UndefinedSwitch {
        /// 'A' or 'B'.
        half: char,
    },
    /// A switch is closed although the timer's outputs are off.
    #[error("a switch of half {half} is closed although the outputs of TIM1 are off")]
    ClosedAtRest {
        /// 'A' or 'B'.
        half: char,
    },
    /// The timer does not make the bridge's PWM.
    #[error("TIM1 does not make the PWM of the bridge: {what}")]
    Pwm {
        /// Description of the problem.
        what: &'static str,
    },
    /// The timer does not drive the coil's driver as it should.
    #[error("TIM8 does not make the PWM of the coil's driver: {what}")]
    CoilPwm {
        /// Description of the problem.
        what: &'static str,
    },
    /// The dead time does not suit the bridge.
    #[error("a dead time of {ns} ns; the bridge needs 200 to 500 ns")]
    DeadTime {
        /// Dead time to which the timer is set, ns.
        ns: u64,
    },
    /// A converter samples another channel than one of its inputs.
    #[error("ADC{converter} samples channel {channel}, to which none of its inputs is wired")]
    Channel {
        /// The converter, from 1 on.
        converter: u32,
        /// The channel.
        channel: u32,
    },
    /// An input is sampled for a shorter time than its source needs.
    #[error("ADC{converter} samples channel {channel} for {ns} ns; its source needs {needs_ns} ns")]
    ShortSampling {
        /// The converter, from 1 on.
        converter: u32,
        /// The channel.
        channel: u32,
        /// Sampling time, ns.
        ns: u64,
        /// That of the board description, ns.
        needs_ns: u64,
    },
    /// The samples of a current are not centred on the middle of the tick.
    #[error(
        "ADC{converter} samples {off_ns} ns off the middle of the tick; at most 100 ns are allowed"
    )]
    SamplingTime {
        /// The converter, from 1 on.
        converter: u32,
        /// Time between the middle of the tick and the middle of its samplings, ns.
        off_ns: u64,
    },
    /// A switch opens or closes while a converter samples or converts.
    #[error("a switch of the bridge switches while ADC{converter} samples or converts")]
    SwitchingWhileSampling {
        /// The converter, from 1 on.
        converter: u32,
    },
    /// The link has another speed.
    #[error("a character of USART6 takes {units} units of time; one of the link takes 800")]
    Baud {
        /// Duration of a character as the program has set it, in units of time.
        units: u64,
    },
    /// A program uses its chip in a way that the manual forbids, and has been stopped.
    #[error("the core of {controller} is stopped: {refusal}")]
    Refused {
        /// `drive` or `comms`.
        controller: &'static str,
        /// The use.
        refusal: Refusal,
    },
    /// The counter does not follow the encoder.
    #[error("TIM5 has counted {counted} while the encoder turned by {turned}")]
    Encoder {
        /// Counts of the timer in half a tick.
        counted: i32,
        /// Counts of the encoder.
        turned: i32,
    },
}
