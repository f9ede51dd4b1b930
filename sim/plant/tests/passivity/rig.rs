//! A joint as the device renders it, what makes its torque act, and a hand's
//! energy.

use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::render::input_check::InputLimits;
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{
    EnergyObserver, Phase, Renderer, Sample, Settings, ShaftStep, StepCoefficients, StickSlip,
    Validated,
};
use crepitus_plant::actuator::Commanded;
use crepitus_plant::chain::Body;
use crepitus_plant::effect::{Context, Given, Part};
use crepitus_plant::effects::motor::EFFECT as MOTOR;
use std::f64::consts::TAU;

pub(crate) const TICK_S: f64 = 5e-5;

/// The shaft as the joint measures it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sensing {
    /// The true angle.
    True,
    /// The counts of the device's encoder, and the speed estimated from them.
    Counts,
}

/// Way in which the torque acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Acts {
    /// All of it late by this number of ticks.
    Late(usize),
    /// Torque through the effect `motor`.
    Motor,
}

/// Ticks by which the motor's torque lags behind its command, on average.
///
/// 1/g at the samples of the current; over a tick the winding's exponential
/// bulges, and the mean of a growing current is R·h/24L of a tick's growth
/// below its middle.
pub(crate) fn motor_lag_ticks() -> f64 {
    let [bandwidth_hz, ohm, henry] =
        ["bandwidth_hz", "resistance_ohm", "inductance_h"].map(|key| {
            let spec = MOTOR.parameters.iter().find(|p| p.key == key);
            spec.expect(key).default
        });
    1.0 / (1.0 - (-TAU * bandwidth_hz * TICK_S).exp()) + ohm * TICK_S / (24.0 * henry)
}

fn motor() -> Box<dyn Commanded> {
    let Part::Actuator(make) = MOTOR.part else {
        panic!("the motor is an actuator");
    };
    let context = Context {
        tick_s: TICK_S,
        gravity_rad: None,
        single: false,
        start: Body {
            angle_rad: 0.0,
            omega_rad_s: 0.0,
        },
    };
    make(&Given::defaults(&MOTOR), &context).expect("defaults are allowed")
}

/// A motor, and the same without a command: what the second does on the same
/// shaft is the motor's own, of its back-EMF. As long as no limit is met both
/// are linear, so the difference is what became of the command.
struct Motors {
    commanded: Box<dyn Commanded>,
    idle: Box<dyn Commanded>,
    row: Vec<f64>,
}

impl Motors {
    fn new() -> Self {
        Self {
            commanded: motor(),
            idle: motor(),
            row: Vec::new(),
        }
    }

    /// Work that a command takes out of the shaft in a tick, J.
    fn tick(&mut self, torque_nm: f64, omega_rad_s: f64) -> f64 {
        let mut step = |motor: &mut Box<dyn Commanded>, torque_nm| {
            let before = motor.absorbed_j();
            motor.command(torque_nm);
            motor.fold(TICK_S);
            motor.settle(TICK_S, omega_rad_s);
            self.row.clear();
            motor.write(&mut self.row);
            assert!(self.row[1].abs() < 24.0, "the supply limits: not linear");
            motor.absorbed_j() - before
        };
        step(&mut self.commanded, torque_nm) - step(&mut self.idle, 0.0)
    }
}

/// A hand at a joint.
pub(crate) struct Rig {
    settings: Validated<Settings>,
    renderer: Renderer<f32, ExactEvents>,
    reader: EncoderReader<f32>,
    sensing: Sensing,
    motors: Option<Motors>,
    observer: EnergyObserver<f64>,
    /// Observer with the terms of lost samples left out.
    ungranted: EnergyObserver<f64>,
    angle_rad: f64,
    seen_rad: f64,
    torque_nm: f64,
    /// ∫Ω² dt·h, rad².
    squares: f64,
}

#[expect(clippy::cast_possible_truncation, reason = "f32 is what is tested")]
fn single(x: f64) -> f32 {
    x as f32
}

fn count(angle_rad: f64) -> i32 {
    let counts = (angle_rad / EncoderSettings::default().rad_per_count()).floor();
    #[expect(clippy::cast_possible_truncation, reason = "a few turns")]
    let counts = counts as i32;
    counts
}

