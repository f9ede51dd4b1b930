//! Messages made of bytes, mostly plausible.

use crate::bytes::Bytes;
use crepitus_protocol::Values;
use crepitus_protocol::management::Action;
use crepitus_protocol::parameters::{Kind, PARAMETERS};

/// A tick that is about now: mostly now, or a little earlier.
pub(crate) fn near(bytes: &mut Bytes<'_>, now: u64) -> u64 {
    match bytes.byte() {
        0..=127 => now,
        back @ 128..=223 => now.saturating_sub(u64::from(back - 128) * 8),
        ahead @ 224..=239 => now.saturating_add(u64::from(ahead - 223)),
        240..=247 => u64::MAX - u64::from(bytes.byte()),
        _ => u64::from(bytes.u16()),
    }
}

/// Values of which some are not the defaults, mostly allowed.
pub(crate) fn values(bytes: &mut Bytes<'_>) -> Values {
    let mut values = Values::default();
    for _ in 0..bytes.byte() % 4 {
        let parameter = &PARAMETERS[usize::from(bytes.byte()) % PARAMETERS.len()];
        let how = bytes.byte();
        let value = match parameter.kind {
            _ if how >= 240 => bytes.double(),
            Kind::Choice(_) => f64::from(how % 3),
            // Near the default, since most values go with some others only.
            Kind::Number(spec) if how < 120 => spec.default * f64::from(how) / 60.0,
            Kind::Number(spec) => bytes.between(spec.min, spec.max),
        };
        values.set(parameter.id, value);
    }
    values
}

/// A question of the lane that never changes.
pub(crate) fn action(bytes: &mut Bytes<'_>) -> Action {
    bytes.choice(&[Action::Hello, Action::Stop, Action::Reboot])
}
