//! A weight that swings in the brace, for a fit: the angle of the rotor, smooth in every parameter.
//!
//! ```text
//! motor, gear          gap           brace      cuffs      weight
//!   τ ─> [J_r] ──────[  β  ]──────── [J_b] ──[ k, b ]──── [J_w] ── −M·sin φ − B·Ω
//!    F + μ·|τ|
//! ```
//!
//! J_r·Ω̇_r = τ − (F + μ|τ|)·sgn Ω_r − N,  J_b·Ω̇_b = N − P,  J_w·Ω̇_w = P − B·Ω_w − M·sin(φ_w − φ₀)
//!
//! with P = k(φ_b − φ_w) + b(Ω_b − Ω_w), and N the force of the teeth. The parts are
//! [`drivetrain`](crate::effects::drivetrain), [`backlash`](crate::effects::backlash),
//! [`cuff`](crate::effects::cuff) and a [`limb`](crate::effects::limb) without passive moment: the
//! [chain](crate::chain) of these parts, released, is the same brace.
//!
//! A real brace has more: [`Imperfections`]. A fit marginalises over them.
//!
//! Only the solver differs. A fit follows a swing thousands of times, and differentiates the angle by
//! differences. So steps are ten times as long as a tick, by Runge-Kutta of the fourth order between
//! the events, which are located within a step: that keeps the angle smooth.

// All functions are `#[inline]`: the package of a fit compiles them with its own optimisation.

mod imperfections;

pub use imperfections::{BY_ANGLE, Imperfections};

use crate::effects::drivetrain::Gear;

/// Integration step, s.
pub const STEP_S: f64 = 5e-4;

/// Most changes of mode in one step; the rest of the step is integrated in the last mode.
const MOST_CHANGES: u32 = 24;

/// Damping ratios of the teeth, and of what gives way before friction slips.
const TEETH_RATIO: f64 = 0.4;
const PRESLIDING_RATIO: f64 = 0.3;

/// Largest angle that a mode turns by in a step, rad: stiffer springs are as stiff as that.
const STIFFEST: f64 = 1.8;

/// A brace with a weight in its cuffs, all referred to the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedBrace {
    /// Rotor, and losses of the gear.
    pub gear: Gear,
    /// Lost motion of the gear, rad.
    pub gap_rad: f64,
    /// Inertia of the brace between gear and cuffs, kg·m².
    pub brace_kg_m2: f64,
    /// Stiffness of the cuffs, N·m/rad.
    pub stiffness_nm: f64,
    /// Damping of the cuffs, N·m·s/rad.
    pub damping_nms: f64,
    /// Moment of the weight when it is horizontal, N·m.
    pub moment_nm: f64,
    /// Inertia of the weight about the axis, kg·m².
    pub weight_kg_m2: f64,
    /// Viscous damping about the axis, N·m·s/rad.
    pub viscous_nms: f64,
    /// Imperfections of the brace.
    pub imperfections: Imperfections,
}

/// Angles and velocities of rotor, brace and weight.
#[derive(Clone, Copy, Debug, PartialEq)]
struct State {
    angle: [f64; 3],
    omega: [f64; 3],
}

const ROTOR: usize = 0;
const BRACE: usize = 1;
const WEIGHT: usize = 2;

impl State {
    #[inline]
    fn moved(&self, by: f64, rate: &Self) -> Self {
        Self {
            angle: std::array::from_fn(|i| self.angle[i] + by * rate.angle[i]),
            omega: std::array::from_fn(|i| self.omega[i] + by * rate.omega[i]),
        }
    }
}

/// State of friction and teeth.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mode {
    /// Sign of the rotor's velocity; `None` if friction holds it.
    sliding: Option<f64>,
    /// Sign of φ_r − φ_b where the gap is closed; `None` if it is open.
    contact: Option<f64>,
    /// Angle at which a friction that gives way has no torque while it holds, rad.
    anchor_rad: f64,
}

/// Initial state of a swing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Begin {
    /// Angle of the rotor, rad.
    pub angle_rad: f64,
    /// Velocity of the rotor, rad/s.
    pub omega_rad_s: f64,
    /// Deflection of the cuffs, φ_b − φ_w, beyond that of a steady motion, rad.
    pub deflection_rad: f64,
    /// Rate of that deflection, rad/s.
    pub deflection_rad_s: f64,
}

