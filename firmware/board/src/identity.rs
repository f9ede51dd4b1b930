//! The identity of this controller.

use crate::raw;
use crate::start::Start;
use crepitus_protocol::frame::CRC;
use crepitus_protocol::management::{Identity, Role};
use crepitus_protocol::schema;
use stm32f4xx_hal::signature::Uid;

/// The identity in a hello. The image's CRC-32 covers code, constants and
/// initial values in flash, without the vector table: the output of
/// `rust-objcopy -O binary --gap-fill 0xff -j .text -j .rodata -j .data`.
/// Takes a few milliseconds.
pub fn identity(role: Role, start: &Start) -> Identity {
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
        image: CRC.checksum(raw::image()),
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
