//! What a change of stiffness does to a wound spring: without a thought it
//! injects energy from nowhere; committed and ramped it injects none.

use super::{Mark, Panel, Scale, Series, Story};
use crate::sampling::Sampling;
use crate::stability::parameter_changes::SLEW_NM_PER_S;
use crepitus_model::joint::oscillator::Oscillator;
use crepitus_model::render::ramp::Ramp;
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{
    Frozen, Parameters, Settings, SettingsError, ShaftStep, StepCoefficients, StickSlip, Validated,
};
use crepitus_plant::Motion;

/// The device's tick, s.
const STEP_S: f64 = 5e-5;
/// Speed of the shaft, rad/s.
const OMEGA_RAD_S: f64 = 1.0;
/// When the spring is made forty times stiffer, and when soft again, s.
const STIFFER_S: f64 = 0.039;
const SOFTER_S: f64 = 0.09;
/// How long the run is, s.
const SHOWN_S: f64 = 0.13;
/// The smallest energy that is drawn, J.
const LEAST_J: f64 = 3e-4;

const COMMITTED: &str = "committed and ramped";
const NAIVE: &str = "replaced as they are";

/// Lines against time, s.
#[derive(Default)]
struct Lines {
    torque_nm: Vec<(f64, f64)>,
    stored_j: Vec<(f64, f64)>,
}

impl Lines {
    fn add(&mut self, time_s: f64, torque_nm: f64, stored_j: f64) {
        self.torque_nm.push((time_s, torque_nm));
        self.stored_j.push((time_s, stored_j.max(LEAST_J)));
    }
}

/// See the module.
pub(super) fn parameter_change() -> Result<Story, SettingsError> {
    let stiff = Parameters::default();
    let soft = Parameters {
        stiffness_nm_per_rad: 10.0,
        ..stiff
    };
    let committed = committed(&valid(soft)?, &valid(stiff)?)?;
    let naive = naive(&soft, &stiff)?;
    let at_change = |lines: &[(f64, f64)], after_s: f64| {
        let next = lines.iter().find(|(t, _)| *t > after_s);
        next.map_or(0.0, |(_, y)| *y)
    };
    // Just before and just after, whatever rounding makes of the time.
    let (before_s, after_s) = (STIFFER_S - 1.5 * STEP_S, STIFFER_S + 0.5 * STEP_S);
    let before_j = at_change(&committed.stored_j, before_s);
    let time = || Scale::linear("Time (s)").within(0.0, SHOWN_S);
    // Named in the first panel, where there is room.
    let marks = |names: [&str; 2]| {
        vec![
            Mark::new(STIFFER_S, names[0]),
            Mark::new(SOFTER_S, names[1]),
        ]
    };
    Ok(Story {
        name: "parameter-change",
        title: "A stiffer spring, and no energy from nowhere",
        caption: format!(
            "A hand has wound a spring of 10 N·m/rad to {:.2} N·m when its stiffness is set to 400 N·m/rad. Replaced as \
             it is, spring and object hold {:.2} J instead of {:.1} mJ, show {:.1} N·m for a moment, and go on swinging. \
             Committed as the device does it, θ is scaled so that the torque goes on and the energy falls to {:.1} mJ. \
             Back to the soft spring the torque may only fall at {SLEW_NM_PER_S} N·m/s, so the stiffness takes its time.",
            at_change(&committed.torque_nm, before_s),
            at_change(&naive.stored_j, after_s),
            before_j * 1e3,
            at_change(&naive.torque_nm, after_s),
            at_change(&committed.stored_j, after_s) * 1e3,
        ),
        panels: vec![
            Panel {
                heading: "Torque (without a limit, to show what would be asked for)".to_owned(),
                x: time(),
                y: Scale::linear("Torque (N·m)").within(-1.0, 17.0),
                series: vec![
                    Series::line(NAIVE, naive.torque_nm),
                    Series::line(COMMITTED, committed.torque_nm.clone()),
                ],
                levels: Vec::new(),
                bounds: marks(["kr 10 → 400", "kr 400 → 10"]),
            },
            Panel {
                heading: "The same, near Ts and Tk".to_owned(),
                x: time(),
                y: Scale::linear("Torque (N·m)").within(-0.05, 0.45),
                series: vec![Series::line(COMMITTED, committed.torque_nm)],
                levels: vec![
                    Mark::new(stiff.static_torque_nm, "Ts"),
                    Mark::new(stiff.kinetic_torque_nm, "Tk"),
                ],
                bounds: marks(["", ""]),
            },
            Panel {
                heading: "Energy of spring and object".to_owned(),
                x: time(),
                y: Scale {
                    logarithmic: true,
                    ..Scale::linear("Energy (J)").within(LEAST_J, 1.0)
                },
                series: vec![
                    Series::line(NAIVE, naive.stored_j),
                    Series::line(COMMITTED, committed.stored_j),
                ],
                levels: Vec::new(),
                bounds: marks(["", ""]),
            },
        ],
    })
}

