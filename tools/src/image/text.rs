//! A report as text.

use crate::image::report::{Finding, Report};
use std::fmt::Write;

/// A number in groups of three digits.
pub fn grouped(number: u32, separator: char) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (n, digit) in digits.chars().enumerate() {
        if n > 0 && (digits.len() - n).is_multiple_of(3) {
            text.push(separator);
        }
        text.push(digit);
    }
    text
}

/// The whole report.
pub fn render(report: &Report) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_report(&mut text, report);
    text
}

fn write_report(out: &mut String, report: &Report) -> std::fmt::Result {
    writeln!(out, "{}", report.image)?;
    writeln!(
        out,
        "\n  {:<8}{:>11}{:>11}{:>9}{:>12}",
        "bytes", "now", "recorded", "change", "available"
    )?;
    for size in &report.sizes {
        let mark = mark(size.at_least);
        let change = size.change_percent();
        let change = match size.recorded {
            0 => "new".to_owned(),
            _ => format!("{change:+.1} %"),
        };
        writeln!(
            out,
            "  {:<8}{:>11}{:>11}{change:>11}{:>12}",
            size.what,
            format!("{mark}{}", grouped(size.used, ',')),
            grouped(size.recorded, ','),
            grouped(size.available, ','),
        )?;
    }
    write_interrupts(out, report)?;
    write_stack(out, report)?;
    write_loops(out, report)?;
    write_panics(out, report)?;
    for (title, findings) in [("hint", &report.hints), ("FAIL", &report.failures)] {
        for finding in findings {
            write_finding(out, title, finding)?;
        }
    }
    let verdict = match report.failures.len() {
        0 => "passes".to_owned(),
        n => format!("fails: {n} finding{}", if n == 1 { "" } else { "s" }),
    };
    writeln!(out, "\n  {} {verdict}", report.image)
}

fn write_interrupts(out: &mut String, report: &Report) -> std::fmt::Result {
    if report.interrupts.is_empty() {
        return Ok(());
    }
    let width = report.interrupts.iter().map(|i| i.handler.len());
    let width = width.max().unwrap_or(0).max(9);
    writeln!(
        out,
        "\n  {:<width$} {:>4} {:>8} {:>5} {:>9} {:>12} {:>5} {:>7}",
        "interrupt", "irq", "priority", "gated", "functions", "instructions", "loops", "stack"
    )?;
    for i in &report.interrupts {
        let stack = format!("{}{}", mark(i.at_least), grouped(i.stack, ','));
        writeln!(
            out,
            "  {:<width$} {:>4} {:>8} {:>5} {:>9} {:>12} {:>5} {stack:>7}",
            i.handler,
            i.irq,
            i.priority,
            if i.gated { "yes" } else { "no" },
            i.functions,
            i.instructions,
            i.loops,
        )?;
    }
    Ok(())
}

fn write_stack(out: &mut String, report: &Report) -> std::fmt::Result {
    writeln!(out, "\n  worst stack, level on level")?;
    for level in &report.levels {
        let who = match level.priority {
            0 => "thread".to_owned(),
            n => format!("priority {n}"),
        };
        let path = level.path.iter().filter(|(_, bytes)| *bytes > 0);
        let path: Vec<String> = path
            .map(|(name, bytes)| format!("{name} {bytes}"))
            .collect();
        let bytes = format!("{}{}", mark(level.at_least), grouped(level.bytes, ','));
        writeln!(
            out,
            "    {who:<11} {:>3} + {bytes:<6} {}",
            level.exception,
            path.join(" > ")
        )?;
    }
    Ok(())
}

fn write_loops(out: &mut String, report: &Report) -> std::fmt::Result {
    if report.loops.is_empty() {
        return Ok(());
    }
    writeln!(out, "\n  loops that gated interrupts reach")?;
    for l in &report.loops {
        let bound = l.bound.map_or("?".to_owned(), |bound| bound.to_string());
        let reason = l.reason.as_deref().unwrap_or("nobody has looked");
        let copies = match l.copies {
            1 => String::new(),
            n => format!(", {n} times"),
        };
        writeln!(
            out,
            "    {bound:>6}  {}, {}{copies}: {reason}",
            l.function, l.place
        )?;
    }
    Ok(())
}

fn write_panics(out: &mut String, report: &Report) -> std::fmt::Result {
    if report.panics.is_empty() {
        return Ok(());
    }
    writeln!(out, "\n  calls of panics inside libraries")?;
    for panics in &report.panics {
        writeln!(
            out,
            "    {:>6}  {}, {} allowed: {}",
            panics.calls, panics.library, panics.at_most, panics.reason
        )?;
    }
    Ok(())
}

fn write_finding(out: &mut String, title: &str, finding: &Finding) -> std::fmt::Result {
    writeln!(out, "\n  {title} {}: {}", finding.check, finding.what)?;
    for line in &finding.at {
        writeln!(out, "       at {line}")?;
    }
    for (n, line) in finding.todo.lines().enumerate() {
        let arrow = if n == 0 { "->" } else { "  " };
        writeln!(out, "       {arrow} {line}")?;
    }
    Ok(())
}

fn mark(at_least: bool) -> &'static str {
    if at_least { "≥" } else { "" }
}

#[cfg(test)]
mod tests {
    use super::grouped;

    #[test]
    fn groups_digits() {
        for (number, text) in [
            (0, "0"),
            (999, "999"),
            (1_000, "1,000"),
            (1_234_567, "1,234,567"),
        ] {
            assert_eq!(grouped(number, ','), text);
        }
    }
}
