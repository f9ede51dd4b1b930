//! A simulated board with its builder, who does what the rows say, and with one fault of its wiring.

use super::rows::Check;
use crate::failure::Failure;
use clap::ValueEnum;
use crepitus_client::connection::Simulated;
use crepitus_protocol::management::ResetCause;
use crepitus_scene::{Overrides, shipped};
use crepitus_virtual_device::board::{Board, Controller};
use crepitus_virtual_device::faults::Faults;
use crepitus_virtual_device::leg::{CurrentPath, CurrentSensor, EncoderWiring};
use crepitus_virtual_device::usb::cabled::CabledDevice;
use crepitus_virtual_device::usb::host::CdcHost;
use crepitus_virtual_device::usb::usbip::{Event, Server};
use crepitus_virtual_device::{Start, VirtualDevice};
use std::error::Error;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Scene of the board's leg: a weight on a free arm.
const SCENE: &str = "weight-on-the-arm";

/// A fault of the wiring.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Fault {
    /// The wire from the drive to comms is cut.
    LinkCut,
    /// The link is not twisted with its ground.
    LinkNoisy,
    /// The encoder's plug is out.
    EncoderUnplugged,
    /// The wire of a read-back is cut.
    ReadBackCut,
    /// An amplifier rests at another voltage.
    AmplifierOffset,
    /// The supply's divider has a wrong resistor.
    DividerWrong,
    /// The temperature sensor's wire is cut.
    SensorUnplugged,
    /// The break line does not reach the timer.
    BreakCut,
    /// The stop is bridged.
    StopBridged,
    /// The motor's wires are swapped, when it is connected for row 20.
    MotorSwapped,
    /// The watchdog is frozen by the debugger's settings.
    WatchdogFrozen,
    /// A stop of the brace is far within the range.
    StopsNarrow,
}

/// Time from the builder's readiness to his or her action, ticks: 0.2 s.
const REACTS: u64 = 4_000;

/// Time of the way there of a hand, ticks: 1.5 s.
const WAY: u32 = 30_000;

/// Time in which a watchdog resets a controller that hangs, ticks.
const BITES: u64 = 500;

/// Acts of the builder.
#[derive(Clone, Copy, Debug, Default)]
struct Work {
    /// The row; none between two.
    row: Option<Check>,
    /// Rows that have begun or ended.
    changes: u32,
    /// The program has said that it is time.
    acts: bool,
}

/// The builder, as the program sees him or her.
#[derive(Clone, Debug, Default)]
pub(super) struct Builder(Arc<Mutex<Work>>);

impl Builder {
    fn work(&self) -> MutexGuard<'_, Work> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A row begins.
    pub(super) fn begin(&self, row: Check) {
        self.turn_to(Some(row));
    }

    /// It is time to act.
    pub(super) fn act(&self) {
        self.work().acts = true;
    }

    /// The row is over.
    pub(super) fn end(&self) {
        self.turn_to(None);
    }

    fn turn_to(&self, row: Option<Check>) {
        let mut work = self.work();
        *work = Work {
            row,
            changes: work.changes.wrapping_add(1),
            acts: false,
        };
    }
}

/// The board.
struct Bench {
    device: VirtualDevice,
    builder: Builder,
    fault: Option<Fault>,
    /// The row that was seen last.
    seen: Work,
    /// Tick at which the builder acted.
    acted: Option<u64>,
    /// Angle at which the hand took the leg, rad.
    rest_rad: f64,
}

/// The simulated board, and its builder.
pub(super) fn bench(fault: Option<Fault>) -> Result<(Simulated, Builder), Failure> {
    let scene = shipped::scene(Path::new(SCENE), &Overrides::default()).map_err(Failure::input)?;
    let device = VirtualDevice::of(&scene, &Start::default()).map_err(Failure::input)?;
    let builder = Builder::default();
    let mut bench = Bench {
        device,
        builder: builder.clone(),
        fault,
        seen: Work::default(),
        acted: None,
        rest_rad: 0.0,
    };
    bench.plant();
    Ok((Simulated::cabled(Box::new(bench)), builder))
}

impl Bench {
    fn has(&self, fault: Fault) -> bool {
        self.fault == Some(fault)
    }

