//! A plant from names and numbers, stepped as a scene steps it.

use crepitus_plant::actuator::{Actuator, Commanded};
use crepitus_plant::assembly::{Listed, assemble, assemble_with};
use crepitus_plant::boundary::MotionStep;
use crepitus_plant::chain::Body;
use crepitus_plant::effect::{Context, Given};
use crepitus_plant::effects::EFFECTS;
use crepitus_plant::effects::motor::bridge::Bridge;
use crepitus_plant::effects::motor::{self, MotorNumbers};
use crepitus_plant::plant::Coil;
use crepitus_plant::{Motion, Piece, Plant};
use proptest::test_runner::{Config, RngSeed};
use std::fmt::{self, Debug, Formatter};

/// The device's tick.
pub(crate) const TICK_S: f64 = 5e-5;
const TICKS_PER_S: f64 = 20_000.0;

/// A configuration of `cases` cases, the same ones in every run.
///
/// `PROPTEST_CASES` asks for another number of them, and `PROPTEST_RNG_SEED`
/// for others.
pub(crate) fn cases(cases: u32) -> Config {
    let number = |name| std::env::var(name).ok().and_then(|n| n.parse::<u64>().ok());
    Config {
        cases: number("PROPTEST_CASES").map_or(cases, |n| u32::try_from(n).unwrap_or(u32::MAX)),
        rng_seed: RngSeed::Fixed(number("PROPTEST_RNG_SEED").unwrap_or(1)),
        failure_persistence: None,
        ..Config::default()
    }
}

/// Effects by name, with the numbers that differ from the defaults.
#[derive(Clone)]
pub(crate) struct Build {
    listed: Vec<Listed>,
    start: Option<Body>,
    released: bool,
    substeps: u32,
}

impl Debug for Build {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for Listed { effect, given } in &self.listed {
            let keys = effect.parameters.iter().map(|p| p.key);
            let numbers: Vec<_> = keys.zip(&given.numbers).collect();
            write!(f, "{} {numbers:?} {:?}; ", effect.name, given.choices)?;
        }
        let Self {
            start, released, ..
        } = self;
        write!(f, "start {start:?}, released {released}")
    }
}

impl Build {
    pub(crate) fn of(effects: &[(&str, &[(&str, f64)])]) -> Self {
        let mut build = Self {
            listed: Vec::new(),
            start: None,
            released: false,
            substeps: 1,
        };
        for (name, numbers) in effects {
            build = build.with(name, numbers);
        }
        build
    }

    pub(crate) fn with(mut self, name: &str, numbers: &[(&str, f64)]) -> Self {
        let place = |name| EFFECTS.iter().position(|e| e.name == name).expect(name);
        let effect = EFFECTS[place(name)];
        let mut given = Given::defaults(effect);
        for (key, value) in numbers {
            let i = effect.parameters.iter().position(|p| p.key == *key);
            given.numbers[i.expect(key)] = *value;
        }
        self.listed.push(Listed { effect, given });
        self.listed.sort_by_key(|l| place(l.effect.name));
        self
    }

    pub(crate) fn choosing(mut self, effect: &str, key: &str, name: &str) -> Self {
        let listed = self.listed.iter_mut().find(|l| l.effect.name == effect);
        let listed = listed.expect(effect);
        let choices = listed.effect.choices;
        let i = choices.iter().position(|c| c.key == key).expect(key);
        let chosen = (0..).zip(choices[i].names).find(|(_, n)| **n == name);
        listed.given.choices[i] = chosen.expect(name).0;
        self
    }

    /// The right end begins like this, and not as the motion does.
    pub(crate) fn starting(mut self, angle_rad: f64, omega_rad_s: f64) -> Self {
        self.start = Some(Body {
            angle_rad,
            omega_rad_s,
        });
        self
    }

    /// Releases the right end: nobody holds it.
    pub(crate) fn released(mut self) -> Self {
        self.released = true;
        self
    }

    /// Each tick is gone through in so many steps.
    pub(crate) fn substeps(mut self, substeps: u32) -> Self {
        self.substeps = substeps;
        self
    }

