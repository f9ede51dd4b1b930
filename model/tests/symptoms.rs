//! The laws of the symptoms as a device runs them, stepped at 20 kHz and kept over
//! commits: energy, mirror images, bad input, commits, and closed forms.
//!
//! A play returns to the hand over any time, d ticks late, at most
//!
//! ```text
//! E ≤ T₀²/2σ + (½·n + d)·σ·h·∫Ω² dt
//! ```
//!
//! with n ticks between two samples. An encoder adds half a count at the torque. A commit
//! lets go of what the play holds then, at most, and adds S to σ until its jump has faded.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    clippy::panic,
    reason = "small numbers, and tests"
)]

mod support;

use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::render::effects::clasp_knife::ClaspKnifeSettings;
use crepitus_model::render::effects::clonus::ClonusSettings;
use crepitus_model::render::effects::cogwheel::CogwheelSettings;
use crepitus_model::render::effects::lead_pipe::LeadPipeSettings;
use crepitus_model::render::effects::range_limit::RangeLimitSettings;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_model::render::effects::symptom::{Change, Word};
use crepitus_model::render::effects::texture::TextureSettings;
use crepitus_model::render::effects::{
    EffectSettings, EffectSpec, MOST_STIFFNESS_NM_PER_RAD, SwitchedEffects, TANK_J, TANK_REFILL_W,
    Timing,
};
use crepitus_model::render::input_check::{InputCheck, InputLimits};
use crepitus_model::render::position::{Position, Sight};
use crepitus_model::render::{Addition, Check, Seen, Shown};
use crepitus_model::{Real, Sample, ShaftStep};
use proptest::prelude::*;

const TICK_S: f64 = 5e-5;
const SLEW_NM: f64 = 100.0 * TICK_S;

fn timing(sight: Sight) -> Timing {
    Timing {
        step_s: TICK_S,
        delay_ticks: 2,
        sight,
    }
}

/// Effects of an armed device.
struct Rig<F: Real> {
    effects: SwitchedEffects<F>,
    check: InputCheck<F>,
    settings: EffectSettings,
    timing: Timing,
    /// What happened, and in which share of the last tick.
    words: Vec<(Word, f64)>,
    settling: bool,
}

impl<F: Real> Rig<F> {
    fn new(settings: EffectSettings, sight: Sight, from_rad: f64) -> Self {
        let timing = timing(sight);
        let mut rig = Self {
            effects: SwitchedEffects::new(F::from_f64(SLEW_NM), &timing),
            check: InputCheck::new(&InputLimits::device(TICK_S), F::from_f64(TICK_S), F::ZERO),
            settings: EffectSettings::default(),
            timing,
            words: Vec::new(),
            settling: false,
        };
        rig.commit(settings);
        rig.effects.rest(&sight.position(from_rad));
        rig
    }

    fn commit(&mut self, settings: EffectSettings) {
        let now = (&self.settings, &self.timing);
        let changes = settings.changes(&self.timing, now).unwrap();
        self.effects.change(&changes, F::from_f64(SLEW_NM));
        self.settings = settings;
    }

    fn tick(&mut self, sample: Sample<F>, place: Position<F>) -> f64 {
        let input = self.check.check(&sample);
        let seen = Seen {
            sample,
            omega_rad_s: F::ZERO,
            place,
            is_driven: true,
        };
        let mut shown = Shown::nothing();
        self.words.clear();
        let words = &mut self.words;
        self.effects.tick(
            &seen,
            &input,
            &mut shown,
            &mut |_: &'static EffectSpec, change: Change<F>| {
                words.push((change.word, change.fraction.to_f64()));
            },
        );
        self.settling = shown.settling;
        shown.torque_nm.to_f64()
    }

    /// A tick over which the velocity changes linearly.
    fn step(&mut self, from: (f64, f64), to: (f64, f64), travel_rad: f64) -> f64 {
        let shaft = ShaftStep {
            delta_phi_rad: F::from_f64(travel_rad),
            omega_start_rad_s: F::from_f64(from.1),
            omega_end_rad_s: F::from_f64(to.1),
        };
        self.tick(Sample::Taken(shaft), self.timing.sight.position(to.0))
    }

    /// Along a motion from 0 s on: (s, rad, N·m) at the ticks, and words with their times.
    fn run(&mut self, end_s: f64, motion: impl Fn(f64) -> (f64, f64)) -> Run {
        let mut run = Run::default();
        for n in 0..(end_s / TICK_S).round() as u32 {
            let from_s = f64::from(n) * TICK_S;
            let (from, to) = (motion(from_s), motion(from_s + TICK_S));
            let nm = self.step(from, to, to.0 - from.0);
            run.rows.push((from_s + TICK_S, to.0, nm));
            let times = self
                .words
                .iter()
                .map(|(word, f)| (*word, from_s + f * TICK_S));
            run.words.extend(times);
        }
        run
    }
}

