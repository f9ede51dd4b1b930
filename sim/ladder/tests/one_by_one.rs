//! Many joints at once have the bits that each has by itself, step by step.

use crepitus_ladder::joints::{Columns, Counts, Joints, Lanes, Motion};
use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{
    Convention, EventKind, Parameters, Restart, Settings, ShaftStep, StepCoefficients, StickSlip,
    Validated,
};
use fastrand::Rng;

const CONVENTIONS: [Convention; 3] = [Convention::Frozen, Convention::Paper, Convention::Physical];

/// Bits of torque, θ and θ̇, and the phase, after a step.
type State = ([u64; 3], i8);

fn bits<F: Lanes>(x: F) -> u64 {
    let x = x.to_f64();
    // The sign of a NaN, of an explicit method that has diverged, is the compiler's.
    if x.is_nan() { u64::MAX } else { x.to_bits() }
}

/// A number between two, evenly in its logarithm.
fn log(random: &mut Rng, low: f64, high: f64) -> f64 {
    low * (high / low).powf(random.f64())
}

fn settings(random: &mut Rng, convention: Convention) -> Validated<Settings> {
    let static_torque_nm = log(random, 0.05, 2.0);
    let (stiffness, inertia) = (log(random, 50.0, 2000.0), log(random, 1e-5, 0.05));
    let damping = if convention == Convention::Frozen || random.bool() {
        0.0
    } else {
        2.0 * (stiffness * inertia).sqrt() * log(random, 1e-3, 3.0)
    };
    // Some touch, and some turn back.
    let kinetic = [1.0, 0.0, random.f64()][random.usize(..3)];
    let settings = Settings {
        parameters: Parameters {
            static_torque_nm,
            kinetic_torque_nm: static_torque_nm * kinetic,
            stiffness_nm_per_rad: stiffness,
            inertia_kg_m2: inertia,
            damping_nms_per_rad: damping,
        },
        convention,
        restart: if convention == Convention::Frozen && random.bool() {
            Restart::FromKinetic
        } else {
            Restart::Elastic
        },
    };
    settings.validate().unwrap()
}

/// Turns and speeds of a hand that starts, stops, turns back and jumps.
fn motion<F: Lanes>(random: &mut Rng, steps: usize, step_s: f64) -> (Vec<F>, Vec<F>) {
    let (mut speed, mut acceleration) = (log(random, 0.01, 8.0), 0.0);
    let mut of_step = |_| {
        if random.f64() < 0.01 {
            acceleration = 100.0 * (random.f64() - 0.5);
        }
        if random.f64() < 0.003 {
            speed = [0.0, -speed, 8.0 * (random.f64() - 0.5)][random.usize(..3)];
        }
        let before = speed;
        speed = (speed + acceleration * step_s).clamp(-8.0, 8.0);
        (
            F::from_f64(0.5 * (before + speed) * step_s),
            F::from_f64(speed),
        )
    };
    (0..steps).map(&mut of_step).unzip()
}

/// The model's own joint, step by step.
struct Alone<'a, F> {
    turns: &'a [F],
    speeds: &'a [F],
    omega_rad_s: F,
}

impl<F: Lanes> JointVisitor<F> for Alone<'_, F> {
    type Output = (Vec<State>, Counts);

    fn visit<J: StickSlip<F>>(mut self, mut joint: J) -> Self::Output {
        let mut counts = Counts::default();
        let mut step = |(turn, speed): (&F, &F)| {
            let shaft = ShaftStep {
                delta_phi_rad: *turn,
                omega_start_rad_s: self.omega_rad_s,
                omega_end_rad_s: *speed,
            };
            joint.step(&shaft, |event| match event.kind {
                EventKind::Break => counts.breaks += 1,
                EventKind::Stick => counts.sticks += 1,
                EventKind::Reverse => counts.reverses += 1,
            });
            self.omega_rad_s = *speed;
            let numbers = [
                joint.torque_nm(),
                joint.theta_rad(),
                joint.theta_dot_rad_s(),
            ];
            (numbers.map(bits), joint.phase().sign())
        };
        let states = self.turns.iter().zip(self.speeds).map(&mut step).collect();
        (states, counts)
    }
}

