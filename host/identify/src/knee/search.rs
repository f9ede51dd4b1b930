//! Search for the shape of a symptom: a sequence that fills its ranges evenly (Halton 1960), and from the best of
//! those a simplex (Nelder & Mead, Computer J. 7 (1965), 308–313). Laws jump, so no slope is followed.

use super::limb::{columns, dot, orthonormal, project_out};
use super::motion::Motion;
use super::symptom::{PHASES, Symptom};
use std::ops::Range;

/// Points of the even sequence for each parameter, and the best of them that are followed.
const POINTS_PER_PARAMETER: usize = 100;
const FOLLOWED: usize = 5;

/// Width about the strongest oscillation in which beats are looked for, Hz.
const BEAT_HZ: f64 = 0.6;

/// Most evaluations of a simplex, and relative spread of the cost at which it ends.
const MOST_EVALUATIONS: usize = 400;
const SPREAD: f64 = 1e-5;

/// An examination with the limb projected out of its torque.
pub(crate) struct Problem<'m> {
    pub(crate) motion: &'m Motion,
    pub(crate) blocks: &'m [Range<usize>],
    pub(crate) symptom: Symptom,
    pub(crate) is_flexor: bool,
    /// Columns of the limb.
    pub(crate) limb: Vec<Vec<f64>>,
    basis: Vec<Vec<f64>>,
    /// Torque without what the limb explains, N·m.
    rest: Vec<f64>,
}

/// A symptom of a shape, fitted to the torque.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    pub(crate) shape: Vec<f64>,
    pub(crate) amplitudes: Vec<f64>,
    /// Phase of a ratchet in each stroke.
    pub(crate) phases: Vec<usize>,
    /// Sum of squares that is left, (N·m)².
    pub(crate) cost: f64,
}

impl<'m> Problem<'m> {
    pub(crate) fn new(
        motion: &'m Motion,
        blocks: &'m [Range<usize>],
        symptom: Symptom,
        is_flexor: bool,
    ) -> Self {
        let limb = columns(motion, !symptom.is_rigidity());
        let basis = orthonormal(&limb);
        let mut rest = motion.torque_nm.clone();
        project_out(&basis, &mut rest);
        Self {
            motion,
            blocks,
            symptom,
            is_flexor,
            limb,
            basis,
            rest,
        }
    }

    /// Torques of the symptom at an amplitude of 1; those of a ratchet with a phase for each stroke.
    pub(crate) fn signals(&self, shape: &[f64], phases: &[usize]) -> Option<Vec<Vec<f64>>> {
        let at = |phase: usize| {
            let phase = phase as f64 / PHASES as f64;
            self.symptom
                .signals(shape, self.is_flexor, self.motion, phase)
        };
        if self.symptom != Symptom::Cogwheel || phases.is_empty() {
            return at(0);
        }
        let mut all = Vec::new();
        for phase in 0..PHASES {
            all.push(at(phase)?.pop()?);
        }
        let mut signal = vec![0.0; self.motion.len()];
        for (block, phase) in self.blocks.iter().zip(phases) {
            signal[block.clone()].copy_from_slice(&all[*phase][block.clone()]);
        }
        Some(vec![signal])
    }

    /// Fits amplitudes to a shape.
    pub(crate) fn evaluate(&self, shape: &[f64]) -> Option<Point> {
        if self.symptom == Symptom::Cogwheel {
            return self.ratchet(shape);
        }
        let signals = self.signals(shape, &[])?;
        let (amplitudes, cost) = self.amplitudes(&signals);
        Some(Point {
            shape: shape.to_vec(),
            amplitudes,
            phases: Vec::new(),
            cost,
        })
    }

    /// Fits a ratchet: its phase is that which fits best in each stroke.
    fn ratchet(&self, shape: &[f64]) -> Option<Point> {
        let mut all = Vec::new();
        for phase in 0..PHASES {
            let mut signal = self
                .symptom
                .signals(shape, false, self.motion, phase as f64 / PHASES as f64)?
                .pop()?;
            project_out(&self.basis, &mut signal);
            all.push(signal);
        }
        let mean: Vec<f64> = (0..self.motion.len())
            .map(|i| all.iter().map(|signal| signal[i]).sum::<f64>() / PHASES as f64)
            .collect();
        let mut amplitude = (dot(&mean, &self.rest) / dot(&mean, &mean).max(1e-12)).max(0.0);
        let mut phases = vec![0; self.blocks.len()];
        for _ in 0..2 {
            let (mut up, mut down) = (0.0, 1e-12);
            for (block, phase) in self.blocks.iter().zip(&mut phases) {
                let rest = &self.rest[block.clone()];
                let misfit = |phase: &usize| {
                    let signal = all[*phase][block.clone()].iter();
                    rest.iter()
                        .zip(signal)
                        .map(|(r, s)| (r - amplitude * s).powi(2))
                        .sum::<f64>()
                };
                *phase = (0..PHASES).min_by(|a, b| misfit(a).total_cmp(&misfit(b)))?;
                up += dot(rest, &all[*phase][block.clone()]);
                down += dot(&all[*phase][block.clone()], &all[*phase][block.clone()]);
            }
            amplitude = (up / down).max(0.0);
        }
        let signals = self.signals(shape, &phases)?;
        let (amplitudes, cost) = self.amplitudes(&signals);
        Some(Point {
            shape: shape.to_vec(),
            amplitudes,
            phases,
            cost,
        })
    }

