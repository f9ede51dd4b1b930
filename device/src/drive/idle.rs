//! `idle`: prepares commits, between the tasks.

use crate::counters::Counters;
use crate::drive::commits::Commits;
use crate::drive::exchange::Exchange;
use crate::drive::link_task::Shared;
use crate::drive::prepare::{Preparation, Prepared};
use crepitus_protocol::pieces::Reassembly;

/// Resources that `idle` shares. Every task may run before and after each lock.
pub trait Plans {
    /// The resources that it shares with the link's task.
    fn parts(&mut self) -> &mut impl Shared;

    /// Stores both halves of a plan, for the tasks to apply.
    fn store(&mut self, plan: Prepared);
}

/// Prepares a pending commit once the previous one has settled. What is gathered of it
/// lies in `gathered` meanwhile.
pub fn prepare_pending(
    preparation: &mut Preparation,
    gathered: &mut Reassembly,
    shared: &mut impl Plans,
    exchange: &Exchange,
    counters: &Counters,
) {
    if exchange.is_busy() {
        return;
    }
    let Some(taken) = shared
        .parts()
        .commits(|commits| commits.take_into(gathered))
    else {
        return;
    };
    let Some(values) = Commits::verified(gathered, counters) else {
        return;
    };
    let is_live = shared.parts().command(|command| command.safety().is_live());
    let result = preparation.prepare(taken, &values, is_live);
    let done = result.as_ref().map(|_| ()).map_err(|error| *error);
    shared
        .parts()
        .commits(|commits| commits.done(taken, done, counters));
    if let Ok(plan) = result {
        shared.store(plan);
        exchange.plan_stored();
    }
}

#[cfg(test)]
mod tests;