#[derive(Default)]
struct Run {
    rows: Vec<(f64, f64, f64)>,
    words: Vec<(Word, f64)>,
}

impl Run {
    fn times(&self, word: Word) -> Vec<f64> {
        let of = self.words.iter().filter(|(w, _)| *w == word);
        of.map(|(_, time_s)| *time_s).collect()
    }

    fn at(&self, time_s: f64) -> f64 {
        self.rows[(time_s / TICK_S).round() as usize - 1].2
    }
}

/// The same speed from this angle on, deg and deg/s.
fn ramp(from_deg: f64, deg_s: f64) -> impl Fn(f64) -> (f64, f64) {
    let omega = deg_s.to_radians();
    move |t| (from_deg.to_radians() + omega * t, omega)
}

fn only<F: Real>(settings: EffectSettings, from_deg: f64) -> Rig<F> {
    Rig::new(settings, Sight::IDEAL, from_deg.to_radians())
}

/// One symptom, with parameters from these shares of their ranges.
#[expect(clippy::too_many_lines, reason = "a list of parameters")]
fn symptom(kind: usize, x: &[f64]) -> EffectSettings {
    let at = |i: usize, low: f64, high: f64| low + (high - low) * x[i];
    let none = EffectSettings::default();
    match kind {
        0 => {
            let loss = at(0, 0.1, 0.8);
            let stiffness = at(1, 1.0, (1000.0 * (1.0 - loss)).min(600.0));
            let cap = at(2, 0.1, 6.5);
            let most = (1000.0 * (1.0 - loss)).powi(2) - stiffness * stiffness;
            let stiffening = (0.99 * x[3] * most / (4.0 * cap)).min(5000.0);
            let low = at(4, -4.0, 90.0);
            EffectSettings {
                range_limit: Some(RangeLimitSettings {
                    extension_limit_deg: low,
                    flexion_limit_deg: low + at(5, 5.0, 40.0),
                    extension_stiffness_nm_per_rad: stiffness,
                    extension_stiffening_nm_per_rad2: stiffening,
                    extension_loss: loss,
                    extension_torque_nm: cap,
                    flexion_stiffness_nm_per_rad: stiffness,
                    flexion_stiffening_nm_per_rad2: stiffening,
                    flexion_loss: loss,
                    flexion_torque_nm: cap,
                }),
                ..none
            }
        }
        1 => EffectSettings {
            lead_pipe: Some(LeadPipeSettings {
                torque_nm: at(0, 0.1, 4.5),
                presliding_deg: at(1, 0.3, 10.0),
                ..LeadPipeSettings::default()
            }),
            ..none
        },
        2 => EffectSettings {
            cogwheel: Some(CogwheelSettings {
                mode: u8::from(x[0] > 0.5),
                torque_nm: at(1, 0.1, 4.5),
                presliding_deg: at(2, 0.3, 10.0),
                low_share: x[3],
                frequency_hz: at(4, 3.0, 12.0),
                duty: at(5, 0.1, 0.9),
                pitch_deg: at(4, 1.0, 30.0),
                ..CogwheelSettings::default()
            }),
            ..none
        },
        3 => EffectSettings {
            spasticity: Some(SpasticitySettings {
                muscles: u8::from(x[0] > 0.5),
                threshold_deg: at(1, 30.0, 90.0),
                threshold_velocity_deg_s: at(2, 5.0, 60.0),
                velocity_torque_nms_per_rad: at(3, 0.0, 2.0),
                residual_share: x[4],
                stiffness_nm_per_rad: at(5, 0.0, 10.0),
                release_s: at(0, 0.01, 1.0),
                catch_stiffness_nm_per_rad: at(1, 10.0, 300.0),
                rearm_deg: at(2, 2.0, 30.0),
                ..SpasticitySettings::default()
            }),
            ..none
        },
        4 => {
            let flexors = x[0] > 0.5;
            let (low, high) = (at(1, 20.0, 60.0), at(2, 61.0, 100.0));
            EffectSettings {
                clasp_knife: Some(ClaspKnifeSettings {
                    muscles: u8::from(flexors),
                    trigger: u8::from(x[3] > 0.5),
                    onset_deg: if flexors { high } else { low },
                    release_deg: if flexors { low } else { high },
                    onset_torque_nm: at(4, 0.0, 4.5),
                    slope_nm_per_rad: at(5, 0.0, 10.0),
                    residual_share: at(0, 0.0, 0.9),
                    collapse_s: at(1, 0.005, 0.3),
                    rearm_deg: at(2, 2.0, 30.0),
                    catch_stiffness_nm_per_rad: at(3, 10.0, 300.0),
                    release_torque_nm: at(4, 0.2, 4.5),
                }),
                ..none
            }
        }
        _ => {
            let (pitch, width) = (at(0, 0.5, 15.0), at(1, 0.1, 1.0));
            let stiffness = at(2, 50.0, 400.0);
            let most = 0.5 * stiffness * width * pitch.to_radians();
            let base = at(3, 0.0, 1.0);
            EffectSettings {
                texture: Some(TextureSettings {
                    base_nm: base,
                    peak_nm: base + (2.0 * x[4]).min(most),
                    pitch_deg: pitch,
                    width_share: width,
                    irregularity: 0.9 * x[5],
                    stiffness_nm_per_rad: stiffness,
                    ..TextureSettings::default()
                }),
                ..none
            }
        }
    }
}

