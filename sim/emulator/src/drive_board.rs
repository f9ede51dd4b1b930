//! The drive's image on its board: leg, link, enable lines, and comms: native, or
//! the image of comms on a board of its own ([`crate::comms_board`]).
//!
//! ```text
//!   native Comms ── 4.2 Mbaud ──> USART6 ┌───────────┐ TIM5 <── edges ─────┐
//!                <────────────────       │ the image │ ADCs <── current ── Leg
//!        │                               └───────────┘ TIM1 ──> voltage ───┘
//!   enable line of comms, PB10 ──────┬──── PB0, read back on PB1
//!                              motor supply
//! ```
//!
//! Leg and chip run alternately, half a tick at a time. The halves are
//! synchronised with the bridge's timer once it runs: a tick begins at its
//! bottom. The leg gets the bridge's mean voltage: duty times supply. With a scene whose `motor` has
//! the board's path of the current, the leg makes the pulses of it, and the converters see the two
//! amplifiers as they are when each sampling ends. The encoder's edges are evenly spaced in the last six
//! tenths of a half. The comparator is evaluated as a half ends.
//!
//! The driver of the vibration actuator's coil hangs on TIM8 and on the gate of both
//! enable lines; its nFAULT is at PA6, its current at PA3.
//!
//! A pin that is not set up for its wire connects nothing, and
//! [`DriveBoard::errors`] names it, as it does a shoot-through, a converter
//! that samples at the wrong time, and the rest of [`BoardError`].

mod access;
mod board_error;
mod coil_driver;
mod comms_side;
mod encoder_edges;
mod half_bridges;
mod link_wires;
mod native_comms;
mod pin_map;
mod wiring;

use crate::devices::adc::Course;
use crate::image::Image;
use crate::mcu::{Reset, Sampling, Watch};
use crate::pins::Pin;
use crate::stm32f405::Stm32f405;
use crate::time::Time;
use crepitus_device::board::{
    self, COIL_CURRENT, MOTOR_CURRENT, MOTOR_TEMPERATURE, REFERENCE_V, TRIP_A,
};
use crepitus_virtual_device::leg::{CurrentPath, Leg, Terminals};
use encoder_edges::Edges;
use half_bridges::Quiet;
use pin_map::{
    BREAK, COIL, COIL_FAULT, COMMS_LINE, JOINT, LINE, LINE_BACK, MONITOR, MOTOR, SENSOR, SUPPLY,
};

pub use board_error::BoardError;
pub use comms_side::CommsSide;
pub use native_comms::NativeComms;

/// Half a tick.
pub const HALF: Time = Time::from_us(25);

/// Share of the converters' reference per ampere.
const SHARE_PER_A: f64 = MOTOR_CURRENT.volts_per_ampere() / REFERENCE_V;

/// Share of the converters' reference per ampere of the coil.
const COIL_SHARE_PER_A: f64 = COIL_CURRENT.volts_per_ampere() / REFERENCE_V;

/// Faults of the board.
#[derive(Clone, Copy, Debug, Default)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a part that works or not"
)]
pub struct Faults {
    /// Cut of the link from comms: nothing arrives.
    pub down_is_cut: bool,
    /// Cut of the link from the drive: nothing arrives.
    pub up_is_cut: bool,
    /// The comparator behind the monitor's amplifier never trips.
    pub trip_is_blind: bool,
    /// The drive's line is stuck at this level.
    pub line_is_stuck: Option<bool>,
    /// The drive's gate lets all pass, whatever its line.
    pub drive_gate_is_stuck: bool,
    /// The gate of comms lets all pass, whatever its line.
    pub comms_gate_is_stuck: bool,
}

/// The board, with comms at the other end of its link.
pub struct DriveBoard<C = NativeComms> {
    mcu: Stm32f405,
    leg: Leg,
    comms: C,
    /// Current faults.
    pub faults: Faults,
    edges: Edges,
    is_second: bool,
    /// End of the next half.
    end: Time,
    is_synchronised: bool,
    resets: Vec<(Time, Reset)>,
    errors: Vec<(Time, BoardError)>,
    /// Samplings of the converters that are not checked yet.
    samplings: Vec<Sampling>,
    /// Time without switching around the middle of this tick, if all of it was
    /// synchronised.
    quiet: Option<Quiet>,
}

impl<C: CommsSide> DriveBoard<C> {
    /// The board with an image and a leg, just switched on.
    pub fn new(image: &Image, leg: Leg, comms: C) -> Self {
        let mut mcu = Stm32f405::new(image);
        mcu.drive_pin(BREAK, true);
        mcu.drive_pin(COIL_FAULT, true);
        Self {
            mcu,
            leg,
            comms,
            faults: Faults::default(),
            edges: Edges::default(),
            is_second: false,
            end: Time::ZERO,
            is_synchronised: false,
            resets: Vec::new(),
            errors: Vec::new(),
            samplings: Vec::new(),
            quiet: None,
        }
    }

