//! `events.csv`: one row an event.

use super::push_number;
use crate::trace::EventRecord;
use std::io::{self, Write};

/// Writes the events of a run.
#[derive(Debug)]
pub struct EventsCsv<W> {
    to: W,
    line: String,
}

impl<W: Write> EventsCsv<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn new(mut to: W) -> io::Result<Self> {
        to.write_all(b"t_s,event,theta_rad,omega_rad_s,torque_before_nm,torque_after_nm\n")?;
        Ok(Self {
            to,
            line: String::new(),
        })
    }

    /// Writes an event.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn event(&mut self, event: &EventRecord) -> io::Result<()> {
        self.line.clear();
        push_number(&mut self.line, event.time_s);
        self.line.push(',');
        self.line.push_str(event.kind.name());
        for value in [
            event.theta_rad,
            event.omega_rad_s,
            event.torque_before_nm,
            event.torque_after_nm,
        ] {
            self.line.push(',');
            push_number(&mut self.line, value);
        }
        self.line.push('\n');
        self.to.write_all(self.line.as_bytes())
    }

    /// Gives the writer back.
    pub fn into_inner(self) -> W {
        self.to
    }
}
