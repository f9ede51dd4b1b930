//! Judgement of how well a hand keeps to a target.
//!
//! Of every piece of the path it is judged whether it was travelled too slowly, right or
//! too fast; turns at the ends weigh little, because little is travelled there. The score
//! counts strokes: those whose middle half had the right speed, or, with a metronome,
//! beats at which the leg turned back.

use crate::live::target::{Aim, Target};
use crepitus_knee::examination::Strokes;
use crepitus_recording::Row;
use serde::Serialize;

/// A slower leg rests, °/s.
const REST_DEG_PER_S: f64 = 3.0;

/// Time constant of the speed that is judged, s: shorter than a reaction, longer than a
/// stick-slip cycle.
const SMOOTHING_S: f64 = 0.05;

/// Longest time between two samples, s: after a longer one nobody knows how the leg was moved meanwhile.
const GAP_S: f64 = 0.1;

/// A turn this far from a beat, in its periods, is not at it.
const BEAT_TOLERANCE: f64 = 0.15;

/// Judgement of the speed now.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The leg rests.
    #[default]
    Rest,
    /// Too slow.
    Slow,
    /// Right.
    Right,
    /// Too fast.
    Fast,
}

/// Result of scoring.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Score {
    /// Time that was judged, s.
    pub seconds: f64,
    /// Shares of the path, 0 to 1; none without a path.
    pub share_right: Option<f64>,
    /// Too slow.
    pub share_slow: Option<f64>,
    /// Too fast.
    pub share_fast: Option<f64>,
    /// Strokes.
    pub strokes: u32,
    /// Number of strokes at the right speed.
    pub strokes_right: u32,
    /// Beats of the metronome.
    pub beats: u32,
    /// Number of beats with a turn at them.
    pub beats_hit: u32,
    /// Share of the right strokes, or of the beats, in per cent; none without any.
    pub score: Option<f64>,
}

/// Judges a hand.
#[derive(Clone, Debug)]
pub struct Pace {
    target: Target,
    strokes: Strokes,
    verdict: Verdict,
    speed_deg_per_s: f64,
    last_s: Option<f64>,
    is_scoring: bool,
    /// Start of scoring.
    begin_s: Option<f64>,
    /// Degrees: slow, right, fast.
    path_deg: [f64; 3],
    score: Score,
    /// The last beat that was hit.
    hit: Option<u32>,
}

impl Pace {
    /// Begins; nothing is scored yet.
    pub fn new(target: Target) -> Self {
        Self {
            target,
            strokes: Strokes::default(),
            verdict: Verdict::Rest,
            speed_deg_per_s: 0.0,
            last_s: None,
            is_scoring: false,
            begin_s: None,
            path_deg: [0.0; 3],
            score: Score::default(),
            hit: None,
        }
    }

    /// The target.
    pub fn target(&self) -> Target {
        self.target
    }

    /// Begins a score, or ends it; the last one stays to be read.
    pub fn set_scoring(&mut self, is_scoring: bool) {
        if is_scoring {
            *self = Self {
                is_scoring,
                ..Self::new(self.target)
            };
        } else {
            self.is_scoring = false;
        }
    }

    /// Returns whether it scores.
    pub fn is_scoring(&self) -> bool {
        self.is_scoring
    }

    /// Judgement of the speed now.
    pub fn verdict(&self) -> Verdict {
        self.verdict
    }

    /// Takes the next sample.
    pub fn take(&mut self, row: &Row) {
        let now_s = row.time_s;
        let step_s = self.last_s.map_or(0.0, |last_s| now_s - last_s);
        let step_s = if step_s > GAP_S { 0.0 } else { step_s };
        self.last_s = Some(now_s);
        let speed = f64::from(row.omega_rad_s).abs().to_degrees();
        if !speed.is_finite() {
            return;
        }
        let share = (step_s / SMOOTHING_S).clamp(0.0, 1.0);
        self.speed_deg_per_s += (speed - self.speed_deg_per_s) * share;
        self.verdict = self.judge(self.speed_deg_per_s);
        let stroke = self.strokes.take(now_s, row.angle_rad);
        if !self.is_scoring {
            return;
        }
        let begin_s = *self.begin_s.get_or_insert(now_s);
        self.score.seconds = now_s - begin_s;
        let [slow, right, fast] = &mut self.path_deg;
        let path = match self.verdict {
            Verdict::Rest => None,
            Verdict::Slow => Some(slow),
            Verdict::Right => Some(right),
            Verdict::Fast => Some(fast),
        };
        if let Some(path) = path {
            *path += speed * step_s;
        }
        if let Some(stroke) = stroke {
            self.score.strokes += 1;
            let verdict = self.judge(stroke.speed_rad_s.to_degrees());
            self.score.strokes_right += u32::from(verdict == Verdict::Right);
            self.turned(stroke.end_s - begin_s);
        }
        if let Aim::Metronome { beats_per_min } = self.target.aim {
            self.score.beats = whole(self.score.seconds * beats_per_min / 60.0);
        }
    }

    fn judge(&self, speed_deg_per_s: f64) -> Verdict {
        if speed_deg_per_s < REST_DEG_PER_S {
            return Verdict::Rest;
        }
        match self.target.aim {
            Aim::Speed { low_deg_per_s, .. } if speed_deg_per_s < low_deg_per_s => Verdict::Slow,
            Aim::Speed {
                high_deg_per_s: Some(high),
                ..
            } if speed_deg_per_s > high => Verdict::Fast,
            Aim::Speed { .. } | Aim::Metronome { .. } => Verdict::Right,
        }
    }

