//! The vibration actuator on a leg, with the stages of the drive in its loop.

use super::input::{ActuatorLoop, ActuatorRun, Input, Lost, Upset};
use super::observation::{ActuatorObservation, Observation};
use super::parameter_changes::SLEW_NM_PER_S;
use super::subject::Subject;
use crate::vibration::loop_gain::{self, CUFFS};
use crepitus_model::control::device_limits::LimitSettings;
use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::control::energy_observer::MOST_DELAY_TICKS;
use crepitus_model::parameters::Tabled;
use crepitus_model::render::effects::{SwitchedEffects, Timing};
use crepitus_model::render::input_check::{InputCheck, InputLimits};
use crepitus_model::render::limits::TorqueLimits;
use crepitus_model::render::position::{Position, Sensing};
use crepitus_model::render::{Pipeline, ShaftEstimate};
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{Crepitus, Real, Sample, SettingsError, StepCoefficients};
use crepitus_plant::encoder::Encoder;
use crepitus_plant::plant::Coil;
use crepitus_scene::scene::Precision;
use crepitus_scene::{Overrides, Scene, Walk};
use std::path::Path;

/// A firm hand on a nominal device.
pub(super) const NOMINAL: ActuatorRun = ActuatorRun {
    with: "",
    preset: "coarse",
    speed_rad_s: 0.5,
    keys: &[],
    backlash: false,
    upsets: &[],
    lost: Lost::NONE,
};

/// The stages of the drive.
type Stages<F> = Pipeline<
    F,
    InputCheck<F>,
    Option<Crepitus<F, ExactEvents>>,
    SwitchedEffects<F>,
    TorqueLimits<F>,
>;

/// Runs it; a scene that is refused is an overflow at 0 s.
pub(super) fn observe(
    subject: Subject,
    (input, run): (&Input, &ActuatorRun),
    late_s: f64,
) -> Observation {
    let seen = parsed(&run.scene(subject.precision, input.duration_s, input.step_s));
    let seen = seen.and_then(|scene| {
        match subject.precision {
            Precision::F32 => shake::<f32>((input, run), &scene, late_s),
            Precision::F64 => shake::<f64>((input, run), &scene, late_s),
        }
        .ok()
    });
    seen.unwrap_or_else(Observation::refused)
}

fn parsed(text: &str) -> Option<Scene> {
    Scene::parse(Path::new("shaken.toml"), text, &Overrides::default()).ok()
}

/// The largest gains of the loop over hands and cuffs; a scene that is refused is an
/// overflow at 0 s.
pub(super) fn observe_loop(linear: &ActuatorLoop) -> Observation {
    let Some(scene) = parsed(&NOMINAL.scene(Precision::F64, 2.0, 5e-5)) else {
        return Observation::refused();
    };
    let mut seen = Observation::default();
    let whole = &mut seen.actuator.whole;
    whole.ticks = 1.0;
    for hand in linear.hands {
        for cuff in CUFFS {
            let margin = loop_gain::margin(&scene, hand, cuff, linear.late_ticks);
            whole.loop_gain = whole.loop_gain.max(margin.largest);
            whole.loop_in_phase = whole.loop_in_phase.max(1.0 / margin.stable_to);
        }
    }
    seen
}

fn stages<F: Real>(scene: &Scene, timing: &Timing) -> Result<Stages<F>, SettingsError> {
    let step_s = timing.step_s;
    let slew_nm = F::from_f64(SLEW_NM_PER_S * step_s);
    let encoder = EncoderSettings::default();
    let joint = match &scene.crepitus {
        Some(crepitus) => Some(Crepitus::new(
            StepCoefficients::new(&crepitus.settings, step_s)?,
            InputLimits::device(step_s),
            F::from_f64(encoder.rad_per_count()),
            F::ZERO,
        )),
        None => None,
    };
    let mut effects = SwitchedEffects::new(slew_nm, timing);
    let changes = scene.effect_settings().changes_from_none(timing)?;
    effects.change(&changes, slew_nm);
    Ok(Pipeline::new(
        InputCheck::new(&InputLimits::device(step_s), F::from_f64(step_s), F::ZERO),
        joint,
        effects,
        TorqueLimits::armed(F::from_f64(LimitSettings::defaults().torque_nm), slew_nm),
    ))
}