fn valid(parameters: Parameters) -> Result<Validated<Settings>, SettingsError> {
    Settings {
        parameters,
        ..Settings::default()
    }
    .validate()
}

/// Energy of spring and motion, J.
fn energy_j(a: &StepCoefficients<f64>, theta: f64, theta_dot: f64) -> f64 {
    0.5 * a.stiffness * theta * theta + 0.5 * a.inertia * theta_dot * theta_dot
}

/// The real joint, with the device's commits.
fn committed(
    soft: &Validated<Settings>,
    stiff: &Validated<Settings>,
) -> Result<Lines, SettingsError> {
    let (soft, stiff) = (
        StepCoefficients::new(soft, STEP_S)?,
        StepCoefficients::new(stiff, STEP_S)?,
    );
    let motion = Motion::constant(OMEGA_RAD_S);
    let sampling = Sampling::new(&motion, SHOWN_S, STEP_S);
    let mut joint = Frozen::<f64, ExactEvents>::new(soft, OMEGA_RAD_S);
    let mut ramp = Ramp::at(soft);
    let mut lines = Lines::default();
    let mut walk = sampling.walk_from(0);
    let mut chunk: Vec<ShaftStep<f64>> = Vec::new();
    for n in 0..sampling.steps() {
        walk.fill(&mut chunk, 1);
        let now_s = sampling.time_s(n, 0.0);
        let due = |at_s: f64| (now_s - at_s).abs() < 0.5 * STEP_S;
        if due(STIFFER_S) {
            ramp = Ramp::new(*joint.coefficients(), stiff, SLEW_NM_PER_S);
        } else if due(SOFTER_S) {
            ramp = Ramp::new(*joint.coefficients(), soft, SLEW_NM_PER_S);
        }
        if let Some(next) = ramp.advance() {
            joint.adjust(next);
        }
        for shaft in &chunk {
            joint.step(shaft, |_| {});
        }
        lines.add(
            sampling.time_s(n + 1, 0.0),
            joint.torque_nm(),
            energy_j(
                joint.coefficients(),
                joint.theta_rad(),
                joint.theta_dot_rad_s(),
            ),
        );
    }
    Ok(lines)
}

/// What the equations say if the numbers are replaced and the state is not
/// looked at: the stick's angle goes on, and the far too strong spring swings.
fn naive(soft: &Parameters, stiff: &Parameters) -> Result<Lines, SettingsError> {
    let swing = Oscillator::<f64>::of(stiff).transition(STEP_S);
    let soft: StepCoefficients<f64> = StepCoefficients::new(&valid(*soft)?, STEP_S)?;
    let stiff = StepCoefficients::new(&valid(*stiff)?, STEP_S)?;
    let mut lines = Lines::default();
    let mut time_s = 0.0;
    while time_s < STIFFER_S - 0.5 * STEP_S {
        time_s += STEP_S;
        let theta = OMEGA_RAD_S * time_s;
        let energy = energy_j(&soft, theta, OMEGA_RAD_S);
        lines.add(time_s, soft.stiffness * theta, energy);
    }
    let theta = OMEGA_RAD_S * time_s;
    let (mut x, mut v) = (theta - stiff.kinetic_angle_rad, OMEGA_RAD_S);
    time_s += STEP_S;
    let energy = energy_j(&stiff, theta, v);
    lines.add(time_s, stiff.stiffness * theta, energy);
    while time_s < SOFTER_S {
        time_s += STEP_S;
        (x, v) = swing.apply(x, v);
        let energy = energy_j(&stiff, x + stiff.kinetic_angle_rad, v);
        lines.add(time_s, stiff.kinetic_nm, energy);
    }
    Ok(lines)
}
