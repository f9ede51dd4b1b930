//! Search for the shape of a symptom: a sequence that fills its ranges evenly (Halton 1960), and from the best of
//! those a simplex (Nelder & Mead, Computer J. 7 (1965), 308–313). Laws jump, so no slope is followed.

use super::limb::{Fitted, Limb};
use super::motion::Motion;
use super::symptom::{PHASES, Symptom};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// Points of the even sequence for each parameter, the best of them that are followed, and the best of those that
/// are followed to the end.
const POINTS_PER_PARAMETER: usize = 100;
const FOLLOWED: usize = 5;
const ENDED: usize = 2;

/// Width about the strongest oscillation in which beats are looked for, Hz.
const BEAT_HZ: f64 = 0.6;

/// Evaluations of a simplex for each parameter, at first and at most, and relative spread of the cost at which it ends.
const FIRST_EVALUATIONS: usize = 20;
const MOST_EVALUATIONS: usize = 60;
const SPREAD: f64 = 1e-5;

/// An examination, a limb and a symptom.
pub(crate) struct Problem<'m> {
    pub(crate) motion: &'m Motion,
    pub(crate) blocks: &'m [Range<usize>],
    pub(crate) symptom: Symptom,
    pub(crate) is_flexor: bool,
    pub(crate) limb: Limb,
    /// Least and largest angle, deg.
    range_deg: (f64, f64),
    /// Whether nobody waits for it any more.
    is_cancelled: &'m AtomicBool,
}

/// A symptom of a shape, fitted to the torque.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    pub(crate) shape: Vec<f64>,
    /// Limb, amplitudes, and what they leave.
    pub(crate) fitted: Fitted,
    /// Phase of a ratchet in each stroke.
    pub(crate) phases: Vec<usize>,
}

impl<'m> Problem<'m> {
    pub(crate) fn new(
        motion: &'m Motion,
        blocks: &'m [Range<usize>],
        symptom: Symptom,
        is_flexor: bool,
        is_cancelled: &'m AtomicBool,
    ) -> Self {
        Self {
            motion,
            blocks,
            symptom,
            is_flexor,
            limb: Limb::new(motion, !symptom.is_rigidity()),
            range_deg: motion.range_deg(),
            is_cancelled,
        }
    }

    /// Torques of the symptom at an amplitude of 1; those of a ratchet with a phase for each stroke.
    pub(crate) fn signals(&self, shape: &[f64], phases: &[usize]) -> Option<Vec<Vec<f64>>> {
        if self.symptom != Symptom::Cogwheel || phases.is_empty() {
            return self
                .symptom
                .signals(shape, self.is_flexor, self.motion, 0.0);
        }
        Some(vec![self.in_phase(&self.all_phases(shape)?, phases)])
    }

    /// Torques of a ratchet in each of its phases.
    fn all_phases(&self, shape: &[f64]) -> Option<Vec<Vec<f64>>> {
        let at = |phase: usize| {
            let phase = phase as f64 / PHASES as f64;
            let mut signals = self
                .symptom
                .signals(shape, self.is_flexor, self.motion, phase)?;
            signals.pop()
        };
        (0..PHASES).map(at).collect()
    }

    /// Torque of a ratchet with a phase for each stroke.
    fn in_phase(&self, all: &[Vec<f64>], phases: &[usize]) -> Vec<f64> {
        let mut signal = vec![0.0; self.motion.len()];
        for (block, phase) in self.blocks.iter().zip(phases) {
            signal[block.clone()].copy_from_slice(&all[*phase][block.clone()]);
        }
        signal
    }

    /// Fits amplitudes to a shape.
    pub(crate) fn evaluate(&self, shape: &[f64]) -> Option<Point> {
        if self.is_cancelled.load(Ordering::Relaxed) {
            return None;
        }
        if !self.symptom.shows(shape, self.is_flexor, self.range_deg) {
            return None;
        }
        if self.symptom == Symptom::Cogwheel {
            return self.ratchet(shape);
        }
        let signals = self.signals(shape, &[])?;
        Some(Point {
            shape: shape.to_vec(),
            fitted: self.limb.fit(&signals)?,
            phases: Vec::new(),
        })
    }

