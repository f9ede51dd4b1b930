//! What is counted, by name: a counter's place in its list is its place on
//! the wire.
//!
//! Counters wrap: the difference of two readings is right as long as less
//! than 2³² lies between.

/// A counter of one controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CounterSpec {
    /// Name.
    pub name: &'static str,
    /// What it counts.
    pub meaning: &'static str,
}

macro_rules! counters {
    ($(#[$doc:meta])* $enum:ident, $list:ident, $count:ident: $($variant:ident $name:literal $meaning:literal,)+) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $enum {
            $(#[doc = $meaning] $variant,)+
        }

        impl $enum {
            /// Its place.
            pub const fn index(self) -> usize {
                self as usize
            }
        }

        #[doc = concat!("The table of [`", stringify!($enum), "`].")]
        pub const $list: [CounterSpec; $count] =
            [$(CounterSpec { name: $name, meaning: $meaning },)+];

        #[doc = concat!("How many [`", stringify!($enum), "`]s there are.")]
        pub const $count: usize = [$($enum::$variant),+].len();
    };
}

counters! {
    /// What the drive counts.
    DriveCounter, DRIVE_COUNTERS, DRIVE_COUNT:
    Produced "produced-samples" "Samples that were put into blocks.",
    Dropped "dropped-samples" "Samples of blocks that found no place in the queue to the link.",
    Frames "received-frames" "Frames from comms that were in order.",
    Discarded "discarded-frames" "Frames from comms that were too long, malformed, or had a wrong checksum; commits with a wrong checksum over all values.",
    Foreign "foreign-frames" "Frames of a lane or a language that the drive does not speak.",
    Heartbeats "heartbeats" "Heartbeats that were fresh.",
    StaleHeartbeats "stale-heartbeats" "Heartbeats that had been on their way for too long.",
    StaleCommands "stale-commands" "Commands that were late or out of order.",
    Commits "commits" "Parameter commits that came into force.",
    RefusedCommits "refused-commits" "Parameter commits that were refused.",
    LostSamples "lost-samples" "Encoder counts that were not to be believed.",
    LateTicks "late-ticks" "Ticks whose torque was not ready in time.",
    MissedCurrents "missed-currents" "Ticks without a measured current.",
    LimitedTicks "limited-ticks" "Armed ticks whose torque was limited.",
    Armings "armings" "Times that it was armed.",
    Faults "faults" "Faults that were raised.",
}

counters! {
    /// What comms counts.
    CommsCounter, COMMS_COUNTERS, COMMS_COUNT:
    FromDrive "drive-frames" "Frames from the drive that were in order.",
    FromDriveDiscarded "drive-discarded-frames" "Frames from the drive that were too long, malformed, or had a wrong checksum.",
    FromHost "host-frames" "Frames from the host that were in order.",
    FromHostDiscarded "host-discarded-frames" "Frames from the host that were too long, malformed, or had a wrong checksum.",
    Foreign "foreign-frames" "Frames of a lane or a language that comms does not speak.",
    ReceivedSamples "received-samples" "Samples that came from the drive.",
    LostSamples "lost-samples" "Samples that the drive produced and the link lost.",
    DroppedSamples "dropped-samples" "Samples that found no place in the queue to the host.",
    SentSamples "sent-samples" "Samples that went to the host.",
    DroppedReplies "dropped-replies" "Replies that found no place in the queue to the host.",
    Requests "requests" "Requests that were carried out.",
    RepeatedRequests "repeated-requests" "Requests that had been answered already, and were answered again.",
    Renewals "lease-renewals" "Renewals of the lease.",
    LeasesExpired "expired-leases" "Leases that ran out.",
    DriveRestarts "drive-restarts" "Times that the drive started again.",
    Faults "faults" "Faults that were raised.",
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique() {
        for list in [&DRIVE_COUNTERS[..], &COMMS_COUNTERS[..]] {
            for (i, counter) in list.iter().enumerate() {
                assert!(list[..i].iter().all(|other| other.name != counter.name));
            }
        }
        assert_eq!(DRIVE_COUNTERS[DriveCounter::Faults.index()].name, "faults");
        assert_eq!(COMMS_COUNTERS[CommsCounter::Faults.index()].name, "faults");
    }
}
