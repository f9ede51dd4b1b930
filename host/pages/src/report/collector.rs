//! Collects the data of the figures from rows and events, in one pass.
//!
//! Memory does not grow with the run: each part has a bound of its own, and
//! together they stay below a few megabytes.

use crepitus_scene::run::PlantEnergySummary;
use crepitus_scene::trace::{Column, EventRecord, SymptomEvent};

use crate::plot::palette::RANGE;
use crate::plot::{Mark, Plot, Thinned};
use crate::report::channels::{Channels, Sample, Setup, TorqueLevels};
use crate::report::choice::Choice;
use crate::report::envelope::Envelope;
use crate::report::fast_part::{FastPart, Waiting};
use crate::report::hysteresis::Hysteresis;
use crate::report::overlay::{self, Comparison, Difference, Measured};
use crate::report::plant::{Plant, PlantCollector};
use crate::report::spectrum::{Spectrum, Welch};
use crate::report::symptoms::Symptoms;
use crate::report::window::Window;

/// Bins of the lines over the whole run: more than a chart has pixels.
const LINE: usize = 1600;

/// Gaps that are drawn one by one: more than a chart has pixels.
const GAPS: usize = 2000;

/// Collects a bounded amount of data while a run streams by.
///
/// An event at time t comes before the first row with a time of t or later.
#[derive(Debug)]
pub struct Collector {
    channels: Channels,
    levels: Option<TorqueLevels>,
    rows: u64,
    /// Columns that have a value in every row: the first so many.
    always: usize,
    broken_rows: u64,
    angle: Thinned,
    omega: Thinned,
    encoder_omega: Thinned,
    envelope: Envelope,
    whole: Window,
    choice: Choice,
    hysteresis: Hysteresis,
    welch: Option<Welch>,
    plant: Option<PlantCollector>,
    symptoms: Option<Symptoms>,
    /// Fast part of the hand torque; only where there is a hand.
    fast: Option<FastPart>,
    marks: Vec<Mark>,
    pushes: Vec<(f64, f64)>,
    gaps: Vec<(f64, f64)>,
    comparisons: Vec<Comparison>,
}

/// Collected data of a complete run.
#[derive(Debug)]
pub struct Figures {
    pub(crate) levels: Option<TorqueLevels>,
    pub(crate) rows: u64,
    pub(crate) broken_rows: u64,
    pub(crate) has_torque: bool,
    pub(crate) has_object: bool,
    pub(crate) angle: Thinned,
    pub(crate) omega: Thinned,
    pub(crate) encoder_omega: Thinned,
    pub(crate) envelope: Envelope,
    /// The whole run, as a window; its phases and events are complete only if
    /// it did not overflow.
    pub(crate) whole: Window,
    pub(crate) onset: Option<Window>,
    pub(crate) fastest: Option<Window>,
    pub(crate) hysteresis: Hysteresis,
    pub(crate) spectrum: Option<Spectrum>,
    pub(crate) plant: Option<Plant>,
    pub(crate) symptoms: Option<Symptoms>,
    pub(crate) balance: Option<PlantEnergySummary>,
    /// Times at which parameters changed, or the device restarted.
    pub(crate) marks: Vec<Mark>,
    /// Start and end of each push of the motor to arm it, s.
    pub(crate) pushes: Vec<(f64, f64)>,
    /// Times of the last row before missing ones and of the first one after them, s.
    pub(crate) gaps: Vec<(f64, f64)>,
    /// Measured curves.
    pub(crate) comparisons: Vec<Comparison>,
}

impl Figures {
    /// Difference of each measured curve from the run.
    pub fn differences(&self) -> Vec<Difference> {
        overlay::differences(&self.comparisons)
    }

    /// Adds where the energy of the plant came from and went.
    pub fn set_balance(&mut self, balance: PlantEnergySummary) {
        self.balance = Some(balance);
    }

    /// Draws on a panel over time where rows are missing and the marked moments,
    /// after the lines; the first panel of a chart names the moments, by
    /// [`Panel::moments`](crate::plot::Panel::moments).
    pub(crate) fn draw_marks(&self, plot: &mut Plot) {
        plot.blank(&self.gaps);
        plot.moments(&self.marks);
    }

