//! The two controllers, the link between them, and the leg.
//!
//! ```text
//!  tick n          counter      current             PWM loads
//!    ├────────────────┼────────────┼───────────────────┤
//!  drive          sample, render   command         next tick
//!  wires          21 bytes each way
//!  comms          every 20th tick
//! ```

use crate::leg::{Leg, Terminals};
use crate::wire::Wire;
use crepitus_device::comms::{self, Comms};
use crepitus_device::drive::command::{Inputs, Outputs};
use crepitus_device::drive::motor::Bridge;
use crepitus_device::drive::plausibility::TRIP_A;
use crepitus_device::drive::{self, Drive};
use crepitus_protocol::management::{Identity, ResetCause, Role};
use crepitus_protocol::{Revision, ValueError, Values, schema};
use crepitus_scene::Scene;

/// Ticks of the drive in a tick of comms.
const COMMS_TICKS: u64 = 20;

/// Ticks that a controller takes to start.
const START_TICKS: u64 = 200;

/// An enable line: what drives it, and what is broken about it.
#[derive(Clone, Copy, Debug, Default)]
struct EnableLine {
    driven: bool,
    /// As read back: a tick later.
    read: bool,
    /// It stays like this whatever drives it.
    stuck: Option<bool>,
}

impl EnableLine {
    fn is_on(self) -> bool {
        self.stuck.unwrap_or(self.driven)
    }
}

/// Which controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Controller {
    /// The drive.
    Drive,
    /// Comms.
    Comms,
}

/// What a controller is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Health {
    Runs,
    /// It does nothing any more; its pins stay as they are.
    Hangs,
    /// It starts at this tick; its pins are pulled down.
    StartsAt(u64, ResetCause),
}

/// How a board starts.
#[derive(Clone, Copy, Debug, Default)]
pub struct Start {
    /// Seed of the link's faults.
    pub seed: u64,
    /// Parameters that comms has kept.
    pub saved: Option<(Revision, Values)>,
    /// The drive's first tick, and number of its first block.
    pub tick: u64,
    /// Number of the drive's first block.
    pub sequence: u16,
    /// What the encoder's counter begins with.
    pub count: i32,
    /// What comms' counters begin with.
    pub counters: u32,
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
    /// Comms to drive.
    down: Wire,
    /// Drive to comms.
    up: Wire,
    drive_line: EnableLine,
    comms_line: EnableLine,
    drive_health: Health,
    comms_health: Health,
    /// Which start of each is the next.
    starts: [u16; 2],
    /// What the bridge was told last.
    bridge: Bridge,
    /// What comms keeps over a restart.
    kept: Option<(Revision, Values)>,
    keeps: bool,
    comms_has_restarted: bool,
    /// The comparator at the shunt works.
    trips: bool,
    /// It has let go of the bridge, until the drive does.
    is_broken: bool,
    /// The drive's converter gives currents.
    converts: bool,
    /// The drive's rendering is ready in time.
    renders: bool,
    /// Language of the drive's program, from its next start on.
    drive_schema: u64,
    tick: u64,
}

fn identity(role: Role, reset: ResetCause) -> Identity {
    let part = |text: &str| text.parse().unwrap_or(0);
    Identity {
        role,
        version: [
            part(env!("CARGO_PKG_VERSION_MAJOR")),
            part(env!("CARGO_PKG_VERSION_MINOR")),
            part(env!("CARGO_PKG_VERSION_PATCH")),
        ],
        schema: schema::HASH,
        serial: match role {
            Role::Drive => *b"SIM-DRIVE-01",
            _ => *b"SIM-COMMS-01",
        },
        image: 0,
        reset,
    }
}

