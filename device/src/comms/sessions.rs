//! Which requests were carried out already.
//!
//! For each of the hosts that spoke last, the number of its last request and
//! the reply: a request that is repeated is answered again, one that is older
//! is not heard.

use crepitus_protocol::Session;
use crepitus_protocol::host::{Reply, Request};

/// Hosts that are remembered.
const HOSTS: usize = 3;

/// What is to be done with a request.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to put it on")]
pub enum Verdict {
    /// It is new.
    New,
    /// It was answered: once more.
    Again(Reply),
    /// It is older, or is still being carried out.
    Ignore,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    session: Session,
    number: u16,
    /// None while it is being carried out.
    reply: Option<Reply>,
}

/// The hosts that spoke last, the latest first.
#[derive(Clone, Debug, Default)]
pub struct Sessions {
    entries: heapless::Deque<Entry, HOSTS>,
}

impl Sessions {
    /// Whether a request is to be carried out; from then on it is.
    pub fn judge(&mut self, request: &Request) -> Verdict {
        let Request {
            session, number, ..
        } = *request;
        if let Some(entry) = self.latest(session) {
            if entry.number == number {
                return entry.reply.map_or(Verdict::Ignore, Verdict::Again);
            }
            if number.wrapping_sub(entry.number).cast_signed() < 0 {
                return Verdict::Ignore;
            }
            (entry.number, entry.reply) = (number, None);
            return Verdict::New;
        }
        if self.entries.is_full() {
            self.entries.pop_back();
        }
        // There is room now.
        let _ = self.entries.push_front(Entry {
            session,
            number,
            reply: None,
        });
        Verdict::New
    }

    /// A request was answered.
    pub fn answered(&mut self, reply: &Reply) {
        if let Some(entry) = self.entry(reply.session)
            && entry.number == reply.number
        {
            entry.reply = Some(*reply);
        }
    }

    /// The entry of a host that speaks now, if it is remembered.
    fn latest(&mut self, session: Session) -> Option<&mut Entry> {
        let entry = *self.entry(session)?;
        self.entries.retain(|other| other.session != session);
        // There is room now.
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
    use crepitus_protocol::host::{Answer, Ask};

    fn request(session: u32, number: u16) -> Request {
        Request {
            session: Session(session),
            number,
            ask: Ask::Status,
        }
    }

    #[test]
    fn a_request_is_carried_out_once() {
        let mut sessions = Sessions::default();
        // Across the wrap of the number.
        for number in [0xfffe, 0xffff, 0, 1] {
            assert_eq!(sessions.judge(&request(1, number)), Verdict::New);
            assert_eq!(sessions.judge(&request(1, number)), Verdict::Ignore);
            let reply = Reply {
                session: Session(1),
                number,
                answer: Ok(Answer::Done),
            };
            sessions.answered(&reply);
            assert_eq!(sessions.judge(&request(1, number)), Verdict::Again(reply));
            let older = request(1, number.wrapping_sub(1));
            assert_eq!(sessions.judge(&older), Verdict::Ignore);
        }
    }

    #[test]
    fn hosts_do_not_mix_and_the_oldest_is_forgotten() {
        let mut sessions = Sessions::default();
        for session in 1..=4 {
            assert_eq!(sessions.judge(&request(session, 7)), Verdict::New);
        }
        assert_eq!(sessions.judge(&request(4, 7)), Verdict::Ignore);
        assert_eq!(sessions.judge(&request(1, 7)), Verdict::New);
        // The oldest is the one that has not spoken for longest.
        assert_eq!(sessions.judge(&request(3, 8)), Verdict::New);
        assert_eq!(sessions.judge(&request(5, 7)), Verdict::New);
        assert_eq!(sessions.judge(&request(3, 8)), Verdict::Ignore);
        assert_eq!(sessions.judge(&request(4, 7)), Verdict::New);
    }
}
