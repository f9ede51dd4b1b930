//! Detection of repeated requests.
//!
//! The last sequence number and reply of each recent host are stored: a
//! repeated request gets the stored reply, an older one is ignored.

use crepitus_protocol::Session;
use crepitus_protocol::host::{Reply, Request};

/// Number of hosts stored.
const HOSTS: usize = 3;

/// Classification of a request by its sequence number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to put it on")]
pub enum RequestClass {
    /// New: carry it out.
    New,
    /// Repeated: send this reply again.
    Repeat(Reply),
    /// Older, or still being carried out.
    Ignore,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    session: Session,
    number: u16,
    /// None while it is being carried out.
    reply: Option<Reply>,
}

/// Recent hosts, the latest first.
#[derive(Clone, Debug, Default)]
pub struct Sessions {
    entries: heapless::Deque<Entry, HOSTS>,
}

impl Sessions {
    /// Classifies a request; a new one becomes the session's current request.
    pub fn classify(&mut self, request: &Request) -> RequestClass {
        let Request {
            session, number, ..
        } = *request;
        if let Some(entry) = self.latest(session) {
            if entry.number == number {
                return entry
                    .reply
                    .map_or(RequestClass::Ignore, RequestClass::Repeat);
            }
            if number.wrapping_sub(entry.number).cast_signed() < 0 {
                return RequestClass::Ignore;
            }
            (entry.number, entry.reply) = (number, None);
            return RequestClass::New;
        }
        if self.entries.is_full() {
            self.entries.pop_back();
        }
        // Cannot fail: not full.
        let _ = self.entries.push_front(Entry {
            session,
            number,
            reply: None,
        });
        RequestClass::New
    }

    /// Stores the reply to the current request.
    pub fn store_reply(&mut self, reply: &Reply) {
        if let Some(entry) = self.entry(reply.session)
            && entry.number == reply.number
        {
            entry.reply = Some(*reply);
        }
    }

    /// Moves a host's entry to the front and returns it.
    fn latest(&mut self, session: Session) -> Option<&mut Entry> {
        let entry = *self.entry(session)?;
        self.entries.retain(|other| other.session != session);
        // Cannot fail: an entry was removed.
        let _ = self.entries.push_front(entry);
        self.entries.front_mut()
    }

    fn entry(&mut self, session: Session) -> Option<&mut Entry> {
        self.entries
            .iter_mut()
            .find(|entry| entry.session == session)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::host::{Answer, Operation};

    fn request(session: u32, number: u16) -> Request {
        Request {
            session: Session(session),
            number,
            operation: Operation::Status,
        }
    }

    #[test]
    fn a_request_is_carried_out_once() {
        let mut sessions = Sessions::default();
        // Across the wrap of the number.
        for number in [0xfffe, 0xffff, 0, 1] {
            assert_eq!(sessions.classify(&request(1, number)), RequestClass::New);
            assert_eq!(sessions.classify(&request(1, number)), RequestClass::Ignore);
            let reply = Reply {
                session: Session(1),
                number,
                answer: Ok(Answer::Done),
            };
            sessions.store_reply(&reply);
            assert_eq!(
                sessions.classify(&request(1, number)),
                RequestClass::Repeat(reply)
            );
            let older = request(1, number.wrapping_sub(1));
            assert_eq!(sessions.classify(&older), RequestClass::Ignore);
        }
    }

    #[test]
    fn hosts_do_not_mix_and_the_least_recent_is_evicted() {
        let mut sessions = Sessions::default();
        for session in 1..=4 {
            assert_eq!(sessions.classify(&request(session, 7)), RequestClass::New);
        }
        assert_eq!(sessions.classify(&request(4, 7)), RequestClass::Ignore);
        assert_eq!(sessions.classify(&request(1, 7)), RequestClass::New);
        // The least recently used entry is evicted.
        assert_eq!(sessions.classify(&request(3, 8)), RequestClass::New);
        assert_eq!(sessions.classify(&request(5, 7)), RequestClass::New);
        assert_eq!(sessions.classify(&request(3, 8)), RequestClass::Ignore);
        assert_eq!(sessions.classify(&request(4, 7)), RequestClass::New);
    }
}
