//! The points of a study in order: pairs of scene and convention, and what
//! all diagrams share, so that a rung looks the same in every one.

use crate::accuracy::Point;

/// The step of the device, s.
pub(crate) const DEVICE_TICK_S: f64 = 5e-5;

/// Returns whether a step is the device's tick, but for rounding.
pub(crate) fn is_device_tick(step_s: f64) -> bool {
    (step_s - DEVICE_TICK_S).abs() < 1e-6 * DEVICE_TICK_S
}

/// See the module.
#[derive(Debug)]
pub(crate) struct Study<'p> {
    /// Pairs, the one to look at first in front.
    pub(crate) pairs: Vec<Pair<'p>>,
    /// Rungs in order of first appearance, as are the views.
    pub(crate) rungs: Vec<&'static str>,
    pub(crate) views: Vec<View>,
}

/// A precision, on the true motion or behind the encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct View {
    pub(crate) precision: &'static str,
    pub(crate) is_exact: bool,
}

impl View {
    pub(crate) fn of(point: &Point) -> Self {
        Self {
            precision: point.precision,
            is_exact: point.is_exact(),
        }
    }

    /// `f32`, or `f32, encoder`.
    pub(crate) fn name(self) -> String {
        let behind = if self.is_exact { "" } else { ", encoder" };
        format!("{}{behind}", self.precision)
    }
}

/// One scene under one convention.
#[derive(Debug)]
pub(crate) struct Pair<'p> {
    pub(crate) scene: &'p str,
    pub(crate) convention: &'static str,
    points: Vec<&'p Point>,
}

impl<'p> Study<'p> {
    pub(crate) fn new(points: &'p [Point]) -> Self {
        let mut study = Self {
            pairs: Vec::new(),
            rungs: Vec::new(),
            views: Vec::new(),
        };
        for point in points {
            if !study.rungs.contains(&point.solver) {
                study.rungs.push(point.solver);
            }
            if !study.views.contains(&View::of(point)) {
                study.views.push(View::of(point));
            }
            let of = study
                .pairs
                .iter_mut()
                .find(|pair| pair.scene == point.scene && pair.convention == point.convention);
            match of {
                Some(pair) => pair.points.push(point),
                None => study.pairs.push(Pair {
                    scene: &point.scene,
                    convention: point.convention,
                    points: vec![point],
                }),
            }
        }
        // The encoder's beside the true one of its precision.
        study.views.sort_by_key(|view| view.precision);
        // Stable: others keep their order.
        study.pairs.sort_by_key(Pair::rank);
        study
    }

    /// Number of pairs, from the first on, that a page shows unfolded.
    pub(crate) fn in_full(&self) -> usize {
        let preferred = self.pairs.iter().take_while(|pair| pair.rank() < 2);
        preferred.count().max(1)
    }
}

impl<'p> Pair<'p> {
    /// The speed of the paper's measurements first, there without the
    /// object's own motion.
    fn rank(&self) -> u8 {
        match (self.scene.contains("0.988"), self.convention) {
            (true, "frozen") => 0,
            (true, "physical") => 1,
            _ => 2,
        }
    }

    pub(crate) fn title(&self) -> String {
        format!("{}, {} convention", self.scene, self.convention)
    }

    pub(crate) fn points(&self) -> impl Iterator<Item = &'p Point> {
        self.points.iter().copied()
    }

    /// The views in which the pair was studied.
    pub(crate) fn views<'s>(&'s self, study: &'s Study) -> impl Iterator<Item = View> + 's {
        let has = |view: &View| self.points().any(|point| View::of(point) == *view);
        study.views.iter().copied().filter(has)
    }

    /// The points of one rung in one view, from the longest step to the
    /// shortest.
    pub(crate) fn of(&self, rung: &str, view: View) -> Vec<&'p Point> {
        let mut points: Vec<&Point> = self
            .points()
            .filter(|point| point.solver == rung && View::of(point) == view)
            .collect();
        points.sort_by(|a, b| b.step_s.total_cmp(&a.step_s));
        points
    }
}
