//! Registers of the endpoints.

use super::ENDPOINTS;

const MPSIZ: u32 = 0x7ff;
const USBAEP: u32 = 1 << 15;
const NAKSTS: u32 = 1 << 17;
const STALL: u32 = 1 << 21;
const CNAK: u32 = 1 << 26;
const SNAK: u32 = 1 << 27;
const EPDIS: u32 = 1 << 30;
const EPENA: u32 = 1 << 31;
/// Bits that are kept of a write: size, activity, type, stall, FIFO.
const STORED: u32 = MPSIZ | USBAEP | 3 << 18 | 1 << 20 | STALL | 15 << 22;

/// DIEPINT, DOEPINT.
pub(super) const XFRC: u32 = 1;
const EPDISD: u32 = 1 << 1;
pub(super) const STUP: u32 = 1 << 3;
/// TXFE: the transmit FIFO is empty.
pub(super) const EMPTY: u32 = 1 << 7;

/// An endpoint of one direction.
#[derive(Debug, Default)]
pub(super) struct Endpoint {
    is_first: bool,
    control: u32,
    pub(super) interrupts: u32,
    size: u32,
}

/// All of them.
#[derive(Debug)]
pub(super) struct Endpoints {
    /// IN.
    pub(super) into_host: [Endpoint; ENDPOINTS],
    /// OUT.
    pub(super) from_host: [Endpoint; ENDPOINTS],
}

impl Default for Endpoints {
    fn default() -> Self {
        let all = || {
            std::array::from_fn(|n| Endpoint {
                is_first: n == 0,
                ..Endpoint::default()
            })
        };
        Self {
            into_host: all(),
            from_host: all(),
        }
    }
}

impl Endpoint {
    pub(super) fn read(&self, register: u32) -> u32 {
        match register {
            // The first one is always active.
            0x00 if self.is_first => self.control | USBAEP,
            0x00 => self.control,
            0x08 => self.interrupts,
            0x10 => self.size,
            _ => 0,
        }
    }

    pub(super) fn write(&mut self, register: u32, value: u32) {
        match register {
            0x00 => {
                self.control = self.control & (EPENA | NAKSTS) | value & STORED;
                if value & CNAK != 0 {
                    self.control &= !NAKSTS;
                }
                if value & SNAK != 0 {
                    self.control |= NAKSTS;
                }
                if value & EPENA != 0 {
                    self.control |= EPENA;
                }
                if value & EPDIS != 0 {
                    self.control &= !EPENA;
                    self.interrupts |= EPDISD;
                }
            }
            0x08 => self.interrupts &= !value,
            0x10 => self.size = value,
            _ => {}
        }
    }

    /// The transmit FIFO that it uses.
    pub(super) fn fifo(&self) -> usize {
        (self.control >> 22 & 15) as usize
    }

    pub(super) fn is_active(&self) -> bool {
        self.is_first || self.control & USBAEP != 0
    }

    pub(super) fn is_stalled(&self) -> bool {
        self.control & STALL != 0
    }

    /// Returns whether the program has it enabled, and wants no NAK.
    pub(super) fn is_ready(&self) -> bool {
        self.control & (EPENA | NAKSTS) == EPENA
    }

    /// Bytes of its largest packet.
    fn largest(&self) -> u32 {
        match self.control & MPSIZ {
            code if self.is_first => 64 >> (code & 3),
            bytes => bytes,
        }
    }

    /// Packets left of the transfer.
    fn packets(&self) -> u32 {
        self.size >> 19 & if self.is_first { 3 } else { 0x3ff }
    }

    /// Bytes left of it.
    fn bytes(&self) -> u32 {
        self.size & if self.is_first { 0x7f } else { 0x7_ffff }
    }

    /// Bytes of the next packet to the host.
    pub(super) fn next_packet(&self) -> usize {
        self.bytes().min(self.largest()) as usize
    }

    /// A packet has gone; returns whether the transfer is complete.
    ///
    /// The usual driver never programs the size of a transfer from the host,
    /// and each of its packets completes one.
    pub(super) fn packet_done(&mut self, bytes: usize) -> bool {
        let bytes = u32::try_from(bytes).unwrap_or(u32::MAX);
        let is_short = bytes < self.largest();
        let packets = self.packets().saturating_sub(1);
        self.size = packets << 19 | self.bytes().saturating_sub(bytes);
        let is_complete = packets == 0 || is_short;
        if is_complete {
            self.control = self.control & !EPENA | NAKSTS;
            self.interrupts |= XFRC;
        }
        is_complete
    }

    /// A SETUP packet has come, which ends a stall and whatever went on.
    pub(super) fn begin_request(&mut self) {
        self.control = self.control & !STALL | NAKSTS;
    }

    /// The bus was reset: nothing is sent or received until the program asks for it.
    pub(super) fn bus_reset(&mut self) {
        self.control = self.control & !STALL | NAKSTS;
    }
}
