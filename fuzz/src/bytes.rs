//! Bytes read one after the other as numbers. After the last byte there are
//! only zeros, so every input means something.

/// The rest of an input.
pub(crate) struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    pub(crate) fn new(data: &'a [u8]) -> Self {
        Self(data)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut taken = [0; N];
        let (now, rest) = self.0.split_at(N.min(self.0.len()));
        taken[..now.len()].copy_from_slice(now);
        self.0 = rest;
        taken
    }

    pub(crate) fn byte(&mut self) -> u8 {
        let [byte] = self.take();
        byte
    }

    /// All that is left.
    pub(crate) fn rest(&mut self) -> &'a [u8] {
        core::mem::take(&mut self.0)
    }

    /// The next `count`, or as many as there are.
    pub(crate) fn take_some(&mut self, count: usize) -> &'a [u8] {
        let (now, rest) = self.0.split_at(count.min(self.0.len()));
        self.0 = rest;
        now
    }

    pub(crate) fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }

    /// Any bit pattern of single precision.
    pub(crate) fn f32(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }

    pub(crate) fn i32(&mut self) -> i32 {
        i32::from_le_bytes(self.take())
    }

    /// Any bit pattern of single precision.
    pub(crate) fn single(&mut self) -> f64 {
        f64::from(self.f32())
    }

    /// Any bit pattern of double precision.
    pub(crate) fn double(&mut self) -> f64 {
        f64::from_le_bytes(self.take())
    }

    /// One of `choices`.
    pub(crate) fn choice<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[usize::from(self.byte()) % choices.len()]
    }

    /// Returns a number from −1 to 1.
    pub(crate) fn signed(&mut self) -> f64 {
        f64::from(i16::from_le_bytes(self.take())) / 32768.0
    }

    /// Returns a number from 0 to 1, both included.
    pub(crate) fn part(&mut self) -> f64 {
        f64::from(self.byte()) / 255.0
    }

    /// Returns a number from `min` to `max`, both to the bit, and in between by even factors.
    /// Where `min` is 0 the factors begin at `max`·1e−15.
    pub(crate) fn between(&mut self, min: f64, max: f64) -> f64 {
        match u16::from_le_bytes(self.take()) {
            0 => min,
            u16::MAX => max,
            n => {
                let low = if min > 0.0 { min } else { max * 1e-15 };
                let part = f64::from(n) / f64::from(u16::MAX);
                (low * (max / low).powf(part)).clamp(min, max)
            }
        }
    }
}
