//! Resources that the link's task shares with others, behind RTIC's locks.

use crepitus_device::drive::command::Command;
use crepitus_device::drive::commits::Commits;
use crepitus_device::drive::link_task::Shared;
use crepitus_device::drive::prepare::CommandPlan;
use rtic::Mutex;

/// The resource of `command_motor`: its state and its plan, behind one lock.
pub struct Commanding {
    pub command: Command,
    /// Its half of the plan that `idle` has stored.
    pub plan: Option<CommandPlan>,
}

/// Locks of the shared resources.
pub(crate) struct Parts<C, K> {
    pub(crate) command: C,
    pub(crate) commits: K,
}

impl<C, K> Shared for Parts<C, K>
where
    C: Mutex<T = Commanding>,
    K: Mutex<T = Commits>,
{
    fn command<R>(&mut self, work: impl FnOnce(&mut Command) -> R) -> R {
        self.command.lock(|part| work(&mut part.command))
    }

    fn commits<R>(&mut self, work: impl FnOnce(&mut Commits) -> R) -> R {
        self.commits.lock(|commits| work(commits))
    }
}