/// The brace with the torque of one step.
struct Step<'b> {
    n: &'b WeightedBrace,
    /// Angle at which the weight hangs at rest, rad.
    hang_rad: f64,
    /// Torque of the motor, N·m.
    torque: f64,
    /// Coulomb friction, N·m.
    limit: f64,
    /// Stiffness and damping of the teeth; `None` where they are rigid.
    teeth: Option<(f64, f64)>,
    /// Stiffness and damping of a friction that holds; `None` where it is rigid.
    presliding: Option<(f64, f64)>,
    /// Stiffness of the cuffs, N·m/rad.
    cuffs_nm: f64,
}

impl<'b> Step<'b> {
    #[inline]
    fn new(n: &'b WeightedBrace, hang_rad: f64, torque: f64) -> Self {
        let (rotor, brace) = (n.gear.inertia_kg_m2, n.brace_kg_m2);
        let spring = |compliance: f64, inertia: f64, ratio: f64| {
            (compliance > 0.0).then(|| {
                let stiffness = (1.0 / compliance).min(inertia * (STIFFEST / STEP_S).powi(2));
                (stiffness, 2.0 * ratio * (stiffness * inertia).sqrt())
            })
        };
        let extra = &n.imperfections;
        Self {
            n,
            hang_rad,
            torque,
            limit: n.gear.limit_nm(torque),
            teeth: spring(
                extra.teeth_rad_per_nm,
                rotor * brace / (rotor + brace),
                TEETH_RATIO,
            ),
            presliding: spring(extra.presliding_rad_per_nm, rotor, PRESLIDING_RATIO),
            cuffs_nm: n.stiffness_nm.min(brace * (STIFFEST / STEP_S).powi(2)),
        }
    }

    /// Returns the friction that the rotor slides against at a velocity, N·m.
    #[inline]
    fn limit_at(&self, angle_rad: f64, omega_rad_s: f64) -> f64 {
        let share = self
            .n
            .imperfections
            .friction_share(angle_rad - self.hang_rad, omega_rad_s);
        self.limit * share
    }

    /// Returns the torque of a friction that holds and gives way, without its damping, N·m.
    #[inline]
    fn held(&self, x: &State, mode: Mode) -> f64 {
        let stiffness = self.presliding.map_or(0.0, |spring| spring.0);
        stiffness * (x.angle[ROTOR] - mode.anchor_rad)
    }

    /// Returns how far the teeth have given way, in the sense of the contact, rad.
    #[inline]
    fn pressed(&self, x: &State, side: f64) -> f64 {
        side * (x.angle[ROTOR] - x.angle[BRACE]) - 0.5 * self.n.gap_rad
    }

    /// Returns the torque of the cuffs on the brace, N·m.
    #[inline]
    fn pull(&self, x: &State) -> f64 {
        -self.cuffs_nm * (x.angle[BRACE] - x.angle[WEIGHT])
            - self.n.damping_nms * (x.omega[BRACE] - x.omega[WEIGHT])
    }

    #[inline]
    fn rate(&self, x: &State, mode: Mode) -> State {
        let n = self.n;
        let rotor_kg_m2 = n.gear.inertia_kg_m2;
        let pull = self.pull(x);
        let weight = (-pull
            - n.viscous_nms * x.omega[WEIGHT]
            - n.moment_nm * (x.angle[WEIGHT] - self.hang_rad).sin())
            / n.weight_kg_m2;
        // Motor and friction; none where friction holds the rotor rigidly.
        let driven = match (mode.sliding, self.presliding) {
            (Some(sense), _) => {
                Some(self.torque - sense * self.limit_at(x.angle[ROTOR], x.omega[ROTOR]))
            }
            (None, Some((_, damping))) => {
                Some(self.torque - self.held(x, mode) - damping * x.omega[ROTOR])
            }
            (None, None) => None,
        };
        let (rotor, brace) = match (mode.contact, self.teeth) {
            (Some(side), Some((stiffness, damping))) => {
                let closing = side * (x.omega[ROTOR] - x.omega[BRACE]);
                // They do not pull.
                let force = side * (stiffness * self.pressed(x, side) + damping * closing).max(0.0);
                let rotor = driven.map_or(0.0, |driven| (driven - force) / rotor_kg_m2);
                (rotor, (force + pull) / n.brace_kg_m2)
            }
            (Some(_), None) => {
                let both = driven.map_or(0.0, |driven| {
                    (driven + pull) / (rotor_kg_m2 + n.brace_kg_m2)
                });
                (both, both)
            }
            (None, _) => (
                driven.map_or(0.0, |driven| driven / rotor_kg_m2),
                pull / n.brace_kg_m2,
            ),
        };
        State {
            angle: x.omega,
            omega: [rotor, brace, weight],
        }
    }

