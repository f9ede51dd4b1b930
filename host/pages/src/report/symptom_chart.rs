//! Sizes that the charts of symptoms share, CSS pixels.

/// Width of a chart on a screen.
pub(crate) const WIDTH: f64 = 960.0;

/// Width of lines behind others, which may cover them.
pub(crate) const WIDE: f64 = 5.5;
