//! The varied settings, and the scene of each.

use crepitus_model::render::effects::friction_compensation::FrictionCompensationSettings;
use crepitus_scene::preset::{Joint, joints};
use crepitus_scene::scene::Overrides;
use crepitus_scene::{Scene, SceneError};
use std::fmt::Write;
use std::path::Path;

/// The device's tick, s.
pub(super) const TICK_S: f64 = 5e-5;

/// Time at which the hand begins to stop, and time at which it rests, s.
const STOPS_S: f64 = 0.3;
const RESTS_S: f64 = 0.35;

/// Speed of the hand before, rad/s.
const SPEED_RAD_S: f64 = 0.5;

/// Length of a run, s.
pub(super) const DURATION_S: f64 = 3.0;

/// Stiffness of the rendered spring, N·m/rad.
pub const STIFFNESSES: [f64; 14] = [
    25.0, 35.0, 50.0, 71.0, 100.0, 141.0, 200.0, 283.0, 400.0, 566.0, 800.0, 1131.0, 1600.0, 2263.0,
];

/// Damping of the cuff, N·m·s/rad; the plausible range begins at 0.5.
pub const DAMPINGS: [f64; 6] = [0.0, 0.05, 0.1, 0.2, 0.5, 1.0];

/// Lag from the commanded to the acting torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lag {
    /// No delay; the torque is held for a tick.
    Ideal,
    /// A motor whose current loop has this bandwidth, Hz.
    Motor(f64),
}

/// The lags of the map; the device's is the second.
pub const LAGS: [Lag; 4] = [
    Lag::Ideal,
    Lag::Motor(1000.0),
    Lag::Motor(300.0),
    Lag::Motor(100.0),
];

impl Lag {
    /// Mean delay of the torque, s: half a tick of holding, and for a motor 1/g
    /// ticks, g = 1 − e^(−2π·f·h) being the share by which the current reduces
    /// its error in a tick.
    pub fn mean_s(self) -> f64 {
        let ticks = match self {
            Self::Ideal => 0.0,
            Self::Motor(_) => 1.0 / self.gain(),
        };
        (0.5 + ticks) * TICK_S
    }

    /// g of a motor; 1 without one.
    pub(super) fn gain(self) -> f64 {
        match self {
            Self::Ideal => 1.0,
            Self::Motor(hz) => -(-std::f64::consts::TAU * hz * TICK_S).exp_m1(),
        }
    }

    /// Description.
    pub fn name(self) -> String {
        match self {
            Self::Ideal => "torque at once".to_owned(),
            Self::Motor(hz) => format!("current loop of {hz} Hz"),
        }
    }
}

/// The gear's dry friction, and its compensation by the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gear {
    /// Description.
    pub name: &'static str,
    /// Dry friction, N·m.
    pub friction_nm: f64,
    /// Share of the load that is lost.
    pub load_loss: f64,
    /// The device compensates share·friction of its own settings.
    pub is_compensated: bool,
}

/// The gears of the map.
pub const GEARS: [Gear; 6] = [
    gear("0.5 N·m", 0.5, 0.3, false),
    gear("0.5 N·m, of which 0.4 compensated", 0.5, 0.3, true),
    gear("0.4 N·m, all of it compensated", 0.4, 0.0, true),
    gear("0.1 N·m, of which 0.4 compensated", 0.1, 0.0, true),
    gear("0.005 N·m", 0.005, 0.0, false),
    gear("none", 0.0, 0.0, false),
];

const fn gear(name: &'static str, friction_nm: f64, load_loss: f64, is_compensated: bool) -> Gear {
    Gear {
        name,
        friction_nm,
        load_loss,
        is_compensated,
    }
}

impl Gear {
    /// Dry friction left to a moving shaft, N·m; negative if the device
    /// overcompensates.
    pub fn left_nm(&self) -> f64 {
        let believed = FrictionCompensationSettings::default();
        let compensated = if self.is_compensated {
            believed.share * believed.friction_nm
        } else {
            0.0
        };
        self.friction_nm - compensated
    }
}

