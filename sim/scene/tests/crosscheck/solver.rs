//! The joint from event to event.
//!
//! ```text
//! stick    θ = θ₀ + φ − φ₀      T = kr·θ            (`physical`: + J·Ω̇ + c·Ω)
//! slip s   J·θ̈ + c·θ̇ + kr·θ = s·Tk, until s·(Ω − θ̇) falls to zero
//! ```
//! This file holds the joint's numbers and code shared by all phases; `stick`,
//! `slip` and `frozen` beside it are the phases, `boundary` the boundaries of
//! the motion's pieces.

mod boundary;
mod frozen;
mod slip;
mod stick;

use crate::double_double::Dd;
use crate::event::{Cause, Event, History, Unsolved};
use crate::rounding::Rounding;
use crate::series::Series;
use crate::shaft::{Changes, Shaft, longest_s, speed_size_rad_s};
use crate::swing::Object;
use crepitus_model::{Convention, EventKind, Restart, Settings};
use crepitus_plant::{Motion, Piece};

/// Relative tolerance of a torque at Ts: far above the rounding of 31 digits,
/// far below that of 16.
const AT_LIMIT: f64 = 1e-24;
/// The most steps of a solution.
const MOST_STEPS: u32 = 400_000;
/// The most events at one time.
const MOST_AT_ONCE: usize = 8;

/// A problem to solve.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// The joint.
    pub settings: &'a Settings,
    /// The motion of the shaft.
    pub motion: &'a Motion,
    /// Duration, s.
    pub duration_s: f64,
    /// The most events to find.
    pub most_events: usize,
}

/// The numbers of the joint.
#[derive(Clone, Copy, Debug)]
struct Joint {
    inertia: Dd,
    stiffness: Dd,
    damping: Dd,
    kinetic_nm: Dd,
    static_nm: Dd,
    /// J and c as far as the torque of a stick includes them.
    stick_inertia: Dd,
    stick_damping: Dd,
    convention: Convention,
    restart: Restart,
    object: Object,
}

/// State of the object. Senses are ±1.
#[derive(Clone, Copy, Debug)]
enum Phase {
    /// The object moves with the shaft; `fresh` where the torque may begin at a limit.
    Stick { fresh: bool },
    /// `paper`: kr·θ is beyond the limit of this sense, and a slip cannot
    /// begin.
    Held(f64),
    /// The object slips; how the gap s·(Ω − θ̇) begins.
    Slip { sense: f64, gap: Gap },
}

/// Beginning of the gap s·(Ω − θ̇) of a slip.
#[derive(Clone, Copy, Debug)]
enum Gap {
    /// Gap above zero.
    Open,
    /// Gap at zero, with this slope, rad/s².
    Opening(Dd),
}

/// A solution in progress.
struct Solver<'a> {
    problem: Problem<'a>,
    joint: Joint,
    changes: Changes,
    rounding: Rounding,
    piece: Piece,
    end_s: Dd,
    time_s: Dd,
    theta: Dd,
    /// Velocity of the object in a slip, rad/s.
    v: Dd,
    phase: Phase,
    history: History,
    steps: u32,
}

/// Solves a problem, with 31 digits.
///
/// # Errors
/// [`Unsolved`] where even 31 digits do not decide.
pub fn solve(problem: Problem<'_>) -> Result<History, Unsolved> {
    solve_rounded(problem, Rounding::none())
}

/// Solves a problem whose numbers are changed by `rounding`.
///
/// # Errors
/// As [`solve`].
pub fn solve_rounded(problem: Problem<'_>, mut rounding: Rounding) -> Result<History, Unsolved> {
    let joint = Joint::new(problem.settings, &mut rounding);
    let changes = Changes([(); 6].map(|()| rounding.change(1.0)));
    let mut solver = Solver {
        piece: problem.motion.piece(0.0),
        end_s: Dd::new(problem.duration_s),
        problem,
        joint,
        changes,
        rounding,
        time_s: Dd::ZERO,
        theta: Dd::ZERO,
        v: Dd::ZERO,
        phase: Phase::Stick { fresh: true },
        history: History::default(),
        steps: 0,
    };
    solver.run()?;
    Ok(solver.history)
}

