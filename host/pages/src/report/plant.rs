//! Figures of a plant: the leg, the hand, and the columns of
//! its effects. A scene without a plant has none of this.

use crepitus_model::parameters::same;
use crepitus_model::render::effects::{EffectSpec, SPECS};
use crepitus_scene::trace::Column;

use crate::plot::Thinned;
use crate::plot::palette::{CURVES, Ink};
use crate::report::channels::{Channels, Sample, Setup};
use crate::report::course::Course;
use crate::report::spectrum::{Spectrum, Welch};
use crate::report::symptoms::words::Words;

/// The side of the leg: its motion, and the torque at the hand. `green` in
/// the style sheet.
pub(crate) const LEG: Ink = CURVES[2];

/// A column that gets a small chart of its own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown {
    column: &'static str,
    /// Description.
    pub(crate) title: &'static str,
    /// Label of the axis, with the unit.
    pub(crate) axis: &'static str,
    /// Factor from the column's unit to that of the axis.
    scale: f64,
    /// Quantity of the motor itself, not referred to the joint.
    pub(crate) of_motor: bool,
    /// Added to the model's torque before it is commanded.
    pub(crate) is_stage: bool,
    /// Shows the push that arms the motor.
    pub(crate) has_pushes: bool,
}

const fn shown(column: &'static str, title: &'static str, axis: &'static str) -> Shown {
    Shown {
        column,
        title,
        axis,
        scale: 1.0,
        of_motor: false,
        is_stage: false,
        has_pushes: false,
    }
}

/// Column of an effect of the device.
const fn stage(spec: &EffectSpec) -> Shown {
    let axis = if same(spec.unit, "V") {
        "Voltage (V)"
    } else {
        "Torque (N·m)"
    };
    Shown {
        is_stage: same(spec.unit, "N·m"),
        ..shown(spec.column, spec.title, axis)
    }
}

const fn of_motor(column: &'static str, title: &'static str, axis: &'static str) -> Shown {
    Shown {
        of_motor: true,
        ..shown(column, title, axis)
    }
}

impl Shown {
    /// The torque of a symptom.
    pub(crate) fn is_symptom(&self) -> bool {
        Words::all().any(|words| words.spec.column == self.column)
    }
}

/// Columns of the plant.
const SHOWN: [Shown; 16] = [
    of_motor("motor_current_a", "Motor current", "Current (A)"),
    of_motor("motor_voltage_v", "Motor voltage", "Voltage (V)"),
    Shown {
        has_pushes: true,
        ..shown(
            "motor_torque_nm",
            "Motor torque, at the joint",
            "Torque (N·m)",
        )
    },
    shown("gear_friction_nm", "Friction of the gear", "Torque (N·m)"),
    Shown {
        scale: 180.0 / std::f64::consts::PI,
        ..shown("gap_rad", "Backlash: rotor ahead of the joint", "Angle (°)")
    },
    shown(
        "brace_torque_nm",
        "Brace: torque on the leg, as a force sensor between them shows it",
        "Torque (N·m)",
    ),
    shown(
        "limb_torque_nm",
        "Leg: weight and passive moment",
        "Torque (N·m)",
    ),
    shown(
        "limb_stretch_nm",
        "Pull along the shank: torque on the leg",
        "Torque (N·m)",
    ),
    shown("coil_voltage_v", "Coil of the actuator", "Voltage (V)"),
    shown("coil_current_a", "Coil of the actuator", "Current (A)"),
    shown(
        "actuator_torque_nm",
        "Actuator: torque on the shell",
        "Torque (N·m)",
    ),
    shown(
        "seat_torque_nm",
        "Seat: torque of the shell on the leg",
        "Torque (N·m)",
    ),
    shown("shell_weight_nm", "Weight of the shell", "Torque (N·m)"),
    Shown {
        scale: 1e3,
        ..shown("excursion_m", "Excursion of the reaction mass", "Way (mm)")
    },
    shown(
        "shell_acceleration_m_s2",
        "Acceleration of the shell",
        "Acceleration (m/s²)",
    ),
    shown(
        "hand_acceleration_m_s2",
        "Acceleration of the palm",
        "Acceleration (m/s²)",
    ),
];

/// Data collected during the run.
#[derive(Debug)]
pub(crate) struct PlantCollector {
    hand_welch: Option<Welch>,
    /// The last time and intended angle, for the intended speed.
    last_intended: (f64, f64),
    plant: Plant,
    columns: Vec<(usize, Shown)>,
}

/// Collected data of a complete run.
#[derive(Debug)]
pub(crate) struct Plant {
    pub(crate) leg: Follower,
    pub(crate) intended: Follower,
    pub(crate) hand: Course,
    /// Torque at the hand without its slow part.
    pub(crate) fast: Course,
    /// The time that the slow part is a mean over, s.
    pub(crate) mean_s: f64,
    pub(crate) hand_spectrum: Option<Spectrum>,
    /// The columns of effects, in their order in a row.
    pub(crate) columns: Vec<(Shown, Course)>,
}

/// Motion beside that of the shaft.
#[derive(Debug)]
pub(crate) struct Follower {
    pub(crate) angle: Thinned,
    pub(crate) omega: Thinned,
    /// Lead of its angle over the shaft's.
    pub(crate) ahead: Thinned,
}

impl Plant {
    /// Returns whether something is added to the model's torque.
    pub(crate) fn has_stages(&self) -> bool {
        self.columns
            .iter()
            .any(|(shown, _)| shown.is_stage && !shown.is_symptom())
    }
}