const KINDS: usize = 6;

/// Minimum-jerk moves of a hand through these angles, deg, each of this many ticks.
fn hand(points: &[(f64, u32)]) -> Vec<f64> {
    let mut from = 60.0;
    let mut angles = vec![from];
    for &(to, ticks) in points {
        for i in 1..=ticks {
            let u = f64::from(i) / f64::from(ticks);
            angles.push(from + (to - from) * u * u * u * (10.0 + u * (6.0 * u - 15.0)));
        }
        from = to;
    }
    angles.into_iter().map(f64::to_radians).collect()
}

/// The energy that a hand got back, against the bound.
struct Ledger {
    delay: usize,
    late_nm: Vec<f64>,
    level_j: f64,
    /// The most that any earlier level is above what was stored then.
    floor_j: f64,
    unseen: (f64, f64, f64),
    /// What is held beyond the torque while that leaves.
    leaves_j: f64,
    worst_j: f64,
}

impl Ledger {
    fn new(delay: usize) -> Self {
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
    fn tick(&mut self, travel_rad: f64, nm: f64, seen: bool, stiffness: f64, fading: f64) {
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

struct Hand<'a> {
    angles: &'a [f64],
    delay: usize,
    counts: bool,
    /// Commits of these settings at these ticks.
    commits: &'a [(usize, EffectSettings)],
    /// Every so many ticks some samples are missing.
    gaps: Option<(usize, usize)>,
}

/// By how much a hand gets back more than the bound, J, and the largest torque.
fn excess<F: Real>(settings: EffectSettings, hand: &Hand<'_>) -> (f64, f64) {
    let encoder = EncoderSettings::default();
    let (sight, spare_rad) = if hand.counts {
        (Sight::of_encoder(&encoder), encoder.rad_per_count())
    } else {
        (Sight::IDEAL, 0.0)
    };
    let count = |rad: f64| (rad / encoder.rad_per_count()).floor() as i32;
    let angles = hand.angles;
    let mut reader = EncoderReader::<F>::new(&encoder, TICK_S, count(angles[0]), F::ZERO).unwrap();
    let mut rig = Rig::<F>::new(settings, sight, angles[0]);
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
            rig.tick(Sample::Lost, sight.position(seen_rad))
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

fn parameters() -> impl Strategy<Value = (usize, Vec<f64>)> {
    (0..KINDS, prop::collection::vec(0.0..1.0_f64, 6))
}

fn points() -> impl Strategy<Value = Vec<(f64, u32)>> {
    prop::collection::vec((20.0..100.0_f64, 1500..6000_u32), 2..8)
}

/// Small moves about a place, as a hand in contact makes.
fn tremble() -> impl Strategy<Value = Vec<(f64, u32)>> {
    (
        30.0..90.0_f64,
        prop::collection::vec((-6.0..6.0_f64, 300..1500_u32), 4..20),
    )
        .prop_map(|(at, moves)| moves.into_iter().map(|(deg, n)| (at + deg, n)).collect())
}

proptest! {
    #![proptest_config(support::cases(300))]

    #[test]
    fn a_play_gives_no_more_than_it_holds(
        (kind, x) in parameters(),
        points in prop_oneof![points(), tremble()],
        delay in 0..3_usize,
        counts: bool,
        single: bool,
        gaps in prop::option::of((30..400_usize, 1..19_usize)),
    ) {
        let hand = Hand {
            angles: &hand(&points),
            delay,
            counts,
            commits: &[],
            // The bound for late torque takes ticks of one length.
            gaps: gaps.filter(|_| !counts && delay == 0),
        };
        let settings = symptom(kind, &x);
        let (excess_j, _) = if single {
            excess::<f32>(settings, &hand)
        } else {
            excess::<f64>(settings, &hand)
        };
        let rounding_j = if single { 2e-5 } else { 1e-9 };
        prop_assert!(excess_j <= rounding_j, "{excess_j} J");
    }

    #[test]
    fn nor_does_it_over_commits(
        (kind, x) in parameters(),
        others in prop::collection::vec((prop::option::of(prop::collection::vec(0.0..1.0_f64, 6)), 0..20_000_usize), 1..6),
        points in prop_oneof![points(), tremble()],
    ) {
        let commits: Vec<_> = others
            .iter()
            .map(|(x, tick)| {
                let none = EffectSettings::default();
                (*tick, x.as_ref().map_or(none, |x| symptom(kind, x)))
            })
            .collect();
        let angles = hand(&points);
        let hand = Hand { angles: &angles, delay: 0, counts: false, commits: &commits, gaps: None };
        let settings = symptom(kind, &x);
        let (excess_j, _) = excess::<f64>(settings, &hand);
        prop_assert!(excess_j <= 1e-7, "{excess_j} J");
    }

    #[test]
    fn a_commit_pushes_no_hand_that_rests(
        (kind, x) in parameters(),
        (other, y) in parameters(),
        points in tremble(),
    ) {
        let angles = hand(&points);
        let mut rig = Rig::<f64>::new(symptom(kind, &x), Sight::IDEAL, angles[0]);
        let mut nm = 0.0;
        for pair in angles.windows(2) {
            let omega = (pair[1] - pair[0]) / TICK_S;
            nm = rig.step((pair[0], omega), (pair[1], omega), pair[1] - pair[0]);
        }
        let rest = (angles[angles.len() - 1], 0.0);
        rig.commit(symptom(other, &y));
        for _ in 0..3_000 {
            let now_nm = rig.step(rest, rest, 0.0);
            let slower = (now_nm - nm).abs() <= SLEW_NM + 1e-12;
            // What decays or gives by itself does so as fast as it wants.
            prop_assert!(slower || now_nm.abs() <= nm.abs(), "{nm} to {now_nm}");
            prop_assert!(now_nm.abs() <= nm.abs() + 1e-12, "{nm} to {now_nm}");
            nm = now_nm;
        }
    }

    #[test]
    fn what_gives_energy_is_paid_from_the_tank(
        gain in 0.0..20.0_f64,
        amplitude in 0.0..4.5_f64,
        frequency in 0.5..12.0_f64,
        sweep in 0.05..0.6_f64,
    ) {
        let settings = EffectSettings {
            spasticity: Some(SpasticitySettings {
                form: 1,
                threshold_deg: 60.0,
                velocity_shift_s: 0.27,
                gain_nm_per_rad: gain,
                ..SpasticitySettings::default()
            }),
            clonus: Some(ClonusSettings {
                amplitude_nm: amplitude,
                start_velocity_deg_s: 20.0,
                ..ClonusSettings::default()
            }),
            ..EffectSettings::default()
        };
        let mut rig = only::<f64>(settings, 60.0);
        let sweep = sweep.min(6.0 / (std::f64::consts::TAU * frequency));
        let motion = |t: f64| {
            let w = std::f64::consts::TAU * frequency;
            (1.05 + sweep * (w * t).sin(), sweep * w * (w * t).cos())
        };
        let (mut level_j, mut highest_j, mut nm) = (0.0_f64, 0.0_f64, 0.0);
        for n in 0..60_000_u32 {
            let (from, to) = (motion(f64::from(n) * TICK_S), motion(f64::from(n + 1) * TICK_S));
            level_j += nm * (to.0 - from.0) + TANK_REFILL_W * TICK_S;
            nm = rig.step(from, to, to.0 - from.0);
            highest_j = highest_j.max(level_j);
            // A tick may take more than is left.
            prop_assert!(highest_j - level_j <= TANK_J + 2e-3, "{}", highest_j - level_j);
        }
    }

    #[test]
    fn no_input_makes_a_torque_that_is_none(
        (kind, x) in parameters(),
        samples in prop::collection::vec((0..12_usize, -3.0..3.0_f64), 500..1500),
    ) {
        let settings = symptom(kind, &x);
        let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e30, -1e30, 1e-42, f64::MAX];
        let mut rig = Rig::<f32>::new(settings, Sight::IDEAL, 1.0);
        let mut phi = 1.0;
        // No torque of a symptom with these parameters is beyond.
        let most_nm = settings.largest_torque_nm(None) + 10.0 * 3.0;
        for (which, omega) in samples {
            let nm = if let Some(x) = bad.get(which) {
                let to = (phi, omega);
                match which % 3 {
                    0 => rig.step((phi, *x), to, 0.0),
                    1 => rig.step((phi, omega), (phi, *x), 0.0),
                    _ => rig.step((phi, omega), to, *x),
                }
            } else {
                phi += 20.0 * omega * TICK_S;
                rig.step((phi, omega), (phi, omega), omega * TICK_S)
            };
            prop_assert!(nm.is_finite() && nm.abs() <= most_nm, "{nm}");
        }
        for _ in 0..100 {
            let nm = rig.step((phi, 0.5), (phi + 0.5 * TICK_S, 0.5), 0.5 * TICK_S);
            phi += 0.5 * TICK_S;
            prop_assert!(nm.is_finite());
        }
    }

    #[test]
    fn a_wall_never_pulls_and_keeps_its_cap(
        x in prop::collection::vec(0.0..1.0_f64, 6),
        y in prop::collection::vec(0.0..1.0_f64, 6),
        points in points(),
        at in 0..8_000_usize,
    ) {
        let (before, after) = (symptom(0, &x), symptom(0, &y));
        let cap = |s: &EffectSettings| s.range_limit.map_or(0.0, |s| s.flexion_torque_nm);
        let angles = hand(&points);
        let commits = [(at, after)];
        let hand = Hand { angles: &angles, delay: 0, counts: false, commits: &commits, gaps: None };
        let (_, largest_nm) = excess::<f64>(before, &hand);
        prop_assert!(largest_nm <= cap(&before).max(cap(&after)) + 1e-9);
    }

    #[test]
    fn flexors_are_the_mirror_image_of_extensors(
        which in 0..4_usize,
        x in prop::collection::vec(0.0..1.0_f64, 6),
        points in points(),
    ) {
        // Mirrored about 60 deg.
        let image = |deg: f64| 120.0 - deg;
        let mut own = EffectSettings::default();
        let mut other = own;
        match which {
            0 => {
                let wall = symptom(0, &x).range_limit.unwrap();
                own.range_limit = Some(wall);
                other.range_limit = Some(RangeLimitSettings {
                    extension_limit_deg: image(wall.flexion_limit_deg),
                    flexion_limit_deg: image(wall.extension_limit_deg),
                    ..wall
                });
            }
            1 => {
                let muscle = SpasticitySettings { muscles: 0, ..symptom(3, &x).spasticity.unwrap() };
                own.spasticity = Some(muscle);
                other.spasticity = Some(SpasticitySettings {
                    muscles: 1,
                    threshold_deg: image(muscle.threshold_deg),
                    ..muscle
                });
            }
            2 => {
                let knife = ClaspKnifeSettings {
                    muscles: 0,
                    onset_deg: 30.0 + 20.0 * x[0],
                    release_deg: 60.0 + 20.0 * x[1],
                    ..symptom(4, &x).clasp_knife.unwrap()
                };
                own.clasp_knife = Some(knife);
                other.clasp_knife = Some(ClaspKnifeSettings {
                    muscles: 1,
                    onset_deg: image(knife.onset_deg),
                    release_deg: image(knife.release_deg),
                    ..knife
                });
            }
            _ => {
                let clonus = ClonusSettings {
                    hold_deg: 40.0 + 40.0 * x[0],
                    start_velocity_deg_s: 20.0 + 100.0 * x[1],
                    ..ClonusSettings::default()
                };
                own.clonus = Some(clonus);
                other.clonus = Some(ClonusSettings {
                    muscles: 1,
                    hold_deg: image(clonus.hold_deg),
                    ..clonus
                });
            }
        }
        let angles = hand(&points);
        let middle = 60_f64.to_radians();
        let (mut one, mut two) = (only::<f64>(own, 60.0), only::<f64>(other, 60.0));
        let mut omega = 0.0;
        for pair in angles.windows(2) {
            let moved = pair[1] - pair[0];
            let end = moved / TICK_S;
            let nm = one.step((pair[0], omega), (pair[1], end), moved);
            let mirrored = |rad: f64| 2.0 * middle - rad;
            let image_nm = two.step((mirrored(pair[0]), -omega), (mirrored(pair[1]), -end), -moved);
            prop_assert!((nm + image_nm).abs() < 1e-9, "{nm} {image_nm}");
            // Both walls may have something to say in a tick.
            let words = |rig: &Rig<f64>| {
                let mut words: Vec<_> = rig.words.iter().map(|(word, _)| word.name()).collect();
                words.sort_unstable();
                words
            };
            prop_assert_eq!(words(&one), words(&two));
            omega = end;
        }
    }
}

/// A symptom whose mirror image about 0 deg has settings of its own, and that image.
fn mirrored(which: usize, x: &[f64]) -> [EffectSettings; 2] {
    let mut both = [EffectSettings::default(); 2];
    let [own, image] = &mut both;
    match which {
        0 => {
            let wall = RangeLimitSettings {
                extension_limit_deg: -1.0 - 9.0 * x[4],
                flexion_limit_deg: 4.0 + 30.0 * x[5].min(0.2),
                ..symptom(0, x).range_limit.unwrap()
            };
            own.range_limit = Some(wall);
            image.range_limit = Some(RangeLimitSettings {
                extension_limit_deg: -wall.flexion_limit_deg,
                flexion_limit_deg: -wall.extension_limit_deg,
                ..wall
            });
        }
        1 | 2 => {
            let muscle = SpasticitySettings {
                form: u8::from(which == 2),
                muscles: 0,
                threshold_deg: 60.0 * x[1] - 30.0,
                ..symptom(3, x).spasticity.unwrap()
            };
            own.spasticity = Some(muscle);
            image.spasticity = Some(SpasticitySettings {
                muscles: 1,
                threshold_deg: -muscle.threshold_deg,
                ..muscle
            });
        }
        3 => {
            let clonus = ClonusSettings {
                hold_deg: 0.0,
                start_velocity_deg_s: 20.0 + 100.0 * x[1],
                ..ClonusSettings::default()
            };
            own.clonus = Some(clonus);
            image.clonus = Some(ClonusSettings {
                muscles: 1,
                ..clonus
            });
        }
        4 => {
            own.lead_pipe = Some(LeadPipeSettings {
                elastic_nm_per_rad: 10.0 * x[2],
                neutral_deg: 0.0,
                ..symptom(1, x).lead_pipe.unwrap()
            });
            *image = *own;
        }
        _ => {
            own.cogwheel = Some(CogwheelSettings {
                mode: 0,
                elastic_nm_per_rad: 10.0 * x[5],
                neutral_deg: 0.0,
                ..symptom(2, x).cogwheel.unwrap()
            });
            *image = *own;
        }
    }
    both
}

/// Follows a hand and its mirror image: the torques are each other's to the bit.
fn mirrors<F: Real>(both: &[EffectSettings; 2], angles: &[f64]) -> Result<(), TestCaseError> {
    let [mut one, mut two] = both.map(|settings| Rig::<F>::new(settings, Sight::IDEAL, angles[0]));
    two.effects.rest(&Sight::IDEAL.position(-angles[0]));
    let mut omega = 0.0;
    for pair in angles.windows(2) {
        let moved = pair[1] - pair[0];
        let end = moved / TICK_S;
        let nm = one.step((pair[0], omega), (pair[1], end), moved);
        let image_nm = two.step((-pair[0], -omega), (-pair[1], -end), -moved);
        prop_assert_eq!(nm, -image_nm, "{}", F::NAME);
        omega = end;
    }
    Ok(())
}

proptest! {
    #![proptest_config(support::cases(300))]

    #[test]
    fn a_mirrored_joint_shows_the_mirrored_torque_to_the_bit(
        which in 0..6_usize,
        x in prop::collection::vec(0.0..1.0_f64, 6),
        points in points(),
    ) {
        let both = mirrored(which, &x);
        let middle = 60_f64.to_radians();
        let angles: Vec<_> = hand(&points).iter().map(|rad| rad - middle).collect();
        mirrors::<f64>(&both, &angles)?;
        mirrors::<f32>(&both, &angles)?;
    }
}

fn near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found} for {expected}");
}

