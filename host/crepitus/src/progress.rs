//! A progress bar for work that takes over a second, on a terminal only.

use crate::output::stderr_is_ready;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::{Duration, Instant};

/// Work that takes less time shows no bar.
const SHOW_AFTER: Duration = Duration::from_secs(1);

/// Progress through a simulated time.
pub(crate) struct Progress {
    begun: Instant,
    total_s: f64,
    /// Name of the whole of which the percentage is shown.
    whole: &'static str,
    bar: Option<ProgressBar>,
}

impl Progress {
    pub(crate) fn new(total_s: f64) -> Self {
        Self {
            begun: Instant::now(),
            total_s,
            whole: "simulated time",
            bar: None,
        }
    }

    /// Progress through a study, from 0 to 1.
    pub(crate) fn of_study() -> Self {
        let mut progress = Self::new(1.0);
        progress.whole = "study";
        progress
    }

    /// Progress through a recording, from 0 to 1.
    pub(crate) fn of_reading() -> Self {
        let mut progress = Self::new(1.0);
        progress.whole = "recording";
        progress
    }

    /// Progress through the runs of a sweep, from 0 to 1.
    pub(crate) fn of_sweep() -> Self {
        let mut progress = Self::new(1.0);
        progress.whole = "sweep";
        progress
    }

    /// Progress through a table, from 0 to 1.
    pub(crate) fn of_table() -> Self {
        let mut progress = Self::new(1.0);
        progress.whole = "table";
        progress
    }

    /// The simulation has reached `time_s`.
    pub(crate) fn reached(&mut self, time_s: f64) {
        if self.begun.elapsed() < SHOW_AFTER || !stderr_is_ready() {
            return;
        }
        let milliseconds = |s: f64| Duration::from_secs_f64(s.max(0.0)).as_millis();
        let position = u64::try_from(milliseconds(time_s)).unwrap_or(u64::MAX);
        let length = u64::try_from(milliseconds(self.total_s)).unwrap_or(u64::MAX);
        let bar = self.bar.get_or_insert_with(|| {
            // Hidden if stderr is not a terminal.
            let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr())
                .with_elapsed(self.begun.elapsed());
            if let Ok(style) = ProgressStyle::with_template(&format!(
                "{{bar:40}} {{percent:>3}} % of the {}, {{eta}} to go",
                self.whole
            )) {
                bar.set_style(style);
            }
            bar
        });
        bar.set_position(position);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            if !stderr_is_ready() {
                bar.set_draw_target(ProgressDrawTarget::hidden());
            }
            bar.finish_and_clear();
        }
    }
}
