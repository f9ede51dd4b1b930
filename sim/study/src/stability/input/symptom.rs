//! Input of symptoms other than crepitus, as the device renders them.

use super::Lost;
use crate::stability::text::{Plain, Time};
use crate::symptoms::{Given, Hand};
use crepitus_scene::scene::Precision;
use std::fmt;

/// Symptoms under a hand.
#[derive(Clone, Debug, PartialEq)]
pub struct SymptomRun {
    /// The symptoms.
    pub symptoms: Vec<Given>,
    /// Motion of the hand.
    pub hand: Hand,
    /// Whether they get counts of the device's encoder, or the true motion.
    pub counts: bool,
    /// Commits: when, s, and what is rendered from then on.
    pub commits: Vec<(f64, Vec<Given>)>,
    /// Lost samples.
    pub lost: Lost,
    /// Ticks that the torque is late, where energy is measured.
    pub delay_ticks: usize,
    /// Duration, s.
    pub duration_s: f64,
    /// The step, s.
    pub step_s: f64,
}

/// A rotor without a leg that is pressed into a flexion limit, with the device in the
/// loop: counts, half a tick, the current loop.
#[derive(Clone, Debug, PartialEq)]
pub struct Pressed {
    /// K1 of the wall, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Its loss.
    pub loss: f64,
    /// Dry friction of the rotor, N·m.
    pub friction_nm: f64,
    /// Torque that presses, N·m.
    pub torque_nm: f64,
    /// Duration, s.
    pub duration_s: f64,
    /// The step, s.
    pub step_s: f64,
}

impl Pressed {
    /// Returns the run as a scene. What presses is a string so soft that it does not notice the wall.
    pub(in crate::stability) fn scene(&self, precision: Precision) -> String {
        const STRING_NM_PER_RAD: f64 = 0.02;
        let Self {
            stiffness_nm_per_rad,
            loss,
            friction_nm,
            torque_nm,
            duration_s,
            step_s,
        } = self;
        // Drawn out within a tenth of a second.
        let omega_rad_s = torque_nm / STRING_NM_PER_RAD / 0.05;
        format!(
            "version = 1\ntitle = \"pressed\"\nduration_s = {duration_s:?}\ndevice = true\n\
             [motion]\nkind = \"velocity-knots\"\nfrom_deg = 89.0\nknots = [\n\
             {{ t_s = 0.0, omega_rad_s = 0.0 }},\n\
             {{ t_s = 0.05, omega_rad_s = {omega_rad_s:?} }},\n\
             {{ t_s = 0.1, omega_rad_s = 0.0 }}]\n\
             [solver]\nkind = \"exact-events\"\nstep_s = {step_s:?}\nprecision = \"{}\"\n\
             [output]\ntrace_step_s = {step_s:?}\n\
             [effects.range-limit]\nextension_limit_deg = 0.0\nflexion_limit_deg = 90.0\n\
             flexion_stiffness_nm_per_rad = {stiffness_nm_per_rad:?}\n\
             flexion_stiffening_nm_per_rad2 = 0.0\nflexion_loss = {loss:?}\n\
             [effects.encoder]\n[effects.motor]\n\
             [effects.drivetrain]\nfriction_nm = {friction_nm:?}\nload_loss = 0.0\n\
             [effects.hand]\nmass_kg = 1e-3\ndamping_ns_per_m = 0.0\n\
             stiffness_n_per_m = {STRING_NM_PER_RAD:?}\nlever_m = 1.0\n",
            precision.name()
        )
    }
}

impl fmt::Display for Pressed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "a rotor with {} N·m of friction, pressed by {} N·m into an end of {} N·m/rad with a loss of {}, \
             with encoder, tick and current loop between them",
            Plain(self.friction_nm),
            Plain(self.torque_nm),
            Plain(self.stiffness_nm_per_rad),
            Plain(self.loss)
        )
    }
}

/// Symptoms that must be refused.
#[derive(Clone, Debug, PartialEq)]
pub struct RefusedSymptoms {
    /// The mistake.
    pub what: &'static str,
    /// The symptoms.
    pub symptoms: Vec<Given>,
}

impl SymptomRun {
    /// Returns whether the reference solves it too: one symptom, on the true motion, as it
    /// was armed.
    pub(in crate::stability) fn suits_the_reference(&self) -> bool {
        self.symptoms.len() == 1
            && !self.counts
            && self.commits.is_empty()
            && self.lost == Lost::NONE
    }
}

fn list(f: &mut fmt::Formatter<'_>, symptoms: &[Given]) -> fmt::Result {
    for (i, given) in symptoms.iter().enumerate() {
        let and = if i == 0 { "" } else { " and " };
        write!(f, "{and}{given}")?;
    }
    Ok(())
}

impl fmt::Display for SymptomRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        list(f, &self.symptoms)?;
        write!(f, ": {}", self.hand)?;
        if self.counts {
            f.write_str(", seen through the encoder")?;
        }
        if self.delay_ticks > 0 {
            write!(f, ", the torque {} ticks late", self.delay_ticks)?;
        }
        if self.lost.ticks > 0 {
            write!(
                f,
                ", {} samples in a row lost of every {}",
                self.lost.ticks, self.lost.every
            )?;
        }
        for (at_s, symptoms) in &self.commits {
            write!(f, ", from {} on ", Time(*at_s))?;
            list(f, symptoms)?;
        }
        Ok(())
    }
}
