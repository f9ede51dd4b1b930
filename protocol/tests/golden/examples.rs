//! An example of every message. Its numbers are chosen so that no two fields
//! could be exchanged unnoticed, and none depends on a default.

use crate::hex::hex;
use crate::management;
use crepitus_protocol::chirp::PlayedChirp;
use crepitus_protocol::counters::{COMMS_COUNT, DRIVE_COUNT};
use crepitus_protocol::crash::{Controller, Part};
use crepitus_protocol::host::{Answer, Counters, Operation, Refusal, Reply, Request, Status};
use crepitus_protocol::link::{
    DriveRefusal, DriveStatus, FromDrive, Heartbeat, Order, Outcome, ToDrive,
};
use crepitus_protocol::measured::Measured;
use crepitus_protocol::parameters::PARAMETERS;
use crepitus_protocol::pieces::{self, Piece};
use crepitus_protocol::task_times::{DeviceTimes, TaskCycles, TaskTimes};
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, Block};
use crepitus_protocol::telemetry::{
    BlockFlags, CoilCurrent, EffectPhases, NO_CURRENT, Sample, SampleFlags,
};
use crepitus_protocol::{
    Decoder, Frame, Lane, LimitReason, Nonce, Revision, Session, State, ValueError, Values, frame,
};
use postcard_schema::Schema;
use postcard_schema::schema::NamedType;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt::Debug;

/// A message and its bytes.
pub(crate) struct Example {
    pub(crate) name: String,
    pub(crate) means: String,
    pub(crate) lane: Lane,
    /// Schema, if it is a postcard message.
    pub(crate) schema: Option<&'static NamedType>,
    /// Lane, tag, message.
    pub(crate) body: Vec<u8>,
    pub(crate) frame: Vec<u8>,
}

impl Example {
    /// The message alone.
    pub(crate) fn message(&self) -> &[u8] {
        &self.body[2..]
    }
}

/// The body of the one frame that these bytes are.
pub(crate) fn received(frame: &[u8]) -> Vec<u8> {
    let mut decoder = Decoder::new();
    let (last, rest) = frame.split_last().expect("a frame");
    for byte in rest {
        assert!(decoder.push(*byte).is_none(), "a zero inside a frame");
    }
    let body = decoder
        .push(*last)
        .expect("the end")
        .unwrap_or_else(|e| panic!("{e:?}: {}", hex(frame)));
    let mut bytes = vec![body.lane, body.tag];
    bytes.extend(body.payload);
    bytes
}

/// An example; checks the round trip.
fn example<T>(lane: Lane, name: &str, message: &T, means: Option<&str>) -> Example
where
    T: Schema + Serialize + DeserializeOwned + Debug + PartialEq,
{
    let frame: Frame = frame::encode(lane, message).expect("every message fits");
    let body = received(&frame);
    let (back, rest) = postcard::take_from_bytes::<T>(&body[2..]).expect("a message");
    assert!(rest.is_empty(), "{name}: bytes are left");
    assert_eq!(&back, message, "{name} does not come back");
    Example {
        name: name.to_owned(),
        means: means.map_or_else(|| format!("{message:?}"), str::to_owned),
        lane,
        schema: Some(T::SCHEMA),
        body,
        frame: frame.to_vec(),
    }
}

/// Every example.
pub(crate) fn all() -> Vec<Example> {
    let mut all = management::examples();
    all.extend(requests());
    all.extend(replies());
    all.extend(blocks());
    all.extend(to_drive());
    all.extend(from_drive());
    all.push(example(Lane::Times, "times.of-drive", &TIMES, None));
    all.push(example(Lane::Times, "times.of-comms", &COMMS_TIMES, None));
    all
}

const HOST: Session = Session(0x1234_5678);
const NONCE: Nonce = Nonce(0x9abc_def0);
const OTHER: Session = Session(0xcafe);
const CHIRP: PlayedChirp = PlayedChirp {
    amplitude_mv: 400,
    from_dhz: 80,
    to_dhz: 5_000,
    duration_ms: 10_000,
};

/// Half its id for each parameter: no device would take them.
fn values() -> Values {
    let mut values = Values::default();
    for parameter in &PARAMETERS {
        values.set(parameter.id, f64::from(parameter.id) / 2.0);
    }
    values
}

const VALUES: &str = "the value of each parameter is half its id";

