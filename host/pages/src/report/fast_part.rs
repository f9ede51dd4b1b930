//! The fast part of the torque at the hand: what is left of it when its slow
//! part, the weight of a leg for one, is taken away.
//!
//! The slow part comes of moving means around each row, over T and over 2T:
//!
//! ```text
//! slow = (4·mean over T − mean over 2T)/3,   T = 0.2 s
//! ```
//!
//! The second mean takes out what the first makes of curvature, so a leg that
//! is moved leaves next to nothing. What vibrates at f keeps the share
//! 1 − (4·sinc fT − sinc 2fT)/3: from 10 Hz on its size to within a fifth, from
//! 20 Hz on to within a tenth; about 7 Hz it is a third larger. Within T of the
//! ends of a run, where a mean would be one-sided and leave some of the slow part,
//! there is no fast part, and none in a run of 2T or less.
//!
//! A mean around a row needs the rows after it, so rows and events are held
//! back by T, together and in order. Memory is bounded: where rows are closer
//! than 12 µs, T is shorter.

use std::collections::VecDeque;

use crepitus_scene::trace::EventRecord;

use crate::report::channels::Sample;

/// A row or an event on its way.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Waiting {
    /// Row with its fast part.
    Row(Sample),
    Event(EventRecord),
}

/// See the module.
#[derive(Debug)]
pub(crate) struct FastPart {
    row_step_s: f64,
    /// Rows in T/2.
    half: usize,
    waiting: VecDeque<Waiting>,
    /// Sums of all hand torques before a row: of those rows that a mean may
    /// still begin or end at.
    sums: VecDeque<f64>,
    /// Number of the row that the first of them is for.
    first: usize,
    rows_in: usize,
    rows_out: usize,
    last: f64,
    ended: bool,
}

impl FastPart {
    /// T, s.
    const MEAN_S: f64 = 0.2;
    /// Rows in T/2: fewer make no mean, more are not kept.
    const FEWEST: f64 = 4.0;
    const MOST: f64 = 8192.0;

