//! A host's end of the connection.

use super::{Shared, ms};
use crepitus_client::{Transport, TransportError};
use std::time::Duration;

/// One of the hosts of a device. Time goes by while it waits.
#[derive(Debug)]
pub struct Port {
    device: Shared,
    host: usize,
    is_open: bool,
    /// Number of bytes that a slow computer receives in a millisecond, which goes by meanwhile.
    pub bytes_per_ms: Option<usize>,
}

impl Port {
    pub fn new(device: &Shared) -> Self {
        Self {
            device: device.clone(),
            host: device.borrow_mut().add_host(),
            is_open: true,
            bytes_per_ms: None,
        }
    }

    fn lost(&mut self) -> TransportError {
        self.is_open = false;
        TransportError::Lost {
            port: self.name(),
            detail: "no such device".into(),
        }
    }

    fn is_there(&self) -> bool {
        self.is_open && self.device.borrow().is_plugged
    }
}

impl Transport for Port {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        if !self.is_there() {
            return Err(self.lost());
        }
        self.device.borrow_mut().hear(bytes);
        Ok(())
    }

    fn receive(&mut self, buffer: &mut [u8], patience: Duration) -> Result<usize, TransportError> {
        let end = self.now() + patience;
        loop {
            if !self.is_there() {
                return Err(self.lost());
            }
            let mut device = self.device.borrow_mut();
            let waiting = device.waiting(self.host);
            let count = waiting.len().min(buffer.len());
            if count > 0 {
                for (place, byte) in buffer.iter_mut().zip(waiting.drain(..count)) {
                    *place = byte;
                }
                for _ in 0..self.bytes_per_ms.map_or(0, |in_a_ms| count / in_a_ms) {
                    device.millisecond();
                }
                return Ok(count);
            }
            if ms(device.now_ms()) >= end {
                return Ok(0);
            }
            device.millisecond();
        }
    }

    fn now(&self) -> Duration {
        ms(self.device.borrow().now_ms())
    }

    fn wait(&mut self, time: Duration) {
        let end = self.now() + time;
        while self.now() < end {
            self.device.borrow_mut().millisecond();
        }
    }

    fn reopen(&mut self) -> Result<(), TransportError> {
        self.is_open = self.device.borrow().is_plugged;
        if self.is_open {
            self.device.borrow_mut().waiting(self.host).clear();
            Ok(())
        } else {
            Err(TransportError::NotFound { port: self.name() })
        }
    }

    fn name(&self) -> String {
        "bench".into()
    }
}