/// Names of requests. A new one does not compile until it is here, and fails
/// until it has an example.
fn operation_name(operation: &Operation) -> &'static str {
    match operation {
        Operation::Renew => "renew",
        Operation::Status => "status",
        Operation::Counters => "counters",
        Operation::Parameters => "parameters",
        Operation::Commit { .. } => "commit",
        Operation::Save => "save",
        Operation::Zero => "zero",
        Operation::Arm => "arm",
        Operation::Disarm => "disarm",
        Operation::ClearFault => "clear-fault",
        Operation::Subscribe => "subscribe",
        Operation::Unsubscribe => "unsubscribe",
        Operation::Open => "open",
        Operation::PlayChirp(_) => "play-chirp",
        Operation::Times => "times",
        Operation::ReadCrash { controller, .. } => match controller {
            Controller::Drive => "read-crash.drive",
            Controller::Comms => "read-crash.comms",
        },
    }
}

fn requests() -> Vec<Example> {
    let commit = Operation::Commit {
        base: Revision(300),
        values: values(),
    };
    let asks = vec![
        Operation::Renew,
        Operation::Status,
        Operation::Counters,
        Operation::Parameters,
        commit,
        Operation::Save,
        Operation::PlayChirp(CHIRP),
        Operation::Zero,
        Operation::Arm,
        Operation::Disarm,
        Operation::ClearFault,
        Operation::Subscribe,
        Operation::Unsubscribe,
        Operation::Open,
        Operation::ReadCrash {
            controller: Controller::Drive,
            part: 22,
        },
        Operation::ReadCrash {
            controller: Controller::Comms,
            part: 2,
        },
        Operation::Times,
    ];
    (0x1fe..)
        .zip(asks)
        .map(|(number, operation)| {
            let request = Request {
                session: HOST,
                nonce: if operation == Operation::Open {
                    Nonce::NONE
                } else {
                    NONCE
                },
                number,
                operation,
            };
            let means = (operation == commit)
                .then(|| format!("Request {{ session: Session(305419896), nonce: {NONCE:?}, number: {number}, operation: Commit {{ base: Revision(300), values }} }}; {VALUES}"));
            let name = format!("request.{}", operation_name(&operation));
            example(Lane::Request, &name, &request, means.as_deref())
        })
        .collect()
}

/// Names of answers; see [`operation_name`].
fn answer_name(answer: &Answer) -> &'static str {
    match answer {
        Answer::Done => "done",
        Answer::Status(status) if status.saved.is_some() => "status-full",
        Answer::Status(_) => "status",
        Answer::Counters(_) => "counters",
        Answer::Parameters { .. } => "parameters",
        Answer::Committed { .. } => "committed",
        Answer::Subscribed { .. } => "subscribed",
        Answer::Opened { .. } => "opened",
        Answer::CrashPart(Part { words: None, .. }) => "no-crash-part",
        Answer::CrashPart(_) => "crash-part",
        Answer::Times(_) => "times",
    }
}

/// A part of a post-mortem record.
const PART: Part = Part {
    number: 2,
    words: Some([
        0,
        1,
        127,
        128,
        0xffff,
        0x1_0000,
        0x00ff_ffff,
        0x8000_0000,
        u32::MAX,
        0,
        0,
        0,
        0,
        0,
        0,
        0,
    ]),
};

/// Times of a drive, and none of comms.
const DRIVE_TIMES: TaskTimes = TaskTimes {
    tasks: [
        TaskCycles {
            runs: 20_000,
            worst: 96,
            mean_256: 23_040,
        },
        TaskCycles {
            runs: 20_001,
            worst: 1_870,
            mean_256: 362_752,
        },
        TaskCycles {
            runs: 19_999,
            worst: 1_105,
            mean_256: 230_400,
        },
        TaskCycles {
            runs: 21_000,
            worst: 1_533,
            mean_256: 128,
        },
    ],
    earliest_sample: 40,
    latest_sample: 62,
    late_ticks: 3,
    stack_used: 2_120,
    stack_bytes: 65_536,
};
const COMMS_TIMES: DeviceTimes = DeviceTimes {
    drive: None,
    comms: Some(TaskTimes {
        earliest_sample: 0,
        latest_sample: 0,
        late_ticks: 0,
        ..DRIVE_TIMES
    }),
};
const TIMES: DeviceTimes = DeviceTimes {
    drive: Some(DRIVE_TIMES),
    comms: None,
};

/// Measurements of a drive with a joint's sensor.
const MEASURED: Measured = Measured {
    supply_cv: 2_397,
    motor_c: -3,
    joint_cdeg: Some(118),
};

