//! A pass of the knee: 90° from turn to turn, as a sine of 45° does it; at 0.25 Hz, and at 0.1 Hz.
//!
//! At 0.25 Hz the shaft accelerates so fast that an inertia on a spring no longer sticks; the joint that
//! the device renders grates throughout. At 0.1 Hz both have the same cycles.
//!
//! Known: the cycles of the event-driven reference, counted in its torque as in that of a law, and
//! the error that the exact joint itself has if its torque is held for a tick:
//!
//! ```text
//! e² = 1/(N·h) · Σₙ ∫ (Tₙ − T(t))² dt        Tₙ the law's torque at the tick, T the reference's
//! ```
//!
//! A law that is a fraction of a cycle late has an error of the size of Ts − Tk.

use crate::accuracy::held_torque::HeldTorque;
use crate::accuracy::input::Input;
use crate::accuracy::scenes::StudyScene;
use crate::laws::cycles::Cycles;
use crate::laws::reference::{demanded, torques};
use crate::laws::runner::{Runner, TICK_S, TICKS_HZ};
use crate::laws::task::{Demand, Prepared, Quantity, Reading, Setting, Task, Use};
use crate::sampling::Sampling;
use crate::watcher::StudyError;
use crepitus_model::SettingsError;
use crepitus_plant::Motion;

/// The task.
pub struct Knee;

/// From turn to turn, s.
const PASS_S: f64 = 2.0;
const SLOW_PASS_S: f64 = 5.0;

const QUANTITIES: &[Quantity] = &[
    Quantity {
        name: "knee-breaks",
        title: "cycles of a pass of the knee, 90° in 2 s",
        unit: "1",
        demands: "the cycles of the event-driven reference, which grates throughout",
        of: Use::Grating,
    },
    Quantity {
        name: "knee-slow-breaks",
        title: "cycles of a slow pass of the knee, 90° in 5 s",
        unit: "1",
        demands: "the cycles of the event-driven reference, and of an inertia on a spring",
        of: Use::Grating,
    },
    Quantity {
        name: "knee-rms",
        title: "root mean square error of the held torque in a pass of the knee",
        unit: "N·m",
        demands: "the error of the exact joint if it is held for a tick, by the event-driven reference",
        of: Use::Grating,
    },
];

impl Task for Knee {
    fn name(&self) -> &'static str {
        "knee"
    }

    fn title(&self) -> &'static str {
        "a pass of the knee"
    }

    fn quantities(&self) -> &'static [Quantity] {
        QUANTITIES
    }

    fn prepare(&self, setting: &Setting) -> Result<Box<dyn Prepared>, StudyError> {
        let joint = &setting.joint.parameters;
        let scene = StudyScene {
            name: self.name().to_owned(),
            title: self.title().to_owned(),
            motion: pass(PASS_S),
            duration_s: PASS_S,
            settings: demanded(joint)?,
            input: Input::Exact,
        };
        let sampling = Sampling::new(&scene.motion, PASS_S, TICK_S);
        let held = HeldTorque::new(&scene, &sampling, &scene.true_events());
        let mut ticks_nm = vec![0.0];
        let count = |duration_s, ticks_nm: &mut Vec<f64>| {
            let (mut cycles, mut count) = (Cycles::of(joint), 0_u32);
            let motion = pass(duration_s);
            torques(&scene.settings, &motion, duration_s, TICKS_HZ, |t, nm| {
                count += u32::from(cycles.see(t, nm).is_some());
                ticks_nm.push(nm);
            });
            count
        };
        Ok(Box::new(Pass {
            count: count(PASS_S, &mut ticks_nm),
            slow_count: count(SLOW_PASS_S, &mut Vec::new()),
            exact_nm: rms_nm(&held, ticks_nm),
            drop_nm: joint.static_torque_nm - joint.kinetic_torque_nm,
            held,
        }))
    }
}

/// From turn to turn in this time.
fn pass(duration_s: f64) -> Motion {
    Motion::sine(45_f64.to_radians(), 0.5 / duration_s, -90.0)
}

/// Error of torques that are shown from their tick to the next, N·m.
fn rms_nm(held: &HeldTorque, ticks_nm: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (n, shown_nm) in ticks_nm.into_iter().enumerate() {
        if let Some(tick) = held.tick(n) {
            sum += tick.mean_square(shown_nm);
            count += 1.0;
        }
    }
    f64::sqrt(sum / count)
}

struct Pass {
    count: u32,
    slow_count: u32,
    exact_nm: f64,
    drop_nm: f64,
    held: HeldTorque,
}

impl Prepared for Pass {
    fn demanded(&self) -> Vec<Demand> {
        vec![
            Demand::itself(f64::from(self.count)),
            Demand::itself(f64::from(self.slow_count)),
            Demand::beside(self.exact_nm, self.drop_nm),
        ]
    }

    fn refinements(&self) -> &[u32] {
        &[2, 8]
    }

    fn measure(&self, runner: &Runner<'_>) -> Result<Vec<Reading>, SettingsError> {
        let (count, ticks_nm) = passed(runner, PASS_S)?;
        let (slow_count, _) = passed(runner, SLOW_PASS_S)?;
        let cycles = |count: u32| {
            Reading::but(
                f64::from(count),
                count == 0,
                "does not grate: no cycle in a pass",
            )
        };
        Ok(vec![
            cycles(count),
            cycles(slow_count),
            Reading::of(rms_nm(&self.held, ticks_nm)),
        ])
    }
}

/// Cycles of a pass, and the torque at each tick from the first on, N·m.
fn passed(runner: &Runner<'_>, duration_s: f64) -> Result<(u32, Vec<f64>), SettingsError> {
    let mut ride = runner.start(0.0)?;
    let mut cycles = Cycles::of(runner.joint);
    let (mut count, mut part) = (0_u32, 0);
    let mut ticks_nm = vec![0.0];
    let piece = pass(duration_s).piece(0.0);
    ride.follow(
        duration_s,
        |time_s| piece.angle_and_velocity(time_s),
        |time_s, torque_nm| {
            count += u32::from(cycles.see(time_s, torque_nm).is_some());
            part += 1;
            if part == runner.parts {
                part = 0;
                ticks_nm.push(torque_nm);
            }
        },
    );
    Ok((count, ticks_nm))
}
