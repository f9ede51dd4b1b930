//! A rotor that is pressed into a wall: a scene of the plant with the device in its loop.

use super::input::Pressed;
use super::observation::Observation;
use super::subject::Subject;
use crate::symptoms::event::{SymptomEvent, own};
use crepitus_scene::run::{Observer, columns};
use crepitus_scene::trace::SymptomEvent as SceneEvent;
use crepitus_scene::{Overrides, Scene, run};
use std::convert::Infallible;
use std::path::Path;

/// Runs the scene; a scene that is refused, or fails, is an overflow at 0 s.
pub(super) fn observe(subject: Subject, pressed: &Pressed, late_s: f64) -> Observation {
    let mut seen = Observation {
        step_s: pressed.step_s,
        ..Observation::default()
    };
    let text = pressed.scene(subject.precision);
    let Ok(scene) = Scene::parse(Path::new("pressed.toml"), &text, &Overrides::default()) else {
        seen.overflow_s = Some(0.0);
        return seen;
    };
    let mut rotor = Rotor {
        place: columns(&scene)
            .iter()
            .position(|column| column.name == "range_limit_nm"),
        late_s,
        seen: &mut seen,
        events: Vec::new(),
    };
    let ran = run(&scene, &mut rotor).is_ok() && rotor.place.is_some();
    let events = own(rotor.events);
    if !ran {
        seen.overflow_s.get_or_insert(0.0);
    }
    seen.symptoms.events = events;
    seen
}

/// Sees the wall's torque.
struct Rotor<'a> {
    place: Option<usize>,
    late_s: f64,
    seen: &'a mut Observation,
    events: Vec<SymptomEvent>,
}

impl Observer for Rotor<'_> {
    type Error = Infallible;

    fn row(&mut self, values: &[f64]) -> Result<(), Infallible> {
        let time_s = values.first().copied().unwrap_or(f64::NAN);
        let torque_nm = self.place.and_then(|place| values.get(place)).copied();
        let torque_nm = torque_nm.unwrap_or(f64::NAN);
        self.seen.steps += 1;
        if !torque_nm.is_finite() {
            self.seen.overflow_s.get_or_insert(time_s);
        }
        if time_s >= self.late_s {
            self.seen.late_torque.add(torque_nm);
        }
        self.seen.torque.add(torque_nm);
        self.seen.last_torque_nm = torque_nm;
        Ok(())
    }

    fn symptom(&mut self, event: &SceneEvent) -> Result<(), Infallible> {
        self.events.push(SymptomEvent {
            time_s: event.time_s,
            word: event.word,
            omega_rad_s: event.omega_rad_s,
            before_nm: event.torque_before_nm,
            after_nm: event.torque_after_nm,
        });
        Ok(())
    }
}