#[test]
fn cogwheel_has_its_mean_and_its_height() {
    let settings = EffectSettings {
        cogwheel: Some(CogwheelSettings::default()),
        ..EffectSettings::default()
    };
    let run = only::<f64>(settings, 0.0).run(1.6, ramp(0.0, 60.0));
    let late: Vec<f64> = run
        .rows
        .iter()
        .filter(|r| r.0 > 0.32)
        .map(|r| r.2)
        .collect();
    near(late.iter().sum::<f64>() / late.len() as f64, 1.343_75, 1e-3);
    let peak = |deg_s: f64| {
        let run = only::<f64>(settings, 0.0).run(1.6, ramp(0.0, deg_s));
        let late = run.rows.iter().filter(|r| r.0 > 0.8);
        late.fold(0.0_f64, |most, r| most.max(r.2))
    };
    near(peak(11.3), 2.0, 1e-9);
    near(peak(11.2), 2.0 - 0.05 / 11.25 * 1.2, 1e-3);
    near(peak(5.0), 0.8 + 5.0 / 1.5 * 2.0 * 0.08, 1e-3);
}

#[test]
fn a_cogwheel_at_rest_gives_once() {
    let settings = EffectSettings {
        cogwheel: Some(CogwheelSettings::default()),
        ..EffectSettings::default()
    };
    let run = only::<f64>(settings, 0.0).run(2.0, |t| {
        let moves = t < 0.0699;
        let deg = 60.0 * t.min(0.07);
        (
            deg.to_radians(),
            if moves { 60_f64.to_radians() } else { 0.0 },
        )
    });
    assert_eq!(run.times(Word::Give).len(), 1);
    let later: Vec<_> = run.words.iter().filter(|(_, t)| *t > 0.17).collect();
    assert!(later.is_empty(), "{later:?}");
    near(run.at(1.9), 0.8, 1e-9);
}