    /// Runs a number of ticks.
    pub fn run(&mut self, ticks: u64) {
        for _ in 0..2 * ticks {
            self.half(None);
        }
    }

    /// Runs as [`Self::run`] does, passing every step of the core to `watch`.
    pub fn watch(&mut self, ticks: u64, watch: &mut dyn Watch) {
        for _ in 0..2 * ticks {
            self.half(Some(watch));
        }
    }

    /// Runs to the middle of a tick, unless already there.
    pub fn to_the_middle(&mut self) {
        if !self.is_second {
            self.half(None);
        }
    }

    /// Half a tick of everything.
    pub fn half(&mut self, mut watch: Option<&mut dyn Watch>) {
        // In the half in which it becomes so, edges come when they no longer fit.
        let was_synchronised = self.is_synchronised;
        self.synchronise();
        self.connect();
        let before = self.leg.count();
        if self.is_second {
            self.leg.second_half();
        } else {
            self.leg.first_half();
        }
        let counter = wiring::counter(&self.mcu);
        let begin = self.mcu.now().min(self.end);
        self.show_current(CurrentPath::Sensor, SENSOR, SHARE_PER_A, self.end);
        // Wired the other way round.
        self.show_current(CurrentPath::Monitor, MONITOR, -SHARE_PER_A, self.end);
        let coil_share = 0.5 + COIL_SHARE_PER_A * self.leg.coil_a();
        self.mcu.set_analog(COIL, coil_share);
        self.show_slow_sensors();
        self.end = self.end.max(begin) + HALF;
        let start = self.end - HALF;
        for (at, channel, level) in self.edges.between(before, self.leg.count(), start) {
            go(&mut self.mcu, at, &mut watch);
            self.mcu.drive_encoder(channel, level);
        }
        go(&mut self.mcu, self.end, &mut watch);
        self.check_comparator();
        self.carry();
        self.check_refusals();
        let resets = self.mcu.take_resets();
        if !resets.is_empty() {
            (self.is_synchronised, self.quiet) = (false, None);
        }
        self.resets.extend(resets);
        if was_synchronised && self.is_synchronised {
            let turned = self.leg.count().wrapping_sub(before);
            self.check_wiring(turned, counter);
        } else {
            // Those of the half in which it becomes so are not those of a whole tick.
            self.mcu.take_samplings();
        }
        self.is_second = !self.is_second;
    }

    /// Adds a program that was stopped to the errors.
    fn check_refusals(&mut self) {
        let found = [
            ("drive", self.mcu.refusal()),
            ("comms", self.comms.refusal()),
        ];
        for (controller, refusal) in found {
            let Some(refusal) = refusal else { continue };
            let error = BoardError::Refused {
                controller,
                refusal,
            };
            if !self.errors.iter().any(|(_, known)| *known == error) {
                self.errors.push((self.mcu.now(), error));
            }
        }
    }

    /// A current at its pin, with this share of the reference for an ampere, in the half that begins.
    fn show_current(&mut self, path: CurrentPath, pin: Pin, share_per_a: f64, begin: Time) {
        let share = move |current_a: f64| 0.5 + share_per_a * current_a;
        match self.leg.amplifier(path) {
            None => self.mcu.set_analog(pin, share(self.leg.current_a(path))),
            Some(amplifier) => {
                let course = Course::new(begin, move |at_s| share(amplifier.shown_a(at_s)));
                self.mcu.set_analog_course(pin, course);
            }
        }
    }

    fn show_slow_sensors(&mut self) {
        let supply_v = self.leg.measured_supply_v();
        let motor_c = self.leg.slow_sensors().motor_c;
        let motor_v = MOTOR_TEMPERATURE.freezing_v + motor_c / MOTOR_TEMPERATURE.celsius_per_volt;
        let supply_share = supply_v / board::SUPPLY.share() / REFERENCE_V;
        self.mcu.set_analog(SUPPLY, supply_share);
        self.mcu.set_analog(MOTOR, motor_v / REFERENCE_V);
        self.mcu.set_analog(JOINT, self.leg.joint_turns());
    }

