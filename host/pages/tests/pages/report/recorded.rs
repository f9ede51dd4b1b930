//! Reports of recordings: changes of parameters, and the push that arms.

use std::cell::RefCell;

use super::{SINE, collect, page, setup, text};
use crate::fixture::{Motion, Run, plant};
use crate::markup::{charts, count, on_a_desk};
use crepitus_pages::report::{Collector, Figures, Mark, html};

/// A recording of so many seconds: torque, motor, two changes of parameters,
/// and the push that arms it.
fn recorded(rows: u32, pushed_s: f64) -> Figures {
    let names = ["motor_torque_nm"];
    let columns = plant::columns(Run::columns(true, false), &names);
    let collector = RefCell::new(Collector::new(&setup(&columns, rows, 5e-5)));
    for (at, name) in [
        (0.1, "revision 3: kinetic_torque_nm = 0.25"),
        (0.4, "revision 4: 2 parameters"),
    ] {
        collector.borrow_mut().mark(Mark {
            at,
            name: name.to_owned(),
        });
    }
    collector
        .borrow_mut()
        .arming_push(pushed_s, pushed_s + 0.016);
    let last_s = f64::from(rows - 1) * 5e-5;
    Run::new(Motion::Constant { speed: 1.0 }, last_s, 5e-5).play(
        |row| collector.borrow_mut().row(&plant::row(row, row[6], &names)),
        |event| collector.borrow_mut().event(event),
    );
    collector.into_inner().finish()
}

#[test]
fn every_chart_over_time_says_when_parameters_changed() {
    for rows in [12_001, 200_001] {
        let page = page("recorded", &text("A recording"), &recorded(rows, 0.0));
        let over_time = charts(&page).filter(|chart| chart.contains(">Time (s)<"));
        let mut charts = 0;
        for chart in
            over_time.filter(|chart| chart.contains("whole run") || chart.contains("Motor torque"))
        {
            charts += 1;
            // Named once, above the panels; a line in each panel, and from the first up to the name.
            let panels = count(&chart, "rotate(-90");
            let marks = 2 + usize::from(chart.contains("Motor torque"));
            let in_panels = 2 * panels + marks - 2;
            assert_eq!(
                count(&chart, "stroke-dasharray=\"2 3\""),
                in_panels + marks,
                "{chart:.200}"
            );
            assert_eq!(
                count(&chart, ">revision 3: kinetic_torque_nm = 0.25</text>"),
                1
            );
        }
        // Motion, torque, motor.
        assert_eq!(charts, 3, "{rows}");
    }
    let page = page(
        "not-recorded",
        &text("No change"),
        &collect(SINE, 12_001, 5e-5, false),
    );
    assert_eq!(count(&page, "stroke-dasharray=\"2 3\""), 0);
}

#[test]
fn the_push_that_arms_is_shaded_and_named_on_the_motors_torque() {
    let page = page("armed", &text("A recording"), &recorded(12_001, 0.0));
    let named: Vec<String> = charts(&page)
        .filter(|chart| chart.contains(">arming: polarity test</text>"))
        .collect();
    // The motor's own chart, and the zoom in which it begins.
    assert_eq!(named.len(), 2);
    assert!(named.iter().all(|chart| chart.contains("fill=\"#c8d5e0\"")));
    assert!(page.contains("no torque that was rendered, and in no table"));
    // A zoom on another stretch of time does not show it.
    let later = on_a_desk(&html(&text("A recording"), &recorded(200_001, 5.0)));
    assert_eq!(count(&later, ">arming: polarity test</text>"), 1);
}
