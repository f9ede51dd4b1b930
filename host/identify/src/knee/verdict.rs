//! Which model, with what intervals, and what cannot be told.

use super::jackknife::{Jackknife, gain};
use super::motion::{Examination, Motion};
use super::refusal::Refusal;
use super::search::{Point, Problem};
use super::stroke::{Stroke, blocks, strokes};
use super::symptom::{Symptom, allowance, spec};
use crate::Estimate;
use nalgebra::DVector;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// Dry friction from which a knee is called rigid, N·m: half of the mildest grade that ships.
pub const RIGID_NM: f64 = 0.3;

/// Largest torque of a symptom from which it is called one, N·m.
const FELT_NM: f64 = 0.2;

/// Least decrease of the squared error in left-out strokes, as a share, and least deviations of the paired
/// difference over strokes, by which a symptom has to beat a limb without.
const GAIN: f64 = 0.15;
const SURE: f64 = 2.0;

/// Squared errors in left-out strokes that differ by less than this share are alike, if not surely different.
const ALIKE: f64 = 0.03;

/// Share of the torque's variance that limb and symptom have to explain, and of the motion of a leg that swings freely.
const EXPLAINED: f64 = 0.7;
const EXPLAINED_FREE: f64 = 0.9;

/// Width of a range of angles in the report of what is not explained, deg.
const ANGLES_DEG: f64 = 10.0;

/// Share of a parameter's range from which its interval says nothing.
const UNTOLD: f64 = 0.5;

/// A value of a fitted law.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// Key of the effect in a scene.
    pub key: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Value, with its 95 % interval; an infinite one for a threshold that only lies between two strokes.
    pub estimate: Estimate,
    /// Whether the recording tells it: otherwise the interval is as wide as half the range that was searched.
    pub is_told: bool,
    /// Least and largest value that a device shows.
    pub range: (f64, f64),
}

/// A model of the knee.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The symptom.
    pub symptom: Symptom,
    /// Whether it is of the flexors, which resist extension.
    pub is_flexor: bool,
    /// Values of its law.
    pub values: Vec<Value>,
    /// Residual of the fit, N·m rms.
    pub residual_nm: f64,
    /// Error in strokes that were left out, N·m rms.
    pub left_out_nm: f64,
    /// Largest torque of the symptom, N·m.
    pub largest_nm: f64,
    /// Squared error of each stroke by the fit without it, (N·m)².
    by_stroke: Vec<f64>,
    residual: Vec<f64>,
    torque: Vec<f64>,
}

/// Torque that limb and symptom do not explain.
#[derive(Clone, Debug, PartialEq)]
pub struct Unexplained {
    /// N·m rms.
    pub rms_nm: f64,
    /// Share of the torque's variance.
    pub share: f64,
    /// Angle, deg, at the middle of each ten degrees, and rms there, N·m.
    pub by_angle: Vec<(f64, f64)>,
}

/// A model fitted to a knee.
#[derive(Clone, Debug, PartialEq)]
pub struct KneeFit {
    /// Strokes of the examination.
    pub strokes: Vec<Stroke>,
    /// The proposal.
    pub best: Candidate,
    /// The best of the others.
    pub second: Candidate,
    /// Dry friction of limb and apparatus, N·m, with its 95 % interval.
    pub friction_nm: Estimate,
    /// Symptoms that this examination cannot show, and why.
    pub untold: Vec<(Symptom, String)>,
    /// The torque that is left.
    pub unexplained: Unexplained,
    motion: Motion,
}

impl KneeFit {
    /// Returns time, s, angle, rad, torque, symptom and residual, N·m, of each sample of the fit.
    pub fn curve(&self) -> impl Iterator<Item = [f64; 5]> {
        let motion = &self.motion;
        (0..motion.len()).map(|i| {
            let (angle, torque) = (motion.angle_rad[i], motion.torque_nm[i]);
            [
                motion.time_s[i],
                angle,
                torque,
                self.best.torque[i],
                self.best.residual[i],
            ]
        })
    }
}

/// Fits every symptom to an examination and proposes one. `progress` gets the completed share of the work and
/// cancels it by returning false.
///
/// # Errors
/// [`Refusal`]: what is missing, or what cannot be told apart.
pub fn fit(
    examination: &Examination,
    progress: &mut dyn FnMut(f64) -> bool,
) -> Result<KneeFit, Refusal> {
    let motion = Motion::of(examination)?;
    let (strokes, begins) = strokes(&motion)?;
    let blocks = blocks(&begins, motion.len());
    let fastest = |is_flexion: bool| {
        let of_sense = strokes
            .iter()
            .filter(|stroke| stroke.is_flexion() == is_flexion);
        of_sense.map(|stroke| stroke.peak_deg_s).fold(0.0, f64::max)
    };
    let mut untold = Vec::new();
    let mut variants = Vec::new();
    for symptom in Symptom::ALL {
        let needed = symptom.needed_deg_s();
        let reached = f64::max(fastest(true), fastest(false));
        if reached < needed {
            untold.push((
                symptom,
                format!("the fastest stroke is {reached:.0} deg/s, it shows from {needed:.0} on: record faster ones"),
            ));
            continue;
        }
        variants.push((symptom, false));
        if symptom.is_muscular() && fastest(false) >= needed {
            variants.push((symptom, true));
        }
    }
    let candidates = fitted(&motion, &blocks, &variants, progress)?;
    decide(motion, strokes, candidates, untold)
}

