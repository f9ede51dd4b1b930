//! Vibration threshold of a hand.
//!
//! The threshold of vibration for a grasped cylinder is a U over frequency with its
//! minimum at 150 to 200 Hz (Brisben et al. 1999: below 0.01 µm in the most sensitive
//! people). The level here is that of ordinary ones, 0.03 µm from 160 to 200 Hz; below, the
//! displacement grows by 12 dB an octave (Gescheider and Verrillo), which is one
//! acceleration; above, it is taken to grow as fast (an estimate). All of it is for a
//! hand at rest, and known to ±10 dB.

use std::f64::consts::{SQRT_2, TAU};

/// Least displacement that is felt, m peak.
const DISPLACEMENT_M: f64 = 0.03e-6;

/// Frequency range with this least displacement, Hz.
const MINIMUM_HZ: (f64, f64) = (160.0, 200.0);

/// The acceleration that is just felt at this frequency, m/s² rms.
pub fn threshold_m_s2(hz: f64) -> f64 {
    let (low, high) = MINIMUM_HZ;
    let displacement_m = if hz < low {
        DISPLACEMENT_M * (low / hz) * (low / hz)
    } else if hz > high {
        DISPLACEMENT_M * (hz / high) * (hz / high)
    } else {
        DISPLACEMENT_M
    };
    let omega = TAU * hz;
    displacement_m * omega * omega / SQRT_2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn below_the_minimum_it_is_one_acceleration_and_above_it_rises() {
        assert!((threshold_m_s2(160.0) - 0.02144).abs() < 1e-4);
        assert!((threshold_m_s2(20.0) / threshold_m_s2(160.0) - 1.0).abs() < 1e-12);
        assert!((threshold_m_s2(400.0) / threshold_m_s2(200.0) - 16.0).abs() < 1e-9);
    }
}
