//! All symptoms of a device at once, whatever the sensor delivers, with other
//! settings committed at any tick, in contact or not. After every tick:
//!
//! - every symptom's torque is finite and at most what its settings allow, or no more
//!   than it was before they were in force;
//! - while the leg rests, no torque of a play grows; after a commit only to what motion
//!   has earned since it was switched on, within twice the slew limit;
//! - what gives energy gives no more than its tank holds;
//! - while the motor is not driven there is no torque;
//! - words are within the tick and in order for each symptom, and bounded in number.

use crate::bytes::Bytes;
use crate::guarded::{next_samples, sample};
use crate::shaft::Shaft;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::parameters::Chosen;
use crepitus_model::render::effects::symptom::Change;
use crepitus_model::render::effects::{
    EffectSettings, EffectSpec, SPECS, SwitchedEffects, TANK_J, TANK_REFILL_W, Timing,
};
use crepitus_model::render::input_check::{Checked, InputCheck, InputLimits};
use crepitus_model::render::position::Sensing;
use crepitus_model::render::{Addition, Check, ShaftEstimate, Shown};
use crepitus_model::{Real, ShaftStep};
use std::f64::consts::PI;

const STEP_S: f64 = 5e-5;

/// Slew limit of the device, N·m in a step: 100 N·m/s.
const SLEW_NM: f64 = 100.0 * STEP_S;

/// The most ticks of one input.
const MOST_TICKS: usize = 4096;

/// The most words of a tick.
const MOST_WORDS: usize = 8 * SYMPTOMS;

/// Places of the symptoms in the table of effects.
const SYMPTOMS: usize = crepitus_model::render::effects::SYMPTOMS.len();

/// Checks the laws.
///
/// # Panics
/// If one is broken.
pub fn body(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let kind = bytes.byte();
    let sensing = if kind & 2 == 0 {
        Sensing::IDEAL
    } else {
        Sensing::of_encoder(&EncoderSettings::default())
    };
    if kind & 1 == 0 {
        run::<f32>(bytes, sensing);
    } else {
        run::<f64>(bytes, sensing);
    }
}

fn run<F: Real>(mut bytes: Bytes<'_>, sensing: Sensing) {
    let mut knee = Knee::<F>::new(sensing, 2.5 * bytes.part());
    knee.commit(&settings(&mut bytes));
    if bytes.byte() & 1 == 0 {
        let place = sensing.position(knee.angle_rad);
        knee.effects.rest(&place);
    }
    let mut shaft = Shaft::default();
    while !bytes.is_empty() && knee.ticks < MOST_TICKS {
        let what = bytes.byte();
        if what.is_multiple_of(8) {
            knee.commit(&settings(&mut bytes));
        }
        // The motor is let go, or driven again.
        if what % 64 == 33 {
            knee.is_driven = !knee.is_driven;
        }
        for step in next_samples(&mut bytes, &mut shaft, STEP_S) {
            knee.tick(step.as_ref());
        }
    }
}

/// Settings of some symptoms: any values in their ranges.
fn settings(bytes: &mut Bytes<'_>) -> EffectSettings {
    let on = bytes.byte();
    let made: Vec<_> = SPECS[..SYMPTOMS]
        .iter()
        .enumerate()
        .map(|(place, spec)| {
            (on >> place & 1 == 1).then(|| {
                // Few bytes: most numbers stay at their default.
                let seed = bytes.byte();
                let numbers: Vec<f64> = spec
                    .parameters
                    .iter()
                    .enumerate()
                    .map(|(n, p)| {
                        if seed >> (n % 8) & 1 == 0 {
                            return p.default;
                        }
                        let number = p.min + (p.max - p.min) * bytes.part();
                        // Others are refused.
                        let is_whole = matches!(p.key, "beats" | "seed");
                        if is_whole { number.trunc() } else { number }
                    })
                    .collect();
                let options: Vec<u8> = spec
                    .choices
                    .iter()
                    .map(|choice| bytes.byte() % u8::try_from(choice.names.len()).unwrap_or(1))
                    .collect();
                (numbers, options)
            })
        })
        .collect();
    EffectSettings::given(|name| {
        let place = SPECS[..SYMPTOMS]
            .iter()
            .position(|spec| spec.name == name)?;
        let (numbers, options) = made[place].as_ref()?;
        Some(Chosen { numbers, options })
    })
}

/// Bounds of what one symptom may show.
#[derive(Clone, Copy, Debug, Default)]
struct Bounds {
    is_on: bool,
    /// N·m, wherever the leg is.
    largest_nm: f64,
    /// Growth of the bound with the angle, N·m/rad.
    slope: f64,
    /// Stiffness of its play, N·m/rad.
    stiffness: f64,
    /// Whether it has a spring besides its play, which a commit moves.
    is_elastic: bool,
    /// Whether it gives energy.
    is_active: bool,
}

