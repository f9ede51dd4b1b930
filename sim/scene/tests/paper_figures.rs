//! The paper's words on its Figs. 8 and 9, counted in the scenes that stand for them:
//! "In the sticking phase, the presented torque increased and angular velocity decreased. On the
//! contrary, in the slipping phase, the presented torque decreased and angular velocity increased."
//!
//! `cargo test -p crepitus-scene --test paper_figures -- --nocapture` prints the counts.

use crepitus_scene::run::columns;
use crepitus_scene::{Observer, Overrides, Scene, run, shipped};
use std::convert::Infallible;
use std::path::Path;

const STEP_S: f64 = 5e-5;

/// Columns of a run, a row a step.
struct Signals {
    places: [usize; 3],
    is_stick: Vec<bool>,
    sensor_nm: Vec<f64>,
    link_rad_s: Vec<f64>,
}

impl Observer for Signals {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        let [phase, sensor, link] = self.places;
        self.is_stick.push(values[phase] == 0.0);
        self.sensor_nm.push(values[sensor]);
        self.link_rad_s.push(values[link]);
        Ok(())
    }
}

impl Signals {
    fn of(scene: &Scene) -> Self {
        let place = |name| {
            let found = columns(scene).iter().position(|column| column.name == name);
            found.unwrap_or_else(|| panic!("no column {name}"))
        };
        let mut signals = Self {
            places: ["phase", "brace_torque_nm", "omega_rad_s"].map(place),
            is_stick: Vec::new(),
            sensor_nm: Vec::new(),
            link_rad_s: Vec::new(),
        };
        run(scene, &mut signals).unwrap();
        signals
    }

    fn shipped(name: &str, changes: &[(&str, &str)]) -> Self {
        let every_step = ("output.trace_step_s".to_owned(), STEP_S.to_string());
        let changes = changes.iter();
        let changes = changes.map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
        let overrides = Overrides {
            set: changes.chain([every_step]).collect(),
            ..Overrides::default()
        };
        Self::of(&shipped::scene(Path::new(name), &overrides).unwrap())
    }

    /// Sticks and slips between two changes of phase: first row, and the one behind the last.
    /// Without what the mean at either end would lack, and the start.
    fn phases(&self) -> Vec<(usize, usize)> {
        let changes: Vec<usize> = (1..self.is_stick.len())
            .filter(|n| self.is_stick[*n] != self.is_stick[n - 1])
            .collect();
        let (first, last) = (rows(0.5), self.is_stick.len() - rows(0.15));
        let pairs = changes.windows(2).map(|pair| (pair[0], pair[1]));
        let long_enough = pairs.filter(|(from, to)| to - from > 1);
        long_enough
            .filter(|(from, to)| *from > first && *to < last)
            .collect()
    }

    /// Direction of a signal, last against first sample of a phase, this many rows later.
    fn counts(&self, signal: &[f64], lag: usize) -> Counts {
        let fast = without_slow_part(signal);
        let mut counts = Counts::default();
        for (from, to) in self.phases() {
            let rises = fast[to - 1 + lag] > fast[from + lag];
            let (rising, all) = if self.is_stick[from] {
                (&mut counts.rising_sticks, &mut counts.sticks)
            } else {
                (&mut counts.rising_slips, &mut counts.slips)
            };
            *rising += usize::from(rises);
            *all += 1;
        }
        counts
    }

    /// Share of the slips' time in which the torque changes by less than `limit_nm_s`.
    fn flat_share(&self, limit_nm_s: f64) -> f64 {
        let slips: Vec<usize> = (1..self.is_stick.len())
            .filter(|n| *n > rows(0.5) && !self.is_stick[*n] && !self.is_stick[n - 1])
            .collect();
        let change = |n: &usize| (self.sensor_nm[*n] - self.sensor_nm[n - 1]).abs() / STEP_S;
        let flat = slips.iter().filter(|n| change(n) < limit_nm_s).count();
        share(flat, slips.len())
    }
}

#[derive(Debug, Default)]
struct Counts {
    rising_sticks: usize,
    sticks: usize,
    rising_slips: usize,
    slips: usize,
}

impl Counts {
    fn rises_in_sticks(&self) -> f64 {
        share(self.rising_sticks, self.sticks)
    }

    fn falls_in_slips(&self) -> f64 {
        share(self.slips - self.rising_slips, self.slips)
    }
}

#[expect(clippy::cast_precision_loss, reason = "some thousands")]
fn share(part: usize, whole: usize) -> f64 {
    assert!(whole > 20, "{whole} are too few to count");
    part as f64 / whole as f64
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn rows(duration_s: f64) -> usize {
    (duration_s / STEP_S).round() as usize
}

/// The signal minus its mean over the 0.2 s around it.
fn without_slow_part(signal: &[f64]) -> Vec<f64> {
    let half = rows(0.1);
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(signal.iter().scan(0.0, |sum, x| {
            *sum += x;
            Some(*sum)
        }))
        .collect();
    let mean = |n: usize| {
        let (from, to) = (n.saturating_sub(half), (n + half + 1).min(signal.len()));
        #[expect(clippy::cast_precision_loss, reason = "some thousands")]
        let count = (to - from) as f64;
        (sums[to] - sums[from]) / count
    };
    (0..signal.len()).map(|n| signal[n] - mean(n)).collect()
}

fn check(name: &str) {
    let signals = Signals::shipped(name, &[]);
    let torque = signals.counts(&signals.sensor_nm, 0);
    let velocity = signals.counts(&signals.link_rad_s, 0);
    println!("{name}: torque at the sensor {torque:?}");
    println!("{name}: velocity of the link {velocity:?}");
    println!(
        "{name}: the torque changes by less than 0.1 N·m/s in {:.1} % of the slips' time",
        100.0 * signals.flat_share(0.1)
    );
    assert!(torque.rises_in_sticks() >= 0.95, "{name}: {torque:?}");
    assert!(torque.falls_in_slips() >= 0.95, "{name}: {torque:?}");
    // Reported; below half it would be the opposite of what the paper says.
    assert!(velocity.rises_in_sticks() < 0.5, "{name}: {velocity:?}");
    assert!(velocity.falls_in_slips() < 0.5, "{name}: {velocity:?}");
}

#[test]
fn torque_rises_in_sticks_and_falls_in_slips_at_high_speed() {
    check("fig8");
}

#[test]
fn torque_rises_in_sticks_and_falls_in_slips_at_low_speed() {
    check("fig9");
}

/// The count can tell: with the other restart rule the torque drops where a stick begins, and the
/// sensor is half a millisecond late with it.
#[test]
fn with_the_elastic_restart_it_is_the_opposite_until_the_lag_is_taken_out() {
    let signals = Signals::shipped("fig8", &[("effects.crepitus.restart", "elastic")]);
    let as_it_is = signals.counts(&signals.sensor_nm, 0);
    let later = signals.counts(&signals.sensor_nm, rows(0.5e-3));
    println!("elastic: {as_it_is:?}, 0.5 ms later {later:?}");
    assert!(as_it_is.rises_in_sticks() < 0.05, "{as_it_is:?}");
    assert!(as_it_is.falls_in_slips() < 0.05, "{as_it_is:?}");
    assert!(later.rises_in_sticks() >= 0.95, "{later:?}");
    assert!(later.falls_in_slips() >= 0.95, "{later:?}");
}
