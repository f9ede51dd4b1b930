//! The three converters, which a timer starts.
//!
//! ```text
//! trigger ── sampling ── 12 clocks ──> DR, EOC ── sampling ── 12 clocks ──> JDR1 … JEOC
//!            regular group                        injected group, with JAUTO
//! ```
//!
//! Modelled: regular conversions of a sequence of
//! any length, started by software or on an edge of a timer's trigger output;
//! injected ones that follow by themselves (JAUTO); of either group the first only
//! without SCAN; sampling times, prescaler, 12 bits right-aligned; EOC, JEOC, OVR, STRT,
//! JSTRT and the interrupts of EOC and OVR. The voltage is that at the end of
//! sampling, of the pin of the channel, and 0 unless that pin is analog, with the
//! converters' [`Noise`] if it is on. The
//! three share pins and prescaler. Not modelled: injected conversions with triggers or
//! offsets of their own, DMA, the analog watchdog, other
//! resolutions and triggers, continuous mode; [`Adc::uses_unmodelled_features`]
//! reports their use.

mod adcs;

pub(crate) use adcs::Adcs;

use super::registers::Words;
use crate::chip::bus::Now;
use crate::chip::clocks::{Clock, Rates};
use crate::chip::part::{Peripheral, lock};
use crate::chip::pins::Pins;
use crate::devices::noise::Noise;
use crate::mcu::Sampling;
use crate::pins::{Mode, Pin};
use crate::time::Time;
use rsemu::core::wire::{Level, WireSource};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

const EOC: u32 = 1 << 1;
const JEOC: u32 = 1 << 2;
const JSTRT: u32 = 1 << 3;
const STRT: u32 = 1 << 4;
const OVR: u32 = 1 << 5;

const EOCIE: u32 = 1 << 5;
const OVRIE: u32 = 1 << 26;
const SCAN: u32 = 1 << 8;
const JAUTO: u32 = 1 << 10;
/// Bits of CR1 that are modelled.
const KNOWN_1: u32 = EOCIE | OVRIE | SCAN | JAUTO;

/// Injected conversions at most.
const INJECTED: u32 = 4;

const ADON: u32 = 1;
const EOCS: u32 = 1 << 10;
const SWSTART: u32 = 1 << 30;
const EXTEN_SHIFT: u32 = 28;
const EXTSEL_SHIFT: u32 = 24;
const KNOWN_2: u32 = ADON | EOCS | SWSTART | 3 << EXTEN_SHIFT | 15 << EXTSEL_SHIFT;

/// Clocks of each sampling time.
const SAMPLING: [u64; 8] = [3, 15, 28, 56, 84, 112, 144, 480];

/// Clocks of a conversion of 12 bits.
const CONVERSION: u64 = 12;

/// Highest count.
const TOP: f64 = 4095.0;

/// The trigger outputs that are wired, with their numbers in EXTSEL.
pub(crate) const TRIGGERS: [(&str, u32); 3] = [("TIM2", 6), ("TIM3", 8), ("TIM8", 14)];

/// The most sampling intervals that are kept.
const KEPT: usize = 64;

/// The pin of a channel.
fn pin(channel: u32) -> Option<Pin> {
    let number = u8::try_from(channel).ok()?;
    match number {
        0..8 => Some(Pin::new('A', number)),
        8..10 => Some(Pin::new('B', number - 8)),
        10..16 => Some(Pin::new('C', number - 10)),
        _ => None,
    }
}

/// Voltage at a pin over time, as share of the converters' reference: a function of the time since its begin, s.
pub(crate) struct Course {
    begin: Time,
    share: Box<dyn Fn(f64) -> f64 + Send>,
}

impl Course {
    /// A voltage that changes from `begin` on.
    pub(crate) fn new(begin: Time, share: impl Fn(f64) -> f64 + Send + 'static) -> Self {
        Self {
            begin,
            share: Box::new(share),
        }
    }

    fn at(&self, units: u64) -> f64 {
        let since = units.saturating_sub(self.begin.units());
        (self.share)(Time::from_units(since).as_s())
    }
}