impl Board {
    /// The board of a scene's leg, just switched on.
    ///
    /// # Errors
    /// [`ValueError`] if the defaults of the device are not allowed: a mistake
    /// in their table, which a test would have found.
    pub fn new(scene: &Scene, start: &Start) -> Result<Self, ValueError> {
        let mut leg = Leg::new(scene);
        leg.preset_count(start.count);
        let drive = Drive::new(&drive::Boot {
            identity: identity(Role::Drive, ResetCause::Power),
            start: 1,
            counter: start.count.cast_unsigned(),
            tick: start.tick,
            sequence: start.sequence,
        })?;
        let comms = Comms::new(&comms::Boot {
            identity: identity(Role::Comms, ResetCause::Power),
            start: 1,
            saved: start.saved,
            counters: start.counters,
        });
        Ok(Self {
            drive,
            comms,
            leg,
            down: Wire::new(start.seed),
            up: Wire::new(start.seed ^ 0x9e37_79b9_7f4a_7c15),
            drive_line: EnableLine::default(),
            comms_line: EnableLine::default(),
            drive_health: Health::Runs,
            comms_health: Health::Runs,
            starts: [2; 2],
            bridge: Bridge::Float,
            kept: start.saved,
            keeps: true,
            comms_has_restarted: false,
            trips: true,
            is_broken: false,
            converts: true,
            renders: true,
            drive_schema: schema::HASH,
            tick: 0,
        })
    }

    /// One tick of 50 µs.
    pub fn tick(&mut self) {
        self.start_who_is_due();
        let drive_runs = self.drive_health == Health::Runs;
        if drive_runs {
            self.drive.sample_encoder(self.leg.count().cast_unsigned());
            if self.renders {
                self.drive.render_torque();
            }
        }
        self.leg.first_half();
        self.watch_current();
        if drive_runs {
            let outputs = self.drive.command_motor(&Inputs {
                current_a: self.converts.then(|| single(self.leg.current_a())),
                enable_is_on: self.drive_line.read,
                is_broken: self.is_broken,
            });
            self.obey(outputs);
        }
        self.leg.second_half();
        self.watch_current();
        self.switch();
        self.drive_line.read = self.drive_line.is_on();
        self.carry();
        if self.tick.is_multiple_of(COMMS_TICKS) && self.comms_health == Health::Runs {
            self.comms_millisecond();
        }
        if drive_runs {
            self.drive.prepare();
            if self.drive.take_reboot() {
                self.reset(Controller::Drive, ResetCause::Asked);
            }
        }
        self.tick += 1;
    }

    /// The comparator at the shunt, which no program stands behind.
    fn watch_current(&mut self) {
        if self.bridge == Bridge::Float {
            self.is_broken = false;
        } else if self.trips && self.leg.winding_current_a().abs() > f64::from(TRIP_A) {
            self.is_broken = true;
            self.switch();
        }
    }

    fn obey(&mut self, outputs: Outputs) {
        self.drive_line.driven = outputs.enable;
        self.bridge = outputs.bridge;
        // Letting go is at once; a voltage loads with the next period.
        if self.bridge == Bridge::Float || !self.drive_line.is_on() {
            self.leg.set_terminals(Terminals::Open);
        }
    }

    /// The bridge, as both lines let it.
    fn switch(&mut self) {
        let terminals = match self.bridge {
            Bridge::Driven(volts) if self.is_driven() => Terminals::Driven(f64::from(volts)),
            _ => Terminals::Open,
        };
        self.leg.set_terminals(terminals);
    }

