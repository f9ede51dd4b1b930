//! Costs of the ladder on the target, in words and as a table.

use crate::accuracy::target::table::target_table;
use crate::accuracy::target::{OnTarget, STEP_SHARE};

/// Criterion by which the target chooses, where it does.
pub(super) fn chooses_by(on: &OnTarget) -> String {
    format!(
        "By mean cycles on the target ({}), equal means by the worst observed; that must fit {:.0} % of a tick, {:.0} \
         cycles.\n",
        on.label,
        100.0 * STEP_SHARE,
        STEP_SHARE * on.tick_cycles
    )
}

/// Returns the costs on the target as a table, for the terminal and for a page of the book.
pub(super) fn table(on: &OnTarget) -> String {
    format!(
        "A step on the target, in f32 at the device's tick ({}; a tick has {}):\n\n{}\n\
         {} steps, every output the same to the bit as on the host.\n",
        on.label,
        on.tick_cycles,
        target_table(&on.rows).to_markdown(),
        on.steps
    )
}
