//! Response of the image to its seal, to flash that does not hold what was sealed, and
//! to option bytes.

use crate::host::{Host, examination, image};
use crepitus_emulator::Image;
use crepitus_emulator::firmware::{Program, path};
use crepitus_protocol::Fault;
use crepitus_protocol::host::{Answer, Operation, Refusal};
use crepitus_protocol::link::DriveRefusal;

/// The drive's image, sealed as before it is flashed.
fn sealed() -> Option<Image> {
    image()?;
    let path = path(Program::Drive).expect("it was read");
    let mut elf = std::fs::read(path).expect("a file");
    crepitus_firmware_seal::seal(&mut elf).expect("a seal");
    Some(Image::of_elf(&elf).expect("an image"))
}

/// A device with this image, and its fault at the start.
fn started(image: &Image) -> (Host, u8) {
    let mut host = Host::new(image, &examination());
    host.run(1_000);
    match host.ask(Operation::Status) {
        Ok(Answer::Status(status)) => {
            assert!(status.drive_present, "it has not started");
            (host, status.drive_fault)
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_sealed_image_works() {
    let Some(image) = sealed() else { return };
    let (mut host, fault) = started(&image);
    assert_eq!(fault, 0);
    host.arm();
}

#[test]
fn a_bit_of_flash_that_has_changed_is_a_fault_that_stays() {
    let Some(image) = sealed() else { return };
    let seal = 0x1c;
    // A vector that is not used, the seal, and code that does not run by then.
    let handler = image.symbol("HardFault").expect("a handler").address - 0x0800_0000;
    for place in [0x180, seal, handler as usize + 2, image.flash.len() - 1] {
        let mut broken = image.clone();
        broken.flash[place] ^= 0x10;
        stays(&broken, Fault::DriveImageBroken);
    }
}

#[test]
fn option_bytes_of_another_board_are_a_fault_that_stays() {
    let Some(mut image) = sealed() else { return };
    // As they come from the factory; and with a watchdog that hardware starts.
    for option_bytes in [0x0fff_aaed, image.option_bytes & !(1 << 5)] {
        image.option_bytes = option_bytes;
        stays(&image, Fault::DriveOptionBytes);
    }
}

/// Measured by the internal oscillator, on which the drive runs then. Those that
/// are between two, or near none, are refused, too.
#[test]
fn another_crystal_is_a_fault_that_stays() {
    let Some(mut image) = sealed() else { return };
    for crystal_hz in [12_000_000, 16_000_000, 25_000_000, 4_000_000, 9_000_000] {
        image.crystal_hz = crystal_hz;
        stays(&image, Fault::DriveCrystal);
    }
    // That of a bad piece is not.
    image.crystal_hz = 7_998_000;
    assert_eq!(started(&image).1, 0);
}

/// An image whose start ends in a fault that cannot be cleared.
fn stays(image: &Image, fault: Fault) {
    let (mut host, found) = started(image);
    let code = fault.code();
    assert_eq!(found, code);
    assert_eq!(host.try_to_arm(), Err(Refusal::Faulted { code }));
    let refused: Result<Answer, _> = Err(Refusal::Drive(DriveRefusal::Faulted { code }));
    assert_eq!(host.ask(Operation::ClearFault), refused);
    assert!(!host.board.is_driven());
}
