//! A second implementation of the flash interface: cycle by cycle, and with
//! caches that are lists in the order of use. Shares nothing with the first.

use crepitus_emulator::flash_interface::Kind;

/// Activity of the array.
#[derive(Clone, Copy, Debug)]
struct Job {
    /// The line that is read ahead and still wanted.
    ahead: Option<u32>,
    cycles_left: u64,
}

/// Lines in the order of use, the oldest first.
#[derive(Debug)]
struct Lines {
    lines: Vec<u32>,
    most: usize,
}

impl Lines {
    fn new(most: usize) -> Self {
        let lines = Vec::new();
        Self { lines, most }
    }

    /// Returns whether it is there; it is the youngest then.
    fn find(&mut self, line: u32) -> bool {
        let Some(place) = self.lines.iter().position(|known| *known == line) else {
            return false;
        };
        let line = self.lines.remove(place);
        self.lines.push(line);
        true
    }

    fn add(&mut self, line: u32) {
        if self.lines.len() == self.most {
            self.lines.remove(0);
        }
        self.lines.push(line);
    }
}

#[derive(Debug)]
pub(crate) struct ReferenceFlash {
    latency: u64,
    prefetches: bool,
    instructions: Option<Lines>,
    data: Option<Lines>,
    now: u64,
    job: Option<Job>,
    /// A line to be read ahead, and the cycle from which on.
    next: Option<(u32, u64)>,
    /// The line that was read ahead.
    ahead: Option<u32>,
    current: Option<u32>,
}

impl ReferenceFlash {
    /// Returns an interface with empty caches, as `FLASH_ACR` says.
    pub(crate) fn new(register: u32) -> Self {
        let has = |bit: u32| register >> bit & 1 == 1;
        Self {
            latency: u64::from(register & 7),
            prefetches: has(8),
            instructions: has(9).then(|| Lines::new(64)),
            data: has(10).then(|| Lines::new(8)),
            now: 0,
            job: None,
            next: None,
            ahead: None,
            current: None,
        }
    }

    /// A cycle of the array.
    fn cycle(&mut self) {
        if self.job.is_none()
            && let Some((line, _)) = self.next.take_if(|(_, earliest)| *earliest <= self.now)
        {
            let cycles_left = self.latency + 1;
            self.job = Some(Job {
                ahead: Some(line),
                cycles_left,
            });
        }
        if let Some(job) = &mut self.job {
            job.cycles_left -= 1;
            if job.cycles_left == 0 {
                self.ahead = job.ahead.or(self.ahead);
                self.job = None;
            }
        }
        self.now += 1;
    }

    /// A cycle in which the core waits.
    fn wait(&mut self, waits: &mut u64) {
        self.cycle();
        *waits += 1;
    }

    /// The core waits for a line of the array.
    fn fetch(&mut self, waits: &mut u64) {
        while self.job.is_some() {
            self.wait(waits);
        }
        let cycles_left = self.latency + 1;
        self.job = Some(Job {
            ahead: None,
            cycles_left,
        });
        for _ in 0..self.latency {
            self.wait(waits);
        }
    }

    /// A read in a cycle that is not before the end of the last one.
    pub(crate) fn read(&mut self, kind: Kind, offset: u32, at: u64) -> u64 {
        while self.now < at {
            self.cycle();
        }
        let line = offset >> 4;
        let mut waits = 0;
        if kind == Kind::Data {
            if !self.data.as_mut().is_some_and(|lines| lines.find(line)) {
                let held = self.next.take();
                self.fetch(&mut waits);
                self.next = held;
                if let Some(lines) = &mut self.data {
                    lines.add(line);
                }
            }
            return waits;
        }
        if self.current == Some(line) {
            return 0;
        }
        self.next = None;
        let is_coming = self.job.is_some_and(|job| job.ahead == Some(line));
        if is_coming {
            let mut is_late = false;
            while self.job.is_some_and(|job| job.cycles_left > 1) {
                self.wait(&mut waits);
                is_late = true;
            }
            if let Some(lines) = self.instructions.as_mut().filter(|_| is_late) {
                lines.add(line);
            }
        }
        let is_there = self.ahead.take() == Some(line);
        if let Some(job) = &mut self.job {
            job.ahead = None;
        }
        if !is_coming && !is_there {
            let is_cached = self
                .instructions
                .as_mut()
                .is_some_and(|lines| lines.find(line));
            if !is_cached {
                self.fetch(&mut waits);
                if let Some(lines) = &mut self.instructions {
                    lines.add(line);
                }
            }
        }
        self.current = Some(line);
        let lines = self.instructions.as_ref().map(|lines| &lines.lines);
        if self.prefetches && !lines.is_some_and(|lines| lines.contains(&(line + 1))) {
            self.next = Some((line + 1, self.now + 1));
        }
        waits
    }
}