    #[inline]
    fn after(&self, x: &State, mode: Mode, h: f64) -> State {
        let a = self.rate(x, mode);
        let b = self.rate(&x.moved(0.5 * h, &a), mode);
        let c = self.rate(&x.moved(0.5 * h, &b), mode);
        let d = self.rate(&x.moved(h, &c), mode);
        x.moved(h / 6.0, &a)
            .moved(h / 3.0, &b)
            .moved(h / 3.0, &c)
            .moved(h / 6.0, &d)
    }

    /// Returns the distance to each event; the mode ends where one is below zero.
    #[inline]
    fn margins(&self, x: &State, mode: Mode) -> [f64; 2] {
        let friction = match (mode.sliding, self.presliding) {
            (Some(sense), _) => sense * x.omega[ROTOR],
            (None, Some(_)) => self.limit_at(x.angle[ROTOR], 0.0) - self.held(x, mode).abs(),
            (None, None) => self.limit_at(x.angle[ROTOR], 0.0) - self.net(x, mode).abs(),
        };
        let teeth = match (mode.contact, self.teeth) {
            (None, _) => 0.5 * self.n.gap_rad - (x.angle[ROTOR] - x.angle[BRACE]).abs(),
            (Some(side), Some(_)) => self.pressed(x, side),
            (Some(side), None) => {
                side * (self.n.brace_kg_m2 * self.rate(x, mode).omega[BRACE] - self.pull(x))
            }
        };
        [friction, teeth]
    }

    /// Ends the sliding in a sense at rest: friction holds, where it can.
    #[inline]
    fn hold(&self, x: &State, mode: &mut Mode, sense: f64) {
        let limit = self.limit_at(x.angle[ROTOR], 0.0);
        if let Some((stiffness, _)) = self.presliding {
            // A rounding less than the limit, which it would pass at once.
            mode.anchor_rad = x.angle[ROTOR] - sense * limit * (1.0 - 1e-9) / stiffness;
            mode.sliding = None;
            return;
        }
        let net = self.net(x, *mode);
        mode.sliding = (net.abs() > limit).then(|| net.signum());
    }

    /// Changes the mode at an event.
    #[inline]
    fn change(&self, x: &mut State, mode: &mut Mode, event: usize) {
        let is_rigid = self.teeth.is_none();
        if event == 0 {
            match (mode.sliding, self.presliding) {
                (Some(sense), _) => {
                    x.omega[ROTOR] = 0.0;
                    if mode.contact.is_some() && is_rigid {
                        x.omega[BRACE] = 0.0;
                    }
                    self.hold(x, mode, sense);
                }
                (None, Some(_)) => mode.sliding = Some(self.held(x, *mode).signum()),
                (None, None) => mode.sliding = Some(self.net(x, *mode).signum()),
            }
            return;
        }
        if mode.contact.is_some() {
            mode.contact = None;
            return;
        }
        let n = self.n;
        let side = (x.angle[ROTOR] - x.angle[BRACE]).signum();
        mode.contact = Some(side);
        if !is_rigid {
            return;
        }
        let rotor_kg_m2 = n.gear.inertia_kg_m2;
        let both = (rotor_kg_m2 * x.omega[ROTOR] + n.brace_kg_m2 * x.omega[BRACE])
            / (rotor_kg_m2 + n.brace_kg_m2);
        x.angle[ROTOR] = x.angle[BRACE] + side * 0.5 * n.gap_rad;
        x.omega[ROTOR] = both;
        x.omega[BRACE] = both;
        match mode.sliding {
            Some(sense) if self.presliding.is_some() && both * sense < 0.0 => {
                self.hold(x, mode, sense);
            }
            _ if self.presliding.is_none() && both != 0.0 => mode.sliding = Some(both.signum()),
            _ => {}
        }
    }

    /// Returns the torque on the rotor without friction, N·m.
    #[inline]
    fn net(&self, x: &State, mode: Mode) -> f64 {
        self.torque
            + match (mode.contact, self.teeth) {
                (Some(_), None) => self.pull(x),
                (Some(side), Some((stiffness, damping))) => {
                    let closing = side * (x.omega[ROTOR] - x.omega[BRACE]);
                    -side * (stiffness * self.pressed(x, side) + damping * closing).max(0.0)
                }
                (None, _) => 0.0,
            }
    }

