//! The torque at the hand in a short window, where the variants that differ
//! most differ most: of each with and without its effect.

mod profile;
mod trend;

pub(super) use profile::Profile;

use super::hand::{WholeRun, hand_torque};
use super::variant::Change;
use crate::parallel::{Meter, each};
use crate::stability::story::Line;
use crate::watcher::{Cancelled, Watcher};
use crepitus_model::Real;
use crepitus_scene::Scene;
use trend::Trend;

/// The most variants that are shown.
pub(super) const SHOWN: usize = 5;

/// A window shows about this many events of the scene.
const EVENTS: f64 = 12.0;

/// One part in so many of a window is before the stretch that decides on it.
const LEAD: usize = 8;

/// Lengths of a window, s.
const SHORTEST_S: f64 = 0.05;
const LONGEST_S: f64 = 0.5;

/// The torque at the hand in a telling window: of a scene, and of the variants
/// that change it most.
#[derive(Clone, Debug, PartialEq)]
pub struct HandTorque {
    /// Start of the window, s.
    pub from_s: f64,
    /// End of the window, s.
    pub to_s: f64,
    /// Whether the slow course of the scene's torque, a parabola, is taken
    /// from all lines.
    pub less_trend: bool,
    /// Torque of the scene, N·m, against time, s.
    pub scene_nm: Line,
    /// Those that differ most first.
    pub variants: Vec<VariantTorque>,
}

/// One of the variants.
#[derive(Clone, Debug, PartialEq)]
pub struct VariantTorque {
    /// Name of the variant.
    pub name: String,
    /// Kind of change to the scene.
    pub change: Change,
    /// N·m, against time, s.
    pub torque_nm: Line,
}

/// A variant that may be shown.
pub(super) struct Candidate<'a> {
    pub(super) scene: &'a Scene,
    pub(super) change: Change,
    pub(super) name: String,
    pub(super) rms_nm: f64,
    pub(super) profile: &'a Profile,
}

/// The torques of those that differ most; none if none differs.
pub(super) fn shown_torques(
    whole: &WholeRun,
    scene: &Scene,
    mut candidates: Vec<Candidate<'_>>,
    meter: &Meter,
    watcher: &mut dyn Watcher,
) -> Result<Option<HandTorque>, Cancelled> {
    candidates.retain(|c| c.rms_nm > 0.0);
    candidates.sort_by(|a, b| b.rms_nm.total_cmp(&a.rms_nm));
    candidates.truncate(SHOWN);
    let tick_s = scene.step_s();
    let (from, to) = window(whole, &candidates, tick_s);
    if candidates.is_empty() || to < from + 2 {
        return Ok(None);
    }
    let time_s = |tick: usize| tick_s * f64::from_whole(u64::try_from(tick + 1).unwrap_or(0));
    let heard = each(&candidates, meter, watcher, |candidate| {
        let mut short = candidate.scene.clone();
        short.duration_s = time_s(to - 1);
        let mut signal = Vec::with_capacity(to - from);
        let mut tick = 0;
        // The scene has just run; where its run now ends early, so does its line.
        let _ = hand_torque(&short, meter, |torque_nm| {
            if tick >= from {
                signal.push(torque_nm);
            }
            tick += 1;
            tick < to
        });
        signal
    })?;
    let own = whole.signal.get(from..to).unwrap_or_default();
    let trend = Trend::of(own);
    let points = |signal: &[f64]| {
        let times = (from..).map(time_s);
        let torques = signal.iter().enumerate().map(|(i, nm)| nm - trend.at(i));
        times.zip(torques).collect::<Line>()
    };
    let variants = candidates
        .iter()
        .zip(heard)
        .map(|(candidate, signal)| VariantTorque {
            name: candidate.name.clone(),
            change: candidate.change,
            torque_nm: points(&signal),
        });
    Ok(Some(HandTorque {
        from_s: time_s(from),
        to_s: time_s(to - 1),
        less_trend: trend.matters,
        scene_nm: points(own),
        variants: variants.collect(),
    }))
}

/// The ticks of the window, from its first up to its last.
fn window(whole: &WholeRun, candidates: &[Candidate<'_>], tick_s: f64) -> (usize, usize) {
    let ticks = whole.signal.len();
    let all_s = tick_s * f64::from_whole(u64::try_from(ticks).unwrap_or(0));
    let length_s = if whole.events > 0 {
        (EVENTS * all_s / f64::from_whole(whole.events)).clamp(SHORTEST_S, LONGEST_S)
    } else {
        LONGEST_S
    };
    let length = usize::try_from((length_s / tick_s).whole())
        .unwrap_or(usize::MAX)
        .clamp(2, ticks.max(2));
    let Some(first) = candidates.first() else {
        return (0, 0);
    };
    let per_bin = usize::try_from(first.profile.ticks_per_bin).unwrap_or(usize::MAX);
    let shares = shares(candidates);
    let lead = length / LEAD;
    let bins = ((length - lead) / per_bin).clamp(1, shares.len().max(1));
    let mut best = (0, f64::NEG_INFINITY);
    for (start, part) in shares.windows(bins).enumerate() {
        let sum: f64 = part.iter().sum();
        if sum > best.1 {
            best = (start, sum);
        }
    }
    // With a little of what comes before.
    let from = (best.0 * per_bin).saturating_sub(lead);
    let from = from.min(ticks.saturating_sub(length));
    (from, (from + length).min(ticks))
}

/// Sum of the shares that the differences have in each bin.
fn shares(candidates: &[Candidate<'_>]) -> Vec<f64> {
    let mut shares: Vec<f64> = Vec::new();
    for candidate in candidates {
        let bins = &candidate.profile.bins;
        let all: f64 = bins.iter().sum();
        shares.resize(shares.len().max(bins.len()), 0.0);
        for (share, bin) in shares.iter_mut().zip(bins) {
            *share += bin / all;
        }
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_is_where_the_difference_is() {
        let mut profile = Profile::new(40_000);
        for n in 0..40_000 {
            profile.push(if (25_000..25_100).contains(&n) {
                1.0
            } else {
                1e-3
            });
        }
        assert!(profile.bins.len() <= 4096);
        let scene = super::super::study::tests::scene(&["crepitus"], 2.0);
        let whole = WholeRun {
            signal: vec![0.0; 40_000],
            events: 240,
        };
        let candidate = Candidate {
            scene: &scene,
            change: Change::Without,
            name: String::new(),
            rms_nm: 1.0,
            profile: &profile,
        };
        let (from, to) = window(&whole, &[candidate], 5e-5);
        // Twelve events are 0.1 s.
        assert!((1980..=2000).contains(&(to - from)), "{from} {to}");
        assert!(from <= 25_000 && to >= 25_100, "{from} {to}");
        assert_eq!(window(&whole, &[], 5e-5), (0, 0));
    }
}
