//! The class: students who answer on their phones.
//!
//! ```text
//!  teacher lets students join ── a phone chooses a pseudonym ──> seat, with a key that this phone alone has
//!                              page reloaded ── name and key ──> the same seat
//!            teacher frees a seat ── the next phone of its name ──> the seat, with another key
//! ```
//!
//! A page acts for the seat that it has joined, and for no other: no request of a student names a student. So
//! nothing is gained by a guessed pseudonym, nor by an answer that is sent again.

use crate::control::Page;
use crate::lesson::{BeginError, MOST_STUDENTS, check_pseudonym, is_same_name};
use crate::tokens::{is_same, is_secret};
use std::collections::{BTreeMap, HashMap};

/// Keys of phones, by pseudonym.
pub(crate) type Keys = BTreeMap<String, String>;

/// Students who have joined.
#[derive(Debug, Default)]
pub(crate) struct Class {
    is_open: bool,
    seats: Vec<Seat>,
    /// Pseudonyms of the pages that have joined; none of one whose seat was freed.
    pages: HashMap<Page, Option<String>>,
}

/// Place of a student.
#[derive(Debug)]
pub(crate) struct Seat {
    pub(crate) name: String,
    /// Key of its phone; none while it waits for one.
    key: Option<String>,
}

/// Error of a phone that cannot join.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum JoinError {
    /// An invalid pseudonym.
    #[error(transparent)]
    Pseudonym(#[from] BeginError),
    /// Nobody may join now.
    #[error("the class is closed: ask your teacher to let you in")]
    Closed,
    /// The name belongs to another phone, or to nobody yet.
    #[error("{0:?} is taken: choose another name, or ask your teacher to free it")]
    Taken(String),
    /// This page has joined under another name.
    #[error("this phone has joined as {0:?} already")]
    Joined(String),
    /// Too many students.
    #[error("the class is full: it has {MOST_STUDENTS} students")]
    Full,
}

impl Class {
    /// Lets students join, or no more; those who have joined stay.
    pub(crate) fn open(&mut self, is_open: bool) {
        self.is_open = is_open;
    }

    pub(crate) fn is_open(&self) -> bool {
        self.is_open
    }

    /// Gives a page the seat of this name; returns name and key. `students` are those of the lesson, `fresh` is a new
    /// secret.
    pub(crate) fn join(
        &mut self,
        page: Page,
        name: &str,
        key: Option<&str>,
        students: &[String],
        fresh: String,
    ) -> Result<(String, String), JoinError> {
        let name = name.trim();
        check_pseudonym(name)?;
        if let Some(Some(own)) = self.pages.get(&page)
            && !is_same_name(own, name)
        {
            return Err(JoinError::Joined(own.clone()));
        }
        let taken = || JoinError::Taken(name.to_owned());
        // A key that the phone has from before: the seat of an interrupted lesson may have it.
        let given = key.filter(|key| is_secret(key));
        let new_key = given.map_or(fresh, str::to_owned);
        let mut seats = self.seats.iter_mut();
        let (name, key) = if let Some(seat) = seats.find(|seat| is_same_name(&seat.name, name)) {
            let seat_key = seat.key.get_or_insert_with(|| new_key.clone());
            if !is_same(&new_key, seat_key) {
                return Err(taken());
            }
            (seat.name.clone(), new_key)
        } else {
            if students.iter().any(|student| is_same_name(student, name)) {
                return Err(taken());
            }
            if !self.is_open {
                return Err(JoinError::Closed);
            }
            if self.seats.len() >= MOST_STUDENTS {
                return Err(JoinError::Full);
            }
            self.seats.push(Seat {
                name: name.to_owned(),
                key: Some(new_key.clone()),
            });
            (name.to_owned(), new_key)
        };
        self.pages.insert(page, Some(name.clone()));
        Ok((name, key))
    }

    /// Takes the seat of this name from its phone. The seat of a student of the lesson waits for the next phone of
    /// that name; another one is gone.
    pub(crate) fn free(&mut self, name: &str, is_in_lesson: bool) {
        self.put_out(name);
        self.seats.retain(|seat| !is_same_name(&seat.name, name));
        if is_in_lesson {
            self.seats.push(Seat {
                name: name.to_owned(),
                key: None,
            });
        }
    }

    /// Gives the seats of an interrupted lesson back to the phones that had them.
    pub(crate) fn restore(&mut self, keys: &Keys) {
        for (name, key) in keys {
            let mut seats = self.seats.iter();
            let seat = seats.find(|seat| is_same_name(&seat.name, name));
            if seat.is_some_and(|seat| seat.key.as_ref() == Some(key)) {
                continue;
            }
            // Whoever has taken the name meanwhile is another one.
            self.free(name, false);
            self.seats.push(Seat {
                name: name.clone(),
                key: Some(key.clone()),
            });
        }
    }

    /// Seats, in the order in which they were taken.
    pub(crate) fn seats(&self) -> &[Seat] {
        &self.seats
    }

    /// Keys of the phones.
    pub(crate) fn keys(&self) -> Keys {
        let seats = self.seats.iter();
        seats
            .filter_map(|seat| Some((seat.name.clone(), seat.key.clone()?)))
            .collect()
    }

    /// Pseudonym of a page that has joined.
    pub(crate) fn name_of(&self, page: Page) -> Option<&str> {
        self.pages.get(&page)?.as_deref()
    }

    /// Pages that have joined, with their pseudonyms; none of one whose seat was freed.
    pub(crate) fn pages(&self) -> impl Iterator<Item = (Page, Option<&str>)> {
        let pages = self.pages.iter();
        pages.map(|(page, name)| (*page, name.as_deref()))
    }

    /// Returns whether a page of this seat is open.
    pub(crate) fn is_here(&self, seat: &Seat) -> bool {
        let mut names = self.pages.values().flatten();
        names.any(|name| *name == seat.name)
    }

    /// A page has gone; returns whether it had joined.
    pub(crate) fn left(&mut self, page: Page) -> bool {
        self.pages.remove(&page).is_some()
    }

    fn put_out(&mut self, name: &str) {
        for own in self.pages.values_mut() {
            if own.as_deref().is_some_and(|own| is_same_name(own, name)) {
                *own = None;
            }
        }
    }
}

impl Seat {
    /// Returns whether the next phone of its name gets it.
    pub(crate) fn is_free(&self) -> bool {
        self.key.is_none()
    }
}

#[cfg(test)]
mod tests;
