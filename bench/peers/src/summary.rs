//! Ours beside the best peer: a line for each joint, motion, task and convention.

use crate::measure::Summary;
use serde::Serialize;
use std::fmt::Write as _;

/// Ours against the best peer at one piece of work.
#[derive(Clone, Debug, Serialize)]
pub struct Line {
    /// Preset of the joint.
    pub joint: &'static str,
    /// Motion, and the task where there are several.
    pub work: String,
    /// Our solver and its convention.
    pub ours: String,
    /// Our time.
    pub ours_time: Summary,
    /// The fastest peer that is good enough; none if there is none.
    pub peer: Option<(String, Summary)>,
    /// Required ratio, where one is claimed.
    pub required: Option<f64>,
}

impl Line {
    /// Times faster than the peer, and the spread of that, relative: half the distances of the
    /// quartiles of both times.
    fn ratio(&self) -> Option<(f64, f64)> {
        let (_, peer) = self.peer.as_ref()?;
        let ratio = peer.median.cpu_s / self.ours_time.median.cpu_s;
        Some((ratio, f64::midpoint(peer.spread, self.ours_time.spread)))
    }
}

/// The lines as a table.
pub fn markdown(lines: &[&Line]) -> String {
    let mut text = String::from(
        "\n**Ours beside the best peer**\n\n\
         | joint | motion | ours | µs | best peer | µs | times faster | asked for |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for line in lines {
        let us = |time: &Summary| {
            let us = 1e6 * time.median.cpu_s;
            let digits = if us < 10.0 { 2 } else { 0 };
            format!("{us:.digits$} ±{:.0} %", 50.0 * time.spread)
        };
        let (peer, peer_us) = line.peer.as_ref().map_or_else(
            || ("none finds every event".to_owned(), "–".to_owned()),
            |(name, time)| (name.clone(), us(time)),
        );
        let ratio = line.ratio().map_or("–".into(), |(ratio, spread)| {
            let beyond = if (ratio - 1.0).abs() > ratio * spread {
                ""
            } else {
                ", a draw within the spread"
            };
            format!("{ratio:.2} ±{:.0} %{beyond}", 100.0 * spread)
        });
        let asked = match (line.required, line.ratio()) {
            (None, _) => "nothing".to_owned(),
            (Some(least), Some((ratio, _))) if ratio >= least => format!("≥ {least}: holds"),
            (Some(least), _) => format!("≥ {least}: does not hold"),
        };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {peer} | {peer_us} | {ratio} | {asked} |",
            line.joint,
            line.work,
            line.ours,
            us(&line.ours_time),
        );
    }
    text.push_str("\nCPU time of the whole work, median ± half the distance of the quartiles.\n");
    text
}
