//! The chip at the end of a USB cable.

use super::Stm32f405;
use crepitus_virtual_device::usb::wire::{Handshake, Token, UsbWire};

impl Stm32f405 {
    /// Plugs the cable in. Nothing happens until a host resets the bus.
    pub fn plug_in(&mut self) {
        self.chip.otg.plug_in();
    }

    /// Pulls the cable: for the program an idle bus.
    pub fn unplug(&mut self) {
        self.on_the_line(|chip| chip.otg.unplug());
    }

    /// The host stops its frames, as when it goes to sleep.
    pub fn suspend_bus(&mut self) {
        self.on_the_line(|chip| chip.otg.suspend());
    }

    /// The host starts its frames again.
    pub fn resume_bus(&mut self) {
        self.on_the_line(|chip| chip.otg.resume());
    }

    /// Returns whether a hub reports a device: the cable is plugged in and the program
    /// has the pull-up on.
    pub fn is_connected(&self) -> bool {
        self.chip.otg.is_connected()
    }

    /// Performs an action of the host, at the core's time.
    fn on_the_line<T>(&mut self, act: impl FnOnce(&crate::chip::Chip) -> T) -> T {
        self.chip.bus.set_now(self.now);
        self.chip.bus.touch("OTG_FS");
        let result = act(&self.chip);
        self.settle();
        result
    }
}

impl UsbWire for Stm32f405 {
    fn bus_reset(&mut self) {
        self.on_the_line(|chip| (&*chip.otg).bus_reset());
    }

    fn setup_transaction(&mut self, token: Token, request: [u8; 8]) -> Handshake {
        self.on_the_line(|chip| (&*chip.otg).setup_transaction(token, request))
    }

    fn out_transaction(&mut self, token: Token, data: &[u8]) -> Handshake {
        self.on_the_line(|chip| (&*chip.otg).out_transaction(token, data))
    }

    fn in_transaction(&mut self, token: Token) -> Handshake {
        self.on_the_line(|chip| (&*chip.otg).in_transaction(token))
    }

    fn suspend(&mut self) {
        self.suspend_bus();
    }

    fn is_connected(&self) -> bool {
        Self::is_connected(self)
    }
}
