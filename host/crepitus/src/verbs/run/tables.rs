//! A run's summary as a person reads it: a few lines on the terminal, tables
//! in the report.

use super::plant;
use crate::sections::{counts, millijoule, nm, section, torque_section};
use crepitus_model::parameters::ParameterSpec;
use crepitus_pages::report::Section;
use crepitus_scene::Summary;
use crepitus_scene::cpu_time::CLOCK;
use crepitus_scene::run::{AddedTime, EffectSummary, TankSummary, TorqueLimitSummary};

/// Summary of the run in a few lines.
pub(super) fn in_brief(s: &Summary) -> String {
    let mut lines = Vec::new();
    if let Some(e) = &s.events {
        let cycles = match s.cycles.and_then(|c| c.frequency_hz) {
            Some(frequency) => format!(", cycles at {frequency:.3} Hz on average"),
            None => String::new(),
        };
        lines.push(format!(
            "  {}{cycles}",
            counts(&[
                (e.breaks, "break"),
                (e.sticks, "stick"),
                (e.reverses, "reverse")
            ])
        ));
    }
    if let Some(t) = &s.torque {
        lines.push(format!(
            "  torque {} to {}, mean {}",
            nm(t.min_nm),
            nm(t.max_nm),
            nm(t.mean_nm)
        ));
    }
    lines.extend(plant::in_brief(s));
    lines.push(format!(
        "  {} s simulated by {} in {:.2} s, {:.0} times real time with all outputs",
        s.simulated_s, s.solver, s.wall_s, s.real_time_factor
    ));
    if let Some(data) = s.data.as_ref().filter(|data| !data.read_as.is_empty()) {
        lines.push(format!("  recording: {}", data.read_as.join("; ")));
    }
    lines.join("\n")
}

/// The tables of the report; `specs` are the parameters of each effect.
pub(super) fn sections(s: &Summary, specs: &[&[ParameterSpec]]) -> Vec<Section> {
    let coupled = s.plant_energy.is_some();
    let mut sections = vec![run_section(s)];
    if let Some(t) = &s.torque {
        sections.push(torque_section(
            if coupled {
                "Torque of the model over time"
            } else {
                "Torque over time"
            },
            t,
        ));
    }
    if let Some(t) = &s.hand_torque {
        sections.push(torque_section("Torque at the hand over time", t));
    }
    if let Some(c) = &s.cycles {
        let time = |x: Option<f64>| x.map_or("–".to_owned(), |x| format!("{:.4} ms", x * 1e3));
        let frequency = c
            .frequency_hz
            .map_or("–".to_owned(), |f| format!("{f:.4} Hz"));
        sections.push(section(
            "Cycles, from break to break in the same sense",
            [
                ("complete", c.count.to_string()),
                ("mean frequency", frequency),
                ("shortest", time(c.shortest_s)),
                ("longest", time(c.longest_s)),
            ],
        ));
    }
    if let Some(e) = &s.energy {
        sections.push(section(
            if coupled {
                "Energy of the imaginary object"
            } else {
                "Energy"
            },
            [
                (
                    if coupled {
                        "work of the shaft"
                    } else {
                        "work of the hand"
                    },
                    millijoule(e.work_in_j),
                ),
                (
                    "given by the convention, without a torque",
                    millijoule(e.convention_j),
                ),
                ("change in the spring", millijoule(e.spring_change_j)),
                ("change in motion", millijoule(e.kinetic_change_j)),
                ("dissipated by friction", millijoule(e.friction_j)),
                ("dissipated by damping", millijoule(e.viscous_j)),
                (
                    "left over, relative",
                    format!("{:.1e}", e.residual_relative),
                ),
            ],
        ));
    }
    sections.extend(s.tank.as_ref().map(tank_section));
    sections.extend(s.torque_limit.as_ref().map(limit_section));
    sections.extend(plant::rendered_section(s));
    sections.extend(plant::impacts_section(s));
    sections.extend(
        s.effects
            .iter()
            .zip(specs)
            .map(|(effect, specs)| effect_section(effect, specs)),
    );
    sections
}

