//! The two controllers, the link between them, the enable lines and a motor:
//! ticks in the order of `crepitus_virtual_device::Board`.

use crate::chain::MOST_RESTARTS;
use crate::chain::samples::{Produced, Samples};
use crate::chain::wire::Wire;
use crate::winding::{CoilWinding, Winding};
use crepitus_device::comms::{self, Comms};
use crepitus_device::drive::command::Inputs;
use crepitus_device::drive::motor::Bridge;
use crepitus_device::drive::slow_checks::SlowInput;
use crepitus_device::drive::{self, Drive};
use crepitus_device::self_test::SelfTest;
use crepitus_protocol::counters::CommsCounter;
use crepitus_protocol::management::{Identity, ResetCause, Role};
use crepitus_protocol::telemetry::BLOCK_TICKS;
use crepitus_protocol::{Revision, State, TICK_US, Values, schema};

/// Ticks of the drive in a tick of comms.
pub(super) const COMMS_TICKS: u64 = 20;

/// Sensor values, and delays.
#[derive(Clone, Copy)]
pub(super) struct Readings {
    /// Counts in a tick.
    pub(super) turn: i8,
    pub(super) has_current: bool,
    pub(super) has_tripped: bool,
    pub(super) is_late: bool,
    /// The line of the drive reads back as this.
    pub(super) line: Option<bool>,
}

impl Readings {
    /// Readings of a device that is in order.
    pub(super) const GOOD: Self = Self {
        turn: 0,
        has_current: true,
        has_tripped: false,
        is_late: false,
        line: None,
    };
}

/// Losses of the link from the drive.
#[derive(Clone, Copy)]
struct LinkLoss {
    blocks: u32,
    /// Number of lost samples as counted by comms, with the restarts of the drive that it has seen.
    samples: u32,
    restarts: u32,
}

/// The device.
pub(super) struct Device {
    pub(super) tick: u64,
    pub(super) comms: Comms,
    pub(super) drive: Drive,
    /// Each is down until this tick.
    comms_down: u64,
    drive_down: u64,
    pub(super) comms_start: u16,
    drive_start: u16,
    pub(super) down: Wire,
    pub(super) up: Wire,
    comms_line: bool,
    drive_line: bool,
    bridge: Bridge,
    winding: Winding,
    coil: CoilWinding,
    counter: u32,
    saved: Option<(Revision, Values)>,
    pub(super) samples: Samples,
    /// Losses as of the last block that has arrived; none since a restart of comms.
    loss: Option<LinkLoss>,
    pub(super) save_works: bool,
}

fn identity(role: Role, reset: ResetCause) -> Identity {
    Identity {
        role,
        schema: schema::HASH,
        reset,
        ..Identity::default()
    }
}

impl Device {
    /// Returns a device that was just switched on.
    pub(super) fn new(saved: Option<(Revision, Values)>) -> Self {
        Self {
            tick: 0,
            comms: new_comms(1, ResetCause::Power, saved),
            drive: new_drive(1, ResetCause::Power, 0),
            comms_down: 0,
            drive_down: 0,
            comms_start: 1,
            drive_start: 1,
            down: Wire::default(),
            up: Wire::default(),
            comms_line: false,
            drive_line: false,
            bridge: Bridge::Float,
            winding: Winding::default(),
            coil: CoilWinding::default(),
            counter: 0,
            saved,
            samples: Samples::default(),
            loss: None,
            save_works: true,
        }
    }

    pub(super) fn comms_runs(&self) -> bool {
        self.tick >= self.comms_down
    }

    fn drive_runs(&self) -> bool {
        self.tick >= self.drive_down
    }

    /// The drive commands a voltage; what its own line and timeouts permit.
    pub(super) fn commands_torque(&self) -> bool {
        matches!(self.bridge, Bridge::Driven(_)) && self.drive_line
    }

    /// The motor is driven: both lines are on.
    pub(super) fn is_driven(&self) -> bool {
        self.commands_torque() && self.comms_line
    }

    /// Restarts comms, which takes this many ticks.
    pub(super) fn restart_comms(&mut self, cause: ResetCause, ticks: u64) {
        self.comms_start += 1;
        self.comms = new_comms(self.comms_start, cause, self.saved);
        self.comms_down = self.tick + ticks;
        self.comms_line = false;
        self.down.sender_reset(self.tick);
        self.loss = None;
    }

    /// Restarts the drive, which takes this many ticks.
    pub(super) fn restart_drive(&mut self, cause: ResetCause, ticks: u64) {
        if self.drive_start == MOST_RESTARTS {
            return;
        }
        self.drive_start += 1;
        self.drive = new_drive(self.drive_start, cause, self.counter);
        self.drive_down = self.tick + ticks;
        self.drive_line = false;
        self.bridge = Bridge::Float;
        self.up.sender_reset(self.tick);
    }

