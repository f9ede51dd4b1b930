//! Where a spastic muscle caught, against the speed of the stretch.

use crate::chart_symptoms::WIDTH;
use crate::symptoms::Symptom;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_plot::palette::{LEVEL, TEXT};
use crepitus_plot::{Axis, Chart, Mark, Marker, Panel, Point, Stroke, stack};

const HEIGHT: f64 = 300.0;

/// The chart, if there was a catch.
pub(crate) fn chart(symptom: &Symptom, settings: Option<&SpasticitySettings>) -> Option<Chart> {
    if symptom.words.effect != "spasticity" {
        return None;
    }
    let caught = symptom.found.caught().map(|met| {
        let event = &met.event;
        let deg_s = event.omega_rad_s.abs().to_degrees();
        Point::new(deg_s, event.angle_rad.to_degrees())
    });
    let caught: Vec<Point> = caught.collect();
    let fastest = caught.iter().map(|p| p.x).fold(f64::NAN, f64::max);
    if fastest.is_nan() {
        return None;
    }
    let law = settings.map(|settings| Law::of(settings, 1.2 * fastest));
    let line = law.iter().flat_map(|law| &law.line);
    let values = caught.iter().chain(line).map(|p| p.y);
    let x = Axis::covering([0.0, 1.2 * fastest], 9);
    let y = Axis::covering(values, 6);
    let panel = Panel::new(HEIGHT, x, ("Knee angle at the catch (°)", y), |plot| {
        plot.grid();
        if let Some(law) = &law {
            plot.stroke(&law.line, Stroke::dashed(LEVEL, 1.75));
            plot.moments(&law.marks, true);
        }
        for point in &caught {
            plot.mark((point.x, point.y), Marker::Circle, TEXT);
        }
    });
    let panel = panel.x_title(Some("Speed of the stretch (°/s)"));
    let heading = match law {
        Some(_) => "Angle of catch against speed; dashed: where the settings put it",
        None => "Angle of catch against speed",
    };
    Some(Chart {
        svg: stack(WIDTH, "Knee angle at each catch against speed", vec![panel]),
        heading: Some(heading.to_owned()),
        half: false,
    })
}

/// Where the settings put a catch.
struct Law {
    /// (deg/s, deg)
    line: Vec<Point>,
    marks: Vec<Mark>,
}

impl Law {
    fn of(settings: &SpasticitySettings, to_deg_s: f64) -> Self {
        let slowest_deg_s = settings.slowest_rad_s().to_degrees();
        let ends = [slowest_deg_s, to_deg_s.max(slowest_deg_s)];
        let line = ends.map(|deg_s| {
            let threshold_rad = settings.threshold_rad(settings.sense() * deg_s.to_radians());
            Point::new(deg_s, threshold_rad.to_degrees())
        });
        let slower = Mark {
            at: slowest_deg_s,
            name: "slower: no catch".to_owned(),
        };
        Self {
            line: line.to_vec(),
            marks: (slowest_deg_s > 0.0)
                .then_some(slower)
                .into_iter()
                .collect(),
        }
    }
}
