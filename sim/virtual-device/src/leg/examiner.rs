//! The examiner of a simulated device: chooses the motion by the knee that the device renders.
//!
//! | step | motion |
//! |---|---|
//! | slow | beyond both ends of the range at 45 °/s; at 35 °/s where a muscle must not notice |
//! | fast | a stretch at 200 °/s, or half as fast again as its sign needs |
//! | hold | the same past the angle of clonus, held for three seconds |
//! | drop | a fall that the hand goes along with, at 150 °/s |
//! | any of a knee whose signs any movement shows, or that has none | the strokes of the scene |
//!
//! What a knee needs follows from its own parameters: see [`signs`]. One that is stiffer than gear and motor
//! bear for long is bent a little at a time, and let go between. Angles are those of the scene, and of a
//! device whose zero was set with the leg straight.
//!
//! In a blind trial the motion must not tell the knee: all get the same plan, which is in `blind.rs`.

mod blind;

use super::movement::{Movement, rest, stop, whole_ticks};
use crepitus_knee::examination::{Rule, Sign, Step, signs};
use crepitus_model::render::effects::EffectSettings;
use crepitus_plant::Motion;
use crepitus_plant::chain::Body;
use crepitus_plant::motion::Strokes;
use crepitus_scene::Scene;
use std::collections::VecDeque;
use std::iter::once;

/// Speeds, °/s: a slow movement, one that no muscle notices, the way back, a fall, a stretch at least and at most.
const SLOW_DEG_S: f64 = 45.0;
const UNNOTICED_DEG_S: f64 = 35.0;
const BACK_DEG_S: f64 = 60.0;
const FALL_DEG_S: f64 = 150.0;
const STRETCH_DEG_S: [f64; 2] = [200.0, 300.0];

/// Speed of a stretch, as a multiple of the speed from which its sign appears.
const MARGIN: f64 = 1.5;

/// Angles between which muscles are stretched, °; the slow stretch ends sooner.
const STRETCH_DEG: [f64; 2] = [10.0, 112.0];
const SLOW_STRETCH_DEG: [f64; 2] = [20.0, 100.0];

/// Way beyond an end of the range, °, and the furthest angles, where the brace has its torque still.
const BEYOND_DEG: f64 = 5.0;
const FURTHEST_DEG: [f64; 2] = [-1.0, 118.0];

/// Way before and beyond the angle of clonus, °, and the time for which it is held, s.
const HOLD_DEG: [f64; 2] = [30.0, 15.0];
const HOLD_S: f64 = 3.0;

/// Rests, s: at an end, before a stretch, after one, and of a knee that is let go.
const END_S: f64 = 0.5;
const BEFORE_S: f64 = 0.3;
const AFTER_S: f64 = 0.2;
const LET_GO_S: f64 = 1.2;

/// Rigidity up to which whole strokes are no overload, N·m: gear and motor bear 3.2 for ever, and of the
/// friction 0.4 are compensated while the leg moves.
const BORNE_NM: f64 = 3.5;

/// Angle by which cuff and leg give under such a torque, at most, °.
const GIVE_DEG: f64 = 1.0;

/// A little of the way, °, towards the middle of the range, and the speed with which such a knee is let go, °/s.
const BIT_DEG: f64 = 16.0;
const MIDDLE_DEG: f64 = 60.0;
const LET_GO_DEG_S: f64 = 30.0;

/// The examiner.
pub(super) struct Examiner {
    /// Strokes of the scene.
    usual: Strokes,
    /// Effects of the knee, and whether the imaginary object is on.
    knee: (EffectSettings, bool),
    /// Whether a trial is blind, in which every knee is moved alike.
    is_blind: bool,
    /// Movements before the plan.
    first: VecDeque<Movement>,
    plan: Vec<Movement>,
    /// Place of the next movement in the plan.
    next: usize,
    /// Angle at which the movement under way ends, rad.
    at_rad: f64,
    /// Ticks until then.
    ticks: u32,
}