    /// Plants the fault, where it is one from the start on.
    fn plant(&mut self) {
        let noisy = Faults {
            corruption: 0.05,
            ..Faults::default()
        };
        let cut = Faults {
            is_cut: true,
            ..Faults::default()
        };
        let fault = self.fault;
        let board = self.device.board_mut();
        match fault {
            Some(Fault::LinkCut) => board.up().injector.faults = cut,
            Some(Fault::LinkNoisy) => board.up().injector.faults = noisy,
            Some(Fault::EncoderUnplugged) => {
                board.leg_mut().set_encoder_wiring(EncoderWiring::Unplugged);
            }
            Some(Fault::ReadBackCut) => board.set_stuck(Controller::Drive, Some(false)),
            Some(Fault::AmplifierOffset) => board
                .leg_mut()
                .set_current_sensor(CurrentPath::Sensor, CurrentSensor::Offset(0.05)),
            Some(Fault::DividerWrong) => board.leg_mut().slow_sensors_mut().supply_v = Some(21.0),
            Some(Fault::SensorUnplugged) => board.leg_mut().slow_sensors_mut().motor_c = -50.0,
            Some(Fault::BreakCut) => board.set_trip(false),
            Some(
                Fault::StopBridged
                | Fault::MotorSwapped
                | Fault::WatchdogFrozen
                | Fault::StopsNarrow,
            )
            | None => {}
        }
    }

    /// Acts of the builder in a tick.
    fn work(&mut self) {
        let work = *self.builder.work();
        if work.changes != self.seen.changes {
            if let Some(before) = self.seen.row {
                self.put_back(before);
            }
            (self.seen, self.acted) = (work, None);
        }
        let Some(row) = work.row else { return };
        let now = self.device.board().now();
        // A dummy load instead of a motor turns nothing: here a hand holds the leg.
        let is_loaded = matches!(row, Check::Lines | Check::Break | Check::Stop);
        let hand = self.device.board().leg().hand();
        if is_loaded && hand.hand_rad().is_none() {
            hand.aim(hand.shaft_rad());
        }
        if row == Check::Polarity && self.has(Fault::MotorSwapped) {
            // Against each other is all that the device can tell.
            let leg = self.device.board_mut().leg_mut();
            leg.set_encoder_wiring(EncoderWiring::Swapped);
        }
        if !work.acts {
            return;
        }
        if self.acted.is_none() {
            self.rest_rad = hand.shaft_rad();
        }
        let since = now - *self.acted.get_or_insert(now);
        let (has_reacted, is_there) = (since == REACTS, since == REACTS + u64::from(WAY));
        match row {
            Check::Encoder if has_reacted => hand.aim(self.rest_rad + 0.8),
            Check::Encoder if is_there => hand.aim(self.rest_rad),
            Check::Limits if since >= REACTS => {
                let most = if self.has(Fault::StopsNarrow) {
                    1.0
                } else {
                    2.5
                };
                hand.aim(self.rest_rad + most * share(since - REACTS));
            }
            Check::Heat if !self.has(Fault::SensorUnplugged) => {
                let board = self.device.board_mut();
                board.leg_mut().slow_sensors_mut().motor_c = 25.0 + 6.0 * share(since);
            }
            Check::Break if has_reacted => self.device.board_mut().pull_break(true),
            Check::Stop if has_reacted && !self.has(Fault::StopBridged) => {
                self.device.board_mut().leg_mut().press_stop(true);
            }
            Check::Watchdog if has_reacted => self.device.board_mut().hang(Controller::Drive),
            Check::Watchdog if since == REACTS + BITES && !self.has(Fault::WatchdogFrozen) => {
                let board = self.device.board_mut();
                board.reset(Controller::Drive, ResetCause::Watchdog);
            }
            _ => {}
        }
    }

    /// Puts back what the row has changed.
    fn put_back(&mut self, row: Check) {
        let is_frozen = self.has(Fault::WatchdogFrozen);
        let board: &mut Board = self.device.board_mut();
        board.leg().hand().release();
        match row {
            Check::Break => board.pull_break(false),
            Check::Stop => board.leg_mut().press_stop(false),
            Check::Watchdog if is_frozen => board.reset(Controller::Drive, ResetCause::Power),
            _ => {}
        }
    }
}

/// Share of the way.
fn share(since: u64) -> f64 {
    let ticks = u32::try_from(since).unwrap_or(WAY).min(WAY);
    f64::from(ticks) / f64::from(WAY)
}

impl CabledDevice for Bench {
    fn tick(&mut self) {
        self.device.tick();
        self.work();
    }

    fn now(&self) -> u64 {
        CabledDevice::now(&self.device)
    }

    fn plug_in(&mut self) -> Result<(), Box<dyn Error + Send + Sync>> {
        CabledDevice::plug_in(&mut self.device)
    }

    fn host(&mut self) -> Option<&mut CdcHost> {
        CabledDevice::host(&mut self.device)
    }

    fn serve(&mut self, server: &mut Server) -> Vec<Event> {
        self.device.serve(server)
    }
}
