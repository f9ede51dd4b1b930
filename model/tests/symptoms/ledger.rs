//! Energy that a hand gets back, against its bound. A play returns to the hand over any time,
//! d ticks late, at most
//!
//! ```text
//! E ≤ T₀²/2σ + (½·n + d)·σ·h·∫Ω² dt
//! ```
//!
//! with n ticks between two samples. An encoder adds half a count at the torque. A commit
//! lets go of what the play holds then, at most, and adds S to σ until its jump has faded.

use super::rig::*;

use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::joint::MOST_STIFFNESS_NM_PER_RAD;
use crepitus_model::render::effects::EffectSettings;
use crepitus_model::render::position::{Position, Sensing};
use crepitus_model::{Real, Sample};

/// The energy that a hand got back, against the bound.
pub(crate) struct Ledger {
    pub(crate) delay: usize,
    pub(crate) late_nm: Vec<f64>,
    pub(crate) level_j: f64,
    /// The most that any earlier level is above what was stored then.
    pub(crate) floor_j: f64,
    pub(crate) unseen: (f64, f64, f64),
    /// Energy that is held beyond the torque while that leaves, J.
    pub(crate) leaves_j: f64,
    pub(crate) worst_j: f64,
}

impl Ledger {
    pub(crate) fn new(delay: usize) -> Self {
        Self {
            delay,
            late_nm: vec![0.0; delay + 1],
            level_j: 0.0,
            floor_j: 0.0,
            unseen: (0.0, 0.0, 0.0),
            leaves_j: 0.0,
            worst_j: 0.0,
        }
    }

    /// A tick, with the torque at its end; `fading` is S while a jump fades.
    pub(crate) fn tick(
        &mut self,
        travel_rad: f64,
        nm: f64,
        seen: bool,
        stiffness: f64,
        fading: f64,
    ) {
        let (ticks, work_j, squares) = self.unseen;
        let acting_nm = self.late_nm[self.delay];
        let unseen = (
            ticks + 1.0,
            work_j + acting_nm * travel_rad,
            squares + travel_rad * travel_rad,
        );
        let granted = (0.5 * unseen.0 + self.delay as f64) * (stiffness + fading) * unseen.2;
        let level_j = self.level_j + unseen.1 + granted;
        self.worst_j = self.worst_j.max(self.floor_j - level_j);
        self.late_nm.rotate_right(1);
        self.late_nm[0] = nm;
        self.unseen = unseen;
        if seen {
            self.unseen = (0.0, 0.0, 0.0);
            self.level_j = level_j;
            // The ticks before, whose torque is still on its way.
            let edge_j = 0.6 * (self.delay as f64 * travel_rad).powi(2) * stiffness;
            let most_nm = self
                .late_nm
                .iter()
                .fold(0.0_f64, |most, nm| most.max(nm.abs()));
            let stored_j = most_nm * most_nm / (2.0 * stiffness) + self.leaves_j + edge_j;
            self.floor_j = self.floor_j.max(level_j - stored_j);
        }
    }
}

pub(crate) struct Hand<'a> {
    pub(crate) angles: &'a [f64],
    pub(crate) delay: usize,
    pub(crate) counts: bool,
    /// Commits of these settings at these ticks.
    pub(crate) commits: &'a [(usize, EffectSettings)],
    /// Every so many ticks some samples are missing.
    pub(crate) gaps: Option<(usize, usize)>,
}

/// Energy that a hand gets back beyond the bound, J, and the largest torque, N·m.
pub(crate) fn excess<F: Real>(settings: EffectSettings, hand: &Hand<'_>) -> (f64, f64) {
    let encoder = EncoderSettings::default();
    let (sensing, spare_rad) = if hand.counts {
        (Sensing::of_encoder(&encoder), encoder.rad_per_count())
    } else {
        (Sensing::IDEAL, 0.0)
    };
    let count = |rad: f64| (rad / encoder.rad_per_count()).floor() as i32;
    let angles = hand.angles;
    let mut reader = EncoderReader::<F>::new(&encoder, TICK_S, count(angles[0]), F::ZERO).unwrap();
    let mut rig = Rig::<F>::new(settings, sensing, angles[0]);
    let mut ledger = Ledger::new(hand.delay);
    let (mut seen_rad, mut omega, mut largest, mut last_nm) = (angles[0], 0.0, 0.0_f64, 0.0_f64);
    let mut stiffness = settings.stiffness_nm_per_rad(None);
    let softest = hand
        .commits
        .iter()
        .map(|(_, s)| s.stiffness_nm_per_rad(None));
    let softest = softest.filter(|s| *s > 0.0).fold(stiffness, f64::min);
    for (n, pair) in angles.windows(2).enumerate() {
        if let Some((_, settings)) = hand.commits.iter().find(|(tick, _)| *tick == n) {
            rig.commit(*settings);
            let holds_j = last_nm * last_nm / (2.0 * softest);
            ledger.level_j += holds_j;
            ledger.leaves_j = ledger.leaves_j.max(holds_j);
            // What leaves is what it was.
            stiffness = match settings.stiffness_nm_per_rad(None) {
                0.0 => stiffness,
                other => other,
            };
        }
        let seen = hand.gaps.is_none_or(|(every, ticks)| n % every >= ticks);
        let next = angles.get(n + 2).copied().unwrap_or(pair[1]);
        let nm = if hand.counts {
            let shaft = reader.read(count(pair[1]));
            rig.tick(Sample::Taken(shaft), Position::at(count(pair[1])))
        } else if seen {
            let to = (pair[1], (next - pair[0]) / (2.0 * TICK_S));
            let nm = rig.step((seen_rad, omega), to, pair[1] - seen_rad);
            (seen_rad, omega) = to;
            nm
        } else {
            rig.tick(Sample::Lost, sensing.position(seen_rad))
        };
        if !rig.settling {
            ledger.leaves_j = 0.0;
        }
        let fading = if rig.settling {
            MOST_STIFFNESS_NM_PER_RAD
        } else {
            0.0
        };
        ledger.tick(pair[1] - pair[0], nm, seen, stiffness, fading);
        (last_nm, largest) = (nm, largest.max(nm.abs()));
    }
    (ledger.worst_j - largest * spare_rad, largest)
}