#[test]
fn a_lead_pipe_loop_costs_the_same_at_any_speed() {
    let settings = EffectSettings {
        lead_pipe: Some(LeadPipeSettings::default()),
        ..EffectSettings::default()
    };
    let area = 4.0 * 1.2 * (30.0 - 1.5_f64).to_radians();
    for frequency in [0.25, 1.0, 2.0] {
        let w = std::f64::consts::TAU * frequency;
        let swing = 30_f64.to_radians();
        let motion = |t: f64| (swing * (w * t).sin(), swing * w * (w * t).cos());
        let run = only::<f64>(settings, 0.0).run(2.0 / frequency, motion);
        let second = run
            .rows
            .windows(2)
            .filter(|r| r[0].0 >= 1.0 / frequency - 1e-9);
        let work: f64 = second
            .map(|r| 0.5 * (r[0].2 + r[1].2) * (r[1].1 - r[0].1))
            .sum();
        near(work, area, 2e-4);
    }
    near(area, 2.3876, 1e-4);
}

#[test]
fn mas_2_catches_a_fast_stretch_where_it_should() {
    let settings = EffectSettings {
        spasticity: Some(SpasticitySettings::default()),
        ..EffectSettings::default()
    };
    for (deg_s, at_deg, nm) in [(90.0, 52.5, 1.05), (130.0, 42.5, 1.52)] {
        let run = only::<f64>(settings, 10.0).run(0.8, ramp(10.0, deg_s));
        let caught = run.times(Word::Catch);
        assert_eq!(caught.len(), 1);
        near(10.0 + deg_s * caught[0], at_deg, 1e-6);
        // P, which the torque comes near to before it decays.
        near(0.67 * f64::to_radians(deg_s), nm, 5e-3);
        let soon = run.rows.iter().filter(|r| r.0 < caught[0] + 0.1);
        let peak = soon.fold(0.0_f64, |most, r| most.max(r.2));
        assert!(peak > 0.7 * nm && peak <= nm + 0.3, "{peak}");
    }
    let run = only::<f64>(settings, 10.0).run(3.0, ramp(10.0, 30.0));
    assert!(run.words.is_empty() && run.rows.iter().all(|r| r.2 == 0.0));
}

