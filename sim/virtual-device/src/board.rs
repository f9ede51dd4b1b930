//! The two controllers, the link between them, and the leg.
//!
//! ```text
//!  tick n          counter      current             PWM loads
//!    ├────────────────┼────────────┼───────────────────┤
//!  drive          sample, render   command         next tick
//!  wires          21 bytes each way
//!  comms          every 20th tick
//! ```

mod breakage;
mod outputs;
mod starts;

use crate::leg::{CurrentPath, Leg, Terminals};
use crate::storage::Storage;
use crate::wire::Wire;
use crepitus_device::comms::{self, Comms};
use crepitus_device::drive::coil::CoilOutput;
use crepitus_device::drive::command::Inputs;
use crepitus_device::drive::motor::Bridge;
use crepitus_device::drive::slow_checks::SlowInput;
use crepitus_device::drive::{self, Drive};
use crepitus_device::self_test::SelfTest;
use crepitus_protocol::crash::Head;
use crepitus_protocol::management::{ResetCause, Role};
use crepitus_protocol::{DeviceSettings, Revision, TICK_US, ValueError, Values, schema};
use crepitus_scene::Scene;
use starts::identity;

/// Ticks of the drive in a tick of comms.
const COMMS_TICKS: u64 = 20;

/// Start-up time of a controller, ticks.
const START_TICKS: u64 = 200;

/// An enable line: its driver and its fault.
#[derive(Clone, Copy, Debug, Default)]
struct EnableLine {
    driven: bool,
    /// Read-back: a tick later.
    read: bool,
    /// Stuck at this level.
    stuck: Option<bool>,
    /// The line's gate lets everything pass.
    gate_is_stuck: bool,
}

impl EnableLine {
    fn is_on(self) -> bool {
        self.stuck.unwrap_or(self.driven)
    }

    /// Returns whether the gate passes what the timer puts out.
    fn passes(self) -> bool {
        self.is_on() || self.gate_is_stuck
    }
}

/// A controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Controller {
    /// The drive.
    Drive,
    /// Comms.
    Comms,
}

/// State of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Health {
    Runs,
    /// The controller hangs; its pins stay as they are.
    Hangs,
    /// The controller starts at this tick; its pins are pulled down.
    StartsAt(u64, ResetCause),
}

/// Initial state of a board.
#[derive(Clone, Copy, Debug, Default)]
pub struct Start {
    /// Seed of the link's faults.
    pub seed: u64,
    /// Parameters stored by comms.
    pub saved: Option<(Revision, Values)>,
    /// The drive's first tick, and number of its first block.
    pub tick: u64,
    /// Number of the drive's first block.
    pub sequence: u16,
    /// Initial count of the encoder.
    pub count: i32,
    /// Initial value of comms' counters.
    pub counters: u32,
    /// Number of times that both controllers have been started before.
    pub starts: u16,
}

/// The two controllers with a leg.
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a part that works or not"
)]
pub struct Board {
    drive: Drive,
    comms: Comms,
    leg: Leg,
    /// Revision of the knee that the leg's examiner knows.
    examined: Option<Revision>,
    /// Comms to drive.
    down: Wire,
    /// Drive to comms.
    up: Wire,
    drive_line: EnableLine,
    comms_line: EnableLine,
    drive_health: Health,
    comms_health: Health,
    /// Start counter of each.
    starts: [u16; 2],
    /// Their post-mortem records.
    drive_crash: Option<drive::Crash>,
    comms_crash: Option<Head>,
    /// Last command to the bridge.
    bridge: Bridge,
    /// Last command to the coil.
    coil: CoilOutput,
    /// The coil's driver has opened it, until the drive lets it sleep.
    coil_tripped: bool,
    /// The converter of the coil's current works.
    converts_coil: bool,
    /// Parameters that comms stores over a restart.
    storage: Storage,
    comms_has_restarted: bool,
    /// The comparator behind the monitor's amplifier works.
    trips: bool,
    /// The break line is pulled low from outside.
    break_is_low: bool,
    /// The comparator has opened the bridge, until the drive floats it.
    comparator_tripped: bool,
    /// The drive's converters work: that of the sensor, and of the monitor.
    converts: [bool; 2],
    /// The drive's converter of the inputs that change slowly works.
    converts_slow: bool,
    /// Runs of `render_torque` in a tick: one, if its timer is right.
    renderings: u32,
    /// The drive's crystal has 12 MHz instead of 8.
    drive_is_fast: bool,
    /// The wire by which the drive reads the line of comms is whole.
    comms_line_reaches_drive: bool,
    /// Length of a tick of the drive, by its other timer, µs.
    interval_us: u32,
    /// Schema hash of the drive's program, from its next start on.
    drive_schema: u64,
    tick: u64,
}

