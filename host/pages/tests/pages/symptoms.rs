//! Pages of runs with symptoms: which pictures and words are on them.
//!
//! The pages are left in the target's `tmp` directory to be looked at.

use crate::fixture::symptom::{EXAMINED, Item, STEPPED, ran, scene};
use crate::markup::{assert_drawn, assert_page, count};
use crepitus_model::render::effects::EffectSettings;
use crepitus_pages::report::{Collector, Figures, Paper, Setup, Text, html, pictures};
use crepitus_scene::Scene;

fn figures(place: usize, solver: &str, knows_settings: bool) -> Figures {
    let (effects, speeds, ends) = EXAMINED[place];
    examined(&scene(effects, speeds, ends, solver), knows_settings)
}

fn examined(scene: &Scene, knows_settings: bool) -> Figures {
    let (columns, items) = ran(scene);
    let mut collector = Collector::new(&Setup {
        columns: &columns,
        rows_expected: items.len() as u64,
        row_step_s: 1e-3,
        levels: None,
        effects: if knows_settings {
            scene.effect_settings()
        } else {
            EffectSettings::default()
        },
    });
    for item in &items {
        match item {
            Item::Row(values) => collector.row(values),
            Item::Event(event) => collector.symptom(event),
        }
    }
    collector.finish()
}

/// Checks what every page must keep to, and leaves the page to be looked at.
fn page(name: &str, figures: &Figures) -> String {
    let text = Text {
        title: "An examination".to_owned(),
        ..Text::default()
    };
    let page = html(&text, figures);
    let wrong = ["NaN", "inf,"];
    assert_page(&format!("symptom-{name}"), &page, 300_000, &wrong);
    for picture in pictures(figures, Paper::Screen) {
        assert_drawn(&picture.svg);
    }
    page
}

/// The names of the pictures, and what the page says besides.
const EXPECTED: [(&[&str], &[&str]); 9] = [
    (
        &["range-limit-1", "range-limit-2"],
        &[
            "End of the range of motion",
            ">extension ends at 10°<",
            ">flexion ends at 120°<",
            "limit of the end-feel",
            "in the end-feel",
            "the end yields",
            "4.00 N·m within 2.9°, pressed on to 6.0°; met 2 times",
        ],
    ),
    (
        &["lead-pipe-1", "lead-pipe-2"],
        &[
            "limits of the rigidity",
            "even resistance",
            "2.39 J, between 15.0° and 75.0°",
        ],
    ),
    (
        &["cogwheel-1", "cogwheel-2"],
        &[
            "limits at a tooth",
            "limits between teeth",
            "at a tooth",
            "a second while it moved",
        ],
    ),
    (
        &["spasticity-1", "spasticity-2", "catch-angle"],
        &[
            "caught at 52.5° at 90 °/s with 1.05 N·m",
            "caught at 42.5° at 130 °/s with 1.52 N·m",
            ">threshold of a slow stretch: 75°<",
            ">slower: no catch<",
            "Speed of the stretch (°/s)",
            ">catch<",
        ],
    ),
    (
        &["spasticity-1", "spasticity-2", "catch-angle"],
        &[
            "the reflex answers",
            "a very slow stretch",
            "began at 66.9° at 30 °/s",
        ],
    ),
    (
        &["clasp-knife-1", "clasp-knife-2"],
        &[
            "collapsed at 75.0° from 3.16 N·m; a fifth was left after 8",
            ">resistance begins at 30°<",
            ">collapses at 75°<",
            "what the collapse leaves",
        ],
    ),
    (
        &["clonus-1", "clonus-2", "beats"],
        &[
            "8 beats in 1.3 s, ended by itself; SCATS 1: mild, less than 3 s",
            "first 217 ms, last 167 ms",
            "the rhythm of the settings",
            ">held beyond 60°<",
        ],
    ),
    (
        &["texture-1", "texture-2"],
        &[
            "limits at an asperity",
            "limits between asperities",
            "a second while it moved",
        ],
    ),
    (
        &["range-limit-1", "lead-pipe-2", "together-1", "together-2"],
        &[
            "All symptoms together",
            "On examination: lead-pipe rigidity",
        ],
    ),
];

#[test]
fn every_symptom_has_its_pictures_and_words() {
    for (place, (pictured, said)) in EXPECTED.iter().enumerate() {
        let figures = figures(place, STEPPED, true);
        let page = page(&place.to_string(), &figures);
        let names: Vec<String> = pictures(&figures, Paper::Screen)
            .into_iter()
            .map(|p| p.name)
            .collect();
        for name in *pictured {
            assert!(
                names.iter().any(|n| n == name),
                "{place}: {name} of {names:?}"
            );
        }
        for words in *said {
            assert!(page.contains(words), "{place}: {words}");
        }
        assert!(page.contains("Knee angle, flexion (°)") && page.contains("Resistance (N·m)"));
        // One of its own, and none among the effects of a plant.
        assert!(!page.contains("part of the model’s torque"), "{place}");
    }
}

#[test]
fn the_reference_has_the_same_pictures() {
    for place in 0..8 {
        let (stepped, exact) = (
            figures(place, STEPPED, true),
            figures(place, "kind = \"reference\"", true),
        );
        page(&format!("{place}-reference"), &exact);
        let names = |figures: &Figures| -> Vec<String> {
            let all = pictures(figures, Paper::Screen).into_iter().map(|p| p.name);
            // What a hand feels is known of a stepped run alone.
            all.filter(|name| !["hand", "spectrum", "energy"].contains(&name.as_str()))
                .collect()
        };
        assert_eq!(names(&stepped), names(&exact), "{place}");
    }
}

#[test]
fn without_settings_no_limit_is_drawn_and_the_page_says_so() {
    let page = page("3-unknown", &figures(3, STEPPED, false));
    assert!(page.contains("no limits are drawn"));
    assert!(!page.contains("where the settings put it"));
    assert!(!page.contains("threshold of a slow stretch"));
    assert!(page.contains("caught at 52.5° at 90 °/s;"));
    assert_eq!(count(&page, "<h2>Angle of catch against speed</h2>"), 1);
}

#[test]
fn an_end_is_as_hard_however_far_it_is_pressed() {
    for (to_deg, pressed) in [(92.0, "2.0°"), (95.0, "5.0°")] {
        let effects = "[effects.range-limit]\npreset = \"bone-block\"";
        let scene = scene(effects, &[60.0], (40.0, to_deg), STEPPED);
        let page = html(&Text::default(), &examined(&scene, true));
        let expected = format!("4.00 N·m within 0.8°, pressed on to {pressed}<");
        assert!(page.contains(&expected), "{expected}");
    }
}

#[test]
fn a_stretch_without_an_answer_says_which_threshold_it_did_not_meet() {
    for (effects, speed, ends, expected) in [
        // Quick enough, and not far enough.
        (
            "[effects.clonus]",
            300.0,
            (10.0, 55.0),
            "none: no stretch passed 60° at 100 °/s or more",
        ),
        (
            "[effects.spasticity]",
            90.0,
            (10.0, 30.0),
            "none: no stretch met the threshold",
        ),
    ] {
        let scene = scene(effects, &[speed], ends, STEPPED);
        let page = html(&Text::default(), &examined(&scene, true));
        assert!(page.contains(expected), "{expected}");
    }
}