impl Bounds {
    fn of(settings: &EffectSettings, place: usize) -> Self {
        let alone = settings.only(place);
        let largest_nm = alone.largest_torque_nm(None);
        let elastic = [
            alone.lead_pipe.map_or(0.0, |s| s.elastic_nm_per_rad),
            alone.cogwheel.map_or(0.0, |s| s.elastic_nm_per_rad),
        ];
        Self {
            is_on: alone != EffectSettings::default(),
            largest_nm,
            stiffness: alone.stiffness_nm_per_rad(None),
            slope: (alone.torque_bound_nm(None) - largest_nm) / PI,
            is_elastic: elastic.into_iter().any(|k| k > 0.0),
            is_active: alone.clonus.is_some() || alone.spasticity.is_some_and(|s| s.form == 1),
        }
    }

    fn at(&self, angle_rad: f64) -> f64 {
        // No neutral angle and no onset is beyond a turn.
        self.largest_nm + self.slope * (angle_rad.abs() + 2.0 * PI)
    }

    fn spring_nm(&self, angle_rad: f64) -> f64 {
        if self.is_elastic {
            self.at(angle_rad) - self.largest_nm
        } else {
            0.0
        }
    }
}

/// Knowledge of the leg's way in a tick.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    ShaftEstimate,
    Unseen,
    /// Over a gap.
    Guessed,
}

/// The symptoms of a device, and what is known of them from outside.
struct Knee<F: Real> {
    effects: SwitchedEffects<F>,
    check: InputCheck<F>,
    timing: Timing,
    settings: EffectSettings,
    angle_rad: f64,
    is_driven: bool,
    ticks: usize,
    bounds: [Bounds; SYMPTOMS],
    /// Torque that each may show, and torque that it shows, N·m.
    allowed_nm: [f64; SYMPTOMS],
    shown_nm: [f64; SYMPTOMS],
    /// Torque that each held when it was switched on, plus what motion has added since, N·m.
    earned_nm: [f64; SYMPTOMS],
    /// Each has had a spring besides, or has given energy, at some time.
    was_elastic: [bool; SYMPTOMS],
    was_active: [bool; SYMPTOMS],
    /// Each gives energy, or did when it was switched off.
    is_paid: [bool; SYMPTOMS],
    /// The tank as seen from outside, J.
    level_j: f64,
    highest_j: f64,
    /// The most that a tick has taken, J.
    tick_j: f64,
}

impl<F: Real> Knee<F> {
    fn new(sensing: Sensing, angle_rad: f64) -> Self {
        let timing = Timing {
            step_s: STEP_S,
            delay_ticks: 2,
            sensing,
        };
        Self {
            effects: SwitchedEffects::new(F::from_f64(SLEW_NM), &timing),
            check: InputCheck::new(&InputLimits::device(STEP_S), F::from_f64(STEP_S), F::ZERO),
            timing,
            settings: EffectSettings::default(),
            angle_rad,
            is_driven: true,
            ticks: 0,
            bounds: [Bounds::default(); SYMPTOMS],
            allowed_nm: [0.0; SYMPTOMS],
            shown_nm: [0.0; SYMPTOMS],
            earned_nm: [0.0; SYMPTOMS],
            was_elastic: [false; SYMPTOMS],
            was_active: [false; SYMPTOMS],
            is_paid: [false; SYMPTOMS],
            level_j: 0.0,
            highest_j: 0.0,
            tick_j: 0.0,
        }
    }

    /// Commits the settings, unless a device refuses them.
    fn commit(&mut self, settings: &EffectSettings) {
        if settings.check(None).is_err() {
            return;
        }
        let now = (&self.settings, &self.timing);
        let changes = settings
            .changes(&self.timing, now)
            .expect("settings that were checked");
        self.effects.change(&changes, F::from_f64(SLEW_NM));
        self.settings = *settings;
        for place in 0..SYMPTOMS {
            let bounds = Bounds::of(settings, place);
            self.bounds[place] = bounds;
            self.was_elastic[place] |= bounds.is_elastic;
            self.was_active[place] |= bounds.is_active;
            if bounds.is_on {
                self.is_paid[place] = bounds.is_active;
            }
        }
    }

    fn tick(&mut self, step: Option<&ShaftStep<f64>>) {
        self.ticks += 1;
        let sample = sample(step);
        let input = self.check.check(&sample);
        let travel_rad = match (&input, step) {
            (Checked::Missing(_), _) | (_, None) => 0.0,
            (_, Some(step)) => F::from_f64(step.delta_phi_rad).to_f64(),
        };
        self.angle_rad += travel_rad;
        let seen = ShaftEstimate {
            sample,
            omega_rad_s: F::ZERO,
            place: self.timing.sensing.position(self.angle_rad),
            is_driven: self.is_driven,
        };
        let mut shown = Shown::nothing();
        let mut words = Words::default();
        self.effects.tick(
            &seen,
            &input,
            &mut shown,
            &mut |spec: &'static EffectSpec, change: Change<F>| words.see(spec, &change),
        );
        let way = match input {
            Checked::Step(shaft) if shaft.delta_phi_rad != F::ZERO => Way::ShaftEstimate,
            // An angle that the velocities do not explain.
            Checked::Step(shaft) if shaft != ShaftStep::default() => Way::Guessed,
            Checked::Step(_) => Way::ShaftEstimate,
            Checked::Missing(_) => Way::Unseen,
            Checked::CatchUp(_) | Checked::Resume(_) => Way::Guessed,
        };
        self.torques(&shown, travel_rad, way);
    }