fn replies() -> Vec<Example> {
    let reply = |answer| Reply {
        session: HOST,
        number: 0x1ff,
        answer,
    };
    let full = Status {
        state: State::Faulted,
        drive_fault: 4,
        comms_fault: 32,
        drive_present: true,
        tick: 20_000_000_000,
        uptime_ms: 1_000_000,
        revision: Revision(301),
        in_force: Revision(300),
        saved: Some(Revision(299)),
        lease: Some(OTHER),
        zeroed: true,
        polarity_proven: true,
        measured: MEASURED,
        coil_fault: 3,
    };
    let answers = [
        Answer::Done,
        Answer::Status(Status::default()),
        Answer::Status(full),
        Answer::Counters(Counters {
            drive: counts::<DRIVE_COUNT>(1_000_000),
            comms: counts::<COMMS_COUNT>(1),
        }),
        Answer::Parameters {
            revision: Revision(300),
            values: values(),
        },
        Answer::Committed {
            revision: Revision(301),
        },
        Answer::Subscribed {
            first_tick: 20_000_000_000,
            dropped: 4_000_000,
            start: 5,
        },
        Answer::Opened { nonce: NONCE },
        Answer::CrashPart(PART),
        Answer::CrashPart(Part {
            words: None,
            ..PART
        }),
        Answer::Times(TIMES),
    ];
    let mut examples: Vec<_> = answers
        .iter()
        .map(|answer| {
            let means = matches!(answer, Answer::Parameters { .. })
                .then(|| format!("Reply {{ session: Session(305419896), number: 511, answer: Ok(Parameters {{ revision: Revision(300), values }}) }}; {VALUES}"));
            let name = format!("reply.{}", answer_name(answer));
            example(Lane::Reply, &name, &reply(Ok(*answer)), means.as_deref())
        })
        .collect();
    for (name, refusal) in refusals() {
        let name = format!("refusal.{name}");
        examples.push(example(Lane::Reply, &name, &reply(Err(refusal)), None));
    }
    examples
}

fn refusals() -> Vec<(String, Refusal)> {
    let mut all: Vec<(String, Refusal)> = [
        (
            "stale",
            Refusal::Stale {
                revision: Revision(302),
            },
        ),
        ("leased", Refusal::Leased { by: OTHER }),
        ("drive-silent", Refusal::DriveSilent),
        ("unconfirmed", Refusal::Unconfirmed),
        ("faulted", Refusal::Faulted { code: 9 }),
        ("armed", Refusal::Armed),
        ("busy", Refusal::Busy),
        ("storage", Refusal::Storage),
        ("aborted", Refusal::Aborted),
        ("not-open", Refusal::NotOpen),
    ]
    .map(|(name, refusal)| (name.to_owned(), refusal))
    .into();
    for (name, error) in [
        ("out-of-range", ValueError::OutOfRange { id: 28 }),
        ("kinetic-above-static", ValueError::KineticAboveStatic),
        ("unguarded", ValueError::Unguarded),
        ("static-above-limit", ValueError::StaticAboveLimit),
        ("narrow-range", ValueError::NarrowRange),
        ("needs-disarmed", ValueError::NeedsDisarmed { id: 6 }),
        ("contradiction", ValueError::Contradiction),
    ] {
        all.push((format!("values.{name}"), Refusal::Values(error)));
    }
    for (name, refusal) in [
        ("no-parameters", DriveRefusal::NoParameters),
        ("no-lease", DriveRefusal::NoLease),
        ("faulted", DriveRefusal::Faulted { code: 12 }),
        ("armed", DriveRefusal::Armed),
        ("no-encoder", DriveRefusal::NoEncoder),
        ("aborted", DriveRefusal::Aborted),
        ("not-zeroed", DriveRefusal::NotZeroed),
        ("outside-range", DriveRefusal::OutsideRange),
        ("not-armed", DriveRefusal::NotArmed),
        ("no-actuator", DriveRefusal::NoActuator),
        ("chirp-out-of-range", DriveRefusal::ChirpOutOfRange),
        ("chirp-playing", DriveRefusal::ChirpPlaying),
    ] {
        all.push((format!("drive.{name}"), Refusal::Drive(refusal)));
    }
    all
}

/// Another number at each place.
fn counts<const N: usize>(factor: u32) -> [u32; N] {
    std::array::from_fn(|i| factor * u32::try_from(i).expect("a small number"))
}