    /// What goes over the link.
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
            |has_place| {
                (comms_runs && has_place)
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
            |has_place| drive_runs.then(|| drive.link_to_send(has_place)).flatten(),
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
            if self.keeps {
                self.kept = Some(parameters);
            }
            self.comms.saved(self.keeps);
        }
        if outputs.reboot {
            self.reset(Controller::Comms, ResetCause::Asked);
        }
        // A line that comms takes away is away at once.
        if !self.comms_line.is_on() {
            self.leg.set_terminals(Terminals::Open);
        }
    }

    fn start_who_is_due(&mut self) {
        if let Health::StartsAt(tick, cause) = self.drive_health
            && tick <= self.tick
        {
            let boot = drive::Boot {
                identity: Identity {
                    schema: self.drive_schema,
                    ..identity(Role::Drive, cause)
                },
                start: self.starts[0],
                counter: self.leg.count().cast_unsigned(),
                ..drive::Boot::default()
            };
            // Its defaults were allowed at the first start.
            if let Ok(drive) = Drive::new(&boot) {
                self.drive = drive;
                self.drive_health = Health::Runs;
                self.starts[0] = self.starts[0].wrapping_add(1);
            }
        }
        if let Health::StartsAt(tick, cause) = self.comms_health
            && tick <= self.tick
        {
            self.comms = Comms::new(&comms::Boot {
                identity: identity(Role::Comms, cause),
                start: self.starts[1],
                saved: self.kept,
                counters: 0,
            });
            self.comms_health = Health::Runs;
            self.starts[1] = self.starts[1].wrapping_add(1);
            self.comms_has_restarted = true;
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

    /// Whether the motor is being driven: told to, and let by both lines and
    /// the comparator.
    pub fn is_driven(&self) -> bool {
        matches!(self.bridge, Bridge::Driven(_))
            && !self.is_broken
            && self.drive_line.is_on()
            && self.comms_line.is_on()
    }

    /// Whether comms runs.
    pub fn comms_runs(&self) -> bool {
        self.comms_health == Health::Runs
    }

    /// Whether comms has started anew since this was asked last: its USB
    /// device has gone, and a new one is there.
    pub fn take_comms_restart(&mut self) -> bool {
        std::mem::take(&mut self.comms_has_restarted)
    }
}

/// Faults of the board.
impl Board {
    /// An enable line stays like this, or is mended.
    pub fn set_stuck(&mut self, controller: Controller, stuck: Option<bool>) {
        match controller {
            Controller::Drive => self.drive_line.stuck = stuck,
            Controller::Comms => self.comms_line.stuck = stuck,
        }
        self.switch();
    }

    /// A controller hangs: its pins stay as they are.
    pub fn hang(&mut self, controller: Controller) {
        *self.health(controller) = Health::Hangs;
    }

    /// A controller is reset: its pins fall, and it starts anew.
    pub fn reset(&mut self, controller: Controller, cause: ResetCause) {
        self.reset_for(controller, cause, START_TICKS);
    }

    /// The same, of a controller that takes so many ticks to start.
    pub fn reset_for(&mut self, controller: Controller, cause: ResetCause, ticks: u64) {
        *self.health(controller) = Health::StartsAt(self.tick + ticks, cause);
        match controller {
            Controller::Drive => {
                self.drive_line.driven = false;
                self.bridge = Bridge::Float;
                self.up.sender_reset();
            }
            Controller::Comms => {
                self.comms_line.driven = false;
                self.comms_line.read = self.comms_line.is_on();
                self.down.sender_reset();
            }
        }
        self.switch();
    }

    /// Whether parameters can be kept.
    pub fn set_storage(&mut self, works: bool) {
        self.keeps = works;
    }

    /// The comparator at the shunt works, or is as blind as the sensor.
    pub fn set_trip(&mut self, works: bool) {
        self.trips = works;
    }

    /// The drive's converter works, or gives no currents any more.
    pub fn set_converter(&mut self, works: bool) {
        self.converts = works;
    }

    /// The drive's model is ready within its tick, or never.
    pub fn set_rendering(&mut self, in_time: bool) {
        self.renders = in_time;
    }

    /// From its next start on the drive's program says that it speaks this
    /// language.
    pub fn set_drive_schema(&mut self, schema: u64) {
        self.drive_schema = schema;
    }

    fn health(&mut self, controller: Controller) -> &mut Health {
        match controller {
            Controller::Drive => &mut self.drive_health,
            Controller::Comms => &mut self.comms_health,
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "what a converter shows")]
fn single(value: f64) -> f32 {
    value as f32
}
