//! The study of effects against the runner: what it says of a variant is what
//! two runs say, and the smallest set is the smallest.

use crepitus_plant::effects::{EFFECTS, find};
use crepitus_scene::run::{FELT_COLUMN, Observer, columns};
use crepitus_scene::trace::{EventRecord, SymptomEvent};
use crepitus_scene::{Overrides, Scene};
use crepitus_studies::effects::row::Outcome;
use crepitus_studies::effects::variant::Change;
use crepitus_studies::effects::{EffectsError, EffectsStudy, Plan, run};
use crepitus_studies::{Cancelled, Watcher};
use std::convert::Infallible;
use std::path::Path;

struct Patient {
    last: f64,
}

impl Watcher for Patient {
    fn progress(&mut self, fraction: f64) -> Result<(), Cancelled> {
        assert!(fraction >= self.last && fraction <= 1.0);
        self.last = fraction;
        Ok(())
    }
}

fn scene(effects: &str) -> Scene {
    let text = format!(
        "version = 1\ntitle = \"small\"\nduration_s = 0.4\n[motion]\nkind = \"sine\"\namplitude_deg = 20\n\
         frequency_hz = 1.3\n[solver]\nkind = \"exact-events\"\nstep_s = 5e-5\nprecision = \"f32\"\n{effects}"
    );
    Scene::parse(Path::new("small.toml"), &text, &Overrides::default()).unwrap()
}

fn study(scene: &Scene, tolerance: Option<&str>) -> EffectsStudy {
    let plan = Plan {
        scene: scene.clone(),
        tolerance: tolerance.map(|t| t.parse().unwrap()),
    };
    run(&plan, &mut Patient { last: 0.0 }).unwrap()
}

/// Keeps the torque at the hand and counts events.
struct Hand {
    place: usize,
    torque: Vec<f64>,
    events: u64,
}

impl Observer for Hand {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        self.torque.push(values[self.place]);
        Ok(())
    }

    fn event(&mut self, _: &EventRecord) -> Result<(), Infallible> {
        self.events += 1;
        Ok(())
    }

    fn symptom(&mut self, event: &SymptomEvent) -> Result<(), Infallible> {
        self.events += u64::from(!event.word.is_of_play());
        Ok(())
    }
}

fn hand(scene: &Scene) -> (Vec<f64>, u64) {
    let name = if scene.is_coupled() {
        FELT_COLUMN
    } else {
        "torque_nm"
    };
    let mut hand = Hand {
        place: columns(scene).iter().position(|c| c.name == name).unwrap(),
        torque: Vec::new(),
        events: 0,
    };
    crepitus_scene::run(scene, &mut hand).unwrap();
    (hand.torque.split_off(1), hand.events)
}

fn apart(a: &[f64], b: &[f64]) -> (f64, f64) {
    assert_eq!(a.len(), b.len());
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect();
    let squares: f64 = differences.iter().map(|d| d * d).sum();
    #[expect(clippy::cast_precision_loss, reason = "a few thousand")]
    let rms = (squares / a.len() as f64).sqrt();
    (rms, differences.into_iter().fold(0.0, f64::max))
}

const SMALL: &str = "[effects.crepitus]\npreset = \"coarse\"\n[effects.encoder]\n[effects.drivetrain]\n\
                     [effects.friction-compensation]\n[effects.limb]\n";

#[test]
fn a_symptom_that_is_left_out_takes_its_torque_and_its_events_along() {
    let knee = scene(
        "[effects.range-limit]\nextension_limit_deg = -5\nflexion_limit_deg = 15\n[effects.lead-pipe]\n\
         [effects.texture]\n[effects.clasp-knife]\nonset_deg = 5\nrelease_deg = 12\nrearm_deg = 2\n",
    );
    let study = study(&knee, None);
    let whole = study.whole().unwrap().ran().unwrap();
    let (torque, events) = hand(&knee);
    assert_eq!(whole.events, events);
    assert!(events > 20, "{events}");
    for effect in ["range-limit", "lead-pipe", "texture", "clasp-knife"] {
        let row = study.rows.iter().find(|r| r.effect == effect).unwrap();
        let left = knee.without(find(effect).unwrap()).unwrap();
        let (without, fewer) = hand(&left);
        let added = row.added().unwrap();
        let (rms_nm, peak_nm) = apart(&torque, &without);
        assert!((added.rms_nm - rms_nm).abs() <= 1e-12 * rms_nm, "{row:?}");
        assert_eq!(added.peak_nm, peak_nm);
        assert!(rms_nm > 0.01, "{effect}: {rms_nm}");
        let own = i64::try_from(events).unwrap() - i64::try_from(fewer).unwrap();
        assert_eq!(added.events, own, "{effect}");
        // Rigidity has none of its own.
        assert_eq!(own == 0, effect == "lead-pipe", "{effect}: {own}");
        assert!(added.states > 0, "{row:?}");
    }
}

