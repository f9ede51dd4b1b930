//! Power fails while comms writes its flash: the parameters are those of before
//! or the new ones, and can be saved again.

use crate::host::{Host, boards, client, connected, images, leg, run};
use crepitus_device::parameter_log::{
    ParameterLog, RECORDS_PER_SECTOR, SECTOR_BYTES, SLOT_BYTES, Sectors as _,
};
use crepitus_emulator::Pair;
use crepitus_emulator::image::FLASH;
use crepitus_emulator::pair::{Boards, PARAMETERS};
use crepitus_protocol::parameters::id::STATIC_TORQUE;
use crepitus_protocol::{Revision, Values};
use crepitus_virtual_device::nor_flash::NorFlash;
use std::ops::Range;
use std::time::Duration;

const FLASH_SR: u32 = 0x4002_3c0c;
const BUSY: u32 = 1 << 16;

/// Shares of an operation after which power fails.
const CUTS: [f64; 5] = [0.02, 0.25, 0.5, 0.75, 0.98];

const OLD: f64 = 0.4375;
const NEW: f64 = 0.625;

fn is_busy(boards: &Boards) -> bool {
    let status = boards.comms().mcu().peek(FLASH_SR);
    status.expect("a register") & BUSY != 0
}

/// Bytes of the log that are programmed.
fn programmed(boards: &Boards, places: Range<usize>) -> usize {
    let begin = FLASH + u32::try_from(PARAMETERS + places.start).expect("in flash");
    let words = (begin..).step_by(4).take(places.len() / 4);
    words
        .flat_map(|at| {
            let word = boards.comms().mcu().peek(at).expect("flash");
            word.to_le_bytes()
        })
        .filter(|byte| *byte != 0xff)
        .count()
}

/// The place of the record after `n` others.
fn slot(n: usize) -> Range<usize> {
    (n + 1) * SLOT_BYTES..(n + 2) * SLOT_BYTES
}

/// Two records: the scene's, and one with another value.
fn with_two_records() -> Option<Host> {
    let mut host = connected()?;
    host.set(&[(STATIC_TORQUE, OLD)]).expect("a commit");
    host.save().expect("saved");
    host.set(&[(STATIC_TORQUE, NEW)]).expect("a commit");
    Some(host)
}

#[test]
fn power_fails_at_five_points_of_a_save() {
    let Some(mut host) = with_two_records() else {
        return;
    };
    host.save().expect("saved");
    let whole = programmed(boards(&mut host), slot(2));
    println!("{whole} bytes of a record are not 0xff");
    let mut cut_bytes = 0;
    for (cut, is_within) in CUTS.into_iter().zip([true, false].into_iter().cycle()) {
        let Some(mut host) = with_two_records() else {
            return;
        };
        #[expect(clippy::cast_precision_loss, reason = "a few hundred")]
        let reached = move |bytes: usize| bytes as f64 >= cut * whole as f64;
        let was_busy = std::rc::Rc::new(std::cell::Cell::new(false));
        let busy = was_busy.clone();
        host.transport_mut().power_fails = Some(Box::new(move |boards| {
            busy.set(is_busy(boards));
            // Every other time within a byte for certain.
            reached(programmed(boards, slot(2))) && (busy.get() || !is_within)
        }));
        assert!(host.save().is_err(), "{cut}: the connection is lost");
        cut_bytes += u32::from(was_busy.get());
        host.reconnect(Duration::from_secs(2))
            .expect("a connection");
        run(&mut host, 20);
        let (_, values) = host.parameters().expect("parameters");
        assert_eq!(values.get(STATIC_TORQUE), Some(OLD), "{cut}");
        let revision = host.set(&[(STATIC_TORQUE, NEW)]).expect("a commit");
        host.save().expect("saved after the failure");
        host.transport_mut().pair.power_cycle();
        host.reconnect(Duration::from_secs(2))
            .expect("a connection");
        let status = host.status().expect("a status");
        assert_eq!(status.saved, Some(revision), "{cut}");
    }
    println!("in the middle of a byte: {cut_bytes} of {}", CUTS.len());
    assert!(cut_bytes >= 3);
}

/// A log whose next start erases the first sector.
fn with_a_full_sector() -> Option<Pair> {
    let [drive, mut comms] = images()?;
    let mut log = ParameterLog::open(NorFlash::default());
    for n in 0..=RECORDS_PER_SECTOR {
        let mut values = Values::default();
        values.set(STATIC_TORQUE, OLD);
        let revision = Revision(u32::try_from(n).expect("a few"));
        assert!(log.store(revision, &values));
    }
    comms.put(PARAMETERS, log.sectors().bytes());
    let mut pair = Pair::new(&drive, &comms, leg());
    // The drive need not run.
    pair.boards_mut().mcu_mut().set_hung(true);
    Some(pair)
}

#[test]
fn power_fails_at_five_points_of_an_erasure() {
    const ERASE_TICKS: f64 = 8_000.0;
    for cut in CUTS {
        let Some(mut pair) = with_a_full_sector() else {
            return;
        };
        let began = (0..2_000).any(|_| {
            pair.tick();
            is_busy(pair.boards())
        });
        assert!(began, "the sector is erased at the start");
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share"
        )]
        for _ in 0..(cut * ERASE_TICKS) as u64 {
            pair.tick();
        }
        assert!(is_busy(pair.boards()), "{cut}");
        pair.power_cycle();
        pair.boards_mut().mcu_mut().set_hung(true);
        let left = programmed(pair.boards(), 0..SECTOR_BYTES);
        println!("{cut}: {left} bytes are not erased");
        let mut host = client(pair);
        let (revision, values) = host.parameters().expect("parameters");
        let newest = Revision(u32::try_from(RECORDS_PER_SECTOR).expect("a few"));
        assert_eq!((revision, values.get(STATIC_TORQUE)), (newest, Some(OLD)));
        // Erased once more, whatever it read as, and sealed.
        assert!(host.now() > Duration::from_millis(400), "{cut}");
        assert!(programmed(boards(&mut host), 0..SECTOR_BYTES) < 10);
        host.save().expect("saved");
    }
}
