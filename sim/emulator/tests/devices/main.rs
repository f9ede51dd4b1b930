//! Devices of the chip by themselves: the test is the program, and writes their
//! registers as one would.

mod bench;
mod dma;
mod flash;
mod otg;
mod usart;