impl Joint {
    fn new(settings: &Settings, rounding: &mut Rounding) -> Self {
        let p = &settings.parameters;
        let mut near = |x: f64| Dd::new(x) + Dd::new(rounding.change(x));
        let (inertia, stiffness, damping) = (
            near(p.inertia_kg_m2),
            near(p.stiffness_nm_per_rad),
            near(p.damping_nms_per_rad),
        );
        let static_nm = near(p.static_torque_nm);
        let kinetic_nm = if p.kinetic_torque_nm == p.static_torque_nm {
            static_nm
        } else {
            near(p.kinetic_torque_nm).min(static_nm)
        };
        let physical = settings.convention == Convention::Physical;
        let counts = |x: Dd| if physical { x } else { Dd::ZERO };
        Self {
            inertia,
            stiffness,
            damping,
            kinetic_nm,
            static_nm,
            stick_inertia: counts(inertia),
            stick_damping: counts(damping),
            convention: settings.convention,
            restart: settings.restart,
            object: Object {
                damping_per_s: damping / inertia,
                stiffness_per_s2: stiffness / inertia,
            },
        }
    }

    /// The torque that a stick requires, as a series.
    fn required(&self, theta: Dd, shaft: &Shaft) -> Series {
        Self::torque(
            self.stiffness,
            self.stick_inertia,
            self.stick_damping,
            theta,
            shaft,
        )
    }

    /// kr·θ + J·Ω̇ + c·Ω of a stick, under any convention.
    fn true_torque(&self, theta: Dd, shaft: &Shaft) -> Series {
        Self::torque(self.stiffness, self.inertia, self.damping, theta, shaft)
    }

    fn torque(stiffness: Dd, inertia: Dd, damping: Dd, theta: Dd, shaft: &Shaft) -> Series {
        let mut torque = shaft.turned.plus(theta).times(stiffness);
        if inertia != Dd::ZERO {
            torque = torque.combine(Dd::ONE, &shaft.omega_dot, inertia);
        }
        if damping != Dd::ZERO {
            torque = torque.combine(Dd::ONE, &shaft.omega, damping);
        }
        torque
    }

    /// A torque held within ±Ts: what is shown.
    fn shown(&self, torque_nm: Dd) -> Dd {
        if torque_nm.abs() > self.static_nm {
            self.static_nm * torque_nm.sign()
        } else {
            torque_nm
        }
    }

    /// Returns whether a torque is beyond the static limit by more than 31 digits can
    /// be wrong, given what else it may be wrong by.
    fn is_beyond(&self, torque_nm: Dd, doubt_nm: f64) -> bool {
        let slack = AT_LIMIT * self.static_nm.to_f64() + doubt_nm;
        (torque_nm.abs() - self.static_nm).to_f64() > slack
    }
}

/// A sense as events have it.
#[expect(clippy::cast_possible_truncation, reason = "−1, 0 or 1")]
fn sign(sense: f64) -> i8 {
    sense as i8
}

