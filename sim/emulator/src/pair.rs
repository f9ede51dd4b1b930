//! Both images on their boards, at the end of a USB cable, for a host's program.
//!
//! ```text
//! program ── bytes ── CdcHost ══ packets ══ OTG_FS │ comms │ USART6 ── USART6 │ drive │ TIM1 ── leg
//! ```
//!
//! Time advances only by [`Pair::tick`]: 50 µs of everything, including one
//! packet each way on the bus. The two chips have one clock and run one after the
//! other, half a tick each; a run is the same each time, to the last bit.

use crate::comms_board::CommsBoard;
use crate::drive_board::DriveBoard;
use crate::image::Image;
use crate::mcu::Reset;
use crate::refusal::Refusal;
use crate::state_hash::Hash;
use crepitus_device::parameter_log::{ParameterLog, Sectors as _};
use crepitus_protocol::{Revision, Values};
use crepitus_virtual_device::Leg;
use crepitus_virtual_device::nor_flash::NorFlash;
use crepitus_virtual_device::usb::cabled::CabledDevice;
use crepitus_virtual_device::usb::enumeration::EnumerationError;
use crepitus_virtual_device::usb::host::{CdcHost, Traffic};
use crepitus_virtual_device::usb::usbip::{Event, Server};
use crepitus_virtual_device::usb::wire::{Handshake, Token, UsbWire};
use std::error::Error;

/// Turns of the bus in a frame.
const FRAME_TICKS: u64 = 20;

/// Ticks that the device gets to show itself after it is plugged in: comms may
/// be starting, and erase a sector of flash, which takes it at most 0.8 s.
const PLUG_IN_TICKS: u64 = 30_000;

/// Offset of the parameters in the flash of comms: sectors 2 and 3.
pub const PARAMETERS: usize = 0x8000;

/// Reason why the device cannot be reached.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlugInError {
    /// Comms does not switch its pull-up on.
    #[error("no device shows on the bus: the image of comms does not run")]
    NotConnected,
    /// A core was stopped.
    #[error("the image of {controller} is stopped: {refusal}")]
    Refused {
        /// `drive` or `comms`.
        controller: &'static str,
        /// The use of the chip that is forbidden.
        refusal: Refusal,
    },
    /// The host could not enumerate it.
    #[error("the emulated device cannot be enumerated")]
    Enumeration(#[from] EnumerationError),
}

/// The two boards.
pub type Boards = DriveBoard<CommsBoard>;

/// Both boards and a host.
pub struct Pair {
    boards: Boards,
    host: Option<CdcHost>,
    ticks: u64,
    /// Traffic of earlier connections.
    earlier: Traffic,
}

impl Pair {
    /// Both just switched on, not plugged in. Flash is as from the factory: comms
    /// begins by preparing it, which takes 0.8 s.
    pub fn new(drive: &Image, comms: &Image, leg: Leg) -> Self {
        Self {
            boards: DriveBoard::new(drive, leg, CommsBoard::new(comms)),
            host: None,
            ticks: 0,
            earlier: Traffic::default(),
        }
    }

    /// [`Self::new`] with these parameters stored.
    pub fn of(drive: &Image, comms: &Image, leg: Leg, values: &Values) -> Self {
        Self::new(drive, &with_parameters(comms, values), leg)
    }

    /// Plugs the cable in, and enumerates the device.
    ///
    /// # Errors
    /// [`PlugInError`] if that fails: comms hangs, or cannot start.
    pub fn plug_in(&mut self) -> Result<(), PlugInError> {
        self.unplug();
        let Self { boards, ticks, .. } = self;
        boards.comms_mut().mcu_mut().plug_in();
        let mut run = |boards: &mut Boards| {
            *ticks += 1;
            boards.run(1);
        };
        let end = PLUG_IN_TICKS;
        if !(0..end).any(|_| {
            run(boards);
            boards.comms().mcu().is_connected()
        }) {
            self.check()?;
            return Err(PlugInError::NotConnected);
        }
        self.host = Some(CdcHost::enumerate(boards, &mut run)?);
        Ok(())
    }

    /// Checks that neither core was stopped.
    ///
    /// # Errors
    /// [`PlugInError::Refused`] if one was.
    pub fn check(&self) -> Result<(), PlugInError> {
        let drive = self.boards.mcu().refusal();
        let comms = self.boards.comms().mcu().refusal();
        for (controller, refusal) in [("drive", drive), ("comms", comms)] {
            if let Some(refusal) = refusal {
                return Err(PlugInError::Refused {
                    controller,
                    refusal,
                });
            }
        }
        Ok(())
    }

