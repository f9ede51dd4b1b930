//! A winding on a bridge that the caller switches: the board, whose device
//! code closes the current loop itself.
//!
//! Driven, the terminals have the commanded voltage, within the
//! supply's. Open, all its switches are off, and what current there is flows
//! on through their diodes, against the supply:
//!
//! ```text
//! v = −sgn(i)·(U + 2·Ud)   until i = 0;   then i = 0, and no torque,
//! unless |Kt·N·Ω| > U + 2·Ud: then the motor is a generator on the supply
//! ```
//!
//! The instant at which the current has died away is located inside the step
//! and the step cut there, as it is for the modes of a chain. The supply takes
//! back what it gets: it is stiff.
//!
//! **A switch that is shorted** leaves a way on which a current meets one diode
//! instead of the supply, in one sense: an open bridge then brakes a shaft that
//! turns the other way.
//!
//! Ud is 0.8 V, an estimate: body diodes of MOSFETs at an ampere.
//!
//! With a [path of the current](crate::effects::motor::current_path) that is not ideal, its owner tells the bridge
//! where each half of a tick begins: what the winding gets is then the mean of the pulses.

use crate::actuator::Actuator;
use crate::chain::{Push, Step, Verdict, sense_of};
use crate::effects::motor::current_path::{CurrentPath, Half};
use crate::effects::motor::winding::{Course, Winding};
use crate::effects::motor::{COLUMNS, MotorNumbers, NAME};
use crate::energy_balance::{Account, EnergyBalance};
use crepitus_model::Sense;

pub use crepitus_model::control::current_path::DIODE_V;

/// Share of itself below which a falling current counts as zero.
const NEARLY: f64 = 1e-5;

/// State of the bridge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Terminals {
    /// The bridge holds this voltage, V; positive drives towards growing angle.
    Driven(f64),
    /// All switches are off.
    Open,
}

/// Mode in which the current flows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    /// Current through switches, at this voltage.
    Driven(f64),
    /// Current through diodes, in this sense.
    Diodes(Sense),
    /// No current.
    Blocked,
}

/// A motor's winding on a bridge.
#[derive(Clone, Debug)]
pub struct Bridge {
    winding: Winding,
    supply_v: f64,
    /// The sense of a current that a shorted switch lets through.
    shorted: Option<Sense>,
    /// A contact in the motor's line is open: no current at all.
    line_is_open: bool,
    mode: Mode,
    /// The diodes were found not to begin to conduct in this step: at the edge
    /// they would switch endlessly.
    refused: bool,
    charge_c: f64,
    supply_j: f64,
    diodes_j: f64,
    /// Back-EMF in the last step, V.
    emf_v: f64,
    path: Option<CurrentPath>,
    /// Mean of the pulses in this half of a tick, V.
    pulses_v: Option<f64>,
}

impl Bridge {
    /// An open bridge on a motor without current, mostly stepped by `usual_s`.
    pub fn new(motor: MotorNumbers, usual_s: f64) -> Self {
        Self {
            winding: Winding::new(motor.winding, 0.0, usual_s),
            supply_v: motor.supply_v,
            shorted: None,
            line_is_open: false,
            mode: Mode::Blocked,
            refused: false,
            charge_c: 0.0,
            supply_j: 0.0,
            diodes_j: 0.0,
            emf_v: 0.0,
            path: motor.current_path(),
            pulses_v: None,
        }
    }

    /// Begins the first or the second half of a tick, with what the bridge was set to. Only a path that is not ideal
    /// needs it.
    pub fn begin_half(&mut self, is_second: bool) {
        let current_a = self.current_a();
        let Some(path) = &mut self.path else {
            return;
        };
        self.pulses_v = match self.mode {
            Mode::Driven(volts) => {
                let duty = volts / self.supply_v;
                Some(path.half(is_second, duty, current_a, self.emf_v).0)
            }
            Mode::Diodes(_) | Mode::Blocked => {
                path.float(current_a);
                None
            }
        };
    }

    /// The current as the amplifier at a half shows it, A: the mean of the samples around the end of the half tick
    /// that was begun last.
    pub fn sampled_a(&self, half: Half) -> f64 {
        match &self.path {
            Some(path) => path.sampled_a(half) - path.even_a() + self.current_a(),
            None => self.current_a(),
        }
    }

    /// The path of the current in the half tick that was begun last; none if it is ideal.
    pub fn path(&self) -> Option<&CurrentPath> {
        self.path.as_ref()
    }

    /// Switches the bridge. A voltage beyond the supply's is the supply's.
    pub fn set(&mut self, terminals: Terminals) {
        if self.line_is_open {
            return;
        }
        self.pulses_v = None;
        self.mode = match terminals {
            Terminals::Driven(v) => Mode::Driven(v.clamp(-self.supply_v, self.supply_v)),
            Terminals::Open => Sense::of(self.current_a()).map_or(Mode::Blocked, Mode::Diodes),
        };
    }

    /// Shorts a switch, so that a current of this sense flows while the bridge is
    /// open, or repairs it.
    pub fn set_shorted(&mut self, shorted: Option<Sense>) {
        self.shorted = shorted;
    }

    /// Opens or closes a contact in the motor's line. What the current had left
    /// goes into the contact.
    pub fn set_line(&mut self, is_open: bool) {
        self.line_is_open = is_open;
        if is_open {
            self.diodes_j += self.winding.cut_off();
            self.mode = Mode::Blocked;
        }
    }