impl Board {
    /// The board of a scene's leg, just switched on.
    ///
    /// # Errors
    /// [`ValueError`] if the defaults of the device are invalid: a mistake in
    /// their table, which a test would have found.
    pub fn new(scene: &Scene, start: &Start) -> Result<Self, ValueError> {
        let mut leg = Leg::new(scene);
        leg.preset_count(start.count);
        let drive = Drive::new(&drive::Boot {
            self_test: SelfTest::default(),
            identity: identity(Role::Drive, ResetCause::Power),
            start: start.starts.wrapping_add(1),
            counter: start.count.cast_unsigned(),
            tick: start.tick,
            sequence: start.sequence,
            crash: None,
        })?;
        let comms = Comms::new(&comms::Boot {
            self_test: SelfTest::default(),
            identity: identity(Role::Comms, ResetCause::Power),
            start: start.starts.wrapping_add(1),
            entropy: start.seed,
            saved: start.saved,
            counters: start.counters,
            crash: None,
        });
        Ok(Self {
            drive,
            comms,
            leg,
            examined: None,
            down: Wire::new(start.seed),
            up: Wire::new(start.seed ^ 0x9e37_79b9_7f4a_7c15),
            drive_line: EnableLine::default(),
            comms_line: EnableLine::default(),
            drive_health: Health::Runs,
            comms_health: Health::Runs,
            starts: [start.starts.wrapping_add(2); 2],
            drive_crash: None,
            comms_crash: None,
            bridge: Bridge::Float,
            coil: CoilOutput::Asleep,
            coil_tripped: false,
            converts_coil: true,
            storage: Storage::new(start.saved),
            comms_has_restarted: false,
            trips: true,
            break_is_low: false,
            comparator_tripped: false,
            converts: [true; 2],
            converts_slow: true,
            renderings: 1,
            drive_is_fast: false,
            comms_line_reaches_drive: true,
            interval_us: TICK_US,
            drive_schema: schema::HASH,
            tick: 0,
        })
    }

    /// One tick of 50 µs.
    pub fn tick(&mut self) {
        self.start_due_controllers();
        if self.drive_is_fast && self.tick.is_multiple_of(2) {
            self.extra_drive_tick();
        }
        let drive_runs = self.drive_health == Health::Runs;
        if drive_runs {
            self.render();
        }
        self.leg.first_half();
        self.check_comparator();
        if drive_runs {
            self.command();
        }
        self.leg.second_half();
        self.check_comparator();
        self.switch();
        self.drive_line.read = self.drive_line.is_on();
        self.carry();
        if self.tick.is_multiple_of(COMMS_TICKS) && self.comms_health == Health::Runs {
            self.comms_millisecond();
        }
        if drive_runs {
            self.drive.prepare();
            if self.drive.take_reboot() {
                self.reset(Controller::Drive, ResetCause::Requested);
            }
        }
        self.tell_examiner();
        self.tick += 1;
    }

    /// Tells the leg's examiner which knee the drive renders, once it has changed.
    fn tell_examiner(&mut self) {
        let revision = self.drive.revision();
        if self.examined == Some(revision) {
            return;
        }
        if let Some(Ok(settings)) = self.drive.values().map(DeviceSettings::of) {
            self.examined = Some(revision);
            self.leg
                .examine(&settings.effects, settings.crepitus.is_some());
        }
    }

    fn command(&mut self) {
        let outputs = self.drive.command_motor(&Inputs {
            current_a: self.converted(CurrentPath::Sensor),
            monitor_a: self.converted(CurrentPath::Monitor),
            interval_us: self.interval_us,
            enable_is_on: self.drive_line.read,
            comms_enable_is_on: self.comms_line_reaches_drive && self.comms_line.is_on(),
            has_tripped: self.comparator_tripped,
            slow: self.slow(),
            coil_a: self.converted_coil(),
            coil_has_tripped: self.coil_tripped,
        });
        self.execute(outputs);
    }

    /// A tick of a drive whose crystal is too fast.
    fn extra_drive_tick(&mut self) {
        if self.drive_health == Health::Runs && self.renderings > 0 {
            self.render();
            self.command();
        }
    }

    fn render(&mut self) {
        for _ in 0..self.renderings {
            self.drive.sample_encoder(self.leg.count().cast_unsigned());
            self.drive.render_torque();
        }
    }

