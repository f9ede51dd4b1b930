//! Motions on which the symptoms are studied.

use crate::symptoms::Hand;

/// Name, motion and duration, s. Together they reach every state of every symptom at
/// its defaults: both ends of the range and beyond their caps, catches and
/// blades, again after they were re-armed, beats of a stretch that is held, teeth and
/// asperities there and back; and they turn within a play.
pub fn motions() -> [(&'static str, Hand, f64); 3] {
    [
        (
            "constant-120",
            Hand::Constant {
                from_deg: 0.0,
                deg_s: 120.0,
            },
            1.2,
        ),
        (
            "strokes-400",
            Hand::Strokes {
                from_deg: 3.0,
                to_deg: 131.0,
                deg_s: 400.0,
                pause_s: 0.4,
            },
            3.0,
        ),
        (
            "tremor-6",
            Hand::Sine {
                centre_deg: 74.0,
                // In extension first: armed in the middle of a fast stretch a reflex has no past,
                // and its onset is smeared over the first step.
                amplitude_deg: -4.0,
                frequency_hz: 6.0,
            },
            0.5,
        ),
    ]
}
