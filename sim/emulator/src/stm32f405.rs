//! An STM32F405: the library's core among the parts of `chip`.
//!
//! ```text
//! until the next thing that a part does by itself:
//!     one step of the core, at the time at which it begins
//!     if it has touched a part: clocks, DMA, the next thing
//! then that thing, at its time
//! ```
//!
//! So an interrupt is pending with the step after its event, and a register is
//! read with its value at the start of the instruction.
//!
//! Unless accesses to memory are observed, `fast_path` executes most instructions, with
//! the same result in the same cycles.

mod cycle_counter;
mod exception_state;
mod fast_path;
mod interface;
mod usb;

use crate::chip::Chip;
use crate::chip::bus::FLASH_ACR;
use crate::chip::clocks::Clock;
use crate::chip::memory::Memory;
use crate::flash_interface::FlashRead;
use crate::image::Image;
use crate::mcu::{Pin, RamAccess, Reset, Step, Watch};
use crate::pins::Mode;
use crate::time::Time;
use crepitus_device::board::pins::drive;
use exception_state::Before;
use fast_path::{Executed, FastPath};
use rsemu::core::space::MemAttrs;
use rsemu::core::value::Width;
use rsemu::core::wire::Level;
use rsemu::cpu::arm::v7m::{ArmV7m, Config};
use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;

/// First address of the core's own registers.
const CORE: u32 = 0xe000_0000;

/// SysTick is enabled.
const SYSTICK_ENABLE: u32 = 1;

/// Pins of the encoder's channels, and their function.
const ENCODER_PINS: [Pin; 2] = [Pin::of(&drive::ENCODER_A), Pin::of(&drive::ENCODER_B)];
const ENCODER_FUNCTION: Mode = Mode::of(&drive::ENCODER_A);

/// Interval at which the core is polled for a reset request, or for sleep
/// with its own timer running: 10 µs.
const LOOK_UNITS: u64 = 3_360;

/// The library counts the eight words of a frame as separate loads and stores,
/// in addition to the 12 and 10 cycles that include them: this number of
/// cycles too many at every entry and every return. `tests/timing` has the
/// known answer. The core's cycle counter, DWT, is corrected with them.
const FRAME_CYCLES: u64 = 8;

/// No change of the exception takes less: that from one straight to the next.
const CHAINING: u64 = 6;

/// The microcontroller.
pub struct Stm32f405 {
    core: ArmV7m,
    chip: Chip,
    memory: Memory,
    fast_path: FastPath,
    now: u64,
    cycles: u64,
    /// Those that the fast path has executed.
    fast_cycles: u64,
    /// Cycles of the core's clock, those in which it sleeps too.
    clock: u64,
    /// Number of active exceptions.
    active: u32,
    /// The exception being handled.
    exception: u16,
    /// An exception is pending, besides those of lines that are high.
    is_pending: bool,
    is_hung: bool,
    /// The core has been reset, and not stepped since.
    is_reset: bool,
    /// Levels at the pins of the encoder's channels.
    encoder: [bool; 2],
    resets: Vec<(Time, Reset)>,
}

/// An observer that does nothing.
struct NoWatch;

impl Watch for NoWatch {
    fn step(&mut self, _: &Step) {}
}

impl Stm32f405 {
    /// A chip with an image in its flash, just switched on.
    ///
    /// # Panics
    /// If the image is longer than flash.
    pub fn new(image: &Image) -> Self {
        let core = ArmV7m::new(Config::CORTEX_M4F.with_priority_bits(4));
        let chip = Chip::new(&core, image);
        let memory = Memory::new(&chip);
        core.attach_space(memory.space.clone());
        let mut mcu = Self {
            core,
            fast_path: FastPath::new(&chip, &memory),
            chip,
            memory,
            now: 0,
            cycles: 0,
            fast_cycles: 0,
            clock: 0,
            active: 0,
            exception: 0,
            is_pending: false,
            is_hung: false,
            is_reset: false,
            encoder: [false; 2],
            resets: Vec::new(),
        };
        mcu.reset(Reset::PowerOn);
        mcu
    }

