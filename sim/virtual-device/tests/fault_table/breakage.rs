//! Parts that can be broken, and mended.

use crate::support::Host;
use crepitus_protocol::management::ResetCause;
use crepitus_virtual_device::board::Controller::{self, Comms, Drive};
use crepitus_virtual_device::leg::{CurrentPath, CurrentSensor, EncoderWiring};
use crepitus_virtual_device::{Board, Faults};

pub(crate) fn board(host: &mut Host) -> &mut Board {
    host.device.board_mut()
}

/// Applies `what` in the first tick only.
pub(crate) fn once(since: u64, host: &mut Host, what: impl FnOnce(&mut Board)) {
    if since == 0 {
        what(host.device.board_mut());
    }
}

pub(crate) fn nothing(_: &mut Host) {}

/// Faults of the wire to the drive.
pub(crate) fn break_down(host: &mut Host, faults: Faults) {
    board(host).down().injector.faults = faults;
}

pub(crate) fn mend_down(host: &mut Host) {
    break_down(host, Faults::default());
}

/// Cuts the wire to comms.
pub(crate) fn cut_up(host: &mut Host, _: u64) {
    board(host).up().injector.faults.is_cut = true;
}

pub(crate) fn mend_up(host: &mut Host) {
    board(host).up().injector.faults.is_cut = false;
}

pub(crate) fn unplug_encoder(host: &mut Host, _: u64) {
    let leg = board(host).leg_mut();
    leg.set_encoder_wiring(EncoderWiring::Unplugged);
}

pub(crate) fn swap_encoder(host: &mut Host, _: u64) {
    let leg = board(host).leg_mut();
    leg.set_encoder_wiring(EncoderWiring::Swapped);
}

pub(crate) fn mend_encoder(host: &mut Host) {
    let leg = board(host).leg_mut();
    leg.set_encoder_wiring(EncoderWiring::Right);
}

pub(crate) fn jump_count(board: &mut Board, counts: i32) {
    let count = board.leg().count();
    board.leg_mut().preset_count(count.wrapping_add(counts));
}

pub(crate) fn break_sensor(host: &mut Host, sensor: CurrentSensor) {
    break_path(host, CurrentPath::Sensor, sensor);
}

pub(crate) fn break_monitor(host: &mut Host, sensor: CurrentSensor) {
    break_path(host, CurrentPath::Monitor, sensor);
}

fn break_path(host: &mut Host, path: CurrentPath, sensor: CurrentSensor) {
    board(host).leg_mut().set_current_sensor(path, sensor);
}

pub(crate) fn mend_sensors(host: &mut Host) {
    break_sensor(host, CurrentSensor::Right);
    break_monitor(host, CurrentSensor::Right);
}

pub(crate) fn stop_converter(host: &mut Host, _: u64) {
    board(host).set_converter(CurrentPath::Sensor, false);
}

pub(crate) fn stop_monitor(host: &mut Host, _: u64) {
    board(host).set_converter(CurrentPath::Monitor, false);
}

pub(crate) fn mend_converters(host: &mut Host) {
    board(host).set_converter(CurrentPath::Sensor, true);
    board(host).set_converter(CurrentPath::Monitor, true);
}

pub(crate) fn supply_off(host: &mut Host, _: u64) {
    board(host).leg_mut().set_supply(false);
}

pub(crate) fn supply_on(host: &mut Host) {
    board(host).leg_mut().set_supply(true);
}

pub(crate) fn drive_line_on(host: &mut Host, _: u64) {
    board(host).set_stuck(Drive, Some(true));
}

pub(crate) fn drive_line_off(host: &mut Host, _: u64) {
    board(host).set_stuck(Drive, Some(false));
}

pub(crate) fn mend_drive_line(host: &mut Host) {
    board(host).set_stuck(Drive, None);
}

pub(crate) fn comms_line_on(host: &mut Host, _: u64) {
    board(host).set_stuck(Comms, Some(true));
}

pub(crate) fn comms_line_off(host: &mut Host, _: u64) {
    board(host).set_stuck(Comms, Some(false));
}

pub(crate) fn mend_comms_line(host: &mut Host) {
    board(host).set_stuck(Comms, None);
}

/// Hangs, until its watchdog bites: 10 ms.
pub(crate) fn hang_and_bite(host: &mut Host, since: u64, controller: Controller) {
    once(since, host, |board| board.hang(controller));
    if since == 200 {
        board(host).reset(controller, ResetCause::Watchdog);
    }
}

pub(crate) fn restart_comms(host: &mut Host) {
    board(host).reset(Comms, ResetCause::Requested);
}

pub(crate) fn restart_drive(host: &mut Host) {
    board(host).reset(Drive, ResetCause::Requested);
}