    /// Fits a ratchet: its phase is that which fits best in each stroke.
    fn ratchet(&self, shape: &[f64]) -> Option<Point> {
        /// Times that phases and limb are fitted in turn.
        const TIMES: u32 = 2;
        let all = self.all_phases(shape)?;
        let mut mean = vec![0.0; self.motion.len()];
        for signal in &all {
            let share = 1.0 / PHASES as f64;
            mean.iter_mut()
                .zip(signal)
                .for_each(|(sum, s)| *sum += share * s);
        }
        let mut fitted = self.limb.fit(&[mean])?;
        let mut phases = vec![0; self.blocks.len()];
        for _ in 0..TIMES {
            let rest = self.limb.rest(&fitted);
            let amplitude = *fitted.amplitudes.first()?;
            for (block, phase) in self.blocks.iter().zip(&mut phases) {
                let misfit = |phase: &usize| {
                    let pairs = rest[block.clone()].iter().zip(&all[*phase][block.clone()]);
                    pairs.map(|(r, s)| (r - amplitude * s).powi(2)).sum::<f64>()
                };
                *phase = (0..PHASES).min_by(|a, b| misfit(a).total_cmp(&misfit(b)))?;
            }
            fitted = self.limb.fit(&[self.in_phase(&all, &phases)])?;
        }
        Some(Point {
            shape: shape.to_vec(),
            fitted,
            phases,
        })
    }

    /// Returns the sum of squares in a stroke that a fit has not seen, (N·m)². The phase of a ratchet is that of this
    /// stroke alone: half of it has the phase that fits the other half best, in turns of a tooth or two.
    pub(crate) fn unseen(
        &self,
        shape: &[f64],
        fitted: &Fitted,
        block: &Range<usize>,
    ) -> Option<f64> {
        /// Length of a turn, s.
        const TURN_S: f64 = 0.25;
        if self.symptom != Symptom::Cogwheel {
            let signals = self.signals(shape, &[])?;
            return Some(self.limb.squares(fitted, &signals, block));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a small positive number"
        )]
        let turn = ((TURN_S / self.motion.step_s) as usize).max(1);
        let all = self.all_phases(shape)?;
        let squares = |signal: &Vec<f64>| {
            let mut halves = [0.0, 0.0];
            for (i, from) in block.clone().step_by(turn).enumerate() {
                let rows = from..(from + turn).min(block.end);
                halves[i % 2] += self
                    .limb
                    .squares(fitted, std::slice::from_ref(signal), &rows);
            }
            halves
        };
        let by_phase: Vec<[f64; 2]> = all.iter().map(squares).collect();
        let best = |half: usize| by_phase.iter().min_by(|a, b| a[half].total_cmp(&b[half]));
        Some(best(1)?[0] + best(0)?[1])
    }

    /// Returns the frequency of the strongest oscillation while the joint is held, Hz.
    fn beat_hz(&self) -> Option<f64> {
        let range = self.symptom.shape()[0];
        let rest = self.limb.rest(&self.limb.fit(&[])?);
        let power = |hz: f64| -> f64 {
            let each = self.blocks.iter().map(|block| {
                let (mut sine, mut cosine) = (0.0, 0.0);
                for i in block
                    .clone()
                    .filter(|i| self.motion.omega_rad_s[*i].abs() < 0.05)
                {
                    let turn = std::f64::consts::TAU * hz * self.motion.time_s[i];
                    sine += rest[i] * turn.sin();
                    cosine += rest[i] * turn.cos();
                }
                sine * sine + cosine * cosine
            });
            each.sum()
        };
        let mut best = (0.0, range.low);
        let mut hz = range.low;
        while hz <= range.high {
            let here = power(hz);
            if here > best.0 {
                best = (here, hz);
            }
            hz += 0.05;
        }
        Some(best.1)
    }

    /// Searches the shape; `None` if no shape is one of the law's.
    pub(crate) fn best(&self) -> Option<Point> {
        let ranges = self.symptom.shape();
        if ranges.is_empty() {
            return self.evaluate(&[]);
        }
        let scaled = |unit: &[f64]| -> Vec<f64> {
            let pairs = unit.iter().zip(ranges);
            pairs
                .map(|(u, range)| range.low + u.clamp(0.0, 1.0) * (range.high - range.low))
                .collect()
        };
        let cost = |unit: &[f64]| {
            self.evaluate(&scaled(unit))
                .map_or(f64::INFINITY, |point| point.fitted.cost)
        };
        // Beats keep their phase for so long that no sequence hits their frequency.
        let beat = (self.symptom == Symptom::Clonus)
            .then(|| self.beat_hz())
            .flatten();
        let mut starts: Vec<(f64, Vec<f64>)> = (1..=POINTS_PER_PARAMETER * ranges.len())
            .map(|i| {
                let mut unit: Vec<f64> = (0..ranges.len()).map(|k| halton(i, PRIMES[k])).collect();
                if let (Some(hz), [first, ..]) = (beat, unit.as_mut_slice()) {
                    let near = hz + BEAT_HZ * (*first - 0.5);
                    *first =
                        ((near - ranges[0].low) / (ranges[0].high - ranges[0].low)).clamp(0.0, 1.0);
                }
                (cost(&unit), unit)
            })
            .collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let n = ranges.len();
        let follow = |mut simplex: Simplex, evaluations: usize| {
            simplex.descend(&cost, evaluations * n);
            simplex
        };
        let mut followed: Vec<Simplex> = (starts.into_iter().take(FOLLOWED))
            .map(|(_, start)| follow(Simplex::about(&start, &cost), FIRST_EVALUATIONS))
            .collect();
        followed.sort_by(|a, b| a.least().total_cmp(&b.least()));
        followed.truncate(ENDED);
        let ends = followed
            .into_iter()
            .map(|simplex| follow(simplex, MOST_EVALUATIONS - FIRST_EVALUATIONS));
        let best = ends.min_by(|a, b| a.least().total_cmp(&b.least()))?;
        self.evaluate(&scaled(&best.points.first()?.1))
    }
}

