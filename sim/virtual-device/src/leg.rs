//! Motor, encoder and current sensors on a leg that moves as a scene says.
//!
//! ```text
//! tick n       first half        second half
//!        ├───────────────────┬───────────────────┤
//!   count(), bridge     current_a()         count(), bridge
//! ```
//!
//! A tick is simulated in two halves, because the drive samples the current
//! in its middle. The bridge may be switched between any two halves and holds
//! its last command: PWM loads at a tick's start, an emergency off is
//! immediate.
//!
//! Of a scene's effects the leg has those of the mechanics (`drivetrain`,
//! `backlash`, `cuff`, `limb`, `hand`); a motor's winding is always there, with
//! the scene's numbers or the defaults. What a device does (`crepitus`,
//! `friction-compensation`, `bone-shaping`, the current loop of `motor`) is
//! the board's to do.
//!
//! A scene whose `motor` has dead time, lag or excursions of its amplifiers has them here, too: see
//! [`current_path`](crepitus_plant::effects::motor::current_path).
//!
//! Strokes, sines and constant velocities continue for ever. Velocity knots and
//! recordings are followed to the end of the scene; the motion then slows down
//! within a tenth of a second, and rests.
//!
//! A leg that [begins straight](Scene::begins_straight) is at 0° until the motor is driven, and is led
//! to the motion's start before that begins. An [examiner](Scene::has_examiner) chooses the motion by the knee, but in a
//! [blind](HandInput::set_blind) trial. A [hand](HandInput) can take the leg from either, and give it back.

mod coil;
mod examiner;
mod hand;
mod hand_input;
mod lead_in;
mod movement;
mod mover;
mod sensors;
#[cfg(test)]
mod tests;

pub use coil::{COIL_RANGE_A, CoilFaults};
pub use crepitus_plant::effects::motor::bridge::Terminals;
pub use hand_input::HandInput;
pub use sensors::{Amplifier, CurrentPath, CurrentSensor, EncoderWiring, SlowSensors};

use coil::CoilDriver;
use crepitus_model::Sense;
use crepitus_model::render::effects::EffectSettings;
use crepitus_plant::chain::Body;
use crepitus_plant::effects::motor::bridge::Bridge;
use crepitus_plant::effects::motor::{self, MotorNumbers};
use crepitus_plant::energy_balance::EnergyBalance;
use crepitus_plant::{Motion, Plant};
use crepitus_scene::Scene;
use mover::Mover;
use sensors::Counter;

/// Tick of the drive, s.
pub const TICK_S: f64 = 5e-5;

/// Time constant of the supply's capacitors without a supply, s: 470 µF and 220 Ω.
const DISCHARGE_S: f64 = 0.1;

/// A leg with brace, gear and motor.
pub struct Leg {
    plant: Plant<Bridge>,
    mover: Mover,
    steps_per_half: u32,
    counter: Counter,
    /// Current sensors of the loop, and of the monitor.
    current_sensors: [CurrentSensor; 2],
    slow_sensors: SlowSensors,
    /// Voltage of the supply's capacitors, V.
    capacitors_v: f64,
    /// Command to the bridge.
    terminals: Terminals,
    is_supplied: bool,
    coil: CoilDriver,
    /// Impulse at the hand and charge at the start of the tick.
    begun: (f64, f64),
    felt_nm: f64,
    motor_nm: f64,
}

impl Leg {
    /// The leg of a scene at the start of its motion, or straight. The bridge is open, the
    /// counter zero, whatever the angle.
    pub fn new(scene: &Scene) -> Self {
        // A scene's steps are those of a tick.
        let steps_per_half = scene.substeps.div_ceil(2);
        let step_s = TICK_S / (2.0 * f64::from(steps_per_half));
        let mover = Mover::new(scene, step_s);
        let straight = mover.leads().then(|| Scene {
            motion: Motion::rest(0.0),
            ..scene.clone()
        });
        let at_first = straight.as_ref().unwrap_or(scene);
        let motor = MotorNumbers::of(&scene.given(&motor::EFFECT));
        let plant = at_first.assemble_with(TICK_S, Bridge::new(motor, step_s));
        mover.input().report(None, plant.shaft().angle_rad);
        let encoder = scene.encoder.unwrap_or_default();
        Self {
            counter: Counter::new(&encoder, plant.shaft().angle_rad),
            begun: (plant.felt_nms(), 0.0),
            plant,
            mover,
            steps_per_half,
            current_sensors: [CurrentSensor::Right; 2],
            slow_sensors: SlowSensors::default(),
            capacitors_v: motor.supply_v,
            terminals: Terminals::Open,
            is_supplied: true,
            coil: CoilDriver::new(scene),
            felt_nm: 0.0,
            motor_nm: 0.0,
        }
    }

