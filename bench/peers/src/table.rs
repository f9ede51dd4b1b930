//! The result as Markdown.

use crate::contest::{Contestant, Who};
use crate::summary::Line;
use crate::verdict::Ratio;
use crate::work::{Task, Work};
use crepitus_scene::preset::Joint;
use std::fmt::Write as _;

/// The table and the ratios below it.
pub fn markdown(
    joint: &Joint,
    contestants: &[Contestant],
    ratios: &[Ratio],
    rounds: usize,
) -> String {
    let events = Work::new(joint.parameters).closed_form_events().len();
    let mut text = format!(
        "\n**{}** at a constant speed\n\n\
         | solver | setting | events of {events} | worst event error, s | events only, ms \
         | all samples, ms | samples in sticks only, ms | worst torque error, N·m |\n\
         |---|---|---|---|---|---|---|---|\n",
        joint.name,
    );
    for c in contestants {
        let score = c.results.iter().flatten().next().map(|r| r.score);
        let number = |x: Option<f64>| x.map_or("–".into(), |x| format!("{x:.1e}"));
        let time = |task| {
            c.result(task).map_or("–".into(), |r| {
                let mark = if c.who.tuned_for.contains(&task) {
                    "**"
                } else {
                    ""
                };
                let (ms, spread) = (1e3 * r.time.median.cpu_s, 100.0 * r.time.spread);
                format!("{mark}{}{mark} ±{:.0} %", digits(ms), spread / 2.0)
            })
        };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} |",
            name(&c.who),
            setting(&c.who),
            score.map_or("gave up".into(), |s| s.events.to_string()),
            number(score.and_then(|s| s.event_error_s)),
            time(Task::Events),
            time(Task::Samples),
            time(Task::SamplesInStick),
            number(
                c.result(Task::Samples)
                    .and_then(|r| r.score.torque_error_nm)
            ),
        );
    }
    let _ = writeln!(
        text,
        "\nCPU time of one thread, median of {rounds} interleaved rounds ± half the distance of the \
         quartiles; wall time was {:.0} % above it in the median. Bold: the cheapest setting of the \
         method with all events within 1e-9 s.\n",
        100.0 * (waiting(contestants) - 1.0)
    );
    text.push_str(
        "| task | ours | best peer with all events within 1e-9 s | times faster | by wall time | asked for |\n\
         |---|---|---|---|---|---|\n",
    );
    for r in ratios {
        let asked = r.required.map_or("–".into(), |x| {
            format!(
                "≥ {x}: {}",
                if r.holds() { "holds" } else { "does not hold" }
            )
        });
        let _ = writeln!(
            text,
            "| {} | {} | {}, {} | {:.1} | {:.1} | {asked} |",
            task(r.task),
            name(&r.ours),
            name(&r.peer),
            setting(&r.peer),
            r.cpu,
            r.wall,
        );
    }
    text
}

/// A ratio for the summary.
pub fn line(joint: &Joint, ratio: &Ratio) -> Line {
    let [ours_time, peer_time] = ratio.times;
    let work = match ratio.task {
        Task::Samples => "constant, all samples",
        Task::SamplesInStick => "constant, samples in sticks",
        Task::Events => "constant, events",
    };
    Line {
        joint: joint.name,
        work: work.into(),
        ours: ratio.ours.method.clone(),
        ours_time,
        peer: Some((name(&ratio.peer), peer_time)),
        required: ratio.required,
    }
}

fn name(who: &Who) -> String {
    format!("{} {}", who.library, who.method)
}

fn setting(who: &Who) -> String {
    who.setting.map_or("–".into(), |s| {
        let limit = if s.limited { ", step limited" } else { "" };
        let tolerance = format!("{:.1e}", s.tolerance).replace(".0e", "e");
        format!("{tolerance}{limit}")
    })
}

fn task(task: Task) -> &'static str {
    match task {
        Task::Samples => "all events and samples",
        Task::SamplesInStick => "the same, known torque (slips) filled in by both",
        Task::Events => "events only",
    }
}

/// Two or three digits.
fn digits(ms: f64) -> String {
    if ms < 0.01 {
        format!("{ms:.5}")
    } else if ms < 0.1 {
        format!("{ms:.4}")
    } else if ms < 1.0 {
        format!("{ms:.3}")
    } else if ms < 10.0 {
        format!("{ms:.2}")
    } else {
        format!("{ms:.1}")
    }
}

/// Wall time over CPU time, the median of all.
fn waiting(contestants: &[Contestant]) -> f64 {
    let mut shares: Vec<f64> = contestants
        .iter()
        .flat_map(|c| c.results.iter().flatten())
        .map(|r| r.time.median.wall_s / r.time.median.cpu_s)
        .collect();
    shares.sort_by(f64::total_cmp);
    shares.get(shares.len() / 2).copied().unwrap_or(1.0)
}
