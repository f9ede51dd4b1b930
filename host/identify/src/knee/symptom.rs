//! Symptoms as models of a measured torque: the laws of `crepitus_model`, followed along the measured motion.
//!
//! A law is given torques of the order of 1 N·m, within the ranges of its parameters, and an amplitude
//! multiplies what it answers: a person's knee may be stronger than what a device can show.

use super::motion::{Motion, travel};
use crepitus_model::parameters::ParameterSpec;
use crepitus_model::render::effects::clasp_knife::{ClaspKnife, ClaspKnifeSettings};
use crepitus_model::render::effects::clonus::{Clonus, ClonusSettings};
use crepitus_model::render::effects::cogwheel::{Cogwheel, CogwheelSettings};
use crepitus_model::render::effects::lead_pipe::{LeadPipe, LeadPipeSettings};
use crepitus_model::render::effects::range_limit::{RangeLimit, RangeLimitSettings};
use crepitus_model::render::effects::spasticity::{Spasticity, SpasticitySettings};
use crepitus_model::render::effects::symptom::Law;
use crepitus_model::render::effects::{SPECS, Timing};
use crepitus_model::render::position::Sensing;

crepitus_model::named! {
    /// A symptom, or none.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Symptom {
        /// A limb with the dry friction that every joint and apparatus has.
        Healthy => "no symptom",
        /// Lead-pipe rigidity.
        LeadPipe => "lead-pipe rigidity",
        /// Cogwheel rigidity.
        Cogwheel => "cogwheel rigidity",
        /// Spasticity as a catch and a release.
        Catch => "spasticity (catch)",
        /// Spasticity as a delayed reflex.
        Reflex => "spasticity (reflex)",
        /// The clasp-knife phenomenon.
        ClaspKnife => "clasp-knife",
        /// Clonus.
        Clonus => "clonus",
        /// An end of the range that comes early.
        RangeLimit => "range limit",
    }
}

/// A parameter of a law that changes the form of its torque.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// Whether the torque changes smoothly with it: what does not is searched, and stated without an interval.
    pub(crate) is_smooth: bool,
}

const fn smooth(low: f64, high: f64) -> Shape {
    Shape {
        low,
        high,
        is_smooth: true,
    }
}

const fn stepped(low: f64, high: f64) -> Shape {
    Shape {
        low,
        high,
        is_smooth: false,
    }
}