    /// The first half of a tick. The current is sampled at its end.
    pub fn first_half(&mut self) {
        self.begun = (self.plant.felt_nms(), self.plant.actuator().charge_c());
        self.half(false);
    }

    /// The second half of a tick.
    pub fn second_half(&mut self) {
        self.half(true);
        let felt_nms = self.plant.felt_nms();
        let is_driven = matches!(self.terminals, Terminals::Driven(_));
        self.mover.tick(is_driven, &mut self.plant);
        self.capacitors_v = if self.is_supplied {
            self.supply_v()
        } else {
            self.capacitors_v * (-TICK_S / DISCHARGE_S).exp()
        };
        let (before_nms, charge_c) = self.begun;
        let bridge = self.plant.actuator();
        let impulse_nms = bridge.winding().settings().constant * (bridge.charge_c() - charge_c);
        self.felt_nm = (felt_nms - before_nms) / TICK_S;
        self.motor_nm = -impulse_nms / TICK_S;
    }

    fn half(&mut self, is_second: bool) {
        self.plant.actuator_mut().begin_half(is_second);
        for _ in 0..self.steps_per_half {
            self.mover.advance(&mut self.plant);
        }
        self.counter.turn_to(self.plant.shaft().angle_rad);
    }

    /// Input of a hand that moves the leg.
    pub fn hand(&self) -> HandInput {
        self.mover.input().clone()
    }

    /// Tells the examiner, if there is one, which knee it is: its effects, and whether the imaginary object is on. For
    /// another knee he or she stops, and begins another examination; not in a blind trial.
    pub fn examine(&mut self, effects: &EffectSettings, grates: bool) {
        self.mover.examine(effects, grates);
    }

    /// Releases the leg: from now on nobody holds it, whatever the scene's motion.
    pub fn release(&mut self) {
        self.plant.release();
    }

    /// Sets the command to the bridge.
    pub fn set_terminals(&mut self, terminals: Terminals) {
        self.terminals = terminals;
        self.switch();
    }

    fn switch(&mut self) {
        let terminals = if self.is_supplied {
            self.terminals
        } else {
            Terminals::Open
        };
        self.plant.actuator_mut().set(terminals);
        self.plant.set_coil(self.coil.terminals(self.is_supplied));
    }

    /// Sets the duty of the coil's driver, −1 to 1; `None` lets it sleep.
    pub fn set_coil(&mut self, duty: Option<f64>) {
        self.coil.set(duty);
        self.switch();
    }

    /// Reading of the coil's current sensor, A.
    pub fn coil_a(&self) -> f64 {
        let coil_a = self.plant.coil_current_a().unwrap_or(0.0);
        self.coil.shows_a(coil_a, self.is_supplied)
    }

    /// Voltage at the coil's driver, V; `None` where its outputs are open.
    pub fn coil_v(&self) -> Option<f64> {
        self.coil.volts(self.is_supplied)
    }

    /// The encoder's counter now, as a 32-bit timer holds it: it wraps.
    pub fn count(&self) -> i32 {
        self.counter.count()
    }

    /// Sets the counter to `count`.
    pub fn preset_count(&mut self, count: i32) {
        self.counter.preset(count);
    }

    /// Reading of the current by one of the two shunts with its amplifier, A: the mean of a tick's conversions, after
    /// its first half.
    pub fn current_a(&self, path: CurrentPath) -> f64 {
        self.current_sensors[path as usize].shows(self.plant.actuator().sampled_a(path.half()))
    }

