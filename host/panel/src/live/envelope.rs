//! The lowest and the highest value of every few milliseconds.
//!
//! A screen has 60 pictures a second and some hundred pixels, the device 20,000 samples
//! a second: a bin holds the extremes of its samples, so that the shortest spike reaches
//! the screen, and everything that happened in its time.

use crepitus_model::render::effects::Phases;
use crepitus_plant::Extremes;
use crepitus_protocol::TICKS_PER_S;
use crepitus_protocol::state::LimitReason;
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_recording::Row;
use std::collections::VecDeque;

/// Events and conditions in a bin, beside the effects' states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Marks(pub u16);

impl Marks {
    /// The imaginary object stuck.
    pub const STICK: u16 = 1;
    /// The imaginary object slipped.
    pub const SLIP: u16 = 1 << 1;
    /// The torque differed from the model's, for another reason than being disarmed.
    pub const LIMITED: u16 = 1 << 2;
    /// The motor was driven.
    pub const ENERGISED: u16 = 1 << 3;
    /// Parameters were ramping.
    pub const SETTLING: u16 = 1 << 4;
    /// A count of the encoder was rejected.
    pub const LOST: u16 = 1 << 5;
    /// Rendering was late.
    pub const LATE: u16 = 1 << 6;
    /// There is no sample: all extremes are empty.
    pub const GAP: u16 = 1 << 7;
    /// The leg is beyond an empty end, which [`Pain`](crate::live::Pain) knows.
    pub const HURTS: u16 = 1 << 8;

    /// Returns the marks without those of the imaginary object's motion.
    #[must_use]
    pub fn without_phase(self) -> Self {
        Self(self.0 & !(Self::STICK | Self::SLIP))
    }

    fn of(flags: SampleFlags) -> u16 {
        let stuck = if flags.phase_sign() == 0 {
            Self::STICK
        } else {
            Self::SLIP
        };
        let is_limited = !matches!(flags.limit(), LimitReason::None | LimitReason::NotArmed);
        [
            (is_limited, Self::LIMITED),
            (flags.has(SampleFlags::ENERGISED), Self::ENERGISED),
            (flags.has(SampleFlags::SETTLING), Self::SETTLING),
            (flags.has(SampleFlags::LOST), Self::LOST),
            (flags.has(SampleFlags::LATE), Self::LATE),
        ]
        .into_iter()
        .filter_map(|(has, mark)| has.then_some(mark))
        .fold(stuck, |marks, mark| marks | mark)
    }
}

/// Some consecutive samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bin {
    /// Torque commanded to the motor, N·m.
    pub torque_nm: Extremes<f32>,
    /// Torque of the model, N·m.
    pub model_nm: Extremes<f32>,
    /// Speed, rad/s.
    pub speed_rad_s: Extremes<f32>,
    /// Angle, rad.
    pub angle_rad: Extremes<f32>,
    /// Angle at which a hand wants the leg, rad; none without one.
    pub hand_rad: Extremes<f32>,
    /// The [states](crate::live::STATES) that occurred.
    pub states: u32,
    /// Sticks that broke.
    pub breaks: u16,
    /// The rest.
    pub marks: Marks,
}

impl Bin {
    /// A time without samples.
    pub fn gap() -> Self {
        Self {
            marks: Marks(Marks::GAP),
            ..Self::default()
        }
    }

    /// Extends it by another bin. A gap adds nothing.
    pub fn join(&mut self, other: &Self) {
        if other.marks.0 & Marks::GAP != 0 {
            return;
        }
        if self.marks.0 & Marks::GAP != 0 {
            *self = *other;
            return;
        }
        self.torque_nm.join(other.torque_nm);
        self.model_nm.join(other.model_nm);
        self.speed_rad_s.join(other.speed_rad_s);
        self.angle_rad.join(other.angle_rad);
        self.hand_rad.join(other.hand_rad);
        self.states |= other.states;
        self.breaks = self.breaks.saturating_add(other.breaks);
        self.marks.0 |= other.marks.0;
    }
}

/// Makes numbered bins of rows, and none where there are no rows. Bin `k` has the samples of the
/// times from `k` lengths of a bin to `k + 1`.
#[derive(Clone, Debug)]
pub struct Bins {
    rows_per_bin: u64,
    /// The bin at hand and its number; none before the first row.
    open: Option<(u64, Bin)>,
    /// The states of the last phases: they are mostly the same.
    last: (Phases, u32),
}

