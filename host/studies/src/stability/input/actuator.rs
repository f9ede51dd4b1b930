//! Input of the vibration actuator: a device in its loop on a leg with a shell, a
//! reaction mass and a hand.

use super::Lost;
use crate::stability::text::{Plain, Time};
use crepitus_scene::scene::Precision;
use std::fmt;

/// A device that vibrates.
#[derive(Clone, Debug, PartialEq)]
pub struct ActuatorRun {
    /// Differences from the default plant, in words.
    pub with: &'static str,
    /// The joint's preset.
    pub preset: &'static str,
    /// Speed that the hand intends, rad/s; 0 holds still.
    pub speed_rad_s: f64,
    /// Additional and replaced settings of the scene: (effect, key, value as TOML).
    pub keys: &'static [(&'static str, &'static str, &'static str)],
    /// The gear has backlash.
    pub backlash: bool,
    /// Disturbances, and their times, s.
    pub upsets: &'static [(f64, Upset)],
    /// Lost samples.
    pub lost: Lost,
    /// Duration, s.
    pub duration_s: f64,
    /// The step, s.
    pub step_s: f64,
}

/// The loop that it closes, with a joint that sticks: see
/// [`loop_gain`](crate::vibration::loop_gain).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorLoop {
    /// Hands that hold the shell: each of these.
    pub hands: &'static [&'static str],
    /// Stiffnesses of the cuffs: each of these, N·m/rad.
    pub cuffs_nm_per_rad: &'static [f64],
    /// Ticks that everything is late besides.
    pub late_ticks: u32,
}

impl fmt::Display for ActuatorLoop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cuffs = self.cuffs_nm_per_rad.iter();
        let cuffs: Vec<String> = cuffs.map(|cuff| Plain(*cuff).to_string()).collect();
        write!(
            f,
            "the loop of a joint that sticks; hand: {}; cuff: {} N·m/rad",
            self.hands.join(", "),
            cuffs.join(", ")
        )?;
        match self.late_ticks {
            0 => Ok(()),
            ticks => write!(f, "; {ticks} ticks late"),
        }
    }
}

/// Disturbance of a device that vibrates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Upset {
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
    pub(in crate::stability) fn scene(&self, precision: Precision) -> String {
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
        let Self {
            preset,
            speed_rad_s,
            duration_s,
            step_s,
            ..
        } = self;
        let knots: Vec<String> = self.speeds().iter().map(ToString::to_string).collect();
        let mut text = format!(
            "version = 1\ntitle = \"shaken\"\nduration_s = {duration_s:?}\n[motion]\nkind = \"velocity-knots\"\n\
             from_deg = 40.0\nknots = [{}]\n[solver]\nkind = \"exact-events\"\nstep_s = {step_s:?}\nprecision = \
             \"{}\"\n",
            knots.join(", "),
            precision.name()
        );
        debug_assert!(speed_rad_s.is_finite());
        for effect in EFFECTS {
            if effect == "backlash" && !self.backlash {
                continue;
            }
            text.push_str(&["[effects.", effect, "]\n"].concat());
            match effect {
                "crepitus" => text.push_str(&["preset = \"", preset, "\"\n"].concat()),
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
    fn speeds(&self) -> Vec<Knot> {
        let mut now = self.speed_rad_s;
        let mut knots = vec![Knot(0.0, now, now)];
        for (at_s, upset) in self.upsets {
            if let Upset::Speed(next) = upset {
                knots.push(Knot(*at_s, now, *next));
                now = *next;
            }
        }
        knots.push(Knot(self.duration_s, now, now));
        knots
    }
}

/// Time, and velocity on both sides of it.
struct Knot(f64, f64, f64);

impl fmt::Display for Knot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{{ t_s = {:?}, omega_left_rad_s = {:?}, omega_right_rad_s = {:?} }}",
            self.0, self.1, self.2
        )
    }
}

impl fmt::Display for ActuatorRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} at {} rad/s in the hand, with the actuator{}",
            self.preset,
            Plain(self.speed_rad_s),
            self.with
        )?;
        if self.backlash {
            f.write_str(", with backlash")?;
        }
        if self.lost.ticks > 0 {
            write!(
                f,
                ", {} samples in a row lost of every {}",
                self.lost.ticks, self.lost.every
            )?;
        }
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
