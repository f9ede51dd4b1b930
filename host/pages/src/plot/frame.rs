//! Edges of a pair of axes.

/// The inside of a pair of axes, CSS pixels of the whole chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Left edge, at which x begins.
    pub left: f64,
    /// Top edge, at which y ends.
    pub top: f64,
    /// Right edge, at which x ends.
    pub right: f64,
    /// Bottom edge, at which y begins.
    pub bottom: f64,
}
