//! A simulated device in this process, or an emulated one, as a transport. Its
//! time advances while the host waits, as fast as it can or in real time; in real time
//! it [makes up](Simulated::run_on) for what passed in between, where the host says so.

use crate::connection::clock::Clock;
use crate::{Transport, TransportError};
use crepitus_emulator::on_target::{self, NoTarget};
use crepitus_protocol::TICKS_PER_S;
use crepitus_scene::Scene;
use crepitus_scene::values::values;
use crepitus_virtual_device::usb::cabled::CabledDevice;
use crepitus_virtual_device::{HandInput, Leg, Start, VirtualDevice};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Timeout of a write that the device does not accept, ticks.
const TIMEOUT_TICKS: u64 = 10_000;

/// A device at the end of a virtual USB cable.
pub struct Simulated {
    device: Box<dyn CabledDevice>,
    name: String,
    /// Input of a hand that moves its leg.
    hand: Option<HandInput>,
    /// Whether the last write was incomplete, so that a delimiter has to go first.
    torn: bool,
    /// Limit to real time, if there is one.
    pace: Option<Pace>,
}

/// Limit to real time, with the ticks that are due.
struct Pace {
    clock: Clock,
    due: u64,
}

/// Ticks between two looks at the clock while a device makes up for time.
const RUN_ON_CHECK: u64 = 1_000;

/// Poll interval of a tick that is not due yet.
const NAP: Duration = Duration::from_micros(500);

/// The firmware's own images with the leg and the parameters of a scene; `on_build` is called if they have to be
/// built first.
///
/// # Errors
/// [`NoTarget`] without the emulator or the images, or if no device can render the scene.
pub fn emulated(scene: &Scene, on_build: impl FnOnce()) -> Result<Box<dyn CabledDevice>, NoTarget> {
    emulated_with(Leg::new(scene), scene, on_build)
}

fn emulated_with(
    leg: Leg,
    scene: &Scene,
    on_build: impl FnOnce(),
) -> Result<Box<dyn CabledDevice>, NoTarget> {
    let values = values(scene).map_err(|error| NoTarget::NoDevice(error.to_string()))?;
    on_target::device(leg, &values, on_build)
}

impl Simulated {
    /// Creates the simulated device of a scene.
    ///
    /// # Errors
    /// [`crepitus_virtual_device::VirtualError`] if the scene has what no device has.
    pub fn of(scene: &Scene) -> Result<Self, crepitus_virtual_device::VirtualError> {
        let device = VirtualDevice::of(scene, &Start::default())?;
        let hand = device.board().leg().hand();
        Ok(Self::cabled(Box::new(device)).named("a simulated device", hand))
    }

    /// Creates the device of a scene with the firmware's own images on emulated controllers.
    ///
    /// # Errors
    /// [`NoTarget`] without the emulator or the images.
    pub fn emulated(scene: &Scene) -> Result<Self, NoTarget> {
        let on_build = || eprintln!("building firmware, if it is not up to date");
        let leg = Leg::new(scene);
        let hand = leg.hand();
        let device = emulated_with(leg, scene, on_build)?;
        Ok(Self::cabled(device).named("an emulated device", hand))
    }

    /// Wraps a device at the end of a virtual cable, such as one with injected faults.
    pub fn cabled(device: Box<dyn CabledDevice>) -> Self {
        Self {
            device,
            name: "a device on a virtual cable".to_owned(),
            hand: None,
            torn: false,
            pace: None,
        }
    }

    fn named(mut self, name: &str, hand: HandInput) -> Self {
        name.clone_into(&mut self.name);
        self.hand = Some(hand);
        self
    }

    /// Input of a hand that moves its leg, beside the cable; `None` for a device that was [wrapped](Self::cabled).
    pub fn hand(&self) -> Option<HandInput> {
        self.hand.clone()
    }

    /// Limits the device to real time.
    pub fn in_real_time(mut self) -> Self {
        self.pace = Some(Pace {
            clock: Clock::new(),
            due: 0,
        });
        self
    }

    /// Lets a device in real time make up for the time since the last call, in which the program did something else: then its
    /// lease ends as that of a device at a port. One that is slower than real time makes up for what it can in as long.
    pub fn run_on(&mut self) {
        let Some(pace) = &mut self.pace else { return };
        let away = pace.due + pace.clock.away_ticks();
        pace.due = 0;
        let begun = Instant::now();
        let most = Duration::from_secs(away) / TICKS_PER_S;
        for n in 0..away {
            if n.is_multiple_of(RUN_ON_CHECK) && begun.elapsed() > most {
                break;
            }
            self.device.tick();
        }
    }

    /// Advances the device by one tick, once it is due.
    fn tick(&mut self) {
        if let Some(pace) = &mut self.pace {
            while pace.due == 0 {
                pace.due = pace.clock.due_ticks();
                if pace.due == 0 {
                    sleep(NAP);
                }
            }
            pace.due -= 1;
        }
        self.device.tick();
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
            self.tick();
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
            self.tick();
        }
    }

    fn now(&self) -> Duration {
        let per_tick = u64::from(1_000_000_000 / TICKS_PER_S);
        Duration::from_nanos(self.device.now().saturating_mul(per_tick))
    }

    fn wait(&mut self, time: Duration) {
        for _ in 0..Self::ticks(time) {
            self.tick();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Client, Error};
    use crepitus_protocol::{Fault, State};
    use crepitus_scene::shipped;

    fn device() -> Simulated {
        Simulated::of(&shipped::examination().unwrap()).unwrap()
    }

    /// A program that is away for longer than the lease, and does not renew it.
    #[test]
    fn a_device_in_real_time_runs_on_and_its_lease_ends() -> Result<(), Error> {
        let mut client = Client::connect(device().in_real_time())?;
        client.zero()?;
        client.arm()?;
        let before = client.now();
        sleep(Duration::from_millis(400));
        client.transport_mut().run_on();
        assert!(client.now() >= before + Duration::from_millis(399));
        let status = client.status()?;
        assert_ne!(status.state, State::Armed);
        assert!(!client.is_armed());
        assert_eq!(status.drive_fault, Fault::LeaseExpired.code());
        Ok(())
    }

    #[test]
    fn a_device_without_a_clock_stands_still() -> Result<(), Error> {
        let mut client = Client::connect(device())?;
        let before = client.now();
        sleep(Duration::from_millis(20));
        client.transport_mut().run_on();
        assert_eq!(client.now(), before);
        Ok(())
    }
}
