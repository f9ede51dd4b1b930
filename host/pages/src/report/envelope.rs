//! The torque of a whole run, or another column: per stretch of time its
//! lowest, highest and mean value, and how long the object spent in each phase.
//!
//! Times in a phase come from the events, not from the rows: a stick shorter
//! than a row counts in full.

use crate::plot::Point;
use crepitus_model::{EventKind, Phase, Sense};
use crepitus_plant::Extremes;
use crepitus_scene::trace::EventRecord;

/// One stretch of time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Bin {
    time: Extremes<f64>,
    pub(crate) value: Extremes<f64>,
    sum: f64,
    count: u64,
    rows: u64,
    pub(crate) breaks: u64,
    stick_s: f64,
    positive_s: f64,
    negative_s: f64,
}

/// Shares of the time of a [`Bin`], each 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shares {
    pub(crate) stick: f64,
    pub(crate) positive: f64,
    pub(crate) negative: f64,
}

impl Bin {
    fn append(&mut self, other: &Self) {
        self.time.join(other.time);
        self.value.join(other.value);
        self.sum += other.sum;
        self.count += other.count;
        self.rows += other.rows;
        self.breaks += other.breaks;
        self.stick_s += other.stick_s;
        self.positive_s += other.positive_s;
        self.negative_s += other.negative_s;
    }

    pub(crate) fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }

    /// Times of its first and last row.
    pub(crate) fn ends(&self) -> [f64; 2] {
        [self.time.low, self.time.high]
    }

    pub(crate) fn middle(&self) -> f64 {
        0.5 * (self.time.low + self.time.high)
    }

    pub(crate) fn shares(&self) -> Option<Shares> {
        let total = self.stick_s + self.positive_s + self.negative_s;
        (total > 0.0).then(|| Shares {
            stick: self.stick_s / total,
            positive: self.positive_s / total,
            negative: self.negative_s / total,
        })
    }

    /// Time in any phase, s.
    #[cfg(test)]
    pub(crate) fn known_s(&self) -> f64 {
        self.stick_s + self.positive_s + self.negative_s
    }

    fn is_active(&self) -> bool {
        self.positive_s + self.negative_s > 0.0
    }
}

/// See the module.
#[derive(Clone, Debug)]
pub(crate) struct Envelope {
    pub(crate) bins: Vec<Bin>,
    open: Bin,
    rows_per_bin: u64,
    phase: Option<Phase>,
    since: f64,
    events_seen: bool,
}

impl Envelope {
    /// About as many bins as a chart has pixels across; even.
    pub(crate) const CAPACITY: usize = 1200;

    pub(crate) fn new(rows_expected: u64) -> Self {
        Self {
            bins: Vec::new(),
            open: Bin::default(),
            rows_per_bin: rows_expected.div_ceil(Self::CAPACITY as u64).max(1),
            phase: None,
            since: f64::NAN,
            events_seen: false,
        }
    }

    /// Rows are missing before the next one: in which phase is not known.
    pub(crate) fn gap(&mut self) {
        self.phase = None;
        self.since = f64::NAN;
    }

    /// Records that the object is in no phase from here on, until a row or an event reports one.
    pub(crate) fn off(&mut self, time: f64) {
        self.advance(time);
        self.phase = None;
    }

    pub(crate) fn row(&mut self, time: f64, torque: f64, phase: Option<Phase>) {
        self.advance(time);
        // With events, only they end a phase.
        if !self.events_seen || self.phase.is_none() {
            self.phase = phase;
        }
        self.open.time.add(time);
        self.open.rows += 1;
        if torque.is_finite() {
            self.open.value.add(torque);
            self.open.sum += torque;
            self.open.count += 1;
        }
        if self.open.rows >= self.rows_per_bin {
            self.close();
        }
    }

    pub(crate) fn event(&mut self, event: &EventRecord) {
        if self.phase.is_none() {
            self.phase = Some(Phase::from_sign(event.from));
        }
        self.advance(event.time_s);
        self.events_seen = true;
        self.phase = Some(Phase::from_sign(event.to));
        self.open.value.add(event.torque_before_nm);
        self.open.value.add(event.torque_after_nm);
        if event.kind == EventKind::Break {
            self.open.breaks += 1;
        }
    }

    fn advance(&mut self, time: f64) {
        let spent = time - self.since;
        if spent > 0.0 {
            match self.phase {
                Some(Phase::Stick) => self.open.stick_s += spent,
                Some(Phase::Slip(Sense::Positive)) => self.open.positive_s += spent,
                Some(Phase::Slip(Sense::Negative)) => self.open.negative_s += spent,
                None => {}
            }
        }
        self.since = time;
    }

    fn close(&mut self) {
        if self.bins.len() == Self::CAPACITY {
            self.bins = merged(&self.bins, 2);
            self.rows_per_bin *= 2;
        }
        // After halving, the open bin is a short one; it stays open.
        if self.open.rows >= self.rows_per_bin {
            self.bins.push(std::mem::take(&mut self.open));
        }
    }

    pub(crate) fn finish(mut self) -> Self {
        if self.open.rows > 0 {
            self.bins.push(std::mem::take(&mut self.open));
        }
        self
    }

    pub(crate) fn breaks(&self) -> u64 {
        self.bins.iter().map(|bin| bin.breaks).sum()
    }