    /// Width of the backlash; zero if there is none.
    pub(crate) fn gap_rad(&self) -> f64 {
        self.listed
            .iter()
            .find(|l| l.effect.name == "backlash")
            .map_or(0.0, |l| l.given.numbers[0].to_radians())
    }

    pub(crate) fn on(&self, motion: Motion) -> Rig {
        let context = self.context(&motion);
        let plant = assemble(&self.listed, &context, self.released);
        let plant = plant.expect("numbers within their ranges");
        self.rig(plant, motion)
    }

    /// [`Self::on`] with a bridge that the test switches, on the motor's winding.
    pub(crate) fn on_bridge(&self, motion: Motion) -> Rig<Bridge> {
        let context = self.context(&motion);
        let listed = self.listed.iter().find(|l| l.effect.name == "motor");
        let motor = listed.map_or_else(
            || MotorNumbers::of(&Given::defaults(&motor::EFFECT)),
            |l| MotorNumbers::of(&l.given),
        );
        let bridge = Bridge::new(motor, TICK_S / f64::from(self.substeps));
        let plant = assemble_with(&self.listed, &context, self.released, bridge);
        self.rig(plant, motion)
    }

    fn context(&self, motion: &Motion) -> Context {
        Context {
            tick_s: TICK_S,
            gravity_rad: None,
            single: false,
            start: self.start.unwrap_or(body(&motion.piece(0.0), 0.0)),
        }
    }

    fn rig<A: Actuator>(&self, plant: Plant<A>, motion: Motion) -> Rig<A> {
        let piece = motion.piece(0.0);
        let columns = plant.columns();
        Rig {
            plant,
            motion,
            piece,
            parts: self.substeps,
            columns,
            steps: 0,
            now: body(&piece, 0.0),
            felt_nm: 0.0,
            mid: Vec::new(),
        }
    }

    /// Returns the rig on a motion that rests at 0.
    pub(crate) fn at_rest(&self) -> Rig {
        self.on(Motion::rest(0.0))
    }
}

fn body(piece: &Piece, time_s: f64) -> Body {
    let (angle_rad, omega_rad_s) = piece.angle_and_velocity(time_s);
    Body {
        angle_rad,
        omega_rad_s,
    }
}

/// A plant and the motion that it is stepped against.
pub(crate) struct Rig<A = Box<dyn Commanded>> {
    pub(crate) plant: Plant<A>,
    motion: Motion,
    piece: Piece,
    parts: u32,
    columns: Vec<&'static str>,
    steps: u64,
    /// The motion as the next step starts.
    pub(crate) now: Body,
    /// Mean of what the hand felt in the last tick, N·m.
    pub(crate) felt_nm: f64,
    /// The columns in the middle of the last tick, if a step ends there.
    mid: Vec<f64>,
}

impl<A: Commanded> Rig<A> {
    /// One tick with the device asking for `torque_nm`.
    pub(crate) fn tick(&mut self, torque_nm: f64) {
        self.tick_with(torque_nm, Coil::Driven(0.0));
    }

    /// One tick, with the bridge of the coil like this.
    pub(crate) fn tick_with(&mut self, torque_nm: f64, coil: Coil) {
        let felt = self.plant.felt_nms();
        self.plant.command(torque_nm, 0.0);
        self.plant.set_coil(coil);
        for part in 0..self.parts {
            if 2 * part == self.parts {
                self.mid.clear();
                self.plant.write(&mut self.mid);
            }
            self.step();
        }
        self.felt_nm = (self.plant.felt_nms() - felt) / TICK_S;
    }

    /// Some ticks with the same command.
    pub(crate) fn ticks(&mut self, ticks: u32, torque_nm: f64) {
        for _ in 0..ticks {
            self.tick(torque_nm);
        }
    }
}

impl<A: Actuator> Rig<A> {
    /// One step of a tick.
    pub(crate) fn step(&mut self) {
        self.steps += 1;
        let time_s = self.time_s();
        while self.piece.end_s < time_s {
            self.piece = self.motion.piece(self.piece.end_s);
        }
        let to = body(&self.piece, time_s);
        self.plant.advance(&MotionStep {
            length_s: TICK_S / f64::from(self.parts),
            from: self.now,
            to,
        });
        self.now = to;
        if self.piece.end_s == time_s {
            self.piece = self.motion.piece(time_s);
            if self.piece.jump {
                self.now = body(&self.piece, time_s);
                self.plant.jump(self.now.omega_rad_s);
            }
        }
    }