fn blocks() -> Vec<Example> {
    let sample = |n: i16| Sample {
        count: -2 + i32::from(n),
        model_torque_nm: 0.25 * f32::from(n),
        torque_nm: -0.5 * f32::from(n),
        current_ma: if n == 0 { NO_CURRENT } else { -100 * n },
        flags: SampleFlags::default()
            .with_phase(if n % 2 == 0 { 0 } else { -1 })
            .with(SampleFlags::ENERGISED, true)
            .with_limit(
                LimitReason::ALL[usize::try_from(n).expect("a place") % LimitReason::ALL.len()],
            ),
    };
    let mut samples = [Sample::default(); BLOCK_SAMPLES];
    for (n, place) in (0..).zip(&mut samples) {
        *place = sample(n);
    }
    let block = Block {
        sequence: 0xfffe,
        first_tick: 20_000_000_000,
        revision: Revision(300),
        dropped: 140,
        flags: BlockFlags::new(State::Armed, true, 3),
        samples,
        phases: core::array::from_fn(|n| EffectPhases(u16::try_from(257 * n).expect("small"))),
        coil_currents: [-1_200, 5, i16::MIN, 300].map(CoilCurrent),
    };
    let means = "Block { sequence: 65534, first_tick: 20000000000, revision: Revision(300), dropped: 140, \
                 flags: BlockFlags(30): armed, zeroed, start 3, samples, phases, coil }; sample n has count n - 2, model torque n/4 N·m, \
                 torque -n/2 N·m, current -100 n mA but none in the first, limit reason n modulo 8, energised, \
                 and slips towards falling angle where n is odd; its effects' phases are 257 n; the coil has -1200, 5, no and 300 mA";
    vec![
        example(Lane::Telemetry, "block", &block, Some(means)),
        example(
            Lane::Telemetry,
            "block.empty",
            &Block::default(),
            Some("a Block of zeros, without a current of the coil"),
        ),
    ]
}

/// Names of the messages to the drive; see [`operation_name`].
fn to_drive_name(message: &ToDrive) -> &'static str {
    match message {
        ToDrive::Heartbeat(_) => "heartbeat",
        ToDrive::Commit { .. } => "commit",
        ToDrive::Command { order, .. } => match order {
            Order::Arm => "command.arm",
            Order::Zero => "command.zero",
            Order::ClearFault => "command.clear-fault",
            Order::PlayChirp(_) => "command.play-chirp",
        },
        ToDrive::ReadCrash { .. } => "read-crash",
    }
}

fn to_drive() -> Vec<Example> {
    let command = |order| ToDrive::Command {
        seen_tick: 20_000_000_000,
        number: 0xff00,
        order,
    };
    let messages = [
        ToDrive::Heartbeat(Heartbeat {
            seen_tick: 20_000_000_000,
            lease_left: 4_980,
            enable: true,
            start: 7,
            number: 0xff,
        }),
        ToDrive::Commit {
            revision: Revision(301),
            seal: pieces::seal(&values().0, 7),
            pieces: 9,
            piece: Piece::of(&values().0, 1).expect("more values than one piece has"),
        },
        command(Order::Arm),
        command(Order::Zero),
        command(Order::ClearFault),
        command(Order::PlayChirp(CHIRP)),
        ToDrive::ReadCrash { part: 22 },
    ];
    messages
        .iter()
        .map(|message| {
            let means = matches!(message, ToDrive::Commit { .. })
                .then(|| format!("Commit {{ revision: Revision(301), checksum, pieces: 9, piece: Piece {{ index: 1, values }} }}; {VALUES}"));
            let name = format!("to-drive.{}", to_drive_name(message));
            example(Lane::ToDrive, &name, message, means.as_deref())
        })
        .collect()
}

fn from_drive() -> Vec<Example> {
    let full = DriveStatus {
        tick: 20_000_000_040,
        start: 7,
        comms_start: Some(9),
        state: State::Armed,
        fault: 0,
        coil_fault: 4,
        revision: Revision(300),
        refused: Some((Revision(301), ValueError::NeedsDisarmed { id: 6 })),
        last: Some(Outcome {
            number: 0xff00,
            result: Ok(()),
        }),
        zeroed: true,
        polarity_proven: true,
        awaits_comms: false,
        measured: MEASURED,
        counters: counts(1_000_000),
    };
    let refused = DriveStatus {
        state: State::Arming,
        last: Some(Outcome {
            number: 1,
            result: Err(DriveRefusal::NoEncoder),
        }),
        ..DriveStatus::default()
    };
    [
        ("at-start", FromDrive::Status(DriveStatus::default())),
        ("full", FromDrive::Status(full)),
        ("command-refused", FromDrive::Status(refused)),
        ("of-a-record", FromDrive::CrashPart(PART)),
        ("of-tasks", FromDrive::Times(DRIVE_TIMES)),
    ]
    .into_iter()
    .map(|(name, message)| {
        // Another kind of message does not compile until it is an example.
        let kind = match message {
            FromDrive::Status(_) => "status",
            FromDrive::CrashPart(_) => "crash-part",
            FromDrive::Times(_) => "times",
        };
        let name = format!("from-drive.{kind}.{name}");
        example(Lane::FromDrive, &name, &message, None)
    })
    .collect()
}
