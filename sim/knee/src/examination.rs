//! # What an examination measures
//!
//! ```text
//!  samples ──┬─ strokes ──> speed, steadiness, smoothness ──┐
//!            ├─ means of 20 ms ──> peak speed, jerk          │
//!            ├─ catches, ends, beats of the torque           ├──> measures
//!            ├─ steps: slow, fast, hold, drop                │
//!            └─ guide: what shows this knee's signs ─────────┴──> findings
//! ```
//!
//! Sample by sample, in a fixed memory, and the only place that computes them: the panel, the monitor,
//! reports and Python all read [`Measure::ALL`].
//!
//! | measure | definition, with its source |
//! |---|---|
//! | range, flexion, extension deficit | angles from straight, which is 0° (Norkin and White, *Measurement of Joint Motion*); `ends.rs` |
//! | R1, R2 and R2 − R1 | catch of a fast stretch, end of a slow one, and the dynamic part between (Boyd and Graham 1999); `catches.rs`, `ends.rs` |
//! | beats | torque that comes and goes while the leg is held; `beats.rs` |
//! | steadiness, smoothness | of the last stroke (Enoka et al. 2003; Balasubramanian et al. 2015); `strokes.rs` |
//!
//! A torque above 0 opposes growing angle, as everywhere. Samples further apart than 15 ms break a
//! stroke off.

mod beats;
mod catches;
mod ends;
mod guide;
mod means;
mod measure;
mod passages;
mod signs;
mod steps;
mod strokes;
#[cfg(test)]
mod tests;

pub use guide::{Finding, Outcome};
pub use measure::{COUNT, Measure, MeasureSpec};
pub use signs::{Rule, Sign, signs};
pub use steps::Step;
pub use strokes::{Stroke, Strokes};

use beats::Beats;
use catches::{Catches, Felt};
use core::f64::consts::PI;
use crepitus_model::render::effects::EffectSettings;
use ends::Ends;
use guide::Guide;
use means::{Means, Motion};
use steps::Steps;
use strokes::MOST_RAD;

/// Speed that tells a fast stroke from a slow one, rad/s: 65 °/s, above V1 and below a fall.
const FAST_RAD_S: f64 = 65.0 * PI / 180.0;

/// Longest time from sample to sample, s: less than a mean takes.
const GAP_S: f64 = 0.015;

/// Largest angle from sample to sample, rad: beyond it is another zero.
const JUMP_RAD: f64 = 0.3;

/// Time constant of the torque that is judged, s.
const SMOOTHING_S: f64 = 0.01;

/// Angle within which a leg is straight, rad: 5°.
const STRAIGHT_RAD: f64 = 5.0 * PI / 180.0;

/// A sample of the leg.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct LegSample {
    time_s: f64,
    angle_rad: f64,
    omega_rad_s: f64,
    torque_nm: f64,
}

impl LegSample {
    fn is_finite(&self) -> bool {
        let all = [self.time_s, self.omega_rad_s, self.torque_nm];
        all.iter().all(|x| x.is_finite()) && self.angle_rad.abs() <= MOST_RAD
    }

    fn follows(&self, last: &Self) -> bool {
        let step_s = self.time_s - last.time_s;
        let jump_rad = (self.angle_rad - last.angle_rad).abs();
        step_s > 0.0 && step_s <= GAP_S && jump_rad <= JUMP_RAD
    }
}

/// An examination.
#[derive(Clone, Debug, Default)]
pub struct Examination {
    last: Option<LegSample>,
    /// Time of its samples, s.
    seconds: f64,
    /// Torque, smoothed, N·m.
    torque_nm: f64,
    /// Least and greatest angle, rad.
    reached_rad: Option<[f64; 2]>,
    peak_rad_s: f64,
    strokes: Strokes,
    means: Means,
    /// Speed of the last mean, rad/s.
    speed_rad_s: f64,
    catches: Catches,
    ends: Ends,
    beats: Beats,
    /// Furthest ends of slow strokes: in flexion, and in extension, rad.
    slow_flexion_rad: Option<f64>,
    slow_extension_rad: Option<f64>,
    deficit_rad: Option<f64>,
    last_stroke: Option<Stroke>,
    steps: Steps,
    guide: Guide,
}

impl Examination {
    /// Begins to examine a knee with these effects; `grates` where the imaginary object is on, too.
    /// Without a knee, as by [`Default`], there are measures and steps alone.
    pub fn new(effects: &EffectSettings, grates: bool) -> Self {
        Self {
            guide: Guide::new(effects, grates),
            ..Self::default()
        }
    }

