//! The other end of the drive's link.

use crate::character::Character;
use crate::refusal::Refusal;
use crate::time::Time;

/// Comms, as the drive's board sees it.
pub trait CommsSide {
    /// Runs until `end`. `sent` is what the drive has put on the wire by `now`,
    /// the first moment at or after `end` at which it could be looked at. Returns
    /// what comes back, with times after `end`.
    fn run(&mut self, sent: Vec<Character>, end: Time, now: Time) -> Vec<Character>;

    /// Returns whether its enable line is on.
    fn line_is_on(&self) -> bool;

    /// Stops it, its line as it is.
    fn set_hung(&mut self, is_hung: bool);

    /// The use of its chip that has stopped it for good.
    fn refusal(&self) -> Option<Refusal> {
        None
    }
}
