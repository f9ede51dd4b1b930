//! The reader of the encoder, for any counts with any ticks missed:
//!
//! - steps and estimate are finite, and each step begins with the velocity
//!   that the last one ended with;
//! - a count shifted by any offset changes no bit: the counter may wrap;
//! - the steps add up to the counts: no angle is lost where ticks are missed.

use crate::bytes::Bytes;
use crepitus_model::Real;
use crepitus_model::control::encoder::{EncoderReader, EncoderSettings};
use crepitus_model::joint::LONGEST_STEP_S;
use crepitus_model::parameters::Tabled;

/// Checks the laws.
///
/// # Panics
/// If one is broken.
pub fn body(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    if bytes.byte().is_multiple_of(2) {
        run::<f32>(bytes);
    } else {
        run::<f64>(bytes);
    }
}

fn run<F: Real>(mut bytes: Bytes<'_>) {
    let mut settings = EncoderSettings::default();
    for (spec, value) in EncoderSettings::TABLE.iter().zip(settings.values_mut()) {
        *value = bytes.between(spec.min, spec.max);
    }
    let step_s = bytes.between(1e-9, LONGEST_STEP_S);
    let omega = F::from_f64(50.0 * bytes.signed());
    let offset = bytes.i32();
    let mut count = bytes.i32();
    let reader = |count| {
        EncoderReader::<F>::new(&settings, step_s, count, omega).expect("settings in range")
    };
    let (mut plain, mut shifted) = (reader(count), reader(count.wrapping_add(offset)));
    let rad_per_count = F::from_f64(settings.rad_per_count());
    let mut last = omega;
    while !bytes.is_empty() {
        let tag = bytes.byte();
        let next = match tag % 4 {
            0 => {
                plain.miss();
                shifted.miss();
                continue;
            }
            1 => bytes.i32(),
            // A step of the counter, small or as large as its tag.
            2 => count.wrapping_add(i32::from(bytes.byte().cast_signed())),
            _ => count.wrapping_add(i32::from(tag.cast_signed()) << 24),
        };
        let step = plain.read(next);
        assert_eq!(
            step,
            shifted.read(next.wrapping_add(offset)),
            "an offset of {offset} counts is seen"
        );
        assert_eq!(step.omega_start_rad_s, last, "a gap between two steps");
        assert!(step.omega_end_rad_s.is_finite(), "{step:?}");
        let turned = F::from_count(next.wrapping_sub(count)) * rad_per_count;
        assert_eq!(step.delta_phi_rad, turned, "an angle is lost");
        (count, last) = (next, step.omega_end_rad_s);
    }
}
