//! Students of a lesson, by their pseudonyms.

use super::error::{BeginError, MOST_PSEUDONYM};
use super::{Lesson, LessonError};
use crate::lesson::plan::MOST_STUDENTS;

impl Lesson {
    /// Admits a student who has come later: the next trial is the first.
    ///
    /// # Errors
    /// [`LessonError::Begun`] while a trial runs, as its knee may be revealed already;
    /// [`LessonError::Ended`]; [`LessonError::Student`] for an invalid pseudonym, one that is taken, or
    /// one too many.
    pub fn admit(&mut self, pseudonym: &str) -> Result<(), LessonError> {
        self.check_running()?;
        if self.began {
            let trial = self.trial();
            return Err(LessonError::Begun { trial });
        }
        let mut students = self.students.clone();
        students.push(pseudonym.to_owned());
        check_students(&students, self.plan().blind)?;
        self.students = students;
        Ok(())
    }

    /// Returns the pseudonym under which a student is in the lesson.
    pub fn student(&self, pseudonym: &str) -> Option<&str> {
        let mut students = self.students.iter().map(String::as_str);
        students.find(|student| is_same_name(student, pseudonym))
    }
}

/// Returns whether two pseudonyms are taken for one: capital letters make no difference.
pub(crate) fn is_same_name(one: &str, other: &str) -> bool {
    one.to_lowercase() == other.to_lowercase()
}

/// Checks the form of a pseudonym.
pub(crate) fn check_pseudonym(pseudonym: &str) -> Result<(), BeginError> {
    let allowed = |c: char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    let count = pseudonym.chars().count();
    if !(1..=MOST_PSEUDONYM).contains(&count)
        || !pseudonym.chars().all(allowed)
        || !pseudonym.starts_with(char::is_alphanumeric)
        || !pseudonym.ends_with(char::is_alphanumeric)
    {
        let pseudonym = pseudonym.to_owned();
        return Err(BeginError::Pseudonym { pseudonym });
    }
    Ok(())
}

/// Checks number and form of the pseudonyms, and that no two are equal.
pub(super) fn check_students(students: &[String], blind: bool) -> Result<(), BeginError> {
    let least = usize::from(blind);
    if !(least..=MOST_STUDENTS).contains(&students.len()) {
        let students = students.len();
        return Err(BeginError::Students { students });
    }
    for (place, pseudonym) in students.iter().enumerate() {
        check_pseudonym(pseudonym)?;
        let mut before = students.iter().take(place);
        if before.any(|other| is_same_name(other, pseudonym)) {
            let pseudonym = pseudonym.clone();
            return Err(BeginError::Duplicate { pseudonym });
        }
    }
    Ok(())
}
