//! Plants that are stepped against the runs of their scenes.

use super::*;
use crate::run::{Observer, columns};
use crate::scene::Overrides;
use crate::shipped::SHIPPED;
use std::path::Path;

/// Rows that are compared.
const ROWS: usize = 1_500;

/// The first rows of a run.
struct First(Vec<Vec<f64>>);

impl Observer for First {
    type Error = ();

    fn row(&mut self, row: &[f64]) -> Result<(), ()> {
        self.0.push(row.to_vec());
        if self.0.len() < ROWS { Ok(()) } else { Err(()) }
    }
}

fn rows_of(scene: &Scene) -> Vec<Vec<f64>> {
    let mut first = First(Vec::new());
    let _stopped = crate::run(scene, &mut first);
    assert!(first.0.len() > 100, "{}", scene.title);
    first.0
}

fn every_row(mut scene: Scene) -> Arc<Scene> {
    scene.trace_step_s = scene.step_s();
    Arc::new(scene)
}

fn scene(name: &str) -> Scene {
    crate::shipped::scene(Path::new(name), &Overrides::default()).unwrap()
}

fn row(plant: &SteppedPlant) -> Vec<f64> {
    let mut row = Vec::new();
    plant.row(&mut row);
    row
}

fn same(ours: &[f64], theirs: &[f64], what: &str) {
    let bits = |row: &[f64]| row.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(ours), bits(theirs), "{what}: {ours:?}, not {theirs:?}");
}

#[test]
fn stepped_by_its_own_hand_and_device_it_makes_the_runs_trace_to_the_bit() {
    let mut compared = 0;
    for shipped in SHIPPED {
        for as_device in [false, true] {
            let overrides = Overrides {
                as_device,
                ..Overrides::default()
            };
            let Ok(scene) = shipped.read(&overrides) else {
                continue;
            };
            let scene = every_row(scene);
            if !scene.is_coupled() {
                let refused = SteppedPlant::new(&scene, Holder::Scene);
                assert_eq!(refused.err(), Some(NotStepped::NoPlant));
                continue;
            }
            compared += 1;
            let theirs = rows_of(&scene);
            let mut plant = SteppedPlant::new(&scene, Holder::Scene).unwrap();
            let names = |columns: Vec<Column>| columns.iter().map(|c| c.name).collect::<Vec<_>>();
            assert_eq!(names(plant.columns()), names(columns(&scene)));
            let mut snapshot = None;
            for (n, theirs) in theirs.iter().enumerate() {
                let what = format!("{} {as_device}, row {n}", shipped.name);
                same(&row(&plant), theirs, &what);
                if n == 700 {
                    snapshot = Some(plant.clone());
                }
                plant.tick(0.0, None);
            }
            // A copy goes on from where it was made, whatever became of the other.
            if let Some(mut plant) = snapshot {
                for (n, theirs) in theirs.iter().enumerate().skip(700) {
                    same(
                        &row(&plant),
                        theirs,
                        &format!("{}, copied, {n}", shipped.name),
                    );
                    plant.tick(0.0, None);
                }
            }
        }
    }
    assert!(compared > 50, "{compared}");
}

#[test]
fn the_motor_takes_the_torque_that_it_is_given() {
    // The command of the device is a column.
    let scene = every_row(
        crate::shipped::scene(
            Path::new("fig8"),
            &Overrides {
                as_device: true,
                ..Overrides::default()
            },
        )
        .unwrap(),
    );
    let theirs = rows_of(&scene);
    let place = columns(&scene).iter().position(|c| c.name == "shown_nm");
    let place = place.unwrap();
    let mut given = SteppedPlant::new(&scene, Holder::Scene).unwrap();
    let mut other = given.clone();
    for (n, theirs) in theirs.iter().enumerate() {
        same(&row(&given), theirs, &format!("row {n}"));
        given.tick(0.0, Some(theirs[place]));
        other.tick(0.0, Some(theirs[place] + 0.5));
    }
    assert!(other.at.shaft.angle_rad < given.at.shaft.angle_rad - 1e-6);
}

#[test]
fn a_hand_without_torque_lets_go_of_the_leg() {
    let scene = every_row(scene("pendulum-test"));
    let theirs = rows_of(&scene);
    let mut plant = SteppedPlant::new(&scene, Holder::Torque).unwrap();
    let felt = plant
        .columns()
        .iter()
        .position(|c| c.name == "hand_torque_nm");
    let felt = felt.unwrap();
    for theirs in &theirs {
        let mut ours = row(&plant);
        assert_eq!(ours.remove(felt), 0.0);
        same(&ours, theirs, "released");
        plant.tick(0.0, None);
    }
    assert_eq!(plant.ticks_left(), None);
}

/// A leg that hangs, and all that a device has, under torques of any sign.
#[test]
fn what_a_hand_gives_is_found_again() {
    for name in ["pendulum-test", "everything", "fig9", "gear-friction"] {
        let scene = every_row(scene(name));
        let Ok(mut plant) = SteppedPlant::new(&scene, Holder::Torque) else {
            assert_eq!(name, "gear-friction");
            continue;
        };
        let begun = row(&plant)[1];
        let (mut most, mut sum) = (0.0_f64, 0.0);
        for n in 0..20_000_u32 {
            let torque_nm = 12.0 + 6.0 * (0.003 * f64::from(n)).sin();
            plant.tick(torque_nm, None);
            sum += torque_nm;
            most = most.max((plant.at.felt_nm - torque_nm).abs());
        }
        plant.check().unwrap();
        assert!(row(&plant)[1] > begun + 0.2, "{name}");
        // Felt is what was pushed: a sum of 20,000 impulses, and its differences.
        assert!(most < 1e-9, "{name}: {most}");
        let felt_nms = plant.run.plant.felt_nms();
        assert!((felt_nms - sum * 5e-5).abs() < 1e-9, "{name}");
        let balance = plant.run.plant.balance();
        assert!(balance.relative_residual() < 1e-9, "{name}: {balance:?}");
    }
}

#[test]
fn a_scene_ends_and_a_torque_does_not() {
    let mut short = scene("fig8-1-motor");
    short.duration_s = 10.0 * short.step_s();
    let short = every_row(short);
    let mut plant = SteppedPlant::new(&short, Holder::Scene).unwrap();
    assert_eq!(plant.ticks_left(), Some(10));
    plant.tick(0.0, None);
    assert_eq!(plant.ticks_left(), Some(9));
    let no_leg = SteppedPlant::new(&short, Holder::Torque);
    assert_eq!(no_leg.err(), Some(NotStepped::NoLeg));
}