    fn torques(&mut self, shown: &Shown<F>, travel_rad: f64, way: Way) {
        // Over a gap the leg may have been anywhere.
        let moved_rad = if way == Way::Guessed {
            f64::INFINITY
        } else {
            travel_rad.abs()
        };
        let (mut work_j, mut sum_nm) = (0.0, 0.0);
        for (place, spec) in SPECS.iter().enumerate().take(SYMPTOMS) {
            let name = spec.name;
            let nm = shown.added.get(place).expect("a place").to_f64();
            let was_nm = self.shown_nm[place];
            let bound_nm = self.bounds[place].at(self.angle_rad);
            // What is exchanged falls with the slew limit, or stays where the law under it
            // grows.
            let falls_nm = if way == Way::Unseen { 0.0 } else { SLEW_NM };
            let fading_nm = if shown.settling { was_nm.abs() } else { 0.0 };
            // A new spring acts at once, beside what is left of an old limit.
            let spring_nm = self.bounds[place].spring_nm(self.angle_rad);
            let allowed_nm = bound_nm
                .max(self.allowed_nm[place] - falls_nm)
                .max(fading_nm);
            let rounding_nm = 1e-12_f64.max(64.0 * F::EPSILON.to_f64()) * (1.0 + allowed_nm);
            assert!(
                self.is_driven || nm == 0.0,
                "{name}: {nm} N·m of a motor that is not driven"
            );
            assert!(
                nm.is_finite() && nm.abs() <= allowed_nm + spring_nm + 2.0 * SLEW_NM + rounding_nm,
                "{name}: {nm} N·m, where {allowed_nm} are allowed"
            );
            let Bounds {
                stiffness, is_on, ..
            } = self.bounds[place];
            self.earned_nm[place] = if is_on {
                self.earned_nm[place] + stiffness * moved_rad
            } else {
                nm.abs()
            };
            let is_play = !self.was_active[place] && !self.was_elastic[place];
            if moved_rad == 0.0 && is_play {
                // Of two ends one may let go, and what fades besides it.
                let settles_nm = (was_nm.abs() + 2.0 * SLEW_NM).min(self.earned_nm[place]);
                assert!(
                    nm.abs() <= settles_nm.max(was_nm.abs()) + rounding_nm,
                    "{name} pushes a leg that rests: from {was_nm} to {nm} N·m"
                );
            }
            // One tank pays for all together: what one takes in, another may give.
            if self.is_paid[place] {
                work_j += was_nm * travel_rad;
            }
            self.allowed_nm[place] = allowed_nm;
            self.shown_nm[place] = nm;
            sum_nm += nm;
        }
        let torque_nm = shown.torque_nm.to_f64();
        assert!(
            (torque_nm - sum_nm).abs() <= 1e-5 * (1.0 + sum_nm.abs()),
            "{torque_nm} N·m of {sum_nm}"
        );
        self.level_j += work_j + TANK_REFILL_W * STEP_S;
        self.highest_j = self.highest_j.max(self.level_j);
        self.tick_j = self.tick_j.max(work_j.abs());
        let given_j = self.highest_j - self.level_j;
        // Torque answers two ticks late, and each may take more than is left.
        assert!(
            given_j <= TANK_J + 4.0 * self.tick_j + 1e-3,
            "{given_j} J out of a tank of {TANK_J} J"
        );
    }
}

/// The words of one tick.
#[derive(Default)]
struct Words {
    seen: Vec<(&'static str, f64)>,
    count: usize,
}

impl Words {
    fn see<F: Real>(&mut self, spec: &'static EffectSpec, change: &Change<F>) {
        let fraction = change.fraction.to_f64();
        // That a play has turned may be noticed a tick later.
        assert!(
            (-1.0..=1.0).contains(&fraction),
            "{}: {change:?}",
            spec.name
        );
        assert!(change.before_nm.is_finite() && change.after_nm.is_finite());
        let mut of = self.seen.iter().filter(|(name, _)| *name == spec.name);
        // After a commit one wall may be left and the other one met.
        if !change.word.is_of_play() && spec.name != "range-limit" {
            let last = of.next_back().map_or(0.0, |(_, fraction)| *fraction);
            assert!(
                fraction >= last - 1e-6,
                "{}: {change:?} after {last}",
                spec.name
            );
            self.seen.push((spec.name, fraction));
        }
        self.count += 1;
        assert!(self.count <= MOST_WORDS, "too many words");
    }
}