    /// One tick. Returns whether comms has restarted by itself.
    pub(super) fn tick(&mut self, readings: Readings) -> bool {
        let drive_runs = self.drive_runs();
        if drive_runs {
            self.drive_tick(readings);
        }
        let bridge = if self.is_driven() {
            self.bridge
        } else {
            Bridge::Float
        };
        self.winding.tick(bridge, readings.turn);
        self.carry();
        let mut has_restarted = false;
        if self.tick.is_multiple_of(COMMS_TICKS) && self.comms_runs() {
            has_restarted = self.comms_tick();
        }
        if drive_runs {
            self.drive.prepare();
            if self.drive.take_reboot() {
                self.restart_drive(ResetCause::Requested, COMMS_TICKS);
            }
        }
        self.tick += 1;
        has_restarted
    }

    fn drive_tick(&mut self, readings: Readings) {
        self.counter = self.counter.wrapping_add_signed(readings.turn.into());
        // Ticks begin with the first result.
        if !readings.is_late || self.drive.rendered().is_none() {
            self.drive.sample_encoder(self.counter);
            self.drive.render_torque();
        }
        let current_a = self.winding.current_a();
        let outputs = self.drive.command_motor(&Inputs {
            current_a: readings.has_current.then_some(current_a),
            monitor_a: readings.has_current.then_some(current_a),
            interval_us: TICK_US,
            enable_is_on: readings.line.unwrap_or(self.drive_line),
            comms_enable_is_on: self.comms_line,
            has_tripped: readings.has_tripped,
            slow: SlowInput::in_turn(self.tick, 24.0, 25.0, 0.0),
            coil_a: readings.has_current.then_some(self.coil.current_a()),
            coil_has_tripped: readings.has_tripped,
        });
        self.coil.tick(outputs.coil);
        (self.drive_line, self.bridge) = (outputs.enable, outputs.bridge);
        let is_driven = matches!(outputs.bridge, Bridge::Driven(_));
        let is_energised = self.drive.state() == State::Armed && is_driven;
        let [start, _] = self.drive_start.to_le_bytes();
        self.samples.produced(
            start,
            Produced {
                rendered: self.drive.rendered().unwrap_or_default(),
                is_energised,
                has_current: readings.has_current,
            },
        );
    }

    /// Transfers frames over the link.
    fn carry(&mut self) {
        let now = self.tick;
        if self.comms_runs()
            && self.down.has_room(now)
            && let Some(frame) = self.comms.link_to_send()
        {
            self.down.send(frame, now);
        }
        while let Some(arrival) = self.down.receive(now) {
            if self.drive_runs() {
                for byte in &arrival.frame {
                    self.drive.link_received(*byte);
                }
            }
        }
        if self.drive_runs()
            && let Some(frame) = self.drive.link_to_send(self.up.has_room(now))
        {
            self.up.send(frame, now);
        }
        while let Some(arrival) = self.up.receive(now) {
            if self.comms_runs() {
                for byte in &arrival.frame {
                    self.comms.link_received(*byte);
                }
                if let Some(lost_before) = arrival.lost_before {
                    self.block_received(lost_before);
                }
            }
        }
    }

    /// Comms counts the samples that the link has lost between the blocks that
    /// have arrived since the last restart of either controller.
    fn block_received(&mut self, lost_before: u32) {
        let counters = self.comms.counters();
        let now = LinkLoss {
            blocks: lost_before,
            samples: counters.get(CommsCounter::LostSamples),
            restarts: counters.get(CommsCounter::DriveRestarts),
        };
        let before = self.loss.filter(|loss| loss.restarts == now.restarts);
        if let Some(before) = before {
            let blocks = now.blocks - before.blocks;
            assert_eq!(now.samples - before.samples, blocks * BLOCK_TICKS);
        }
        self.loss = Some(now);
    }

    fn comms_tick(&mut self) -> bool {
        let outputs = self.comms.tick(&comms::Inputs {
            enable_is_on: self.comms_line,
        });
        self.comms_line = outputs.enable;
        if let Some(parameters) = outputs.save {
            if self.save_works {
                self.saved = Some(parameters);
            }
            self.comms.saved(self.save_works);
        }
        if outputs.reboot {
            self.restart_comms(ResetCause::Requested, COMMS_TICKS);
        }
        outputs.reboot
    }
}

fn new_comms(start: u16, reset: ResetCause, saved: Option<(Revision, Values)>) -> Comms {
    Comms::new(&comms::Boot {
        self_test: SelfTest::default(),
        identity: identity(Role::Comms, reset),
        start,
        entropy: start.into(),
        saved,
        counters: 0,
        crash: None,
    })
}

fn new_drive(start: u16, reset: ResetCause, counter: u32) -> Drive {
    let boot = drive::Boot {
        self_test: SelfTest::default(),
        identity: identity(Role::Drive, reset),
        start,
        counter,
        ..drive::Boot::default()
    };
    Drive::new(&boot).expect("the defaults are allowed")
}