/// States of joints in columns.
struct Arrays<F> {
    numbers: [Vec<F>; 3],
    phase: Vec<i8>,
}

impl<F: Lanes> Arrays<F> {
    fn new(count: usize) -> Self {
        Self {
            numbers: [(); 3].map(|()| vec![F::from_f64(f64::NAN); count]),
            phase: vec![9; count],
        }
    }

    fn columns(&mut self) -> Columns<'_, F> {
        let [torque_nm, theta_rad, theta_dot_rad_s] = &mut self.numbers;
        Columns {
            torque_nm,
            phase: &mut self.phase,
            theta_rad,
            theta_dot_rad_s,
        }
    }

    fn states(&self) -> Vec<State> {
        let of = |n: usize| ([0, 1, 2].map(|k| bits(self.numbers[k][n])), self.phase[n]);
        (0..self.phase.len()).map(of).collect()
    }
}

/// Joints of one rung on motions of their own: in arrays, in pieces, in threads and in lock-step.
fn compare<F: Lanes>(random: &mut Rng, convention: Convention, solver: Solver) -> u64 {
    // Up to more than there are lanes.
    let (count, steps) = (random.usize(1..20), 2_000);
    let step_s = [5e-5, 5e-4][random.usize(..2)];
    let name = format!("{} {} {}", F::NAME, convention.name(), solver.name());
    let each: Vec<_> = (0..count)
        .map(|_| {
            let (turns, speeds) = motion::<F>(random, steps, step_s);
            let omega_rad_s = if random.bool() { F::ZERO } else { speeds[0] };
            (settings(random, convention), turns, speeds, omega_rad_s)
        })
        .collect();
    let (mut expected, mut counts) = (Vec::new(), Vec::new());
    for (settings, turns, speeds, omega_rad_s) in &each {
        let alone = Alone {
            turns,
            speeds,
            omega_rad_s: *omega_rad_s,
        };
        let (states, count) = with_joint(settings, solver, step_s, *omega_rad_s, alone).unwrap();
        expected.push(states);
        counts.push(count);
    }
    let make = || {
        let of_each = each.iter().map(|(settings, .., omega)| (*settings, *omega));
        Joints::new(of_each, solver, step_s).unwrap()
    };
    let part = |from: usize, to: usize| -> (Vec<F>, Vec<F>) {
        let of = |numbers: &Vec<F>| numbers[from..to].to_vec();
        let turns = each.iter().flat_map(|(_, turns, ..)| of(turns)).collect();
        let speeds = each.iter().flat_map(|(.., speeds, _)| of(speeds)).collect();
        (turns, speeds)
    };
    let (turns, speeds) = part(0, steps);
    let whole = Motion::of_each(&turns, &speeds);
    for threads in [1, 3] {
        let (mut joints, mut arrays) = (make(), Arrays::new(count * steps));
        joints
            .steps(whole, arrays.columns(), threads, || true)
            .unwrap();
        let states = arrays.states();
        for (n, expected) in expected.iter().enumerate() {
            let states = &states[n * steps..(n + 1) * steps];
            let wrong = states.iter().zip(expected).position(|(a, b)| a != b);
            assert_eq!(wrong, None, "{name}, {threads} threads, joint {n}");
        }
        assert!(joints.counts().eq(counts.iter().copied()), "{name}");
    }
    // Steps one by one and arrays of them, in turns; a snapshot goes the same way.
    let (mut joints, mut from) = (make(), 0);
    let mut lonely: Joints<F> = joints.clone();
    while from < steps {
        let to = (from + random.usize(1..700)).min(steps);
        let in_array = random.bool();
        if in_array {
            let (turns, speeds) = part(from, to);
            let columns = Columns::default();
            let motion = Motion::of_each(&turns, &speeds);
            joints.steps(motion, columns, 1, || true).unwrap();
        } else {
            for n in from..to {
                let (turns, speeds) = part(n, n + 1);
                joints.step(Motion::of_each(&turns, &speeds)).unwrap();
                for (torque, expected) in joints.torques_nm().iter().zip(&expected) {
                    assert_eq!(bits(*torque), expected[n].0[0], "{name}, step {n}");
                }
                let motions: Vec<_> = if random.f64() < 0.05 {
                    joints.motions().collect()
                } else {
                    Vec::new()
                };
                for ((theta, theta_dot), expected) in motions.into_iter().zip(&expected) {
                    assert_eq!([theta, theta_dot].map(bits), expected[n].0[1..], "{name}");
                }
            }
        }
        from = to;
        if random.f64() < 0.2 {
            lonely = joints.clone();
            joints.restart(0, F::ZERO, F::ONE);
            joints = lonely.clone();
        }
        for (n, phase) in joints.phases().iter().enumerate() {
            assert_eq!(*phase, expected[n][from - 1].1, "{name}");
        }
    }
    assert!(joints.counts().eq(counts.iter().copied()), "{name}");
    assert_eq!(lonely.len(), count);
    counts
        .iter()
        .map(|c| c.breaks + c.sticks + c.reverses)
        .sum()
}

