//! The observer of a run: writes its rows and events, collects the report's
//! figures, moves the progress bar, and stops at Ctrl-C.

use crate::failure::Failure;
use crate::interrupt;
use crate::progress::Progress;
use crate::wav::Listener;
use crepitus_files::output::{Folder, Part};
use crepitus_pages::report::{Collector, Figures, Measured, Setup};
use crepitus_scene::Observer;
use crepitus_scene::output::{EventsCsv, TraceCsv};
use crepitus_scene::trace::{Column, EventRecord, SymptomEvent};
use std::io::{self, BufWriter};

pub(super) struct Watch {
    trace: TraceCsv<BufWriter<Part>>,
    events: EventsCsv<BufWriter<Part>>,
    collector: Collector,
    listener: Option<Listener>,
    progress: Progress,
    trace_every: u64,
    rows: u64,
}

/// Reason for the early end of a run.
#[derive(Debug)]
pub(super) enum WatchError {
    /// The results cannot be written.
    Write(io::Error),
    /// The sound cannot be made.
    Sound(Failure),
    /// Ctrl-C.
    Interrupted,
}

impl Watch {
    pub(super) fn new(
        folder: &Folder,
        setup: &Setup<'_>,
        duration_s: f64,
        trace_every: u64,
    ) -> io::Result<Self> {
        Ok(Self {
            trace: TraceCsv::new(folder.file("trace.csv")?, setup.columns.to_vec())?,
            events: EventsCsv::new(folder.file("events.csv")?)?,
            collector: Collector::new(setup),
            listener: None,
            progress: Progress::new(duration_s),
            trace_every,
            rows: 0,
        })
    }

    /// Lays measured curves over the rows that will come.
    pub(super) fn compare(&mut self, measured: Vec<Measured>, columns: &[Column]) {
        self.collector.compare(measured, columns);
    }

    /// Makes a sound of the rows that will come.
    pub(super) fn listen(&mut self, listener: Option<Listener>) {
        self.listener = listener;
    }

    /// The sound of the rows that came.
    pub(super) fn listener(&mut self) -> Option<Listener> {
        self.listener.take()
    }

    /// Finishes both files and gives the figures.
    pub(super) fn finish(self, folder: &Folder) -> io::Result<Figures> {
        folder.finish(self.trace.into_inner())?;
        folder.finish(self.events.into_inner())?;
        Ok(self.collector.finish())
    }
}

impl Observer for Watch {
    type Error = WatchError;

    fn row(&mut self, values: &[f64]) -> Result<(), WatchError> {
        self.collector.row(values);
        if let Some(listener) = &mut self.listener {
            listener.row(values).map_err(WatchError::Sound)?;
        }
        if self.rows.is_multiple_of(self.trace_every) {
            self.trace.row(values).map_err(WatchError::Write)?;
        }
        self.rows += 1;
        Ok(())
    }

    fn event(&mut self, event: &EventRecord) -> Result<(), WatchError> {
        self.collector.event(event);
        self.events.event(event).map_err(WatchError::Write)
    }

    fn symptom(&mut self, event: &SymptomEvent) -> Result<(), WatchError> {
        self.collector.symptom(event);
        self.events.symptom(event).map_err(WatchError::Write)
    }

    fn progress(&mut self, time_s: f64) -> Result<(), WatchError> {
        reached(&mut self.progress, time_s)
    }
}

/// The observer of a run without a trace.
pub(super) struct EventsAlone {
    events: EventsCsv<BufWriter<Part>>,
    progress: Progress,
}

impl EventsAlone {
    pub(super) fn new(folder: &Folder, duration_s: f64) -> io::Result<Self> {
        Ok(Self {
            events: EventsCsv::new(folder.file("events.csv")?)?,
            progress: Progress::new(duration_s),
        })
    }

    /// Finishes the file.
    pub(super) fn finish(self, folder: &Folder) -> io::Result<()> {
        folder.finish(self.events.into_inner())
    }
}

impl Observer for EventsAlone {
    type Error = WatchError;
    const WANTS_ROWS: bool = false;
    const NEEDS_STEPS: bool = false;

    fn event(&mut self, event: &EventRecord) -> Result<(), WatchError> {
        self.events.event(event).map_err(WatchError::Write)
    }

    fn symptom(&mut self, event: &SymptomEvent) -> Result<(), WatchError> {
        self.events.symptom(event).map_err(WatchError::Write)
    }

    fn progress(&mut self, time_s: f64) -> Result<(), WatchError> {
        reached(&mut self.progress, time_s)
    }
}

/// Moves the progress bar, and stops at Ctrl-C.
fn reached(progress: &mut Progress, time_s: f64) -> Result<(), WatchError> {
    progress.reached(time_s);
    if interrupt::requested() {
        return Err(WatchError::Interrupted);
    }
    Ok(())
}
