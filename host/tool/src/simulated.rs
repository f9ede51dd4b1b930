//! A simulated device in this process, or an emulated one, as a transport. Its
//! time advances only while the host waits.

use crepitus_board::{Start, VirtualDevice};
use crepitus_client::{Transport, TransportError};
use crepitus_emulator::on_target::{self, NoTarget};
use crepitus_protocol::TICKS_PER_S;
use crepitus_scene::Scene;
use crepitus_usb::cabled::CabledDevice;
use std::time::Duration;

/// Timeout of a write that the device does not accept, ticks.
const TIMEOUT_TICKS: u64 = 10_000;

/// A device at the end of a virtual USB cable.
pub(crate) struct Simulated {
    device: Box<dyn CabledDevice>,
    name: String,
    /// The last write was incomplete: send a delimiter first.
    torn: bool,
}

impl Simulated {
    /// The device of a scene.
    pub(crate) fn of(scene: &Scene) -> Result<Self, crepitus_board::VirtualError> {
        Ok(Self {
            device: Box::new(VirtualDevice::of(scene, &Start::default())?),
            name: "a simulated device".to_owned(),
            torn: false,
        })
    }

    /// The device of a scene, as the firmware's own images on emulated
    /// controllers.
    pub(crate) fn emulated(scene: &Scene) -> Result<Self, NoTarget> {
        let on_build = || eprintln!("building firmware, if it is not up to date");
        Ok(Self {
            device: on_target::device(scene, on_build)?,
            name: "an emulated device".to_owned(),
            torn: false,
        })
    }

    fn lost(&self) -> TransportError {
        TransportError::Lost {
            port: self.name.clone(),
            detail: "its virtual cable is out".to_owned(),
        }
    }

    fn ticks(time: Duration) -> u64 {
        let per_tick = u128::from(1_000_000_000 / TICKS_PER_S);
        u64::try_from(time.as_nanos().div_ceil(per_tick)).unwrap_or(u64::MAX)
    }
}

impl Transport for Simulated {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        let delimiter: &[u8] = if self.torn { &[0] } else { &[] };
        let mut rest = [delimiter, bytes].concat();
        self.torn = false;
        for _ in 0..TIMEOUT_TICKS {
            let Some(host) = self.device.host() else {
                return Err(self.lost());
            };
            let taken = host.queue(&rest);
            rest.drain(..taken);
            if rest.is_empty() {
                return Ok(());
            }
            self.device.tick();
        }
        self.torn = true;
        Err(TransportError::Stalled {
            port: self.name.clone(),
            patience: Duration::from_millis(500),
        })
    }

    fn receive(&mut self, buffer: &mut [u8], patience: Duration) -> Result<usize, TransportError> {
        let mut left = Self::ticks(patience);
        loop {
            let Some(host) = self.device.host() else {
                return Err(self.lost());
            };
            let received = host.received();
            if !received.is_empty() {
                let count = received.len().min(buffer.len());
                for (place, byte) in buffer.iter_mut().zip(received) {
                    *place = *byte;
                }
                host.consume(count);
                return Ok(count);
            }
            if left == 0 {
                return Ok(0);
            }
            left -= 1;
            self.device.tick();
        }
    }

    fn now(&self) -> Duration {
        let per_tick = u64::from(1_000_000_000 / TICKS_PER_S);
        Duration::from_nanos(self.device.now().saturating_mul(per_tick))
    }

    fn wait(&mut self, time: Duration) {
        for _ in 0..Self::ticks(time) {
            self.device.tick();
        }
    }

    fn reopen(&mut self) -> Result<(), TransportError> {
        self.device.plug_in().map_err(|error| TransportError::Open {
            port: self.name.clone(),
            detail: error.to_string(),
        })
    }

    fn name(&self) -> String {
        self.name.clone()
    }
}
