//! Integrals over whole steps of a stick on a curved motion, and where its speed turns.

use crepitus_plant::piece::{Curve, Piece};

/// Nodes and weights of Gauss's rule on [−1, 1]: exact for the square of a polynomial piece.
const NODES: [(f64, f64); 6] = [
    (-0.932_469_514_203_152, 0.171_324_492_379_170_36),
    (-0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (-0.238_619_186_083_196_9, 0.467_913_934_572_691_04),
    (0.238_619_186_083_196_9, 0.467_913_934_572_691_04),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152, 0.171_324_492_379_170_36),
];

/// Panels in a period of a sine.
const PANELS_PER_PERIOD: f64 = 16.0;

/// Stretches of a period of a sine in which a zero is looked for, and the least and the most of all.
const STRETCHES: [f64; 3] = [8.0, 4.0, 1e6];

/// Stretches of a polynomial piece in which a zero is looked for.
const POLYNOMIAL_STRETCHES: f64 = 16.0;

/// Integrals over a time of the spring's torque.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Integrals {
    /// ∫T dt, N·m·s.
    pub(super) torque: f64,
    /// ∫T² dt, N²·m²·s.
    pub(super) square: f64,
    /// ∫Ω² dt, rad²/s.
    pub(super) omega_squared: f64,
    /// ∫Ω̇·T dt, N·m·rad/s.
    pub(super) acceleration_torque: f64,
}

/// Integrals between two times of a piece of T = kr·(offset + φ).
pub(super) fn integrals(
    piece: &Piece,
    (from_s, to_s): (f64, f64),
    (stiffness, offset_rad): (f64, f64),
) -> Integrals {
    let panels = match piece.curve {
        Curve::Polynomial(_) => 1.0,
        Curve::Sine { frequency_hz, .. } => ((to_s - from_s) * frequency_hz * PANELS_PER_PERIOD)
            .ceil()
            .max(1.0),
    };
    let half_s = (to_s - from_s) / panels / 2.0;
    let mut sum = Integrals::default();
    let mut panel = 0.0;
    while panel < panels {
        let middle_s = from_s + (2.0 * panel + 1.0) * half_s;
        for (at, weight) in NODES {
            let shaft = piece.at(middle_s + at * half_s);
            let weight = weight * half_s;
            let torque_nm = stiffness * (offset_rad + shaft.phi_rad);
            sum.torque += weight * torque_nm;
            sum.square += weight * torque_nm * torque_nm;
            sum.omega_squared += weight * shaft.omega_rad_s * shaft.omega_rad_s;
            sum.acceleration_torque += weight * shaft.omega_dot * torque_nm;
        }
        panel += 1.0;
    }
    sum
}

/// Times between two at which a function of the motion changes its sign, to less than a millionth of the
/// time between.
pub(super) fn zeros(
    piece: &Piece,
    (from_s, to_s): (f64, f64),
    value: impl Fn(f64) -> f64,
) -> impl Iterator<Item = f64> {
    let stretches = match piece.curve {
        Curve::Polynomial(_) => POLYNOMIAL_STRETCHES,
        Curve::Sine { frequency_hz, .. } => {
            let [per_period, least, most] = STRETCHES;
            (per_period * frequency_hz * (to_s - from_s))
                .ceil()
                .clamp(least, most)
        }
    };
    let length_s = (to_s - from_s) / stretches;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at most a million"
    )]
    let count = stretches as u32;
    (0..count).filter_map(move |n| {
        let mut low_s = from_s + f64::from(n) * length_s;
        let mut high_s = low_s + length_s;
        let falls = value(low_s) > 0.0;
        if falls == (value(high_s) > 0.0) {
            return None;
        }
        for _ in 0..24 {
            let middle_s = f64::midpoint(low_s, high_s);
            if (value(middle_s) > 0.0) == falls {
                low_s = middle_s;
            } else {
                high_s = middle_s;
            }
        }
        Some(f64::midpoint(low_s, high_s))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_are_those_of_many_short_panels() {
        let sine = Curve::Sine {
            centre_rad: 0.1,
            amplitude_rad: 0.7,
            frequency_hz: 0.8,
            phase_turns: 0.2,
        };
        for curve in [sine, Curve::Polynomial([0.2, 0.5, -0.4, 0.3, 0.2, -0.1])] {
            let piece = Piece {
                start_s: 0.0,
                end_s: 2.0,
                jump: false,
                curve,
            };
            let whole = integrals(&piece, (0.1, 1.4), (300.0, -0.2));
            let mut sum = Integrals::default();
            for n in 0..100 {
                let at = |n: f64| 0.1 + 0.013 * n;
                let part = integrals(
                    &piece,
                    (at(f64::from(n)), at(f64::from(n + 1))),
                    (300.0, -0.2),
                );
                sum.torque += part.torque;
                sum.square += part.square;
                sum.omega_squared += part.omega_squared;
                sum.acceleration_torque += part.acceleration_torque;
            }
            for (a, b) in [
                (whole.torque, sum.torque),
                (whole.square, sum.square),
                (whole.omega_squared, sum.omega_squared),
                (whole.acceleration_torque, sum.acceleration_torque),
            ] {
                assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{a} {b}");
            }
        }
    }

    #[test]
    fn zeros_are_found() {
        let piece = Piece {
            start_s: 0.0,
            end_s: 7.0,
            jump: false,
            curve: Curve::Polynomial([0.0, 1.0, 0.0, 1.0, 0.0, 0.0]),
        };
        let found: Vec<f64> = zeros(&piece, (0.0, 7.0), f64::cos).collect();
        assert_eq!(found.len(), 2);
        for (n, zero) in (0_u8..).zip(found) {
            let expected = std::f64::consts::FRAC_PI_2 * f64::from(2 * n + 1);
            assert!((zero - expected).abs() < 1e-6, "{zero}");
        }
    }
}
