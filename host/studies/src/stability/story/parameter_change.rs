//! Effect of a change of stiffness on a wound spring: without a thought it
//! injects energy from nowhere; committed and ramped it injects none.

use super::{Line, STEP_S, levels};
use crate::sampling::Sampling;
use crate::stability::parameter_changes::SLEW_NM_PER_S;
use crate::story::{PanelData, Scale, Series, Story, mark};
use crepitus_model::joint::oscillator::Oscillator;
use crepitus_model::render::ramp::Ramp;
use crepitus_model::solver::locate::ExactEvents;
use crepitus_model::{
    Frozen, Parameters, Settings, SettingsError, ShaftStep, StepCoefficients, StickSlip,
};
use crepitus_plant::Motion;

/// Speed of the shaft, rad/s.
const OMEGA_RAD_S: f64 = 1.0;
/// Time at which the spring is made forty times stiffer, and time at which it is made soft again, s.
const STIFFER_S: f64 = 0.039;
const SOFTER_S: f64 = 0.09;
/// Duration of the run, s.
const SHOWN_S: f64 = 0.13;
/// The smallest energy that is drawn, J.
const LEAST_J: f64 = 3e-4;

const COMMITTED: &str = "committed and ramped";
const NAIVE: &str = "replaced as they are";

/// One way to do it; against time, s.
#[derive(Default)]
struct Change {
    /// Torque, N·m.
    torque_nm: Line,
    /// Energy of spring and object, J.
    stored_j: Line,
}

impl Change {
    fn add(&mut self, time_s: f64, torque_nm: f64, stored_j: f64) {
        self.torque_nm.push((time_s, torque_nm));
        self.stored_j.push((time_s, stored_j));
    }
}

/// The paper's joint with this stiffness, N·m/rad.
fn coefficients(stiffness_nm_per_rad: f64) -> Result<StepCoefficients<f64>, SettingsError> {
    let settings = Settings {
        parameters: Parameters {
            stiffness_nm_per_rad,
            ..Parameters::default()
        },
        ..Settings::default()
    };
    StepCoefficients::new(&settings.validate()?, STEP_S)
}

/// Energy of spring and motion, J.
fn energy_j(a: &StepCoefficients<f64>, theta: f64, theta_dot: f64) -> f64 {
    0.5 * a.stiffness * theta * theta + 0.5 * a.inertia * theta_dot * theta_dot
}

/// The real joint, with the device's commits.
fn committed(soft: StepCoefficients<f64>, stiff: StepCoefficients<f64>) -> Change {
    let motion = Motion::constant(OMEGA_RAD_S);
    let sampling = Sampling::new(&motion, SHOWN_S, STEP_S);
    let mut joint = Frozen::<f64, ExactEvents>::new(soft, OMEGA_RAD_S);
    let mut ramp = Ramp::at(soft);
    let mut lines = Change::default();
    let mut walk = sampling.walk_from(0);
    let mut chunk: Vec<ShaftStep<f64>> = Vec::new();
    for n in 0..sampling.steps() {
        walk.fill(&mut chunk, 1);
        let now_s = sampling.time_s(n, 0.0);
        for (at_s, next) in [(STIFFER_S, stiff), (SOFTER_S, soft)] {
            if (now_s - at_s).abs() < 0.5 * STEP_S {
                ramp = Ramp::new(*joint.coefficients(), next, SLEW_NM_PER_S);
            }
        }
        if let Some(next) = ramp.advance() {
            joint.adjust(next);
        }
        for shaft in &chunk {
            joint.step(shaft, |_| {});
        }
        let (theta, v) = (joint.theta_rad(), joint.theta_dot_rad_s());
        let stored_j = energy_j(joint.coefficients(), theta, v);
        lines.add(sampling.time_s(n + 1, 0.0), joint.torque_nm(), stored_j);
    }
    lines
}

/// Solution of the equations if the numbers are replaced and the state is not
/// looked at: the stick's angle goes on, and the far too strong spring swings.
fn naive(soft: StepCoefficients<f64>, stiff: StepCoefficients<f64>) -> Change {
    let swing = Oscillator::<f64>::of(&Parameters::default()).transition(STEP_S);
    let mut lines = Change::default();
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
    lines
}

/// See the module.
pub(super) fn story() -> Result<Story, SettingsError> {
    let soft = coefficients(10.0)?;
    let stiff = coefficients(Parameters::default().stiffness_nm_per_rad)?;
    let (committed, naive) = (committed(soft, stiff), naive(soft, stiff));
    let at_change = |lines: &[(f64, f64)], after_s: f64| {
        let next = lines.iter().find(|(t, _)| *t > after_s);
        next.map_or(0.0, |(_, y)| *y)
    };
    // Just before and just after, whatever rounding makes of the time.
    let (before_s, after_s) = (STIFFER_S - 1.5 * STEP_S, STIFFER_S + 0.5 * STEP_S);
    let time = || Scale::linear("Time (s)").within(0.0, SHOWN_S);
    // Named in the first panel, where there is room.
    let marks = |names: [&str; 2]| vec![mark(STIFFER_S, names[0]), mark(SOFTER_S, names[1])];
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
            at_change(&committed.stored_j, before_s) * 1e3,
            at_change(&naive.torque_nm, after_s),
            at_change(&committed.stored_j, after_s) * 1e3,
        ),
        panels: vec![
            PanelData {
                heading: "Torque asked for, without a limit".to_owned(),
                x: time(),
                y: Scale::linear("Torque (N·m)").within(-1.0, 17.0),
                series: vec![
                    Series::line(NAIVE, naive.torque_nm),
                    Series::line(COMMITTED, committed.torque_nm.clone()),
                ],
                bounds: marks(["kr 10 → 400", "kr 400 → 10"]),
                ..PanelData::default()
            },
            PanelData {
                heading: "The same, near Ts and Tk".to_owned(),
                x: time(),
                y: Scale::linear("Torque (N·m)").within(-0.05, 0.45),
                series: vec![Series::line(COMMITTED, committed.torque_nm)],
                levels: levels(),
                bounds: marks(["", ""]),
            },
            PanelData {
                heading: "Energy of spring and object".to_owned(),
                x: time(),
                y: Scale::logarithmic("Energy (J)").within(LEAST_J, 1.0),
                series: vec![
                    Series::line(NAIVE, naive.stored_j),
                    Series::line(COMMITTED, committed.stored_j),
                ],
                bounds: marks(["", ""]),
                ..PanelData::default()
            },
        ],
    })
}
