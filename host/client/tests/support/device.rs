//! Both controllers, joined.

use super::noise::Noise;
use crepitus_device::drive::motor::Bridge;
use crepitus_device::drive::slow_checks::SlowInput;
use crepitus_device::self_test::SelfTest;
use crepitus_device::usb_port::HostBytes;
use crepitus_device::{Comms, Drive, comms, drive};
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_protocol::management::{Identity, ResetCause, Role};
use crepitus_protocol::{Revision, TICK_S, TICK_US, Values, schema};
use std::collections::VecDeque;

/// Motor of the device: R, Ω; L, H; N·m/A at the joint.
const RESISTANCE_OHM: f64 = 1.23;
const INDUCTANCE_H: f64 = 0.34e-3;
const CONSTANT: f64 = 0.0389 * 86.0;

/// A device.
#[derive(Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a wire")]
pub struct Device {
    pub comms: Comms,
    pub drive: Drive,
    /// Disturbance of the bytes to and from the host.
    pub to_host: Noise,
    pub from_host: Noise,
    /// Bytes that wait for a host at most.
    pub room: usize,
    /// The wire between the controllers.
    pub link_is_cut: bool,
    /// Angle of the shaft, rad, after so many seconds.
    pub shaft: fn(f64) -> f64,
    /// Identities as the next start shows them.
    pub comms_identity: Identity,
    pub drive_identity: Identity,
    pub is_plugged: bool,
    saved: Option<(Revision, Values)>,
    starts: (u16, u16),
    comms_line: bool,
    drive_line: bool,
    bridge: Bridge,
    current_a: f64,
    ticks: u64,
    hosts: Vec<VecDeque<u8>>,
}

fn identity(role: Role) -> Identity {
    Identity {
        role,
        version: [0, 1, 0],
        schema: schema::HASH,
        serial: *b"bench-device",
        image: 0,
        reset: ResetCause::Power,
    }
}

impl Device {
    pub fn new() -> Self {
        let mut device = Self {
            comms: Comms::new(&comms::Boot::default()),
            drive: Drive::new(&drive::Boot::default()).unwrap(),
            to_host: Noise::default(),
            from_host: Noise::default(),
            room: usize::MAX,
            link_is_cut: false,
            shaft: |_| 0.0,
            comms_identity: identity(Role::Comms),
            drive_identity: identity(Role::Drive),
            is_plugged: true,
            saved: None,
            starts: (u16::MAX - 1, u16::MAX - 1),
            comms_line: false,
            drive_line: false,
            bridge: Bridge::Float,
            current_a: 0.0,
            ticks: 0,
            hosts: Vec::new(),
        };
        device.start_comms(ResetCause::Power);
        device.start_drive(ResetCause::Power);
        device
    }

    /// Comms restarts. Its enable line falls; the host's line stays, as that of a
    /// bridge between USB and UART would.
    pub fn start_comms(&mut self, reset: ResetCause) {
        self.starts.0 = self.starts.0.wrapping_add(1);
        self.comms_identity.reset = reset;
        self.comms_line = false;
        self.comms = Comms::new(&comms::Boot {
            self_test: SelfTest::default(),
            identity: self.comms_identity,
            start: self.starts.0,
            entropy: u64::from(self.starts.0),
            saved: self.saved,
            counters: 0,
            crash: None,
        });
    }

    /// The drive restarts.
    pub fn start_drive(&mut self, reset: ResetCause) {
        self.starts.1 = self.starts.1.wrapping_add(1);
        self.drive_identity.reset = reset;
        (self.drive_line, self.bridge) = (false, Bridge::Float);
        self.drive = Drive::new(&drive::Boot {
            self_test: SelfTest::default(),
            identity: self.drive_identity,
            counter: self.counter(),
            start: self.starts.1,
            tick: 0,
            sequence: 0,
            crash: None,
        })
        .unwrap();
    }

    /// The cable to the hosts is pulled out.
    pub fn unplug(&mut self) {
        self.is_plugged = false;
        self.comms.host_lost();
        self.hosts.iter_mut().for_each(VecDeque::clear);
    }

