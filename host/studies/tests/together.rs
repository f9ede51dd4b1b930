//! Rows of a sweep whose points are run together are those of runs by themselves, to the bit.

use crepitus_scene::shipped::Source;
use crepitus_scene::{Overrides, cpu_time};
use crepitus_studies::sweep::{
    Design, Ended, Plan, Points, Receiver, Row, Stop, Threads, run_all, totals,
};
use fastrand::Rng;
use std::iter::once;
use std::path::Path;

/// Parameters of the joint, which are varied.
const KEYS: [&str; 5] = [
    "static_torque_nm",
    "kinetic_torque_nm",
    "stiffness_nm_per_rad",
    "inertia_kg_m2",
    "damping_nms_per_rad",
];

/// A hand that stops, turns back and jumps, also within steps and a moment beside their ends.
const KNOTS: &str = "kind = \"velocity-knots\"\nknots = [\
    { t_s = 0.0, omega_rad_s = 0.4 }, \
    { t_s = 0.0500123, omega_left_rad_s = 1.1, omega_right_rad_s = -0.7 }, \
    { t_s = 0.12, omega_left_rad_s = -0.2, omega_right_rad_s = 1.9 }, \
    { t_s = 0.2000000001, omega_left_rad_s = 0.0, omega_right_rad_s = 0.8 }, \
    { t_s = 0.31237, omega_rad_s = 0.0 }]\n";

const STROKES: &str =
    "kind = \"strokes\"\nfrom_deg = 10\nto_deg = 31\npeak_speed_deg_s = 97\npause_s = 0.0313\n";

const SINE: &str = "kind = \"sine\"\namplitude_deg = 20\nfrequency_hz = 1.7\nphase_deg = 25\n";

const CONSTANT: &str = "kind = \"constant\"\nvelocity_rad_s = 0.3\n";

/// Rows in the order of their points.
struct Rows(Vec<Row>);

impl Receiver for Rows {
    type Error = Ended;

    fn row(&mut self, row: Row) -> Result<(), Ended> {
        self.0.push(row);
        Ok(())
    }

    fn poll(&mut self) -> Result<(), Ended> {
        Ok(())
    }
}

/// A number between two, evenly in its logarithm.
fn log(random: &mut Rng, low: f64, high: f64) -> f64 {
    low * (high / low).powf(random.f64())
}

/// A joint; some touch, some turn back, some have more torque than a device, some are invalid.
fn point(random: &mut Rng, is_frozen: bool) -> Vec<String> {
    let most_nm = if random.f64() < 0.1 { 30.0 } else { 2.0 };
    let static_nm = log(random, 0.05, most_nm);
    let kinetic_nm = static_nm * [1.0, 0.0, random.f64(), random.f64(), 1.2][random.usize(..5)];
    let (stiffness, inertia) = (log(random, 50.0, 2000.0), log(random, 1e-5, 0.05));
    let damping = if is_frozen || random.bool() {
        0.0
    } else {
        2.0 * (stiffness * inertia).sqrt() * log(random, 1e-3, 3.0)
    };
    [static_nm, kinetic_nm, stiffness, inertia, damping]
        .map(|x| format!("{x:?}"))
        .to_vec()
}

fn plan(home: &Path, scene: &str, keys: &[&str], points: Vec<Vec<String>>) -> Plan {
    let file = home.join("scene.toml");
    std::fs::write(&file, scene).unwrap();
    let keys = keys.iter().map(|key| (*key).to_owned()).collect();
    let design = Design::Listed(Points::new(keys, points).unwrap());
    Plan::new(Source::find(&file).unwrap(), Overrides::default(), design).unwrap()
}

fn rows(plan: &Plan, threads: Threads) -> Vec<Row> {
    let mut rows = Rows(Vec::new());
    run_all(
        once(0..plan.runs()),
        threads,
        &mut rows,
        |points, stop, give| totals(plan, points, stop, give),
    )
    .unwrap();
    rows.0.sort_by_key(|row| row.index);
    rows.0
}

fn one_by_one(plan: &Plan) -> Vec<Row> {
    let threads = Threads {
        count: 2,
        at_once: 1,
    };
    rows(plan, threads)
}

/// Cells with every bit of their numbers.
fn cells(row: &Row) -> Vec<String> {
    let cells = row.cells.iter();
    cells.map(|(name, cell)| format!("{name}={cell}")).collect()
}

fn compare(name: &str, plan: &Plan, count: usize) -> usize {
    let threads = plan.threads(count);
    assert!(threads.at_once > 1, "{name}");
    let (alone, together) = (one_by_one(plan), rows(plan, threads));
    assert_eq!(alone.len() as u64, plan.runs());
    assert_eq!(alone.len(), together.len());
    for (a, b) in alone.iter().zip(&together) {
        assert_eq!(a.index, b.index);
        assert_eq!(cells(a), cells(b), "{name}, point {}", a.index);
    }
    alone.iter().filter(|row| row.failure().is_some()).count()
}

