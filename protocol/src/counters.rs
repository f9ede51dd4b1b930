//! Tables of the event counters: the index in the table is the index on the
//! wire.
//!
//! Counters wrap: the difference of two readings is valid below 2³².

/// A counter of one controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CounterSpec {
    /// Name.
    pub name: &'static str,
    /// Description.
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
            /// Index in the table and on the wire.
            pub const fn index(self) -> usize {
                self as usize
            }
        }

        #[doc = concat!("The table of [`", stringify!($enum), "`].")]
        pub const $list: [CounterSpec; $count] =
            [$(CounterSpec { name: $name, meaning: $meaning },)+];

        #[doc = concat!("Number of [`", stringify!($enum), "`]s.")]
        pub const $count: usize = [$($enum::$variant),+].len();
    };
}

counters! {
    /// Counters of the drive.
    DriveCounter, DRIVE_COUNTERS, DRIVE_COUNT:
    Produced "produced-samples" "Samples that were put into blocks.",
    Dropped "dropped-samples" "Samples of blocks dropped because the queue to the link was full.",
    Frames "received-frames" "Valid frames from comms.",
    Discarded "discarded-frames" "Frames from comms that were too long, malformed, or had a wrong checksum; commits with a wrong checksum over all values.",
    Foreign "foreign-frames" "Frames of an unknown lane, with another schema tag, or with an invalid message.",
    Heartbeats "heartbeats" "Fresh heartbeats.",
    StaleHeartbeats "stale-heartbeats" "Stale heartbeats: delayed too long.",
    StaleCommands "stale-commands" "Stale commands: delayed too long or out of order.",
    Commits "commits" "Parameter commits that were applied.",
    RefusedCommits "refused-commits" "Parameter commits that were rejected.",
    LostSamples "lost-samples" "Implausible encoder counts.",
    LateTicks "late-ticks" "Ticks whose torque was not ready in time.",
    MissedCurrents "missed-currents" "Ticks without a measured current.",
    LimitedTicks "limited-ticks" "Armed ticks whose torque was limited.",
    Armings "armings" "Successful armings.",
    Faults "faults" "Faults that were raised.",
}

counters! {
    /// Counters of comms.
    CommsCounter, COMMS_COUNTERS, COMMS_COUNT:
    FromDrive "drive-frames" "Valid frames from the drive.",
    FromDriveDiscarded "drive-discarded-frames" "Frames from the drive that were too long, malformed, or had a wrong checksum.",
    FromHost "host-frames" "Valid frames from the host.",
    FromHostDiscarded "host-discarded-frames" "Frames from the host that were too long, malformed, or had a wrong checksum.",
    Foreign "foreign-frames" "Frames of an unknown lane, with another schema tag, or with an invalid message.",
    ReceivedSamples "received-samples" "Samples received from the drive.",
    LostSamples "lost-samples" "Samples that the drive produced and the link lost.",
    DroppedSamples "dropped-samples" "Samples dropped because the queue to the host was full.",
    SentSamples "sent-samples" "Samples sent to the host.",
    DroppedReplies "dropped-replies" "Replies dropped because the queue to the host was full.",
    Requests "requests" "Requests executed.",
    RepeatedRequests "repeated-requests" "Repeated requests, answered with the stored reply.",
    Renewals "lease-renewals" "Renewals of the lease.",
    LeasesExpired "expired-leases" "Leases that expired.",
    DriveRestarts "drive-restarts" "Restarts of the drive.",
    Faults "faults" "Faults that were raised.",
    NotOpen "unopened-requests" "Requests of sessions that are not open, or with an old nonce; not executed.",
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Controllers count by variant, people read by name.
    #[test]
    fn every_counter_has_its_place_and_its_name() {
        let drive: [_; DRIVE_COUNT] = [
            (DriveCounter::Produced, "produced-samples"),
            (DriveCounter::Dropped, "dropped-samples"),
            (DriveCounter::Frames, "received-frames"),
            (DriveCounter::Discarded, "discarded-frames"),
            (DriveCounter::Foreign, "foreign-frames"),
            (DriveCounter::Heartbeats, "heartbeats"),
            (DriveCounter::StaleHeartbeats, "stale-heartbeats"),
            (DriveCounter::StaleCommands, "stale-commands"),
            (DriveCounter::Commits, "commits"),
            (DriveCounter::RefusedCommits, "refused-commits"),
            (DriveCounter::LostSamples, "lost-samples"),
            (DriveCounter::LateTicks, "late-ticks"),
            (DriveCounter::MissedCurrents, "missed-currents"),
            (DriveCounter::LimitedTicks, "limited-ticks"),
            (DriveCounter::Armings, "armings"),
            (DriveCounter::Faults, "faults"),
        ];
        let comms: [_; COMMS_COUNT] = [
            (CommsCounter::FromDrive, "drive-frames"),
            (CommsCounter::FromDriveDiscarded, "drive-discarded-frames"),
            (CommsCounter::FromHost, "host-frames"),
            (CommsCounter::FromHostDiscarded, "host-discarded-frames"),
            (CommsCounter::Foreign, "foreign-frames"),
            (CommsCounter::ReceivedSamples, "received-samples"),
            (CommsCounter::LostSamples, "lost-samples"),
            (CommsCounter::DroppedSamples, "dropped-samples"),
            (CommsCounter::SentSamples, "sent-samples"),
            (CommsCounter::DroppedReplies, "dropped-replies"),
            (CommsCounter::Requests, "requests"),
            (CommsCounter::RepeatedRequests, "repeated-requests"),
            (CommsCounter::Renewals, "lease-renewals"),
            (CommsCounter::LeasesExpired, "expired-leases"),
            (CommsCounter::DriveRestarts, "drive-restarts"),
            (CommsCounter::Faults, "faults"),
            (CommsCounter::NotOpen, "unopened-requests"),
        ];
        for (place, (counter, name)) in drive.into_iter().enumerate() {
            assert_eq!(counter.index(), place, "{name}");
            assert_eq!(DRIVE_COUNTERS[place].name, name);
        }
        for (place, (counter, name)) in comms.into_iter().enumerate() {
            assert_eq!(counter.index(), place, "{name}");
            assert_eq!(COMMS_COUNTERS[place].name, name);
        }
    }
}