/// A further effect of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extra {
    /// Description.
    pub name: &'static str,
    /// Lines of a scene.
    toml: &'static str,
}

impl Extra {
    /// No further effect.
    pub const NONE: Self = Self {
        name: "nothing else",
        toml: "",
    };

    /// Each of the effects that the map leaves out.
    pub const ALL: [Self; 6] = [
        Self::NONE,
        Self {
            name: "backlash of 1°",
            toml: "[effects.backlash]\n",
        },
        Self {
            name: "bone shaping",
            toml: "[effects.bone-shaping]\n",
        },
        Self {
            name: "the leg's own mass and tissue",
            toml: "[effects.limb]\n",
        },
        Self {
            name: "an encoder of 128 lines",
            toml: "encoder.lines = 128\n",
        },
        Self {
            name: "an encoder of 4096 lines",
            toml: "encoder.lines = 4096\n",
        },
    ];
}

/// One cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// The joint, but for its stiffness.
    pub preset: &'static Joint,
    /// Stiffness, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Damping of the cuff, N·m·s/rad.
    pub damping_nms_per_rad: f64,
    /// Lag from the commanded to the acting torque.
    pub lag: Lag,
    /// The gear.
    pub gear: Gear,
    /// A further effect.
    pub extra: Extra,
}

impl Setting {
    /// The paper's joint on the unchanged device, with a plausible damping of
    /// the cuff.
    pub fn shipped() -> Self {
        let [coarse, ..] = joints() else {
            unreachable!("a test finds joints among the presets")
        };
        let [_, _, _, _, _, damping] = DAMPINGS;
        let [_, lag, ..] = LAGS;
        let [_, gear, ..] = GEARS;
        Self {
            preset: coarse,
            stiffness_nm_per_rad: coarse.parameters.stiffness_nm_per_rad,
            damping_nms_per_rad: damping,
            lag,
            gear,
            extra: Extra::NONE,
        }
    }

    /// The scene file of the cell, for `crepitus run`.
    pub fn toml(&self) -> String {
        let mut text = format!(
            "version = 1\n\
             title = \"A hand that stops\"\n\
             duration_s = {DURATION_S:?}\n\
             device = true\n\n\
             [motion]\n\
             kind = \"velocity-knots\"\n\
             knots = [{{ t_s = 0.0, omega_rad_s = {SPEED_RAD_S:?} }}, {{ t_s = {STOPS_S:?}, \
             omega_rad_s = {SPEED_RAD_S:?} }}, {{ t_s = {RESTS_S:?}, omega_rad_s = 0.0 }}]\n\n\
             [solver]\n\
             kind = \"exact-events\"\n\
             step_s = {TICK_S:?}\n\
             precision = \"f32\"\n\n\
             [effects]\n\
             hand = {{}}\n"
        );
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "crepitus = {{ preset = \"{}\", stiffness_nm_per_rad = {:?} }}",
            self.preset.name, self.stiffness_nm_per_rad
        );
        let _ = writeln!(
            text,
            "drivetrain = {{ friction_nm = {:?}, load_loss = {:?} }}",
            self.gear.friction_nm, self.gear.load_loss
        );
        let _ = writeln!(
            text,
            "cuff = {{ damping_nms_per_rad = {:?} }}",
            self.damping_nms_per_rad
        );
        if let Lag::Motor(hz) = self.lag {
            let _ = writeln!(text, "motor = {{ bandwidth_hz = {hz:?} }}");
        }
        if self.gear.is_compensated {
            text.push_str("friction-compensation = {}\n");
        }
        if self.extra.toml.starts_with("encoder") {
            text.push_str(self.extra.toml);
        } else {
            text.push_str("encoder = {}\n\n");
            text.push_str(self.extra.toml);
        }
        text
    }

    /// The scene.
    ///
    /// # Errors
    /// [`SceneError`] if the device refuses the joint.
    pub fn scene(&self) -> Result<Scene, SceneError> {
        Scene::parse(
            Path::new("coupled.toml"),
            &self.toml(),
            &Overrides::default(),
        )
    }
}
