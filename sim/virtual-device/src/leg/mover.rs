//! Mover of a leg: the scene's motion, its examiner, or the hand of a person; one of them at a time.
//!
//! ```text
//!  straight ── motor driven ──> led ──> moved by the scene's motion, or by its examiner
//!       │                        │        │ aim       ↑ release: an examiner goes on from where the leg
//!       │ aim                    │ aim    ↓           │ is, to a motion it is led back
//!       └────────────────────────┴─────> held by a hand
//! ```
//!
//! Between two ticks another boundary holds the leg, at the angle and the velocity that it has: nothing
//! jumps but what the hand pulls with.

use super::examiner::Examiner;
use super::hand;
use super::lead_in::LeadIn;
use super::{HandInput, TICK_S};
use crepitus_knee::HandPath;
use crepitus_model::render::effects::EffectSettings;
use crepitus_plant::effects::motor::bridge::Bridge;
use crepitus_plant::{Motion, Plant};
use crepitus_scene::{Scene, Walk};

/// The mover.
pub(super) struct Mover {
    scene: Scene,
    /// Examiner who moves the leg in place of the scene's motion, if the scene has one.
    examiner: Option<Examiner>,
    stage: Stage,
    /// Motion of the leg, but while a hand holds it.
    walk: Walk<Motion>,
    step_s: f64,
    /// Time before the walk's, s.
    before_s: f64,
    input: HandInput,
    /// Target of the hand that was executed last.
    target_rad: Option<f64>,
}

/// Stage of a leg's motion.
enum Stage {
    /// Before the motion, or on the way to it.
    Led(LeadIn),
    /// In the motion, or moved by the examiner.
    Moved,
    /// Held by the hand of a person, which goes along this path.
    Held(HandPath),
}

impl Mover {
    /// The mover of a scene's leg, in steps of `step_s`.
    pub(super) fn new(scene: &Scene, step_s: f64) -> Self {
        let mut examiner = Examiner::of(scene);
        let (stage, motion) = if let Some(lead_in) = LeadIn::of(scene) {
            (Stage::Led(lead_in), Motion::rest(0.0))
        } else {
            let examined = examiner.as_mut().map(Examiner::begin);
            let motion = examined.unwrap_or_else(|| scene.endless_motion());
            (Stage::Moved, motion)
        };
        Self {
            scene: scene.clone(),
            examiner,
            stage,
            walk: Walk::new(motion, step_s),
            step_s,
            before_s: 0.0,
            input: HandInput::default(),
            target_rad: None,
        }
    }

    /// Returns whether the leg begins straight, and is led to its motion.
    pub(super) fn leads(&self) -> bool {
        matches!(self.stage, Stage::Led(_))
    }

    /// Input of a hand that moves the leg.
    pub(super) fn input(&self) -> &HandInput {
        &self.input
    }

    /// Time since the start, s; what leads to the motion included.
    pub(super) fn time_s(&self) -> f64 {
        self.before_s + self.walk.time_s()
    }

    /// One step of a plant.
    pub(super) fn advance(&mut self, plant: &mut Plant<Bridge>) {
        if let Stage::Held(path) = &mut self.stage {
            plant.advance(&hand::step(path, self.step_s));
        } else {
            self.walk.advance(plant);
        }
    }

    /// A tick is over, in which the motor was driven or not: changes the motion, or who moves the leg, where that is
    /// due.
    pub(super) fn tick(&mut self, is_driven: bool, plant: &mut Plant<Bridge>) {
        if let Some(motion) = self.next_motion(is_driven) {
            self.turn_to(motion);
        }
        if matches!(self.stage, Stage::Held(_)) {
            self.before_s += TICK_S;
        }
        let target_rad = self.input.target_rad();
        if target_rad != self.target_rad {
            self.target_rad = target_rad;
            self.follow_hand(target_rad, plant);
        }
        self.heed_blind();
        let hand_rad = match &self.stage {
            Stage::Held(path) => Some(path.state().angle_rad),
            Stage::Led(_) | Stage::Moved => None,
        };
        self.input.report(hand_rad, plant.shaft().angle_rad);
    }