/// A value of a fitted law: its key in a scene, and how it follows from shape and amplitudes.
pub(crate) type Keyed = (&'static str, f64);

/// Depth of an end of the range at which its torque is normalised to 1 N·m, rad.
const DEPTH_RAD: f64 = 0.3;

/// Delay and activation of a reflex, s: the least shift of its threshold is their sum.
const ACTIVATION_S: f64 = 0.01;

/// Way on after the collapse of a clasp-knife by which it is told from an end of the range, deg.
const COLLAPSE_DEG: f64 = 5.0;

/// Phases of a ratchet that are tried.
pub(crate) const PHASES: usize = 8;

impl Symptom {
    /// Name of its effect in a scene; `None` without a symptom.
    pub fn effect(self) -> Option<&'static str> {
        match self {
            Self::Healthy => None,
            Self::LeadPipe => Some("lead-pipe"),
            Self::Cogwheel => Some("cogwheel"),
            Self::Catch | Self::Reflex => Some("spasticity"),
            Self::ClaspKnife => Some("clasp-knife"),
            Self::Clonus => Some("clonus"),
            Self::RangeLimit => Some("range-limit"),
        }
    }

    /// Choices of the effect besides the muscles.
    pub fn choice(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Catch => Some(("form", "catch")),
            Self::Reflex => Some(("form", "reflex")),
            _ => None,
        }
    }

    /// Whether it is of one group of muscles.
    pub(crate) fn is_muscular(self) -> bool {
        matches!(
            self,
            Self::Catch | Self::Reflex | Self::ClaspKnife | Self::Clonus
        )
    }

    /// Whether its law has the dry friction of the limb in it.
    pub(crate) fn is_rigidity(self) -> bool {
        matches!(self, Self::LeadPipe | Self::Cogwheel)
    }

    /// Speed of the fastest stretch below which it need not show, deg/s.
    pub(crate) fn needed_deg_s(self) -> f64 {
        match self {
            Self::Catch | Self::Reflex => 90.0,
            Self::Clonus => 120.0,
            _ => 0.0,
        }
    }

    /// Whether a shape shows in a motion between these angles, deg: a clasp-knife collapses before the end.
    pub(crate) fn shows(self, p: &[f64], is_flexor: bool, (low, high): (f64, f64)) -> bool {
        let (Self::ClaspKnife, [onset, span, ..]) = (self, p) else {
            return true;
        };
        let released = released(*onset, *span, is_flexor);
        (low + COLLAPSE_DEG..=high - COLLAPSE_DEG).contains(&released)
    }

    /// Parameters of its shape.
    pub(crate) fn shape(self) -> &'static [Shape] {
        match self {
            Self::Healthy => &[],
            Self::LeadPipe => &[const { smooth(0.3, 8.0) }],
            Self::Cogwheel => &[
                const { smooth(3.5, 11.0) },
                const { smooth(0.0, 0.9) },
                const { smooth(0.3, 6.0) },
            ],
            Self::Catch => &[
                const { smooth(20.0, 130.0) },
                const { smooth(0.05, 0.45) },
                const { smooth(0.0, 1.0) },
                const { smooth(0.0, 5.0) },
                const { smooth(0.02, 0.5) },
                const { stepped(20.0, 100.0) },
                const { smooth(20.0, 250.0) },
            ],
            // The second is what is left of the shift after delay and activation: an answer that begins at one angle
            // whatever the speed is an end of the range.
            Self::Reflex => &[
                const { smooth(20.0, 130.0) },
                const { smooth(0.04, 0.4) },
                const { smooth(0.02, 0.095) },
            ],
            Self::ClaspKnife => &[
                const { smooth(10.0, 90.0) },
                const { smooth(8.0, 80.0) },
                const { smooth(0.02, 0.8) },
                const { smooth(0.0, 0.7) },
                const { smooth(0.01, 0.15) },
                const { smooth(8.0, 80.0) },
            ],
            Self::Clonus => &[
                const { smooth(3.5, 9.0) },
                const { smooth(0.25, 0.75) },
                const { smooth(0.0, 0.8) },
                const { smooth(20.0, 110.0) },
                const { smooth(0.01, 0.15) },
                const { stepped(40.0, 250.0) },
                const { stepped(2.0, 60.0) },
            ],
            Self::RangeLimit => &[
                const { smooth(0.0, 60.0) },
                const { smooth(0.0, 1.0) },
                const { smooth(50.0, 140.0) },
                const { smooth(0.0, 1.0) },
                const { smooth(0.0, 0.7) },
                const { smooth(0.2, 6.5) },
            ],
        }
    }

    /// Torques of its law along a motion, N·m at an amplitude of 1; several where their amplitudes are free.
    /// `phase` is that of a ratchet, in teeth.
    pub(crate) fn signals(
        self,
        p: &[f64],
        is_flexor: bool,
        motion: &Motion,
        phase: f64,
    ) -> Option<Vec<Vec<f64>>> {
        let muscles = u8::from(is_flexor);
        let one = |signal: Option<Vec<f64>>| signal.map(|signal| vec![signal]);
        match (self, p) {
            (Self::Healthy, _) => Some(Vec::new()),
            (Self::LeadPipe, [delta]) => one(Some(play(motion, *delta))),
            (Self::Cogwheel, [frequency, low, delta]) => one(followed::<Cogwheel<f64>>(
                &CogwheelSettings {
                    torque_nm: 1.0,
                    frequency_hz: *frequency,
                    low_share: *low,
                    presliding_deg: *delta,
                    ..CogwheelSettings::default()
                },
                motion,
                phase / frequency,
            )),
            (
                Self::Catch,
                [
                    threshold,
                    shift,
                    residual,
                    stiffness,
                    release,
                    speed,
                    build_up,
                ],
            ) => one(followed::<Spasticity<f64>>(
                &SpasticitySettings {
                    form: 0,
                    muscles,
                    threshold_deg: *threshold,
                    velocity_shift_s: *shift,
                    torque_nm: 6.5,
                    threshold_velocity_deg_s: *speed,
                    velocity_torque_nms_per_rad: 1.0,
                    residual_share: *residual,
                    stiffness_nm_per_rad: *stiffness,
                    release_s: *release,
                    catch_stiffness_nm_per_rad: *build_up,
                    ..SpasticitySettings::default()
                },
                motion,
                0.0,
            )),
            (Self::Reflex, [threshold, lead, delay]) => one(followed::<Spasticity<f64>>(
                &SpasticitySettings {
                    form: 1,
                    muscles,
                    threshold_deg: *threshold,
                    velocity_shift_s: lead + delay + ACTIVATION_S,
                    torque_nm: 6.5,
                    gain_nm_per_rad: 1.0,
                    delay_s: *delay,
                    activation_s: ACTIVATION_S,
                    ..SpasticitySettings::default()
                },
                motion,
                0.0,
            )),
            (Self::ClaspKnife, [onset, span, first, residual, collapse, build_up]) => {
                one(followed::<ClaspKnife<f64>>(
                    &ClaspKnifeSettings {
                        muscles,
                        onset_deg: *onset,
                        release_deg: released(*onset, *span, is_flexor),
                        onset_torque_nm: *first,
                        slope_nm_per_rad: (1.0 - first) / travel_rad(*onset, *span, is_flexor),
                        residual_share: *residual,
                        collapse_s: *collapse,
                        catch_stiffness_nm_per_rad: *build_up,
                        ..ClaspKnifeSettings::default()
                    },
                    motion,
                    0.0,
                ))
            }
            (Self::Clonus, [frequency, push, first, hold, delay, speed, beats]) => {
                one(followed::<Clonus<f64>>(
                    &ClonusSettings {
                        muscles,
                        frequency_hz: *frequency,
                        push_share: *push,
                        first_stretch: *first,
                        amplitude_nm: 1.0,
                        hold_deg: *hold,
                        start_velocity_deg_s: *speed,
                        delay_s: *delay,
                        beats: beats.round(),
                        ..ClonusSettings::default()
                    },
                    motion,
                    0.0,
                ))
            }
            (Self::RangeLimit, [..]) => ends(p, motion),
            _ => None,
        }
    }

    /// Values of the law by their keys in a scene.
    pub(crate) fn values(self, p: &[f64], amplitudes: &[f64], is_flexor: bool) -> Vec<Keyed> {
        match (self, p, amplitudes) {
            (Self::LeadPipe, [delta], [a]) => vec![("torque_nm", *a), ("presliding_deg", *delta)],
            (Self::Cogwheel, [frequency, low, delta], [a]) => vec![
                ("torque_nm", *a),
                ("low_share", *low),
                ("frequency_hz", *frequency),
                ("presliding_deg", *delta),
            ],
            (
                Self::Catch,
                [
                    threshold,
                    shift,
                    residual,
                    stiffness,
                    release,
                    speed,
                    build_up,
                ],
                [a],
            ) => vec![
                ("threshold_deg", *threshold),
                ("velocity_shift_s", *shift),
                ("velocity_torque_nms_per_rad", *a),
                ("residual_share", *residual),
                ("stiffness_nm_per_rad", stiffness * a),
                ("release_s", *release),
                ("threshold_velocity_deg_s", *speed),
                ("catch_stiffness_nm_per_rad", build_up * a),
            ],
            (Self::Reflex, [threshold, lead, delay], [a]) => vec![
                ("threshold_deg", *threshold),
                ("velocity_shift_s", lead + delay + ACTIVATION_S),
                ("gain_nm_per_rad", *a),
                ("delay_s", *delay),
            ],
            (Self::ClaspKnife, [onset, span, first, residual, collapse, build_up], [a]) => vec![
                ("onset_deg", *onset),
                ("release_deg", released(*onset, *span, is_flexor)),
                ("onset_torque_nm", first * a),
                (
                    "slope_nm_per_rad",
                    (1.0 - first) * a / travel_rad(*onset, *span, is_flexor),
                ),
                ("residual_share", *residual),
                ("collapse_s", *collapse),
                ("catch_stiffness_nm_per_rad", build_up * a),
            ],
            (Self::Clonus, [frequency, push, first, hold, delay, speed, beats], [a]) => vec![
                ("frequency_hz", *frequency),
                ("push_share", *push),
                ("first_stretch", *first),
                ("amplitude_nm", *a),
                ("hold_deg", *hold),
                ("start_velocity_deg_s", *speed),
                ("delay_s", *delay),
                ("beats", beats.round()),
            ],
            (
                Self::RangeLimit,
                [extension, extension_bend, flexion, flexion_bend, loss, cap],
                [e, f],
            ) => {
                let mut values = Vec::new();
                if *e > 0.0 {
                    let [k, bend] = wall(*extension_bend);
                    values.push(("extension_limit_deg", *extension));
                    values.push(("extension_stiffness_nm_per_rad", e * k));
                    values.push(("extension_stiffening_nm_per_rad2", e * bend));
                    values.push(("extension_loss", *loss));
                    values.push(("extension_torque_nm", e * cap));
                }
                if *f > 0.0 {
                    let [k, bend] = wall(*flexion_bend);
                    values.push(("flexion_limit_deg", *flexion));
                    values.push(("flexion_stiffness_nm_per_rad", f * k));
                    values.push(("flexion_stiffening_nm_per_rad2", f * bend));
                    values.push(("flexion_loss", *loss));
                    values.push(("flexion_torque_nm", f * cap));
                }
                values
            }
            _ => Vec::new(),
        }
    }
}