    /// The amplifier of a shunt in the last half of a tick; `None` if bridge and amplifiers are ideal, so that it shows
    /// [`Self::current_a`] all the time.
    pub fn amplifier(&self, path: CurrentPath) -> Option<Amplifier> {
        let ways = self.plant.actuator().path()?;
        Some(Amplifier {
            off_a: self.winding_current_a() - ways.even_a(),
            path: ways.clone(),
            half: path.half(),
            sensor: self.current_sensors[path as usize],
        })
    }

    /// The true current, A; positive drives towards growing angle.
    pub fn winding_current_a(&self) -> f64 {
        self.plant.actuator().current_a()
    }

    /// Voltage of the motor's supply, V.
    pub fn supply_v(&self) -> f64 {
        if self.is_supplied {
            self.plant.actuator().supply_v()
        } else {
            0.0
        }
    }

    /// Voltage that the supply's sensor shows, V. Without a supply, capacitors
    /// discharge.
    pub fn measured_supply_v(&self) -> f64 {
        self.slow_sensors.supply_v.unwrap_or(self.capacitors_v)
    }

    /// Reading of the joint's own sensor, as a share of its turn. Its zero is not the
    /// joint's.
    pub fn joint_turns(&self) -> f64 {
        let angle_rad = self.plant.shaft().angle_rad - self.slow_sensors.slipped_rad;
        let turns = (angle_rad / std::f64::consts::TAU + 0.9).rem_euclid(1.0);
        self.slow_sensors.joint_turns.unwrap_or(turns)
    }

    /// The sensors of what changes slowly.
    pub fn slow_sensors(&self) -> &SlowSensors {
        &self.slow_sensors
    }

    /// Time since the start of the motion, s; what leads to it included.
    pub fn time_s(&self) -> f64 {
        self.mover.time_s()
    }

    /// The motor's shaft, referred to the joint.
    pub fn shaft(&self) -> Body {
        self.plant.shaft()
    }

    /// The leg itself, where the hand is.
    pub fn leg(&self) -> Body {
        self.plant.leg()
    }

    /// Mean torque at the hand in the last tick, N·m; positive opposes growing
    /// angle. Zero if the leg is free.
    pub fn felt_nm(&self) -> f64 {
        self.felt_nm
    }

    /// Mean torque of the motor at the joint in the last tick, N·m; positive
    /// opposes growing angle.
    pub fn motor_nm(&self) -> f64 {
        self.motor_nm
    }

    /// The energy balance since the start.
    pub fn balance(&self) -> EnergyBalance {
        self.plant.balance()
    }
}

/// Faults, which can be set and cleared at any time.
impl Leg {
    /// Rewires the encoder.
    pub fn set_encoder_wiring(&mut self, wiring: EncoderWiring) {
        self.counter.wiring = wiring;
    }

    /// Breaks or repairs one of the two shunts with its amplifier.
    pub fn set_current_sensor(&mut self, path: CurrentPath, sensor: CurrentSensor) {
        self.current_sensors[path as usize] = sensor;
    }

    /// The sensors of what changes slowly, to break them.
    pub fn slow_sensors_mut(&mut self) -> &mut SlowSensors {
        &mut self.slow_sensors
    }

    /// Present faults of the coil.
    pub fn coil_faults(&self) -> &CoilFaults {
        &self.coil.faults
    }

    /// Breaks or repairs the coil, its driver or its sensor.
    pub fn set_coil_faults(&mut self, faults: CoilFaults) {
        self.coil.faults = faults;
        self.switch();
    }

    /// Shorts a switch of the bridge, so that a current of this sense flows while
    /// it is open, or repairs it.
    pub fn set_shorted_switch(&mut self, shorted: Option<Sense>) {
        self.plant.actuator_mut().set_shorted(shorted);
        self.switch();
    }

    /// Presses or releases the hand-held stop: it opens supply and motor line. The coil's
    /// 5 V come from that supply.
    pub fn press_stop(&mut self, is_pressed: bool) {
        self.plant.actuator_mut().set_line(is_pressed);
        self.set_supply(!is_pressed);
    }

    /// Turns the motor's supply on or off. Without it the terminals are open,
    /// whatever the bridge's command; a current decays into the capacitors of
    /// the supply, which still hold its voltage.
    pub fn set_supply(&mut self, is_on: bool) {
        self.is_supplied = is_on;
        self.switch();
    }
}
