//! The configuration registers of the images are those of docs/generated/registers.md.

use crate::host::image;
use crate::register_tables::tables;
use crepitus_emulator::firmware::{Program, image_for_test};
use crepitus_emulator::{Image, Stm32f405, Time};
use crepitus_virtual_device::usb::host::CdcHost;
use std::fmt::Write as _;
use std::path::Path;

const BLESS: &str =
    "CREPITUS_BLESS=1 cargo test -p crepitus-emulator --test drive_image registers::";

/// Time after which `init` is over; that of comms begins with two erasures.
const STARTED: Time = Time::from_us(50_000);
const COMMS_STARTED: Time = Time::from_us(900_000);

const HEAD: &str = "\
# Registers

What the two images write into the chip's configuration registers, read from the emulator after they have started:
modelled silicon, not measured on hardware. Made and checked by

```text
CREPITUS_BLESS=1 cargo test -p crepitus-emulator --test drive_image registers::
```

Only configuration is shown, no counters, flags and addresses that a build moves. A register that is not shown has its
value after a reset, and so have the fields that are not named. Names are those of RM0090 and PM0214.

";

/// A chip without a board around it, so that the registers show whatever a
/// board says.
fn started(image: &Image, after: Time) -> Stm32f405 {
    let mut mcu = Stm32f405::new(image);
    mcu.run_until(after);
    assert!(!mcu.is_locked_up());
    mcu
}

/// Comms, enumerated by a host.
fn enumerated(image: &Image) -> Stm32f405 {
    let mut mcu = started(image, COMMS_STARTED);
    mcu.plug_in();
    let mut turn = |mcu: &mut Stm32f405| mcu.run_until(mcu.now() + Time::from_us(50));
    CdcHost::enumerate(&mut mcu, &mut turn).expect("a device");
    mcu
}

/// Neither a part whose clock is off, nor an address where nothing is.
fn tables_of(mcu: &Stm32f405) -> String {
    assert_eq!(mcu.not_modelled(), Vec::<String>::new());
    tables(mcu)
}

#[test]
fn the_registers_are_those_of_the_page() {
    let Some(image) = image() else { return };
    let Some(comms) = image_for_test(Program::Comms) else {
        return;
    };
    let mut page = HEAD.to_owned();
    // Writing to a String cannot fail.
    let _ = writeln!(page, "## Drive\n\n{}", tables_of(&started(&image, STARTED)));
    let _ = write!(
        page,
        "## Comms\n\nWith a host that has enumerated it.\n\n{}",
        tables_of(&enumerated(&comms))
    );
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/generated/registers.md");
    if std::env::var_os("CREPITUS_BLESS").is_some_and(|value| value != "0") {
        std::fs::write(&path, &page).expect("the page can be written");
        return;
    }
    let known = std::fs::read_to_string(&path).expect("the page is there");
    let differ = |ours: &str, theirs: &str, sign: &str| {
        let lines = ours
            .lines()
            .filter(|line| !theirs.lines().any(|other| other == *line));
        lines.fold(String::new(), |all, line| all + sign + line + "\n")
    };
    let changes = differ(&known, &page, "- ") + &differ(&page, &known, "+ ");
    assert_eq!(
        known, page,
        "docs/generated/registers.md differs:\n{changes}{BLESS}"
    );
}
