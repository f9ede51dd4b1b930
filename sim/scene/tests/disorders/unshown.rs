//! Torque that a scene asks for and that does not reach the motor: what the energy tank holds
//! back, and what is beyond a device's largest torque.

use crepitus_model::render::Limit;
use crepitus_scene::run::{HELD_BACK_COLUMN, columns};
use crepitus_scene::trace::{SymptomEvent, Word};
use crepitus_scene::{Observer, Overrides, Scene, Summary, run};
use std::convert::Infallible;
use std::path::Path;

/// A knee that is stretched and let back, with strokes as an examiner makes them.
const STROKES: &str = r#"
version = 1
title = "Clonus that the energy tank holds back"
duration_s = 6.0
[motion]
kind = "strokes"
from_deg = 20.0
to_deg = 130.0
peak_speed_deg_s = 220.0
pause_s = 0.3
"#;

const CLONUS: &str = "[effects.clonus]\npreset = \"scats-2-clonus\"\n";

const TICKS: &str = "[solver]\nkind = \"exact-events\"\nstep_s = 5e-5\nprecision = \"f32\"\n";

const REFERENCE: &str = "[solver]\nkind = \"reference\"\n[output]\ntrace_step_s = 5e-5\n";

struct Unshown {
    names: Vec<&'static str>,
    rows: Vec<Vec<f64>>,
    events: Vec<SymptomEvent>,
}

impl Observer for Unshown {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        self.rows.push(values.to_vec());
        Ok(())
    }

    fn symptom(&mut self, event: &SymptomEvent) -> Result<(), Infallible> {
        self.events.push(*event);
        Ok(())
    }
}

impl Unshown {
    fn column(&self, name: &str) -> impl Iterator<Item = f64> {
        let place = self.names.iter().position(|n| *n == name);
        let place = place.unwrap_or_else(|| panic!("{name} of {:?}", self.names));
        self.rows.iter().map(move |row| row[place])
    }

    /// The largest torques that were asked for and shown of the beats that were held back, N·m.
    fn held_back(&self) -> Vec<(Word, f64, f64)> {
        let is_one = |e: &&SymptomEvent| matches!(e.word, Word::Weak | Word::Unfelt);
        let of = |e: &SymptomEvent| (e.word, e.torque_before_nm, e.torque_after_nm);
        self.events.iter().filter(is_one).map(of).collect()
    }
}

fn render(parts: &[&str], as_device: bool) -> (Unshown, Summary) {
    let text = parts.concat();
    let overrides = Overrides {
        as_device,
        ..Overrides::default()
    };
    let scene = Scene::parse(Path::new("unshown.toml"), &text, &overrides)
        .unwrap_or_else(|error| panic!("{error}\n{text}"));
    let mut found = Unshown {
        names: columns(&scene).iter().map(|c| c.name).collect(),
        rows: Vec::new(),
        events: Vec::new(),
    };
    let Ok(summary) = run(&scene, &mut found) else {
        panic!("it did not run:\n{text}");
    };
    (found, summary)
}

/// The one warning with these words.
fn warning<'a>(summary: &'a Summary, words: &str) -> &'a str {
    let with: Vec<_> = summary
        .warnings
        .iter()
        .filter(|w| w.contains(words))
        .collect();
    assert_eq!(with.len(), 1, "{words}: {:?}", summary.warnings);
    with[0]
}

#[test]
fn beats_that_the_tank_holds_back_are_marked_counted_and_warned_of() {
    for (solver, as_device) in [(TICKS, false), (TICKS, true), (REFERENCE, false)] {
        let (found, summary) = render(&[STROKES, solver, CLONUS], as_device);
        let held_back = found.held_back();
        println!("{solver} {as_device} {held_back:?} {:?}", summary.tank);
        let beats = found.events.iter().filter(|e| e.word == Word::Beat);
        let beats = u64::try_from(beats.count()).expect("few");
        let tank = summary.tank.as_ref().expect("clonus gives energy");
        // In each of two stretches a beat of about half the height, and one of next to nothing.
        assert_eq!(held_back.len(), 4);
        for pair in held_back.chunks(2) {
            let [(weak, asked_nm, weak_nm), (unfelt, _, unfelt_nm)] = pair[..] else {
                panic!("{held_back:?}");
            };
            assert_eq!((weak, unfelt), (Word::Weak, Word::Unfelt));
            assert!((asked_nm - 1.5).abs() < 1e-3, "{asked_nm}");
            assert!((0.75..0.8).contains(&weak_nm), "{weak_nm}");
            assert!((0.05..0.15).contains(&unfelt_nm), "{unfelt_nm}");
        }
        assert_eq!((tank.weak, tank.unfelt), (2, 2));
        assert!(
            (beats - 1..=beats).contains(&tank.pushes),
            "{beats} {tank:?}"
        );
        let first_s = tank.first_s.expect("held back");
        let words = format!("from t = {first_s:.4} s on");
        let text = warning(&summary, "energy tank held back torque of clonus");
        assert!(
            text.contains(&words) && text.contains("2 were weak and 2 not felt"),
            "{text}"
        );
        assert_eq!(solver == REFERENCE, text.contains("continuous law"));
        // The column has it from that time on, and never more than all.
        let times = found.column("t_s").zip(found.column(HELD_BACK_COLUMN));
        let shares: Vec<_> = times.filter(|(_, share)| *share != 0.0).collect();
        assert!((shares[0].0 - first_s).abs() < 1e-4);
        assert!(shares.iter().all(|(_, share)| (0.0..=1.0).contains(share)));
        let most = shares.iter().map(|s| s.1).fold(0.0, f64::max);
        assert!((most - tank.most_share).abs() < 1e-3);
        if as_device {
            let limits = found.column("limit").zip(found.column(HELD_BACK_COLUMN));
            for (limit, share) in limits {
                let is_tank = limit == f64::from(Limit::Tank as u8);
                assert_eq!(is_tank, share > 0.0, "limit {limit}, share {share}");
            }
        }
    }
}