impl Examiner {
    /// The examiner of a scene, before the first movement; `None` where the scene has none.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let Motion::Strokes(usual) = scene.motion else {
            return None;
        };
        if !scene.has_examiner || !scene.is_held() {
            return None;
        }
        let mut examiner = Self {
            usual,
            knee: (scene.effect_settings(), scene.crepitus.is_some()),
            is_blind: false,
            first: VecDeque::new(),
            plan: Vec::new(),
            next: 0,
            at_rad: usual.from_rad,
            ticks: 0,
        };
        if scene.begins_straight {
            examiner.await_leg();
        } else {
            examiner.choose(0.0);
        }
        Some(examiner)
    }

    /// Chooses the plan for a leg that is led from straight to where it begins.
    pub(super) fn await_leg(&mut self) {
        self.choose(self.usual.from_rad.signum());
    }

    /// Chooses the plan for the knee, for a leg that comes to where it begins in this sense; 0 for one that rests.
    fn choose(&mut self, sense: f64) {
        let (effects, grates) = &self.knee;
        let from_deg = self.at_rad.to_degrees();
        let let_go = |deg: f64| Movement::new(from_deg - sense * deg, LET_GO_DEG_S, LET_GO_S);
        self.next = 0;
        if self.is_blind {
            let eases = let_go(blind::EASE_DEG);
            self.plan = blind::plan();
            self.first = once(eases).chain(blind::way_to(eases)).collect();
            return;
        }
        let stiff_deg = stiff_deg(effects);
        self.plan = match stiff_deg {
            Some(back_deg) => bit_by_bit(from_deg, back_deg).into(),
            None => plan(effects, *grates, &self.usual),
        };
        let lets_go = stiff_deg.filter(|_| sense != 0.0).map(let_go);
        self.first = lets_go.into_iter().collect();
    }

    /// Takes note of the knee. Returns whether a plan has to be chosen for it: it is another one than before, and no
    /// secret.
    pub(super) fn meet(&mut self, knee: &(EffectSettings, bool)) -> bool {
        let is_another = *knee != self.knee;
        self.knee = *knee;
        is_another && !self.is_blind
    }

    /// Takes note of whether a trial is blind. Returns whether that has changed, so that a plan has to be chosen.
    pub(super) fn set_blind(&mut self, is_blind: bool) -> bool {
        std::mem::replace(&mut self.is_blind, is_blind) != is_blind
    }

    /// Goes on from where a leg is, with the plan for the knee from its beginning. Returns the motion that slows the leg
    /// down to rest.
    pub(super) fn go_on(&mut self, now: Body) -> Motion {
        let (slows, ticks, rests_at_rad) = stop(now);
        self.at_rad = rests_at_rad;
        self.ticks = ticks + whole_ticks(BEFORE_S);
        let omega = now.omega_rad_s;
        self.choose(if omega == 0.0 { 0.0 } else { omega.signum() });
        Motion::Sequence(vec![slows, rest(slows.end_s, rests_at_rad)])
    }

    /// Begins the next movement, where the last one ends.
    pub(super) fn begin(&mut self) -> Motion {
        let movement = self.first.pop_front().or_else(|| {
            let place = self.next % self.plan.len().max(1);
            self.next = place + 1;
            self.plan.get(place).copied()
        });
        let Some(movement) = movement else {
            return Motion::rest(self.at_rad);
        };
        let (motion, ticks) = movement.motion(self.at_rad);
        (self.at_rad, self.ticks) = (movement.to_rad, ticks);
        motion
    }

    /// A tick is over. Returns the motion that begins with the next one, if another does.
    pub(super) fn tick(&mut self) -> Option<Motion> {
        self.ticks = self.ticks.saturating_sub(1);
        (self.ticks == 0).then(|| self.begin())
    }
}

/// Travel by which a knee is let go that is stiffer than motor and gear bear for long, °: over which its resistance
/// builds up, and by which cuff and leg have given. `None` of other knees.
fn stiff_deg(effects: &EffectSettings) -> Option<f64> {
    let pipe = effects.lead_pipe?;
    (pipe.torque_nm > BORNE_NM).then_some(pipe.presliding_deg + GIVE_DEG)
}

/// Movements for a knee, one after another and again.
fn plan(effects: &EffectSettings, grates: bool, usual: &Strokes) -> Vec<Movement> {
    let signs: Vec<Sign> = signs(effects, grates).collect();
    let mut plan = Vec::new();
    if signs.is_empty() || signs.iter().any(|sign| sign.step == Step::Slow) {
        plan.extend(slow(&signs, usual));
    }
    for sign in &signs {
        match sign.rule {
            Rule::Stretch { .. } => plan.extend(stretches(sign)),
            Rule::Hold { angle_deg, .. } => plan.extend(hold(sign, angle_deg)),
            Rule::Move { .. } | Rule::Reach { .. } => {}
        }
    }
    plan
}

