//! The hand of a page on the leg of a simulated device.

use crate::SIM;
use crate::page::{Frame, Page, Panel};
use crate::support::served::Served;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// Interval of a display's pictures.
const PICTURE: Duration = Duration::from_millis(16);

/// Angles of leg and hand in a bin, °: means of lowest and highest.
#[derive(Clone, Copy, Debug)]
struct Seen {
    time_s: f64,
    leg: f32,
    /// NaN while no hand has the leg.
    hand: f32,
}

/// The bins of a frame.
fn bins(frame: &Frame) -> impl Iterator<Item = Seen> {
    (0..frame.bins).map(move |bin| {
        let mean = |place| f32::midpoint(frame.value(bin, place), frame.value(bin, place + 1));
        Seen {
            time_s: frame.begin_s + f64::from(bin) * frame.bin_s,
            leg: mean(6).to_degrees(),
            hand: mean(8).to_degrees(),
        }
    })
}

fn seen(page: &Page) -> Vec<Seen> {
    page.frames.iter().flat_map(bins).collect()
}

fn newest(page: &Page) -> Option<Seen> {
    let mut newest_first = page.frames.iter().rev();
    newest_first.find_map(|frame| bins(frame).last())
}

/// Forgets what has come, also what waits to be read.
fn forget(page: &mut Page) {
    page.go_on(Duration::from_millis(300));
    page.frames.clear();
}

fn move_hand(page: &mut Page, deg: f32, holds: bool) {
    page.send(&json!({ "hand": deg, "holds": holds }).to_string());
}

/// Moves the hand there and waits until the leg is there, too: within the 7° by which the most rigid knee lags.
fn bring(page: &mut Page, deg: f32) {
    move_hand(page, deg, true);
    page.until("the leg", |page| {
        let there = |angle: f32, within: f32| (angle - deg).abs() < within;
        newest(page).is_some_and(|seen| there(seen.leg, 8.0) && there(seen.hand, 0.5))
    });
}

/// Waits until no hand has the leg.
fn until_free(page: &mut Page) {
    page.until("a free leg", |page| {
        newest(page).is_some_and(|seen| seen.hand.is_nan())
    });
}

#[test]
fn a_hand_moves_the_leg_and_gives_it_back() {
    let panel = Panel::new(&SIM);
    let mut page = panel.controlling();
    let reach = &page.latest["hello"]["source"]["hand"];
    assert_eq!(*reach, json!({ "least_deg": -4.0, "most_deg": 124.0 }));
    until_free(&mut page);
    for deg in [40.0, 95.0, 10.0] {
        bring(&mut page, deg);
    }
    // What is said once holds: the leg settles, and rests where the gear holds it back.
    page.go_on(Duration::from_secs(1));
    forget(&mut page);
    page.go_on(Duration::from_millis(2_500));
    let legs: Vec<_> = seen(&page).iter().map(|seen| seen.leg).collect();
    let [lowest, highest] =
        [f32::min, f32::max].map(|end| legs.iter().copied().reduce(end).unwrap());
    assert!(
        lowest > 8.0 && highest < 12.0 && highest - lowest < 0.5,
        "{lowest}° to {highest}°"
    );
    // Beyond what a brace may be armed at is its end.
    for (asked, reached) in [(1e9, 124.0), (-1e9, -4.0)] {
        move_hand(&mut page, asked, true);
        page.until("the end", |page| {
            newest(page).is_some_and(|seen| (seen.hand - reached).abs() < 0.1)
        });
    }
    move_hand(&mut page, 0.0, false);
    until_free(&mut page);
    // The examination goes on.
    page.frames.clear();
    page.until("two strokes", |page| {
        let legs: Vec<_> = seen(page).iter().map(|seen| seen.leg).collect();
        let highest = legs.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        highest > 75.0 && legs.last().is_some_and(|last| *last < 12.0)
    });
}

/// Mean angle by which the leg is behind a hand that goes from 30° to 80° at 40 °/s, °.
fn lag(page: &mut Page) -> f32 {
    bring(page, 30.0);
    page.frames.clear();
    let begun = Instant::now();
    loop {
        let deg = 30.0 + 40.0 * begun.elapsed().as_secs_f32();
        if deg > 80.0 {
            break;
        }
        move_hand(page, deg, true);
        page.go_on(PICTURE);
    }
    let lags: Vec<_> = (seen(page).iter())
        .filter(|seen| (45.0..70.0).contains(&seen.hand))
        .map(|seen| seen.hand - seen.leg)
        .collect();
    #[expect(clippy::cast_precision_loss, reason = "some hundred bins")]
    let count = lags.len() as f32;
    assert!(count > 20.0, "{count} bins");
    lags.iter().sum::<f32>() / count
}

/// UPDRS 4 is 3.5 N·m: 5° at the hand, and 2° in the cuff; the gear adds to it.
#[test]
fn the_leg_lags_where_the_knee_resists() {
    let panel = Panel::new(&SIM);
    let mut page = panel.controlling();
    let mut lag_of = |preset: &str| {
        page.ask("apply", json!({ "preset": preset })).unwrap();
        // While other tests keep the computer busy, torque may end: then it is tried again.
        for _ in 0..5 {
            page.arm();
            // The torque fades in.
            page.go_on(Duration::from_millis(500));
            let lag = lag(&mut page);
            if page.status("state") == "armed" {
                return lag;
            }
        }
        panic!("torque ends: {:?}", page.latest["status"]);
    };
    let (healthy, rigid) = (lag_of("healthy"), lag_of("updrs-4-lead-pipe"));
    println!("healthy {healthy:.1}°, rigid {rigid:.1}°");
    assert!(healthy.abs() < 2.5, "{healthy}");
    assert!((3.0..15.0).contains(&(rigid - healthy)), "{rigid}");
}