impl std::fmt::Debug for Course {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Course")
            .field("begin", &self.begin)
            .finish_non_exhaustive()
    }
}

/// Voltage at a pin.
#[derive(Debug)]
enum Voltage {
    Constant(f64),
    Over(Course),
}

/// Voltages at the pins, as share of the converter's reference.
#[derive(Debug)]
pub(crate) struct Analog {
    pins: Arc<Pins>,
    shares: Mutex<BTreeMap<Pin, Voltage>>,
    noise: Mutex<Option<Noise>>,
}

impl Analog {
    pub(crate) fn new(pins: Arc<Pins>) -> Self {
        Self {
            pins,
            shares: Mutex::default(),
            noise: Mutex::default(),
        }
    }

    /// Adds noise of this standard deviation, in counts, to every sample from now on.
    pub(crate) fn set_noise(&self, counts: f64) {
        *lock(&self.noise) = Some(Noise::new(counts / (TOP + 1.0)));
    }

    /// Sets the voltage at a pin.
    pub(crate) fn set(&self, pin: Pin, share: f64) {
        lock(&self.shares).insert(pin, Voltage::Constant(share));
    }

    /// Lets the voltage at a pin change over time.
    pub(crate) fn set_course(&self, pin: Pin, course: Course) {
        lock(&self.shares).insert(pin, Voltage::Over(course));
    }

    /// Voltage that a channel converts at this time, in units, noise included, as share of the reference.
    fn channel(&self, channel: u32, at: u64) -> f64 {
        let pin = pin(channel).filter(|pin| self.pins.mode(*pin) == Mode::Analog);
        let share = pin.and_then(|pin| {
            lock(&self.shares).get(&pin).map(|voltage| match voltage {
                Voltage::Constant(share) => *share,
                Voltage::Over(course) => course.at(at),
            })
        });
        let noise = lock(&self.noise).as_mut().map_or(0.0, Noise::next);
        share.unwrap_or(0.0) + noise
    }
}

/// A conversion's place in its group.
#[derive(Clone, Copy, Debug)]
enum Place {
    Regular(u32),
    Injected(u32),
}

#[derive(Debug, Default)]
struct State {
    sr: u32,
    cr1: u32,
    cr2: u32,
    smpr: [u32; 2],
    sqr: [u32; 3],
    jsqr: u32,
    dr: u32,
    jdr: [u32; INJECTED as usize],
    ccr: u32,
    /// Place of the current conversion, and its end.
    converting: Option<(Place, u64)>,
    /// Sampling of the current conversion, if it has not ended.
    sampling: Option<Sampling>,
    samplings: Vec<Sampling>,
    sampled: f64,
    trigger_levels: u32,
    lost_triggers: u32,
    is_dead: bool,
}

/// The device.
pub(crate) struct Adc {
    state: Mutex<State>,
    /// Number of the converter, from 1 on.
    number: u32,
    rates: Arc<Rates>,
    now: Now,
    interrupt: WireSource,
    analog: Arc<Analog>,
    asked_too_much: AtomicBool,
}

impl Adc {
    pub(crate) fn new(
        number: u32,
        rates: Arc<Rates>,
        now: Now,
        interrupt: WireSource,
        analog: Arc<Analog>,
    ) -> Self {
        Self {
            state: Mutex::default(),
            number,
            rates,
            now,
            interrupt,
            analog,
            asked_too_much: AtomicBool::new(false),
        }
    }

    /// Returns whether a program has used a feature that is not modelled.
    pub(crate) fn uses_unmodelled_features(&self) -> bool {
        self.asked_too_much.load(Relaxed)
    }

    /// Sets whether it starts no conversion any more.
    pub(crate) fn set_dead(&self, is_dead: bool) {
        lock(&self.state).is_dead = is_dead;
    }

    /// Takes the sampling intervals since the last call.
    pub(crate) fn take_samplings(&self) -> Vec<Sampling> {
        std::mem::take(&mut lock(&self.state).samplings)
    }

    /// Triggers that came while it was converting.
    pub(crate) fn lost_triggers(&self) -> u32 {
        lock(&self.state).lost_triggers
    }

