//! Students who answer on their phones.

use super::DeviceThread;
use super::lessons::{Held, NO_LESSON};
use crate::control::Page;
use crate::lesson::{Lesson, is_same_name};
use crate::shared::Outcome;
use crate::tokens::secret;
use axum::extract::ws::Utf8Bytes;
use crepitus_client::Transport;
use serde_json::{Value, json};
use std::collections::HashMap;

impl<T: Transport> DeviceThread<'_, T> {
    /// Lets students join, or no more.
    pub(super) fn open_class(&mut self, is_open: bool) {
        self.class.open(is_open);
        self.publish_class();
    }

    /// Gives a page the seat of a student.
    pub(super) fn join(&mut self, page: Page, name: &str, key: Option<&str>) -> Outcome {
        let fresh = secret().map_err(|error| format!("no random numbers: {error}"))?;
        let lesson = self.lesson.as_ref().map(Held::lesson);
        let students = lesson.map(Lesson::students).unwrap_or_default();
        let joined = self.class.join(page, name, key, students, fresh);
        let (name, key) = joined.map_err(|error| error.to_string())?;
        self.store_keys();
        self.publish_class();
        Ok(json!({ "name": name, "key": key }))
    }

    /// Takes a student's seat from its phone, at the teacher's wish.
    pub(super) fn free_seat(&mut self, name: &str) {
        let lesson = self.lesson.as_ref().map(Held::lesson);
        let student = lesson.and_then(|lesson| lesson.student(name));
        self.class.free(student.unwrap_or(name), student.is_some());
        self.store_keys();
        self.publish_class();
    }

    /// Takes the answer of the student who has joined on this page. It says which trial it is for: one that was sent
    /// late, or again, does not become an answer to another knee.
    pub(super) fn answer_own(
        &mut self,
        page: Page,
        trial: usize,
        disorder: &str,
        level: Option<&str>,
        confidence: u8,
    ) -> Outcome {
        let name = self.class.name_of(page).ok_or("join the class first")?;
        let lesson = self.lesson.as_ref().map(Held::lesson).ok_or(NO_LESSON)?;
        let student = lesson.student(name);
        let student = student.ok_or("you take part from the next knee on: wait for it")?;
        let now = lesson.trial();
        if trial != now {
            return Err(format!(
                "this answer is to knee {trial}, but now it is knee {now}: look again, then answer"
            ));
        }
        let student = student.to_owned();
        self.take_answer(&student, disorder, level, confidence)
    }

    /// Stores the answers of this turn at once, then confirms them: a class answers together, and torque must not
    /// wait for the disk as often as there are students.
    pub(super) fn store_answers(&mut self) {
        if self.unstored.is_empty() {
            return;
        }
        self.publish_parameters();
        self.changed();
        for reply in self.unstored.drain(..) {
            // The page may be gone.
            let _ = reply.send(Ok(Value::Null));
        }
    }

    /// Admits those who have joined since the last trial, before the next one begins.
    pub(super) fn admit_students(&mut self) {
        let Some(held) = &mut self.lesson else {
            return;
        };
        let lesson = held.lesson_mut();
        if lesson.began() || lesson.ended() {
            return;
        }
        for seat in self.class.seats() {
            if lesson.student(&seat.name).is_none()
                && let Err(error) = lesson.admit(&seat.name)
            {
                self.message = Some(error.to_string());
            }
        }
        self.store_keys();
    }

    /// The students of a lesson that begins: those whom the teacher has entered, then those who have joined.
    pub(super) fn with_class(&self, entered: &[String]) -> Vec<String> {
        let mut students = entered.to_vec();
        for seat in self.class.seats() {
            let is_it = |other: &String| is_same_name(other, &seat.name);
            if !students.iter().any(is_it) {
                students.push(seat.name.clone());
            }
        }
        students
    }

    /// Tells the teacher's pages who has joined, and every viewer how many; while students may join, also where.
    pub(super) fn publish_class(&self) {
        let class = &self.class;
        let is_open = class.is_open();
        let seats = class.seats().iter().map(|seat| {
            json!({ "name": seat.name, "here": class.is_here(seat), "free": seat.is_free() })
        });
        let seats: Vec<_> = seats.collect();
        let invitation = Some(&self.shared.invitations.student).filter(|_| is_open);
        let public = json!({ "open": is_open, "joined": seats.len(), "invitation": invitation });
        let class = json!({ "open": is_open, "seats": seats });
        self.publish(|latest| &mut latest.class, &json!({ "class": class }));
        let public = json!({ "class": public });
        self.publish(|latest| &mut latest.public_class, &public);
        self.publish_own();
    }

    /// Tells every page of a student the student's own part of the lesson, and nothing else.
    pub(super) fn publish_own(&self) {
        let lesson = self.lesson.as_ref().map(Held::lesson);
        let pages = self.class.pages().map(|(page, name)| {
            let own = name.map(|name| {
                let view = lesson.and_then(|lesson| lesson.own_view(name));
                json!({ "name": name, "lesson": view })
            });
            (page, Utf8Bytes::from(json!({ "own": own }).to_string()))
        });
        let own: HashMap<_, _> = pages.collect();
        self.shared.latest.send_if_modified(|latest| {
            let has_changed = latest.own != own;
            latest.own = own;
            has_changed
        });
    }
}