#[test]
fn every_variant_is_what_two_runs_say() {
    let scene = scene(SMALL);
    let study = study(&scene, None);
    assert_eq!(study.rows.len(), 1 + EFFECTS.len());
    assert_eq!((study.ticks, study.tick_s), (8000, 5e-5));
    let (whole, events) = hand(&scene);
    let own = study.whole().unwrap();
    assert_eq!(own.ran().unwrap().events, events);
    assert!(own.ran().unwrap().added.is_none());
    for row in &study.rows[1..] {
        let effect = find(row.effect).unwrap();
        let (variant, sign) = match row.change {
            Change::Without => (scene.without(effect).unwrap(), -1.0),
            Change::With => (scene.with(effect).unwrap(), 1.0),
            Change::Scene => panic!("the scene twice"),
        };
        let (torque, found) = hand(&variant);
        let ran = row.ran().unwrap();
        let added = row.added().unwrap();
        let (rms_nm, peak_nm) = apart(&torque, &whole);
        assert!((added.rms_nm - rms_nm).abs() <= 1e-12 * rms_nm, "{row:?}");
        assert_eq!(added.peak_nm, peak_nm, "{row:?}");
        assert_eq!(ran.events, found);
        let more = if row.change == Change::With {
            i128::from(found) - i128::from(events)
        } else {
            i128::from(events) - i128::from(found)
        };
        assert_eq!(i128::from(added.events), more);
        assert!(row.ns_per_step > 0.0);
        // Never a cost that is not above what the timings can tell.
        let cost = sign * (row.ns_per_step - own.ns_per_step);
        let resolution = added.time.ns_resolution;
        assert!(resolution > 0.0, "{row:?}");
        match added.time.ns_per_step {
            Some(ns) => assert!((ns - cost).abs() < 1e-9 && ns > resolution, "{row:?}"),
            None => assert!(cost <= resolution, "{row:?}"),
        }
        // A tick's peak is no more than all of it.
        assert!(added.peak_nm >= added.rms_nm && ran.torque.peak_nm >= ran.torque.rms_nm);
    }
    let named = |effect| study.rows.iter().find(|r| r.effect == effect).unwrap();
    assert_eq!(
        named("drivetrain").name(),
        "without drivetrain (and friction-compensation)"
    );
    assert_eq!(named("motor").name(), "with motor");
    assert_eq!(named("crepitus").added().unwrap().states, 2);
    assert_eq!(named("motor").added().unwrap().states, 2);
    // The weight of the leg is most of the torque at the hand, and nothing of what vibrates.
    let rms = |row: &&crepitus_studies::effects::Row| row.added().map_or(0.0, |added| added.rms_nm);
    let heaviest = study.rows.iter().max_by(|a, b| rms(a).total_cmp(&rms(b)));
    assert_eq!(heaviest.unwrap().effect, "limb");
    let felt = study.by_vibration();
    assert_eq!(felt.len(), study.rows.len() - 1);
    assert!(felt.is_sorted_by(|a, b| a.1.abs() >= b.1.abs()), "{felt:?}");
    let felt = study.hand_torque.as_ref().unwrap();
    assert_eq!(felt.variants.len(), 5);
    for variant in &felt.variants {
        assert_eq!(variant.torque_nm.len(), felt.scene_nm.len());
        assert_eq!(variant.torque_nm[0].0, felt.scene_nm[0].0);
    }
    // A slow course that both lines lack drops out of their difference.
    let (own, other) = (felt.scene_nm[100], felt.variants[0].torque_nm[100]);
    let at_s = own.0;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a place among a few thousand"
    )]
    let tick = (at_s / 5e-5).round() as usize - 1;
    let (limbless, _) = hand(&scene.without(find("limb").unwrap()).unwrap());
    let apart_nm = whole[tick] - limbless[tick];
    assert!((own.1 - other.1 - apart_nm).abs() < 1e-9, "{apart_nm}");
}

