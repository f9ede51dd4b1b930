//! Memory over long runs, and gaps that no figure reaches across.

use super::*;
use crate::report::fixture::{Motion, Run};
use crepitus_model::render::effects::EffectSettings;
use std::cell::RefCell;
use std::ops::Range;

#[test]
fn memory_does_not_grow_with_the_run() {
    let columns = Run::columns(true, true);
    let run = Run::new(Motion::Constant { speed: 1.0 }, 250.0, 5e-5);
    // Also with a row count that is far off.
    let collector = RefCell::new(Collector::new(&Setup {
        columns: &columns,
        rows_expected: 1000,
        row_step_s: 5e-5,
        levels: None,
        effects: EffectSettings::default(),
    }));
    run.with_encoder().play(
        |row| collector.borrow_mut().row(row),
        |event| collector.borrow_mut().event(event),
    );
    let figures = collector.into_inner().finish();
    assert!(figures.rows >= 5_000_000);
    assert!(figures.envelope.breaks() > 7000);
    assert!(figures.envelope.bins.len() <= Envelope::CAPACITY + 1);
    for line in [&figures.angle, &figures.omega, &figures.encoder_omega] {
        assert!(line.stored() <= LINE);
    }
    for window in [Some(&figures.whole), figures.onset.as_ref()] {
        let window = window.expect("recorded");
        assert!(window.torque.stored() <= LINE);
        assert!(window.orbit.stored() <= 4000);
        assert!(window.events().len() <= Window::EVENTS);
    }
    assert!(figures.hysteresis.stored() <= 2002);
    assert!(figures.spectrum.expect("long enough").points.len() <= 32_769);
}

#[test]
fn nor_with_that_of_a_plant() {
    use crate::report::fixture::plant as made;
    let columns = made::columns(Run::columns(true, false), &made::ALL);
    let collector = RefCell::new(Collector::new(&Setup {
        columns: &columns,
        rows_expected: 1000,
        row_step_s: 1e-3,
        levels: None,
        effects: EffectSettings::default(),
    }));
    Run::new(Motion::Constant { speed: 1.0 }, 300.0, 1e-3).play(
        |row| {
            let row = made::row(row, row[6], &made::ALL);
            collector.borrow_mut().row(&row);
        },
        |event| collector.borrow_mut().event(event),
    );
    let figures = collector.into_inner().finish();
    // Rows that were held back have come.
    assert_eq!(figures.rows, 300_001);
    assert!(figures.envelope.breaks() > 9000);
    let plant = figures.plant.expect("it has columns");
    assert_eq!(plant.columns.len(), 9);
    let courses = plant.columns.iter().map(|(_, course)| course);
    for course in courses.chain([&plant.hand, &plant.fast]) {
        assert!(!course.is_empty());
        assert!(course.stored() <= LINE + Envelope::CAPACITY + 1);
    }
    assert!(plant.leg.ahead.stored() <= LINE && plant.intended.omega.stored() <= LINE);
    let (low, high) = plant.fast.extent();
    assert!(high - low < 0.5, "the weight is gone: {low} to {high}");
}

/// Ten seconds, of which two are missing, or a part of the onset: nothing reaches across.
#[test]
fn no_phase_window_or_spectrum_reaches_across_a_gap() {
    let columns = Run::columns(true, false);
    let collect = |missing: &Range<f64>, says_so: bool| {
        let collector = RefCell::new(Collector::new(&Setup {
            columns: &columns,
            rows_expected: 160_000,
            row_step_s: 5e-5,
            levels: None,
            effects: EffectSettings::default(),
        }));
        let before = RefCell::new(0.0);
        Run::new(Motion::Constant { speed: 1.0 }, 10.0, 5e-5).play(
            |row| {
                if missing.contains(&row[0]) {
                    return;
                }
                let before = before.replace(row[0]);
                if says_so && row[0] - before > 1e-4 {
                    collector.borrow_mut().gap(before, row[0]);
                }
                collector.borrow_mut().row(row);
            },
            |event| {
                if !missing.contains(&event.time_s) {
                    collector.borrow_mut().event(event);
                }
            },
        );
        collector.into_inner().finish()
    };
    let known_s = |figures: &Figures| -> f64 {
        let bins = figures.envelope.bins.iter();
        bins.map(crate::report::envelope::Bin::known_s).sum()
    };
    let spans = |figures: &Figures, gap: &Range<f64>| {
        let window = figures.onset.as_ref().expect("a window");
        window.time.low < gap.start && window.time.high > gap.end
    };
    let gap = 4.0..6.0;
    let (with, without) = (collect(&gap, true), collect(&gap, false));
    assert_eq!((with.gaps.len(), without.gaps.len()), (1, 0));
    assert!((known_s(&with) - 8.0).abs() < 0.1, "{}", known_s(&with));
    assert!(known_s(&without) > 9.9);
    assert!(!spans(&with, &gap));
    let segments = |figures: &Figures| {
        let spectrum = figures.spectrum.as_ref().expect("long enough");
        spectrum.points.iter().map(|point| point.y).sum::<f64>()
    };
    assert!(segments(&with) != segments(&without));
    // A cycle lasts 31 ms, so the onset would last to 0.13 s.
    let gap = 0.05..0.1;
    let (with, without) = (collect(&gap, true), collect(&gap, false));
    assert!(spans(&without, &gap) && !spans(&with, &gap));
}

#[test]
fn a_run_without_rows_finishes() {
    let columns = Run::columns(true, false);
    let figures = Collector::new(&Setup {
        columns: &columns,
        rows_expected: 0,
        row_step_s: 0.0,
        levels: None,
        effects: EffectSettings::default(),
    })
    .finish();
    assert_eq!(figures.rows, 0);
    assert!(figures.onset.is_none() && figures.spectrum.is_none());
}
