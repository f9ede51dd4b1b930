//! Resources that the link's task shares with others, behind RTIC's locks.

use crepitus_device::drive::command::Command;
use crepitus_device::drive::commits::Commits;
use crepitus_device::drive::link_task::Shared;
use crepitus_device::drive::sampler::Sampler;
use rtic::Mutex;

/// Locks of the shared resources.
pub(crate) struct Parts<C, S, K> {
    pub(crate) command: C,
    pub(crate) sampler: S,
    pub(crate) commits: K,
}

impl<C, S, K> Shared for Parts<C, S, K>
where
    C: Mutex<T = Command>,
    S: Mutex<T = Sampler>,
    K: Mutex<T = Commits>,
{
    fn command<R>(&mut self, work: impl FnOnce(&mut Command) -> R) -> R {
        self.command.lock(|command| work(command))
    }

    fn sampler<R>(&mut self, work: impl FnOnce(&mut Sampler) -> R) -> R {
        self.sampler.lock(|sampler| work(sampler))
    }

    fn commits<R>(&mut self, work: impl FnOnce(&mut Commits) -> R) -> R {
        self.commits.lock(|commits| work(commits))
    }
}
