//! Cost of a step of a joint, alone and among many: nanoseconds, and ratios of one run.
//!
//! ```sh
//! cargo run --profile dist -p crepitus-ladder --example many_joints
//! ```
//!
//! All run through the same motion, in turns; a row is the fastest of its rounds, which other work on the
//! computer disturbs least. The plain loop is what
//! one writes for oneself: the law of `frozen`, its slips by four multiplications a step, no events.
#![expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "small numbers"
)]

use crepitus_ladder::joints::{Columns, Joints, Lanes, Motion};
use crepitus_model::solver::Solver;
use crepitus_model::{Convention, Parameters, Settings};
use std::hint::black_box;
use std::time::Instant;

const STEPS: usize = 20_000;
const JOINTS: usize = 64;
const ROUNDS: usize = 15;
const STEP_S: f64 = 5e-5;

/// Turns, rad, and speeds, rad/s, of a hand that moves to and fro.
fn motion<F: Lanes>() -> (Vec<F>, Vec<F>, F) {
    let angle = |n: usize| 0.25 * (std::f64::consts::TAU * 0.7 * n as f64 * STEP_S).sin();
    let speed = |n: usize| {
        0.25 * 0.7 * std::f64::consts::TAU * (std::f64::consts::TAU * 0.7 * n as f64 * STEP_S).cos()
    };
    let turns = (0..STEPS)
        .map(|n| F::from_f64(angle(n + 1) - angle(n)))
        .collect();
    let speeds = (0..STEPS).map(|n| F::from_f64(speed(n + 1))).collect();
    (turns, speeds, F::from_f64(speed(0)))
}

fn joints<F: Lanes>(count: usize, convention: Convention, omega_rad_s: F) -> Joints<F> {
    let each = (0..count).map(|n| {
        let settings = Settings {
            parameters: Parameters {
                static_torque_nm: 0.4 + 1e-3 * n as f64,
                ..Parameters::default()
            },
            convention,
            ..Settings::default()
        };
        (settings.validate().expect("valid"), omega_rad_s)
    });
    Joints::new(each, Solver::ExactEvents, STEP_S).expect("valid")
}

/// The law by hand: θ sticks to the shaft up to Ts, and swings for the time of eqs. (10)–(11).
fn plain(turns: &[f64], speeds: &[f64], out: &mut [Vec<f64>; 3], phase: &mut [i8]) {
    let p = Parameters::default();
    let (kr, j, ts, tk) = (
        p.stiffness_nm_per_rad,
        p.inertia_kg_m2,
        p.static_torque_nm,
        p.kinetic_torque_nm,
    );
    let wn = (kr / j).sqrt();
    let (c, s) = ((wn * STEP_S).cos(), (wn * STEP_S).sin() / wn);
    let (mut theta, mut v, mut sense, mut left) = (0.0, 0.0, 0.0_f64, 0_i64);
    let [torque, thetas, theta_dots] = out;
    for n in 0..turns.len() {
        if left > 0 {
            let x = theta - sense * tk / kr;
            (theta, v) = (c * x + s * v + sense * tk / kr, -wn * wn * s * x + c * v);
            left -= 1;
            if left == 0 {
                (theta, sense) = (sense * (2.0 * tk - ts) / kr, 0.0);
            }
        } else {
            theta += turns[n];
            v = speeds[n];
            if (kr * theta).abs() >= ts {
                sense = theta.signum();
                let lag = (ts - tk).atan2((sense * v).max(0.0) * (j * kr).sqrt());
                left = (2.0 * (std::f64::consts::PI - lag) / wn / STEP_S) as i64;
            }
        }
        torque[n] = if sense == 0.0 { kr * theta } else { sense * tk };
        phase[n] = sense as i8;
        thetas[n] = theta;
        theta_dots[n] = v;
    }
}

/// A named piece of work, and nanoseconds of each joint's step in each round.
struct Row<'a> {
    name: String,
    joints: usize,
    work: Box<dyn FnMut() + 'a>,
    times_ns: Vec<f64>,
}

impl<'a> Row<'a> {
    fn new(name: impl Into<String>, joints: usize, work: impl FnMut() + 'a) -> Self {
        Self {
            name: name.into(),
            joints,
            work: Box::new(work),
            times_ns: Vec::new(),
        }
    }

    fn fastest(&self) -> f64 {
        self.times_ns.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// Arrays of all columns for many joints.
struct Arrays<F> {
    torque_nm: Vec<F>,
    phase: Vec<i8>,
    theta_rad: Vec<F>,
    theta_dot_rad_s: Vec<F>,
}

impl<F: Lanes> Arrays<F> {
    fn new(joints: usize) -> Self {
        let numbers = || vec![F::ZERO; joints * STEPS];
        Self {
            torque_nm: numbers(),
            phase: vec![0; joints * STEPS],
            theta_rad: numbers(),
            theta_dot_rad_s: numbers(),
        }
    }

    fn all(&mut self) -> Columns<'_, F> {
        Columns {
            torque_nm: &mut self.torque_nm,
            phase: &mut self.phase,
            theta_rad: &mut self.theta_rad,
            theta_dot_rad_s: &mut self.theta_dot_rad_s,
        }
    }

    fn torque_and_phase(&mut self) -> Columns<'_, F> {
        Columns {
            torque_nm: &mut self.torque_nm,
            phase: &mut self.phase,
            ..Columns::default()
        }
    }
}

