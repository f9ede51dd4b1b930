//! The emulator as an optional feature: the core is a large part of a program's
//! build, behind the feature `core`.

use crepitus_ladder::exchange::Input;
use crepitus_ladder::{Call, Plan};
use crepitus_protocol::Values;
use crepitus_virtual_device::Leg;
use crepitus_virtual_device::usb::cabled::CabledDevice;

/// Runs the steps of a plan, compares every output with the host's, and returns
/// the cost of each; or the reason of a failure.
pub type OnTarget = Box<dyn FnMut(&Plan, &[Input]) -> Result<Vec<Call>, String>>;

/// Ticks until the drive has the parameters that comms has stored: 30 ms.
#[cfg(feature = "core")]
const PREPARED_TICKS: u64 = 600;

/// Reason why there is no target.
#[derive(Debug, thiserror::Error)]
pub enum NoTarget {
    /// The program was built without the core.
    #[error(
        "this program was built without the emulator; build it with `--features emulator`, as in \
         `cargo run --release --features emulator -- info --device emulated`"
    )]
    NoCore,
    /// There is no image.
    #[error("{0}")]
    NoImage(String),
    /// The device cannot be used.
    #[error("{0}")]
    NoDevice(String),
}

/// The ladder on an emulated core; `on_build` is called if its image has to be
/// built first.
///
/// # Errors
/// [`NoTarget`].
#[cfg(feature = "core")]
pub fn ladder(on_build: impl FnOnce()) -> Result<OnTarget, NoTarget> {
    use crate::firmware::{self, Program};
    use crate::ladder::Ladder;
    if firmware::is_to_be_built() {
        on_build();
    }
    let image =
        firmware::image(Program::Ladder).map_err(|error| NoTarget::NoImage(error.to_string()))?;
    let mut ladder = Ladder::new(&image);
    Ok(Box::new(move |plan, inputs| {
        let run = ladder.run_and_compare(plan, inputs);
        Ok(run.map_err(|error| error.to_string())?.calls)
    }))
}

/// Both images with a leg and parameters, plugged in and running for as
/// long as it takes the drive to get its parameters; `on_build` is called if they
/// have to be built first.
///
/// # Errors
/// [`NoTarget`].
#[cfg(feature = "core")]
pub fn device(
    leg: Leg,
    values: &Values,
    on_build: impl FnOnce(),
) -> Result<Box<dyn CabledDevice>, NoTarget> {
    use crate::Pair;
    use crate::firmware::{self, Program};
    if firmware::is_to_be_built() {
        on_build();
    }
    let image = |program| firmware::image(program).map_err(|e| NoTarget::NoImage(e.to_string()));
    let (drive, comms) = (image(Program::Drive)?, image(Program::Comms)?);
    let mut pair = Pair::of(&drive, &comms, leg, values);
    let plugged = pair.plug_in();
    plugged.map_err(|error| NoTarget::NoDevice(error.to_string()))?;
    for _ in 0..PREPARED_TICKS {
        pair.tick();
    }
    Ok(Box::new(pair))
}

/// Fails: the program was built without the core.
///
/// # Errors
/// Always [`NoTarget::NoCore`].
#[cfg(not(feature = "core"))]
pub fn ladder(_: impl FnOnce()) -> Result<OnTarget, NoTarget> {
    Err(NoTarget::NoCore)
}

/// Fails: the program was built without the core.
///
/// # Errors
/// Always [`NoTarget::NoCore`].
#[cfg(not(feature = "core"))]
pub fn device(_: Leg, _: &Values, _: impl FnOnce()) -> Result<Box<dyn CabledDevice>, NoTarget> {
    Err(NoTarget::NoCore)
}
