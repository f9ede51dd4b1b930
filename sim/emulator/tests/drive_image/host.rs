//! A host at the USB end of the native comms.

use crate::locks::LockCheck;
use crate::times::Books;
use crepitus_device::usb_port::HostBytes;
use crepitus_emulator::drive_board::NativeComms;
use crepitus_emulator::firmware::{Program, image_for_test};
use crepitus_emulator::mcu::Watch;
use crepitus_emulator::{DriveBoard, Image, Time};
use crepitus_protocol::frame;
use crepitus_protocol::host::{Answer, Operation, Refusal, Reply, Request};
use crepitus_protocol::link::DriveRefusal;
use crepitus_protocol::telemetry::Block;
use crepitus_protocol::{Decoder, Lane, Nonce, Revision, Session};
use crepitus_scene::values::values;
use crepitus_scene::{Overrides, Scene};
use crepitus_virtual_device::Leg;
use std::path::Path;

/// Timing of flash and of registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flash {
    /// The core never waits.
    ZeroWaitStates,
    /// The core waits as the reference manual says.
    Modelled,
}

impl Flash {
    pub(crate) const BOTH: [Self; 2] = [Self::ZeroWaitStates, Self::Modelled];

    /// Label of figures.
    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::ZeroWaitStates => "modelled, 0 wait states",
            Self::Modelled => "modelled flash",
        }
    }
}

/// Returns whether the long mode is asked for.
pub(crate) fn is_long() -> bool {
    std::env::var_os("CREPITUS_LONG").is_some()
}

/// Returns the rows to judge of a table with one row for each [`Flash`]: that of the modelled flash,
/// where a tick takes longest, and in the long mode both.
pub(crate) fn judged<T>(rows: [T; 2]) -> impl Iterator<Item = T> {
    rows.into_iter().skip(usize::from(!is_long()))
}

/// Ticks between two renewals of the lease: 50 ms.
const RENEWAL_TICKS: u64 = 1_000;

/// Ticks until the image must run.
const BOOT_TICKS: u64 = 1_000;

pub(crate) struct Host {
    pub(crate) board: DriveBoard,
    number: u32,
    nonce: Nonce,
    holds_lease: bool,
    ticks: u64,
    from_comms: Decoder,
    replies: Vec<Reply>,
    from_drive: Decoder,
    decoded: usize,
    /// Blocks that the drive has sent.
    pub(crate) blocks: Vec<Block>,
    /// Checks every step of the core.
    pub(crate) locks: Option<LockCheck>,
    /// Books of every step of the core.
    pub(crate) books: Option<Books>,
    /// A test breaks what the board checks, on purpose.
    pub(crate) breaks_board: bool,
}

pub(crate) fn image() -> Option<Image> {
    image_for_test(Program::Drive)
}

pub(crate) fn examination() -> Scene {
    scene("")
}

/// The examination with more effects.
pub(crate) fn scene(effects: &str) -> Scene {
    scene_of(&[include_str!("examination.toml"), effects].concat())
}

/// A scene of this text.
pub(crate) fn scene_of(text: &str) -> Scene {
    Scene::parse(Path::new("examination.toml"), text, &Overrides::default()).expect("a scene")
}

impl Host {
    /// A board with the scene's parameters kept in comms, until its image
    /// runs.
    pub(crate) fn new(image: &Image, scene: &Scene) -> Self {
        Self::listening(image, scene, &[])
    }

    /// [`Self::listening`] with this timing from the first instruction on.
    pub(crate) fn timed(image: &Image, scene: &Scene, registers: &[u32], flash: Flash) -> Self {
        let mut host = Self::switched_on(image, scene, registers);
        if flash == Flash::Modelled {
            host.board.mcu_mut().model_flash();
        }
        host.boot();
        host
    }

    /// [`Self::timed`] with books from the first instruction on.
    pub(crate) fn with_books(
        image: &Image,
        scene: &Scene,
        registers: &[u32],
        flash: Flash,
    ) -> Self {
        let mut host = Self::switched_on(image, scene, registers);
        if flash == Flash::Modelled {
            host.board.mcu_mut().model_flash();
        }
        host.books = Some(Books::default());
        host.boot();
        host
    }

