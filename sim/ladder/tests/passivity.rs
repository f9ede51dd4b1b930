//! Energy that a bare joint returns, against what is said of it.

use crepitus_ladder::joints::{Joints, Motion, Passivity};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters, Restart, Settings, Validated};
use fastrand::Rng;
use std::array::from_ref;

const STEP_S: f64 = 5e-5;

/// A joint, its shaft, and the energy that the shaft has got back over any stretch, J, with the torque of a step held
/// over the next.
struct Shaft {
    joint: Joints<f64>,
    omega_rad_s: f64,
    torque_nm: f64,
    phase: i8,
    /// Energy put in so far, and the most so far.
    put_in_j: f64,
    most_j: f64,
    returned_j: f64,
    /// ∫Ω² dt, rad²/s.
    square: f64,
}

impl Shaft {
    fn new(settings: &Validated<Settings>) -> Self {
        let joint = Joints::new([(*settings, 0.0)], Solver::ExactEvents, STEP_S);
        Self {
            joint: joint.unwrap(),
            omega_rad_s: 0.0,
            torque_nm: 0.0,
            phase: 0,
            put_in_j: 0.0,
            most_j: 0.0,
            returned_j: 0.0,
            square: 0.0,
        }
    }

    /// A step with this acceleration, rad/s², behind a velocity step, rad/s.
    fn step(&mut self, acceleration: f64, jump: f64) {
        let from = self.omega_rad_s + jump;
        let to = from + acceleration * STEP_S;
        let turn = 0.5 * (from + to) * STEP_S;
        self.omega_rad_s = to;
        self.put_in_j += self.torque_nm * turn;
        self.most_j = self.most_j.max(self.put_in_j);
        self.returned_j = self.returned_j.max(self.most_j - self.put_in_j);
        self.square += turn * turn / STEP_S;
        self.joint
            .step(Motion::of_all(from_ref(&turn), from_ref(&to)))
            .unwrap();
        self.torque_nm = self.joint.torques_nm()[0];
        self.phase = self.joint.phases()[0];
    }

    fn bound_j(&self, passivity: &Passivity) -> f64 {
        passivity.stored_j + passivity.needed_damping_nms_per_rad * self.square
    }
}

fn settings(parameters: Parameters, restart: Restart) -> Validated<Settings> {
    let settings = Settings {
        parameters,
        convention: Convention::Frozen,
        restart,
    };
    settings.validate().unwrap()
}

fn random(random: &mut Rng) -> Validated<Settings> {
    let log = |random: &mut Rng, low: f64, high: f64| low * (high / low).powf(random.f64());
    let static_torque_nm = log(random, 0.05, 2.0);
    let parameters = Parameters {
        static_torque_nm,
        kinetic_torque_nm: static_torque_nm * (0.1 + 0.85 * random.f64()),
        stiffness_nm_per_rad: log(random, 50.0, 1000.0),
        inertia_kg_m2: log(random, 1e-3, 0.05),
        damping_nms_per_rad: 0.0,
    };
    let restart = [Restart::Elastic, Restart::FromKinetic][random.usize(..2)];
    settings(parameters, restart)
}

/// A hand that pushes on in a stick, and turns back in every slip as fast as it may.
fn turn_back(shaft: &mut Shaft, acceleration: f64, velocity_step: f64, speed: f64) {
    for _ in 0..60_000 {
        let was = shaft.phase;
        if shaft.phase == 0 {
            let wanted = speed - shaft.omega_rad_s;
            let most = acceleration.max(1e-6) * STEP_S;
            shaft.step(wanted.clamp(-most, most) / STEP_S, 0.0);
        } else {
            shaft.step(-acceleration * f64::from(shaft.phase), 0.0);
        }
        if was == 0 && shaft.phase != 0 && velocity_step > 0.0 {
            shaft.step(0.0, -velocity_step * f64::from(shaft.phase));
        }
    }
}

