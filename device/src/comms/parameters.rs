//! The parameters that comms owns: committed, on their way to the drive, kept.

use crepitus_protocol::{DeviceSettings, Revision, ValueError, Values};

/// The parameters.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    revision: Revision,
    values: Values,
    /// A commit that the drive has not confirmed.
    candidate: Option<(Revision, Values)>,
    /// The newest revision that was ever given.
    newest: Revision,
    saved: Option<Revision>,
}

impl Parameters {
    /// Those that were kept, if they are allowed; otherwise the defaults.
    pub fn new(saved: Option<(Revision, Values)>) -> Self {
        let saved = saved.filter(|(revision, values)| {
            *revision != Revision::NONE && DeviceSettings::of(values).is_ok()
        });
        let (revision, values) = saved.unwrap_or((Revision(1), Values::default()));
        Self {
            revision,
            values,
            candidate: None,
            newest: revision,
            saved: saved.map(|(revision, _)| revision),
        }
    }

    /// Of the values that were committed last.
    pub fn revision(&self) -> Revision {
        self.revision
    }

    /// The values that were committed last.
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// Of the values that are kept.
    pub fn saved(&self) -> Option<Revision> {
        self.saved
    }

    /// The values in force are kept now.
    pub fn keep(&mut self, revision: Revision) {
        self.saved = Some(revision);
    }

    /// A commit: checked, and on its way to the drive from now on.
    ///
    /// # Errors
    /// [`ValueError`] if the values are not allowed, or not while the device
    /// `is_live`.
    pub fn propose(&mut self, values: &Values, is_live: bool) -> Result<Revision, ValueError> {
        DeviceSettings::of(values)?;
        if is_live && let Some(id) = values.needs_disarmed(&self.values) {
            return Err(ValueError::NeedsDisarmed { id });
        }
        self.newest = self.newest.next();
        self.candidate = Some((self.newest, *values));
        Ok(self.newest)
    }

    /// The drive has confirmed it, or may have: it is the one.
    pub fn accept(&mut self) {
        if let Some((revision, values)) = self.candidate.take() {
            (self.revision, self.values) = (revision, values);
        }
    }

    /// The drive has refused it.
    pub fn reject(&mut self) {
        self.candidate = None;
    }

    /// The values that were committed last, as another commit.
    pub fn renumber(&mut self) {
        self.newest = self.newest.next();
        self.revision = self.newest;
    }

    /// What the drive is to be sent: the commit under way; or, if it has other
    /// parameters than were committed, those.
    pub fn to_send(&self, in_force: Option<Revision>) -> Option<(Revision, &Values)> {
        let in_force = in_force?;
        match &self.candidate {
            Some((revision, values)) => (in_force != *revision).then_some((*revision, values)),
            None => (in_force != self.revision).then_some((self.revision, &self.values)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::parameters::id;

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
        // The number of what was refused is not given again.
        assert_eq!(parameters.propose(&values, true), Ok(Revision(3)));
        parameters.accept();
        assert_eq!(
            (parameters.revision(), *parameters.values()),
            (Revision(3), values)
        );
    }

    #[test]
    fn a_drive_with_other_parameters_is_given_the_right_ones() {
        let parameters = Parameters::new(None);
        assert!(parameters.to_send(Some(Revision::NONE)).is_some());
        assert!(parameters.to_send(Some(Revision(1))).is_none());
        assert!(parameters.to_send(None).is_none(), "nobody is there");
    }

    #[test]
    fn what_was_kept_is_used_if_it_is_allowed() {
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