    /// [`Self::listening`] with a core that stands still until `late` before it sets
    /// anything up: comms sends meanwhile.
    pub(crate) fn late(image: &Image, scene: &Scene, registers: &[u32], late: Time) -> Self {
        let mut host = Self::switched_on(image, scene, registers);
        let mcu = host.board.mcu_mut();
        mcu.set_hung(true);
        mcu.run_until(late);
        mcu.set_hung(false);
        host.boot();
        host
    }

    /// [`Self::new`] with accesses to these registers written down from the first
    /// instruction on.
    pub(crate) fn listening(image: &Image, scene: &Scene, registers: &[u32]) -> Self {
        Self::timed(image, scene, registers, Flash::ZeroWaitStates)
    }

    /// [`Self::new`] with `locks` checked from the first instruction on.
    pub(crate) fn locked(image: &Image, scene: &Scene, locks: LockCheck) -> Self {
        let mut host = Self::switched_on(image, scene, &[]);
        host.board.mcu_mut().observe_ram(&locks.ranges());
        host.locks = Some(locks);
        host.boot();
        host
    }

    fn switched_on(image: &Image, scene: &Scene, registers: &[u32]) -> Self {
        let values = values(scene).expect("a scene for the device");
        let mut board = DriveBoard::new(
            image,
            Leg::new(scene),
            NativeComms::new(Some((Revision(1), values))),
        );
        board.comms_mut().record_bytes();
        board.mcu_mut().listen(registers);
        Self {
            board,
            number: 0,
            nonce: Nonce::NONE,
            holds_lease: false,
            ticks: 0,
            from_comms: Decoder::new(),
            replies: Vec::new(),
            from_drive: Decoder::new(),
            decoded: 0,
            blocks: Vec::new(),
            locks: None,
            books: None,
            breaks_board: false,
        }
    }

    fn boot(&mut self) {
        for _ in 0..BOOT_TICKS {
            if self.board.is_synchronised() {
                return;
            }
            self.run(1);
        }
        panic!("the image does not start");
    }

