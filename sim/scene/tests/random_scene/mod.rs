//! Random motions and parameters of a symptom, as text of a scene.

use fastrand::Rng;
use std::fmt::Write;

pub(crate) const TICK_S: f64 = 5e-5;

/// Tolerance within which stepped and event-driven laws agree.
#[derive(Clone, Copy)]
pub(crate) struct Tolerance {
    pub(crate) time_s: f64,
    pub(crate) torque_nm: f64,
}

/// Numbers that look random.
pub(crate) struct Random(Rng);

impl Random {
    pub(crate) fn new(seed: u64, name: &str, form: &str) -> Self {
        let letters = name.bytes().chain(form.bytes());
        let seed = letters.fold(seed.wrapping_mul(0x1234_5678_9ABC_DEF1), |sum, byte| {
            sum.wrapping_mul(31).wrapping_add(u64::from(byte))
        });
        Self(Rng::with_seed(seed))
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.f64()
    }

    /// Now and then an end of the range.
    fn within(&mut self, low: f64, high: f64) -> f64 {
        match self.0.f64() {
            x if x < 0.06 => low,
            x if x > 0.94 => high,
            _ => self.between(low, high),
        }
    }

    fn happens(&mut self, share: f64) -> bool {
        self.0.f64() < share
    }
}

/// Strokes of the hand about the middle of the range; `jumps` is how many of the knots
/// of a velocity are jumps of it.
pub(crate) fn motion(random: &mut Random, end_s: f64, jumps: f64) -> String {
    let mut text = String::from("[motion]\n");
    let middle = random.between(30.0, 90.0);
    match random.0.f64() {
        x if x < 0.2 => {
            let _ = write!(
                text,
                "kind = \"sine\"\nfrom_deg = {middle:?}\namplitude_deg = {:?}\nfrequency_hz = {:?}\n",
                random.between(2.0, 60.0),
                random.between(0.4, 3.0)
            );
        }
        x if x < 0.4 => {
            let _ = write!(
                text,
                "kind = \"strokes\"\nfrom_deg = {:?}\nto_deg = {:?}\npeak_speed_deg_s = {:?}\npause_s = {:?}\n",
                random.between(-5.0, 40.0),
                random.between(70.0, 130.0),
                random.between(60.0, 400.0),
                random.between(0.0, 0.2)
            );
        }
        _ => {
            let (mut time, mut angle, mut speed) = (0.0, random.between(0.0, 120.0), 0.0);
            let _ = write!(text, "kind = \"velocity-knots\"\nfrom_deg = {angle:?}\n");
            let mut knots = Vec::new();
            while time < end_s {
                let left: f64 = speed;
                if random.happens(jumps) {
                    speed = random.between(-300.0, 300.0);
                }
                knots.push((time, left, speed));
                let length = random.between(600.0, 6000.0) * TICK_S;
                let next = if random.happens(0.3) {
                    speed
                } else {
                    // Back to the middle, at last.
                    random.between(-250.0, 250.0) - 3.0 * (angle - middle)
                };
                let next = next.clamp(-400.0, 400.0);
                angle += 0.5 * (speed + next) * length;
                // On a tick or within one.
                time += length;
                if random.happens(0.3) {
                    time = (time / TICK_S).round() / 20_000.0;
                }
                speed = next;
            }
            knots.push((time, speed, speed));
            for (t, left, right) in knots {
                let (left, right) = (left.to_radians(), right.to_radians());
                let _ = write!(
                    text,
                    "[[motion.knots]]\nt_s = {t:?}\nomega_left_rad_s = {left:?}\nomega_right_rad_s = {right:?}\n"
                );
            }
        }
    }
    text
}