    /// Adds a host; returns its index.
    pub fn add_host(&mut self) -> usize {
        self.hosts.push(VecDeque::new());
        self.hosts.len() - 1
    }

    /// Bytes that wait for a host.
    pub fn waiting(&mut self, host: usize) -> &mut VecDeque<u8> {
        &mut self.hosts[host]
    }

    /// Bytes of a host.
    pub fn hear(&mut self, bytes: &[u8]) {
        let bytes = self.from_host.pass(bytes);
        for packet in bytes.chunks(64) {
            self.comms.received(packet);
        }
    }

    /// Milliseconds since the device was switched on.
    pub fn now_ms(&self) -> u64 {
        self.ticks / 20
    }

    /// Torque of the motor now, N·m, positive towards growing angle.
    pub fn torque_nm(&self) -> f64 {
        self.current_a * CONSTANT
    }

    /// One millisecond.
    pub fn millisecond(&mut self) {
        let outputs = self.comms.tick(&comms::Inputs {
            enable_is_on: self.comms_line,
        });
        self.comms_line = outputs.enable;
        if let Some(save) = outputs.save {
            self.saved = Some(save);
            self.comms.saved(true);
        }
        for _ in 0..20 {
            self.tick();
        }
        self.send_to_hosts();
        if outputs.reboot {
            self.start_comms(ResetCause::Requested);
        }
        if self.drive.take_reboot() {
            self.start_drive(ResetCause::Requested);
        }
    }

    fn time_s(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a test is short")]
        let ticks = self.ticks as f64;
        ticks * TICK_S
    }

    fn counter(&self) -> u32 {
        let counts = (self.shaft)(self.time_s()) / EncoderSettings::default().rad_per_count();
        #[expect(clippy::cast_possible_truncation, reason = "a test is short")]
        let counts = counts.floor() as i32;
        counts.cast_unsigned()
    }

    fn tick(&mut self) {
        self.drive.sample_encoder(self.counter());
        self.drive.render_torque();
        #[expect(clippy::cast_possible_truncation, reason = "rounded to f32")]
        let current_a = self.current_a as f32;
        let outputs = self.drive.command_motor(&drive::command::Inputs {
            current_a: Some(current_a),
            monitor_a: Some(current_a),
            interval_us: TICK_US,
            enable_is_on: self.drive_line,
            comms_enable_is_on: self.comms_line,
            has_tripped: false,
            slow: SlowInput::in_turn(self.drive.next_tick(), 24.0, 25.0, 0.0),
            // No actuator is connected.
            coil_a: Some(0.0),
            coil_has_tripped: false,
        });
        self.drive.prepare();
        self.drive_line = outputs.enable;
        self.bridge = outputs.bridge;
        self.flow();
        self.ticks += 1;
        self.link();
    }

    /// The winding over one tick.
    fn flow(&mut self) {
        let omega = ((self.shaft)(self.time_s() + TICK_S) - (self.shaft)(self.time_s())) / TICK_S;
        self.current_a = match self.bridge {
            Bridge::Driven(volts) if self.comms_line && self.drive_line => {
                let target = (f64::from(volts) - CONSTANT * omega) / RESISTANCE_OHM;
                target + (self.current_a - target) * (-RESISTANCE_OHM / INDUCTANCE_H * TICK_S).exp()
            }
            _ => 0.0,
        };
    }

    fn link(&mut self) {
        if let Some(frame) = self.drive.link_to_send(true) {
            for byte in frame {
                if !self.link_is_cut {
                    self.comms.link_received(byte);
                }
            }
        }
        while let Some(frame) = self.comms.link_to_send() {
            for byte in frame {
                if !self.link_is_cut {
                    self.drive.link_received(byte);
                }
            }
        }
    }

    fn send_to_hosts(&mut self) {
        while self.is_plugged && self.hosts.iter().all(|host| host.len() < self.room) {
            let run = self.comms.to_send();
            let count = run.len().min(64);
            if count == 0 {
                return;
            }
            let packet = self.to_host.pass(&run[..count]);
            self.comms.sent(count);
            for host in &mut self.hosts {
                host.extend(&packet);
            }
        }
    }
}