    /// Adds new mismatches of image and wiring to the errors.
    fn check_wiring(&mut self, turned: i32, counter: i32) {
        let quiet = self.quiet.take();
        if !self.is_second {
            let bridge = half_bridges::quiet(&self.mcu);
            let coil = coil_driver::quiet(&self.mcu);
            self.quiet = Some(coil.map_or(bridge, |coil| bridge.and(coil)));
        }
        let middle = self.end - HALF;
        let Self {
            mcu,
            errors,
            samplings,
            ..
        } = self;
        coil_driver::count_on(mcu);
        let now = mcu.now();
        let mut report = |error| {
            if !errors.iter().any(|(_, known)| *known == error) {
                errors.push((now, error));
            }
        };
        wiring::check(mcu, &mut report);
        if self.is_second {
            // The core may have run ahead of the board.
            samplings.extend(mcu.take_samplings());
            let is_past = |sampling: &mut Sampling| sampling.begin < middle + HALF;
            let samplings: Vec<Sampling> = samplings.extract_if(.., is_past).collect();
            if let Some(quiet) = quiet {
                wiring::check_samplings(&samplings, middle, quiet, &mut report);
            }
        }
        let counted = wiring::counter(mcu).wrapping_sub(counter);
        if counted != turned {
            report(BoardError::Encoder { counted, turned });
        }
    }

    /// Aligns the ends of halves with the bottom and top of the bridge's timer, once
    /// it runs.
    fn synchronise(&mut self) {
        if self.is_synchronised {
            return;
        }
        let Some(phase) = half_bridges::phase(&self.mcu) else {
            return;
        };
        self.is_synchronised = true;
        // Those until now were not in step with anything.
        self.mcu.take_samplings();
        self.is_second = phase >= HALF;
        let into = if self.is_second { phase - HALF } else { phase };
        self.end = self.mcu.now() - into;
    }

    /// Updates lines and terminals.
    fn connect(&mut self) {
        let line = self.line_is_on();
        self.mcu.drive_pin(LINE_BACK, line);
        self.mcu.drive_pin(COMMS_LINE, self.comms.line_is_on());
        let is_open = (line || self.faults.drive_gate_is_stuck)
            && (self.comms.line_is_on() || self.faults.comms_gate_is_stuck);
        let terminals = if is_open {
            half_bridges::terminals(&self.mcu, self.leg.supply_v())
        } else {
            Terminals::Open
        };
        self.leg.set_terminals(terminals);
        let is_awake = line && self.comms.line_is_on();
        let duty = coil_driver::duty(&self.mcu).filter(|_| is_awake);
        self.leg.set_coil(duty);
        // Open drain with a pull-up: high while it sleeps, low if the wire is broken.
        let fails = self.leg.coil_faults().driver_fails;
        self.mcu.drive_pin(COIL_FAULT, !fails);
    }

    fn check_comparator(&mut self) {
        let monitor_a = self.leg.current_a(CurrentPath::Monitor);
        let is_over = monitor_a.abs() > f64::from(TRIP_A);
        self.mcu
            .drive_pin(BREAK, !is_over || self.faults.trip_is_blind);
    }

    /// Lets comms run, with what goes over the link.
    fn carry(&mut self) {
        let mut sent = self.mcu.link_take();
        if self.faults.up_is_cut {
            sent.clear();
        }
        let answered = self.comms.run(sent, self.end, self.mcu.now());
        if !self.faults.down_is_cut {
            for character in answered {
                self.mcu.link_feed(character);
            }
        }
    }

    /// Returns whether the drive's enable line is on.
    pub fn line_is_on(&self) -> bool {
        self.faults
            .line_is_stuck
            .unwrap_or_else(|| self.mcu.pin(LINE))
    }

    /// Returns whether the enable line of comms is on.
    pub fn comms_line_is_on(&self) -> bool {
        self.comms.line_is_on()
    }

    /// Returns whether the drive itself drives the motor: its bridge switches and its
    /// line is on.
    pub fn drive_is_on(&self) -> bool {
        let terminals = half_bridges::terminals(&self.mcu, self.leg.supply_v());
        self.line_is_on() && terminals != Terminals::Open
    }

    /// Returns whether the motor is driven: by the drive, and enabled by comms.
    pub fn is_driven(&self) -> bool {
        self.drive_is_on() && self.comms.line_is_on()
    }

    /// Simulates a brief drop of the supply.
    pub fn brown_out(&mut self) {
        self.reset(Reset::BrownOut);
    }

    /// Resets the chip.
    pub fn reset(&mut self, reset: Reset) {
        self.resets.push((self.mcu.now(), reset));
        self.mcu.reset(reset);
        (self.is_synchronised, self.quiet) = (false, None);
    }
}

fn go(mcu: &mut Stm32f405, until: Time, watch: &mut Option<&mut dyn Watch>) {
    match watch {
        Some(watch) => mcu.watch_until(until, *watch),
        None => mcu.run_until(until),
    }
}
