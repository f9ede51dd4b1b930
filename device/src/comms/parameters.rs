//! The parameters that comms owns: committed, pending at the drive, saved.

use crate::comms::sample_checks::Bounds;
use crepitus_protocol::telemetry::{Block, SampleFlags};
use crepitus_protocol::{DeviceSettings, Revision, ValueError, Values};

/// Committed parameters, and a pending commit.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    revision: Revision,
    values: Values,
    /// A commit that the drive has not confirmed.
    pending: Option<(Revision, Values)>,
    /// The latest revision number used.
    latest: Revision,
    saved: Option<Revision>,
    /// Bounds of the committed values.
    bounds: Bounds,
    /// Bounds of all values that may still be in force.
    wide_bounds: Bounds,
    /// Blocks in a row with the committed values in force, and those of them without a ramp
    /// since the last one that had one.
    in_force_blocks: u32,
    settled_blocks: u32,
}

impl Parameters {
    /// The saved parameters if they are valid, otherwise the defaults.
    pub fn new(saved: Option<(Revision, Values)>) -> Self {
        let saved = saved.filter(|(revision, values)| {
            *revision != Revision::NONE && DeviceSettings::of(values).is_ok()
        });
        let (revision, values) = saved.unwrap_or((Revision(1), Values::default()));
        // Both are valid: of the defaults a test knows.
        let bounds = DeviceSettings::of(&values).map_or(Bounds::NONE, |s| Bounds::of(&s));
        Self {
            revision,
            values,
            pending: None,
            latest: revision,
            saved: saved.map(|(revision, _)| revision),
            bounds,
            wide_bounds: bounds,
            in_force_blocks: 0,
            settled_blocks: 0,
        }
    }

    /// Revision of the values committed last.
    pub fn revision(&self) -> Revision {
        self.revision
    }

    /// The values committed last.
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// Revision of the saved values.
    pub fn saved(&self) -> Option<Revision> {
        self.saved
    }

    /// Records that this revision was saved.
    pub fn mark_saved(&mut self, revision: Revision) {
        self.saved = Some(revision);
    }

    /// Checks a commit and makes it pending at the drive.
    ///
    /// # Errors
    /// [`ValueError`] if the values are invalid, or need a disarmed device and
    /// it `is_live`.
    pub fn propose(&mut self, values: &Values, is_live: bool) -> Result<Revision, ValueError> {
        let settings = DeviceSettings::of(values)?;
        if is_live && let Some(id) = values.needs_disarmed(&self.values) {
            return Err(ValueError::NeedsDisarmed { id });
        }
        self.latest = self.latest.next();
        self.pending = Some((self.latest, *values));
        self.wide_bounds = self.wide_bounds.or(Bounds::of(&settings));
        (self.in_force_blocks, self.settled_blocks) = (0, 0);
        Ok(self.latest)
    }

    /// Completes the pending commit: the drive has applied it, or may have.
    pub fn accept(&mut self) {
        if let Some((revision, values)) = self.pending.take() {
            (self.revision, self.values) = (revision, values);
            if let Ok(settings) = DeviceSettings::of(&values) {
                self.bounds = Bounds::of(&settings);
            }
        }
    }

    /// Drops the pending commit: the drive has rejected it.
    pub fn reject(&mut self) {
        self.pending = None;
    }

    /// Gives the committed values a new revision, newer than that of the drive, to send them again.
    pub fn renumber(&mut self, active: Revision) {
        if self.latest.is_before(active) {
            self.latest = active;
        }
        self.latest = self.latest.next();
        self.revision = self.latest;
    }

    /// Narrows the bounds once blocks show that the committed values are in
    /// force, with no ramp in progress and nothing left that fades; or have been for so long that
    /// a drive that still reports a ramp is wrong.
    pub fn shown(&mut self, block: &Block) {
        let is_settling = (block.samples.iter()).any(|s| s.flags.has(SampleFlags::SETTLING));
        let is_in_force = block.revision == self.revision && self.pending.is_none();
        let counted = |blocks: u32, goes_on| if goes_on { blocks.saturating_add(1) } else { 0 };
        self.in_force_blocks = counted(self.in_force_blocks, is_in_force);
        self.settled_blocks = counted(self.settled_blocks, is_in_force && !is_settling);
        let wide = &self.wide_bounds;
        let has_faded = self.settled_blocks > 0 && wide.has_faded(self.settled_blocks);
        if has_faded || (self.in_force_blocks > 0 && wide.has_settled(self.in_force_blocks)) {
            self.wide_bounds = self.bounds;
        }
    }