    /// The winding's current now, A; positive drives towards growing angle.
    pub fn current_a(&self) -> f64 {
        self.winding.current_a()
    }

    /// Charge that has gone through the winding so far, A·s: times Kt·N, the
    /// impulse on the joint.
    pub fn charge_c(&self) -> f64 {
        self.charge_c
    }

    /// The winding.
    pub fn winding(&self) -> &Winding {
        &self.winding
    }

    /// The supply's voltage, V.
    pub fn supply_v(&self) -> f64 {
        self.supply_v
    }

    /// Voltages against a current of this sense: the supply's, and that of diodes, V.
    fn against_v(&self, sense: Sense) -> (f64, f64) {
        match self.shorted {
            None => (self.supply_v, 2.0 * DIODE_V),
            Some(free) if free == sense => (0.0, DIODE_V),
            Some(_) => (self.supply_v, DIODE_V),
        }
    }

    /// The sum of both, V.
    fn all_against_v(&self, sense: Sense) -> f64 {
        let (supply_v, diodes_v) = self.against_v(sense);
        supply_v + diodes_v
    }

    /// The voltage at terminals through which a current flows, V.
    fn voltage_v(&self) -> Option<f64> {
        match self.mode {
            Mode::Driven(v) => Some(self.pulses_v.unwrap_or(v)),
            Mode::Diodes(sense) => Some(-sense.of_signed(self.all_against_v(sense))),
            Mode::Blocked => None,
        }
    }

    /// A current through diodes, of this course: dies away, or flows on.
    fn judge(&mut self, sense: Sense, step: &Step, course: &Course) -> Verdict {
        let start = sense.of_signed(self.current_a());
        let tends_to = sense.of_signed(course.final_a);
        if start <= 0.0 {
            if tends_to > 0.0 {
                return Verdict::Holds;
            }
            self.refused = true;
            self.mode = Mode::Blocked;
            return Verdict::Again;
        }
        let left = self.winding.left_after(step.length_s);
        if sense.of_signed(course.current_a(left)) > NEARLY * start {
            return Verdict::Holds;
        }
        // Without current after τ·ln((i − i∞)/(−i∞)).
        let ends_s = self.winding.time_constant_s() * (-start / tends_to).ln_1p();
        Verdict::EndsAt((ends_s / step.length_s).min(1.0))
    }
}

impl Actuator for Bridge {
    fn fold(&mut self, length_s: f64) -> Push {
        match self.voltage_v() {
            Some(voltage_v) => self.winding.fold(voltage_v, length_s),
            None => Push::default(),
        }
    }

    fn check(&mut self, step: &Step, mean_rad_s: impl FnOnce() -> f64) -> Verdict {
        match self.mode {
            Mode::Driven(_) => Verdict::Holds,
            Mode::Diodes(sense) => {
                let voltage_v = -sense.of_signed(self.all_against_v(sense));
                let course = self.winding.course(voltage_v, mean_rad_s());
                self.judge(sense, step, &course)
            }
            Mode::Blocked => {
                let emf_v = self.winding.settings().constant * mean_rad_s();
                let sense = sense_of(-emf_v);
                if emf_v.abs() <= self.all_against_v(sense) || self.refused || self.line_is_open {
                    return Verdict::Holds;
                }
                self.mode = Mode::Diodes(sense);
                Verdict::Again
            }
        }
    }

    fn load_nm(&self) -> f64 {
        self.winding.load_nm()
    }

    fn settle(&mut self, length_s: f64, mean_rad_s: f64) {
        self.refused = false;
        self.emf_v = self.winding.settings().constant * mean_rad_s;
        let Some(voltage_v) = self.voltage_v() else {
            self.winding.idle();
            return;
        };
        let start_a = self.current_a();
        let course = self.winding.course(voltage_v, mean_rad_s);
        let mean_a = self
            .winding
            .settle(voltage_v, length_s, mean_rad_s, &course);
        let charge_c = mean_a * length_s;
        self.charge_c += charge_c;
        self.supply_j += voltage_v * charge_c;
        if let Mode::Diodes(sense) = self.mode {
            let (_, diodes_v) = self.against_v(sense);
            let diodes_j = diodes_v * sense.of_signed(charge_c);
            self.supply_j += diodes_j;
            self.diodes_j += diodes_j;
            if sense.of_signed(self.current_a()) <= NEARLY * start_a.abs() {
                self.diodes_j += self.winding.cut_off();
                self.mode = Mode::Blocked;
            }
        }
    }

    fn absorbed_j(&self) -> f64 {
        self.winding.absorbed_j()
    }

    fn energy(&self, balance: &mut EnergyBalance) {
        balance.add(NAME, "supply", Account::Given, self.supply_j);
        balance.add(NAME, "diodes", Account::Lost, self.diodes_j);
        self.winding.energy(NAME, balance);
    }

    fn columns(&self) -> &'static [&'static str] {
        &COLUMNS
    }

    fn write(&self, row: &mut Vec<f64>) {
        // Open terminals without current show the back-EMF; it is not kept.
        row.extend([
            self.current_a(),
            self.voltage_v().unwrap_or(0.0),
            self.winding.torque_nm(),
        ]);
    }
}
