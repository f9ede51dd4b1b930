//! What can go wrong while drawing.

/// A report that could not be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The drawing library refused a chart.
    #[error("cannot draw the chart \"{chart}\": {reason}")]
    Draw {
        /// What the chart shows.
        chart: String,
        /// What the drawing library says.
        reason: String,
    },
}
