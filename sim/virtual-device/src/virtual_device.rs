//! A board at the end of a USB cable, for a host's program.
//!
//! ```text
//! program ── bytes ── CdcHost ══ packets ══ SoftBus ── usb-device, usbd-serial ── Comms ── link ── Drive ── leg
//! ```
//!
//! Time advances only by [`VirtualDevice::tick`]: 50 µs of everything,
//! including one packet each way on the bus.

use crate::board::{Board, Start};
use crate::usb::bus::SoftBus;
use crate::usb::cable::SoftCable;
use crate::usb::cabled::CabledDevice;
use crate::usb::enumeration::EnumerationError;
use crate::usb::host::{CdcHost, Traffic};
use crate::usb::usbip::{Event, Server};
use crepitus_device::usb_port::{UsbIdentity, UsbPort, UsbPortError};
use crepitus_protocol::{Revision, ValueError};
use crepitus_scene::Scene;
use crepitus_scene::values::{NotRendered, values};
use std::error::Error;
use usb_device::bus::UsbBusAllocator;

/// Turns of the bus in a frame.
const FRAME_TICKS: u64 = 20;

/// Strings of the USB descriptors.
const IDENTITY: UsbIdentity<'static> = UsbIdentity {
    manufacturer: "Crepitus",
    product: "Crepitus simulated device",
    serial_number: "SIM-COMMS-01",
};

/// Reason why there is no virtual device.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VirtualError {
    /// No device can render the scene.
    #[error(transparent)]
    Scene(#[from] NotRendered),
    /// The device's own defaults are invalid.
    #[error("the device's defaults are invalid: {0:?}")]
    Defaults(ValueError),
    /// The USB stack refused the descriptors.
    #[error("the USB stack refused the descriptors: {0:?}")]
    Port(UsbPortError),
    /// The host could not enumerate it.
    #[error("the virtual USB device cannot be enumerated")]
    Enumeration(#[from] EnumerationError),
}

struct Usb {
    port: UsbPort<'static, SoftBus>,
    cable: SoftCable,
    host: Option<CdcHost>,
}

impl Usb {
    fn new() -> Result<Self, VirtualError> {
        let (bus, cable) = SoftBus::new();
        // The stack borrows its allocator for ever, as on the controller, where
        // it is a static. A device is built once, and again at each restart of
        // comms: some hundred bytes each time.
        let allocator = Box::leak(Box::new(UsbBusAllocator::new(bus)));
        let port = UsbPort::new(allocator, &IDENTITY).map_err(VirtualError::Port)?;
        Ok(Self {
            port,
            cable,
            host: None,
        })
    }
}

/// A board at the end of a USB cable.
pub struct VirtualDevice {
    board: Board,
    usb: Usb,
    /// Traffic of earlier connections.
    earlier: Traffic,
}

impl VirtualDevice {
    /// The device of a scene, with the scene's parameters stored, plugged in.
    ///
    /// # Errors
    /// [`VirtualError`] if no device can render the scene.
    pub fn of(scene: &Scene, start: &Start) -> Result<Self, VirtualError> {
        let start = Start {
            saved: Some((Revision(1), values(scene)?)),
            ..*start
        };
        let board = Board::new(scene, &start).map_err(VirtualError::Defaults)?;
        let mut device = Self {
            board,
            usb: Usb::new()?,
            earlier: Traffic::default(),
        };
        device.plug_in()?;
        Ok(device)
    }

    /// Plugs the device in, and enumerates it.
    ///
    /// # Errors
    /// [`VirtualError::Enumeration`] if that fails: comms hangs, or is just
    /// starting.
    pub fn plug_in(&mut self) -> Result<(), VirtualError> {
        self.unplug();
        let Self { board, usb, .. } = self;
        let Usb { port, cable, host } = usb;
        cable.plug_in();
        *host = Some(CdcHost::enumerate(cable, &mut |_| turn(board, port))?);
        Ok(())
    }

    /// Pulls the plug.
    pub fn unplug(&mut self) {
        if let Some(host) = self.usb.host.take() {
            self.earlier.add(host.traffic());
        }
        self.usb.cable.unplug();
    }

    /// Returns whether the host has it.
    pub fn is_plugged_in(&self) -> bool {
        self.usb.host.is_some()
    }

    /// 50 µs of everything. A device that does not answer is disconnected until
    /// it is plugged in again.
    pub fn tick(&mut self) {
        turn(&mut self.board, &mut self.usb.port);
        if self.board.take_comms_restart() {
            self.unplug();
            // The descriptors are the same as before.
            if let Ok(usb) = Usb::new() {
                self.usb = usb;
            }
            return;
        }
        if let Some(host) = &mut self.usb.host {
            if self.board.now().is_multiple_of(FRAME_TICKS) {
                host.start_frame();
            }
            if host.poll(&mut self.usb.cable).is_err() {
                self.unplug();
            }
        }
    }

    /// Lends the cable to a host that is not [`host`](Self::host), which gives it up. The host gets the
    /// cable and what lets the device run for 50 µs.
    ///
    /// A restart of comms shows as a device that is disconnected, until the next call.
    pub fn lend_cable<R>(
        &mut self,
        host: impl FnOnce(&mut SoftCable, &mut dyn FnMut(&mut SoftCable)) -> R,
    ) -> R {
        if self.is_plugged_in() {
            self.unplug();
            self.usb.cable.plug_in();
        }
        let Self { board, usb, .. } = self;
        let Usb { port, cable, .. } = usb;
        let mut has_restarted = false;
        let result = host(cable, &mut |cable| {
            if has_restarted {
                board.tick();
                return;
            }
            turn(board, port);
            has_restarted = board.take_comms_restart();
            if has_restarted {
                cable.unplug();
            }
        });
        // The descriptors are the same as before.
        if has_restarted && let Ok(usb) = Usb::new() {
            self.usb = usb;
        }
        result
    }

    /// The board.
    pub fn board(&self) -> &Board {
        &self.board
    }

    /// The board, to break it.
    pub fn board_mut(&mut self) -> &mut Board {
        &mut self.board
    }

    /// The host's end of the cable, if the device is plugged in.
    pub fn host(&mut self) -> Option<&mut CdcHost> {
        self.usb.host.as_mut()
    }

    /// Traffic of the bus, over all connections.
    pub fn traffic(&self) -> Traffic {
        let mut sum = self.earlier;
        let host = self.usb.host.as_ref();
        sum.add(host.map(CdcHost::traffic).unwrap_or_default());
        sum
    }
}

impl CabledDevice for VirtualDevice {
    fn tick(&mut self) {
        Self::tick(self);
    }

    fn now(&self) -> u64 {
        self.board.now()
    }

    fn plug_in(&mut self) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(Self::plug_in(self)?)
    }

    fn host(&mut self) -> Option<&mut CdcHost> {
        Self::host(self)
    }

    fn serve(&mut self, server: &mut Server) -> Vec<Event> {
        self.lend_cable(|cable, mut run| server.frame(cable, &mut run))
    }
}

/// Runs the device for 50 µs.
fn turn(board: &mut Board, port: &mut UsbPort<'static, SoftBus>) {
    board.tick();
    if board.comms_runs() {
        port.poll(board.comms_mut());
    }
}
