//! Input of the vibration actuator: a device in its loop on a leg with a shell, a
//! reaction mass and a hand.

use super::Lost;
use crate::stability::text::{Plain, Time};
use crate::vibration::loop_gain::CUFFS;
use crepitus_scene::scene::Precision;
use std::fmt;

/// Effects of the scene.
const EFFECTS: [&str; 11] = [
    "crepitus",
    "encoder",
    "motor",
    "drivetrain",
    "backlash",
    "cuff",
    "limb",
    "shell",
    "reaction-mass",
    "hand",
    "vibration-actuator",
];

/// A device that vibrates.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ActuatorRun {
    /// Differences from the default plant, in words.
    pub(crate) with: &'static str,
    /// The joint's preset.
    pub(crate) preset: &'static str,
    /// Speed that the hand intends, rad/s; 0 holds still.
    pub(crate) speed_rad_s: f64,
    /// Additional and replaced settings of the scene: (effect, key, value as TOML).
    pub(crate) keys: &'static [(&'static str, &'static str, &'static str)],
    /// The gear has backlash.
    pub(crate) backlash: bool,
    /// Disturbances, and their times, s.
    pub(crate) upsets: &'static [(f64, Upset)],
    pub(crate) lost: Lost,
}

/// The loop that it closes on each of the cuffs, with a joint that sticks: see
/// [`loop_gain`](crate::vibration::loop_gain).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ActuatorLoop {
    /// Hands that hold the shell: each of these.
    pub(crate) hands: &'static [&'static str],
    /// Ticks that everything is late besides.
    pub(crate) late_ticks: u32,
}

/// Disturbance of a device that vibrates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Upset {
    /// The hand lets go.
    LetsGo,
    /// The device is disarmed: both bridges are open.
    Disarmed,
    /// A gain is committed.
    Gain(f64),
    /// The hand goes on with this speed, at once, rad/s.
    Speed(f64),
}

impl ActuatorRun {
    /// Returns the run as a scene.
    pub(crate) fn scene(&self, precision: Precision, duration_s: f64, step_s: f64) -> String {
        let mut text = format!(
            "version = 1\ntitle = \"shaken\"\nduration_s = {duration_s:?}\n[motion]\nkind = \"velocity-knots\"\n\
             from_deg = 40.0\nknots = [{}]\n[solver]\nkind = \"exact-events\"\nstep_s = {step_s:?}\nprecision = \
             \"{}\"\n",
            self.knots(duration_s).join(", "),
            precision.name()
        );
        for effect in EFFECTS {
            if effect == "backlash" && !self.backlash {
                continue;
            }
            text.push_str(&["[effects.", effect, "]\n"].concat());
            match effect {
                "crepitus" => text.push_str(&["preset = \"", self.preset, "\"\n"].concat()),
                "hand" => text.push_str("grip = \"firm\"\nlever_m = 0.3\n"),
                _ => {}
            }
            for (_, key, value) in self.keys.iter().filter(|(of, ..)| *of == effect) {
                text.push_str(&[key, " = ", value, "\n"].concat());
            }
        }
        text
    }

    /// The hand's velocity as knots.
    fn knots(&self, duration_s: f64) -> Vec<String> {
        let knot = |at_s: f64, left: f64, right: f64| {
            format!(
                "{{ t_s = {at_s:?}, omega_left_rad_s = {left:?}, omega_right_rad_s = {right:?} }}"
            )
        };
        let mut now = self.speed_rad_s;
        let mut knots = vec![knot(0.0, now, now)];
        for (at_s, upset) in self.upsets {
            if let Upset::Speed(next) = upset {
                knots.push(knot(*at_s, now, *next));
                now = *next;
            }
        }
        knots.push(knot(duration_s, now, now));
        knots
    }
}

impl fmt::Display for ActuatorLoop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (hands, cuffs) = (self.hands.join(", "), CUFFS.map(|c| Plain(c).to_string()));
        write!(
            f,
            "the loop of a joint that sticks; hand: {hands}; cuff: {} N·m/rad",
            cuffs.join(", ")
        )?;
        match self.late_ticks {
            0 => Ok(()),
            ticks => write!(f, "; {ticks} ticks late"),
        }
    }
}

impl fmt::Display for ActuatorRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { preset, with, .. } = self;
        let speed = Plain(self.speed_rad_s);
        write!(
            f,
            "{preset} at {speed} rad/s in the hand, with the actuator{with}"
        )?;
        if self.backlash {
            f.write_str(", with backlash")?;
        }
        write!(f, "{}", self.lost)?;
        for (at_s, upset) in self.upsets {
            write!(f, ", from {} on ", Time(*at_s))?;
            match upset {
                Upset::LetsGo => f.write_str("nobody holds it")?,
                Upset::Disarmed => f.write_str("disarmed")?,
                Upset::Gain(gain) => write!(f, "gain {}", Plain(*gain))?,
                Upset::Speed(speed) => write!(f, "{} rad/s", Plain(*speed))?,
            }
        }
        Ok(())
    }
}