#[test]
fn a_clasp_knife_builds_and_melts_away() {
    let settings = EffectSettings {
        clasp_knife: Some(ClaspKnifeSettings::default()),
        ..EffectSettings::default()
    };
    let run = only::<f64>(settings, 10.0).run(1.5, ramp(10.0, 60.0));
    let released = run.times(Word::Release);
    near(10.0 + 60.0 * released[0], 75.0, 1e-6);
    near(
        run.at(released[0] - TICK_S),
        0.8 + 3.0 * 45_f64.to_radians(),
        2e-3,
    );
    near(0.8 + 3.0 * 45_f64.to_radians(), 3.156, 1e-3);
    near(run.at(released[0] + 0.085) / 3.156, 0.2, 2e-3);
}

#[test]
fn a_hard_wall_is_stiff_and_returns_little() {
    let settings = EffectSettings {
        range_limit: Some(RangeLimitSettings {
            flexion_limit_deg: 90.0,
            flexion_stiffness_nm_per_rad: 300.0,
            flexion_stiffening_nm_per_rad2: 0.0,
            flexion_loss: 0.25,
            ..RangeLimitSettings::default()
        }),
        ..EffectSettings::default()
    };
    let w = std::f64::consts::TAU * 0.25;
    let motion = |t: f64| {
        let swing = 6_f64.to_radians();
        let from = 87_f64.to_radians();
        (from + swing * (w * t).sin(), swing * w * (w * t).cos())
    };
    let run = only::<f64>(settings, 87.0).run(4.0, motion);
    let met = run.times(Word::Contact)[0];
    let cap = run.times(Word::Cap)[0];
    near(motion(met).0.to_degrees(), 90.0, 1e-6);
    near(motion(cap).0.to_degrees() - 90.0, 0.764, 1e-3);
    let most = run.rows.iter().fold(0.0_f64, |most, r| most.max(r.2));
    near(most, 4.0, 1e-12);
    let back = run.rows.windows(2).filter(|r| r[1].1 < r[0].1);
    let returned: f64 = back
        .map(|r| -0.5 * (r[0].2 + r[1].2) * (r[1].1 - r[0].1))
        .sum();
    assert!(returned <= 20e-3 + 1e-6 && returned > 19e-3, "{returned}");
}