/// Slowly beyond each end; without one beyond them, the strokes of the scene.
fn slow(signs: &[Sign], usual: &Strokes) -> [Movement; 2] {
    let ends = [usual.from_rad, usual.to_rad].map(f64::to_degrees);
    let [mut low, mut high] = ends;
    for sign in signs {
        if let Rule::Reach { angle_deg } = sign.rule {
            let [lowest, highest] = FURTHEST_DEG;
            let beyond_deg = (angle_deg + sign.sense * BEYOND_DEG).clamp(lowest, highest);
            (low, high) = (low.min(beyond_deg), high.max(beyond_deg));
        }
    }
    if [low, high] == ends {
        return [usual.to_rad, usual.from_rad].map(|to_rad| Movement {
            to_rad,
            peak_rad_s: usual.peak_speed_rad_s,
            rest_s: usual.pause_s,
        });
    }
    [high, low].map(|to_deg| Movement::new(to_deg, SLOW_DEG_S, END_S))
}

/// Slowly, fast, and let fall, each from where the muscle is short.
fn stretches(sign: &Sign) -> [Movement; 7] {
    let along = |[low, high]: [f64; 2]| {
        if sign.sense > 0.0 {
            [low, high]
        } else {
            [high, low]
        }
    };
    let [short_deg, long_deg] = along(STRETCH_DEG);
    let [_, slow_deg] = along(SLOW_STRETCH_DEG);
    let back = Movement::new(short_deg, BACK_DEG_S, BEFORE_S);
    [
        back,
        Movement::new(slow_deg, UNNOTICED_DEG_S, END_S),
        back,
        Movement::new(long_deg, stretch_deg_s(sign), AFTER_S),
        back,
        Movement::new(long_deg, FALL_DEG_S, AFTER_S),
        back,
    ]
}

/// Fast past an angle, and held.
fn hold(sign: &Sign, angle_deg: f64) -> [Movement; 3] {
    let [before_deg, beyond_deg] = HOLD_DEG;
    let [lowest, highest] = FURTHEST_DEG;
    let short_deg = (angle_deg - sign.sense * before_deg).clamp(lowest, highest);
    let long_deg = (angle_deg + sign.sense * beyond_deg).clamp(lowest, highest);
    let back = Movement::new(short_deg, BACK_DEG_S, BEFORE_S);
    [
        back,
        Movement::new(long_deg, stretch_deg_s(sign), HOLD_S),
        back,
    ]
}

fn stretch_deg_s(sign: &Sign) -> f64 {
    let [least, most] = STRETCH_DEG_S;
    (MARGIN * sign.appears_from_deg_s()).clamp(least, most)
}

