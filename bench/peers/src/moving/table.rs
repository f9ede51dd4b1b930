//! Event-to-event times as Markdown.

use super::Setting;
use super::contest::{Case, Entrant};
use super::phases::StickBy;
use std::fmt::Write as _;

/// A table for each motion and convention.
pub fn markdown(cases: &[Case], rounds: usize) -> String {
    let mut text = String::new();
    for case in cases {
        let events = case.truth.len();
        let _ = write!(
            text,
            "\n**{}** ({}): {events} events\n\n\
             | solver | setting | events | worst difference, s | µs an event | we are faster by |\n\
             |---|---|---|---|---|---|\n",
            case.name(),
            case.hand.source,
        );
        let ours = &case.ours;
        let _ = writeln!(
            text,
            "| {} | – | {} | – | {} | – |",
            ours.name,
            ours.events,
            per_event(ours, events)
        );
        for peer in &case.peers {
            let ratio = case
                .ratios()
                .find(|(p, _)| std::ptr::eq(*p, peer))
                .map_or("not compared".into(), |(_, ratio)| format!("{ratio:.1}"));
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | {} | {ratio} |",
                peer.name,
                peer.setting.map_or("gave up".into(), setting),
                peer.events,
                peer.event_error_s
                    .map_or("–".into(), |e| format!("{e:.1e}")),
                per_event(peer, events),
            );
        }
    }
    let _ = writeln!(
        text,
        "\nCPU time of one thread over the number of events, median of {rounds} interleaved rounds ± half \
         the distance of the quartiles. Each peer at its cheapest setting with every event within \
         1e-9 s of `reference` (on the recorded knee 1e-7 s where it reaches no less); one that has no such \
         setting is shown with the nearest and not compared with."
    );
    text
}

/// Time per event that there is, µs.
#[expect(clippy::cast_precision_loss, reason = "few events")]
fn per_event(entrant: &Entrant, events: usize) -> String {
    entrant.time.map_or("–".into(), |t| {
        let us = 1e6 * t.median.cpu_s / events as f64;
        format!("{us:.3} ±{:.0} %", 50.0 * t.spread)
    })
}

fn setting(setting: Setting) -> String {
    let tolerance = format!("{:.1e}", setting.tolerance).replace(".0e", "e");
    let limit = setting.slip_limit_s.map_or(String::new(), |s| {
        format!(", slip steps ≤ {:.2} ms", 1e3 * s)
    });
    let stick = match setting.stick_by {
        StickBy::Integration => "θ integrated",
        StickBy::Position => "θ = φ + const",
    };
    format!("{tolerance}{limit}, sticks: {stick}")
}
