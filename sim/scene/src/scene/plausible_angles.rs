//! Ranges of angles and velocities that a joint could have.

use crate::document::Range;

/// Angles and velocities in rad.
pub(super) const ANY_RAD: Range = Range::closed(-1e6, 1e6);

/// Angles and velocities in degrees.
pub(super) const ANY_DEG: Range = Range::closed(-6e7, 6e7);
