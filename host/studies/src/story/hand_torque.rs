//! Torque at the hand in a scene and in the variants that differ most. A peak
//! that lasts a tick must not flatten the rest.

use super::{PanelData, Scale, Series, Story};
use crate::accuracy::timing::quantile;
use crate::effects::variant::Change;
use crate::effects::{HandTorque, VariantTorque};
use crepitus_plant::Extremes;

/// Values outside this central share of all are peaks.
const MIDDLE: f64 = 0.99;

/// A line that goes this many times beyond the middle is cut off.
const BEYOND: f64 = 4.0;

pub(crate) fn story(data: &HandTorque) -> Story {
    Story {
        name: "hand-torque",
        title: "What the hand feels, with and without",
        caption: format!(
            "The torque at the hand of the scene, and of the {} that change it most, from {:.3} to {:.3} s: \
             where, taken together, they change it most. Each panel has its own scale.{}",
            match data.variants.len() {
                1 => "variant".to_owned(),
                n => format!("{n} variants"),
            },
            data.from_s,
            data.to_s,
            if data.less_trend {
                " The slow course of the scene's torque, a parabola, is taken from both lines: beside the weight of a \
                 leg nothing else would be seen."
            } else {
                ""
            },
        ),
        panels: data
            .variants
            .iter()
            .map(|variant| panel(data, variant))
            .collect(),
    }
}

/// The scene and a variant.
fn panel(data: &HandTorque, variant: &VariantTorque) -> PanelData {
    let y = Scale::linear(if data.less_trend {
        "N·m, less trend"
    } else {
        "Torque (N·m)"
    });
    let (beyond, y) = scale(y, &[&data.scene_nm, &variant.torque_nm]);
    PanelData {
        heading: format!("{}{beyond}", variant.name),
        x: Scale::linear("Time (s)").within(data.from_s, data.to_s),
        y,
        series: vec![
            Series::line("the scene", data.scene_nm.clone()),
            Series::line(
                match variant.change {
                    Change::With => "with the effect added",
                    Change::Scene | Change::Without => "with the effect left out",
                },
                variant.torque_nm.clone(),
            ),
        ],
        ..PanelData::default()
    }
}

/// Description of what goes beyond the scale, and the scale.
fn scale(y: Scale, lines: &[&[(f64, f64)]; 2]) -> (String, Scale) {
    let [whole, middle] = [1.0, MIDDLE].map(|share| range(lines, share));
    if whole.width() <= BEYOND * middle.width() || middle.width() <= 0.0 {
        return (String::new(), y);
    }
    let room = 0.15 * middle.width();
    let farthest = if -whole.low > whole.high {
        whole.low
    } else {
        whole.high
    };
    (
        format!("; a peak of {farthest:.1} N·m goes beyond the scale")
            .replace("of -", "of \u{2212}"),
        y.within(middle.low - room, middle.high + room),
    )
}

/// Range in which this share of each line's values is.
fn range(lines: &[&[(f64, f64)]; 2], share: f64) -> Extremes<f64> {
    let tail = (1.0 - share) / 2.0;
    let mut range = Extremes::default();
    for line in lines.iter().filter(|line| !line.is_empty()) {
        let mut sorted: Vec<f64> = line.iter().map(|p| p.1).collect();
        sorted.sort_by(f64::total_cmp);
        for end in [tail, 1.0 - tail] {
            range.add(quantile(&sorted, end));
        }
    }
    range
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_is_labelled_and_does_not_set_the_scale() {
        let line = |torque: &dyn Fn(u32) -> f64| -> Vec<(f64, f64)> {
            (0..1000).map(|n| (f64::from(n), torque(n))).collect()
        };
        let wave = |n: u32| (f64::from(n) * 0.1).sin();
        let grating = line(&wave);
        let y = || Scale::linear("Torque (N·m)");
        assert_eq!(scale(y(), &[&grating, &grating]), (String::new(), y()));
        let hit = line(&|n| if n == 500 { -40.0 } else { wave(n) });
        let (told, y_hit) = scale(y(), &[&grating, &hit]);
        assert!(told.contains("peak of −40.0 N·m"), "{told}");
        let (low, high) = y_hit.range.unwrap();
        assert!((-1.6..-1.0).contains(&low) && (1.0..1.6).contains(&high));
        assert_eq!(scale(y(), &[&[], &[]]).1.range, None);
    }
}