impl Solver<'_> {
    fn run(&mut self) -> Result<(), Unsolved> {
        self.start()?;
        while self.time_s < self.end_s && self.history.events.len() < self.problem.most_events {
            let at_end = match self.phase {
                Phase::Stick { fresh } => self.stick(fresh)?,
                Phase::Held(sense) => self.held(sense)?,
                Phase::Slip { sense, gap } => {
                    if self.joint.convention == Convention::Frozen {
                        self.frozen_slip(sense);
                        false
                    } else {
                        self.slip(sense, gap)?
                    }
                }
            };
            if at_end && self.time_s < self.end_s {
                self.cross()?;
            }
            self.check()?;
        }
        Ok(())
    }

    /// Rejects a solution without progress.
    fn check(&mut self) -> Result<(), Unsolved> {
        self.steps += 1;
        let time_s = self.time_s.to_f64();
        if self.steps > MOST_STEPS {
            return Err(Unsolved::TooLong {
                steps: MOST_STEPS,
                time_s,
            });
        }
        let events = &self.history.events;
        if let Some(index) = events.len().checked_sub(MOST_AT_ONCE) {
            let passed = (self.time_s - events[index].time_s).to_f64();
            if passed < 1e-26 * time_s {
                return Err(Unsolved::PileUp { time_s });
            }
        }
        Ok(())
    }

    /// The end of this piece or of the problem, s.
    fn horizon_s(&self) -> Dd {
        if self.piece.end_s < self.end_s.to_f64() {
            Dd::new(self.piece.end_s)
        } else {
            self.end_s
        }
    }

    /// The next step: how long at most, s, and whether it ends at the horizon.
    fn reach_s(&self) -> Dd {
        let rest = self.horizon_s() - self.time_s;
        let longest = longest_s(&self.piece);
        if rest.to_f64() > longest {
            Dd::new(longest)
        } else {
            rest
        }
    }

    fn shaft(&self, length_s: Dd) -> Shaft {
        Shaft::new(&self.piece, &self.changes, self.time_s, length_s)
    }

    /// Advances to a time, after a step: exactly to the horizon if that was
    /// intended.
    fn pass(&mut self, length_s: Dd) -> bool {
        let horizon = self.horizon_s();
        let next = self.time_s + length_s;
        let at_end = (horizon - next).to_f64() <= 1e-29 * horizon.to_f64();
        self.time_s = if at_end { horizon } else { next };
        at_end
    }

    /// The angle and the time as an f64 solver might have them. A stick
    /// follows φ, which is as large as it becomes in this piece.
    fn round_state(&mut self) {
        let joint = &self.joint;
        let at = |time_s: Dd| self.piece.at(time_s.to_f64()).phi_rad.abs();
        let size = (self.theta.to_f64().abs())
            .max(at(self.time_s))
            .max(at(self.horizon_s()))
            .max((joint.static_nm / joint.stiffness).to_f64());
        self.theta += Dd::new(self.rounding.change(size));
        let later = self.rounding.change(self.time_s.to_f64());
        let time_s = self.time_s + Dd::new(later);
        // An event stays in its piece.
        if time_s.to_f64() > self.piece.start_s && time_s < self.horizon_s() {
            self.time_s = time_s;
        }
    }

    /// Reports a change to stick.
    fn report_stick(&mut self, cause: Cause, from: f64, omega: Dd, required: Dd, certain: Certain) {
        let joint = &self.joint;
        self.history.events.push(Event {
            kind: EventKind::Stick,
            cause,
            time_s: self.time_s,
            from: sign(from),
            to: 0,
            theta_rad: self.theta,
            theta_dot_rad_s: omega,
            omega_rad_s: omega,
            torque_before_nm: Some(joint.kinetic_nm * from),
            torque_after_nm: joint.shown(required),
            half_width_s: certain.half_width_s,
            excess: certain.excess,
        });
    }

    /// Begins a slip and reports it.
    fn begin_slip(&mut self, start: SlipStart) -> Result<(), Unsolved> {
        let joint = &self.joint;
        if let Gap::Opening(slope) = start.gap
            && slope < Dd::ZERO
        {
            return Err(Unsolved::Inconsistent {
                time_s: self.time_s.to_f64(),
            });
        }
        self.history.events.push(Event {
            kind: if start.from == 0.0 {
                EventKind::Break
            } else {
                EventKind::Reverse
            },
            cause: start.cause,
            time_s: self.time_s,
            from: sign(start.from),
            to: sign(start.to),
            theta_rad: self.theta,
            theta_dot_rad_s: start.v,
            omega_rad_s: start.omega,
            torque_before_nm: start.before.map(|t| joint.shown(t)),
            torque_after_nm: joint.kinetic_nm * start.to,
            half_width_s: start.certain.half_width_s,
            excess: start.certain.excess,
        });
        self.v = start.v;
        self.phase = Phase::Slip {
            sense: start.to,
            gap: start.gap,
        };
        self.round_state();
        if self.rounding.is_some()
            && self.time_s < self.horizon_s()
            && let Gap::Opening(_) = start.gap
        {
            // Equal velocities at a rounded time: Ω may change fast.
            let size = speed_size_rad_s(&self.piece, self.time_s);
            self.v = self.shaft_now().0 + Dd::new(self.rounding.change(size));
        }
        Ok(())
    }
}

/// Separation of an event.
#[derive(Clone, Copy, Debug, Default)]
struct Certain {
    half_width_s: f64,
    excess: Option<f64>,
}

/// The beginning of a slip.
#[derive(Clone, Copy, Debug)]
struct SlipStart {
    cause: Cause,
    from: f64,
    to: f64,
    /// Velocity of the object, rad/s.
    v: Dd,
    /// Velocity of the shaft, rad/s.
    omega: Dd,
    gap: Gap,
    /// Torque before, N·m.
    before: Option<Dd>,
    certain: Certain,
}