fn shake<F: Real>(
    (input, run): (&Input, &ActuatorRun),
    scene: &Scene,
    late_s: f64,
) -> Result<Observation, SettingsError> {
    let (step_s, encoder_settings) = (input.step_s, EncoderSettings::default());
    let timing = Timing {
        step_s,
        delay_ticks: MOST_DELAY_TICKS,
        sensing: Sensing::of_encoder(&encoder_settings),
    };
    let mut stages = stages::<F>(scene, &timing)?;
    let mut settings = scene.effect_settings();
    let mut plant = scene.assemble()?;
    let mut walk = Walk::new(&scene.motion, step_s);
    let encoder = Encoder::new(&encoder_settings);
    let first = encoder.count(plant.shaft().angle_rad);
    let omega = F::from_f64(plant.shaft().omega_rad_s);
    let mut reader = EncoderReader::<F>::new(&encoder_settings, step_s, first, omega)?;
    let names = plant.columns();
    let place = |name: &str| names.iter().position(|column| *column == name);
    let places = ["shell_acceleration_m_s2", "excursion_m", "coil_current_a"].map(place);
    let mut seen = Observation::of_steps(step_s);
    let mut row = Vec::new();
    let (mut is_armed, mut coil_v) = (true, 0.0);
    let mut done = 0;
    let mut count = first;
    for n in 1..=input.steps().whole() {
        let now_s = walk.time_s();
        while let Some((_, upset)) = run.upsets.get(done).filter(|(at_s, _)| *at_s <= now_s) {
            done += 1;
            match upset {
                Upset::LetsGo => plant.release(),
                Upset::Disarmed => is_armed = false,
                Upset::Speed(_) => {}
                Upset::Gain(gain) => {
                    let mut next = settings;
                    if let Some(actuator) = &mut next.vibration_actuator {
                        actuator.gain = *gain;
                    }
                    next.check(None)?;
                    let changes = next.changes(&timing, (&settings, &timing))?;
                    let slew_nm = F::from_f64(SLEW_NM_PER_S * step_s);
                    stages.effects.change(&changes, slew_nm);
                    settings = next;
                }
            }
        }
        let sample = if run.lost.takes(n, step_s) {
            reader.miss();
            Sample::Lost
        } else {
            count = encoder.count(plant.shaft().angle_rad);
            Sample::Taken(reader.read(count))
        };
        stages.limits.set_energised(is_armed);
        let shown = stages.tick(
            &ShaftEstimate {
                sample,
                omega_rad_s: reader.omega_rad_s(),
                place: Position::at(count),
                is_driven: is_armed,
            },
            |_| {},
        );
        plant.command(shown.torque_nm.to_f64(), coil_v);
        if !is_armed {
            plant.set_coil(Coil::Open);
        }
        let last_v = std::mem::replace(&mut coil_v, shown.coil_v.to_f64());
        walk.advance(&mut plant);
        row.clear();
        plant.write(&mut row);
        let values = places.map(|place| place.and_then(|place| row.get(place)).copied());
        let torque_nm = shown.torque_nm.to_f64();
        // A criterion of what is not there would hold of nothing.
        let is_complete = values.iter().all(Option::is_some);
        if !(is_complete && torque_nm.is_finite() && plant.shaft().angle_rad.is_finite()) {
            seen.overflow_s.get_or_insert(now_s);
            break;
        }
        seen.steps += 1;
        seen.add_torque::<F>(torque_nm);
        let shaft_rad_s = plant.shaft().omega_rad_s;
        let [m_s2, excursion_m, current_a] = values.map(|value| value.unwrap_or(0.0));
        let ActuatorObservation { whole, late } = &mut seen.actuator;
        let late = Some(late).filter(|_| now_s >= late_s);
        for part in [whole].into_iter().chain(late) {
            part.ticks += 1.0;
            part.acceleration_squares += m_s2 * m_s2;
            part.current_squares += current_a * current_a;
            part.excursion_m = part.excursion_m.max(excursion_m.abs());
            part.volts = part.volts.max(coil_v.abs());
            part.volts_a_tick = part.volts_a_tick.max((coil_v - last_v).abs());
            part.shaft_rad_s = part.shaft_rad_s.max(shaft_rad_s.abs());
        }
    }
    Ok(seen)
}