#[test]
fn beats_in_full_are_neither_marked_nor_warned_of() {
    let still = "version = 1\ntitle = \"a short stretch\"\nduration_s = 1.2\n[motion]\nkind = \"strokes\"\n\
                 from_deg = 20.0\nto_deg = 130.0\npeak_speed_deg_s = 220.0\npause_s = 0.9\n";
    for (solver, as_device) in [(TICKS, true), (TICKS, false), (REFERENCE, false)] {
        let (found, summary) = render(&[still, solver, CLONUS], as_device);
        assert!(found.held_back().is_empty());
        assert!(found.column(HELD_BACK_COLUMN).all(|share| share == 0.0));
        let tank = summary.tank.expect("clonus gives energy");
        assert!(tank.pushes > 0 && tank.first_s.is_none(), "{tank:?}");
        assert!(summary.warnings.is_empty(), "{:?}", summary.warnings);
    }
    let (found, summary) = render(&[still, TICKS, "[effects.lead-pipe]\n"], false);
    assert!(!found.names.contains(&HELD_BACK_COLUMN) && summary.tank.is_none());
}

#[test]
fn the_ladders_tank_converges_to_the_continuous_law_with_its_step() {
    let fine = "[solver]\nkind = \"reference\"\n[output]\ntrace_step_s = 2e-4\n";
    let (truth, _) = render(&[STROKES, fine, CLONUS], false);
    let errors = [2e-4, 1e-4, 5e-5, 2.5e-5].map(|step_s| {
        let solver = format!(
            "[solver]\nkind = \"exact-events\"\nstep_s = {step_s:e}\nprecision = \"f64\"\n[output]\ntrace_step_s = 2e-4\n"
        );
        let (stepped, _) = render(&[STROKES, &solver, CLONUS], false);
        assert_eq!(stepped.rows.len(), truth.rows.len());
        let share = stepped.column(HELD_BACK_COLUMN);
        let pairs = stepped.column("clonus_nm").zip(truth.column("clonus_nm"));
        let within = pairs.zip(share).filter(|(_, share)| *share > 0.0);
        within.map(|((a, b), _)| (a - b).abs()).fold(0.0, f64::max)
    });
    println!("largest torque error, N·m, at 200, 100, 50, 25 µs: {errors:?}");
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((1.7..2.4).contains(&ratio), "{errors:?}");
    }
    assert!(errors[2] < 8e-3, "{errors:?}");
}

/// A lead-pipe, a wall and crepitus that ask for twice what a device shows.
const STRONG: &str = r#"
version = 1
title = "More than a device shows"
duration_s = 1.0
[motion]
kind = "constant"
from_deg = 70.0
velocity_rad_s = 1.0
[effects.crepitus]
preset = "coarse"
[effects.lead-pipe]
torque_nm = 4.5
[effects.range-limit]
flexion_limit_deg = 90.0
flexion_torque_nm = 4.0
"#;

#[test]
fn a_sum_beyond_the_devices_largest_torque_is_said_with_and_without_a_device() {
    let crepitus = |found: &Unshown| -> Vec<f64> { found.column("torque_nm").collect() };
    let mut first = Vec::new();
    for (solver, as_device) in [(TICKS, false), (REFERENCE, false), (TICKS, true)] {
        let (found, summary) = render(&[STRONG, solver], as_device);
        let limit = summary.torque_limit.expect("beyond");
        println!("{limit:?} {:?}", summary.warnings);
        assert_eq!((limit.limit_nm, limit.is_applied), (4.5, as_device));
        assert!((8.5..9.0).contains(&limit.most_nm), "{limit:?}");
        let words = format!("from t = {:.4} s on", limit.first_s);
        let which = if as_device {
            "above the device's limit"
        } else {
            "has no device and no limit"
        };
        let text = warning(&summary, which);
        assert!(text.contains(&words) && text.contains("up to 8."), "{text}");
        if as_device {
            assert!(found.column("shown_nm").all(|nm| nm.abs() <= 4.5));
        } else {
            assert!(
                crepitus(&found).iter().all(|nm| nm.abs() < 0.5),
                "each by itself"
            );
        }
        first.push(limit.first_s);
    }
    assert!((first[0] - first[1]).abs() < 2e-4, "{first:?}");
    // Below it nothing is said.
    let (_, summary) = render(&[STROKES, TICKS, "[effects.lead-pipe]\n"], true);
    assert!(summary.torque_limit.is_none() && summary.warnings.is_empty());
}