#[test]
fn clonus_slows_down_to_its_rhythm() {
    let settings = EffectSettings {
        clonus: Some(ClonusSettings::default()),
        ..EffectSettings::default()
    };
    let run = only::<f64>(settings, 40.0).run(2.0, |t| {
        let deg = 40.0 + 150.0 * t.min(0.2);
        let omega = if t < 0.2 - 1e-9 {
            150_f64.to_radians()
        } else {
            0.0
        };
        (deg.to_radians(), omega)
    });
    let start = run.times(Word::Start)[0];
    let beats = run.times(Word::Beat);
    near(beats[0] - start, 0.05, 1e-9);
    for (pair, ms) in beats.windows(2).zip([216.7, 191.7, 179.2, 172.9, 169.8]) {
        near(1e3 * (pair[1] - pair[0]), ms, 0.05);
    }
    // Impulse of a beat: 2·A·D·P/π.
    let first = run.rows.iter().filter(|r| r.0 > beats[0] && r.0 < beats[1]);
    let impulse: f64 = first.map(|r| r.2 * TICK_S).sum();
    near(
        impulse,
        2.0 * 1.5 * 0.45 * 0.216_667 / std::f64::consts::PI,
        1e-5,
    );
}

#[test]
fn texture_snaps_by_the_angle() {
    let settings = EffectSettings {
        texture: Some(TextureSettings {
            irregularity: 0.0,
            ..TextureSettings::default()
        }),
        ..EffectSettings::default()
    };
    for (deg_s, snaps) in [(60.0, 40), (30.0, 20)] {
        let run = only::<f64>(settings, 0.5).run(2.0, ramp(0.5, deg_s));
        let second = run.times(Word::Snap).into_iter().filter(|t| *t > 1.0);
        assert_eq!(second.count(), snaps);
        let nm: Vec<f64> = run.rows.iter().filter(|r| r.0 > 1.0).map(|r| r.2).collect();
        near(nm.iter().sum::<f64>() / nm.len() as f64, 0.19, 1e-3);
    }
}

