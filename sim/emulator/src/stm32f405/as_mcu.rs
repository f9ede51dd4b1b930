//! The chip as a microcontroller.

use super::{CORE, Stm32f405};
use crate::character::Character;
use crate::mcu::{Access, Mcu, Pin, Reset, Sampling, Watch};
use crate::pins::PinSetup;
use crate::state_hash::Hash;
use crate::time::Time;
use rsemu::core::device::{Device, ResetKind};
use rsemu::core::space::MemAttrs;
use rsemu::core::value::Width;

impl Mcu for Stm32f405 {
    fn run_until(&mut self, until: Time) {
        self.go_to(until.units(), None);
    }

    fn watch_until(&mut self, until: Time, watch: &mut dyn Watch) {
        self.go_to(until.units(), Some(watch));
    }

    fn now(&self) -> Time {
        Time::from_units(self.now)
    }

    fn cycles(&self) -> u64 {
        self.cycles
    }

    fn peek(&self, address: u32) -> Option<u32> {
        if address >= CORE {
            return self.core.with_sys(|sys| sys.read_word(address, true));
        }
        let address = u64::from(address);
        let word = self.memory.space.read(address, Width::U32, MemAttrs::DEBUG);
        word.ok().and_then(|word| u32::try_from(word).ok())
    }

    fn poke(&mut self, address: u32, value: u32) {
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

    fn listen(&mut self, registers: &[u32]) {
        self.chip.bus.listen(registers);
    }

    fn take_accesses(&mut self) -> Vec<Access> {
        self.chip.bus.take_accesses()
    }

    fn pin(&self, pin: Pin) -> bool {
        self.port(pin)
            .is_some_and(|port| port.pin_levels() >> pin.number() & 1 == 1)
    }

    fn drive_pin(&mut self, pin: Pin, level: bool) {
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

    fn pin_setup(&self, pin: Pin) -> PinSetup {
        self.chip.pins.setup(pin)
    }

    fn set_analog(&mut self, pin: Pin, share: f64) {
        self.chip.analog.set(pin, share);
    }

    fn take_samplings(&mut self) -> Vec<Sampling> {
        let adcs = self.chip.adcs.0.iter();
        adcs.flat_map(|adc| adc.take_samplings()).collect()
    }

    fn link_feed(&mut self, character: Character) {
        self.chip.usart.feed(character);
        self.chip.bus.touch("USART6");
        self.settle();
    }

    fn link_take(&mut self) -> Vec<Character> {
        self.chip.usart.take_sent()
    }

    fn link_character_units(&self) -> u64 {
        self.chip.usart.character_units()
    }

    fn reset(&mut self, reset: Reset) {
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

    fn take_resets(&mut self) -> Vec<(Time, Reset)> {
        std::mem::take(&mut self.resets)
    }

    fn set_hung(&mut self, is_hung: bool) {
        self.is_hung = is_hung;
    }

    fn is_locked_up(&self) -> bool {
        self.core.is_locked_up()
    }

    fn state_hash(&self) -> u64 {
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

    fn not_modelled(&self) -> Vec<String> {
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
