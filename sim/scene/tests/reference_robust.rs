//! The reference where it has been wrong, or did not end: motions that end
//! with the run, Ts = Tk, and how often it is asked.

use crepitus_model::{Convention, Event, EventKind, Parameters, Phase, Sense, Settings};
use crepitus_plant::Motion;
use crepitus_plant::motion::{Strokes, VelocityKnot};
use crepitus_scene::reference::{Follow, Reference};
use crepitus_scene::{Observer, Overrides, Scene, run};
use std::ops::ControlFlow;
use std::path::Path;

fn joint(convention: Convention, kinetic: f64, limit: f64, damping_ratio: f64) -> Settings {
    let mut parameters = Parameters {
        kinetic_torque_nm: kinetic,
        static_torque_nm: limit,
        ..Parameters::default()
    };
    parameters.damping_nms_per_rad = 2.0 * damping_ratio * parameters.impedance_nms_per_rad();
    Settings {
        parameters,
        convention,
        ..Settings::default()
    }
}

/// Knots as (time, velocity before, velocity after).
fn knots(knots: &[(f64, f64, f64)]) -> Motion {
    let knots: Vec<_> = knots
        .iter()
        .map(
            |&(time_s, omega_left_rad_s, omega_right_rad_s)| VelocityKnot {
                time_s,
                omega_left_rad_s,
                omega_right_rad_s,
            },
        )
        .collect();
    Motion::velocity_knots(&knots)
}

fn events(settings: &Settings, motion: &Motion, to_s: f64) -> Vec<Event<f64>> {
    let settings = settings.validate().unwrap();
    let mut counted = Counted(Vec::new());
    let end = Reference::new(&settings, motion).follow(to_s, &mut counted);
    let last = counted.0.last_chunk::<3>();
    assert_eq!(end, ControlFlow::Continue(()), "{settings:?} {last:#?}");
    counted.0
}

/// Keeps events, up to far more than there can be in a second or two.
struct Counted(Vec<Event<f64>>);

impl Follow for Counted {
    type Stop = &'static str;

    fn event(&mut self, event: Event<f64>) -> ControlFlow<&'static str> {
        self.0.push(event);
        if self.0.len() > 10_000 {
            ControlFlow::Break("chatters")
        } else {
            ControlFlow::Continue(())
        }
    }

    fn poll(&mut self, _: f64) -> ControlFlow<&'static str> {
        ControlFlow::Continue(())
    }
}

/// Ends a run that polls more often than a short run can.
struct Impatient {
    polls: u32,
    events: u32,
}

impl Follow for Impatient {
    type Stop = &'static str;

    fn event(&mut self, _: Event<f64>) -> ControlFlow<&'static str> {
        self.events += 1;
        ControlFlow::Continue(())
    }

    fn poll(&mut self, _: f64) -> ControlFlow<&'static str> {
        self.polls += 1;
        if self.polls > 1000 {
            ControlFlow::Break("does not end")
        } else {
            ControlFlow::Continue(())
        }
    }
}

#[test]
fn a_recording_that_ends_with_the_run_ends() {
    let folder = tempfile::tempdir().unwrap();
    let rows = (0..=10).map(|i| 0.1 * f64::from(i));
    let rows: Vec<_> = rows
        .map(|t| format!("{t},{}", 30.0 * (3.0 * t).sin()))
        .collect();
    let table = format!("t,angle\n{}\n", rows.join("\n"));
    std::fs::write(folder.path().join("knee.csv"), table).unwrap();
    for solver in [
        "kind = \"reference\"",
        "kind = \"exact-events\"\nstep_s = 5e-5",
    ] {
        for duration_s in [1.0, 0.999_999_999_9, 0.95] {
            let text = format!(
                "version = 1\ntitle = \"ends\"\nduration_s = {duration_s:?}\n\
                 [motion]\nkind = \"recording\"\nfile = \"knee.csv\"\ntime_column = \"t\"\n\
                 angle_column = \"angle\"\nunit = \"deg\"\ncutoff_hz = 2\n\
                 [solver]\n{solver}\n[effects.crepitus]\npreset = \"coarse\"\n"
            );
            let path = folder.path().join("scene.toml");
            let scene = Scene::parse(&path, &text, &Overrides::default()).unwrap();
            let settings = scene.crepitus.unwrap().settings;
            let mut reference = Reference::new(&settings, &scene.motion);
            let mut impatient = Impatient {
                polls: 0,
                events: 0,
            };
            let end = reference.follow(duration_s, &mut impatient);
            assert_eq!(end, ControlFlow::Continue(()));
            assert!(impatient.events > 10, "{}", impatient.events);
            // With rows, and with a walk over the pieces in steps.
            let summary = run(&scene, &mut crepitus_scene::run::Blind).unwrap();
            assert!((summary.simulated_s - duration_s).abs() < 1e-4);
        }
    }
}

