//! The signals of a run that are compared.

use super::{Coil, SETTLES};
use crate::parallel::Meter;
use crate::watcher::Cancelled;
use crepitus_model::Real;
use crepitus_scene::run::{self, FELT_COLUMN, Observer, columns, step_count};
use crepitus_scene::{Scene, Walk};

/// Signals of one run, once it has settled.
#[derive(Clone, Debug)]
pub(super) struct SettledSignals {
    /// Time from one value to the next, s.
    pub(super) step_s: f64,
    /// The joint's torque, N·m.
    pub(super) torque: Vec<f64>,
    /// Torque that the hand or the fixture feels, N·m.
    pub(super) felt: Vec<f64>,
    /// Acceleration of the palm, m/s²; nothing without one.
    pub(super) acceleration: Vec<f64>,
    /// Acceleration of the palm on a bare knee whose joint shows this very torque, m/s².
    pub(super) of_bare_knee: Vec<f64>,
    pub(super) coil: Option<Coil>,
}

struct Recorder<'a> {
    places: [Option<usize>; 5],
    rows: [Vec<f64>; 5],
    meter: &'a Meter,
}

const COLUMNS: [&str; 5] = [
    "torque_nm",
    FELT_COLUMN,
    "hand_acceleration_m_s2",
    "coil_current_a",
    "excursion_m",
];

impl Observer for Recorder<'_> {
    type Error = Cancelled;

    fn row(&mut self, values: &[f64]) -> Result<(), Cancelled> {
        for (place, row) in self.places.iter().zip(&mut self.rows) {
            row.extend(place.and_then(|place| values.get(place)));
        }
        Ok(())
    }

    fn progress(&mut self, _: f64) -> Result<(), Cancelled> {
        if self.meter.is_stopped() {
            return Err(Cancelled);
        }
        Ok(())
    }
}

/// Runs a scene and keeps its signals, or says why there are none.
pub(super) fn record(scene: &Scene, meter: &Meter) -> Result<SettledSignals, String> {
    let mut scene = scene.clone();
    scene.trace_step_s = scene.step_s();
    let names: Vec<_> = columns(&scene).iter().map(|c| c.name).collect();
    let mut recorder = Recorder {
        places: COLUMNS.map(|column| names.iter().position(|name| *name == column)),
        rows: Default::default(),
        meter,
    };
    let ran = run::run(&scene, &mut recorder);
    meter.add(step_count(&scene));
    ran.map_err(|e| e.to_string())?;
    let of_bare_knee = if scene.is_held() {
        answer(&super::Step::BareKnee.free(&scene), &recorder.rows[0])
    } else {
        Vec::new()
    };
    let settled = |signal: Vec<f64>| {
        let skipped = (SETTLES * whole(signal.len())).whole();
        let skipped = usize::try_from(skipped).unwrap_or(0);
        signal.into_iter().skip(skipped).collect::<Vec<f64>>()
    };
    let [torque, felt, acceleration, current, excursion] = recorder.rows.map(settled);
    let ohm = resistance_ohm(&scene);
    let coil = ohm.filter(|_| !current.is_empty()).map(|ohm| {
        let square = current.iter().map(|a| a * a).sum::<f64>() / whole(current.len());
        Coil {
            current_a: square.sqrt(),
            power_w: ohm * square,
            excursion_mm: 1e3 * excursion.iter().fold(0.0_f64, |most, x| most.max(x.abs())),
        }
    });
    Ok(SettledSignals {
        step_s: scene.step_s(),
        torque,
        felt,
        acceleration,
        of_bare_knee: settled(of_bare_knee),
        coil,
    })
}

/// Acceleration of the palm on a knee whose joint shows these torques, one a tick; none
/// without a palm.
fn answer(bare: &Scene, torque_nm: &[f64]) -> Vec<f64> {
    let Ok(mut plant) = bare.assemble() else {
        return Vec::new();
    };
    let column = COLUMNS[2];
    let Some(place) = plant.columns().iter().position(|name| *name == column) else {
        return Vec::new();
    };
    let mut walk = Walk::new(&bare.motion, bare.step_s());
    let mut row = Vec::new();
    let mut accelerations = Vec::with_capacity(torque_nm.len());
    for nm in torque_nm {
        row.clear();
        plant.write(&mut row);
        accelerations.extend(row.get(place));
        plant.command(*nm, 0.0);
        walk.advance(&mut plant);
    }
    accelerations
}

fn whole(n: usize) -> f64 {
    f64::from_whole(u64::try_from(n).unwrap_or(u64::MAX))
}

fn resistance_ohm(scene: &Scene) -> Option<f64> {
    use crepitus_plant::effects::reaction_mass;
    let of = |listed: &&crepitus_plant::assembly::Listed| {
        listed.effect.name == reaction_mass::EFFECT.name
    };
    let listed = scene.listed.iter().find(of)?;
    Some(reaction_mass::as_settings(&listed.given).resistance_ohm)
}