    fn units(&self, state: &State) -> u64 {
        let prescaler = u64::from((state.ccr >> 16 & 3) + 1) * 2;
        prescaler * self.rates.units(Clock::Apb2)
    }

    /// The last index of a group. Without SCAN only the first is converted.
    fn last(state: &State, length: u32) -> u32 {
        if state.cr1 & SCAN == 0 { 0 } else { length }
    }

    fn last_regular(state: &State) -> u32 {
        Self::last(state, state.sqr[0] >> 20 & 15)
    }

    fn last_injected(state: &State) -> u32 {
        Self::last(state, state.jsqr >> 20 & 3)
    }

    fn channel(state: &State, place: Place) -> u32 {
        let (word, slot) = match place {
            Place::Regular(n) => (state.sqr[2 - (n / 6) as usize % 3], n % 6),
            // A short group is the end of its list.
            Place::Injected(n) => {
                let first = INJECTED - 1 - (state.jsqr >> 20 & 3);
                (state.jsqr, first + n)
            }
        };
        word >> (slot * 5) & 31
    }

    fn start(&self, state: &mut State, place: Place, at: u64) {
        let channel = Self::channel(state, place);
        let word = state.smpr[usize::from(channel < 10)];
        let sampling = SAMPLING[(word >> (channel % 10 * 3) & 7) as usize];
        let units = self.units(state);
        let end = at + sampling * units;
        state.sampling = Some(Sampling {
            converter: self.number,
            channel,
            pin: pin(channel),
            begin: Time::from_units(at),
            end: Time::from_units(end),
            converted: Time::from_units(end + CONVERSION * units),
        });
        state.converting = Some((place, end + CONVERSION * units));
        state.sr |= match place {
            Place::Regular(_) => STRT,
            Place::Injected(_) => JSTRT,
        };
    }

    fn trigger(&self, state: &mut State) {
        if state.cr2 & ADON == 0 || state.is_dead {
            return;
        }
        if state.converting.is_some() {
            state.lost_triggers += 1;
            return;
        }
        let now = self.now.load(Relaxed);
        self.start(state, Place::Regular(0), now);
    }

    fn happen(&self, state: &mut State, at: u64) {
        let is_due = |sampling: &Sampling| sampling.end.units() == at;
        if let Some(sampling) = state.sampling.take_if(|sampling| is_due(sampling)) {
            state.sampled = self.analog.channel(sampling.channel, at);
            if state.samplings.len() < KEPT {
                state.samplings.push(sampling);
            }
        }
        let Some((place, end)) = state.converting.filter(|(_, end)| *end == at) else {
            return;
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the range of the converter"
        )]
        let counts = (state.sampled * (TOP + 1.0)).floor().clamp(0.0, TOP) as u32;
        state.converting = None;
        let next = match place {
            Place::Regular(n) => Self::end_regular(state, n, counts),
            Place::Injected(n) => Self::end_injected(state, n, counts),
        };
        if let Some(next) = next {
            self.start(state, next, end);
        }
    }

    /// Stores a result; returns what is converted next.
    fn end_regular(state: &mut State, n: u32, counts: u32) -> Option<Place> {
        // Without DMA an overrun is detected only with EOCS.
        if state.sr & EOC != 0 && state.cr2 & EOCS != 0 {
            state.sr |= OVR;
        }
        state.dr = counts;
        let last = Self::last_regular(state);
        if n >= last || state.cr2 & EOCS != 0 {
            state.sr |= EOC;
        }
        if n < last {
            Some(Place::Regular(n + 1))
        } else {
            (state.cr1 & JAUTO != 0).then_some(Place::Injected(0))
        }
    }

    /// [`Self::end_regular`] for an injected conversion.
    fn end_injected(state: &mut State, n: u32, counts: u32) -> Option<Place> {
        state.jdr[n as usize] = counts;
        if n < Self::last_injected(state) {
            return Some(Place::Injected(n + 1));
        }
        state.sr |= JEOC;
        None
    }

    fn next(state: &State) -> Option<u64> {
        let end = state.converting.map(|(_, end)| end);
        let sampled = state.sampling.map(|sampling| sampling.end.units());
        [sampled, end].into_iter().flatten().min()
    }

    fn update_outputs(&self) {
        let state = lock(&self.state);
        let ends = state.sr & EOC != 0 && state.cr1 & EOCIE != 0;
        let overran = state.sr & OVR != 0 && state.cr1 & OVRIE != 0;
        drop(state);
        self.interrupt.set(Level::from(ends || overran));
    }
}