#[test]
fn a_joint_alone_is_what_the_hand_feels() {
    let scene = scene("[effects.crepitus]\n");
    let study = study(&scene, None);
    let (whole, _) = hand(&scene);
    let without = &study.rows[1];
    assert_eq!(
        (without.change, without.effect),
        (Change::Without, "crepitus")
    );
    let rms = apart(&whole, &vec![0.0; whole.len()]).0;
    let added = without.added().unwrap();
    assert!((added.rms_nm - rms).abs() < 1e-12);
    assert_eq!(without.ran().unwrap().torque.rms_nm, 0.0);
    assert!((study.whole().unwrap().ran().unwrap().torque.rms_nm - rms).abs() < 1e-12);
    // Even a scene without any effect has variants.
    let bare = self::scene("");
    assert_eq!(self::study(&bare, None).rows.len(), 1 + EFFECTS.len());
}

#[test]
fn the_smallest_set_is_within_and_no_smaller_one_is() {
    let scene = scene(SMALL);
    let (whole, events) = hand(&scene);
    let limit = 0.2;
    let study = study(&scene, Some("torque=0.2,events=0.5"));
    let answer = study.answer.as_ref().unwrap();
    // Every set that has what it needs, by brute force.
    let effects = scene.effects();
    let mut within: Vec<Vec<&str>> = Vec::new();
    let mut sets = 0;
    for set in 0..1_u32 << effects.len() {
        let mut part = scene.clone();
        for (i, effect) in effects.iter().enumerate() {
            if set & (1 << i) == 0 {
                part = part.without(effect).unwrap();
            }
        }
        let names: Vec<&str> = part.effects().iter().map(|e| e.name).collect();
        if names.len() != usize::try_from(set.count_ones()).unwrap() {
            continue;
        }
        sets += 1;
        let (torque, found) = if part.has("crepitus") || part.is_coupled() {
            hand(&part)
        } else {
            (vec![0.0; whole.len()], 0)
        };
        if apart(&torque, &whole).0 <= limit && found.abs_diff(events) * 2 <= events {
            within.push(names);
        }
    }
    assert_eq!(answer.sets, sets);
    let least = within.iter().map(Vec::len).min().unwrap();
    let mut smallest: Vec<_> = within.into_iter().filter(|s| s.len() == least).collect();
    let mut told: Vec<_> = answer.others.iter().map(|s| s.effects.clone()).collect();
    told.push(answer.chosen.effects.clone());
    smallest.sort();
    told.sort();
    assert_eq!(told, smallest);
    assert!(least < effects.len());
    assert!(answer.chosen.difference.rms_nm <= limit);
    assert_eq!(answer.kept.len() + answer.dropped.len(), effects.len());
    for kept in &answer.kept {
        // Otherwise a smaller set would do.
        let d = kept.difference.unwrap();
        assert!(d.rms_nm > limit || d.events_relative > 0.5, "{kept:?}");
    }
    for dropped in &answer.dropped {
        let row = study.rows.iter().find(|r| r.effect == dropped.effect);
        let alone = row.unwrap().added().unwrap();
        assert_eq!(dropped.difference.unwrap().rms_nm, alone.rms_nm);
    }
}

#[test]
fn a_variant_that_cannot_run_is_a_row_that_says_why() {
    // rk4 has no meaning under the default convention, so the joint of a
    // variant is refused.
    let text = "version = 1\ntitle = \"no joint\"\nduration_s = 0.05\n[motion]\nkind = \"constant\"\n\
                velocity_rad_s = 1.0\n[solver]\nkind = \"rk4\"\nstep_s = 5e-5\n[effects.drivetrain]\n";
    let scene = Scene::parse(Path::new("a.toml"), text, &Overrides::default()).unwrap();
    let study = study(&scene, None);
    let failed: Vec<_> = study
        .rows
        .iter()
        .filter(|r| matches!(r.outcome, Outcome::Failed { .. }))
        .collect();
    let names: Vec<_> = failed.iter().map(|r| r.effect).collect();
    assert_eq!(names, ["crepitus", "bone-shaping"]);
    for row in failed {
        assert!(row.failure().unwrap().len() > 20, "{row:?}");
        assert!(row.ns_per_step.is_nan());
    }
}

#[test]
fn a_watcher_ends_it_at_any_time() {
    struct Impatient(u32);
    impl Watcher for Impatient {
        fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
            self.0 = self.0.checked_sub(1).ok_or(Cancelled)?;
            Ok(())
        }
    }
    let plan = Plan {
        scene: scene(SMALL),
        tolerance: Some("torque=1e-3".parse().unwrap()),
    };
    for calls in [0, 2, 20, 70] {
        assert!(matches!(
            run(&plan, &mut Impatient(calls)),
            Err(EffectsError::Cancelled(_))
        ));
    }
}