    pub(crate) fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.renew();
            match (&mut self.locks, &mut self.books) {
                (Some(locks), _) => self.board.watch(1, locks),
                (None, Some(books)) => self.board.watch(1, books),
                (None, None) => self.board.run(1),
            }
            self.hear();
        }
    }

    /// Runs as [`Self::run`] does, passing every step of the core to `watch`.
    pub(crate) fn watch(&mut self, ticks: u64, watch: &mut dyn Watch) {
        for _ in 0..ticks {
            self.renew();
            self.board.watch(1, watch);
            self.hear();
        }
    }

    /// A tick of the board by other means.
    pub(crate) fn with_board(&mut self, tick: impl FnOnce(&mut DriveBoard)) {
        self.renew();
        tick(&mut self.board);
        self.hear();
    }

    /// Renews the lease, when it is time.
    fn renew(&mut self) {
        if self.holds_lease && self.ticks.is_multiple_of(RENEWAL_TICKS) {
            self.say_renewal();
        }
    }

    fn say_renewal(&mut self) {
        self.number += 1;
        self.say(self.number, Operation::Renew);
    }

    /// Counts a tick that has passed; reads what was sent, and checks what the board found.
    fn hear(&mut self) {
        self.ticks += 1;
        self.listen();
        self.check_board();
    }

    /// Fails at the first mismatch of image and board.
    fn check_board(&self) {
        let errors = self.board.errors();
        let lines = errors.iter().map(|(at, error)| {
            let tick = at.units() / Time::from_us(50).units();
            format!("tick {tick}: {error}")
        });
        let lines: Vec<String> = lines.collect();
        assert!(
            lines.is_empty() || self.breaks_board,
            "{}",
            lines.join("\n")
        );
    }

    fn say(&mut self, number: u32, operation: Operation) {
        let request = Request {
            session: Session(0x1234),
            nonce: self.nonce,
            number,
            operation,
        };
        let frame = frame::encode(Lane::Request, &request).expect("a frame");
        self.board.comms_mut().comms_mut().received(&frame);
    }

    fn listen(&mut self) {
        let comms = self.board.comms_mut().comms_mut();
        let bytes = comms.to_send().to_vec();
        comms.sent(bytes.len());
        for byte in bytes {
            if let Some(Ok(body)) = self.from_comms.push(byte)
                && body.lane() == Some(Lane::Reply)
            {
                self.replies.extend(body.message::<Reply>());
            }
        }
        let sent = self.board.comms().from_drive();
        for byte in &sent[self.decoded..] {
            if let Some(Ok(body)) = self.from_drive.push(*byte)
                && body.lane() == Some(Lane::Telemetry)
            {
                self.blocks.extend(body.message::<Block>());
            }
        }
        self.decoded = sent.len();
    }

    /// Asks, and waits for the answer.
    pub(crate) fn ask(&mut self, operation: Operation) -> Result<Answer, Refusal> {
        if self.nonce == Nonce::NONE && operation != Operation::Open {
            match self.ask(Operation::Open) {
                Ok(Answer::Opened { nonce }) => self.nonce = nonce,
                other => panic!("not opened: {other:?}"),
            }
        }
        self.number += 1;
        let number = self.number;
        for _ in 0..40 {
            self.say(number, operation);
            for _ in 0..100 {
                self.run(1);
                let found = self.replies.drain(..).find(|reply| reply.number == number);
                if let Some(reply) = found {
                    return reply.answer;
                }
            }
        }
        panic!("no answer to {operation:?}");
    }

    /// Sends a request, and does not wait for its answer.
    pub(crate) fn request(&mut self, operation: Operation) {
        self.number += 1;
        self.say(self.number, operation);
    }

    /// Takes the lease and arms as soon as the drive has its parameters; sets the
    /// angle's zero here if it needs one.
    pub(crate) fn arm(&mut self) {
        match self.try_to_arm() {
            Ok(Answer::Done) => {}
            other => panic!("arming: {other:?}"),
        }
    }

    /// Arms as [`Self::arm`] does; returns the answer.
    pub(crate) fn try_to_arm(&mut self) -> Result<Answer, Refusal> {
        self.holds_lease = true;
        self.say_renewal();
        for _ in 0..100 {
            match self.ask(Operation::Arm) {
                Err(Refusal::Busy | Refusal::DriveSilent) => self.run(200),
                Err(Refusal::Drive(DriveRefusal::NotZeroed | DriveRefusal::OutsideRange)) => {
                    assert_eq!(self.ask(Operation::Zero), Ok(Answer::Done));
                }
                answer => return answer,
            }
        }
        panic!("not armed");
    }

    /// Address at which the idle loop continues after it has slept.
    pub(crate) fn idle_pc(&mut self) -> u32 {
        let mut last = None;
        for _ in 0..100 {
            let mcu = self.board.mcu();
            let now = (mcu.exception() == 0).then(|| mcu.program_counter());
            // Where it is twice it sleeps: no place of a condition before it.
            if let Some(counter) = now.filter(|_| now == last) {
                return counter;
            }
            last = now.or(last);
            self.board.half(None);
        }
        panic!("the idle loop does not run");
    }

    /// Returns whether the drive's last block has shown torque.
    pub(crate) fn shows_torque(&self) -> bool {
        let last = self.blocks.last().and_then(|block| block.samples.last());
        last.is_some_and(|sample| sample.torque_nm.abs() > 0.05)
    }

    /// Runs until the hand feels the joint.
    pub(crate) fn run_until_torque(&mut self) {
        for _ in 0..20_000 {
            if self.shows_torque() && self.board.is_driven() {
                // How long it took to start decides in which half it is.
                self.board.to_the_middle();
                return;
            }
            self.run(1);
        }
        panic!("no torque");
    }

    /// Half ticks until the drive itself drives no longer.
    pub(crate) fn halves_until_off(&mut self, at_most: u64) -> u64 {
        for halves in 0..=at_most {
            if !self.board.drive_is_on() {
                return halves;
            }
            self.board.half(None);
        }
        panic!("still on after {at_most} half ticks");
    }
}
