//! The open sessions: nonces, repeated requests, subscriptions.
//!
//! A request of a session that is not open, or with an old nonce, is not
//! executed. So nothing that was sent before a restart of comms, or before the
//! session was opened last, is ever executed again.
//!
//! The last sequence number and reply of each session are stored: a repeated
//! request gets the stored reply, an older one is ignored. Renewals have the same numbers and
//! no reply; each counts once, and none after a newer one.

use crepitus_protocol::host::{Answer, Operation, Reply, Request};
use crepitus_protocol::{Nonce, Session};

/// Most open sessions.
pub const SESSIONS: usize = 32;

/// Classification of a request by its nonce and sequence number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to put it on")]
pub enum RequestClass {
    /// New: carry it out.
    New,
    /// Opens a session, with the next nonce.
    Open,
    /// Repeated: send this reply again.
    Repeat(Reply),
    /// Older, or still being carried out.
    Ignore,
    /// Belongs to a session that is not open, or has an old nonce.
    NotOpen,
}

/// Classification of a renewal, which has no reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RenewalClass {
    /// A renewal that counts.
    New,
    /// Repeated or older.
    Ignore,
    /// Belongs to a session that is not open, or has an old nonce.
    NotOpen,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    session: Session,
    nonce: Nonce,
    number: u32,
    /// Number of the last renewal.
    renewed: u32,
    /// None while it is being carried out.
    reply: Option<Reply>,
    is_subscribed: bool,
    /// Time of its last use, in requests.
    used: u64,
}

/// The open sessions.
#[derive(Clone, Debug)]
pub struct Sessions {
    entries: heapless::Vec<Entry, SESSIONS>,
    /// State of the generator of nonces.
    nonces: u64,
    requests: u64,
}

impl Sessions {
    /// No session. `entropy` has to differ between starts of comms.
    pub fn new(entropy: u64) -> Self {
        Self {
            entries: heapless::Vec::new(),
            nonces: entropy,
            requests: 0,
        }
    }

    /// Classifies a request; a new one becomes the session's current request.
    pub fn classify(&mut self, request: &Request) -> RequestClass {
        self.requests = self.requests.wrapping_add(1);
        let used = self.requests;
        let is_opening = request.operation == Operation::Open;
        let Some(entry) = self.entry_mut(request.session) else {
            return if is_opening {
                RequestClass::Open
            } else {
                RequestClass::NotOpen
            };
        };
        if !is_opening && entry.nonce != request.nonce {
            return RequestClass::NotOpen;
        }
        entry.used = used;
        if entry.number == request.number {
            return entry
                .reply
                .map_or(RequestClass::Ignore, RequestClass::Repeat);
        }
        if request.number < entry.number {
            return RequestClass::Ignore;
        }
        if is_opening {
            return RequestClass::Open;
        }
        (entry.number, entry.reply) = (request.number, None);
        RequestClass::New
    }

    /// Classifies a renewal; a new one becomes the session's last.
    pub fn renew(&mut self, request: &Request) -> RenewalClass {
        match self.entry_mut(request.session) {
            Some(entry) if entry.nonce == request.nonce => {
                if request.number <= entry.renewed {
                    return RenewalClass::Ignore;
                }
                entry.renewed = request.number;
                RenewalClass::New
            }
            _ => RenewalClass::NotOpen,
        }
    }

    /// Opens a session, or gives it another nonce; it has no subscription then.
    /// Where there is no room, the least recently used session is evicted that
    /// is not `needed`, one without a subscription first: short commands come and go beside a
    /// recording, which says little meanwhile.
    pub fn open(&mut self, request: &Request, needed: [Option<Session>; 2]) -> Reply {
        let nonce = self.next_nonce();
        let Request {
            session, number, ..
        } = *request;
        let reply = Reply {
            session,
            number,
            answer: Ok(Answer::Opened { nonce }),
        };
        let entry = Entry {
            session,
            nonce,
            number,
            renewed: number,
            reply: Some(reply),
            is_subscribed: false,
            used: self.requests,
        };
        let place = self
            .entries
            .iter()
            .position(|old| old.session == session)
            .or_else(|| self.least_recent(needed));
        match place.and_then(|place| self.entries.get_mut(place)) {
            Some(old) => *old = entry,
            // Cannot fail: there is room, or one was evicted.
            None => {
                let _ = self.entries.push(entry);
            }
        }
        reply
    }