/// However strong the damping, a slip is searched with a few evaluations: without a bound of
/// its own for two exponentials it took one for every few nanoseconds.
#[test]
fn a_slip_without_swings_takes_no_longer_than_others() {
    let motion = knots(&[(0.0, 0.0, 2.0), (0.02, 2.0, -2.0), (0.05, -2.0, 0.0)]);
    for ratio in [0.5, 1.0, 2.0, 100.0, 1e4, 1e5] {
        let settings = joint(Convention::Paper, 0.2, 0.4, ratio);
        let settings = settings.validate().unwrap();
        let mut impatient = Impatient {
            polls: 0,
            events: 0,
        };
        let end = Reference::new(&settings, &motion).follow(0.05, &mut impatient);
        assert_eq!(end, ControlFlow::Continue(()));
        assert!(
            impatient.events >= 3,
            "ζ = {ratio}: {} events",
            impatient.events
        );
        assert_eq!(impatient.polls, 0, "ζ = {ratio}");
    }
}

#[test]
fn equal_limits_reverse_with_the_shaft() {
    let settings = joint(Convention::Physical, 0.3, 0.3, 0.0);
    let motion = knots(&[(0.0, 1.0, 1.0), (0.004, 1.0, 1.0), (0.006, -1.0, -1.0)]);
    let events = events(&settings, &motion, 0.05);
    let kinds: Vec<_> = events.iter().map(|e| e.kind).collect();
    assert_eq!(events.len(), 6, "{kinds:?}");
    let reverse = events
        .iter()
        .find(|e| e.kind == EventKind::Reverse)
        .unwrap();
    assert!((reverse.fraction - 4.233e-3).abs() < 1e-6, "{reverse:?}");
}

#[test]
fn equal_limits_stick_where_the_shaft_is_overtaken() {
    let settings = joint(Convention::Physical, 0.3, 0.3, 0.0);
    let motion = knots(&[(0.0, 0.1, 0.1), (0.0005, 0.1, 0.15)]);
    let events = events(&settings, &motion, 0.05);
    let stick = events.iter().find(|e| e.kind == EventKind::Stick).unwrap();
    assert!((stick.fraction - 2.694e-3).abs() < 1e-6, "{stick:?}");
}

#[test]
fn a_touch_is_no_event_for_as_long_as_the_shaft_keeps_its_speed() {
    for convention in [Convention::Paper, Convention::Physical, Convention::Frozen] {
        let settings = joint(convention, 0.3, 0.3, 0.0);
        for speed in [0.01, 0.988, -7.3] {
            let events = events(&settings, &Motion::constant(speed), 10.0);
            assert_eq!(events.len(), 1, "{convention:?} {speed}");
            assert_eq!(events[0].kind, EventKind::Break);
        }
    }
}

/// A touch is no event where the search has to find it: a knot that changes nothing takes
/// away the closed form of a steady slip.
#[test]
fn a_touch_is_no_event_beyond_a_knot_either() {
    let motion = knots(&[(0.0, 1.0, 1.0), (0.01, 1.0, 1.0), (0.05, 1.0, 1.0)]);
    for convention in [Convention::Paper, Convention::Physical] {
        let events = events(&joint(convention, 0.3, 0.3, 0.0), &motion, 1.0);
        assert_eq!(events.len(), 1, "{convention:?} {events:?}");
    }
}

/// An object that has decayed to nothing while the shaft paused sticks as the
/// shaft starts back, and not a window of the search later.
#[test]
fn a_dead_object_sticks_as_the_shaft_starts_back() {
    let settings = joint(Convention::Physical, 0.2, 0.4, 1.0 + 1e-10);
    let motion = Motion::Strokes(Strokes {
        from_rad: 0.0,
        to_rad: 0.5,
        peak_speed_rad_s: 0.4,
        pause_s: 10.0,
    });
    let events = events(&settings, &motion, 30.0);
    let back_s = 1.875 * 0.5 / 0.4 + 10.0;
    let stick = events.iter().find(|e| e.kind == EventKind::Stick).unwrap();
    assert!(
        stick.fraction <= back_s + 1e-9 && stick.omega_rad_s.abs() < 1e-12,
        "{stick:?}, the shaft starts back at {back_s} s"
    );
}

/// Motions on which the velocities meet, touch, and part.
fn motions() -> Vec<(&'static str, Motion)> {
    vec![
        ("constant", Motion::constant(0.988)),
        ("sine", Motion::sine(0.78, 0.25, -90.0)),
        ("quick sine", Motion::sine(0.05, 3.0, 20.0)),
        (
            "knots",
            knots(&[
                (0.0, 0.1, 0.1),
                (0.1, 0.1, 0.5),
                (0.2, -0.5, -0.5),
                (0.200_000_001, -0.5, 0.0),
                (0.3, 0.0, 0.0),
                (0.5, 2.0, 1.0),
            ]),
        ),
    ]
}