    /// Changes channel A (0) or B (1) of the encoder. TIM5 sees it only if the
    /// channel's pin is connected to it.
    pub fn drive_encoder(&mut self, channel: usize, level: bool) {
        if let (Some(pin), Some(known)) = (ENCODER_PINS.get(channel), self.encoder.get_mut(channel))
        {
            *known = level;
            self.drive_pin(*pin, level);
            self.connect_encoder();
            self.settle();
        }
    }

    /// Shows TIM5 the levels of the pins that are connected to it.
    fn connect_encoder(&self) {
        self.chip.bus.touch("TIM5");
        let sources = self.chip.quadrature.iter().zip(ENCODER_PINS);
        for ((source, pin), level) in sources.zip(self.encoder) {
            let is_connected = self.chip.pins.mode(pin) == ENCODER_FUNCTION;
            source.set(Level::from(level && is_connected));
        }
    }

    /// Passes accesses of the core to these addresses of RAM to
    /// [`Watch::ram_access`] from now on, while it is watched.
    pub fn observe_ram(&mut self, ranges: &[Range<u32>]) {
        self.memory.observe(ranges);
    }

    /// Models the waits for flash and for registers from now on: an estimate
    /// from the reference manual, see [`crate::flash_interface`] and decision 92
    /// in docs/decisions.md. Without it the core never waits.
    pub fn model_flash(&mut self) {
        let waits = &self.chip.bus.waits;
        if !waits.is_on() {
            waits.switch_on();
            self.memory.time_flash(&self.chip);
            let register = self.peek(FLASH_ACR).unwrap_or(0);
            self.chip.bus.waits.set_register(register);
        }
    }

    /// Empties the caches of flash.
    pub fn clear_flash_caches(&mut self) {
        self.chip.bus.waits.clear();
    }

    /// Records the core's reads of flash from now on, if they are modelled.
    pub fn record_flash_reads(&mut self) {
        self.chip.bus.waits.record();
    }

    /// Takes the reads of flash since the last call.
    pub fn take_flash_reads(&mut self) -> Vec<FlashRead> {
        self.chip.bus.waits.take_reads()
    }

    /// Changes words of flash, as if another image had been flashed.
    ///
    /// # Panics
    /// If the address is outside of flash.
    pub fn patch_flash(&mut self, address: u32, bytes: &[u8]) {
        let offset = address.wrapping_sub(crate::image::FLASH);
        self.chip.flash.put(offset as usize, bytes);
    }

    /// Reads a word as the program does, with the side effects of a register;
    /// `None` at an unmapped address.
    pub fn load(&mut self, address: u32) -> Option<u32> {
        if address >= CORE {
            return self.peek(address);
        }
        let space = &self.memory.space;
        let word = space.read(u64::from(address), Width::U32, MemAttrs::DEFAULT);
        self.settle();
        word.ok().and_then(|word| u32::try_from(word).ok())
    }

    /// Sets whether a converter, counted from 0, starts no conversion any more.
    pub fn set_converter_dead(&mut self, converter: usize, is_dead: bool) {
        if let Some(adc) = self.chip.adcs.0.get(converter) {
            adc.set_dead(is_dead);
        }
    }

    /// Adds noise of this standard deviation, in counts, to every sample of the
    /// converters from now on: the same in every run.
    pub fn set_converter_noise(&mut self, counts: f64) {
        self.chip.analog.set_noise(counts);
    }

    /// Lets a byte that the DMA receives from the link get to memory so many clocks of 168 MHz after its
    /// stream has counted it.
    pub fn set_memory_lag(&mut self, clocks: u32) {
        self.chip.bus.memory_lag.set(2 * u64::from(clocks));
    }

    /// Triggers that the converters have missed because they were converting.
    pub fn lost_triggers(&self) -> u32 {
        self.chip.adcs.0.iter().map(|adc| adc.lost_triggers()).sum()
    }

    /// The watchdog's oscillator runs at this frequency, Hz: 17,000 to 47,000
    /// on silicon.
    pub fn set_watchdog_hz(&mut self, hz: u32) {
        let units = crate::time::UNITS_PER_S / u64::from(hz.max(1));
        self.chip.bus.touch("IWDG");
        self.chip.bus.rates.set_units(Clock::Low, units);
        self.settle();
    }

