//! Simulated braces with a weight in their cuffs, recorded as `crepitus record` does: the
//! drive's own code on the plant of `sim/plant`, over the virtual USB, through a file.

#![allow(dead_code, reason = "each test uses its part")]

use crate::support::{Heard, Host, scene};
use crepitus_identify::brace::{Quantity, Recording, Sample, Weight};
use crepitus_plant::effects::limb::STANDARD_GRAVITY;
use crepitus_protocol::management::Identity;
use crepitus_protocol::{DeviceSettings, TICK_S};
use crepitus_recording::{Begin, Damage, Metadata, Recorder};
use crepitus_virtual_device::Start;

/// A brace that is unknown to the estimator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth {
    pub(crate) friction_nm: f64,
    pub(crate) load_loss: f64,
    pub(crate) viscous_nms: f64,
    pub(crate) rotor_kg_m2: f64,
    pub(crate) brace_kg_m2: f64,
    pub(crate) gap_deg: f64,
    pub(crate) stiffness_nm: f64,
    pub(crate) damping_nms: f64,
    /// Torque of the motor over what the device believes.
    pub(crate) torque_scale: f64,
    pub(crate) mass_kg: f64,
    pub(crate) lever_m: f64,
    /// Angle at which the weight is let go of, from where it hangs.
    pub(crate) release_deg: f64,
    /// Errors of what a person measures, in standard deviations.
    pub(crate) weighed_wrong: f64,
    pub(crate) inertia_wrong: f64,
}

/// Deviation of a person's weighing.
pub(crate) const WEIGHED: f64 = 0.005;

/// Radius of gyration over the lever: that of Winter's leg, which the plant's weights have.
const GYRATION: f64 = 0.735 / 0.606;

impl Truth {
    /// The data sheet's.
    pub(crate) const NOMINAL: Self = Self {
        friction_nm: 0.5,
        load_loss: 0.3,
        viscous_nms: 0.1,
        rotor_kg_m2: 0.051,
        brace_kg_m2: 0.01,
        gap_deg: 1.0,
        stiffness_nm: 120.0,
        damping_nms: 1.0,
        torque_scale: 1.0,
        mass_kg: 2.5,
        lever_m: 0.25,
        release_deg: 55.0,
        weighed_wrong: 0.0,
        inertia_wrong: 0.0,
    };

    pub(crate) fn inertia_kg_m2(&self) -> f64 {
        self.mass_kg * (GYRATION * self.lever_m).powi(2)
    }

    /// Weight as a person states it.
    pub(crate) fn given(&self) -> Weight {
        let off = |deviation: f64, by: f64| 1.0 + deviation * by;
        Weight::new(
            self.mass_kg * off(WEIGHED, self.weighed_wrong),
            self.lever_m,
            Some(self.inertia_kg_m2() * off(2.0 * WEIGHED, self.inertia_wrong)),
            WEIGHED,
        )
    }