fn text(convention: &str, precision: &str, solver: &str, step_s: f64, motion: &str) -> String {
    // It ends within a step.
    format!(
        "version = 1\ntitle = \"together\"\nduration_s = 0.43217\n[solver]\nkind = \"{solver}\"\nstep_s = {step_s:?}\n\
         precision = \"{precision}\"\n[motion]\n{motion}[effects.crepitus]\nconvention = \"{convention}\"\n"
    )
}

#[test]
fn rows_of_points_together_are_those_of_each_alone() {
    let home = tempfile::tempdir().unwrap();
    let mut random = Rng::with_seed(58);
    let keys = KEYS.map(|key| format!("effects.crepitus.{key}"));
    let keys = keys.each_ref().map(String::as_str);
    let (mut points, mut failed) = (0, 0);
    for (convention, precision) in [
        ("paper", "f64"),
        ("paper", "f32"),
        ("physical", "f64"),
        ("physical", "f32"),
        ("frozen", "f32"),
        ("frozen", "f64"),
    ] {
        for motion in [KNOTS, STROKES, SINE, CONSTANT] {
            for (solver, step_s) in [("exact-events", 5e-5), ("exact", 2.3e-4)] {
                let scene = text(convention, precision, solver, step_s, motion);
                let listed: Vec<_> = (0..23)
                    .map(|_| point(&mut random, convention == "frozen"))
                    .collect();
                points += listed.len();
                let plan = plan(home.path(), &scene, &keys, listed);
                let name = format!("{convention} {precision} {solver} on {motion}");
                failed += compare(&name, &plan, random.usize(1..4));
            }
        }
    }
    println!("{points} points, {failed} of them invalid");
    assert!(points > 1000 && failed > 50 && failed < points / 2);
}

/// Explicit methods that diverge, a crowded step, and what points have not in common: they are run by themselves.
#[test]
fn points_of_other_kinds_are_run_as_before() {
    let home = tempfile::tempdir().unwrap();
    let scene = text("paper", "f64", "exact-events", 1e-4, SINE);
    let keys = [
        "solver.kind",
        "effects.crepitus.convention",
        "motion.frequency_hz",
        "effects.crepitus.inertia_kg_m2",
    ];
    let mut points = Vec::new();
    for solver in ["exact-events", "rk4", "euler", "nonsense"] {
        for convention in ["paper", "frozen", "physical"] {
            for frequency in ["0.5", "2"] {
                for inertia in ["1e-8", "1e-6", "1e-4", "1e-3", "2e-3", "-1"] {
                    points.push(
                        [solver, convention, frequency, inertia]
                            .map(str::to_owned)
                            .to_vec(),
                    );
                }
            }
        }
    }
    let plan = plan(home.path(), &scene, &keys, points);
    let alone = one_by_one(&plan);
    let diverged = |row: &&Row| {
        row.failure()
            .is_some_and(|reason| reason.contains("diverged"))
    };
    assert!(alone.iter().filter(diverged).count() > 5);
    compare("kinds", &plan, 1);
}

/// Rows of 4 s of `low-speed` under `paper` for each second of CPU time: `cargo test --release -p crepitus-studies \
/// --test together rows_a_second -- --nocapture`.
#[test]
fn rows_a_second() {
    // A build for tests inlines less, on some processors to no gain.
    let least = if cfg!(debug_assertions) { 0.8 } else { 1.3 };
    let points = (0..64)
        .map(|n| vec![format!("{:?}", 0.4 + 1e-4 * f64::from(n))])
        .collect();
    let keys = vec!["effects.crepitus.static_torque_nm".to_owned()];
    let set = [
        ("duration_s", "4.0"),
        ("effects.crepitus.convention", "\"paper\""),
    ];
    let overrides = Overrides {
        set: set
            .map(|(path, value)| (path.to_owned(), value.to_owned()))
            .to_vec(),
        ..Overrides::default()
    };
    let source = Source::find(Path::new("low-speed")).unwrap();
    let design = Design::Listed(Points::new(keys, points).unwrap());
    let plan = Plan::new(source, overrides, design).unwrap();
    let mut ratios = Vec::new();
    let mut fastest = [0.0_f64; 2];
    for _ in 0..5 {
        let at_once = usize::try_from(plan.threads(1).at_once).unwrap();
        let of_each = [1, at_once].map(|at_once| {
            let begun = cpu_time::now();
            let mut rows = 0.0;
            for start in (0..64).step_by(at_once) {
                let points = start as u64..(start + at_once) as u64;
                totals(&plan, points, &Stop::default(), &mut |_| rows += 1.0).unwrap();
            }
            rows / cpu_time::since(begun).as_secs_f64()
        });
        ratios.push(of_each[1] / of_each[0]);
        fastest = [0, 1].map(|i| fastest[i].max(of_each[i]));
    }
    ratios.sort_by(f64::total_cmp);
    println!(
        "{:.0} rows for each second of CPU time one by one, {:.0} together: {:.2} times as many",
        fastest[0], fastest[1], ratios[2]
    );
    assert!(ratios[2] >= least, "{ratios:?}");
}