    fn slow(&self) -> SlowInput {
        if !self.converts_slow {
            return SlowInput::None;
        }
        let slow = self.leg.slow_sensors();
        let (supply_v, joint) = (self.leg.measured_supply_v(), self.leg.joint_turns());
        SlowInput::in_turn(
            self.tick,
            single(supply_v),
            single(slow.motor_c),
            single(joint),
        )
    }

    fn converted(&self, path: CurrentPath) -> Option<f32> {
        self.converts[path as usize].then(|| single(self.leg.current_a(path)))
    }

    /// The coil's current while it is driven, as the image reads it.
    fn converted_coil(&self) -> Option<f32> {
        let is_read = self.converts_coil && self.coil != CoilOutput::Asleep;
        is_read.then(|| single(self.leg.coil_a()))
    }

    /// Transfers bytes over the link.
    fn carry(&mut self) {
        let Self {
            drive,
            comms,
            down,
            up,
            ..
        } = self;
        let drive_runs = self.drive_health == Health::Runs;
        let comms_runs = self.comms_health == Health::Runs;
        down.tick(
            self.tick,
            |has_buffer| {
                (comms_runs && has_buffer)
                    .then(|| comms.link_to_send())
                    .flatten()
            },
            |byte| {
                if drive_runs {
                    drive.link_received(byte);
                }
            },
        );
        up.tick(
            self.tick,
            |has_buffer| drive_runs.then(|| drive.link_to_send(has_buffer)).flatten(),
            |byte| {
                if comms_runs {
                    comms.link_received(byte);
                }
            },
        );
    }

    fn comms_millisecond(&mut self) {
        let outputs = self.comms.tick(&comms::Inputs {
            enable_is_on: self.comms_line.read,
        });
        self.comms_line.driven = outputs.enable;
        self.comms_line.read = self.comms_line.is_on();
        if let Some(parameters) = outputs.save {
            let is_stored = self.storage.store(parameters);
            self.comms.saved(is_stored);
        }
        if outputs.reboot {
            self.reset(Controller::Comms, ResetCause::Requested);
        }
        // When comms disables its line, that is immediate.
        if !self.comms_line.passes() {
            self.leg.set_terminals(Terminals::Open);
        }
        if !self.comms_line.is_on() {
            self.leg.set_coil(None);
        }
    }

    /// Ticks since the board was switched on.
    pub fn now(&self) -> u64 {
        self.tick
    }

    /// The drive.
    pub fn drive(&self) -> &Drive {
        &self.drive
    }

    /// Comms.
    pub fn comms(&self) -> &Comms {
        &self.comms
    }

    /// Comms, for what comes and goes by USB.
    pub fn comms_mut(&mut self) -> &mut Comms {
        &mut self.comms
    }

    /// The leg.
    pub fn leg(&self) -> &Leg {
        &self.leg
    }

    /// The leg, to break its sensors and its supply.
    pub fn leg_mut(&mut self) -> &mut Leg {
        &mut self.leg
    }

    /// The wire from comms to the drive.
    pub fn down(&mut self) -> &mut Wire {
        &mut self.down
    }

    /// The wire from the drive to comms.
    pub fn up(&mut self) -> &mut Wire {
        &mut self.up
    }

    /// Returns whether the motor is driven: commanded, and enabled by both lines and
    /// the comparator.
    pub fn is_driven(&self) -> bool {
        matches!(self.bridge, Bridge::Driven(_))
            && !self.comparator_tripped
            && self.drive_line.passes()
            && self.comms_line.passes()
    }

    /// Returns whether the coil of the vibration actuator is driven: commanded, and enabled by
    /// both lines, its driver and its supply.
    pub fn coil_is_driven(&self) -> bool {
        self.leg.coil_v().is_some()
    }

    /// Returns whether the drive commands the coil to be driven, whatever the lines let through.
    pub fn coil_is_commanded(&self) -> bool {
        self.coil != CoilOutput::Asleep
    }

    /// Level of the enable line of a controller at its gate: true for on.
    pub fn line_is_on(&self, controller: Controller) -> bool {
        match controller {
            Controller::Drive => self.drive_line.is_on(),
            Controller::Comms => self.comms_line.is_on(),
        }
    }

    /// Returns whether comms runs.
    pub fn comms_runs(&self) -> bool {
        self.comms_health == Health::Runs
    }

    /// Returns whether comms has restarted since the last call: its USB device has been
    /// replaced by a new one.
    pub fn take_comms_restart(&mut self) -> bool {
        std::mem::take(&mut self.comms_has_restarted)
    }
}

#[expect(clippy::cast_possible_truncation, reason = "what a converter shows")]
fn single(value: f64) -> f32 {
    value as f32
}
