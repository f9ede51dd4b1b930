//! A panel's scale: a peak that lasts a tick must not flatten the rest.

use super::trend::Trend;
use crate::stability::story::{Panel, Scale};

/// Values outside the middle of so many of all are peaks.
const MIDDLE: f64 = 0.99;

/// A line that goes this many times beyond the middle is cut off.
const BEYOND: f64 = 4.0;

/// Heading and scale for two torques, both without a trend.
pub(super) fn panel(name: &str, trend: &Trend, own: &[f64], other: &[f64]) -> Panel {
    let y = Scale::linear(if trend.matters {
        "N·m, less trend"
    } else {
        "Torque (N·m)"
    });
    let torques = [own, other].map(|signal| {
        let torques = signal.iter().enumerate().map(|(i, nm)| nm - trend.at(i));
        torques.collect::<Vec<f64>>()
    });
    let [whole, middle] = [1.0, MIDDLE].map(|share| range(&torques, share));
    let size = |(low, high): (f64, f64)| high - low;
    if size(whole) <= BEYOND * size(middle) || size(middle) <= 0.0 {
        return Panel {
            heading: name.to_owned(),
            y,
            ..Panel::default()
        };
    }
    let room = 0.15 * size(middle);
    let farthest = if -whole.0 > whole.1 { whole.0 } else { whole.1 };
    Panel {
        heading: format!("{name}; a peak of {farthest:.1} N·m goes beyond the scale")
            .replace("of -", "of \u{2212}"),
        y: y.within(middle.0 - room, middle.1 + room),
        ..Panel::default()
    }
}

/// From where to where this share of each signal's values is.
fn range(signals: &[Vec<f64>; 2], share: f64) -> (f64, f64) {
    let tail = (1.0 - share) / 2.0;
    let mut range = (f64::INFINITY, f64::NEG_INFINITY);
    for signal in signals.iter().filter(|signal| !signal.is_empty()) {
        let mut sorted = signal.clone();
        sorted.sort_by(f64::total_cmp);
        range.0 = range
            .0
            .min(crate::accuracy::timing::quantile(&sorted, tail));
        range.1 = range
            .1
            .max(crate::accuracy::timing::quantile(&sorted, 1.0 - tail));
    }
    range
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_is_told_and_does_not_set_the_scale() {
        let grating: Vec<f64> = (0..1000).map(|n| (f64::from(n) * 0.1).sin()).collect();
        let plain = panel("with hand", &Trend::of(&grating), &grating, &grating);
        assert_eq!((plain.heading.as_str(), plain.y.range), ("with hand", None));
        let mut hit = grating.clone();
        hit[500] = -40.0;
        let told = panel("without cuff", &Trend::of(&grating), &grating, &hit);
        assert!(
            told.heading.contains("peak of −40.0 N·m"),
            "{}",
            told.heading
        );
        let (low, high) = told.y.range.unwrap();
        assert!((-1.6..-1.0).contains(&low) && (1.0..1.6).contains(&high));
        let none = panel("none", &Trend::of(&[]), &[], &[]);
        assert_eq!(none.y.range, None);
    }
}