    /// Least-squares amplitudes that are not negative, of at most two signals, and the sum of squares that is left.
    fn amplitudes(&self, signals: &[Vec<f64>]) -> (Vec<f64>, f64) {
        let whole = dot(&self.rest, &self.rest);
        let project = |signal: &Vec<f64>| {
            let mut signal = signal.clone();
            project_out(&self.basis, &mut signal);
            signal
        };
        let signals: Vec<Vec<f64>> = signals.iter().map(project).collect();
        let alone = |signal: &Vec<f64>| {
            let square = dot(signal, signal);
            if square > 1e-9 {
                (dot(signal, &self.rest) / square).max(0.0)
            } else {
                0.0
            }
        };
        let gain = |signal: &Vec<f64>| alone(signal).powi(2) * dot(signal, signal);
        match signals.as_slice() {
            [] => (Vec::new(), whole),
            [signal] => (vec![alone(signal)], whole - gain(signal)),
            [a, b, ..] => {
                let (aa, ab, bb) = (dot(a, a), dot(a, b), dot(b, b));
                let (ay, by) = (dot(a, &self.rest), dot(b, &self.rest));
                let determinant = aa * bb - ab * ab;
                if determinant > 1e-9 * aa * bb {
                    let (x, y) = (
                        (bb * ay - ab * by) / determinant,
                        (aa * by - ab * ay) / determinant,
                    );
                    if x > 0.0 && y > 0.0 {
                        return (vec![x, y], whole - x * ay - y * by);
                    }
                }
                if gain(a) >= gain(b) {
                    (vec![alone(a), 0.0], whole - gain(a))
                } else {
                    (vec![0.0, alone(b)], whole - gain(b))
                }
            }
        }
    }

    /// Returns the frequency of the strongest oscillation while the joint is held, Hz.
    fn beat_hz(&self) -> f64 {
        let range = self.symptom.shape()[0];
        let power = |hz: f64| -> f64 {
            let each = self.blocks.iter().map(|block| {
                let (mut sine, mut cosine) = (0.0, 0.0);
                for i in block
                    .clone()
                    .filter(|i| self.motion.omega_rad_s[*i].abs() < 0.05)
                {
                    let turn = std::f64::consts::TAU * hz * self.motion.time_s[i];
                    sine += self.rest[i] * turn.sin();
                    cosine += self.rest[i] * turn.cos();
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
        best.1
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
                .map_or(f64::INFINITY, |point| point.cost)
        };
        // Beats keep their phase for so long that no sequence hits their frequency.
        let beat = (self.symptom == Symptom::Clonus).then(|| self.beat_hz());
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
        let ends = starts
            .into_iter()
            .take(FOLLOWED)
            .map(|(_, start)| simplex(&start, &cost));
        let (_, unit) = ends.min_by(|a, b| a.0.total_cmp(&b.0))?;
        self.evaluate(&scaled(&unit))
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

/// Descends with a simplex within the unit cube; returns the least cost and its place.
fn simplex(start: &[f64], cost: &dyn Fn(&[f64]) -> f64) -> (f64, Vec<f64>) {
    let within = |x: Vec<f64>| -> Vec<f64> { x.into_iter().map(|u| u.clamp(0.0, 1.0)).collect() };
    let mut points: Vec<(f64, Vec<f64>)> = Vec::new();
    for k in 0..=start.len() {
        let mut point = start.to_vec();
        if let Some(u) = k.checked_sub(1).and_then(|k| point.get_mut(k)) {
            *u += if *u > 0.5 { -0.08 } else { 0.08 };
        }
        points.push((cost(&point), point));
    }
    let mut evaluations = points.len();
    while evaluations < MOST_EVALUATIONS {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let last = points.len() - 1;
        let (least, most) = (points[0].0, points[last].0);
        if most - least <= SPREAD * least {
            break;
        }
        let n = last as f64;
        let centre: Vec<f64> = (0..start.len())
            .map(|k| points[..last].iter().map(|point| point.1[k]).sum::<f64>() / n)
            .collect();
        let along = |by: f64| {
            let worst = &points[last].1;
            within(
                centre
                    .iter()
                    .zip(worst)
                    .map(|(c, w)| c + by * (c - w))
                    .collect(),
            )
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
    points
        .into_iter()
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((f64::INFINITY, start.to_vec()))
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
        let (cost, at) = simplex(&[0.2, 0.9], &valley);
        assert!(
            cost < 2e-4 && (4.0 * at[0] - 2.5).abs() < 0.02,
            "{cost} {at:?}"
        );
    }
}
