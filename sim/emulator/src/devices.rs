//! Devices that the library lacks.
//!
//! | device | for |
//! |---|---|
//! | [`adc`] | a converter that a timer starts, with [`noise`] |
//! | [`usart`] | a USART with DMA requests and the time of every character |
//! | [`brake`] | the break input of an advanced timer |
//! | [`flash`] | flash that is programmed and erased, and takes its time |
//! | [`otg`] | the USB controller, as a device |

pub(crate) mod adc;
pub(crate) mod brake;
pub(crate) mod flash;
pub(crate) mod noise;
pub(crate) mod otg;
pub(crate) mod registers;
pub(crate) mod usart;
