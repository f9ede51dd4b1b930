//! The signals of a run's second half, and their measures.

use super::Measured;
use crate::parallel::Meter;
use crate::watcher::Cancelled;
use crepitus_model::Real;
use crepitus_plant::Extremes;
use crepitus_scene::Scene;
use crepitus_scene::run::{self, FELT_COLUMN, Observer, columns, step_count};
use crepitus_scene::trace::{EventKind, EventRecord};

/// Half of the window whose mean is subtracted, s.
const TREND_S: f64 = 0.05;

/// The largest lag of the search, s.
const MOST_LAG_S: f64 = 0.04;

/// Share of the best correlation that makes a peak as good.
const GOOD_PEAK: f64 = 0.9;

/// The most ticks of the correlation.
const LAG_TICKS: usize = 20_000;

/// Signals of a run in its second half, tick by tick.
pub(super) struct Signals {
    tick_s: f64,
    from_s: f64,
    model_nm: Vec<f64>,
    hand_nm: Vec<f64>,
    omega_rad_s: Extremes<f64>,
    breaks_s: Vec<f64>,
    sticks_s: Vec<f64>,
    last_stick_s: Option<f64>,
    places: Places,
}

/// Indices of the recorded columns.
struct Places {
    omega: usize,
    model: usize,
    hand: usize,
}

struct SignalObserver<'a> {
    signals: Signals,
    meter: &'a Meter,
}

impl Observer for SignalObserver<'_> {
    type Error = Cancelled;

    fn row(&mut self, values: &[f64]) -> Result<(), Cancelled> {
        let s = &mut self.signals;
        if values[0] >= s.from_s {
            s.model_nm.push(values[s.places.model]);
            s.hand_nm.push(values[s.places.hand]);
            s.omega_rad_s.add(values[s.places.omega]);
        }
        Ok(())
    }

    fn event(&mut self, event: &EventRecord) -> Result<(), Cancelled> {
        let s = &mut self.signals;
        match event.kind {
            EventKind::Stick => s.last_stick_s = Some(event.time_s),
            EventKind::Break if event.time_s >= s.from_s => {
                s.breaks_s.push(event.time_s);
                s.sticks_s
                    .extend(s.last_stick_s.map(|began| event.time_s - began));
            }
            _ => {}
        }
        Ok(())
    }

    fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
        if self.meter.is_stopped() {
            return Err(Cancelled);
        }
        Ok(())
    }
}

impl Signals {
    /// Runs `scene` and records its signals.
    pub(super) fn of(scene: &Scene, meter: &Meter) -> Result<Self, String> {
        let mut scene = scene.clone();
        scene.trace_step_s = scene.step_s();
        let names: Vec<_> = columns(&scene).iter().map(|c| c.name).collect();
        let place = |name: &str| names.iter().position(|n| *n == name);
        let model = place("torque_nm").ok_or("the scene has no joint")?;
        let mut observer = SignalObserver {
            signals: Self {
                tick_s: scene.step_s(),
                from_s: scene.duration_s / 2.0,
                model_nm: Vec::new(),
                hand_nm: Vec::new(),
                omega_rad_s: Extremes::default(),
                breaks_s: Vec::new(),
                sticks_s: Vec::new(),
                last_stick_s: None,
                places: Places {
                    omega: place("omega_rad_s").unwrap_or(2),
                    model,
                    hand: place(FELT_COLUMN).unwrap_or(model),
                },
            },
            meter,
        };
        let ran = run::run(&scene, &mut observer);
        meter.add(step_count(&scene));
        ran.map(|_| observer.signals).map_err(|e| e.to_string())
    }

    /// The measures.
    pub(super) fn measure(&self) -> Measured {
        let (hand, model) = (self.fast(&self.hand_nm), self.fast(&self.model_nm));
        let range_nm: Extremes<f64> = hand.iter().copied().collect();
        let between_s: Extremes<f64> = self.breaks_s.windows(2).map(|w| w[1] - w[0]).collect();
        let found = !between_s.is_empty();
        Measured {
            ripple_nm: range_nm.width(),
            ripple_rms_nm: mean(hand.iter().map(|x| x * x)).sqrt(),
            lag_s: self.tick_s * whole(self.lag_ticks(&model, &hand)),
            stick_s: (!self.sticks_s.is_empty()).then(|| mean(self.sticks_s.iter().copied())),
            shortest_s: found.then_some(between_s.low),
            longest_s: found.then_some(between_s.high),
            slowest_rad_s: self.omega_rad_s.low,
            fastest_rad_s: self.omega_rad_s.high,
        }
    }

    /// The fast parts of both torques over the last `stretch_s`, against time.
    pub(super) fn last(&self, stretch_s: f64) -> (Points, Points) {
        let reach = self.ticks(TREND_S);
        let points = |values: &[f64]| {
            let fast = self.fast(values);
            let skipped = fast.len().saturating_sub(self.ticks(stretch_s));
            let times = (reach..).map(|i| self.from_s + self.tick_s * whole(i));
            times.zip(fast).skip(skipped).collect()
        };
        (points(&self.model_nm), points(&self.hand_nm))
    }

    fn ticks(&self, stretch_s: f64) -> usize {
        usize::try_from((stretch_s / self.tick_s).whole()).unwrap_or(0)
    }

    /// Values minus their mean over 0.1 s around, without the ends.
    fn fast(&self, values: &[f64]) -> Vec<f64> {
        let reach = self.ticks(TREND_S);
        let window = 2 * reach + 1;
        let mut sum: f64 = values.iter().take(window).sum();
        let mut fast = Vec::new();
        for (i, around) in values.windows(window).enumerate() {
            if i > 0 {
                sum += around[window - 1] - values[i - 1];
            }
            fast.push(around[reach] - sum / whole(window));
        }
        fast
    }

    /// Lag of `late` behind `early`, ticks, by best correlation.
    fn lag_ticks(&self, early: &[f64], late: &[f64]) -> usize {
        let most = self.ticks(MOST_LAG_S);
        let length = early.len().saturating_sub(most).min(LAG_TICKS);
        let from = early.len().saturating_sub(length + most);
        let correlation = |lag: usize| -> f64 {
            early[from..from + length]
                .iter()
                .zip(&late[from + lag..])
                .map(|(a, b)| a * b)
                .sum()
        };
        let last = most.min(early.len().saturating_sub(from + length));
        let found: Vec<f64> = (0..=last).map(correlation).collect();
        // Grating is periodic: take the first peak as good as the best.
        let good = GOOD_PEAK * found.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let at = |lag: usize| found.get(lag).copied().unwrap_or(f64::NEG_INFINITY);
        (0..=last)
            .find(|&lag| at(lag) >= good && at(lag) >= at(lag + 1))
            .unwrap_or(0)
    }
}

/// Points of a line.
type Points = Vec<(f64, f64)>;

fn whole(n: usize) -> f64 {
    f64::from_whole(u64::try_from(n).unwrap_or(u64::MAX))
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0), |(sum, n), x| (sum + x, n + 1));
    sum / whole(n)
}
