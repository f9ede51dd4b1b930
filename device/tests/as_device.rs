//! A scene with a device shows, bit for bit, what the drive shows on the same
//! counts: there is one pipeline.

mod support;

use crepitus_board::values::values;
use crepitus_model::render::Limit;
use crepitus_protocol::host::{Answer, Ask};
use crepitus_protocol::telemetry::SampleFlags;
use crepitus_protocol::{LimitReason, State};
use crepitus_scene::scene::Overrides;
use crepitus_scene::trace::EventRecord;
use crepitus_scene::{Observer, Scene, run};
use std::convert::Infallible;
use std::path::{Path, PathBuf};
use support::{Bench, Boots, TICKS_PER_MS};

/// Of each scene, ms.
const LENGTH_MS: u32 = 2_000;

/// What a row has of the device.
#[derive(Clone, Copy)]
struct Row {
    count: i32,
    omega_rad_s: f64,
    model_nm: f64,
    shown_nm: f64,
    limit: u8,
}

/// Keeps rows.
struct Rows {
    places: [usize; 5],
    rows: Vec<Row>,
}

impl Observer for Rows {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        let [count, omega_rad_s, model_nm, shown_nm, limit] = self.places.map(|at| values[at]);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole numbers"
        )]
        self.rows.push(Row {
            count: count as i32,
            omega_rad_s,
            model_nm,
            shown_nm,
            limit: limit as u8,
        });
        Ok(())
    }

    fn event(&mut self, _: &EventRecord) -> Result<(), Infallible> {
        Ok(())
    }

    fn progress(&mut self, _: f64) -> Result<(), Infallible> {
        Ok(())
    }
}

/// A shipped scene as the drive would run it; or why it would not.
fn scene(file: &Path) -> Result<Scene, String> {
    let mut overrides = Overrides {
        precision: Some("f32".to_owned()),
        step: Some("5e-5".to_owned()),
        as_device: true,
        ..Overrides::default()
    };
    let duration_s = f64::from(LENGTH_MS) * 1e-3;
    for (path, value) in [
        ("solver.kind", "\"exact-events\"".to_owned()),
        ("duration_s", duration_s.to_string()),
        ("output.trace_step_s", "5e-5".to_owned()),
        ("effects.encoder.lines", "512".to_owned()),
    ] {
        overrides.set.push((path.to_owned(), value));
    }
    Scene::read(file, &overrides).map_err(|e| e.to_string())
}

fn rows(scene: &Scene) -> Vec<Row> {
    let columns = crepitus_scene::run::columns(scene);
    let place = |name| columns.iter().position(|c| c.name == name).expect(name);
    let mut rows = Rows {
        places: [
            "encoder_count",
            "omega_rad_s",
            "torque_nm",
            "shown_nm",
            "limit",
        ]
        .map(place),
        rows: Vec::new(),
    };
    run(scene, &mut rows).expect("it runs");
    rows.rows
}

/// What the drive renders on the counts of these rows, armed long before.
fn drive(scene: &Scene, rows: &[Row]) -> Bench {
    let mut bench = Bench::new(&Boots::new());
    bench.motor.turned = Some((rows[0].count, 0.0));
    bench.settle();
    let base = bench.comms.revision();
    let values = values(scene).expect("a joint of the device");
    assert!(matches!(
        bench.ask(Ask::Commit { base, values }),
        Ok(Answer::Committed { .. })
    ));
    bench.ask(Ask::Zero).expect("zeroed");
    bench.ask(Ask::Arm).expect("armed");
    // Until torque may be asked for up to the limit.
    bench.run_leased(200);
    assert_eq!(bench.drive.state(), State::Armed);
    bench.script = rows.iter().map(|r| (r.count, r.omega_rad_s)).collect();
    let ms = u32::try_from(rows.len()).expect("a few") / TICKS_PER_MS + 1;
    bench.run_leased(ms);
    assert_eq!(bench.drive.state(), State::Armed);
    bench
}

#[test]
fn a_scene_shows_what_the_drive_shows_on_the_same_counts_bit_for_bit() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("the scenes")
        .map(|file| file.expect("a file").path())
        .collect();
    files.sort();
    let (mut compared, mut with_stages) = (0, 0);
    for file in files {
        let name = file.file_stem().expect("a name").display().to_string();
        let scene = match scene(&file) {
            Ok(scene) => scene,
            Err(why) => {
                println!("{name}: left out, {why}");
                continue;
            }
        };
        let rows = rows(&scene);
        let bench = drive(&scene, &rows);
        assert_eq!(bench.rendered.len(), rows.len(), "{name}");
        let mut limits = [0_u32; 8];
        for (n, (row, rendered)) in rows.iter().zip(&bench.rendered).enumerate() {
            let (shown, model) = (rendered.torque_nm, rendered.model_torque_nm);
            assert_eq!(f64::from(shown), row.shown_nm, "{name}, tick {n}");
            assert_eq!(f64::from(model), row.model_nm, "{name}, tick {n}");
            let reason = rendered.flags.limit();
            assert_eq!(reason as u8, row.limit, "{name}, tick {n}");
            limits[usize::from(row.limit)] += 1;
        }
        println!("{name}: {} ticks, by limit {limits:?}", rows.len());
        compared += 1;
        with_stages += u32::from(scene.has("friction-compensation") || scene.has("bone-shaping"));
    }
    println!("{compared} scenes, {with_stages} with stages behind the joint");
    assert!(compared > 15 && with_stages > 1);
}

#[test]
fn a_limit_has_the_number_that_it_has_on_the_wire() {
    for (limit, reason) in [
        (Limit::None, LimitReason::None),
        (Limit::Torque, LimitReason::Torque),
        (Limit::Slew, LimitReason::Slew),
        (Limit::TurnedBack, LimitReason::TurnedBack),
        (Limit::Holding, LimitReason::Holding),
        (Limit::NotArmed, LimitReason::NotArmed),
    ] {
        assert_eq!(SampleFlags::default().with_limit(reason).limit(), reason);
        assert_eq!(limit as u8, reason as u8);
    }
}