const PRIMES: [usize; 8] = [2, 3, 5, 7, 11, 13, 17, 19];

/// The radical inverse of a number.
fn halton(mut i: usize, base: usize) -> f64 {
    let (mut share, mut sum) = (1.0, 0.0);
    while i > 0 {
        share /= base as f64;
        sum += share * (i % base) as f64;
        i /= base;
    }
    sum
}

/// A simplex within the unit cube.
struct Simplex {
    /// Costs and places, the least cost first.
    points: Vec<(f64, Vec<f64>)>,
}

impl Simplex {
    fn about(start: &[f64], cost: &dyn Fn(&[f64]) -> f64) -> Self {
        let mut points: Vec<(f64, Vec<f64>)> = Vec::new();
        for k in 0..=start.len() {
            let mut point = start.to_vec();
            if let Some(u) = k.checked_sub(1).and_then(|k| point.get_mut(k)) {
                *u += if *u > 0.5 { -0.08 } else { 0.08 };
            }
            points.push((cost(&point), point));
        }
        let mut simplex = Self { points };
        simplex.sort();
        simplex
    }

    fn sort(&mut self) {
        self.points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    fn least(&self) -> f64 {
        self.points.first().map_or(f64::INFINITY, |point| point.0)
    }

    /// Descends by at most so many evaluations of the cost.
    fn descend(&mut self, cost: &dyn Fn(&[f64]) -> f64, most_evaluations: usize) {
        let points = &mut self.points;
        let last = points.len() - 1;
        let size = points[0].1.len();
        let mut evaluations = 0;
        while evaluations < most_evaluations {
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (least, most) = (points[0].0, points[last].0);
            if most - least <= SPREAD * least {
                break;
            }
            let centre: Vec<f64> = (0..size)
                .map(|k| points[..last].iter().map(|point| point.1[k]).sum::<f64>() / last as f64)
                .collect();
            let along = |by: f64| -> Vec<f64> {
                let pairs = centre.iter().zip(&points[last].1);
                pairs
                    .map(|(c, w)| (c + by * (c - w)).clamp(0.0, 1.0))
                    .collect()
            };
            let reflected = along(1.0);
            let there = cost(&reflected);
            evaluations += 1;
            let next = if there < least {
                let expanded = along(2.0);
                let further = cost(&expanded);
                evaluations += 1;
                if further < there {
                    (further, expanded)
                } else {
                    (there, reflected)
                }
            } else if there < points[last - 1].0 {
                (there, reflected)
            } else {
                let contracted = along(if there < most { 0.5 } else { -0.5 });
                let nearer = cost(&contracted);
                evaluations += 1;
                (nearer, contracted)
            };
            if next.0 < most {
                points[last] = next;
            } else {
                let best = points[0].1.clone();
                for (known, point) in points.iter_mut().skip(1) {
                    for (u, b) in point.iter_mut().zip(&best) {
                        *u = 0.5 * (*u + b);
                    }
                    *known = cost(point);
                }
                evaluations += last;
            }
        }
        self.sort();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_simplex_finds_the_bottom_of_a_bent_valley() {
        let valley = |x: &[f64]| {
            let (a, b) = (4.0 * x[0] - 2.0, 4.0 * x[1] - 2.0);
            1e-6 + (0.5 - a).powi(2) + 10.0 * (b - a * a).powi(2)
        };
        let mut simplex = Simplex::about(&[0.2, 0.9], &valley);
        // Paused and resumed.
        simplex.descend(&valley, 30);
        simplex.descend(&valley, 370);
        let (cost, at) = &simplex.points[0];
        assert!(
            *cost < 2e-4 && (4.0 * at[0] - 2.5).abs() < 0.02,
            "{cost} {at:?}"
        );
    }
}