    /// Shades on a panel of the motor's torque when it was pushed.
    pub(crate) fn shade_pushes(&self, plot: &mut Plot) {
        let (low, high) = (plot.x().low(), plot.x().high());
        let seen = self
            .pushes
            .iter()
            .filter(|(from, to)| *to >= low && *from <= high);
        plot.shade(seen.copied(), RANGE);
    }

    /// Changes of parameters, and beginnings of pushes: the moments of a panel of the motor's torque.
    pub(crate) fn motor_marks(&self) -> Vec<Mark> {
        let pushes = self.pushes.iter().map(|(from, _)| Mark {
            at: *from,
            name: "arming: polarity test".to_owned(),
        });
        pushes.chain(self.marks.iter().cloned()).collect()
    }

    /// Draws what [`draw_marks`](Self::draw_marks) draws, with the beginnings of pushes.
    pub(crate) fn draw_motor_marks(&self, plot: &mut Plot) {
        plot.blank(&self.gaps);
        plot.moments(&self.motor_marks());
    }

    /// Number of bins of a [`Course`](crate::report::course::Course) to draw as one,
    /// if there are too many cycles to draw lines.
    pub(crate) fn bins(&self) -> Option<usize> {
        self.whole
            .overflowed()
            .then(|| self.envelope.bins_for_cycles())
    }
}

impl Collector {
    /// Ready for the first row.
    pub fn new(setup: &Setup) -> Self {
        let channels = Channels::find(setup.columns);
        let fast = channels
            .has_hand()
            .then(|| FastPart::new(setup.row_step_s))
            .flatten();
        let mean_s = fast.as_ref().map_or(f64::NAN, FastPart::mean_s);
        let plant = PlantCollector::new(&channels, setup, mean_s);
        let welch = if plant.is_some() {
            Welch::differencing
        } else {
            Welch::new
        };
        Self {
            channels,
            levels: setup.levels.filter(|levels| {
                [levels.restart_nm, levels.kinetic_nm, levels.static_nm]
                    .iter()
                    .all(|level| level.is_finite())
            }),
            rows: 0,
            always: setup.columns.len(),
            broken_rows: 0,
            angle: Thinned::new(LINE),
            omega: Thinned::new(LINE),
            encoder_omega: Thinned::new(LINE),
            envelope: Envelope::new(setup.rows_expected),
            whole: Window::new(),
            choice: Choice::new(),
            hysteresis: Hysteresis::new(),
            welch: channels
                .has_torque()
                .then(|| welch(setup.row_step_s, setup.rows_expected))
                .flatten(),
            plant,
            symptoms: Symptoms::new(setup),
            fast,
            marks: Vec::new(),
            pushes: Vec::new(),
            gaps: Vec::new(),
            comparisons: Vec::new(),
        }
    }

    /// Compares measured curves with the rows that will come, which have these columns; those
    /// without a column are left out.
    pub fn compare(&mut self, measured: Vec<Measured>, columns: &[Column]) {
        let found = measured
            .into_iter()
            .filter_map(|measured| Comparison::new(measured, columns));
        self.comparisons.extend(found);
    }

    /// Sets the column from which on a row may have no value: NaN is none there.
    pub fn may_lack_from(&mut self, column: usize) {
        self.always = column;
    }

    /// Takes one row of the trace, in the order of the columns. A value that
    /// is not finite is left out of the figures, and the page says so.
    pub fn row(&mut self, values: &[f64]) {
        self.rows += 1;
        let is_broken = |(column, value): (usize, &f64)| {
            let is_none = value.is_nan() && column >= self.always;
            !is_none && !value.is_finite()
        };
        if values.iter().enumerate().any(is_broken) {
            self.broken_rows += 1;
        }
        let mut sample = self.channels.sample(values);
        sample.is_off = self.channels.is_off(values, self.always);
        if sample.time.is_nan() {
            return;
        }
        for comparison in &mut self.comparisons {
            comparison.row(sample.time, values);
        }
        self.angle.push(sample.time, sample.angle);
        self.omega.push(sample.time, sample.omega);
        self.encoder_omega.push(sample.time, sample.encoder_omega);
        if let Some(plant) = &mut self.plant {
            plant.row(&sample, values);
        }
        if let Some(symptoms) = &mut self.symptoms {
            symptoms.row(&sample, values);
        }
        if let Some(fast) = &mut self.fast {
            fast.row(sample);
            self.complete_due_windows();
        } else {
            self.take_row(&sample);
        }
    }

