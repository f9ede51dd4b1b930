//! Parameters of an experiment, and those from before it back in the end.

use crate::failure::{Failure, warn};
use crate::line::{Line, failure};
use crepitus_client::Client;
use crepitus_protocol::parameters::PARAMETERS;
use crepitus_protocol::{Revision, Values};
use std::time::Duration;

/// Tries to put them back, and the time between: the device may still ramp to the last ones.
const TRIES: usize = 20;
const BETWEEN: Duration = Duration::from_millis(50);

/// Every effect off.
pub(super) fn all_off() -> Vec<(u8, f64)> {
    let renders = PARAMETERS
        .iter()
        .filter(|parameter| parameter.key() == "render");
    renders.map(|parameter| (parameter.id, 0.0)).collect()
}

/// A device with other parameters for a while. They are not saved.
pub(super) struct Prepared<'c> {
    client: &'c mut Client<Line>,
    before: Values,
    is_restored: bool,
}

impl<'c> Prepared<'c> {
    /// Sets them.
    pub(super) fn new(
        client: &'c mut Client<Line>,
        changes: &[(u8, f64)],
    ) -> Result<Self, Failure> {
        let (_, before) = client.parameters().map_err(failure)?;
        client.set(changes).map_err(failure)?;
        Ok(Self {
            client,
            before,
            is_restored: false,
        })
    }

    /// The device meanwhile.
    pub(super) fn client(&mut self) -> &mut Client<Line> {
        self.client
    }

    /// Puts the parameters back.
    pub(super) fn restored(mut self) -> Result<(), Failure> {
        self.is_restored = true;
        self.restore().map(|_| ())
    }

    fn restore(&mut self) -> Result<Revision, Failure> {
        let mut tries = 0;
        loop {
            let result = self
                .client
                .parameters()
                .and_then(|(revision, _)| self.client.commit(revision, &self.before));
            match result {
                Ok(revision) => return Ok(revision),
                Err(error) if tries >= TRIES || !self.client.is_connected() => {
                    return Err(failure(error));
                }
                Err(_) => tries += 1,
            }
            let _ = self.client.pump(BETWEEN);
        }
    }
}

impl Drop for Prepared<'_> {
    fn drop(&mut self) {
        if !self.is_restored && self.restore().is_err() {
            warn(
                "the device keeps the parameters of the experiment until it is switched off and on: what was saved is not changed",
            );
        }
    }
}