    /// Advances the state by one step.
    #[inline]
    fn go(&self, x: &mut State, mode: &mut Mode) {
        let mut left = STEP_S;
        for _ in 0..MOST_CHANGES {
            let before = self.margins(x, *mode);
            // A step of the torque can end a mode at once; a gap that has just opened, or
            // a motion that has just begun, is at zero and goes on.
            let at_once = match (before[0] < 0.0, before[1] < 0.0) {
                (true, _) if mode.sliding.is_none() => Some(0),
                (_, true) if mode.contact.is_some() => Some(1),
                _ => None,
            };
            if let Some(event) = at_once {
                self.change(x, mode, event);
                continue;
            }
            let next = self.after(x, *mode, left);
            let after = self.margins(&next, *mode);
            let first = (0..2)
                .filter(|event| after[*event] < 0.0)
                .map(|event| {
                    (
                        self.end(x, *mode, event, before[event], after[event], left),
                        event,
                    )
                })
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((at, event)) = first else {
                *x = next;
                return;
            };
            *x = self.after(x, *mode, at);
            self.change(x, mode, event);
            left -= at;
            if left <= 1e-12 {
                return;
            }
        }
        *x = self.after(x, *mode, left);
    }

    /// Returns the time at which a margin passes zero, s, by regula falsi (Illinois).
    #[inline]
    fn end(&self, x: &State, mode: Mode, event: usize, low: f64, high: f64, length: f64) -> f64 {
        let (mut a, mut b) = ((0.0, low.max(0.0)), (length, high));
        for _ in 0..30 {
            let at = if a.1 - b.1 > 0.0 {
                a.0 + (b.0 - a.0) * a.1 / (a.1 - b.1)
            } else {
                f64::midpoint(a.0, b.0)
            };
            // From zero on, the root that counts is the later one.
            let at = if a.1 == 0.0 {
                f64::midpoint(a.0, b.0)
            } else {
                at
            };
            let margin = self.margins(&self.after(x, mode, at), mode)[event];
            if margin < 0.0 {
                b = (at, margin);
                a.1 *= 0.5;
            } else {
                a = (at, margin);
                b.1 *= 0.5;
            }
            if b.0 - a.0 < 1e-9 * STEP_S || margin.abs() < 1e-13 {
                break;
            }
        }
        b.0
    }
}

/// Simulates a swing about `hang_rad`, where the weight hangs; returns the rotor's angle after each
/// step, rad. `torques_nm` is the motor's torque in each step, N·m.
#[inline]
pub fn swing(brace: &WeightedBrace, hang_rad: f64, begin: &Begin, torques_nm: &[f64]) -> Vec<f64> {
    let step = |torque: f64| Step::new(brace, hang_rad, torque);
    let first = torques_nm.first().copied().unwrap_or(0.0);
    let (mut x, mut mode) = start(&step(first), begin);
    (torques_nm.iter())
        .map(|torque| {
            step(*torque).go(&mut x, &mut mode);
            x.angle[ROTOR]
        })
        .collect()
}

/// Returns the initial state: rotor and brace turn together, the cuffs are deflected by the torque
/// that they transmit.
#[inline]
fn start(step: &Step<'_>, begin: &Begin) -> (State, Mode) {
    let n = step.n;
    let sense = begin.omega_rad_s.signum();
    let (angle, omega) = (begin.angle_rad, begin.omega_rad_s);
    let sum = n.gear.inertia_kg_m2 + n.brace_kg_m2 + n.weight_kg_m2;
    let dry = step.torque - sense * step.limit_at(angle, omega);
    // The acceleration of all as one body, about where the weight is.
    let fall = -n.moment_nm * (angle - step.hang_rad).sin() - n.viscous_nms * omega;
    let together = (dry + fall) / sum;
    // What the teeth do to the brace: the rotor's share of that is its own.
    let teeth = dry - n.gear.inertia_kg_m2 * together;
    let side = if teeth >= 0.0 { 1.0 } else { -1.0 };
    // The cuffs transmit what accelerates the weight beyond its fall.
    let transmitted = n.weight_kg_m2 * together - fall;
    // The teeth, too, have given way.
    let pressed = step
        .teeth
        .map_or(0.0, |(stiffness, _)| teeth.abs() / stiffness);
    let brace = angle - side * (0.5 * n.gap_rad + pressed);
    let bent = transmitted / step.cuffs_nm + begin.deflection_rad;
    (
        State {
            angle: [angle, brace, brace - bent],
            omega: [omega, omega, omega - begin.deflection_rad_s],
        },
        Mode {
            sliding: Some(sense),
            contact: Some(side),
            anchor_rad: angle,
        },
    )
}

#[cfg(test)]
mod tests;
