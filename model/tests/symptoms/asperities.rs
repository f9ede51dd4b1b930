//! The rough joint against a second one that shares nothing with it: a spring that is
//! pulled along in small parts of a count.

use super::rig::*;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::render::effects::symptom::Word;
use crepitus_model::render::effects::texture::TextureSettings;
use crepitus_model::render::position::{Position, Sensing};
use crepitus_model::{Real, Sample, ShaftStep};

/// Parts of a count.
const PARTS: i32 = 64;

/// A spring over regular asperities.
struct Spring {
    settings: TextureSettings,
    sensing: Sensing,
    /// The asperity below.
    below: i32,
    /// Place of the joint, in parts of a count.
    at: i32,
    nm: f64,
    snaps: u32,
    /// The direction in which it is dragged along a limit, or 0.
    dragged: i32,
}

impl Spring {
    fn new(settings: TextureSettings, sensing: Sensing, count: i32) -> Self {
        let mut spring = Self {
            settings,
            sensing,
            below: 0,
            at: count * PARTS,
            nm: 0.0,
            snaps: 0,
            dragged: 0,
        };
        spring.below = (spring.angle_rad() / spring.pitch_rad()).floor() as i32;
        spring
    }

    fn pitch_rad(&self) -> f64 {
        self.settings.pitch_deg.to_radians()
    }

    fn angle_rad(&self) -> f64 {
        f64::from(self.at) / f64::from(PARTS) * self.sensing.rad_per_count
    }

    /// Whether the asperity of this number is there: patches of a pitch each are counted, not divided.
    fn is_there(&self, number: i32) -> bool {
        let TextureSettings {
            patch_deg,
            patch_share,
            ..
        } = self.settings;
        if patch_deg == 0.0 {
            return true;
        }
        let all = (patch_deg / self.settings.pitch_deg).round() as i32;
        let there = ((patch_share * f64::from(all)).round() as i32).max(1);
        let mut number = number;
        while number < 0 {
            number += all;
        }
        while number >= all {
            number -= all;
        }
        number < there
    }

    /// The limit towards the asperity of this number at this distance.
    fn limit_nm(&self, number: i32, away_rad: f64) -> f64 {
        if !self.is_there(number) {
            return self.settings.base_nm;
        }
        let TextureSettings {
            base_nm, peak_nm, ..
        } = self.settings;
        let width_rad = self.settings.width_share * self.pitch_rad();
        let share = (1.0 - away_rad.max(0.0) / width_rad).max(0.0);
        base_nm + (peak_nm - base_nm) * share
    }

    /// Goes on by so many counts.
    fn go(&mut self, counts: i32) -> f64 {
        let part_rad = self.sensing.rad_per_count / f64::from(PARTS);
        let end_rad = self.angle_rad() + f64::from(counts) * self.sensing.rad_per_count;
        for _ in 0..(counts * PARTS).abs() {
            let way = counts.signum();
            self.at += way;
            let below_rad = f64::from(self.below) * self.pitch_rad();
            let beyond_rad = self.angle_rad() - below_rad;
            // Downwards a tick that ends within the encoder's noise has not passed it.
            let is_noise = end_rad - below_rad >= -self.sensing.flicker_rad;
            let passed = if way > 0 {
                i32::from(beyond_rad >= self.pitch_rad())
            } else {
                -i32::from(beyond_rad < 0.0 && !is_noise)
            };
            if passed != 0 {
                let crossed = if way > 0 { self.below + 1 } else { self.below };
                self.snaps += u32::from(self.dragged == way && self.is_there(crossed));
                self.below += passed;
            }
            let beyond_rad = beyond_rad - f64::from(passed) * self.pitch_rad();
            let lower_nm = -self.limit_nm(self.below, beyond_rad);
            let upper_nm = self.limit_nm(self.below + 1, self.pitch_rad() - beyond_rad);
            let elastic_nm =
                self.nm + f64::from(way) * part_rad * self.settings.stiffness_nm_per_rad;
            self.nm = elastic_nm.clamp(lower_nm, upper_nm);
            let limit_nm = if way > 0 { upper_nm } else { lower_nm };
            self.dragged = if self.nm == limit_nm { way } else { 0 };
        }
        self.nm
    }
}

/// Counts of a hand that goes to and fro, rests, hurries and trembles.
fn hand(seed: u64) -> impl Iterator<Item = i32> {
    let mut random = fastrand::Rng::with_seed(seed);
    (0..200).flat_map(move |_| {
        let ticks = random.u8(..90);
        let speed = random.i32(0..5);
        let way = if random.bool() { 1 } else { -1 };
        let trembles = random.u8(..3) == 0;
        (0..ticks).map(move |tick| match (trembles, tick % 2) {
            (true, 0) => way,
            (true, _) => -way,
            _ => way * speed,
        })
    })
}

fn compare<F: Real>(settings: TextureSettings, from: i32, within_nm: f64) -> u32 {
    let sensing = Sensing::of_encoder(&EncoderSettings::default());
    let effects = on!(texture: settings);
    let mut snaps = 0;
    for seed in 0..20 {
        let mut count = from;
        let mut rig = Rig::<F>::new(effects, sensing, f64::from(from) * sensing.rad_per_count);
        let mut spring = Spring::new(settings, sensing, from);
        for (tick, by) in hand(seed).enumerate() {
            count += by;
            let travel_rad = f64::from(by) * sensing.rad_per_count;
            let omega = F::from_f64(travel_rad / TICK_S);
            let shaft = ShaftStep {
                delta_phi_rad: F::from_f64(travel_rad),
                omega_start_rad_s: omega,
                omega_end_rad_s: omega,
            };
            let nm = rig.tick(Sample::Taken(shaft), Position::at(count));
            let before = spring.snaps;
            let expected_nm = spring.go(by);
            assert!(
                (nm - expected_nm).abs() <= within_nm,
                "seed {seed}, tick {tick}, count {count}: {nm} for {expected_nm}"
            );
            let told = rig.words.iter().filter(|(word, _)| *word == Word::Snap);
            assert_eq!(
                told.count() as u32,
                spring.snaps - before,
                "seed {seed}, tick {tick}, count {count}"
            );
        }
        snaps += spring.snaps;
    }
    snaps
}

#[test]
fn an_encoder_that_goes_to_and_fro_over_asperities_meets_each_as_a_spring_would() {
    let rough = TextureSettings {
        irregularity: 0.0,
        ..TextureSettings::default()
    };
    let fine = TextureSettings {
        pitch_deg: 0.5,
        base_nm: 0.0,
        width_share: 1.0,
        stiffness_nm_per_rad: 400.0,
        ..rough
    };
    let patches = TextureSettings {
        patch_deg: 2.4,
        patch_share: 0.5,
        ..fine
    };
    for settings in [rough, fine, patches] {
        for from in [7, -700, 9_000] {
            // A pitch is known to 2⁻²⁰ counts.
            let snaps = compare::<f64>(settings, from, 1e-7);
            assert!(snaps > 100, "{snaps}");
            compare::<f32>(settings, from, 1e-4);
        }
    }
}
