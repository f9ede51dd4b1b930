//! Resources that the link's task shares with others, behind RTIC's locks.

use crepitus_device::drive::command::Command;
use crepitus_device::drive::commits::Commits;
use crepitus_device::drive::link_task::Shared;
use rtic::Mutex;

/// Locks of the shared resources.
pub(crate) struct Parts<C, K> {
    pub(crate) command: C,
    pub(crate) commits: K,
}

impl<C, K> Shared for Parts<C, K>
where
    C: Mutex<T = Command>,
    K: Mutex<T = Commits>,
{
    fn command<R>(&mut self, work: impl FnOnce(&mut Command) -> R) -> R {
        self.command.lock(|command| work(command))
    }

    fn commits<R>(&mut self, work: impl FnOnce(&mut Commits) -> R) -> R {
        self.commits.lock(|commits| work(commits))
    }
}