    pub(crate) fn value(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Friction => self.friction_nm,
            Quantity::LoadLoss => self.load_loss,
            Quantity::Viscous => self.viscous_nms,
            Quantity::RotorInertia => self.rotor_kg_m2,
            Quantity::BraceInertia => self.brace_kg_m2,
            Quantity::Backlash => self.gap_deg,
            Quantity::CuffStiffness => self.stiffness_nm,
            Quantity::CuffDamping => self.damping_nms,
            Quantity::TorqueConstant => self.torque_scale,
        }
    }

    /// Scene of this brace; the limb is the weight, and what a leg has besides is added by `limb`.
    fn scene(&self, limb: &str) -> String {
        let Self {
            friction_nm,
            load_loss,
            viscous_nms,
            rotor_kg_m2,
            brace_kg_m2,
            gap_deg,
            stiffness_nm,
            damping_nms,
            ..
        } = self;
        let body_kg = self.mass_kg / 0.061;
        let height_m = self.lever_m / (0.606 * 0.246);
        let from_deg = 90.0 - self.release_deg;
        format!(
            r#"
version = 1
title = "A weight in the brace"
duration_s = 60.0
[motion]
kind = "constant"
from_deg = {from_deg}
velocity_rad_s = 0.0
[solver]
kind = "exact-events"
step_s = 5e-5
precision = "f32"
[effects.encoder]
[effects.motor]
[effects.lead-pipe]
torque_nm = 0.3
elastic_nm_per_rad = 3.0
neutral_deg = {neutral}
[effects.drivetrain]
inertia_kg_m2 = {rotor_kg_m2}
friction_nm = {friction_nm}
load_loss = {load_loss}
[effects.backlash]
gap_deg = {gap_deg}
[effects.cuff]
stiffness_nm_per_rad = {stiffness_nm}
damping_nms_per_rad = {damping_nms}
brace_inertia_kg_m2 = {brace_kg_m2}
[effects.limb]
body_mass_kg = {body_kg}
height_m = {height_m}
damping_nms_per_rad = {viscous_nms}
{limb}
"#,
            neutral = self.release_deg,
        )
    }

    /// A recording of one release, held for 0.4 s before, until it has hung still for a second.
    pub(crate) fn recorded(&self, is_armed: bool) -> Recording {
        self.recorded_with(is_armed, "passive = \"none\"", 9)
    }

    pub(crate) fn recorded_with(&self, is_armed: bool, limb: &str, longest_s: u64) -> Recording {
        let mut host = Host::new(&scene(&self.scene(limb)), &Start::default());
        host.run(2_000);
        let believed = 0.0389 / self.torque_scale;
        host.set("motor.torque_constant_nm_per_a", believed);
        if is_armed {
            host.arm();
            host.run(2_000);
        }
        host.subscribe();
        let first_tick = host.accounting.expect("subscribed").first_tick;
        let (revision, values) = host.parameters();
        host.stream = Some(Vec::new());
        host.run(8_000);
        host.device.board_mut().leg_mut().release();
        let mut still = 0;
        for _ in 0..200 * longest_s {
            host.run(100);
            let shaft = host.device.board().leg().shaft();
            still = if shaft.omega_rad_s.abs() < 1e-6 {
                still + 1
            } else {
                0
            };
            if still > 160 {
                break;
            }
        }
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("swing");
        let metadata = Metadata::new("A swing", &Identity::default(), None);
        let mut recorder = Recorder::create(&file, &metadata).expect("a file");
        let begin = Begin {
            first_tick,
            dropped: 0,
            start: 1,
        };
        recorder.subscribed(begin).expect("space");
        recorder.announce(revision, &values);
        for heard in host.stream.take().expect("a stream") {
            if let Heard::Block(block) = heard {
                recorder.block(&block).expect("space");
            }
        }
        recorder.finish().expect("space");
        read(&file)
    }
}

/// The samples of a file.
fn read(file: &std::path::Path) -> Recording {
    let recording = crepitus_recording::Recording::open(file, Damage::Refuse).expect("whole");
    let mut in_force = recording.parameters().in_force();
    in_force.at(0);
    let values = in_force.values().expect("parameters");
    let settings = DeviceSettings::of(&values).expect("valid");
    let samples = recording.rows().expect("rows").map(|row| {
        let row = row.expect("a row");
        Sample {
            tick: row.tick,
            count: row.count,
            current_a: row.current_a,
            is_lost: false,
        }
    });
    Recording {
        samples: samples.collect(),
        tick_s: TICK_S,
        rad_per_count: values.rad_per_count(),
        torque_constant_nm_per_a: settings.motor.torque_constant_nm_per_a,
        gear_ratio: settings.encoder.gear_ratio,
    }
}

impl Truth {
    /// A brace within a factor of 2 of the data sheet, with a weight that swings in it, measured
    /// as well as a person can.
    pub(crate) fn hidden(random: &mut fastrand::Rng) -> Self {
        let factor = |random: &mut fastrand::Rng| 2_f64.powf(2.0 * random.f64() - 1.0);
        let nominal = Self::NOMINAL;
        let friction_nm = nominal.friction_nm * factor(random);
        let lever_m = 0.2 + 0.15 * random.f64();
        let moment_nm = friction_nm * (9.0 + 5.0 * random.f64());
        Self {
            friction_nm,
            load_loss: 0.15 + 0.3 * random.f64(),
            viscous_nms: 0.2 * random.f64(),
            rotor_kg_m2: nominal.rotor_kg_m2 * factor(random),
            brace_kg_m2: nominal.brace_kg_m2 * factor(random),
            gap_deg: nominal.gap_deg * factor(random),
            stiffness_nm: nominal.stiffness_nm * factor(random),
            damping_nms: nominal.damping_nms * factor(random),
            torque_scale: 1.0 + 0.03 * normal(random).clamp(-2.0, 2.0),
            mass_kg: moment_nm / (STANDARD_GRAVITY * lever_m),
            lever_m,
            release_deg: 45.0 + 20.0 * random.f64(),
            weighed_wrong: normal(random),
            inertia_wrong: normal(random),
        }
    }
}

/// A standard normal number (Box and Muller).
fn normal(random: &mut fastrand::Rng) -> f64 {
    let radius = (-2.0 * (1.0 - random.f64()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.f64()).cos()
}

/// A quantity's true value in the unit of its table.
pub(crate) fn in_table(truth: &Truth, quantity: Quantity, recording: &Recording) -> f64 {
    match quantity {
        // The scene's gear has 86 turns, which the device need not believe.
        Quantity::TorqueConstant => 0.0389 * 86.0 / recording.gear_ratio,
        _ => truth.value(quantity),
    }
}
