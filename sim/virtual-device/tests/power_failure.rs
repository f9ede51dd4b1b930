//! Stored parameters over a failure of power at every moment of a save and of an
//! erasure, on flash that remembers how far it had come.

use crepitus_device::parameter_log::{ParameterLog, RECORD_BYTES, RECORDS_PER_SECTOR};
use crepitus_protocol::{Revision, Values};
use crepitus_virtual_device::nor_flash::{ERASE_STEPS, NorFlash, WRITE_STEPS};

/// Moments of an erasure and of the seal.
const MOMENTS: u32 = ERASE_STEPS + 8 * WRITE_STEPS;

/// Starts after a failure. Marginal cells change at each.
const STARTS: u32 = 3;

fn values(n: u32) -> Values {
    let mut values = Values::default();
    values.set(4, f64::from(n));
    values
}

fn restarted(log: &ParameterLog<NorFlash>) -> ParameterLog<NorFlash> {
    let mut flash = log.sectors().clone();
    flash.restart();
    ParameterLog::open(flash)
}

/// A log with this many records, saved one after the other over many starts.
fn log_of(records: u32) -> ParameterLog<NorFlash> {
    let mut log = ParameterLog::open(NorFlash::default());
    for n in 1..=records {
        log = restarted(&log);
        assert!(log.store(Revision(n), &values(n)), "{n}");
    }
    log
}

/// Newest record of a log after power came back: always the same, and the log can be saved to.
fn kept(log: &ParameterLog<NorFlash>) -> u32 {
    fills_up(log);
    let mut log = restarted(log);
    let (newest, _) = log.newest().expect("one of them");
    for _ in 0..STARTS {
        log = restarted(&log);
        assert_eq!(log.newest(), Some((newest, values(newest.0))));
    }
    for n in 1_000..1_000 + STARTS {
        assert!(
            log.store(Revision(n), &values(n)),
            "a save after the failure"
        );
        log = restarted(&log);
        assert_eq!(log.newest(), Some((Revision(n), values(n))));
    }
    newest.0
}

/// Saves at the first start after a failure, as many as there is room for: each
/// lasts, also where a sector only seemed to be erased.
fn fills_up(log: &ParameterLog<NorFlash>) {
    let mut log = restarted(log);
    let saves = (1_000..1_100).take_while(|n| log.store(Revision(*n), &values(*n)));
    let last = 999 + u32::try_from(saves.count()).expect("a few");
    let most = u32::try_from(RECORDS_PER_SECTOR).expect("some");
    assert!(
        last + 2 > 999 + most,
        "there is room in the other sector: {last}"
    );
    for _ in 0..STARTS {
        log = restarted(&log);
        assert_eq!(log.newest(), Some((Revision(last), values(last))));
    }
}

/// Records after which the next one goes to a new place each: the same sector, the
/// last of it, the first of the other one, which was erased for it.
fn places() -> [u32; 4] {
    let last = u32::try_from(RECORDS_PER_SECTOR).expect("some");
    [1, last - 1, last, last + 1]
}

#[test]
fn a_failure_at_any_moment_of_a_save_leaves_the_old_or_the_new() {
    let moments = u32::try_from(RECORD_BYTES).expect("some") * WRITE_STEPS;
    for before in places() {
        let whole = log_of(before);
        let mut seen = [false; 2];
        for moment in (0..=moments + 1).step_by(3) {
            let mut flash = whole.sectors().clone();
            flash.restart();
            flash.fail_after(moment);
            let mut log = ParameterLog::open(flash);
            let is_stored = log.store(Revision(99), &values(99));
            let kept = kept(&log);
            assert!(kept == before || kept == 99, "{before}, {moment}: {kept}");
            assert!(
                !is_stored || kept == 99,
                "{before}, {moment}: it was stored"
            );
            seen[usize::from(is_stored)] = true;
        }
        assert!(seen[0], "no failure came in time");
    }
}

#[test]
fn a_failure_at_any_moment_of_an_erasure_loses_nothing() {
    let last = u32::try_from(RECORDS_PER_SECTOR).expect("some");
    // The start after the first record of the second sector erases the first.
    let whole = log_of(last + 1);
    let mut cuts = 0;
    // The erasure, and the seal.
    for moment in 0..=MOMENTS + 1 {
        let mut flash = whole.sectors().clone();
        flash.fail_after(moment);
        let log = ParameterLog::open(flash);
        cuts += u32::from(log.sectors().is_off());
        assert_eq!(kept(&log), last + 1, "{moment}");
    }
    assert!(cuts >= ERASE_STEPS, "{cuts}");
}

#[test]
fn failures_one_after_the_other_lose_nothing_either() {
    let last = u32::try_from(RECORDS_PER_SECTOR).expect("some");
    let whole = log_of(last + 1);
    for first in (0..MOMENTS).step_by(7) {
        let mut flash = whole.sectors().clone();
        for n in 0..5 {
            flash.restart();
            flash.fail_after(first + 11 * n);
            flash = ParameterLog::open(flash).sectors().clone();
        }
        assert_eq!(kept(&ParameterLog::open(flash)), last + 1, "{first}");
    }
}