    /// The mean of all rows; NaN without rows.
    pub(crate) fn mean(&self) -> f64 {
        let sum: f64 = self.bins.iter().map(|bin| bin.sum).sum();
        let count: u64 = self.bins.iter().map(|bin| bin.count).sum();
        sum / count as f64
    }

    /// The phases that took any time.
    pub(crate) fn phases(&self) -> Vec<Phase> {
        let takes_time = |pick: fn(&Bin) -> f64| self.bins.iter().any(|bin| pick(bin) > 0.0);
        [
            (Phase::Stick, takes_time(|bin| bin.stick_s)),
            (
                Phase::Slip(Sense::Positive),
                takes_time(|bin| bin.positive_s),
            ),
            (
                Phase::Slip(Sense::Negative),
                takes_time(|bin| bin.negative_s),
            ),
        ]
        .into_iter()
        .filter_map(|(phase, occurs)| occurs.then_some(phase))
        .collect()
    }

    /// Bins so wide that each holds a few whole cycles on average: narrower
    /// ones would show the beat of bins against cycles, not the torque.
    pub(crate) fn cycle_bins(&self) -> Vec<Bin> {
        self.wide_bins(self.bins_for_cycles())
    }

    /// Bins of this many.
    pub(crate) fn wide_bins(&self, count: usize) -> Vec<Bin> {
        merged(&self.bins, count.max(1))
    }

    /// Average number of bins that a few whole cycles take.
    pub(crate) fn bins_for_cycles(&self) -> usize {
        const CYCLES: u64 = 3;
        const FEWEST_BINS: usize = 60;
        let active = self.bins.iter().filter(|bin| bin.is_active()).count() as u64;
        let wanted = (CYCLES * active).checked_div(self.breaks()).unwrap_or(1);
        let at_most = (self.bins.len() / FEWEST_BINS).max(1);
        usize::try_from(wanted).map_or(at_most, |n| n.clamp(1, at_most))
    }
}

fn merged(bins: &[Bin], count: usize) -> Vec<Bin> {
    bins.chunks(count)
        .map(|group| {
            let mut bin = Bin::default();
            for part in group {
                bin.append(part);
            }
            bin
        })
        .collect()
}

/// Lowest and highest values of bins as two lines: steps, since extremes belong to the whole bin.
pub(crate) fn edges(bins: &[Bin]) -> [Vec<Point>; 2] {
    let edge = |pick: fn(&Bin) -> f64| -> Vec<Point> {
        bins.iter()
            .filter(|bin| !bin.value.is_empty())
            .flat_map(|bin| bin.ends().map(|time| Point::new(time, pick(bin))))
            .collect()
    };
    [edge(|bin| bin.value.low), edge(|bin| bin.value.high)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(time_s: f64, kind: EventKind, from: i8, to: i8) -> EventRecord {
        EventRecord {
            time_s,
            kind,
            from,
            to,
            theta_rad: 0.0,
            omega_rad_s: 1.0,
            torque_before_nm: 0.4,
            torque_after_nm: 0.2,
        }
    }

    #[test]
    fn extremes_survive_any_number_of_rows() {
        for expected in [0, 100_000, 10_000_000] {
            let mut envelope = Envelope::new(expected);
            for i in 0..100_000_u32 {
                let torque = if i == 4321 { 7.0 } else { 0.5 };
                envelope.row(f64::from(i), torque, Some(Phase::Stick));
            }
            let envelope = envelope.finish();
            assert!(envelope.bins.len() <= Envelope::CAPACITY + 1);
            let highs = envelope.bins.iter().map(|b| b.value.high);
            assert_eq!(highs.fold(0.0, f64::max), 7.0);
            let rows: u64 = envelope.bins.iter().map(|b| b.count).sum();
            assert_eq!(rows, 100_000);
        }
    }

    #[test]
    fn nothing_of_the_time_in_which_the_object_is_off_counts_for_a_phase() {
        let mut envelope = Envelope::new(1);
        envelope.row(0.0, 0.0, Some(Phase::Stick));
        envelope.event(&event(0.5, EventKind::Break, 0, 1));
        for time in [1.0, 1.5, 2.0] {
            envelope.off(time);
            envelope.row(time, 0.0, None);
        }
        envelope.row(2.5, 0.0, Some(Phase::Stick));
        envelope.row(3.0, 0.0, Some(Phase::Stick));
        let envelope = envelope.finish();
        let sum = |pick: fn(&Bin) -> f64| envelope.bins.iter().map(pick).sum::<f64>();
        assert_eq!(sum(|bin| bin.stick_s), 1.0);
        assert_eq!(sum(|bin| bin.positive_s), 0.5);
        assert_eq!(sum(|bin| bin.negative_s), 0.0);
    }

    #[test]
    fn phase_times_come_from_the_events() {
        let mut envelope = Envelope::new(1);
        envelope.row(0.0, 0.0, Some(Phase::Stick));
        envelope.event(&event(0.25, EventKind::Break, 0, 1));
        envelope.event(&event(0.75, EventKind::Stick, 1, 0));
        envelope.row(1.0, f64::NAN, Some(Phase::Stick));
        let envelope = envelope.finish();
        let shares = envelope.bins.last().and_then(Bin::shares);
        assert_eq!(
            shares,
            Some(Shares {
                stick: 0.5,
                positive: 0.5,
                negative: 0.0
            })
        );
        assert_eq!(envelope.breaks(), 1);
        assert_eq!(envelope.bins.last().map(|b| b.value.high), Some(0.4));
    }
}