#[test]
fn a_reflex_is_late_and_passive_below_some_hertz() {
    let muscle = SpasticitySettings {
        form: 1,
        threshold_deg: 20.0,
        velocity_shift_s: 0.25,
        gain_nm_per_rad: 1.0,
        ..SpasticitySettings::default()
    };
    let settings = |muscle| EffectSettings {
        spasticity: Some(muscle),
        ..EffectSettings::default()
    };
    // A stretch at constant speed: y = k(φ − λ + μΩ − Ω(τd + τa)).
    let run = only::<f64>(settings(muscle), 5.0).run(1.0, ramp(5.0, 40.0));
    let expected = (5.0 + 40.0 * 0.9 - 20.0 + 40.0 * (0.25 - 0.06_f64)).to_radians();
    near(run.at(0.9), expected, 1e-6);
    // A sine about a place beyond the threshold: the work of its last periods.
    for (frequency, is_passive) in [(2.0, true), (3.6, true), (3.9, false), (6.0, false)] {
        let w = std::f64::consts::TAU * frequency;
        let swing = 0.01;
        let motion = |t: f64| (1.2 + swing * (w * t).sin(), swing * w * (w * t).cos());
        let run = only::<f64>(settings(muscle), 1.2_f64.to_degrees()).run(10.0 / frequency, motion);
        let late = run
            .rows
            .windows(2)
            .filter(|r| r[0].0 >= 8.0 / frequency - 1e-9);
        let work: f64 = late
            .map(|r| 0.5 * (r[0].2 + r[1].2) * (r[1].1 - r[0].1))
            .sum();
        assert_eq!(work > 0.0, is_passive, "{frequency} Hz: {work}");
    }
}
