//! The lane that never changes. Its bytes stand here, in the test, and not in
//! a file that can be rewritten: programs of any two versions must be able
//! to identify and to stop each other.

use crate::examples::{Example, received};
use crate::hex::{bytes, hex};
use crepitus_protocol::management::{
    Action, Answer, Identity, ManagementRequest, ResetCause, Role,
};
use crepitus_protocol::{Lane, frame};

const FOR_EVER: &str = "\n\
    The bytes of the management lane have changed. They may NEVER change: a device in the field\n\
    and a host of any other version meet here to identify and to stop each other. There is no new\n\
    version of this lane and no way to bless other bytes: undo the change. What a later version\n\
    has to say in addition goes behind the bytes that there are; receivers ignore it.\n";

/// A message of the lane, with its body and frame, which never change.
struct Vector {
    name: &'static str,
    message: Message,
    body: &'static str,
    frame: &'static str,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Message {
    ManagementRequest(ManagementRequest),
    Answer(Answer),
}

impl Message {
    fn lane(&self) -> Lane {
        match self {
            Self::ManagementRequest(_) => Lane::Management,
            Self::Answer(_) => Lane::ManagementAnswer,
        }
    }

    fn bytes(&self) -> Vec<u8> {
        match self {
            Self::ManagementRequest(request) => request.bytes().to_vec(),
            Self::Answer(answer) => answer.bytes().to_vec(),
        }
    }

    fn of(lane: Lane, bytes: &[u8]) -> Option<Self> {
        match lane {
            Lane::Management => ManagementRequest::of(bytes).map(Self::ManagementRequest),
            _ => Answer::of(bytes).map(Self::Answer),
        }
    }
}

fn request(action: Action, token: u8) -> Message {
    Message::ManagementRequest(ManagementRequest { action, token })
}

fn comms() -> Identity {
    Identity {
        role: Role::Comms,
        version: [1, 2, 3],
        schema: 0x0123_4567_89ab_cdef,
        serial: *b"COMMS-SERIAL",
        image: 0xdead_beef,
        reset: ResetCause::Requested,
    }
}

fn drive(reset: ResetCause) -> Identity {
    Identity {
        role: Role::Drive,
        serial: *b"DRIVE-SERIAL",
        reset,
        ..comms()
    }
}

fn vectors() -> Vec<Vector> {
    let answer = Message::Answer;
    vec![
        Vector {
            name: "management.hello",
            message: request(Action::Hello, 0xa5),
            body: "4d 31 48 a5",
            frame: "09 4d 31 48 a5 31 42 8f f3 00",
        },
        Vector {
            name: "management.stop",
            message: request(Action::Stop, 1),
            body: "4d 31 53 01",
            frame: "09 4d 31 53 01 5a ee 02 8b 00",
        },
        Vector {
            name: "management.reboot",
            message: request(Action::Reboot, 0),
            body: "4d 31 42 00",
            frame: "04 4d 31 42 05 dc fd dc af 00",
        },
        Vector {
            name: "management.hello.answer",
            message: answer(Answer::Hello {
                token: 0xa5,
                own: comms(),
                drive: drive(ResetCause::BrownOut),
            }),
            body: "6d 31 48 a5 \
                   01 01 02 03 ef cd ab 89 67 45 23 01 43 4f 4d 4d 53 2d 53 45 52 49 41 4c ef be ad de 01 00 00 00 \
                   02 01 02 03 ef cd ab 89 67 45 23 01 44 52 49 56 45 2d 53 45 52 49 41 4c ef be ad de 03 00 00 00",
            frame: "22 6d 31 48 a5 01 01 02 03 ef cd ab 89 67 45 23 01 43 4f 4d 4d 53 2d 53 45 52 49 41 4c ef be ad \
                    de 01 01 01 1e 02 01 02 03 ef cd ab 89 67 45 23 01 44 52 49 56 45 2d 53 45 52 49 41 4c ef be ad \
                    de 03 01 01 05 98 7a 5a c2 00",
        },
        Vector {
            name: "management.hello.answer-without-drive",
            message: answer(Answer::Hello {
                token: 0,
                own: Identity {
                    reset: ResetCause::Panic,
                    ..comms()
                },
                drive: Identity::default(),
            }),
            body: "6d 31 48 00 \
                   01 01 02 03 ef cd ab 89 67 45 23 01 43 4f 4d 4d 53 2d 53 45 52 49 41 4c ef be ad de 04 00 00 00 \
                   00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00",
            frame: "04 6d 31 48 1e 01 01 02 03 ef cd ab 89 67 45 23 01 43 4f 4d 4d 53 2d 53 45 52 49 41 4c ef be ad \
                    de 04 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 \
                    01 01 01 01 05 9c c7 ae c3 00",
        },
        Vector {
            name: "management.stop.answer",
            message: answer(Answer::Stop {
                token: 1,
                done: true,
            }),
            body: "6d 31 53 01 01",
            frame: "0a 6d 31 53 01 01 1b 4a f1 ef 00",
        },
        Vector {
            name: "management.reboot.answer",
            message: answer(Answer::Reboot {
                token: 0,
                done: true,
            }),
            body: "6d 31 42 00 01",
            frame: "04 6d 31 42 06 01 1d b2 0e eb 00",
        },
        Vector {
            name: "management.reboot.refused",
            message: answer(Answer::Reboot {
                token: 2,
                done: false,
            }),
            body: "6d 31 42 02 00",
            frame: "05 6d 31 42 02 05 09 e0 3f ae 00",
        },
    ]
}

