//! Results besides those of the rungs: the other symptoms, the stage of the vibration
//! actuator, and what all of it costs on the device's core.

use crate::accuracy::actuator::{ActuatorPoint, actuator_table};
use crate::accuracy::symptoms::SymptomPoint;
use crate::accuracy::symptoms::table::{steps_table, symptoms_table};
use crate::accuracy::target::OnTarget;
use crate::accuracy::target::table::target_table;
use crepitus_pages::plot::number::rounded;
use crepitus_pages::plot::page::scrolling;
use maud::{Markup, html};

use super::pair::is_device_tick;

/// Tables of the symptoms at the device's tick, and by step; empty without symptoms.
pub(crate) fn symptoms(points: &[SymptomPoint]) -> Markup {
    let at_the_tick = points.iter().filter(|p| is_device_tick(p.step_s));
    let at_the_tick: Vec<SymptomPoint> = at_the_tick.cloned().collect();
    html! {
        @if !points.is_empty() {
            section.table.tick {
                h2 { "The other symptoms" }
                (scrolling("Symptoms at 50 µs", &symptoms_table(&at_the_tick).to_html()))
                p.caption {
                    "Each at its defaults, by its law alone, against its event-driven reference, on a steady "
                    "movement, strokes and a tremor together. Torque is compared at the ends of steps. × crepitus: "
                    "CPU time of a step over that of a step of crepitus (exact-events, frozen) in the same "
                    "precision, timed in turn."
                }
            }
            section.table.tick {
                h3 { "Largest torque error by step, N·m" }
                (scrolling("Torque error of symptoms by step", &by_step(points)))
            }
        }
    }
}

fn by_step(points: &[SymptomPoint]) -> Markup {
    let mut steps_s: Vec<f64> = points.iter().map(|p| p.step_s).collect();
    steps_s.sort_by(|a, b| b.total_cmp(a));
    steps_s.dedup();
    let is_same = |a: &SymptomPoint, b: &SymptomPoint| {
        (a.symptom, a.form, a.precision) == (b.symptom, b.form, b.precision)
    };
    let rows: Vec<&[SymptomPoint]> = points.chunk_by(is_same).collect();
    steps_table(&rows, &steps_s).to_html()
}

/// Table of the actuator's command; empty if it was not studied.
pub(crate) fn actuator(points: &[ActuatorPoint]) -> Markup {
    html! {
        @if !points.is_empty() {
            section.table.tick {
                h2 { "The command of the vibration actuator, 15 to 500 Hz" }
                (scrolling("Command of the actuator by step", &actuator_table(points).to_html()))
                p.caption {
                    "Error as a share of the voltage; rounding: the difference from f64 at the same step."
                }
            }
        }
    }
}

/// Cost on the device's core of every rung, and of what else the device does.
pub(crate) fn target(on: &OnTarget) -> Markup {
    html! {
        section.table.tick {
            h2 { "A step on the device's core" }
            (scrolling("Cycles of a step on the target", &target_table(&on.rows).to_html()))
            p.caption {
                (on.label) ". In f32 at a tick of 50 µs, which has " (rounded(on.tick_cycles))
                " cycles. Means are over the scenes of this study; the worst is the worst of all "
                "steps that were run, on inputs with breaks, matches and reversals: observed, no "
                "bound. Each of " (rounded(steps(on))) " steps gave the bits of the host."
            }
        }
    }
}

#[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
fn steps(on: &OnTarget) -> f64 {
    on.steps as f64
}