impl Follower {
    fn new() -> Self {
        Self {
            angle: Thinned::new(Course::LINE),
            omega: Thinned::new(Course::LINE),
            ahead: Thinned::new(Course::LINE),
        }
    }

    fn push(&mut self, time: f64, angle: f64, omega: f64, shaft: f64) {
        self.angle.push(time, angle);
        self.omega.push(time, omega);
        self.ahead.push(time, angle - shaft);
    }
}

impl PlantCollector {
    /// Ready for the first row; `None` without columns of a plant.
    pub(crate) fn new(channels: &Channels, setup: &Setup, mean_s: f64) -> Option<Self> {
        let columns = columns(setup.columns);
        if columns.is_empty() && !channels.has_hand() && !channels.has_leg() {
            return None;
        }
        let course = || Course::new(setup.rows_expected);
        Some(Self {
            hand_welch: channels
                .has_hand()
                .then(|| Welch::differencing(setup.row_step_s, setup.rows_expected))
                .flatten(),
            last_intended: (f64::NAN, f64::NAN),
            plant: Plant {
                leg: Follower::new(),
                intended: Follower::new(),
                hand: course(),
                fast: course(),
                mean_s,
                hand_spectrum: None,
                columns: columns
                    .iter()
                    .map(|(_, shown)| (*shown, course()))
                    .collect(),
            },
            columns,
        })
    }

    /// Takes a row, of which the sample is a part.
    pub(crate) fn row(&mut self, sample: &Sample, values: &[f64]) {
        let time = sample.time;
        let plant = &mut self.plant;
        plant
            .leg
            .push(time, sample.leg_angle, sample.leg_omega, sample.angle);
        let (last_time, last_angle) = self.last_intended;
        let speed = (sample.intended_angle - last_angle) / (time - last_time);
        self.last_intended = (time, sample.intended_angle);
        plant
            .intended
            .push(time, sample.intended_angle, speed, sample.angle);
        for ((at, _), (shown, course)) in self.columns.iter().zip(&mut plant.columns) {
            let value = values.get(*at).copied().unwrap_or(f64::NAN);
            course.push(time, shown.scale * value);
        }
        if let Some(welch) = &mut self.hand_welch {
            welch.push(sample.hand_torque);
        }
    }

    /// Takes a row again when the fast part of its hand torque is known.
    pub(crate) fn hand(&mut self, sample: &Sample) {
        self.plant.hand.push(sample.time, sample.hand_torque);
        self.plant.fast.push(sample.time, sample.hand_fast);
    }

    pub(crate) fn finish(self) -> Plant {
        let plant = self.plant;
        Plant {
            hand: plant.hand.finish(),
            fast: plant.fast.finish(),
            hand_spectrum: self.hand_welch.and_then(Welch::finish),
            columns: plant
                .columns
                .into_iter()
                .map(|(shown, course)| (shown, course.finish()))
                .collect(),
            ..plant
        }
    }
}

/// Columns that get a chart, and their places in a row.
fn columns(columns: &[Column]) -> Vec<(usize, Shown)> {
    columns
        .iter()
        .enumerate()
        .filter_map(|(at, column)| {
            let shown = SPECS
                .iter()
                .map(stage)
                .chain(SHOWN)
                .find(|shown| shown.column == column.name)?;
            Some((at, shown))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_plant::effects::EFFECTS;
    use crepitus_scene::{Overrides, Scene};
    use std::path::Path;

    /// Columns without a chart of their own: they stand in another one or in a table, or are counts.
    const WITHOUT: [&str; 8] = [
        "hand_torque_nm",
        "hand_impact_nms",
        "leg_angle_rad",
        "leg_omega_rad_s",
        "intended_angle_rad",
        "limb_stretch_m",
        "stop_knocks",
        "tank_held_back",
    ];

    #[test]
    fn what_an_effect_of_the_plant_adds_has_a_chart() {
        let names = |effects: &str| -> Vec<&str> {
            let text = format!(
                "version = 1\ntitle = \"all\"\nduration_s = 0.1\n[motion]\nkind = \"sine\"\n\
                 amplitude_deg = 30\nfrequency_hz = 1.0\n[solver]\nkind = \"exact-events\"\n\
                 step_s = 5e-5\n{effects}"
            );
            let scene = Scene::parse(Path::new("all.toml"), &text, &Overrides::default());
            let columns = crepitus_scene::run::columns(&scene.expect("a scene"));
            columns.iter().map(|column| column.name).collect()
        };
        let alone = names("[effects.crepitus]\n[effects.encoder]\n");
        let all: Vec<String> = EFFECTS
            .iter()
            .map(|effect| format!("[effects.{}]\n", effect.name))
            .collect();
        let of_device = SPECS
            .iter()
            .filter_map(|spec| spec.phases.map(|p| p.column));
        let of_device: Vec<&str> = of_device.collect();
        let (mut charts, mut missing) = (0, Vec::new());
        for name in names(&all.concat()) {
            let has_chart = SPECS
                .iter()
                .map(stage)
                .chain(SHOWN)
                .any(|shown| shown.column == name);
            let is_known =
                alone.contains(&name) || of_device.contains(&name) || WITHOUT.contains(&name);
            if !has_chart && !is_known {
                missing.push(name);
            }
            charts += usize::from(has_chart);
        }
        assert_eq!(missing, [""; 0], "on no page of a report");
        assert!(charts >= SHOWN.len());
    }
}