    /// The core's program counter.
    pub fn program_counter(&self) -> u32 {
        self.core.pc()
    }

    /// Number of those executed cycles that did without the library's help.
    pub fn fast_cycles(&self) -> u64 {
        self.fast_cycles
    }

    /// A core register.
    pub fn register(&self, number: u8) -> u32 {
        self.core.reg(number)
    }

    /// S0 to S31 and FPSCR of the floating-point unit.
    pub fn float_registers(&self) -> impl Iterator<Item = u32> {
        let floats = (0..32).map(|number| self.core.s(number));
        floats.chain([self.core.fpscr()])
    }

    /// Base address (RBAR) and attributes (RASR) of each region of the MPU.
    pub fn mpu_regions(&self) -> [(u32, u32); 8] {
        let (bases, attributes) = self.core.with_sys(|sys| (sys.mpu_rbar, sys.mpu_rasr));
        std::array::from_fn(|number| (bases[number], attributes[number]))
    }

    /// The exception being handled; 0 if none.
    pub fn exception(&self) -> u16 {
        self.core.current_exception().0
    }

    fn settle(&mut self) {
        if !self.chip.bus.is_touched() {
            return;
        }
        if self.chip.bus.take_pins_changed() {
            self.connect_encoder();
            for brake in &self.chip.brakes {
                brake.pins_changed();
            }
        }
        self.chip.bus.settle();
    }

    /// Sleeps without its own timer: nothing happens before the next event.
    fn sleeps_soundly(&self) -> bool {
        self.core.is_asleep() && self.core.with_sys(|sys| sys.syst_csr & SYSTICK_ENABLE == 0)
    }

    fn go_to(&mut self, until: u64, watch: Option<&mut dyn Watch>) {
        match watch {
            Some(watch) => self.run::<true>(until, watch),
            None => self.run::<false>(until, &mut NoWatch),
        }
    }

    fn run<const WATCHED: bool>(&mut self, until: u64, watch: &mut dyn Watch) {
        while self.now < until {
            self.is_hung |= self.chip.refusals.first().is_some();
            self.settle();
            let look = self.now + LOOK_UNITS;
            let stop = self.chip.bus.deadline().min(until).min(look);
            self.steps::<WATCHED>(stop, watch);
            self.chip.bus.advance(self.now);
            self.reset_if_asked();
        }
    }

    /// One step of the core: its cycles, and those of them in which it waited.
    fn step(&mut self) -> (u64, u64) {
        if !self.chip.bus.waits.is_on() {
            return (self.step_without_waits(), 0);
        }
        self.chip.bus.waits.begin(self.clock);
        let cycles = self.step_without_waits();
        let waits = self.chip.bus.waits.end();
        // The library's counter does not know of waits.
        self.core.with_sys(|sys| sys.tick_cyccnt(waits));
        (cycles + waits, waits)
    }

    /// One step as the library does it, with frames counted once, and with the
    /// state of what an exception interrupts.
    fn step_without_waits(&mut self) -> u64 {
        let may_interrupt = self.is_pending || self.chip.raised.any();
        let before = may_interrupt.then(|| Before::step(&self.core));
        self.is_reset = false;
        let cycles = self.core.step();
        // Only a store, or an exception, makes one pending.
        if cycles > 1 {
            self.is_pending = self.core.with_sys(|sys| sys.highest_pending().is_some());
        }
        if cycles < CHAINING {
            return cycles;
        }
        let exception = self.core.current_exception().0;
        if std::mem::replace(&mut self.exception, exception) == exception {
            return cycles;
        }
        let active = self.core.with_sys(|sys| sys.active_count());
        let was_active = std::mem::replace(&mut self.active, active);
        if let Some(before) = before {
            if active >= was_active {
                self.keep_flags(&before);
            }
            if active > was_active {
                self.keep_it_block(&before);
            }
        }
        if active == was_active {
            cycles
        } else {
            self.core
                .with_sys(|sys| sys.tick_cyccnt(FRAME_CYCLES.wrapping_neg()));
            cycles.saturating_sub(FRAME_CYCLES)
        }
    }

