//! Resources that the link's task and `idle` share with others, behind RTIC's locks.

use crepitus_device::drive::command::Command;
use crepitus_device::drive::commits::Commits;
use crepitus_device::drive::idle::Plans;
use crepitus_device::drive::link_task::Shared;
use crepitus_device::drive::prepare::{CommandPlan, Prepared, RenderingPlan};
use rtic::Mutex;

/// The resource of `command_motor`: its state and its plan, behind one lock.
pub struct Commanding {
    pub command: Command,
    /// `command_motor`'s half of the plan that `idle` has stored.
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

/// Parts that `idle` uses.
pub(crate) struct IdleParts<C, K, R> {
    pub(crate) parts: Parts<C, K>,
    pub(crate) rendering_plan: R,
}

impl<C, K, R> Plans for IdleParts<C, K, R>
where
    C: Mutex<T = Commanding>,
    K: Mutex<T = Commits>,
    R: Mutex<T = Option<RenderingPlan>>,
{
    fn parts(&mut self) -> &mut impl Shared {
        &mut self.parts
    }

    fn store(&mut self, plan: Prepared) {
        let Prepared { rendering, command } = plan;
        self.rendering_plan.lock(|slot| *slot = Some(rendering));
        self.parts.command.lock(|part| part.plan = Some(command));
    }
}
