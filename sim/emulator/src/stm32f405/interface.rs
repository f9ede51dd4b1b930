//! Interface of the chip to boards and tests.

use super::{CORE, Stm32f405};
use crate::character::Character;
use crate::devices::adc::Course;
use crate::mcu::{Access, Pin, Reset, Sampling, Watch};
use crate::pins::PinSetup;
use crate::refusal::Refusal;
use crate::state_hash::Hash;
use crate::time::Time;
use rsemu::core::device::{Device, ResetKind};
use rsemu::core::space::MemAttrs;
use rsemu::core::value::Width;

impl Stm32f405 {
    /// Runs until `until`, and at most one instruction beyond.
    pub fn run_until(&mut self, until: Time) {
        self.go_to(until.units(), None);
    }

    /// Runs as [`Self::run_until`] does, passing every step to `watch`. Slower.
    pub fn watch_until(&mut self, until: Time, watch: &mut dyn Watch) {
        self.go_to(until.units(), Some(watch));
    }

    /// Current time.
    pub fn now(&self) -> Time {
        Time::from_units(self.now)
    }

    /// The core's cycles since it was switched on; none pass while it sleeps.
    pub fn cycles(&self) -> u64 {
        self.cycles
    }

    /// A word of memory or of a register, without side effects; `None` at an
    /// unmapped address.
    pub fn peek(&self, address: u32) -> Option<u32> {
        if address >= CORE {
            return self.core.with_sys(|sys| sys.read_word(address, true));
        }
        let address = u64::from(address);
        let word = self.memory.space.read(address, Width::U32, MemAttrs::DEBUG);
        word.ok().and_then(|word| u32::try_from(word).ok())
    }

    /// Writes a word as a debugger does.
    pub fn poke(&mut self, address: u32, value: u32) {
        if self.core.with_sys(|sys| sys.write_word(address, value)) {
            return;
        }
        let (address, value) = (u64::from(address), u64::from(value));
        // Nothing is there: nothing is written.
        let _ = self
            .memory
            .space
            .write(address, Width::U32, value, MemAttrs::DEFAULT);
        if self.chip.flash.busy_until() > self.now {
            self.chip.bus.touch("FLASH");
        }
        self.settle();
    }

    /// Records every access to these registers from now on.
    pub fn listen(&mut self, registers: &[u32]) {
        self.chip.bus.listen(registers);
    }

    /// Takes the accesses recorded since the last call, in order.
    pub fn take_accesses(&mut self) -> Vec<Access> {
        self.chip.bus.take_accesses()
    }

    /// The level at a pin, as the chip sees it.
    pub fn pin(&self, pin: Pin) -> bool {
        self.port(pin)
            .is_some_and(|port| port.pin_levels() >> pin.number() & 1 == 1)
    }

    /// Drives a pin from outside.
    pub fn drive_pin(&mut self, pin: Pin, level: bool) {
        if let Some(port) = self.port(pin) {
            port.set_external(pin.number(), level);
        }
        for brake in &self.chip.brakes {
            if pin == brake.input().pin {
                self.chip.bus.touch(brake.input().timer);
                brake.set_input(level);
            }
        }
        self.settle();
    }

    /// The setup of a pin.
    pub fn pin_setup(&self, pin: Pin) -> PinSetup {
        self.chip.pins.setup(pin)
    }

    /// Sets the voltage at a pin, as share of the converters' reference.
    pub fn set_analog(&mut self, pin: Pin, share: f64) {
        self.chip.analog.set(pin, share);
    }

    /// Lets the voltage at a pin change over time.
    pub(crate) fn set_analog_course(&mut self, pin: Pin, course: Course) {
        self.chip.analog.set_course(pin, course);
    }

    /// Takes the sampling intervals of the converters since the last call.
    pub fn take_samplings(&mut self) -> Vec<Sampling> {
        let adcs = self.chip.adcs.0.iter();
        adcs.flat_map(|adc| adc.take_samplings()).collect()
    }