#[test]
fn the_page_in_control_alone_moves_the_leg() {
    let panel = Panel::new(&SIM);
    let mut viewer = panel.viewer_page();
    let mut second = panel.teacher_page();
    let mut page = panel.controlling();
    for other in [&mut viewer, &mut second] {
        move_hand(other, 100.0, true);
        other.go_on(Duration::from_millis(300));
        assert!(seen(other).iter().all(|seen| seen.hand.is_nan()));
        assert!(!other.is_closed);
    }
    bring(&mut page, 50.0);
    // All see the hand, and none of them lets it go.
    move_hand(&mut viewer, 50.0, false);
    move_hand(&mut second, 20.0, true);
    forget(&mut viewer);
    viewer.go_on(Duration::from_millis(500));
    let hands: Vec<_> = seen(&viewer).iter().map(|seen| seen.hand).collect();
    assert!(hands.len() > 20, "{}", hands.len());
    assert!(hands.iter().all(|hand| (hand - 50.0).abs() < 2.0));
}

#[test]
fn the_hand_of_a_page_that_has_gone_holds_still_then_lets_go() {
    let panel = Panel::new(&SIM);
    let mut viewer = panel.viewer_page();
    let mut page = panel.controlling();
    bring(&mut page, 30.0);
    forget(&mut viewer);
    move_hand(&mut page, 124.0, true);
    page.until("the first of the way", |page| {
        newest(page).is_some_and(|seen| seen.hand > 35.0)
    });
    drop(page);
    viewer.until("the hand", |viewer| {
        newest(viewer).is_some_and(|seen| seen.hand > 35.0)
    });
    until_free(&mut viewer);
    let held: Vec<_> = (seen(&viewer).into_iter())
        .filter(|seen| seen.hand.is_finite())
        .collect();
    let end = held.last().copied().unwrap();
    assert!(end.hand < 123.0, "{end:?}");
    // It has held still for most of two seconds.
    let still = held
        .iter()
        .find(|seen| (seen.hand - end.hand).abs() < 0.01)
        .unwrap();
    let still_s = end.time_s - still.time_s;
    assert!((1.5..2.5).contains(&still_s), "{still_s} s");
    // Another page takes the leg where it is.
    let mut page = panel.controlling();
    bring(&mut page, 60.0);
}

#[test]
fn a_flood_of_targets_is_the_last_of_them() {
    let panel = Panel::new(&SIM);
    let mut viewer = panel.viewer_page();
    let mut page = panel.controlling();
    viewer.frames.clear();
    for n in 0_u16..5_000 {
        move_hand(&mut page, f32::from(n % 120), true);
        if n % 100 == 0 {
            page.go_on(Duration::from_millis(1));
        }
    }
    bring(&mut page, 33.0);
    assert!(!page.is_closed);
    viewer.go_on(Duration::from_millis(300));
    assert!(viewer.frames.len() > 10, "{} frames", viewer.frames.len());
}

/// Messages of a viewer do not take the place of the target that the page in control has sent once.
#[test]
fn a_flood_of_a_viewer_replaces_no_target() {
    let panel = Panel::new(&SIM);
    let mut viewer = panel.viewer_page();
    let mut page = panel.controlling();
    for deg in [20.0, 60.0, 30.0, 70.0, 40.0, 80.0] {
        for n in 0..1_000 {
            move_hand(&mut viewer, 100.0, true);
            if n == 500 {
                move_hand(&mut page, deg, true);
            }
        }
        page.until("the leg", |page| {
            newest(page).is_some_and(|seen| (seen.hand - deg).abs() < 2.0)
        });
        viewer.go_on(PICTURE);
    }
    assert!(!viewer.is_closed);
}

#[test]
fn a_hand_that_no_page_sends_ends_its_connection() {
    let panel = Panel::new(&SIM);
    for text in [
        r#"{"hand":NaN,"holds":true}"#,
        r#"{"hand":1e999,"holds":true}"#,
        r#"{"hand":null,"holds":true}"#,
        r#"{"hand":"30","holds":true}"#,
        r#"{"hand":30}"#,
    ] {
        let mut page = panel.controlling();
        page.send(text);
        page.until("its close", |page| page.is_closed);
    }
    let mut page = panel.controlling();
    page.go_on(Duration::from_millis(100));
    assert!(newest(&page).is_some_and(|seen| seen.hand.is_nan()));
}

/// A brace is moved by the hand on it.
#[test]
fn a_device_at_a_port_has_no_such_hand() {
    let served = Served::new();
    let panel = Panel::at(&["--device", "knee"], Some(served.home.path()));
    let mut page = panel.controlling();
    assert_eq!(page.latest["hello"]["source"]["hand"], Value::Null);
    move_hand(&mut page, 60.0, true);
    page.go_on(Duration::from_millis(300));
    assert!(!page.is_closed);
    assert!(seen(&page).iter().all(|seen| seen.hand.is_nan()));
}