impl Rig {
    pub(crate) fn new(settings: &Settings, sensing: Sensing, acts: Acts) -> Self {
        let settings = settings.validate().expect("allowed");
        let encoder = EncoderSettings::default();
        let renderer = Renderer::of(
            StepCoefficients::<f32>::new(&settings, TICK_S).expect("a tick"),
            InputLimits::device(TICK_S),
            single(encoder.rad_per_count()),
            0.0,
        );
        let exact = StepCoefficients::<f64>::new(&settings, TICK_S).expect("a tick");
        let observer = match acts {
            Acts::Late(ticks) => EnergyObserver::new(&exact, ticks),
            Acts::Motor => EnergyObserver::behind_a_lag(&exact, motor_lag_ticks()),
        };
        Self {
            settings,
            renderer,
            reader: EncoderReader::new(&encoder, TICK_S, 0, 0.0).expect("defaults are allowed"),
            sensing,
            motors: (acts == Acts::Motor).then(Motors::new),
            observer,
            ungranted: observer,
            angle_rad: 0.0,
            seen_rad: 0.0,
            torque_nm: 0.0,
            squares: 0.0,
        }
    }

    /// One tick, in which the shaft turns by `travel_rad`; its sample may be
    /// lost.
    pub(crate) fn turn(&mut self, travel_rad: f64, is_lost: bool) {
        let omega_rad_s = travel_rad / TICK_S;
        let acting = self
            .motors
            .as_mut()
            .map(|motors| motors.tick(self.torque_nm, omega_rad_s));
        self.angle_rad += travel_rad;
        self.squares += travel_rad * travel_rad;
        let sample = self.sample(omega_rad_s, is_lost);
        let shown = self.renderer.render(&sample, |_| {});
        self.torque_nm = f64::from(shown.torque_nm);
        if let Some(work_j) = acting {
            self.observer.acted(travel_rad, work_j, !is_lost);
            self.ungranted.acted(travel_rad, work_j, true);
        } else {
            self.ungranted.tick(travel_rad, self.torque_nm);
            if is_lost {
                self.observer.tick_unseen(travel_rad, self.torque_nm);
            } else {
                self.observer.tick(travel_rad, self.torque_nm);
            }
        }
    }

    fn sample(&mut self, omega_rad_s: f64, is_lost: bool) -> Sample<f32> {
        if is_lost {
            self.reader.miss();
            return Sample::Lost;
        }
        let travel_rad = self.angle_rad - std::mem::replace(&mut self.seen_rad, self.angle_rad);
        Sample::Taken(match self.sensing {
            Sensing::Counts => self.reader.read(count(self.angle_rad)),
            // Straight through each tick; the speed jumps in between.
            Sensing::True => ShaftStep {
                delta_phi_rad: single(travel_rad),
                omega_start_rad_s: single(omega_rad_s),
                omega_end_rad_s: single(omega_rad_s),
            },
        })
    }

    pub(crate) fn phase(&self) -> Phase {
        self.renderer.joint().phase()
    }

    /// The torque shown, N·m.
    pub(crate) fn torque_nm(&self) -> f64 {
        self.torque_nm
    }

    /// The most that the hand got back over any stretch beyond what the bound
    /// grants, as a share of what it may: the bound's first term, and half a
    /// count of an encoder at the limit.
    pub(crate) fn share(&self) -> f64 {
        self.observer.share() / self.allowed()
    }

    /// That share without what lost samples are granted.
    pub(crate) fn share_without_gaps(&self) -> f64 {
        self.ungranted.share() / self.allowed()
    }

    fn allowed(&self) -> f64 {
        let p = &self.settings.parameters;
        let stroke_rad = p.static_torque_nm / p.stiffness_nm_per_rad;
        match self.sensing {
            Sensing::True => 1.0,
            Sensing::Counts => 1.0 + EncoderSettings::default().rad_per_count() / stroke_rad,
        }
    }

    /// Energy returned so far, in units of kr·h·∫Ω² dt.
    pub(crate) fn returned(&self) -> f64 {
        -self.observer.work_j() / (self.settings.parameters.stiffness_nm_per_rad * self.squares)
    }
}