/// Torques of the ends of the range in extension and in flexion.
fn ends(p: &[f64], motion: &Motion) -> Option<Vec<Vec<f64>>> {
    let [extension, extension_bend, flexion, flexion_bend, loss, cap] = p else {
        return None;
    };
    let free = RangeLimitSettings {
        extension_limit_deg: -10.0,
        flexion_limit_deg: 160.0,
        extension_torque_nm: *cap,
        flexion_torque_nm: *cap,
        extension_loss: *loss,
        flexion_loss: *loss,
        ..RangeLimitSettings::default()
    };
    let [k, bend] = wall(*extension_bend);
    let extended = RangeLimitSettings {
        extension_limit_deg: *extension,
        extension_stiffness_nm_per_rad: k,
        extension_stiffening_nm_per_rad2: bend,
        ..free
    };
    let [k, bend] = wall(*flexion_bend);
    let flexed = RangeLimitSettings {
        flexion_limit_deg: *flexion,
        flexion_stiffness_nm_per_rad: k,
        flexion_stiffening_nm_per_rad2: bend,
        ..free
    };
    Some(vec![
        followed::<RangeLimit<f64>>(&extended, motion, 0.0)?,
        followed::<RangeLimit<f64>>(&flexed, motion, 0.0)?,
    ])
}