    /// The correctly rounded time, so that a knot at a tick is met.
    #[expect(clippy::cast_precision_loss, reason = "far below 2⁵³")]
    pub(crate) fn time_s(&self) -> f64 {
        self.steps as f64 / (TICKS_PER_S * f64::from(self.parts))
    }

    fn place(&self, column: &str) -> usize {
        self.columns
            .iter()
            .position(|c| *c == column)
            .expect(column)
    }

    /// A column of the trace now.
    pub(crate) fn get(&self, column: &str) -> f64 {
        self.row()[self.place(column)]
    }

    /// A column in the middle of the last tick.
    pub(crate) fn mid(&self, column: &str) -> f64 {
        self.mid[self.place(column)]
    }

    pub(crate) fn row(&self) -> Vec<f64> {
        let mut row = Vec::new();
        self.plant.write(&mut row);
        row
    }

    pub(crate) fn has(&self, column: &str) -> bool {
        self.columns.contains(&column)
    }

    pub(crate) fn shaft(&self) -> Body {
        self.plant.shaft()
    }

    pub(crate) fn leg(&self) -> Body {
        self.plant.leg()
    }

    /// A term of the energy balance since the start, J.
    pub(crate) fn joule(&self, effect: &str, what: &str) -> f64 {
        self.plant
            .balance()
            .terms()
            .iter()
            .find(|t| t.effect == effect && t.what == what)
            .expect(what)
            .joule
    }

    pub(crate) fn relative_residual(&self) -> f64 {
        self.plant.balance().relative_residual()
    }
}

/// A velocity that goes through (time, velocity) in straight lines.
pub(crate) fn through(points: &[(f64, f64)]) -> Motion {
    let knots: Vec<_> = points.iter().map(|&(t, v)| knot(t, v, v)).collect();
    Motion::velocity_knots(&knots)
}

pub(crate) fn knot(time_s: f64, left: f64, right: f64) -> crepitus_plant::motion::VelocityKnot {
    crepitus_plant::motion::VelocityKnot {
        time_s,
        omega_left_rad_s: left,
        omega_right_rad_s: right,
    }
}

/// Real and imaginary part.
pub(crate) type Complex = (f64, f64);

pub(crate) fn times((a, b): Complex, (c, d): Complex) -> Complex {
    (a * c - b * d, a * d + b * c)
}

pub(crate) fn over(a: Complex, (c, d): Complex) -> Complex {
    let (re, im) = times(a, (c, -d));
    let square = c * c + d * d;
    (re / square, im / square)
}

pub(crate) fn size((re, im): Complex) -> f64 {
    re.hypot(im)
}

/// Sine component of a signal, by least squares over all that was added.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Harmonic {
    ss: f64,
    sc: f64,
    cc: f64,
    ys: f64,
    yc: f64,
}

impl Harmonic {
    /// The signal's value where the sine has this angle.
    pub(crate) fn add(&mut self, angle_rad: f64, y: f64) {
        let (sin, cos) = angle_rad.sin_cos();
        self.ss += sin * sin;
        self.sc += sin * cos;
        self.cc += cos * cos;
        self.ys += y * sin;
        self.yc += y * cos;
    }

    /// y ≈ re·sin + im·cos: the response to a sine of size one.
    pub(crate) fn response(&self) -> Complex {
        let det = self.ss * self.cc - self.sc * self.sc;
        (
            (self.ys * self.cc - self.yc * self.sc) / det,
            (self.yc * self.ss - self.ys * self.sc) / det,
        )
    }
}

/// Point between `low` and `high` at which `f` changes sign.
pub(crate) fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rising = f(high) > 0.0;
    assert!((f(low) > 0.0) != rising, "no root between {low} and {high}");
    for _ in 0..200 {
        let mid = f64::midpoint(low, high);
        if (f(mid) > 0.0) == rising {
            high = mid;
        } else {
            low = mid;
        }
    }
    f64::midpoint(low, high)
}
