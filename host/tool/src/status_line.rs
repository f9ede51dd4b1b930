//! A line on the terminal that says how the device is, while samples go by.

use crepitus_client::Accounting;
use crepitus_protocol::telemetry::Block;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// The line; hidden by itself where stderr is no terminal.
pub(crate) struct StatusLine {
    bar: ProgressBar,
    last: Option<Block>,
}

impl StatusLine {
    pub(crate) fn new() -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {msg}") {
            bar.set_style(style);
        }
        Self { bar, last: None }
    }

    /// The last of the blocks that have come.
    pub(crate) fn block(&mut self, block: &Block) {
        self.last = Some(*block);
    }

    /// Does something else with the terminal meanwhile.
    pub(crate) fn aside<R>(&self, work: impl FnOnce() -> R) -> R {
        self.bar.suspend(work)
    }

    /// Shows how it is.
    pub(crate) fn show(&self, books: Option<&Accounting>) {
        if self.bar.is_hidden() {
            return;
        }
        let (Some(block), Some(books)) = (&self.last, books) else {
            return;
        };
        let torque_nm = block.samples.last().map_or(0.0, |sample| sample.torque_nm);
        self.bar.set_message(format!(
            "{} · {torque_nm:+.3} N·m · {} samples, {} dropped",
            block.flags.state().name(),
            books.received(),
            books.dropped()
        ));
        self.bar.tick();
    }
}

impl Drop for StatusLine {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