#[test]
fn joints_have_the_bits_of_each_alone() {
    let mut random = Rng::with_seed(58);
    let (mut rungs, mut events) = (0, 0);
    for convention in CONVENTIONS {
        for solver in Solver::ALL {
            if solver.refusal(convention).is_some() {
                continue;
            }
            let rounds = if solver == Solver::ExactEvents { 40 } else { 6 };
            for _ in 0..rounds {
                events += compare::<f64>(&mut random, convention, solver);
                if solver.single_refusal().is_none() {
                    events += compare::<f32>(&mut random, convention, solver);
                }
            }
            rungs += 1;
        }
    }
    println!("{rungs} rungs, {events} events");
    assert!(rungs == 25 && events > 100_000, "{rungs} {events}");
}

#[test]
fn one_motion_is_that_of_each() {
    let mut random = Rng::with_seed(59);
    for convention in CONVENTIONS {
        let settings: Vec<_> = (0..7).map(|_| settings(&mut random, convention)).collect();
        let (turns, speeds) = motion::<f64>(&mut random, 4_000, 5e-5);
        let make = || {
            let each = settings.iter().map(|settings| (*settings, 0.5));
            Joints::new(each, Solver::ExactEvents, 5e-5).unwrap()
        };
        let (mut one, mut of_each) = (make(), make());
        let (mut a, mut b) = (Arrays::new(28_000), Arrays::new(28_000));
        let motion = Motion::of_all(&turns, &speeds);
        one.steps(motion, a.columns(), 2, || true).unwrap();
        let (turns, speeds) = (turns.repeat(7), speeds.repeat(7));
        let motion = Motion::of_each(&turns, &speeds);
        of_each.steps(motion, b.columns(), 1, || true).unwrap();
        assert!(a.states() == b.states());
        one.step(Motion::of_all(&[1e-5], &[0.2])).unwrap();
        of_each
            .step(Motion::of_each(&[1e-5; 7], &[0.2; 7]))
            .unwrap();
        assert_eq!(one.torques_nm(), of_each.torques_nm());
        assert_eq!(one.omegas_rad_s(), [0.2; 7]);
    }
}

/// Motion of a shaft.
enum Way<F> {
    /// Steps with these turns and speeds.
    Steps(Vec<F>, Vec<F>),
    /// A jump to a speed.
    Jump(F),
    /// A step in parts of these lengths, s.
    Parts(Vec<(f64, ShaftStep<F>)>),
}