    /// Bounds of all values that may still be in force.
    pub fn bounds_in_force(&self) -> Bounds {
        self.wide_bounds
    }

    /// The values that the drive lacks: the pending commit, else the committed
    /// values. `active` is the drive's revision.
    pub fn to_send(&self, active: Option<Revision>) -> Option<(Revision, &Values)> {
        let active = active?;
        match &self.pending {
            Some((revision, values)) => (active != *revision).then_some((*revision, values)),
            None => (active != self.revision).then_some((self.revision, &self.values)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::parameters::{find, id};
    use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Sample};

    #[test]
    fn a_commit_counts_once_it_is_confirmed() {
        let mut parameters = Parameters::new(None);
        assert_eq!(parameters.revision(), Revision(1));
        let mut values = Values::default();
        values.set(id::STATIC_TORQUE, 0.5);
        assert_eq!(parameters.propose(&values, true), Ok(Revision(2)));
        assert_eq!(parameters.revision(), Revision(1));
        let (revision, sent) = parameters.to_send(Some(Revision(1))).unwrap();
        assert_eq!((revision, sent), (Revision(2), &values));
        parameters.reject();
        assert_eq!(parameters.to_send(Some(Revision(1))), None);
        // The revision of a rejected commit is not reused.
        assert_eq!(parameters.propose(&values, true), Ok(Revision(3)));
        parameters.accept();
        assert_eq!(
            (parameters.revision(), *parameters.values()),
            (Revision(3), values)
        );
    }

    /// Compensation of friction that is switched off fades from 0.4 N·m, 5 mN·m in a tick.
    #[test]
    fn bounds_are_narrowed_when_all_that_fades_has_faded() {
        let block = |revision, flags| Block {
            revision,
            samples: [Sample {
                flags: SampleFlags(flags),
                ..Sample::default()
            }; BLOCK_SAMPLES],
            ..Block::default()
        };
        let mut values = Values::default();
        let (compensation, _) = find("friction-compensation.render").unwrap();
        values.set(compensation, 1.0);
        let mut parameters = Parameters::new(Some((Revision(1), values)));
        let with = parameters.bounds_in_force();
        let revision = parameters.propose(&Values::default(), true).unwrap();
        parameters.accept();
        let without = Bounds::of(&DeviceSettings::of(&Values::default()).unwrap());
        let both = with.or(without);
        for _ in 0..20 {
            parameters.shown(&block(Revision(1), 0));
            parameters.shown(&block(revision, SampleFlags::SETTLING));
        }
        for _ in 0..4 {
            assert_eq!(parameters.bounds_in_force(), both);
            parameters.shown(&block(revision, 0));
        }
        assert_eq!(parameters.bounds_in_force(), both);
        parameters.shown(&block(revision, 0));
        assert_eq!(parameters.bounds_in_force(), without);
    }

    /// A change from 4.5 to 1 N·m takes 35 ms at 100 N·m/s.
    #[test]
    fn a_drive_that_says_for_ever_that_it_settles_is_not_believed() {
        let mut values = Values::default();
        let mut parameters = Parameters::new(Some((Revision(1), values)));
        values.set(id::TORQUE_LIMIT, 1.0);
        let revision = parameters.propose(&values, true).unwrap();
        parameters.accept();
        let wide = parameters.bounds_in_force();
        let narrow = Bounds::of(&DeviceSettings::of(&values).unwrap());
        let settling = Block {
            revision,
            samples: [Sample {
                flags: SampleFlags(SampleFlags::SETTLING),
                ..Sample::default()
            }; BLOCK_SAMPLES],
            ..Block::default()
        };
        let mut blocks = 0;
        while parameters.bounds_in_force() == wide {
            parameters.shown(&settling);
            blocks += 1;
            assert!(blocks < 1_000, "a second, and it is still believed");
        }
        assert_eq!(parameters.bounds_in_force(), narrow);
        // 2·(36 · 0.4 + 0.8 + 4.5) N·m at 0.1 N·m in a block.
        assert!((390..400).contains(&blocks), "{blocks} ms");
    }

    #[test]
    fn saved_parameters_are_used_if_valid() {
        let mut values = Values::default();
        values.set(id::STATIC_TORQUE, 0.5);
        let parameters = Parameters::new(Some((Revision(9), values)));
        assert_eq!(
            (parameters.revision(), parameters.saved()),
            (Revision(9), Some(Revision(9)))
        );
        values.set(id::STATIC_TORQUE, 0.1);
        let parameters = Parameters::new(Some((Revision(9), values)));
        assert_eq!(
            (parameters.revision(), parameters.saved()),
            (Revision(1), None)
        );
    }
}