/// Every settings × motion of this file's laws.
fn everything() -> impl Iterator<Item = (String, Settings, Motion)> {
    let conventions = [Convention::Frozen, Convention::Paper, Convention::Physical];
    conventions.into_iter().flat_map(|convention| {
        let limits = [(0.2, 0.4), (0.3, 0.3), (0.0, 0.3), (0.399_999, 0.4)];
        limits.into_iter().flat_map(move |(kinetic, limit)| {
            let dampings: &[f64] = match convention {
                Convention::Frozen => &[0.0],
                Convention::Paper | Convention::Physical => &[0.0, 1e-3, 0.27, 1.0, 3.0],
            };
            dampings.iter().flat_map(move |&ratio| {
                motions().into_iter().map(move |(name, motion)| {
                    let settings = joint(convention, kinetic, limit, ratio);
                    let name = format!("{convention:?} {kinetic}/{limit} ζ {ratio} {name}");
                    (name, settings, motion)
                })
            })
        })
    })
}

#[test]
fn the_events_do_not_depend_on_how_often_the_state_is_asked_for() {
    for (name, settings, motion) in everything() {
        let once = events(&settings, &motion, 1.5);
        let valid = settings.validate().unwrap();
        for rows in [7, 1500, 30_000] {
            let mut reference = Reference::new(&valid, &motion);
            let mut often = Vec::new();
            for n in 1..=rows {
                let to_s = 1.5 * f64::from(n) / f64::from(rows);
                reference.advance(to_s, |event| often.push(event));
            }
            let same = once.len() == often.len()
                && once
                    .iter()
                    .zip(&often)
                    .all(|(a, b)| a.kind == b.kind && a.fraction.to_bits() == b.fraction.to_bits());
            assert!(
                same,
                "{name}: {} events at once, {} over {rows} rows",
                once.len(),
                often.len()
            );
        }
    }
}

/// s·(Ω − θ̇) ≥ 0 in every slip of `paper` and `physical`, to rounding: friction
/// never pushes the shaft along.
#[test]
fn in_a_slip_the_shaft_is_never_behind() {
    let mut slips = 0_u32;
    for (name, settings, motion) in everything() {
        if settings.convention == Convention::Frozen {
            continue;
        }
        let valid = settings.validate().unwrap();
        let mut reference = Reference::new(&valid, &motion);
        for n in 1..=15_000 {
            reference.advance(1e-4 * f64::from(n), |_| {});
            let Phase::Slip(sense) = reference.phase() else {
                continue;
            };
            slips += 1;
            let (omega, v) = (reference.shaft().omega_rad_s, reference.theta_dot_rad_s());
            let lead = match sense {
                Sense::Positive => omega - v,
                Sense::Negative => v - omega,
            };
            assert!(
                lead >= -1e-13 * (omega.abs() + v.abs() + 1.0),
                "{name} at {} s: {lead:e}",
                1e-4 * f64::from(n)
            );
        }
    }
    assert!(slips > 100_000, "{slips}");
}

/// A run of an hour without rows still checks now and then for cancellation.
#[test]
fn a_run_can_be_ended_where_nothing_is_written() {
    struct Patience(u32);
    impl Observer for Patience {
        type Error = &'static str;

        fn progress(&mut self, _: f64) -> Result<(), Self::Error> {
            self.0 += 1;
            if self.0 > 3 { Err("enough") } else { Ok(()) }
        }
    }
    let text = "version = 1\ntitle = \"long\"\nduration_s = 3600\n\
                [motion]\nkind = \"sine\"\namplitude_deg = 45\nfrequency_hz = 2\n\
                [solver]\nkind = \"reference\"\n[output]\ntrace_step_s = 3600\n\
                [effects.crepitus]\npreset = \"fine\"\n";
    let scene = Scene::parse(Path::new("long.toml"), text, &Overrides::default()).unwrap();
    assert!(run(&scene, &mut Patience(0)).is_err());
}

/// A stroke that ends at 0°, where the angle and the spring's anchor cancel: a torque that is
/// beyond its limit by rounding has not met it again.
#[test]
fn a_play_that_turns_back_at_zero_does_not_chatter() {
    for (mode, to_deg) in [("time", 0.0), ("space", 0.0), ("time", 1.0)] {
        let text = format!(
            "version = 1\ntitle = \"turns\"\nduration_s = 0.2\n\
             [motion]\nkind = \"strokes\"\nfrom_deg = 2\nto_deg = {to_deg:?}\n\
             peak_speed_deg_s = 346\npause_s = 0\n[solver]\nkind = \"reference\"\n\
             [effects.cogwheel]\nmode = \"{mode}\"\n[output]\nplay_events = true\n"
        );
        let scene = Scene::parse(Path::new("scene.toml"), &text, &Overrides::default()).unwrap();
        let mut words = Words(0);
        run(&scene, &mut words).unwrap();
        assert!(
            (1..50).contains(&words.0),
            "{mode}, {to_deg}: {} events",
            words.0
        );
    }
}

struct Words(usize);

impl Observer for Words {
    type Error = std::convert::Infallible;

    fn symptom(&mut self, _: &crepitus_scene::trace::SymptomEvent) -> Result<(), Self::Error> {
        self.0 += 1;
        Ok(())
    }
}
