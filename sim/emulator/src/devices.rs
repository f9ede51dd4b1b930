//! Devices that the library lacks.
//!
//! | device | for |
//! |---|---|
//! | [`adc`] | a converter that a timer starts, with [`noise`] |
//! | [`usart`] | a USART with DMA requests and the time of every character |
//! | [`brake`] | the break input of an advanced timer |
//! | [`data_cache`] | what the data cache of flash may hold after an erasure |
//! | [`event_flags`] | a DMA controller that starts no stream with old event flags |
//! | [`crystal_meter`] | the input of TIM11, by which the crystal is measured |
//! | [`flash`] | flash that is programmed and erased, and takes its time |
//! | [`otg`] | the USB controller, as a device |
//! | [`random`] | random numbers, others at each start |

pub(crate) mod adc;
pub(crate) mod brake;
pub(crate) mod crystal_meter;
pub(crate) mod data_cache;
pub(crate) mod event_flags;
pub(crate) mod flash;
pub(crate) mod noise;
pub(crate) mod otg;
pub(crate) mod random;
pub(crate) mod registers;
pub(crate) mod usart;