    /// None if the rows are too far apart to tell slow from fast.
    pub(crate) fn new(row_step_s: f64) -> Option<Self> {
        let half = 0.5 * Self::MEAN_S / row_step_s;
        // Between 4 and 8192, so it fits.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        (half.is_finite() && half >= Self::FEWEST).then(|| Self {
            row_step_s,
            half: half.min(Self::MOST).round() as usize,
            waiting: VecDeque::new(),
            sums: VecDeque::from([0.0]),
            first: 0,
            rows_in: 0,
            rows_out: 0,
            last: 0.0,
            ended: false,
        })
    }

    /// T as it is, s.
    pub(crate) fn mean_s(&self) -> f64 {
        2.0 * self.half as f64 * self.row_step_s
    }

    /// Takes a row. A torque that is not finite repeats the one before.
    pub(crate) fn row(&mut self, sample: Sample) {
        if sample.hand_torque.is_finite() {
            self.last = sample.hand_torque;
        }
        let sum = self.sums.back().map_or(0.0, |sum| sum + self.last);
        self.sums.push_back(sum);
        self.rows_in += 1;
        self.waiting.push_back(Waiting::Row(sample));
    }

    /// Takes an event.
    pub(crate) fn event(&mut self, event: EventRecord) {
        self.waiting.push_back(Waiting::Event(event));
    }

    /// No more rows will come: the rest is due.
    pub(crate) fn end(&mut self) {
        self.ended = true;
    }

    /// The next row or event, if it is due.
    pub(crate) fn next(&mut self) -> Option<Waiting> {
        let ahead = self.rows_in - self.rows_out;
        if let Some(Waiting::Row(_)) = self.waiting.front()
            && !self.ended
            && ahead <= 2 * self.half
        {
            return None;
        }
        let mut seen = self.waiting.pop_front()?;
        if let Waiting::Row(sample) = &mut seen {
            // Nearer to an end the means would be one-sided.
            if self.rows_out >= 2 * self.half && ahead > 2 * self.half {
                let slow = (4.0 * self.mean(self.half) - self.mean(2 * self.half)) / 3.0;
                sample.hand_fast = sample.hand_torque - slow;
            }
            self.rows_out += 1;
            while self.first + 2 * self.half < self.rows_out {
                self.sums.pop_front();
                self.first += 1;
            }
        }
        Some(seen)
    }

    /// Mean over `reach` rows to both sides of the next row.
    fn mean(&self, reach: usize) -> f64 {
        let from = self.rows_out.saturating_sub(reach);
        let to = self.rows_out + reach + 1;
        let sum = |row: usize| {
            let place = row.checked_sub(self.first);
            place
                .and_then(|place| self.sums.get(place))
                .copied()
                .unwrap_or(f64::NAN)
        };
        (sum(to) - sum(from)) / (to - from) as f64
    }

    #[cfg(test)]
    fn stored(&self) -> usize {
        self.waiting.len() + self.sums.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::EventKind;
    use std::f64::consts::TAU;

    const STEP: f64 = 1e-3;

    fn sample(time: f64, hand_torque: f64) -> Sample {
        Sample {
            time,
            hand_torque,
            ..Sample::nothing()
        }
    }

    /// The fast parts of `rows` rows of a torque.
    fn fast(rows: u32, torque: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        let mut part = FastPart::new(STEP).expect("close rows");
        let mut out = Vec::new();
        let mut take = |part: &mut FastPart| {
            while let Some(Waiting::Row(sample)) = part.next() {
                out.push((sample.time, sample.hand_fast));
            }
        };
        for i in 0..rows {
            let time = f64::from(i) * STEP;
            part.row(sample(time, torque(time)));
            take(&mut part);
            assert!(part.stored() < 1000);
        }
        part.end();
        take(&mut part);
        out
    }

    #[test]
    fn what_vibrates_stays_and_weight_goes() {
        // A leg through 60° in a second and a half, and a cycle's vibration.
        let weight = |t: f64| -20.0 + 7.0 * (TAU * 0.3 * t).cos();
        let shake = |t: f64| 0.02 * (TAU * 31.8 * t).sin();
        let rows = fast(5001, |t| weight(t) + shake(t));
        assert_eq!(rows.len(), 5001);
        let known: Vec<_> = rows
            .into_iter()
            .filter(|(_, fast)| fast.is_finite())
            .collect();
        for (time, fast) in &known {
            assert!((fast - shake(*time)).abs() < 0.003, "{time}: {fast}");
        }
        // All of it but T at either end, where the slope of a moved leg was 40 times what vibrates.
        let ends = [known.first(), known.last()].map(|row| row.map(|(time, _)| *time));
        assert_eq!(ends, [Some(0.2), Some(4.8)]);
    }

    #[test]
    fn every_row_comes_out_once_in_order_at_any_length() {
        for rows in [1, 2, 200, 400, 401, 402, 1000] {
            let out = fast(rows, |_| 3.0);
            assert_eq!(out.len(), rows as usize);
            assert!(out.windows(2).all(|w| w[0].0 < w[1].0));
            for (row, (_, fast)) in (0..).zip(out) {
                let is_known = row >= 200 && row + 200 < rows;
                assert_eq!(fast.is_finite(), is_known, "{row} of {rows}");
                assert!(!is_known || fast.abs() < 1e-12);
            }
        }
        assert!(FastPart::new(0.05).is_none());
        assert!(FastPart::new(0.0).is_none());
        assert!(FastPart::new(f64::NAN).is_none());
    }

    #[test]
    fn events_keep_their_place() {
        let event = EventRecord {
            time_s: 0.5 * STEP,
            kind: EventKind::Break,
            from: 0,
            to: 1,
            theta_rad: 0.0,
            omega_rad_s: 1.0,
            torque_before_nm: 0.4,
            torque_after_nm: 0.2,
        };
        let mut part = FastPart::new(STEP).expect("close rows");
        part.row(sample(0.0, 1.0));
        part.event(event);
        part.row(sample(STEP, 1.0));
        assert!(part.next().is_none(), "too early");
        part.end();
        let order: Vec<bool> = std::iter::from_fn(|| part.next())
            .map(|seen| matches!(seen, Waiting::Event(_)))
            .collect();
        assert_eq!(order, [false, true, false]);
    }

    #[test]
    fn close_rows_make_the_means_shorter() {
        let part = FastPart::new(1e-6).expect("close rows");
        assert!((part.mean_s() - 0.016_384).abs() < 1e-12);
        let part = FastPart::new(5e-5).expect("close rows");
        assert!((part.mean_s() - 0.2).abs() < 1e-12);
    }
}
