//! Cycles that the core waits for a register, besides the two of a load or a
//! store.
//!
//! From the transfer times of AN4031 rev 3, table 4, in cycles of the core; `p`
//! is the period of the peripheral's bus in such cycles.
//!
//! | | AHB1, AHB2 | APB | why |
//! |---|---|---|---|
//! | arbitration in the bus matrix | 1 | 1 | each time, as if another master had used it last |
//! | synchronisation with the bus | | p − 1, at least 1 | until its next edge, at worst |
//! | transfer | 1 | 2 p | setup and access phase |
//! | data phase | −1 | −1 | the load or store counts it |
//! | waits | 1 | 3 p − 1: at 84 MHz 5, at 42 MHz 11 | |
//!
//! A store waits like a load, as if the write buffer was always full.

use super::bus_map::{AHB, APB2};
use super::clocks::{Clock, Rates};

const ARBITRATION: u64 = 1;
const DATA_PHASE: u64 = 1;

/// Waits of an access to a register of a peripheral.
pub(crate) fn waits(address: u32, rates: &Rates) -> u64 {
    let clock = match address {
        AHB.. => return ARBITRATION,
        APB2.. => Clock::Apb2,
        _ => Clock::Apb1,
    };
    let period = rates.units(clock) / rates.units(Clock::Core);
    let synchronisation = period.saturating_sub(1).max(1);
    ARBITRATION + synchronisation + 2 * period - DATA_PHASE
}