    /// The place of the session to evict, if there is no room.
    fn least_recent(&self, needed: [Option<Session>; 2]) -> Option<usize> {
        if !self.entries.is_full() {
            return None;
        }
        self.entries
            .iter()
            .enumerate()
            .filter(|(_, entry)| !needed.contains(&Some(entry.session)))
            .min_by_key(|(_, entry)| (entry.is_subscribed, entry.used))
            .map(|(place, _)| place)
    }

    /// Stores the reply to the current request.
    pub fn store_reply(&mut self, reply: &Reply) {
        if let Some(entry) = self.entry_mut(reply.session)
            && entry.number == reply.number
        {
            entry.reply = Some(*reply);
        }
    }

    /// Starts or stops telemetry of a session.
    pub fn subscribe(&mut self, session: Session, is_subscribed: bool) {
        if let Some(entry) = self.entry_mut(session) {
            entry.is_subscribed = is_subscribed;
        }
    }

    /// Stops telemetry of all sessions.
    pub fn unsubscribe_all(&mut self) {
        for entry in &mut self.entries {
            entry.is_subscribed = false;
        }
    }

    /// Returns whether a session has telemetry.
    pub fn has_subscriber(&self) -> bool {
        self.entries.iter().any(|entry| entry.is_subscribed)
    }

    fn entry_mut(&mut self, session: Session) -> Option<&mut Entry> {
        self.entries
            .iter_mut()
            .find(|entry| entry.session == session)
    }