/// Fits each of these symptoms in a thread.
fn fitted(
    motion: &Motion,
    blocks: &[Range<usize>],
    variants: &[(Symptom, bool)],
    progress: &mut dyn FnMut(f64) -> bool,
) -> Result<Vec<Candidate>, Refusal> {
    /// Time between two reports of the progress.
    const EVERY: Duration = Duration::from_millis(100);
    let is_cancelled = AtomicBool::new(false);
    let mut found: Vec<Option<Candidate>> = vec![None; variants.len()];
    std::thread::scope(|scope| {
        let (ended, ends) = channel();
        for (place, (symptom, is_flexor)) in variants.iter().enumerate() {
            let (ended, is_cancelled) = (ended.clone(), &is_cancelled);
            scope.spawn(move || {
                let problem = Problem::new(motion, blocks, *symptom, *is_flexor, is_cancelled);
                let best = problem.best();
                let candidate = best.and_then(|point| Candidate::of(&problem, &point));
                // Nobody waits after an interruption.
                let _ = ended.send((place, candidate));
            });
        }
        drop(ended);
        let mut count = 0;
        loop {
            if !progress(f64::from(count) / variants.len() as f64) {
                is_cancelled.store(true, Ordering::Relaxed);
                return Err(Refusal::Interrupted);
            }
            match ends.recv_timeout(EVERY) {
                Ok((place, candidate)) => (found[place], count) = (candidate, count + 1),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        Ok(())
    })?;
    Ok(found.into_iter().flatten().collect())
}

impl Candidate {
    fn of(problem: &Problem<'_>, point: &Point) -> Option<Self> {
        let jackknife = Jackknife::of(problem, point)?;
        let count = problem.motion.len() as f64;
        let squares: f64 = jackknife.residual.iter().map(|r| r * r).sum();
        Some(Self {
            symptom: problem.symptom,
            is_flexor: problem.is_flexor,
            values: values(problem, point, &jackknife),
            residual_nm: (squares / count).sqrt(),
            left_out_nm: (jackknife.left_out.iter().sum::<f64>() / count).sqrt(),
            largest_nm: jackknife
                .symptom
                .iter()
                .fold(0.0, |most, t| f64::max(most, t.abs())),
            by_stroke: jackknife.left_out,
            residual: jackknife.residual,
            torque: jackknife.symptom,
        })
    }

    /// Returns a value by its key.
    pub fn value(&self, key: &str) -> Option<&Value> {
        self.values.iter().find(|value| value.key == key)
    }

    /// Returns by how much its squared error in left-out strokes is below that of another, as a share, and the
    /// deviations of the paired difference.
    fn gain_over(&self, other: &Self) -> (f64, f64) {
        gain(&self.by_stroke, &other.by_stroke)
    }
}

/// Values of the law with their intervals, by the slopes of each in shape and amplitudes.
fn values(problem: &Problem<'_>, point: &Point, jackknife: &Jackknife) -> Vec<Value> {
    let symptom = problem.symptom;
    let ranges = symptom.shape();
    let at =
        |shape: &[f64], amplitudes: &[f64]| symptom.values(shape, amplitudes, problem.is_flexor);
    let base = at(&point.shape, &point.fitted.amplitudes);
    let size = ranges.len() + point.fitted.amplitudes.len();
    (base.iter().enumerate())
        .map(|(i, (key, value))| {
            let mut is_stepped = false;
            let mut of_range = 0.0_f64;
            let slopes = DVector::from_fn(size, |k, _| {
                let (mut shape, mut amplitudes) =
                    (point.shape.clone(), point.fitted.amplitudes.clone());
                let by = if let Some(range) = ranges.get(k) {
                    let by = 1e-6 * (range.high - range.low);
                    shape[k] += by;
                    by
                } else {
                    let by = 1e-6 * amplitudes[k - ranges.len()].max(1e-3);
                    amplitudes[k - ranges.len()] += by;
                    by
                };
                let slope = at(&shape, &amplitudes)
                    .get(i)
                    .map_or(0.0, |(_, moved)| (moved - value) / by);
                if let Some(range) = ranges.get(k).filter(|_| slope != 0.0) {
                    is_stepped |= !range.is_smooth;
                    of_range = of_range.hypot(slope * (range.high - range.low));
                }
                slope
            });
            // Beats are whole numbers.
            is_stepped |= *key == "beats";
            let (share, absolute) = allowance(key);
            let of_model = (share * value).hypot(absolute);
            let half_width = if is_stepped {
                f64::INFINITY
            } else {
                jackknife.half_width(&slopes).hypot(of_model)
            };
            let is_shape = of_range > 0.0;
            let spec = symptom.effect().and_then(|effect| spec(effect, key));
            Value {
                key,
                unit: spec.map_or("", |spec| spec.unit),
                estimate: Estimate {
                    value: *value,
                    half_width,
                },
                is_told: if is_shape {
                    half_width < UNTOLD * of_range
                } else {
                    half_width < value.abs()
                },
                range: spec.map_or((f64::MIN, f64::MAX), |spec| (spec.min, spec.max)),
            }
        })
        .collect()
}

/// Chooses among the candidates.
fn decide(
    motion: Motion,
    strokes: Vec<Stroke>,
    mut candidates: Vec<Candidate>,
    untold: Vec<(Symptom, String)>,
) -> Result<KneeFit, Refusal> {
    candidates.sort_by(|a, b| a.left_out_nm.total_cmp(&b.left_out_nm));
    let of = |symptom: Symptom| {
        candidates
            .iter()
            .find(|candidate| candidate.symptom == symptom)
    };
    let noise = |residual_nm: f64, share: f64| Refusal::Noise {
        share: 100.0 * share,
        residual_nm,
    };
    let (Some(healthy), Some(rigid)) = (of(Symptom::Healthy), of(Symptom::LeadPipe)) else {
        return Err(noise(0.0, 0.0));
    };
    let friction_nm = rigid.value("torque_nm").map_or(
        Estimate {
            value: 0.0,
            half_width: 0.0,
        },
        |v| v.estimate,
    );
    // A limb without another symptom: rigid, if its friction is great.
    let plain = if friction_nm.value >= RIGID_NM {
        rigid
    } else {
        healthy
    };
    let beats_plain = |candidate: &&Candidate| {
        let (gain, sure) = candidate.gain_over(plain);
        let is_other = !matches!(candidate.symptom, Symptom::Healthy | Symptom::LeadPipe);
        is_other && gain > GAIN && sure > SURE && candidate.largest_nm > FELT_NM
    };
    let best = candidates.iter().find(beats_plain).unwrap_or(plain);
    let is_other = |candidate: &&Candidate| {
        candidate.symptom != best.symptom
            && !(best.symptom == Symptom::Healthy && candidate.symptom == Symptom::LeadPipe)
            && !(best.symptom == Symptom::LeadPipe && candidate.symptom == Symptom::Healthy)
    };
    let second = candidates.iter().find(is_other).unwrap_or(healthy);
    let count = motion.len() as f64;
    let mean = motion.torque_nm.iter().sum::<f64>() / count;
    let whole: f64 = motion.torque_nm.iter().map(|t| (t - mean).powi(2)).sum();
    let share = best.residual_nm.powi(2) * count / whole.max(1e-300);
    let least = if motion.is_released {
        EXPLAINED_FREE
    } else {
        EXPLAINED
    };
    if 1.0 - share < least {
        return Err(noise(best.residual_nm, 1.0 - share));
    }
    let (gain, sure) = best.gain_over(second);
    let is_same_effect = best.symptom.effect() == second.symptom.effect();
    let is_named = beats_plain(&second) || best.symptom.effect().is_some();
    if is_named
        && !is_same_effect
        && beats_plain(&second)
        && gain.abs() < ALIKE
        && sure.abs() < SURE
    {
        return Err(Refusal::Alike {
            first: best.symptom.name(),
            second: second.symptom.name(),
            first_nm: best.left_out_nm,
            second_nm: second.left_out_nm,
        });
    }
    let unexplained = Unexplained {
        rms_nm: best.residual_nm,
        share,
        by_angle: by_angle(&motion, &best.residual),
    };
    Ok(KneeFit {
        strokes,
        best: best.clone(),
        second: second.clone(),
        friction_nm,
        untold,
        unexplained,
        motion,
    })
}

/// Residual by angle.
fn by_angle(motion: &Motion, residual: &[f64]) -> Vec<(f64, f64)> {
    let mut bins: std::collections::BTreeMap<i32, (f64, f64)> = std::collections::BTreeMap::new();
    for (angle, r) in motion.angle_rad.iter().zip(residual) {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a cast from float saturates"
        )]
        let bin = (angle.to_degrees() / ANGLES_DEG).floor() as i32;
        let sums = bins.entry(bin).or_insert((0.0, 0.0));
        *sums = (sums.0 + r * r, sums.1 + 1.0);
    }
    let means = bins.into_iter();
    means
        .map(|(bin, (sum, n))| ((f64::from(bin) + 0.5) * ANGLES_DEG, f64::sqrt(sum / n)))
        .collect()
}