impl Peripheral for Adc {
    fn advance_to(&self, tick: u64) {
        {
            let mut state = lock(&self.state);
            while let Some(at) = Self::next(&state).filter(|at| *at <= tick) {
                self.happen(&mut state, at);
            }
        }
        self.update_outputs();
    }

    fn next_event(&self) -> Option<u64> {
        Self::next(&lock(&self.state))
    }

    fn reset(&self) {
        {
            let mut state = lock(&self.state);
            *state = State {
                trigger_levels: state.trigger_levels,
                lost_triggers: state.lost_triggers,
                is_dead: state.is_dead,
                ..State::default()
            };
        }
        self.update_outputs();
    }
}

impl Adc {
    /// A timer's trigger output; the line is its number in EXTSEL.
    fn set_trigger(&self, line: u32, level: Level) {
        let mut state = lock(&self.state);
        let was_high = state.trigger_levels >> line & 1 == 1;
        state.trigger_levels &= !(1 << line);
        state.trigger_levels |= u32::from(level.is_high()) << line;
        if state.cr2 >> EXTSEL_SHIFT & 15 != line || was_high == level.is_high() {
            return;
        }
        // Bit 0 of EXTEN: rising edges; bit 1: falling ones.
        let enabled = state.cr2 >> EXTEN_SHIFT & 3;
        if enabled & (if level.is_high() { 1 } else { 2 }) != 0 {
            self.trigger(&mut state);
        }
    }
}

impl Words for Adc {
    fn read(&self, offset: u32, is_debugger: bool) -> u32 {
        let value = {
            let mut state = lock(&self.state);
            match offset {
                0x00 => state.sr,
                0x04 => state.cr1,
                0x08 => state.cr2,
                0x0c => state.smpr[0],
                0x10 => state.smpr[1],
                0x2c => state.sqr[0],
                0x30 => state.sqr[1],
                0x34 => state.sqr[2],
                0x38 => state.jsqr,
                0x3c..0x4c => state.jdr[(offset - 0x3c) as usize / 4],
                0x4c => {
                    if !is_debugger {
                        state.sr &= !EOC;
                    }
                    state.dr
                }
                0x304 => state.ccr,
                _ => 0,
            }
        };
        if !is_debugger {
            self.update_outputs();
        }
        value
    }

    fn write(&self, offset: u32, value: u32) {
        {
            let mut state = lock(&self.state);
            match offset {
                0x00 => state.sr &= value,
                0x04 => state.cr1 = value,
                0x08 => {
                    state.cr2 = value & !SWSTART;
                    if value & SWSTART != 0 {
                        self.trigger(&mut state);
                    }
                    if value & ADON == 0 {
                        (state.sampling, state.converting) = (None, None);
                    }
                    let selected = value >> EXTSEL_SHIFT & 15;
                    let is_wired = TRIGGERS.iter().any(|(_, number)| *number == selected);
                    if value >> EXTEN_SHIFT & 3 != 0 && !is_wired {
                        self.asked_too_much.store(true, Relaxed);
                    }
                }
                0x0c => state.smpr[0] = value,
                0x10 => state.smpr[1] = value,
                0x2c => state.sqr[0] = value,
                0x30 => state.sqr[1] = value,
                0x34 => state.sqr[2] = value,
                0x38 => state.jsqr = value,
                // Offsets of the injected conversions.
                0x14..0x24 if value != 0 => self.asked_too_much.store(true, Relaxed),
                0x304 => state.ccr = value,
                _ => {}
            }
            if state.cr1 & !KNOWN_1 != 0 || state.cr2 & !KNOWN_2 != 0 {
                self.asked_too_much.store(true, Relaxed);
            }
        }
        self.update_outputs();
    }
}