/// The lane's messages, for the file and the book.
pub(crate) fn examples() -> Vec<Example> {
    vectors()
        .into_iter()
        .map(|vector| {
            let lane = vector.message.lane();
            let frame = frame::encode_bytes(lane, &vector.message.bytes()).expect("it fits");
            Example {
                name: vector.name.to_owned(),
                means: match vector.message {
                    Message::ManagementRequest(request) => format!("{request:?}"),
                    Message::Answer(answer) => format!("{answer:?}"),
                },
                lane,
                schema: None,
                body: received(&frame),
                frame: frame.to_vec(),
            }
        })
        .collect()
}

#[test]
fn the_management_lane_is_as_it_always_was() {
    for (vector, example) in vectors().iter().zip(examples()) {
        let name = vector.name;
        assert_eq!(hex(&example.body), vector.body, "{name}{FOR_EVER}");
        assert_eq!(hex(&example.frame), vector.frame, "{name}{FOR_EVER}");
        let body = received(&bytes(vector.frame));
        let mut back = Message::of(example.lane, &body[2..]);
        assert_eq!(back, Some(vector.message), "{name}{FOR_EVER}");
        // Extra bytes of a later version are ignored.
        back = Message::of(example.lane, &[&body[2..], b"more"].concat());
        assert_eq!(back, Some(vector.message), "{name}{FOR_EVER}");
    }
}

#[test]
fn the_bytes_of_the_management_lane_never_change() {
    // No `_`: a new action does not compile until it is listed here.
    for action in [Action::Hello, Action::Stop, Action::Reboot] {
        let byte = match action {
            Action::Hello => b'H',
            Action::Stop => b'S',
            Action::Reboot => b'B',
        };
        assert_eq!(
            ManagementRequest { action, token: 5 }.bytes(),
            [byte, 5],
            "{FOR_EVER}"
        );
    }
    for reset in ResetCause::ALL {
        let number = match reset {
            ResetCause::Power => 0,
            ResetCause::Requested => 1,
            ResetCause::Watchdog => 2,
            ResetCause::BrownOut => 3,
            ResetCause::Panic => 4,
        };
        let own = drive(reset);
        assert_eq!(own.bytes()[28], number, "{reset:?}{FOR_EVER}");
        assert_eq!(Identity::of(&own.bytes()), own, "{FOR_EVER}");
    }
    for role in [Role::Unknown, Role::Comms, Role::Drive] {
        let number = match role {
            Role::Unknown => 0,
            Role::Comms => 1,
            Role::Drive => 2,
        };
        let own = Identity { role, ..comms() };
        assert_eq!(own.bytes()[0], number, "{role:?}{FOR_EVER}");
    }
}
