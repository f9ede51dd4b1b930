//! A few cycles from near: torque, phases, events, what the hand feels of it,
//! and below them the velocities of shaft and object, which meet where the
//! object sticks.

use crepitus_model::EventKind;

use crate::plot::number::rounded;
use crate::plot::palette::{MOTOR, OBJECT, SHAFT, TORQUE};
use crate::plot::{Axis, Chart, Figure, Key, Marker, Panel, Paper, Point, Sign, Svg, stack};

use crate::report::chart_motion::degrees;
use crate::report::collector::Figures;
use crate::report::levels;
use crate::report::phases::{self, shade};
use crate::report::plant::{LEG, Plant};
use crate::report::symptoms::Symptom;
use crate::report::window::Window;

const TORQUE_HEIGHT: f64 = 290.0;
const HAND_HEIGHT: f64 = 150.0;
const VELOCITY_HEIGHT: f64 = 235.0;

/// A window with the words that say which one it is.
pub(crate) struct Titled<'w> {
    pub(crate) title: String,
    pub(crate) window: &'w Window,
}

const MARK_KEYS: [Key; 3] = [
    Key::new(Sign::Mark("▲"), "break"),
    Key::new(Sign::Mark("●"), "stick"),
    Key::new(Sign::Mark("◆"), "reverse"),
];

/// The windows of a run, named; the whole run if nothing ever happened.
pub(crate) fn windows(figures: &Figures) -> Vec<Titled<'_>> {
    let Some(onset) = &figures.onset else {
        if figures.whole.torque.is_empty() {
            return Vec::new();
        }
        return vec![Titled {
            title: "The whole run".to_owned(),
            window: &figures.whole,
        }];
    };
    let speed = |window: &Window| rounded(window.mean_speed().to_degrees());
    let mut list = vec![Titled {
        title: format!(
            "The onset, from {} s, at {} °/s on average",
            rounded(onset.view().0),
            speed(onset)
        ),
        window: onset,
    }];
    if let Some(fastest) = &figures.fastest {
        list.push(Titled {
            title: format!(
                "The fastest part, from {} s, at {} °/s on average",
                rounded(fastest.view().0),
                speed(fastest)
            ),
            window: fastest,
        });
    }
    list
}

pub(crate) fn figure(figures: &Figures, paper: Paper) -> Option<Figure> {
    let windows = windows(figures);
    let any = |is: fn(&Window) -> bool| windows.iter().any(|titled| is(titled.window));
    let has_motor = any(|window| !window.motor.is_empty());
    // Without object and motor it would be the figure of the torque again.
    if windows.is_empty() || !(figures.has_object || has_motor) {
        return None;
    }
    let shown = if figures.has_object {
        "A few cycles"
    } else {
        "Torque of model and motor"
    };
    let mut charts = Vec::new();
    for Titled { title, window } in &windows {
        let svg = chart(figures, window, &format!("{shown}: {title}"), paper);
        charts.push(Chart {
            heading: Some(title.clone()),
            svg,
            half: false,
        });
    }
    let happened = figures.onset.is_some();
    let mut legend = if figures.plant.is_some() {
        vec![Key::new(Sign::Line(TORQUE), "torque of the model")]
    } else {
        vec![Key::new(Sign::Line(TORQUE), "torque")]
    };
    if has_motor {
        legend.push(Key::new(Sign::Line(MOTOR), "torque of the motor"));
    }
    if any(feels) {
        legend.push(Key::new(Sign::Line(LEG), "hand torque, fast part"));
    }
    if figures.has_object {
        legend.push(Key::new(Sign::Line(SHAFT), "shaft velocity Ω"));
        legend.push(Key::new(Sign::Line(OBJECT), "object velocity θ̇"));
        legend.extend(phases::keys(windows.iter().flat_map(|titled| {
            let (from, to) = titled.window.view();
            titled.window.spans(from, to).into_iter().map(|s| s.phase)
        })));
    }
    if happened {
        legend.extend(MARK_KEYS.into_iter().filter(|key| {
            // Reversals are rare: no key without one.
            key.text != "reverse"
                || windows
                    .iter()
                    .any(|w| w.window.count(EventKind::Reverse) > 0)
        }));
    }
    let mut caption = words(figures, happened).to_owned();
    if has_motor && figures.plant.as_ref().is_some_and(Plant::has_stages) {
        caption.push_str(
            " The motor's torque follows what is commanded: that of the model and what friction \
             compensation and bone shaping add.",
        );
    }
    if any(feels) {
        caption.push_str(
            " The fast part of the hand torque, the slow part taken away as above, is on an axis \
             of its own: it may be a small part of what the model renders, or more, where \
             something else strikes.",
        );
    }
    Some(Figure {
        name: "zoom",
        title: match (happened, figures.has_object) {
            (true, _) => "A zoom on a few cycles",
            (false, true) => "Torque and velocities",
            (false, false) => "Torque of model and motor",
        },
        legend,
        charts,
        caption,
    })
}