    /// The motion that begins with the next tick, if another does.
    fn next_motion(&mut self, is_driven: bool) -> Option<Motion> {
        match &mut self.stage {
            Stage::Led(lead_in) => {
                let next = lead_in.tick(is_driven);
                if !lead_in.is_over() {
                    return next;
                }
                self.stage = Stage::Moved;
                self.examiner.as_mut().map(Examiner::begin).or(next)
            }
            Stage::Moved => self.examiner.as_mut()?.tick(),
            Stage::Held(_) => None,
        }
    }

    fn turn_to(&mut self, motion: Motion) {
        self.before_s += self.walk.time_s();
        self.walk.turn_to(motion);
    }

    /// Tells the examiner, if there is one, which knee it is: its effects, and whether the imaginary object is on. For
    /// another knee he or she stops, and begins another examination, but in a blind trial.
    pub(super) fn examine(&mut self, effects: &EffectSettings, grates: bool) {
        // A trial is blind before its knee comes.
        self.heed_blind();
        if let Some(examiner) = &mut self.examiner
            && examiner.meet(&(*effects, grates))
        {
            self.examine_again();
        }
    }

    /// Tells the examiner whether a trial is blind. Once that has changed, he or she begins another examination.
    fn heed_blind(&mut self) {
        let is_blind = self.input.is_blind();
        if let Some(examiner) = &mut self.examiner
            && examiner.set_blind(is_blind)
        {
            self.examine_again();
        }
    }

    /// Lets the examiner choose another plan, and begin with it at once, or once the leg is his or hers.
    fn examine_again(&mut self) {
        let Some(examiner) = &mut self.examiner else {
            return;
        };
        match self.stage {
            Stage::Led(_) => examiner.await_leg(),
            Stage::Moved => {
                let motion = examiner.go_on(self.walk.now());
                self.turn_to(motion);
            }
            Stage::Held(_) => {}
        }
    }

    /// Takes, moves or gives back the leg, as the hand's target says.
    fn follow_hand(&mut self, target_rad: Option<f64>, plant: &mut Plant<Bridge>) {
        match (target_rad, &mut self.stage) {
            (Some(target_rad), Stage::Held(path)) => path.aim(target_rad),
            (Some(target_rad), Stage::Led(_) | Stage::Moved) => self.take(target_rad, plant),
            (None, Stage::Held(_)) => self.give_back(plant),
            (None, Stage::Led(_) | Stage::Moved) => {}
        }
    }

    /// Lets the hand hold the leg where it is, and move it from there.
    fn take(&mut self, target_rad: f64, plant: &mut Plant<Bridge>) {
        let leg = plant.leg();
        plant.hold_by(|chain| hand::boundary(leg, chain));
        self.before_s += self.walk.time_s();
        self.walk = Walk::new(Motion::rest(leg.angle_rad), self.step_s);
        let mut path = hand::path(leg);
        path.aim(target_rad);
        self.stage = Stage::Held(path);
    }

    /// Lets the scene hold the leg again: its examiner goes on from there, or it is led to the scene's motion.
    fn give_back(&mut self, plant: &mut Plant<Bridge>) {
        let (scene, leg) = (&self.scene, plant.leg());
        plant.hold_by(|chain| scene.boundary(TICK_S, leg, chain));
        self.stage = Stage::Moved;
        if let Some(examiner) = &mut self.examiner {
            self.walk = Walk::new(examiner.go_on(leg), self.step_s);
        } else if scene.is_held() {
            let (lead_in, way) = LeadIn::back(leg, scene);
            self.stage = Stage::Led(lead_in);
            self.walk = Walk::new(way, self.step_s);
        }
    }
}