    /// The leg turned back this long after the begin.
    fn turned(&mut self, since_s: f64) {
        let Aim::Metronome { beats_per_min } = self.target.aim else {
            return;
        };
        let beats = since_s * beats_per_min / 60.0;
        let nearest = beats.round();
        let beat = whole(nearest);
        // The begin is no beat to turn at.
        if beat > 0 && (beats - nearest).abs() <= BEAT_TOLERANCE && self.hit != Some(beat) {
            self.hit = Some(beat);
            self.score.beats_hit += 1;
        }
    }

    /// The score so far.
    pub fn score(&self) -> Score {
        let path: f64 = self.path_deg.iter().sum();
        let share = |part: f64| (path > 0.0).then(|| part / path);
        let [slow, right, fast] = self.path_deg;
        let score = self.score;
        let (of, all) = match self.target.aim {
            Aim::Speed { .. } => (score.strokes_right, score.strokes),
            // A turn is found after it has happened: the last beat may be hit and not over.
            Aim::Metronome { .. } => (score.beats_hit, score.beats.max(score.beats_hit)),
        };
        Score {
            share_slow: share(slow),
            share_right: share(right),
            share_fast: share(fast),
            score: (all > 0).then(|| 100.0 * f64::from(of) / f64::from(all)),
            ..score
        }
    }
}

/// The whole number of a count that is at least 0.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "it saturates"
)]
fn whole(count: f64) -> u32 {
    count as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// A sine of the angle, 45° ± 40°, with this period.
    fn examined(target: &str, seconds: f64, period_s: f64) -> Score {
        let mut pace = Pace::new(Target::find(target).unwrap());
        pace.set_scoring(true);
        let w = 2.0 * PI / period_s;
        for tick in 0.. {
            let time_s = f64::from(tick) * 5e-5;
            if time_s > seconds {
                break;
            }
            #[expect(clippy::cast_possible_truncation, reason = "a speed")]
            pace.take(&Row {
                time_s,
                angle_rad: (45.0 - 40.0 * (w * time_s).cos()).to_radians(),
                omega_rad_s: (40.0 * w * (w * time_s).sin()).to_radians() as f32,
                ..Row::default()
            });
        }
        pace.score()
    }

    #[test]
    fn strokes_at_the_right_speed_score_all() {
        // The middle half of a stroke of 80° in 3 s is at 40 °/s.
        let score = examined("slow", 32.0, 6.0);
        assert!(score.strokes >= 10 && score.strokes_right == score.strokes);
        assert_eq!(score.score, Some(100.0));
        // The path's ends are slower than 20 °/s, and little.
        assert!(score.share_right.unwrap() > 0.7, "{score:?}");
        assert!((score.seconds - 32.0).abs() < 0.01);
    }

    #[test]
    fn too_fast_and_too_slow_score_nothing() {
        let fast = examined("slow", 20.0, 2.0);
        assert_eq!(fast.score, Some(0.0));
        assert!(fast.share_fast.unwrap() > 0.7);
        let slow = examined("tardieu-v3", 20.0, 2.0);
        assert_eq!((slow.score, slow.share_slow), (Some(0.0), Some(1.0)));
    }

    #[test]
    fn a_metronome_wants_a_turn_at_each_beat() {
        // 40 beats a minute: a stroke of 1.5 s.
        let on_time = examined("metronome", 30.4, 3.0);
        assert!(on_time.beats_hit >= 19, "{on_time:?}");
        assert!(on_time.score.unwrap() > 90.0);
        let off = examined("metronome", 30.4, 2.3);
        assert!(off.score.unwrap() < 60.0, "{off:?}");
    }

    #[test]
    fn a_leg_at_rest_has_no_score() {
        let mut pace = Pace::new(Target::find("slow").unwrap());
        pace.set_scoring(true);
        for tick in 0..2_000 {
            pace.take(&Row {
                time_s: f64::from(tick) * 5e-5,
                ..Row::default()
            });
        }
        let score = pace.score();
        assert_eq!((score.score, score.share_right), (None, None));
        assert_eq!(pace.verdict(), Verdict::Rest);
    }

    /// As where another hand has had the leg meanwhile.
    #[test]
    fn a_gap_is_no_way_that_was_travelled() {
        let mut pace = Pace::new(Target::find("slow").unwrap());
        pace.set_scoring(true);
        for (time_s, deg_per_s) in [(0.0, 30.0_f32), (0.1, 30.0), (60.0, 300.0), (60.1, 30.0)] {
            pace.take(&Row {
                time_s,
                omega_rad_s: deg_per_s.to_radians(),
                ..Row::default()
            });
        }
        assert_eq!(pace.score().share_right, Some(1.0));
    }

    #[test]
    fn scoring_begins_anew_and_the_last_score_stays() {
        let mut pace = Pace::new(Target::find("slow").unwrap());
        let row = |time_s| Row {
            time_s,
            omega_rad_s: 0.5,
            ..Row::default()
        };
        pace.take(&row(0.0));
        assert_eq!(pace.score().seconds, 0.0);
        pace.set_scoring(true);
        pace.take(&row(1.0));
        pace.take(&row(3.0));
        pace.set_scoring(false);
        pace.take(&row(9.0));
        assert_eq!(pace.score().seconds, 2.0);
        pace.set_scoring(true);
        assert_eq!(pace.score().seconds, 0.0);
    }
}