fn run_section(s: &Summary) -> Section {
    let mut rows = vec![
        ("scene", s.scene.clone()),
        ("motion", s.motion.to_owned()),
        (
            "highest speed",
            format!("{:.1} °/s", s.fastest_rad_s.to_degrees()),
        ),
        ("solver", format!("{} ({})", s.solver, s.precision)),
    ];
    let read_as = s.data.as_ref().map(|data| data.read_as.join("; "));
    rows.extend(
        read_as
            .filter(|text| !text.is_empty())
            .map(|text| ("recording", text)),
    );
    rows.extend(
        s.step_s
            .map(|h| ("step", format!("{} µs", trimmed(h * 1e6)))),
    );
    rows.extend(s.convention.map(|c| ("convention", c.to_owned())));
    rows.extend(s.restart.map(|r| ("restart", r.to_owned())));
    rows.extend(s.preset.map(|p| ("preset", p.to_owned())));
    rows.push(("simulated", format!("{} s", s.simulated_s)));
    if let Some(e) = &s.events {
        rows.push((
            "events",
            counts(&[
                (e.breaks, "break"),
                (e.sticks, "stick"),
                (e.reverses, "reverse"),
            ]),
        ));
    }
    rows.push((
        "real-time factor, outputs included",
        format!("{:.0}", s.real_time_factor),
    ));
    section("Run", rows)
}

/// Table of the torque that the energy tank held back.
fn tank_section(tank: &TankSummary) -> Section {
    let first = tank
        .first_s
        .map_or("none".to_owned(), |s| format!("{s:.4} s"));
    section(
        "Energy tank of clonus and reflex",
        [
            ("law", tank.law.to_owned()),
            ("first torque held back", first),
            ("time held back", format!("{:.3} s", tank.held_back_s)),
            (
                "largest share held back",
                format!("{:.0} %", 1e2 * tank.most_share),
            ),
            (
                "beats and reflexes",
                format!(
                    "{}, of them {} weak and {} not felt",
                    tank.pushes, tank.weak, tank.unfelt
                ),
            ),
        ],
    )
}

/// Torque beyond the largest of a device.
fn limit_section(limit: &TorqueLimitSummary) -> Section {
    let applied = if limit.is_applied {
        "applied: the scene has a device"
    } else {
        "not applied: the scene has no device"
    };
    section(
        "Torque beyond a device's largest",
        [
            ("limit", format!("{}, {applied}", nm(limit.limit_nm))),
            ("first beyond", format!("{:.4} s", limit.first_s)),
            ("time beyond", format!("{:.3} s", limit.beyond_s)),
            ("largest asked for", nm(limit.most_nm)),
        ],
    )
}

fn effect_section(effect: &EffectSummary, specs: &[ParameterSpec]) -> Section {
    let mut rows: Vec<(String, String)> = effect
        .parameters
        .iter()
        .map(|p| match specs.iter().find(|s| s.key == p.key) {
            Some(s) if s.unit == "1" => (format!("{} ({})", s.symbol, s.key), p.value.to_string()),
            Some(s) => (
                format!("{} ({})", s.symbol, s.key),
                format!("{} {}", p.value, s.unit),
            ),
            None => (p.key.to_owned(), p.value.to_string()),
        })
        .collect();
    rows.extend(
        effect
            .choices
            .iter()
            .map(|c| (c.key.to_owned(), c.value.to_owned())),
    );
    rows.push((
        "states".to_owned(),
        if effect.states.is_empty() {
            "none".to_owned()
        } else {
            effect.states.join(", ")
        },
    ));
    if let Some(added) = effect.added {
        rows.push(("cost".to_owned(), cost(&added)));
    }
    Section {
        title: format!("Effect: {}", effect.name),
        rows,
    }
}

/// CPU time of a step; of a cost that is lost in the timings its bound.
fn cost(added: &AddedTime) -> String {
    match added.ns_per_step {
        Some(ns) => format!("{ns:.1} ns per step of {CLOCK}"),
        None if added.is_below_resolution() => format!(
            "below what can be measured ({:.1} ns per step)",
            added.ns_resolution
        ),
        None => "not known".to_owned(),
    }
}

/// A number without the digits that rounding added.
fn trimmed(x: f64) -> String {
    let text = format!("{x:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
