//! Angles at which a spastic muscle caught, against the speed of the stretch.

use crate::plot::palette::{AXIS, TEXT};
use crate::plot::{
    Axis, Chart, CurveStyle, Figure, Key, Mark, Marker, Panel, Paper, Point, Sign, stack,
};
use crate::report::symptom_chart::{WIDE, WIDTH};
use crate::report::symptoms::Symptom;
use crepitus_model::render::effects::spasticity::SpasticitySettings;
use crepitus_scene::static_limits::spasticity;

const HEIGHT: f64 = 320.0;

/// The figure, if there was a catch.
pub(crate) fn figure(
    symptom: &Symptom,
    settings: Option<&SpasticitySettings>,
    paper: Paper,
) -> Option<Figure> {
    if symptom.words.effect() != "spasticity" {
        return None;
    }
    let caught = caught(symptom);
    let fastest = caught.iter().map(|p| p.x).fold(f64::NAN, f64::max);
    if fastest.is_nan() {
        return None;
    }
    let law = settings.map(|settings| Law::of(settings, 1.2 * fastest));
    let line = law.iter().flat_map(|law| &law.line);
    let y = Axis::covering(caught.iter().chain(line).map(|p| p.y), 6);
    let x = Axis::linear(0.0, 1.2 * fastest, 9);
    let panel = Panel::new(HEIGHT, x, ("Knee angle, flexion (°)", y), |plot| {
        plot.grid();
        if let Some(law) = &law {
            plot.line(&law.line, AXIS, WIDE);
            plot.moments(&law.marks);
        }
        for point in &caught {
            plot.mark((point.x, point.y), Marker::Circle, TEXT);
        }
    });
    let panel = panel
        .x_title(Some("Speed of the stretch (°/s)"))
        .moments(law.iter().flat_map(|law| law.marks.clone()).collect());
    let mut legend = vec![Key::new(Sign::Filled(CurveStyle::NEUTRAL), "a catch")];
    if law.is_some() {
        legend.push(Key::new(Sign::Line(AXIS), "where the settings put it"));
    }
    Some(Figure {
        name: "catch-angle",
        title: "Angle of catch against speed",
        legend,
        charts: vec![Chart::full(stack(
            paper.width(WIDTH),
            "Knee angle at each catch against the speed of the stretch",
            vec![panel],
        ))],
        caption: "Where the muscle answered each stretch, and how fast the stretch was there: the \
                  faster, the earlier. A joint that is only stiff or contracted would answer at \
                  one angle whatever the speed."
            .to_owned(),
    })
}

/// Every catch: (deg/s, deg).
fn caught(symptom: &Symptom) -> Vec<Point> {
    let caught = symptom.found.caught().map(|met| {
        let event = &met.event;
        let deg_s = event.omega_rad_s.abs().to_degrees();
        Point::new(deg_s, event.angle_rad.to_degrees())
    });
    caught.collect()
}

/// Angle at which the settings put a catch, over the speed of the stretch.
struct Law {
    /// (deg/s, deg)
    line: Vec<Point>,
    marks: Vec<Mark>,
}

impl Law {
    fn of(settings: &SpasticitySettings, to_deg_s: f64) -> Self {
        let slowest_deg_s = spasticity::slowest_rad_s(settings).to_degrees();
        let ends = [slowest_deg_s, to_deg_s.max(slowest_deg_s)];
        let line = ends.map(|deg_s| {
            let omega_rad_s = spasticity::sense(settings) * deg_s.to_radians();
            let threshold_rad = spasticity::threshold_rad(settings, omega_rad_s);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::fixture::symptom::STEPPED;
    use crate::report::symptoms::tests::examined;
    use crepitus_model::Tabled;

    #[test]
    fn catches_are_on_the_line_in_degrees_and_seconds() {
        for (place, expected) in [
            (3, [(90.0, 52.5), (130.0, 42.5)]),
            (4, [(30.0, 66.9), (90.0, 50.7)]),
        ] {
            let (settings, symptoms) = examined(place, STEPPED);
            let settings = settings.spasticity.expect("on");
            let points = caught(&symptoms.list[0]);
            let Law { line, .. } = Law::of(&settings, 200.0);
            let slope = (line[1].y - line[0].y) / (line[1].x - line[0].x);
            assert_eq!(points.len(), 2);
            for (point, (deg_s, deg)) in points.iter().zip(expected) {
                assert!((point.x - deg_s).abs() < 0.01, "{point:?}");
                assert!((point.y - deg).abs() < 0.01, "{point:?}");
                let on_line = line[0].y + slope * (point.x - line[0].x);
                assert!((point.y - on_line).abs() < 0.01, "{point:?} {on_line}");
            }
        }
    }

    #[test]
    fn flexors_are_caught_later_in_flexion_the_faster() {
        let settings = SpasticitySettings {
            muscles: 1,
            ..SpasticitySettings::defaults()
        };
        let Law { line, marks } = Law::of(&settings, 90.0);
        let at = |n: usize| (line[n].x, line[n].y);
        assert!((at(0).0 - 40.0).abs() < 1e-9 && (at(0).1 - 85.0).abs() < 1e-9);
        assert!((at(1).0 - 90.0).abs() < 1e-9 && (at(1).1 - 97.5).abs() < 1e-9);
        assert_eq!(marks.len(), 1);
    }
}