    /// Pulls the cable.
    pub fn unplug(&mut self) {
        if let Some(host) = self.host.take() {
            self.earlier.add(host.traffic());
        }
        self.boards.comms_mut().mcu_mut().unplug();
    }

    /// Returns whether the host has it.
    pub fn is_plugged_in(&self) -> bool {
        self.host.is_some()
    }

    /// Switches both boards off and on again: memory is lost, flash is not. The
    /// device is disconnected.
    pub fn power_cycle(&mut self) {
        self.unplug();
        self.boards.reset(Reset::PowerOn);
        self.boards.comms_mut().reset(Reset::PowerOn);
    }

    /// 50 µs of everything. A device that does not answer is disconnected until
    /// it is plugged in again.
    pub fn tick(&mut self) {
        self.boards.run(1);
        self.ticks += 1;
        if let Some(host) = &mut self.host {
            if self.ticks.is_multiple_of(FRAME_TICKS) {
                host.start_frame();
            }
            if host.poll(&mut self.boards).is_err() {
                self.unplug();
            }
        }
    }

    /// Ticks since it was switched on.
    pub fn now(&self) -> u64 {
        self.ticks
    }

    /// Lends the cable to a host that is not [`host`](Self::host), which gives it up. The host gets the
    /// boards, whose comms is at the cable's end, and what lets them run for 50 µs.
    pub fn lend_cable<R>(
        &mut self,
        host: impl FnOnce(&mut Boards, &mut dyn FnMut(&mut Boards)) -> R,
    ) -> R {
        if self.is_plugged_in() {
            self.unplug();
            self.boards.comms_mut().mcu_mut().plug_in();
        }
        let Self { boards, ticks, .. } = self;
        host(boards, &mut |boards| {
            *ticks += 1;
            boards.run(1);
        })
    }

    /// The boards.
    pub fn boards(&self) -> &Boards {
        &self.boards
    }

    /// The boards, to break them.
    pub fn boards_mut(&mut self) -> &mut Boards {
        &mut self.boards
    }

    /// The host's end of the cable, if the device is plugged in.
    pub fn host(&mut self) -> Option<&mut CdcHost> {
        self.host.as_mut()
    }

    /// Traffic of the bus, over all connections.
    pub fn traffic(&self) -> Traffic {
        let mut sum = self.earlier;
        sum.add(self.host.as_ref().map(CdcHost::traffic).unwrap_or_default());
        sum
    }

    /// A hash of both chips, for comparing two runs.
    pub fn state_hash(&self) -> u64 {
        let mut hash = Hash::default();
        for mcu in [self.boards.mcu(), self.boards.comms().mcu()] {
            hash.bytes(&mcu.state_hash().to_le_bytes());
        }
        hash.value()
    }
}

/// An image of comms with parameters stored.
fn with_parameters(image: &Image, values: &Values) -> Image {
    let mut log = ParameterLog::open(NorFlash::default());
    log.store(Revision(1), values);
    let mut image = image.clone();
    image.put(PARAMETERS, log.sectors().bytes());
    image
}

impl CabledDevice for Pair {
    fn tick(&mut self) {
        Self::tick(self);
    }

    fn now(&self) -> u64 {
        self.ticks
    }

    fn plug_in(&mut self) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(Self::plug_in(self)?)
    }

    fn host(&mut self) -> Option<&mut CdcHost> {
        Self::host(self)
    }

    fn serve(&mut self, server: &mut Server) -> Vec<Event> {
        self.lend_cable(|boards, mut run| server.frame(boards, &mut run))
    }
}

/// The cable ends at comms.
impl UsbWire for Boards {
    fn bus_reset(&mut self) {
        self.comms_mut().mcu_mut().bus_reset();
    }

    fn setup_transaction(&mut self, token: Token, request: [u8; 8]) -> Handshake {
        let mcu = self.comms_mut().mcu_mut();
        mcu.setup_transaction(token, request)
    }

    fn out_transaction(&mut self, token: Token, data: &[u8]) -> Handshake {
        self.comms_mut().mcu_mut().out_transaction(token, data)
    }

    fn in_transaction(&mut self, token: Token) -> Handshake {
        self.comms_mut().mcu_mut().in_transaction(token)
    }

    fn suspend(&mut self) {
        self.comms_mut().mcu_mut().suspend_bus();
    }

    fn is_connected(&self) -> bool {
        self.comms().mcu().is_connected()
    }
}
