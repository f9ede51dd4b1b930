//! Permissions of the MPU, as the library has answered them before.

use rsemu::cpu::arm::v7m::ArmV7m;
use rsemu::cpu::arm::v7m::sys::{Access, Sys};

/// The smallest piece of memory with permissions of its own: a region, or an
/// eighth of one.
const PIECE_BITS: u32 = 5;

/// Answers that are kept.
const KEPT: usize = 2048;

/// No piece has this key.
const NONE: u32 = u32::MAX;

/// A priority at which the MPU is on, if it is.
const ORDINARY: i32 = 0;

const ACCESSES: [Access; 3] = [Access::Read, Access::Write, Access::Fetch];

#[derive(Clone, Copy)]
struct Answer {
    /// Number of the piece, and whether the program is privileged.
    key: u32,
    /// A bit for each of [`ACCESSES`].
    permits: u8,
}

/// Answers for the MPU's present regions.
pub(super) struct Permissions {
    control: u32,
    bases: [u32; 8],
    attributes: [u32; 8],
    answers: Box<[Answer; KEPT]>,
}

impl Default for Permissions {
    fn default() -> Self {
        let none = Answer {
            key: NONE,
            permits: 0,
        };
        Self {
            control: 0,
            bases: [0; 8],
            attributes: [0; 8],
            answers: Box::new([none; KEPT]),
        }
    }
}

/// Returns whether two addresses always have the same permissions.
pub(super) fn is_one_piece(a: u32, b: u32) -> bool {
    a >> PIECE_BITS == b >> PIECE_BITS
}

impl Permissions {
    /// Drops all answers if the regions have changed.
    pub(super) fn refresh(&mut self, sys: &Sys) {
        let is_same = self.control == sys.mpu_ctrl
            && self.bases == sys.mpu_rbar
            && self.attributes == sys.mpu_rasr;
        if !is_same {
            (self.control, self.bases) = (sys.mpu_ctrl, sys.mpu_rbar);
            self.attributes = sys.mpu_rasr;
            for answer in self.answers.iter_mut() {
                answer.key = NONE;
            }
        }
    }

    /// Returns whether the access is permitted, at priorities that are not negative.
    #[inline]
    pub(super) fn permits(
        &mut self,
        core: &ArmV7m,
        address: u32,
        access: Access,
        is_privileged: bool,
    ) -> bool {
        let piece = address >> PIECE_BITS;
        let key = piece << 1 | u32::from(is_privileged);
        // Without the upper bits all memories would begin at the same place.
        let place = (piece ^ address >> 20) as usize % KEPT;
        let answer = &mut self.answers[place];
        if answer.key != key {
            *answer = ask(core, key, address, is_privileged);
        }
        answer.permits >> access as u8 & 1 == 1
    }
}

#[cold]
fn ask(core: &ArmV7m, key: u32, address: u32, is_privileged: bool) -> Answer {
    let permits = core.with_sys(|sys| {
        ACCESSES.iter().fold(0, |permits, access| {
            let permitted = sys.mpu_permits(address, *access, is_privileged, ORDINARY);
            permits | u8::from(permitted) << *access as u8
        })
    });
    Answer { key, permits }
}