/// Description of what the charts show.
fn words(figures: &Figures, happened: bool) -> &'static str {
    let mut symptoms = figures.symptoms.iter().flat_map(|all| &all.list);
    if !figures.has_object {
        "What the model asks for, and the torque of the motor at the joint, from its current."
    } else if happened {
        "Single stick-slip cycles. While the object sticks (grey) the torque climbs from the \
         restart torque to the static limit Ts; there it breaks, the torque falls to Tk, and \
         the object swings freely on its spring until it sticks again: when its velocity meets \
         that of the shaft, or, in the frozen convention, when it would meet that of a steady \
         shaft. The climbs and falls are what is felt as crepitus; the time between them is \
         set by spring and inertia. Edges of the shading are the times of the events, not of \
         the rows."
    } else if symptoms.any(Symptom::shows_all) {
        // Ts bounds a part of the torque alone.
        "The object never broke loose: it moved with the shaft all the time, like a spring."
    } else {
        "The object never broke loose: the torque stayed within ±Ts and the object moved with \
         the shaft all the time, like a spring."
    }
}

/// Returns whether the torque at the hand is known for the cycles.
fn feels(window: &Window) -> bool {
    !window.hand_fast.is_empty()
}

/// The part of a line inside a window's view.
fn inside(points: Vec<Point>, (from, to): (f64, f64)) -> Vec<Point> {
    points
        .into_iter()
        .filter(|point| (from..=to).contains(&point.x))
        .collect()
}

fn chart(figures: &Figures, window: &Window, label: &str, paper: Paper) -> Svg {
    let view = window.view();
    let torque = inside(window.torque.points(), view);
    let motor = inside(window.motor.points(), view);
    let levels = levels::levels_in(figures.levels, &torque);
    let spans = window.spans(view.0, view.1);
    let room = 0.015 * (view.1 - view.0);
    let time = Axis::linear(view.0 - room, view.1 + room, 8);
    let feels = feels(window);
    let titled = |last: bool| last.then_some("Time (s)");

    let y = levels::torque_axis(&[torque.as_slice(), &motor].concat(), &levels);
    let names = levels::names(&y, &levels, TORQUE_HEIGHT);
    let panel = Panel::new(TORQUE_HEIGHT, time.clone(), ("Torque (N·m)", y), |plot| {
        shade(plot, &spans);
        if !motor.is_empty() {
            figures.shade_pushes(plot);
        }
        plot.grid();
        levels::draw(plot, &levels);
        plot.line(&motor, MOTOR, 1.5);
        plot.line(&torque, TORQUE, 1.75);
        for event in window.events() {
            // A break is marked where it happens, the others where they lead to.
            let (marker, torque) = match event.kind {
                EventKind::Break => (Marker::Triangle, event.torque_before_nm),
                EventKind::Stick => (Marker::Circle, event.torque_after_nm),
                EventKind::Reverse => (Marker::Diamond, event.torque_after_nm),
            };
            if torque.is_finite() && (view.0..=view.1).contains(&event.time_s) {
                plot.mark((event.time_s, torque), marker, TORQUE);
            }
        }
        if motor.is_empty() {
            figures.draw_marks(plot);
        } else {
            figures.draw_motor_marks(plot);
        }
    });
    let panel = panel.x_title(titled(!figures.has_object && !feels));
    let marks = if motor.is_empty() {
        figures.marks.clone()
    } else {
        figures.motor_marks()
    };
    let mut panels = vec![panel.names(names).right(levels::ROOM).moments(marks)];
    if feels {
        let fast = inside(window.hand_fast.points(), view);
        let y = Axis::covering(fast.iter().map(|p| p.y), 3);
        let spans = &spans;
        let panel = Panel::new(HAND_HEIGHT, time.clone(), ("Hand (N·m)", y), move |plot| {
            shade(plot, spans);
            plot.grid();
            plot.line(&fast, LEG, 1.5);
            figures.draw_marks(plot);
        });
        panels.push(panel.x_title(titled(!figures.has_object)));
    }
    if figures.has_object {
        let shaft = degrees(&inside(window.omega.points(), view));
        let object = degrees(&inside(window.theta_dot.points(), view));
        let y = Axis::covering(shaft.iter().chain(&object).map(|p| p.y), 5);
        let spans = &spans;
        let panel = Panel::new(VELOCITY_HEIGHT, time, ("Velocity (°/s)", y), move |plot| {
            shade(plot, spans);
            plot.grid();
            // Wider: while the object sticks it covers the shaft.
            plot.line(&shaft, SHAFT, 4.0);
            plot.line(&object, OBJECT, 1.5);
            figures.draw_marks(plot);
        });
        panels.push(panel.x_title(titled(true)));
    }
    stack(paper.width(960.0), label, panels)
}