    /// The upper half of SplitMix64's next number (Steele, Lea and Flood, 2014),
    /// but never [`Nonce::NONE`].
    fn next_nonce(&mut self) -> Nonce {
        self.nonces = self.nonces.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = self.nonces;
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let [.., a, b, c, d] = (z ^ (z >> 31)).to_le_bytes();
        Nonce(u32::from_le_bytes([a, b, c, d]).max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOBODY: [Option<Session>; 2] = [None; 2];

    impl Sessions {
        fn is_open(&self, session: Session, nonce: Nonce) -> bool {
            let mut entries = self.entries.iter();
            entries.any(|entry| (entry.session, entry.nonce) == (session, nonce))
        }
    }

    fn request(session: u32, nonce: Nonce, number: u32, operation: Operation) -> Request {
        Request {
            session: Session(session),
            nonce,
            number,
            operation,
        }
    }

    /// Opens a session with this number.
    fn open(sessions: &mut Sessions, session: u32, number: u32) -> Nonce {
        let opening = request(session, Nonce::NONE, number, Operation::Open);
        assert_eq!(sessions.classify(&opening), RequestClass::Open);
        let Ok(Answer::Opened { nonce }) = sessions.open(&opening, NOBODY).answer else {
            panic!("not opened");
        };
        nonce
    }

    #[test]
    fn a_request_is_carried_out_once() {
        let mut sessions = Sessions::new(1);
        let nonce = open(&mut sessions, 1, 0xfffd);
        let status = |number| request(1, nonce, number, Operation::Status);
        for number in [0xfffe, 0xffff, 0x1_0000, u32::MAX] {
            assert_eq!(sessions.classify(&status(number)), RequestClass::New);
            assert_eq!(sessions.classify(&status(number)), RequestClass::Ignore);
            let reply = Reply {
                session: Session(1),
                number,
                answer: Ok(Answer::Done),
            };
            sessions.store_reply(&reply);
            assert_eq!(
                sessions.classify(&status(number)),
                RequestClass::Repeat(reply)
            );
            let older = status(number - 1);
            assert_eq!(sessions.classify(&older), RequestClass::Ignore);
        }
    }

    #[test]
    fn a_renewal_counts_once_and_not_after_a_newer_one() {
        let mut sessions = Sessions::new(1);
        let nonce = open(&mut sessions, 1, 7);
        let renewal = |number| request(1, nonce, number, Operation::Renew);
        let numbers = [7, 8, 8, 7, 10, 9, 10, 0x1_0000, 11, u32::MAX, 0];
        let new = numbers.map(|number| sessions.renew(&renewal(number)) == RenewalClass::New);
        let expected = [8, 10, 0x1_0000, u32::MAX];
        let mut left = expected.iter();
        for (number, is_new) in numbers.iter().zip(new) {
            assert!(!is_new || left.next() == Some(number), "{number}");
        }
        assert_eq!(left.next(), None);
        // Requests are numbered with them, and are none of them.
        let status = request(1, nonce, 9, Operation::Status);
        assert_eq!(sessions.classify(&status), RequestClass::New);
        let other = request(1, Nonce(nonce.0 ^ 1), 12, Operation::Renew);
        assert_eq!(sessions.renew(&other), RenewalClass::NotOpen);
        // Opened again, it begins where its opening was.
        let nonce = open(&mut sessions, 1, 20);
        let renewal = |number| request(1, nonce, number, Operation::Renew);
        assert_eq!(sessions.renew(&renewal(20)), RenewalClass::Ignore);
        assert_eq!(sessions.renew(&renewal(21)), RenewalClass::New);
    }

    #[test]
    fn a_session_is_opened_once_by_each_number_and_older_openings_are_ignored() {
        let mut sessions = Sessions::new(1);
        let first = open(&mut sessions, 1, 7);
        sessions.subscribe(Session(1), true);
        let again = request(1, Nonce::NONE, 7, Operation::Open);
        let RequestClass::Repeat(reply) = sessions.classify(&again) else {
            panic!("the opening is carried out again");
        };
        assert_eq!(reply.answer, Ok(Answer::Opened { nonce: first }));
        assert!(sessions.has_subscriber());

        let second = open(&mut sessions, 1, 9);
        assert_ne!(first, second);
        assert!(!sessions.has_subscriber());
        assert_eq!(sessions.classify(&again), RequestClass::Ignore);
        assert!(sessions.is_open(Session(1), second));
        assert!(!sessions.is_open(Session(1), first));
        let late = request(1, first, 10, Operation::Arm);
        assert_eq!(sessions.classify(&late), RequestClass::NotOpen);
    }

    #[test]
    fn the_least_recently_used_session_is_evicted_but_not_one_that_is_needed() {
        let mut sessions = Sessions::new(1);
        let nonces: [Nonce; SESSIONS] =
            core::array::from_fn(|n| open(&mut sessions, u32::try_from(n).unwrap(), 7));
        for (n, nonce) in nonces.iter().enumerate().filter(|(n, _)| *n != 5) {
            let request = request(u32::try_from(n).unwrap(), *nonce, 8, Operation::Status);
            assert_eq!(sessions.classify(&request), RequestClass::New);
        }
        let one_more = request(99, Nonce::NONE, 1, Operation::Open);
        assert_eq!(sessions.classify(&one_more), RequestClass::Open);
        sessions.open(&one_more, [Some(Session(5)), Some(Session(0))]);
        assert!(sessions.is_open(Session(5), nonces[5]), "needed");
        assert!(sessions.is_open(Session(0), nonces[0]), "needed");
        assert!(!sessions.is_open(Session(1), nonces[1]), "the least recent");
        open(&mut sessions, 100, 1);
        assert!(!sessions.is_open(Session(5), nonces[5]));
        assert!(sessions.is_open(Session(2), nonces[2]));
    }

    /// Many short commands beside a recording, which only listens.
    #[test]
    fn one_with_a_subscription_is_evicted_last() {
        let mut sessions = Sessions::new(1);
        let nonces: [Nonce; SESSIONS] =
            core::array::from_fn(|n| open(&mut sessions, u32::try_from(n).unwrap(), 7));
        sessions.subscribe(Session(0), true);
        for n in 100..200 {
            open(&mut sessions, n, 1);
        }
        assert!(sessions.is_open(Session(0), nonces[0]));
        // Where all have one, one of them.
        for n in 168..200 {
            sessions.subscribe(Session(n), true);
        }
        let last = open(&mut sessions, 200, 1);
        assert!(!sessions.is_open(Session(0), nonces[0]));
        assert!(sessions.is_open(Session(200), last));
    }

    #[test]
    fn nonces_do_not_repeat() {
        let mut sessions = Sessions::new(0);
        let mut drawn: std::vec::Vec<_> = (0..1_000).map(|_| sessions.next_nonce().0).collect();
        drawn.sort_unstable();
        drawn.dedup();
        assert_eq!(drawn.len(), 1_000);
        assert!(!drawn.contains(&Nonce::NONE.0));
    }
}