    /// Marks a moment on every chart over time: parameters changed, or the
    /// device restarted.
    pub fn mark(&mut self, mark: Mark) {
        self.marks.push(mark);
    }

    /// Takes a stretch of time, s, in which arming pushed the motor to test its
    /// polarity; its torque is none that was rendered.
    pub fn arming_push(&mut self, from_s: f64, to_s: f64) {
        self.pushes.push((from_s, to_s));
    }

    /// Rows between these times, s, are missing, or the device restarted between them; the next
    /// row is the one after them.
    pub fn gap(&mut self, from_s: f64, to_s: f64) {
        if self.gaps.len() < GAPS {
            self.gaps.push((from_s, to_s));
        } else if let Some((_, end_s)) = self.gaps.last_mut() {
            // Rather too much is missing than too little.
            *end_s = to_s;
        }
        self.comparisons.iter_mut().for_each(Comparison::gap);
        self.envelope.gap();
        self.choice.gap();
        self.hysteresis.gap();
        if let Some(symptoms) = &mut self.symptoms {
            symptoms.gap();
        }
        if let Some(welch) = &mut self.welch {
            welch.gap();
        }
    }

    /// Takes one event.
    pub fn event(&mut self, event: &EventRecord) {
        if self.channels.has_torque() && event.time_s.is_finite() {
            if let Some(fast) = &mut self.fast {
                fast.event(*event);
            } else {
                self.take_event(event);
            }
        }
    }

    /// Takes an event of a symptom besides crepitus.
    pub fn symptom(&mut self, event: &SymptomEvent) {
        if let Some(symptoms) = &mut self.symptoms {
            symptoms.event(event);
        }
    }

    /// The rows and events of which the fast part is known now.
    fn complete_due_windows(&mut self) {
        while let Some(seen) = self.fast.as_mut().and_then(FastPart::next) {
            match seen {
                Waiting::Row(sample) => self.take_row(&sample),
                Waiting::Event(event) => self.take_event(&event),
            }
        }
    }

    fn take_row(&mut self, sample: &Sample) {
        if self.channels.has_hand()
            && let Some(plant) = &mut self.plant
        {
            plant.hand(sample);
        }
        if self.channels.has_torque() {
            if sample.is_off {
                self.envelope.off(sample.time);
                self.choice.gap();
                self.hysteresis.gap();
            } else {
                self.choice.row(sample);
                self.hysteresis
                    .row(sample.angle, sample.omega, sample.theta);
            }
            self.envelope.row(sample.time, sample.torque, sample.phase);
            self.whole.row(sample);
            if let Some(welch) = &mut self.welch {
                welch.push(sample.torque);
            }
        }
    }

    fn take_event(&mut self, event: &EventRecord) {
        let mut event = *event;
        if self.plant.is_some() && self.channels.has_encoder() {
            // The device's estimate; the rows have the shaft's own velocity.
            event.omega_rad_s = f64::NAN;
        }
        let event = &event;
        self.envelope.event(event);
        self.whole.event(event);
        self.choice.event(event);
    }

    /// The run is over.
    pub fn finish(mut self) -> Figures {
        if let Some(fast) = &mut self.fast {
            fast.end();
        }
        self.complete_due_windows();
        let (onset, fastest) = self.choice.finish();
        Figures {
            levels: self.levels,
            rows: self.rows,
            broken_rows: self.broken_rows,
            has_torque: self.channels.has_torque(),
            has_object: self.channels.has_object(),
            angle: self.angle,
            omega: self.omega,
            encoder_omega: self.encoder_omega,
            envelope: self.envelope.finish(),
            whole: self.whole,
            onset,
            fastest,
            hysteresis: self.hysteresis,
            spectrum: self.welch.and_then(Welch::finish),
            plant: self.plant.map(PlantCollector::finish),
            symptoms: self.symptoms.map(Symptoms::finish),
            balance: None,
            marks: self.marks,
            pushes: self.pushes,
            gaps: self.gaps,
            comparisons: self.comparisons,
        }
    }
}

#[cfg(test)]
mod tests;