/// Ways of a hand that jumps, now between steps and now within them.
fn ways<F: Lanes>(random: &mut Rng, step_s: f64) -> Vec<Way<F>> {
    let mut speed = 0.5;
    let mut next = |random: &mut Rng| {
        speed = if random.f64() < 0.3 {
            -speed
        } else {
            6.0 * (random.f64() - 0.4)
        };
        speed
    };
    let mut ways = Vec::new();
    for _ in 0..40 {
        let steps = random.usize(1..60);
        let (speed, after) = (next(random), next(random));
        let [speed_f, after_f] = [speed, after].map(F::from_f64);
        ways.push(Way::Jump(speed_f));
        let turn = F::from_f64(speed * step_s);
        ways.push(Way::Steps(vec![turn; steps], vec![speed_f; steps]));
        let cut_s = step_s * (0.01 + 0.98 * random.f64());
        let part = |omega: f64, length_s: f64| {
            let shaft = ShaftStep {
                delta_phi_rad: F::from_f64(omega * length_s),
                omega_start_rad_s: F::from_f64(omega),
                omega_end_rad_s: F::from_f64(omega),
            };
            (length_s, shaft)
        };
        ways.push(Way::Parts(vec![
            part(speed, cut_s),
            part(after, step_s - cut_s),
        ]));
        ways.push(Way::Steps(
            vec![F::from_f64(after * step_s); 9],
            vec![after_f; 9],
        ));
    }
    ways
}

/// An event: number of its way, of its step or part there, and its numbers; or the state after a part.
type Note = (usize, usize, String);

/// The model's own joint on such a way.
struct OnWays<'a, F> {
    settings: &'a Validated<Settings>,
    ways: &'a [Way<F>],
    omega_rad_s: F,
}

impl<F: Lanes> JointVisitor<F> for OnWays<'_, F> {
    type Output = Vec<Note>;

    fn visit<J: StickSlip<F>>(mut self, mut joint: J) -> Vec<Note> {
        let mut notes = Vec::new();
        for (at, way) in self.ways.iter().enumerate() {
            match way {
                Way::Jump(omega) => self.omega_rad_s = *omega,
                Way::Steps(turns, speeds) => {
                    for (n, (turn, speed)) in turns.iter().zip(speeds).enumerate() {
                        let shaft = ShaftStep {
                            delta_phi_rad: *turn,
                            omega_start_rad_s: self.omega_rad_s,
                            omega_end_rad_s: *speed,
                        };
                        joint.step(&shaft, |event| notes.push((at, n, format!("{event:?}"))));
                        self.omega_rad_s = *speed;
                    }
                }
                Way::Parts(parts) => {
                    let whole = *joint.coefficients();
                    for (n, (length_s, shaft)) in parts.iter().enumerate() {
                        joint.change_step(StepCoefficients::new(self.settings, *length_s).unwrap());
                        joint.step(shaft, |event| notes.push((at, n, format!("{event:?}"))));
                        let state = (joint.phase(), joint.torque_nm(), joint.motion());
                        notes.push((at, n, format!("{state:?}")));
                        self.omega_rad_s = shaft.omega_end_rad_s;
                    }
                    joint.change_step(whole);
                }
            }
        }
        notes
    }
}