    /// Executes plain instructions until `stop`. Returns `false` if there is none,
    /// or if accesses to memory are observed.
    fn fast_steps<const WATCHED: bool>(
        &mut self,
        stop: u64,
        units: u64,
        watch: &mut dyn Watch,
    ) -> bool {
        if self.is_reset || self.memory.is_observed() {
            return false;
        }
        let most = (stop - self.now).div_ceil(units);
        // No plain instruction changes them.
        let exception = if WATCHED { self.exception() } else { 0 };
        let (active, now) = (self.active, self.now);
        let each = |executed: &Executed| {
            if WATCHED {
                watch.step(&Step {
                    pc: executed.pc,
                    exception,
                    active,
                    cycles: u32::try_from(executed.cycles).unwrap_or(u32::MAX),
                    waits: u32::try_from(executed.waits).unwrap_or(u32::MAX),
                    counter: None,
                    at: Time::from_units(now + executed.begin * units),
                });
            }
        };
        let cycles = self.fast_path.run(&self.core, self.clock, most, each);
        self.fast_cycles += cycles;
        self.cycles += cycles;
        self.clock += cycles;
        self.now += cycles * units;
        cycles > 0
    }

    /// Steps of the core until `stop`.
    fn steps<const WATCHED: bool>(&mut self, mut stop: u64, watch: &mut dyn Watch) {
        let mut units = self.chip.bus.rates.units(Clock::Core);
        while self.now < stop {
            if self.is_hung {
                self.now = stop;
                break;
            }
            let busy_until = self.chip.flash.busy_until();
            if busy_until > self.now {
                // Not an instruction can be fetched. A store does not tell the bus.
                self.chip.bus.touch("FLASH");
                self.settle();
                self.now = stop.min(busy_until);
                break;
            }
            if self.fast_steps::<WATCHED>(stop, units, watch) && self.now >= stop {
                break;
            }
            self.chip.bus.now.store(self.now, Relaxed);
            let before = WATCHED.then(|| self.before());
            let pc = before.map_or(0, |before| before.pc);
            let counter = WATCHED
                .then(|| cycle_counter::access(&self.core, |at| self.peek(at)))
                .flatten();
            let interrupted = self.exception;
            let (cycles, waits) = self.step();
            if let Some(before) = before {
                for (address, is_write) in self.memory.take_accesses() {
                    watch.ram_access(&RamAccess {
                        address,
                        is_write,
                        ..before
                    });
                }
                watch.step(&Step {
                    pc,
                    exception: self.core.current_exception().0,
                    active: self.active,
                    cycles: u32::try_from(cycles).unwrap_or(u32::MAX),
                    waits: u32::try_from(waits).unwrap_or(u32::MAX),
                    // With an exception the instruction has not been executed yet.
                    counter: counter.filter(|_| self.exception == interrupted),
                    at: Time::from_units(self.now),
                });
            }
            // In a handler no program of ours sleeps.
            let may_sleep = cycles == 1 && self.active == 0;
            if may_sleep && self.sleeps_soundly() && !self.chip.bus.is_touched() {
                // Whole cycles, so that the core keeps its phase.
                let asleep = (stop - self.now).div_ceil(units).max(1);
                self.now += asleep * units;
                self.clock += asleep;
                break;
            }
            self.cycles += cycles;
            self.clock += cycles;
            self.now += cycles * units;
            if self.chip.bus.is_touched() {
                self.settle();
                units = self.chip.bus.rates.units(Clock::Core);
                stop = stop.min(self.chip.bus.deadline());
            }
        }
    }

    /// State with which the next step begins.
    fn before(&self) -> RamAccess {
        RamAccess {
            pc: self.core.pc(),
            address: 0,
            is_write: false,
            exception: self.core.current_exception().0,
            priority: self.core.execution_priority(),
            at: Time::from_units(self.now),
        }
    }

    fn reset_if_asked(&mut self) {
        let cause = if self.chip.watchdog_fired.swap(false, Relaxed) {
            Reset::Watchdog
        } else if self.core.reset_requested() {
            Reset::Software
        } else {
            return;
        };
        self.resets.push((Time::from_units(self.now), cause));
        self.reset(cause);
    }

    fn port(&self, pin: Pin) -> Option<&rsemu::dev::stm32::gpio::Gpio> {
        self.chip.ports.get(pin.port()).map(|port| &**port)
    }
}
