//! `events.csv`: one row an event.

use super::push_number;
use crate::trace::{EventRecord, SymptomEvent};
use std::io::{self, Write};

/// Angles of the joint are of symptoms, those of the imaginary object of crepitus.
const HEADER: &[u8] =
    b"t_s,effect,event,angle_rad,theta_rad,omega_rad_s,torque_before_nm,torque_after_nm\n";

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
        to.write_all(HEADER)?;
        Ok(Self {
            to,
            line: String::new(),
        })
    }

    /// Writes an event of crepitus.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn event(&mut self, event: &EventRecord) -> io::Result<()> {
        let numbers = [
            None,
            Some(event.theta_rad),
            Some(event.omega_rad_s),
            Some(event.torque_before_nm),
            Some(event.torque_after_nm),
        ];
        self.line(event.time_s, "crepitus", event.kind.name(), numbers)
    }

    /// Writes an event of another symptom.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn symptom(&mut self, event: &SymptomEvent) -> io::Result<()> {
        let numbers = [
            Some(event.angle_rad),
            None,
            Some(event.omega_rad_s),
            Some(event.torque_before_nm),
            Some(event.torque_after_nm),
        ];
        self.line(event.time_s, event.effect, event.word.name(), numbers)
    }

    fn line(
        &mut self,
        time_s: f64,
        effect: &str,
        event: &str,
        numbers: [Option<f64>; 5],
    ) -> io::Result<()> {
        self.line.clear();
        push_number(&mut self.line, time_s);
        for word in [effect, event] {
            self.line.push(',');
            self.line.push_str(word);
        }
        for number in numbers {
            self.line.push(',');
            if let Some(number) = number {
                push_number(&mut self.line, number);
            }
        }
        self.line.push('\n');
        self.to.write_all(self.line.as_bytes())
    }

    /// Gives the writer back.
    pub fn into_inner(self) -> W {
        self.to
    }
}