    /// Puts a character on the wire to the link's receiver, in order. Lost unless its pin
    /// is connected to it when it arrives.
    pub fn link_feed(&mut self, character: Character) {
        self.chip.usart.feed(character);
        self.chip.bus.touch("USART6");
        self.settle();
    }

    /// Takes the characters sent by the link since the last call: those at whose ends
    /// its pin was connected to it.
    pub fn link_take(&mut self) -> Vec<Character> {
        self.chip.usart.take_sent()
    }

    /// Units of time of a character on the link, as the program has set it.
    pub fn link_character_units(&self) -> u64 {
        self.chip.usart.character_units()
    }

    /// Resets the chip.
    pub fn reset(&mut self, reset: Reset) {
        if reset == Reset::PowerOn {
            self.memory.forget();
            self.chip.rcc.reset(ResetKind::Cold);
        }
        self.is_hung = false;
        (self.active, self.exception, self.is_pending) = (0, 0, false);
        self.chip.bus.reset();
        self.chip.bus.waits.clear();
        self.chip.bus.waits.set_register(0);
        self.core.reset(ResetKind::Cold);
        self.is_reset = true;
        for name in match reset {
            Reset::PowerOn => &["porrst", "borrst", "pinrst"][..],
            Reset::BrownOut => &["borrst", "pinrst"],
            Reset::Watchdog => &["iwdgrst", "pinrst"],
            Reset::Software => &["sftrst", "pinrst"],
            Reset::Pin => &["pinrst"],
        } {
            self.chip.causes.set(name);
        }
    }

    /// Takes the chip's own resets since the last call.
    pub fn take_resets(&mut self) -> Vec<(Time, Reset)> {
        std::mem::take(&mut self.resets)
    }

    /// Stops the core while all else runs: like a program that hangs with
    /// interrupts masked. A reset ends it.
    pub fn set_hung(&mut self, is_hung: bool) {
        self.is_hung = is_hung;
    }

    /// Returns whether the core is in lock-up.
    pub fn is_locked_up(&self) -> bool {
        self.core.is_locked_up()
    }

    /// A hash of memory, core and registers, for comparing two runs.
    pub fn state_hash(&self) -> u64 {
        let mut hash = Hash::default();
        let registers = self.core.regs();
        hash.words(registers.r);
        hash.words([
            registers.msp,
            registers.psp,
            registers.xpsr,
            registers.control,
        ]);
        hash.words((0..32).map(|n| self.core.s(n)));
        for store in [&self.memory.ram, &self.memory.ccm] {
            let mut bytes = vec![0; usize::try_from(store.len()).unwrap_or_default()];
            let _ = store.read_at(0, &mut bytes);
            hash.bytes(&bytes);
        }
        for base in self.chip.bus.bases() {
            hash.words((0..0x20).filter_map(|n| self.peek(base + 4 * n)));
        }
        hash.bytes(&self.now.to_le_bytes());
        hash.bytes(&self.cycles.to_le_bytes());
        hash.value()
    }

    /// The first use of the chip that its manual forbids: since then the core stands.
    pub fn refusal(&self) -> Option<Refusal> {
        self.chip.refusals.first()
    }

    /// Features used by the program that are not modelled; unmapped addresses,
    /// parts whose clock was off. Empty if all is well.
    pub fn not_modelled(&self) -> Vec<String> {
        let strays = self.chip.bus.strays();
        let strays = strays.iter().map(|address| format!("{address:#010x}"));
        let asked = [
            ("USART6", self.chip.usart.uses_unmodelled_features()),
            (
                "ADC",
                self.chip
                    .adcs
                    .0
                    .iter()
                    .any(|adc| adc.uses_unmodelled_features()),
            ),
            ("TIM1", self.chip.brakes[0].uses_unmodelled_features()),
            ("TIM8", self.chip.brakes[1].uses_unmodelled_features()),
            ("FLASH", self.chip.flash.uses_unmodelled_features()),
            ("OTG_FS", self.chip.otg.uses_unmodelled_features()),
        ];
        let asked = asked.iter().filter(|(_, is_asked)| *is_asked);
        strays
            .chain(asked.map(|(name, _)| (*name).into()))
            .collect()
    }
}