/// A little to and fro, each time let go by some degrees.
fn bit_by_bit(from_deg: f64, back_deg: f64) -> [Movement; 4] {
    let sense = if from_deg < MIDDLE_DEG { 1.0 } else { -1.0 };
    let to =
        |deg: f64, deg_s: f64, rest_s: f64| Movement::new(from_deg + sense * deg, deg_s, rest_s);
    [
        to(BIT_DEG, BACK_DEG_S, 0.0),
        to(BIT_DEG - back_deg, LET_GO_DEG_S, LET_GO_S),
        to(0.0, BACK_DEG_S, 0.0),
        to(back_deg, LET_GO_DEG_S, LET_GO_S),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_scene::preset;

    const USUAL: Strokes = Strokes {
        from_rad: 0.2,
        to_rad: 1.4,
        peak_speed_rad_s: 1.0,
        pause_s: 0.3,
    };

    fn of(name: &str) -> Vec<Movement> {
        let preset = preset::find(name).unwrap();
        let effects = preset.effect_settings();
        plan(&effects, preset.joint().is_some(), &USUAL)
    }

    #[test]
    fn a_knee_that_any_movement_shows_gets_the_strokes_of_the_scene() {
        let healthy = plan(&EffectSettings::default(), false, &USUAL);
        let to = |to_rad| Movement {
            to_rad,
            peak_rad_s: 1.0,
            rest_s: 0.3,
        };
        assert_eq!(healthy, [to(1.4), to(0.2)]);
        for name in ["coarse", "texture-fine", "updrs-3-lead-pipe"] {
            assert_eq!(of(name), healthy, "{name}");
        }
    }

    #[test]
    fn ends_are_passed_and_no_angle_is_out_of_reach() {
        for preset in preset::shipped() {
            for movement in of(&preset.name) {
                let deg = movement.to_rad.to_degrees();
                assert!((-1.1..118.1).contains(&deg), "{}: {deg}", preset.name);
                assert!(movement.peak_rad_s < 5.3, "{}", preset.name);
            }
        }
        let highest = |name| {
            let angles = of(name).into_iter().map(|m| m.to_rad.to_degrees());
            angles.fold(0.0, f64::max)
        };
        assert!((highest("end-feel-firm") - 111.0).abs() < 0.1);
        assert!((highest("contracture-severe") - 118.0).abs() < 1e-9);
    }

    #[test]
    fn another_knee_begins_with_the_next_movement_from_where_the_leg_is() {
        let scene = crepitus_scene::shipped::examination().unwrap();
        let mut examiner = Examiner::of(&scene).unwrap();
        let first = examiner.begin();
        assert_eq!(first.at(0.0).phi_rad, scene.start().angle_rad);
        // 2.1875 s and a rest of 0.3 s.
        let waited = (1..).find_map(|tick| examiner.tick().map(|motion| (tick, motion)));
        let (ticks, back) = waited.unwrap();
        assert_eq!(ticks, 49_750);
        // Another knee, while the leg is on its way back.
        let clonus = preset::find("scats-3-clonus").unwrap();
        let knee = (clonus.effect_settings(), false);
        let at = |motion: &Motion, time_s: f64| {
            let state = motion.at(time_s);
            Body {
                angle_rad: state.phi_rad,
                omega_rad_s: state.omega_rad_s,
            }
        };
        let now = at(&back, 1.0);
        assert!(examiner.meet(&knee));
        let stop = examiner.go_on(now);
        assert_eq!(at(&stop, 0.0), now);
        let rests = at(&stop, 60.0);
        assert!(rests.omega_rad_s == 0.0 && rests.angle_rad < now.angle_rad);
        assert!(!examiner.meet(&knee), "the same knee again");
        let ends_deg = [30_f64, 75.0, 30.0].map(|deg| {
            let motion = (0..).find_map(|_| examiner.tick()).unwrap();
            at(&motion, 60.0).angle_rad.to_degrees() - deg
        });
        assert!(ends_deg.iter().all(|off| off.abs() < 1e-9), "{ends_deg:?}");
    }

    /// Bent a little, and let go by 2.5°: gear and motor cool down meanwhile.
    #[test]
    fn a_knee_that_is_too_stiff_is_let_go_before_anything_else() {
        let scene = crepitus_scene::shipped::examination().unwrap();
        let mut examiner = Examiner::of(&scene).unwrap();
        let stiff = preset::find("mas-4-lead-pipe").unwrap().effect_settings();
        assert!(examiner.meet(&(stiff, false)));
        examiner.await_leg();
        let mut motion = examiner.begin();
        for end_deg in [7.5, 26.0, 23.5, 10.0, 12.5, 26.0] {
            let deg = motion.at(60.0).phi_rad.to_degrees();
            assert!((deg - end_deg).abs() < 1e-9, "{deg} for {end_deg}");
            motion = (0..).find_map(|_| examiner.tick()).unwrap();
        }
    }

    /// Whether it is stiff, needs speed, or is healthy; also if it comes in the middle of the plan.
    #[test]
    fn in_a_blind_trial_every_knee_gets_the_same_plan() {
        let scene = crepitus_scene::shipped::examination().unwrap();
        let knee = |name: &str| (preset::find(name).unwrap().effect_settings(), false);
        let plan_of = |name: &str| {
            let mut examiner = Examiner::of(&scene).unwrap();
            examiner.begin();
            assert!(examiner.set_blind(true) && !examiner.set_blind(true));
            examiner.go_on(Body::default());
            assert!(!examiner.meet(&knee(name)), "{name}");
            examiner.await_leg();
            (examiner.first.clone(), examiner.plan.clone(), examiner)
        };
        let (first, plan, _) = plan_of("coarse");
        assert!(plan.len() > 20, "{}", plan.len());
        for name in ["mas-4-lead-pipe", "scats-3-clonus", "contracture-severe"] {
            let (own_first, own, mut examiner) = plan_of(name);
            assert_eq!((own_first, own), (first.clone(), plan.clone()), "{name}");
            assert!(examiner.set_blind(false));
            examiner.go_on(Body::default());
            assert_ne!(examiner.plan, plan, "{name}");
        }
    }

    #[test]
    fn a_scene_without_an_examiner_has_its_motion() {
        let scene = crepitus_scene::shipped::examination().unwrap();
        let plain = Scene {
            has_examiner: false,
            ..scene
        };
        assert!(Examiner::of(&plain).is_none());
    }
}