fn rows<'a, F: Lanes>(
    convention: Convention,
    motion: &'a (Vec<F>, Vec<F>, F),
    to: &mut Vec<Row<'a>>,
) {
    let (turns, speeds, start) = motion;
    let name = |what: &str| format!("{} {}, {what}", F::NAME, convention.name());
    let make = move |count| joints(count, convention, *start);
    let mut out = Arrays::new(1);
    to.push(Row::new(name("one joint, step by step"), 1, move || {
        let mut joint = make(1);
        for n in 0..STEPS {
            let motion = Motion::of_all(&turns[n..=n], &speeds[n..=n]);
            joint.step(motion).expect("fits");
            out.torque_nm[n] = joint.torques_nm()[0];
            out.phase[n] = joint.phases()[0];
            (out.theta_rad[n], out.theta_dot_rad_s[n]) = joint.motions().next().expect("one");
        }
        black_box(&out.theta_rad);
    }));
    let mut out = Arrays::new(1);
    to.push(Row::new(name("steps of one joint"), 1, move || {
        let motion = Motion::of_all(turns, speeds);
        let mut joint = make(1);
        joint.steps(motion, out.all(), 1, || true).expect("fits");
        black_box(&out.theta_rad);
    }));
    let of_each: (Vec<F>, Vec<F>) = (turns.repeat(JOINTS), speeds.repeat(JOINTS));
    let mut out = Arrays::new(JOINTS);
    to.push(Row::new(
        name("joints, one motion, all columns"),
        JOINTS,
        move || {
            let motion = Motion::of_all(turns, speeds);
            let mut joints = make(JOINTS);
            joints.steps(motion, out.all(), 1, || true).expect("fits");
            black_box(&out.theta_rad);
        },
    ));
    let mut out = Arrays::new(JOINTS);
    to.push(Row::new(name("joints, one motion"), JOINTS, move || {
        let motion = Motion::of_all(turns, speeds);
        let mut joints = make(JOINTS);
        let columns = out.torque_and_phase();
        joints.steps(motion, columns, 1, || true).expect("fits");
        black_box(&out.torque_nm);
    }));
    let mut out = Arrays::new(JOINTS);
    to.push(Row::new(name("joints, a motion each"), JOINTS, move || {
        let motion = Motion::of_each(&of_each.0, &of_each.1);
        let mut joints = make(JOINTS);
        let columns = out.torque_and_phase();
        joints.steps(motion, columns, 1, || true).expect("fits");
        black_box(&out.torque_nm);
    }));
    let mut out = Arrays::new(JOINTS);
    to.push(Row::new(
        name("joints, one motion, 2 threads"),
        JOINTS,
        move || {
            let motion = Motion::of_all(turns, speeds);
            let mut joints = make(JOINTS);
            let columns = out.torque_and_phase();
            joints.steps(motion, columns, 2, || true).expect("fits");
            black_box(&out.torque_nm);
        },
    ));
    to.push(Row::new(name("joints in lock-step"), JOINTS, move || {
        let mut joints = make(JOINTS);
        for n in 0..STEPS {
            let motion = Motion::of_all(&turns[n..=n], &speeds[n..=n]);
            joints.step(motion).expect("fits");
            black_box(joints.torques_nm());
        }
    }));
}

fn main() {
    let (double, single) = (motion::<f64>(), motion::<f32>());
    let mut out = [(); 3].map(|()| vec![0.0; STEPS]);
    let mut phase = vec![0; STEPS];
    let mut all = Vec::new();
    all.push(Row::new("f64 frozen, plain loop", 1, || {
        plain(&double.0, &double.1, &mut out, &mut phase);
        black_box(&out);
    }));
    for convention in [Convention::Frozen, Convention::Physical] {
        rows(convention, &double, &mut all);
        rows(convention, &single, &mut all);
    }
    for _ in 0..ROUNDS {
        for row in &mut all {
            let begun = Instant::now();
            (row.work)();
            let ns = begun.elapsed().as_secs_f64() * 1e9;
            row.times_ns.push(ns / (row.joints * STEPS) as f64);
        }
    }
    println!("{:48} {:>8} {:>12}", "", "ns/step", "of its steps");
    let mut of_one = f64::NAN;
    for row in &all {
        let ns = row.fastest();
        if row.name.ends_with("steps of one joint") {
            of_one = ns;
        }
        println!("{:48} {ns:8.2} {:12.2}", row.name, ns / of_one);
    }
}
