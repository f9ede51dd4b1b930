//! The phases of the imaginary object as colours of the background.

use crate::plot::palette::{Ink, SLIP_NEGATIVE, SLIP_POSITIVE, STICK};
use crate::plot::{Key, Plot, Sign};
use crepitus_model::{Phase, Sense};

use crate::report::window::Span;

/// Phases with ink and name, in the order of legends.
const PHASES: [(Phase, Ink, &str); 3] = [
    (Phase::Slip(Sense::Positive), SLIP_POSITIVE, "slip +"),
    (Phase::Stick, STICK, "stick"),
    (Phase::Slip(Sense::Negative), SLIP_NEGATIVE, "slip −"),
];

/// Shades the phases over the full height of a panel.
pub(crate) fn shade(plot: &mut Plot, spans: &[Span]) {
    for (phase, ink, _) in PHASES {
        let of_phase = spans.iter().filter(|span| span.phase == phase);
        plot.shade(of_phase.map(|span| (span.from, span.to)), ink);
    }
}

/// The keys of the phases that occur.
pub(crate) fn keys(phases: impl IntoIterator<Item = Phase>) -> Vec<Key> {
    let occur: Vec<Phase> = phases.into_iter().collect();
    let shown = PHASES
        .into_iter()
        .filter(|(phase, ..)| occur.contains(phase));
    shown
        .map(|(_, ink, name)| Key::new(Sign::Patch(ink), name))
        .collect()
}
