//! A few cycles from near: torque, phases, events, what the hand feels of it,
//! and below them the velocities of shaft and object, which meet where the
//! object sticks.

use crepitus_model::EventKind;

use crate::ReportError;
use crate::axis::Axis;
use crate::canvas::{Area, Drawn, Panel, px, svg};
use crate::chart_motion::degrees;
use crate::chart_torque::shade;
use crate::collector::Figures;
use crate::figure::{Chart, Figure, Key, Sign, Titled, phase_keys};
use crate::levels;
use crate::number::rounded;
use crate::palette::{CURVES, Ink, OBJECT, SHAFT, TORQUE};
use crate::plant::{LEG, Plant};
use crate::thinned::Point;
use crate::window::Window;

const TORQUE_HEIGHT: u32 = 290;
const HAND_HEIGHT: u32 = 150;
const VELOCITY_HEIGHT: u32 = 235;

/// The torque of the motor: `purple` in the style sheet.
const MOTOR: Ink = CURVES[3];

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

pub(crate) fn figure(figures: &Figures) -> Result<Option<Figure>, ReportError> {
    let windows = windows(figures);
    if windows.is_empty() {
        return Ok(None);
    }
    let mut charts = Vec::new();
    for Titled { title, window } in &windows {
        let mut height = TORQUE_HEIGHT;
        if feels(window) {
            height += HAND_HEIGHT;
        }
        if figures.has_object {
            height += VELOCITY_HEIGHT;
        }
        let svg = svg((960, height), &format!("A few cycles: {title}"), |area| {
            draw(area, figures, window)
        })?;
        charts.push(Chart {
            heading: Some(title.clone()),
            svg,
            half: false,
        });
    }
    let happened = figures.onset.is_some();
    let mut legend = if figures.plant.is_some() {
        vec![Key::new(Sign::Line("torque"), "torque of the model")]
    } else {
        vec![Key::new(Sign::Line("torque"), "torque")]
    };
    let any = |is: fn(&Window) -> bool| windows.iter().any(|titled| is(titled.window));
    if any(|window| !window.motor.is_empty()) {
        legend.push(Key::new(Sign::Line("purple"), "torque of the motor"));
    }
    if any(feels) {
        legend.push(Key::new(Sign::Line("green"), "hand torque, fast part"));
    }
    if figures.has_object {
        legend.push(Key::new(Sign::Line("shaft"), "shaft velocity Ω"));
        legend.push(Key::new(Sign::Line("object"), "object velocity θ̇"));
        legend.extend(phase_keys(windows.iter().flat_map(|titled| {
            let (from, to) = titled.window.view();
            titled.window.spans(from, to).into_iter().map(|s| s.phase)
        })));
    }
    let mut caption = if happened {
        legend.extend(MARK_KEYS.into_iter().filter(|key| {
            // Reversals are rare: no key without one.
            key.text != "reverse"
                || windows
                    .iter()
                    .any(|w| w.window.count(EventKind::Reverse) > 0)
        }));
        "Single stick-slip cycles. While the object sticks (grey) the torque climbs from the \
         restart torque to the static limit Ts; there it breaks, the torque falls to Tk, and \
         the object swings freely on its spring until it sticks again: when its velocity meets \
         that of the shaft, or, in the frozen convention, when it would meet that of a steady \
         shaft. The climbs and falls are what is felt as crepitus; the time between them is \
         set by spring and inertia. Edges of the shading are the times of the events, not of \
         the rows."
    } else {
        "The object never broke loose: the torque stayed within ±Ts and the object moved with \
         the shaft all the time, like a spring."
    }
    .to_owned();
    if any(|window| !window.motor.is_empty())
        && figures.plant.as_ref().is_some_and(Plant::has_stages)
    {
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
    Ok(Some(Figure {
        name: "zoom",
        title: if happened {
            "A zoom on a few cycles"
        } else {
            "Torque and velocities"
        },
        legend,
        charts,
        caption,
    }))
}

/// Whether it is known what the hand feels of the cycles.
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

fn draw(area: &Area, figures: &Figures, window: &Window) -> Drawn {
    let view = window.view();
    let torque = inside(window.torque.points(), view);
    let motor = inside(window.motor.points(), view);
    let levels = levels::levels_in(figures.levels, &torque);
    let spans = window.spans(view.0, view.1);
    let room = 0.015 * (view.1 - view.0);
    let time = Axis::linear(view.0 - room, view.1 + room, 8);
    let (above, below) = area.split_vertically(px(TORQUE_HEIGHT));

    let mut plot = Panel {
        x: time.clone(),
        y: levels::torque_axis(&[torque.as_slice(), &motor].concat(), &levels),
        x_title: (!figures.has_object && !feels(window)).then_some("Time (s)"),
        y_title: "Torque (N·m)",
        right: levels::ROOM,
    }
    .on(&above)?;
    shade(&mut plot, &spans)?;
    plot.grid()?;
    levels::draw(&mut plot, &levels, TORQUE_HEIGHT)?;
    plot.line(&motor, MOTOR, 6)?;
    plot.line(&torque, TORQUE, 7)?;
    for event in window.events() {
        // A break is marked where it happens, the others where they lead to.
        let torque = match event.kind {
            EventKind::Break => event.torque_before_nm,
            EventKind::Stick | EventKind::Reverse => event.torque_after_nm,
        };
        if torque.is_finite() && (view.0..=view.1).contains(&event.time_s) {
            plot.mark((event.time_s, torque), event.kind, TORQUE)?;
        }
    }
    let below = if feels(window) {
        let (middle, below) = below.split_vertically(px(HAND_HEIGHT));
        let fast = inside(window.hand_fast.points(), view);
        let mut plot = Panel {
            x: time.clone(),
            y: Axis::covering(fast.iter().map(|p| p.y), 3),
            x_title: (!figures.has_object).then_some("Time (s)"),
            y_title: "Hand (N·m)",
            right: levels::ROOM,
        }
        .on(&middle)?;
        shade(&mut plot, &spans)?;
        plot.grid()?;
        plot.line(&fast, LEG, 6)?;
        below
    } else {
        below
    };
    if !figures.has_object {
        return Ok(());
    }

    let shaft = degrees(&inside(window.omega.points(), view));
    let object = degrees(&inside(window.theta_dot.points(), view));
    let mut plot = Panel {
        x: time,
        y: Axis::covering(shaft.iter().chain(&object).map(|p| p.y), 5),
        x_title: Some("Time (s)"),
        y_title: "Velocity (°/s)",
        right: levels::ROOM,
    }
    .on(&below)?;
    shade(&mut plot, &spans)?;
    plot.grid()?;
    // Wider: while the object sticks it covers the shaft.
    plot.line(&shaft, SHAFT, 16)?;
    plot.line(&object, OBJECT, 6)
}
