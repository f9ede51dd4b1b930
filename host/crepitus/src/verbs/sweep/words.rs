//! Numbers of a sweep for people.

use super::Ran;

/// Number of runs, and the time that they took.
pub(super) fn ran(runs: u64, ran: &Ran) -> String {
    let threads = match ran.threads {
        1 => "one thread".to_owned(),
        threads => format!("{threads} threads"),
    };
    let before = runs - ran.runs.min(runs);
    let before = match before {
        0 => String::new(),
        before => format!(", {before} were there already"),
    };
    format!(
        "{} runs in {} on {threads}{before}",
        ran.runs,
        time(ran.wall_s)
    )
}

/// A time.
pub(super) fn time(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.1} h", s / 3600.0),
        s => format!("{:.1} days", s / 86_400.0),
    }
}

/// A size.
#[expect(clippy::cast_precision_loss, reason = "three digits are shown")]
pub(super) fn size(bytes: u64) -> String {
    match bytes {
        0..1_000_000 => format!("{:.1} kB", bytes as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", bytes as f64 / 1e6),
        _ => format!("{:.1} GB", bytes as f64 / 1e9),
    }
}