impl Bins {
    /// Returns a maker of bins of `rows_per_bin` samples, at least 1.
    pub fn new(rows_per_bin: u32) -> Self {
        Self {
            rows_per_bin: u64::from(rows_per_bin.max(1)),
            open: None,
            last: (Phases::default(), 0),
        }
    }

    /// Takes the next sample, and returns the bin that it completes. Times grow; a sample whose time
    /// does not belongs to the bin at hand.
    pub fn take(&mut self, row: &Row) -> Option<(u64, Bin)> {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "times are at least 0, and saturate"
        )]
        let tick = (row.time_s * f64::from(TICKS_PER_S)).round() as u64;
        let number = tick / self.rows_per_bin;
        let complete = self.open.take_if(|(open, _)| *open < number);
        let (_, bin) = self.open.get_or_insert_with(|| (number, Bin::default()));
        if self.last.0 != row.phases {
            self.last = (row.phases, row.phases.states());
        }
        bin.torque_nm.add(row.torque_nm);
        bin.model_nm.add(row.model_torque_nm);
        bin.speed_rad_s.add(row.omega_rad_s);
        #[expect(clippy::cast_possible_truncation, reason = "a drawn angle")]
        bin.angle_rad.add(row.angle_rad as f32);
        bin.states |= self.last.1;
        let broke = row.flags.has(SampleFlags::BREAK);
        bin.breaks = bin.breaks.saturating_add(u16::from(broke));
        bin.marks.0 |= Marks::of(row.flags);
        complete
    }

    /// Returns the last bin, which may have fewer samples.
    pub fn finish(self) -> Option<(u64, Bin)> {
        self.open
    }
}

/// The latest bins of a live view, with empty ones where there are no samples.
#[derive(Clone, Debug)]
pub struct Envelope {
    bins: Bins,
    /// Number of the bin after the last complete one.
    next: u64,
    /// Complete bins, of which the last is the one before `next`.
    ready: VecDeque<Bin>,
}

/// Gaps of more bins are cut: a view shows ten seconds or a minute.
const MOST_GAPS: u64 = 20_000;

impl Envelope {
    /// Returns an empty envelope with bins of `rows_per_bin` samples, at least 1.
    pub fn new(rows_per_bin: u32) -> Self {
        Self {
            bins: Bins::new(rows_per_bin),
            next: 0,
            ready: VecDeque::new(),
        }
    }

    /// Length of a bin, s.
    pub fn bin_s(&self) -> f64 {
        crepitus_recording::seconds(self.bins.rows_per_bin)
    }

    /// Takes the next sample. Times grow; one that does not belongs to the bin at hand.
    pub fn take(&mut self, row: &Row) {
        let is_first = self.bins.open.is_none();
        let complete = self.bins.take(row);
        let open = self.bins.open.map_or(0, |(number, _)| number);
        if let Some((_, bin)) = complete {
            self.ready.push_back(bin);
            self.next += 1;
            // What is before a cut gap cannot stand beside it.
            let gaps = open - self.next;
            if gaps > MOST_GAPS {
                self.ready.clear();
            }
            let gaps = gaps.min(MOST_GAPS);
            self.ready.extend((0..gaps).map(|_| Bin::gap()));
            self.next = open;
        } else if is_first {
            self.next = open;
        }
    }

    /// Adds the angle at which a hand wants the leg now, rad, to the bin at hand.
    pub fn hold(&mut self, angle_rad: f64) {
        if let Some((_, bin)) = &mut self.bins.open {
            #[expect(clippy::cast_possible_truncation, reason = "a drawn angle")]
            bin.hand_rad.add(angle_rad as f32);
        }
    }

    /// Number of the first complete bin, and all of them, oldest first; they are removed.
    pub fn complete(&mut self) -> (u64, Vec<Bin>) {
        let count = u64::try_from(self.ready.len()).unwrap_or(0);
        let first = self.next.saturating_sub(count);
        (first, self.ready.drain(..).collect())
    }