fn compare_on_ways<F: Lanes>(random: &mut Rng, convention: Convention) -> usize {
    let (step_s, omega) = (2e-4, F::from_f64(0.5));
    let ways = ways::<F>(random, step_s);
    let settings: Vec<_> = (0..11).map(|_| settings(random, convention)).collect();
    let each = settings.iter().map(|settings| (*settings, omega));
    let mut joints = Joints::new(each, Solver::ExactEvents, step_s).unwrap();
    joints.record_events();
    let mut notes: Vec<Vec<Note>> = vec![Vec::new(); settings.len()];
    for (at, way) in ways.iter().enumerate() {
        match way {
            Way::Jump(omega) => joints.jump(*omega),
            Way::Steps(turns, speeds) => {
                let motion = Motion::of_all(turns, speeds);
                joints
                    .steps(motion, Columns::default(), 1, || true)
                    .unwrap();
                for (n, notes) in notes.iter_mut().enumerate() {
                    let events = joints.take_events(n);
                    notes.extend(events.map(|e| (at, e.step, format!("{:?}", e.event))));
                }
            }
            Way::Parts(parts) => {
                for (n, notes) in notes.iter_mut().enumerate() {
                    let of = |(length_s, shaft): &(f64, ShaftStep<F>)| {
                        (
                            StepCoefficients::new(&settings[n], *length_s).unwrap(),
                            *shaft,
                        )
                    };
                    let mut part = 0;
                    let parts: Vec<_> = parts.iter().map(of).collect();
                    joints.step_in_parts(n, &parts, |events, state| {
                        notes.extend(events.iter().map(|e| (at, part, format!("{:?}", e.event))));
                        let motion = (state.theta_rad, state.theta_dot_rad_s);
                        let state = (state.phase, state.torque_nm, motion);
                        notes.push((at, part, format!("{state:?}")));
                        part += 1;
                    });
                }
            }
        }
    }
    for (n, (settings, notes)) in settings.iter().zip(&notes).enumerate() {
        let alone = OnWays {
            settings,
            ways: &ways,
            omega_rad_s: omega,
        };
        let expected = with_joint(settings, Solver::ExactEvents, step_s, omega, alone).unwrap();
        let wrong = notes.iter().zip(&expected).position(|(a, b)| a != b);
        assert_eq!(wrong, None, "{} {}, joint {n}", F::NAME, convention.name());
        assert_eq!(notes.len(), expected.len());
    }
    notes.iter().map(Vec::len).sum()
}

#[test]
fn events_jumps_and_parts_of_steps_are_those_of_each_alone() {
    let mut random = Rng::with_seed(60);
    let mut notes = 0;
    for convention in CONVENTIONS {
        for _ in 0..5 {
            notes += compare_on_ways::<f64>(&mut random, convention);
            notes += compare_on_ways::<f32>(&mut random, convention);
        }
    }
    assert!(notes > 40_000, "{notes}");
}

#[test]
fn steps_end_where_the_caller_says() {
    let numbers = vec![0.0; 1_000_000];
    for (threads, convention) in [
        (1, Convention::Frozen),
        (2, Convention::Frozen),
        (1, Convention::Physical),
    ] {
        let settings = Settings {
            convention,
            ..Settings::default()
        };
        let each = [(settings.validate().unwrap(), 0.0_f64); 4];
        let mut joints = Joints::new(each, Solver::ExactEvents, 5e-5).unwrap();
        let mut looks = 0;
        let stopped = joints.steps(
            Motion::of_all(&numbers, &numbers),
            Columns::default(),
            threads,
            || {
                looks += 1;
                looks < 3
            },
        );
        assert!(stopped.is_err() && looks == 3, "{threads}");
    }
}

/// At rest nobody slips, and lanes have one joint after the other to themselves.
#[test]
fn many_joints_at_rest_stay_there() {
    let settings = Settings {
        convention: Convention::Physical,
        ..Settings::default()
    };
    let each = vec![(settings.validate().unwrap(), 0.0_f64); 100_000];
    let mut joints = Joints::new(each, Solver::ExactEvents, 5e-5).unwrap();
    let numbers = [0.0; 10];
    let motion = Motion::of_all(&numbers, &numbers);
    joints
        .steps(motion, Columns::default(), 1, || true)
        .unwrap();
    assert!(joints.torques_nm().iter().all(|torque| *torque == 0.0));
    assert!(joints.counts().all(|of| of == Counts::default()));
}
