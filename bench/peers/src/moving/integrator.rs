//! The part of a library that integrates one phase.

/// Steps of a solver, s.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// The first; none where the library has to find one.
    pub first_s: Option<f64>,
    /// The longest.
    pub longest_s: f64,
}

/// End of a phase as a solver found it.
#[derive(Clone, Copy, Debug)]
pub struct PhaseEnd {
    /// Time of the end, s.
    pub time_s: f64,
    /// The state there.
    pub y: [f64; 2],
    /// The step with which it would have gone on, s.
    pub step_s: f64,
}

/// A library that integrates one phase of [`Phases`](super::phases::Phases) after the other.
pub trait Integrator {
    /// Integrates from `from_s` and `y` to the end of the phase; none if the run ends first.
    ///
    /// # Errors
    /// The library's message if it gives up.
    fn phase(&mut self, from_s: f64, y: [f64; 2], step: Step) -> Result<Option<PhaseEnd>, String>;
}
