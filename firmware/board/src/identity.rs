//! The identity of this controller.

use crate::raw;
use crate::start::Start;
use crepitus_device::board::{CRYSTAL_HZ, crystal_near};
use crepitus_device::self_test::SelfTest;
use crepitus_protocol::frame::CRC;
use crepitus_protocol::management::{Identity, Role};
use crepitus_protocol::schema;
use stm32f4xx_hal::signature::Uid;

/// The place of the seal in the vector table: the eighth word, which ARMv7-M reserves.
const SEAL_AT: usize = 0x1c;

/// The identity in a hello, and the self-test. The checksum covers the
/// first 512 bytes of flash, with the seal as 0, then code, constants and initial
/// values: that of `crepitus-seal`. Takes a few milliseconds.
pub fn identity(
    role: Role,
    start: &Start,
    option_bytes: u32,
    crystal_hz: u32,
) -> (Identity, SelfTest) {
    let vectors = raw::vectors();
    let (head, rest) = vectors.split_at(SEAL_AT);
    let (seal, tail) = rest.split_first_chunk().unwrap_or((&[0; 4], rest));
    let mut digest = CRC.digest();
    for part in [head, &[0; 4], tail, raw::image()] {
        digest.update(part);
    }
    let image = digest.finalize();
    let seal = u32::from_le_bytes(*seal);
    let has_its_crystal = crystal_near(crystal_hz) == Some(CRYSTAL_HZ);
    let self_test = SelfTest::of(seal, image, option_bytes, has_its_crystal);
    (of(role, start, image), self_test)
}

fn of(role: Role, start: &Start, image: u32) -> Identity {
    let part = |text: &str| text.parse().unwrap_or(0);
    Identity {
        role,
        version: [
            part(env!("CARGO_PKG_VERSION_MAJOR")),
            part(env!("CARGO_PKG_VERSION_MINOR")),
            part(env!("CARGO_PKG_VERSION_PATCH")),
        ],
        schema: schema::HASH,
        serial: serial_number(),
        image,
        reset: start.cause,
    }
}

/// The chip's serial number: its place on the wafer, wafer and lot.
fn serial_number() -> [u8; 12] {
    let uid = Uid::get();
    let [x0, x1] = uid.x().to_le_bytes();
    let [y0, y1] = uid.y().to_le_bytes();
    let head = [x0, x1, y0, y1, uid.waf_num()];
    let mut serial = [0; 12];
    for (place, byte) in serial
        .iter_mut()
        .zip(head.into_iter().chain(uid.lot_num().bytes()))
    {
        *place = byte;
    }
    serial
}