/// Angle at which a clasp-knife collapses, deg.
fn released(onset_deg: f64, span_deg: f64, is_flexor: bool) -> f64 {
    let sense = if is_flexor { -1.0 } else { 1.0 };
    (onset_deg + sense * span_deg).clamp(0.0, 150.0)
}

/// Travel from its onset to its collapse, rad.
fn travel_rad(onset_deg: f64, span_deg: f64, is_flexor: bool) -> f64 {
    (released(onset_deg, span_deg, is_flexor) - onset_deg)
        .abs()
        .max(1.0)
        .to_radians()
}

/// Stiffness and stiffening of an end that has 1 N·m at a depth, by the share of the stiffening.
fn wall(bend: f64) -> [f64; 2] {
    [
        1.0 + (1.0 / DEPTH_RAD - 1.0) * (1.0 - bend),
        bend / (DEPTH_RAD * DEPTH_RAD),
    ]
}

/// Torque of a play of 1 N·m with this travel, deg: dry friction.
pub(crate) fn play(motion: &Motion, presliding_deg: f64) -> Vec<f64> {
    let settings = LeadPipeSettings {
        torque_nm: 1.0,
        presliding_deg,
        ..LeadPipeSettings::default()
    };
    followed::<LeadPipe<f64>>(&settings, motion, 0.0).unwrap_or_else(|| vec![0.0; motion.len()])
}

/// Follows a law along a motion, after it has waited at rest; `None` for settings that it cannot have.
fn followed<L: Law<Real = f64>>(
    settings: &L::Settings,
    motion: &Motion,
    wait_s: f64,
) -> Option<Vec<f64>> {
    let timing = Timing {
        step_s: motion.step_s,
        delay_ticks: 0,
        sensing: Sensing::IDEAL,
    };
    let mut law = L::new(L::coefficients(settings, &timing).ok()?);
    let first = *motion.angle_rad.first()?;
    law.rest(&Sensing::IDEAL.position(first));
    let waiting = travel(&[first, first], &[0.0, 0.0], motion.step_s);
    let mut waited_s = 0.0;
    while waited_s < wait_s {
        law.follow(&waiting, &mut ());
        waited_s += motion.step_s;
    }
    let mut torques = Vec::with_capacity(motion.len());
    torques.push(0.0);
    torques.extend((motion.travels.iter()).map(|travel| law.follow(travel, &mut ())));
    Some(torques)
}

/// Allowance for what a law has otherwise than a knee, half width of a 95 % interval: as a share of the value, and
/// absolute, by the unit in the key. From patients of another model, other ones than those of the test.
pub(crate) fn allowance(key: &str) -> (f64, f64) {
    match key {
        key if key.ends_with("_deg") => (0.0, 1.0),
        key if key.ends_with("_hz") => (0.01, 0.0),
        key if key.ends_with("_s") => (0.1, 0.004),
        key if key.ends_with("_nm") || key.contains("_nm") => (0.1, 0.0),
        _ => (0.0, 0.08),
    }
}

/// Row of an effect's table: unit and range of a key.
pub(crate) fn spec(effect: &str, key: &str) -> Option<&'static ParameterSpec> {
    let effect = SPECS.iter().find(|spec| spec.name == effect)?;
    effect.parameters.iter().find(|spec| spec.key == key)
}