    /// Takes the next sample: time, angle, velocity, and torque against growing angle. What is not finite is
    /// left out.
    pub fn take(&mut self, time_s: f64, angle_rad: f64, omega_rad_s: f64, torque_nm: f64) {
        let sample = LegSample {
            time_s,
            angle_rad,
            omega_rad_s,
            torque_nm,
        };
        if !sample.is_finite() {
            return;
        }
        match self.last.replace(sample) {
            Some(last) if sample.follows(&last) => {
                let step_s = time_s - last.time_s;
                self.seconds += step_s;
                let share = (step_s / SMOOTHING_S).min(1.0);
                self.torque_nm += (torque_nm - self.torque_nm) * share;
            }
            _ => self.pause(torque_nm),
        }
        let [least, most] = self.reached_rad.unwrap_or([angle_rad; 2]);
        self.reached_rad = Some([least.min(angle_rad), most.max(angle_rad)]);
        let sense = self.strokes.way().map(|way| way.sense);
        let stroke = self.strokes.take(time_s, angle_rad);
        if self.strokes.way().map(|way| way.sense) != sense {
            self.turned(stroke);
        }
        if let Some(motion) = self.means.take(time_s, angle_rad) {
            self.moved(&motion);
        }
        self.feel(&sample);
        self.beats.take(time_s, angle_rad, self.torque_nm);
        self.guide.take(&sample);
    }

    /// Begins behind a gap: what was under way is not known any more.
    fn pause(&mut self, torque_nm: f64) {
        self.torque_nm = torque_nm;
        self.speed_rad_s = 0.0;
        self.strokes.restart();
        self.means.restart();
        self.catches.turn();
        self.ends.turn();
        self.beats.pause();
        self.steps.pause();
        self.guide.pause();
    }

    fn moved(&mut self, motion: &Motion) {
        self.speed_rad_s = motion.speed_rad_s.abs();
        self.peak_rad_s = self.peak_rad_s.max(self.speed_rad_s);
        self.steps.motion(motion);
        if let Some((at_rad, squared)) = motion.jerk {
            self.strokes.add_jerk(at_rad, squared);
        }
    }

    /// Judges the resistance to the stroke under way.
    fn feel(&mut self, sample: &LegSample) {
        let Some(way) = self.strokes.way() else {
            return;
        };
        let resistance_nm = way.sense * self.torque_nm;
        self.catches.take(&Felt {
            time_s: sample.time_s,
            angle_rad: sample.angle_rad,
            sense: way.sense,
            along_rad: way.along_rad,
            speed_rad_s: self.speed_rad_s,
            resistance_nm,
        });
        self.ends
            .take(way.along_rad, sample.angle_rad, resistance_nm);
    }

    /// The leg has turned: a stroke has ended, if it was one, and the next one has begun.
    fn turned(&mut self, stroke: Option<Stroke>) {
        self.catches.turn();
        let met_rad = self.ends.turn();
        let Some(stroke) = stroke else {
            return;
        };
        self.last_stroke = Some(stroke);
        self.steps.stroke(&stroke);
        if stroke.speed_rad_s >= FAST_RAD_S {
            return;
        }
        let end_rad = met_rad.unwrap_or(stroke.to_rad);
        if stroke.sense() > 0.0 {
            let furthest = self.slow_flexion_rad.unwrap_or(end_rad);
            self.slow_flexion_rad = Some(furthest.max(end_rad));
            return;
        }
        let furthest = self.slow_extension_rad.unwrap_or(end_rad);
        self.slow_extension_rad = Some(furthest.min(end_rad));
        self.deficit_rad = match met_rad {
            Some(met_rad) => Some(met_rad.max(0.0)),
            None if stroke.to_rad <= STRAIGHT_RAD => Some(0.0),
            None => self.deficit_rad,
        };
    }

    /// Time of its samples, s.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// A measure, in its [unit](MeasureSpec::unit); `None` while there is none.
    pub fn measure(&self, measure: Measure) -> Option<f64> {
        let caught = self.catches.found();
        let slow_end_rad = match caught {
            Some(caught) if caught.sense < 0.0 => self.slow_extension_rad,
            _ => self.slow_flexion_rad,
        };
        let train = self.beats.longest();
        match measure {
            Measure::Range => self
                .reached_rad
                .map(|[least, most]| (most - least).to_degrees()),
            Measure::Flexion => self.reached_rad.map(|[_, most]| most.to_degrees()),
            Measure::Deficit => self.deficit_rad.map(f64::to_degrees),
            Measure::PeakSpeed => self.reached_rad.map(|_| self.peak_rad_s.to_degrees()),
            Measure::Catch => caught.map(|caught| caught.angle_rad.to_degrees()),
            Measure::SlowEnd => slow_end_rad.map(f64::to_degrees),
            Measure::Dynamic => {
                let (caught, end_rad) = (caught?, slow_end_rad?);
                Some((caught.sense * (end_rad - caught.angle_rad)).to_degrees())
            }
            Measure::Beats => train.map(|train| f64::from(train.beats)),
            Measure::BeatRate => train?.rate_hz(),
            Measure::Unsteadiness => Some(100.0 * self.last_stroke?.unsteadiness),
            Measure::Smoothness => self.last_stroke?.smoothness,
        }
    }

    /// All measures in the order of [`Measure::ALL`]; NaN where there is none.
    pub fn measures(&self) -> [f64; COUNT] {
        Measure::ALL.map(|measure| self.measure(measure).unwrap_or(f64::NAN))
    }

    /// Returns whether a step was done.
    pub fn has_done(&self, step: Step) -> bool {
        self.steps.has(step)
    }

    /// The signs of the knee, and whether the movement was made that shows each.
    pub fn findings(&self) -> impl Iterator<Item = Finding> {
        self.guide.findings()
    }
}
