//! Speed of a scene relative to real time at the device's 20 kHz, on one
//! core and without a trace.
//!
//! `cargo bench -p crepitus-scene` counts simulated seconds as items: read
//! "item/s" as simulated seconds per second.

use crepitus_plant::effects::EFFECTS;
use crepitus_scene::reference::Reference;
use crepitus_scene::run::Blind;
use crepitus_scene::{Overrides, Scene, run};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use std::path::Path;

fn main() {
    divan::main();
}

/// Simulated seconds of one iteration.
const SECONDS: u32 = 60;

const CONSTANT: &str = "kind = \"constant\"\nvelocity_rad_s = 1.0";
const STROKES: &str =
    "kind = \"strokes\"\nfrom_deg = 5\nto_deg = 65\npeak_speed_deg_s = 30\npause_s = 0.5";
const SINE: &str = "kind = \"sine\"\namplitude_deg = 45\nfrequency_hz = 0.25\nphase_deg = -90";

fn scene(motion: &str, solver: &str, precision: &str, effects: &str) -> Scene {
    let text = format!(
        "version = 1\ntitle = \"bench\"\nduration_s = {SECONDS}\n[motion]\n{motion}\n\
         [solver]\nkind = \"{solver}\"\nstep_s = 5e-5\nprecision = \"{precision}\"\n{effects}"
    );
    Scene::parse(Path::new("bench.toml"), &text, &Overrides::default()).expect("a good scene")
}

fn bench(bencher: Bencher, scene: &Scene) {
    bencher
        .counter(ItemsCount::new(SECONDS))
        .bench_local(|| run(black_box(scene), &mut Blind).map(|s| s.events));
}

#[divan::bench(args = ["frozen", "paper", "physical"], consts = [32, 64])]
fn exact_events<const BITS: u32>(bencher: Bencher, convention: &str) {
    let effects = format!("[effects.crepitus]\nconvention = \"{convention}\"");
    let precision = format!("f{BITS}");
    bench(
        bencher,
        &scene(CONSTANT, "exact-events", &precision, &effects),
    );
}

#[divan::bench(args = [("constant", CONSTANT), ("strokes", STROKES), ("sine", SINE)])]
fn frozen_motions(bencher: Bencher, motion: (&str, &str)) {
    bench(
        bencher,
        &scene(motion.1, "exact-events", "f64", "[effects.crepitus]"),
    );
}

#[divan::bench]
fn frozen_with_encoder(bencher: Bencher) {
    let effects = "[effects.crepitus]\n[effects.encoder]";
    bench(bencher, &scene(STROKES, "exact-events", "f32", effects));
}

/// Every effect, through a hand.
#[divan::bench]
fn everything(bencher: Bencher) {
    let tables: Vec<_> = EFFECTS
        .iter()
        .map(|e| format!("[effects.{}]", e.name))
        .collect();
    let effects = tables.join("\n");
    bench(bencher, &scene(STROKES, "exact-events", "f32", &effects));
}

#[divan::bench]
fn without_effects(bencher: Bencher) {
    bench(bencher, &scene(CONSTANT, "exact", "f64", ""));
}

/// Advances the reference from event to event, without a step: ten seconds at 1 rad/s, 637 events.
#[divan::bench(args = ["frozen", "physical"])]
fn reference_events_only(bencher: Bencher, convention: &str) {
    let effects = format!("[effects.crepitus]\nconvention = \"{convention}\"");
    let text = scene(CONSTANT, "exact-events", "f64", &effects);
    let settings = text.crepitus.expect("crepitus").settings;
    bencher.bench_local(|| {
        let mut events = 0;
        let mut last = 0.0;
        Reference::new(&settings, black_box(&text.motion)).advance(10.0, |e| {
            events += 1;
            last = e.fraction;
        });
        (events, last)
    });
}