#[test]
fn up_to_the_limit_no_hand_gets_more_than_the_bound() {
    let mut rng = Rng::with_seed(59);
    let mut worst = 0.0_f64;
    for case in 0..60 {
        let settings = random(&mut rng);
        let passivity = Passivity::of(&settings, STEP_S, 0.0).unwrap();
        let most = passivity.most_acceleration_rad_s2.unwrap();
        let jump = passivity.most_velocity_step_rad_s.unwrap();
        let share = [1.0, 0.5, 0.0][case % 3];
        assert_eq!(
            passivity.may_push(0.999 * share * most, 0.999 * (1.0 - share) * jump),
            Some(false)
        );
        let mut shaft = Shaft::new(&settings);
        let speed = 1e-3 * 1000.0_f64.powf(rng.f64());
        turn_back(&mut shaft, share * most, (1.0 - share) * jump, speed);
        worst = worst.max(shaft.returned_j / shaft.bound_j(&passivity));
        // And one that does as it likes.
        let mut shaft = Shaft::new(&settings);
        let mut acceleration = 0.0;
        for _ in 0..60_000 {
            if rng.f64() < 0.005 {
                acceleration = most * (2.0 * rng.f64() - 1.0);
                if shaft.omega_rad_s.abs() > 2.0 {
                    acceleration = -most * shaft.omega_rad_s.signum();
                }
            }
            shaft.step(acceleration, 0.0);
        }
        worst = worst.max(shaft.returned_j / shaft.bound_j(&passivity));
    }
    println!("share of the bound that is used: {worst:.4}");
    assert!(worst <= 1.0, "{worst}");
}

#[test]
fn a_little_beyond_the_limit_a_hand_that_jumps_back_is_pushed_in_every_slip() {
    let settings = settings(Parameters::default(), Restart::Elastic);
    let passivity = Passivity::of(&settings, STEP_S, 0.0).unwrap();
    let most = passivity.most_acceleration_rad_s2.unwrap();
    let jump = 1.3 * passivity.most_velocity_step_rad_s.unwrap();
    assert_eq!(passivity.may_push(0.0, jump), Some(true));
    let mut shaft = Shaft::new(&settings);
    turn_back(&mut shaft, 0.5 * most, jump, 1e-2);
    let bound_j = shaft.bound_j(&passivity);
    println!("{jump} rad/s: {} J of {bound_j}", shaft.returned_j);
    assert!(shaft.returned_j > 3.0 * bound_j);
}

/// The paper's joint on a shaft that is shaken at 20 Hz by ±0.02 rad.
#[test]
fn a_fast_hand_is_pushed_and_that_was_said_before() {
    let settings = settings(Parameters::default(), Restart::Elastic);
    let passivity = Passivity::of(&settings, STEP_S, 0.0).unwrap();
    let omega = 2.0 * std::f64::consts::PI * 20.0;
    let peak = 0.02 * omega * omega;
    assert_eq!(passivity.may_push(peak, 0.0), Some(true));
    let mut shaft = Shaft::new(&settings);
    shaft.omega_rad_s = 0.02 * omega;
    for n in 0..80_000_u32 {
        shaft.step(-peak * (omega * (f64::from(n) + 0.5) * STEP_S).sin(), 0.0);
    }
    println!(
        "{} J, bound {}",
        shaft.returned_j,
        shaft.bound_j(&passivity)
    );
    assert!(shaft.returned_j > 1.5 * shaft.bound_j(&passivity));
}

#[test]
fn what_is_not_known_is_not_said() {
    let of = |convention, kinetic| {
        let parameters = Parameters {
            kinetic_torque_nm: kinetic,
            ..Parameters::default()
        };
        let settings = Settings {
            parameters,
            convention,
            restart: Restart::Elastic,
        };
        Passivity::of(&settings.validate().unwrap(), STEP_S, 1.0).unwrap()
    };
    for convention in [Convention::Paper, Convention::Physical] {
        assert_eq!(of(convention, 0.2).may_push(0.0, 0.0), None);
    }
    // Ts = Tk: a slip takes nothing, so any retreat pushes; and Tk = 0 shows nothing.
    assert_eq!(of(Convention::Frozen, 0.4).may_push(0.0, 0.0), Some(false));
    assert_eq!(of(Convention::Frozen, 0.4).may_push(1e-9, 0.0), Some(true));
    assert_eq!(of(Convention::Frozen, 0.0).may_push(1e6, 1e3), Some(false));
    let usual = of(Convention::Frozen, 0.2);
    assert_eq!(usual.needed_damping_nms_per_rad, 1.5 * 400.0 * 5e-5);
    assert!((usual.stored_j - 2e-4).abs() < 1e-15);
    assert_eq!(usual.may_push(f64::NAN, 0.0), Some(true));
}