/// Parameters of a symptom.
#[expect(clippy::too_many_lines, reason = "a list of parameters")]
pub(crate) fn effects(name: &str, form: &str, random: &mut Random) -> String {
    let mut text = format!("[effects.{name}]\n");
    let mut give = |key: &str, x: f64| {
        let _ = writeln!(text, "{key} = {x:?}");
    };
    let mut choices = Vec::new();
    let flexors = random.happens(0.5);
    let muscles = if flexors { "flexors" } else { "extensors" };
    match name {
        "range-limit" => {
            let low = random.between(-10.0, 60.0);
            give("extension_limit_deg", low);
            give("flexion_limit_deg", random.between(low + 6.0, 130.0));
            for side in ["extension_", "flexion_"] {
                let mut give = |key: &str, x: f64| give(&format!("{side}{key}"), x);
                let loss = random.within(0.1, 0.6);
                let cap = random.within(0.0, 6.5);
                let most = 1000.0 * (1.0 - loss);
                let slope = random.between(1.0, most.min(600.0));
                let bend = if cap > 0.0 {
                    random.within(0.0, 0.999).powi(2) * (most * most - slope * slope) / (4.0 * cap)
                } else {
                    100.0
                };
                give("stiffness_nm_per_rad", slope);
                give("stiffening_nm_per_rad2", bend.clamp(0.0, 5000.0));
                give("loss", loss);
                give("torque_nm", cap);
            }
        }
        "lead-pipe" | "cogwheel" => {
            let torque = random.within(0.0, 4.5);
            give("torque_nm", torque);
            // Not above 1200 N·m/rad.
            give("presliding_deg", random.within(0.25, 10.0));
            give("elastic_nm_per_rad", random.within(0.0, 10.0));
            give("neutral_deg", random.within(0.0, 140.0));
            if name == "cogwheel" {
                choices.push(("mode", form));
                give("low_share", random.within(0.0, 1.0));
                give("frequency_hz", random.within(3.0, 12.0));
                give("duty", random.within(0.1, 0.9));
                give("pitch_deg", random.within(1.0, 30.0));
            }
        }
        "spasticity" => {
            choices.push(("form", form));
            choices.push(("muscles", muscles));
            give("threshold_deg", random.between(20.0, 110.0));
            if form == "catch" {
                give("torque_nm", random.within(0.0, 6.5));
                give("velocity_shift_s", random.within(0.0, 0.5));
                give("threshold_velocity_deg_s", random.within(5.0, 200.0));
                give("velocity_torque_nms_per_rad", random.within(0.0, 2.0));
                give("residual_share", random.within(0.0, 1.0));
                give("stiffness_nm_per_rad", random.within(0.0, 10.0));
                give("release_s", random.within(0.01, 1.0));
                give("catch_stiffness_nm_per_rad", random.within(10.0, 300.0));
                give("rearm_deg", random.within(2.0, 60.0));
            } else {
                let (delay, activation) = (random.within(0.0, 0.1), random.within(0.002, 0.1));
                give("delay_s", delay);
                give("activation_s", activation);
                give(
                    "velocity_shift_s",
                    random.within(delay + activation + 1e-9, 0.5),
                );
                // So little that the tank need not fade it.
                give("torque_nm", random.within(0.0, 0.04));
                give("gain_nm_per_rad", random.within(0.0, 0.02));
            }
        }
        "clasp-knife" => {
            choices.push(("trigger", form));
            choices.push(("muscles", muscles));
            let (low, high) = (random.between(10.0, 60.0), random.between(61.0, 110.0));
            let (onset, release) = if flexors { (high, low) } else { (low, high) };
            give("onset_deg", onset);
            give("release_deg", release);
            give("onset_torque_nm", random.within(0.0, 4.5));
            give("slope_nm_per_rad", random.within(0.0, 10.0));
            give("residual_share", random.within(0.0, 0.9));
            give("collapse_s", random.within(0.005, 0.3));
            give("rearm_deg", random.within(2.0, 60.0));
            give("catch_stiffness_nm_per_rad", random.within(10.0, 300.0));
            give("release_torque_nm", random.within(0.2, 4.5));
        }
        "clonus" => {
            choices.push(("muscles", muscles));
            give("hold_deg", random.between(20.0, 100.0));
            give("hysteresis_deg", random.within(1.0, 30.0));
            give("start_velocity_deg_s", random.within(20.0, 150.0));
            give("frequency_hz", random.within(3.0, 10.0));
            give("push_share", random.within(0.2, 0.8));
            give("first_stretch", random.within(0.0, 1.0));
            give("amplitude_nm", random.within(0.0, 0.02));
            give("delay_s", random.within(0.0, 0.2));
            give(
                "beats",
                if random.happens(0.5) {
                    random.between(0.0, 6.0).floor()
                } else {
                    0.0
                },
            );
        }
        "texture" => {
            let (base, height) = (random.within(0.0, 1.0), random.within(0.0, 1.5));
            let (pitch, width) = (random.within(0.4, 15.0), random.within(0.1, 1.0));
            let stiffness = random.between(50.0, 400.0);
            let most = 0.5 * stiffness * width * pitch.to_radians();
            give("base_nm", base);
            give("peak_nm", base + height.min(most));
            give("pitch_deg", pitch);
            give("width_share", width);
            give("irregularity", random.within(0.0, 0.9));
            give("seed", random.between(0.0, 4e9).floor());
            give("stiffness_nm_per_rad", stiffness);
            // Half of them have patches.
            let patch = random.between(2.0, 10.0) * pitch;
            if random.between(0.0, 1.0) < 0.5 && patch < 60.0 {
                give("patch_deg", patch);
                give("patch_share", random.within(0.05, 1.0));
            }
        }
        _ => panic!("unknown symptom {name}"),
    }
    for (key, choice) in choices {
        let _ = writeln!(text, "{key} = \"{choice}\"");
    }
    text
}
