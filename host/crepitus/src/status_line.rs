//! A status line on the terminal while samples arrive.

use crate::output::stderr_is_ready;
use crepitus_client::Accounting;
use crepitus_protocol::telemetry::Block;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal};

/// The line; hidden if stderr is not a terminal.
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

    /// Status line of a program whose lines go to stdout: on a terminal they show that samples arrive.
    pub(crate) fn beside_lines() -> Self {
        let line = Self::new();
        if io::stdout().is_terminal() {
            line.bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        line
    }

    /// Takes the latest block.
    pub(crate) fn block(&mut self, block: &Block) {
        self.last = Some(*block);
    }

    /// Updates the line.
    pub(crate) fn show(&self, accounting: Option<&Accounting>) {
        if self.bar.is_hidden() || !stderr_is_ready() {
            return;
        }
        let (Some(block), Some(accounting)) = (&self.last, accounting) else {
            return;
        };
        let torque_nm = block.samples.last().map_or(0.0, |sample| sample.torque_nm);
        self.bar.set_message(format!(
            "{} · {torque_nm:+.3} N·m · {} samples, {} dropped",
            block.flags.state().name(),
            accounting.received(),
            accounting.dropped()
        ));
        self.bar.tick();
    }
}

impl Drop for StatusLine {
    fn drop(&mut self) {
        if !stderr_is_ready() {
            self.bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        self.bar.finish_and_clear();
    }
}