    /// Number of the first bin, and all complete ones with the last, which may have fewer samples.
    pub fn finish(mut self) -> (u64, Vec<Bin>) {
        if let Some((number, bin)) = self.bins.open {
            self.ready.push_back(bin);
            self.next = number + 1;
        }
        self.complete()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn row(tick: u64, torque_nm: f32) -> Row {
        Row {
            tick,
            time_s: crepitus_recording::seconds(tick),
            torque_nm,
            ..Row::default()
        }
    }

    #[test]
    fn a_spike_of_one_sample_is_in_its_bin() {
        let mut envelope = Envelope::new(100);
        for tick in 0..400 {
            envelope.take(&row(tick, if tick == 217 { 3.0 } else { 0.5 }));
        }
        let (first, bins) = envelope.finish();
        assert_eq!((first, bins.len()), (0, 4));
        let highest: Vec<_> = bins.iter().map(|bin| bin.torque_nm.high).collect();
        assert_eq!(highest, [0.5, 0.5, 3.0, 0.5]);
        assert!(bins.iter().all(|bin| bin.torque_nm.low == 0.5));
    }

    #[test]
    fn a_hand_is_in_the_bins_in_which_it_held_the_leg() {
        let mut envelope = Envelope::new(100);
        envelope.hold(9.0);
        for tick in 0..300 {
            envelope.take(&row(tick, 0.0));
            if (150..160).contains(&tick) {
                envelope.hold(if tick == 155 { 0.75 } else { 0.5 });
            }
        }
        let bins = envelope.finish().1;
        let held: Vec<_> = bins.iter().map(|bin| !bin.hand_rad.is_empty()).collect();
        assert_eq!(held, [false, true, false]);
        assert_eq!((bins[1].hand_rad.low, bins[1].hand_rad.high), (0.5, 0.75));
    }

    #[test]
    fn a_gap_is_bins_without_samples() {
        let mut envelope = Envelope::new(100);
        envelope.take(&row(50, 1.0));
        envelope.take(&row(350, 2.0));
        let (first, bins) = envelope.finish();
        assert_eq!((first, bins.len()), (0, 4));
        assert!(bins[1].torque_nm.is_empty() && bins[2].marks.0 == Marks::GAP);
        assert_eq!(bins[3].torque_nm.low, 2.0);
    }

    #[test]
    fn a_gap_of_an_hour_is_cut() {
        let mut envelope = Envelope::new(1);
        envelope.take(&row(0, 1.0));
        envelope.take(&row(72_000_000, 2.0));
        let (first, bins) = envelope.finish();
        assert_eq!(bins.len(), 20_001);
        assert_eq!(first, 72_000_000 - 20_000);
    }

    #[test]
    fn a_view_that_joins_late_begins_there() {
        let mut envelope = Envelope::new(100);
        envelope.take(&row(1_000_050, 1.0));
        envelope.take(&row(1_000_150, 1.0));
        assert_eq!(envelope.complete().0, 10_000);
    }

    proptest! {
        /// However often one looks, frames join without a seam, and nothing is lost.
        #[test]
        fn frames_join(gaps in prop::collection::vec(1_u64..400, 1..300), every in 1_usize..40) {
            let mut envelope = Envelope::new(100);
            let (mut tick, mut next, mut low) = (0, None, f32::INFINITY);
            let mut seen = f32::INFINITY;
            for (count, gap) in gaps.iter().enumerate() {
                tick += gap;
                #[expect(clippy::cast_precision_loss, reason = "small")]
                let value = -((tick * 7_919 % 1_000) as f32);
                low = low.min(value);
                envelope.take(&row(tick, value));
                if count % every == 0 {
                    let (first, bins) = envelope.complete();
                    if !bins.is_empty() {
                        prop_assert!(next.is_none_or(|next| next == first));
                        next = Some(first + bins.len() as u64);
                    }
                    seen = bins.iter().fold(seen, |low, bin| low.min(bin.torque_nm.low));
                }
            }
            let (first, bins) = envelope.finish();
            prop_assert!(next.is_none_or(|next| next == first));
            prop_assert_eq!(first + bins.len() as u64, tick / 100 + 1);
            prop_assert_eq!(bins.iter().fold(seen, |low, bin| low.min(bin.torque_nm.low)), low);
        }
    }
}
