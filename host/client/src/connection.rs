//! # Connections to a device
//!
//! Opens the [`Transport`](crate::Transport) to a device by its name. The command line tool and the Python
//! package open devices here, so that a name means the same in both:
//!
//! | name | device |
//! |---|---|
//! | none | the only one that is attached |
//! | `sim` | a simulated one in this process, with a scene's leg and parameters |
//! | `emulated` | the same from the firmware's own images, with the feature `core` of `crepitus-emulator` |
//! | with `/` or `\`, or `COM` with a number | a port |
//! | any other | one that `crepitus serve-sim` serves under this name |
//!
//! | to find | look in |
//! |---|---|
//! | names, ports, errors of opening | [`Connection`], [`OpenError`] |
//! | a device in this process as a transport, the hand on its leg | [`Simulated`], [`HandInput`] |
//! | real time, in ticks | [`Clock`] |
//! | identity, status and faults, as text and as JSON | [`device_text`] |
//! | times of its hardware tasks, as text and as JSON | [`times_text`] |
//! | parameters by name and as JSON | [`parameters`] |

mod clock;
mod connection;
pub mod device_text;
mod input;
mod open_error;
pub mod parameters;
mod simulated;
pub mod times_text;

pub use clock::Clock;
pub use connection::{Connection, is_in_this_process, is_port};
pub use crepitus_virtual_device::HandInput;
pub use input::is_input;
pub use open_error::OpenError;
pub use simulated::{Simulated, emulated};
