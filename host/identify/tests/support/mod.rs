//! An actuator with its faults, stepped by Runge and Kutta. It shares no code with
//! the fit; of the project it takes only the chirp, as the device does.

#![allow(dead_code, reason = "each test program uses its part")]

use crepitus_identify::actuator::{Band, Current, Hold, Series, Weighed};
use crepitus_model::control::chirp::{Chirp, ChirpSettings};

/// Samples of the simulation in a tick of 50 µs, and ticks in a sample of telemetry.
const STEPS: u32 = 6;
const TICKS: u32 = 5;
const STEP_S: f64 = 5e-5 / STEPS as f64;

/// Ticks before and after the chirp.
const BEFORE: u32 = 2_000;
const AFTER: u32 = 12_000;

/// The chirp of most tests.
pub(crate) const CHIRP: ChirpSettings = ChirpSettings {
    amplitude_v: 0.4,
    from_hz: 8.0,
    to_hz: 500.0,
    duration_ticks: 200_000,
};

/// The moving mass, as weighed.
pub(crate) const MASS: Weighed = Weighed {
    mass_kg: 0.060,
    share: 0.01,
};

/// A ring that is not clamped.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ring {
    pub(crate) mass_kg: f64,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
}

/// The truth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Simulated {
    pub(crate) resistance_ohm: f64,
    pub(crate) inductance_h: f64,
    pub(crate) force_constant: f64,
    pub(crate) mass_kg: f64,
    pub(crate) resonance_hz: f64,
    /// Damping ratio of the flexure alone.
    pub(crate) damping_ratio: f64,
    /// Mass added to the moving mass, kg; the flexure stays as it is.
    pub(crate) added_kg: f64,
    /// Distance from the middle to a stop, m, and how far its weight moves the mass, m.
    pub(crate) stroke_m: f64,
    pub(crate) sag_m: f64,
    /// Coulomb friction, N.
    pub(crate) friction_n: f64,
    /// The amplifier loses this much against the current, V.
    pub(crate) dead_v: f64,
    pub(crate) offset_v: f64,
    pub(crate) ring: Option<Ring>,
    /// Eddy currents: this resistance, Ω, in parallel with 0.1 mH, in series with the coil.
    pub(crate) eddy_ohm: f64,
    /// Standard deviation of the noise of a sample, A.
    pub(crate) noise_a: f64,
    pub(crate) clips_at_a: f64,
    pub(crate) is_open: bool,
    pub(crate) sign: f64,
}

/// Actuator as the data sheet has it, and ideal.
pub(crate) const NOMINAL: Simulated = Simulated {
    resistance_ohm: 1.8,
    inductance_h: 2e-4,
    force_constant: 1.1,
    mass_kg: 0.060,
    resonance_hz: 35.0,
    damping_ratio: 0.105,
    added_kg: 0.0,
    stroke_m: 1.0,
    sag_m: 0.0,
    friction_n: 0.0,
    dead_v: 0.0,
    offset_v: 0.0,
    ring: None,
    eddy_ohm: 0.0,
    noise_a: 0.002,
    clips_at_a: 1e9,
    is_open: false,
    sign: 1.0,
};

/// Current, place and speed of the mass, of the ring; current past the eddies.
type State = [f64; 6];

impl Simulated {
    /// Every value within ±30 %, noise of 1 to 3 mA.
    pub(crate) fn drawn(random: &mut fastrand::Rng) -> Self {
        let mut about = |value: f64| value * (0.7 + 0.6 * random.f64());
        Self {
            resistance_ohm: about(NOMINAL.resistance_ohm),
            inductance_h: about(NOMINAL.inductance_h),
            force_constant: about(NOMINAL.force_constant),
            mass_kg: about(NOMINAL.mass_kg),
            resonance_hz: about(NOMINAL.resonance_hz),
            damping_ratio: about(NOMINAL.damping_ratio),
            noise_a: 1e-3 + 2e-3 * random.f64(),
            ..NOMINAL
        }
    }

    pub(crate) fn omega(&self) -> f64 {
        2.0 * std::f64::consts::PI * self.resonance_hz
    }

    /// Damping ratio with the coil connected.
    pub(crate) fn whole_damping_ratio(&self) -> f64 {
        let of_coil = self.force_constant.powi(2) / self.resistance_ohm;
        self.damping_ratio + of_coil / (2.0 * self.mass_kg * self.omega())
    }

    fn slope(&self, volts: f64, [i, x, v, y, w, past]: State) -> State {
        let omega = self.omega();
        let stiffness = self.mass_kg * omega * omega;
        let damping = 2.0 * self.damping_ratio * omega * self.mass_kg;
        let (stretch, rate) = (x - y, v - w);
        let beyond = |at: f64| (at.abs() - self.stroke_m).max(0.0).copysign(at);
        // Stops of rubber, 40 times as stiff as the flexure.
        let stop = 40.0 * stiffness * beyond(stretch + self.sag_m);
        let rub = self.friction_n * (rate / 1e-4).tanh();
        let force = self.force_constant * i - stiffness * stretch - damping * rate - stop - rub;
        let lost = self.dead_v * (i / 1e-3).tanh();
        let emf = self.force_constant * rate;
        let eddy = self.eddy_ohm * (i - past);
        let driven = volts + self.offset_v - lost - self.resistance_ohm * i - emf - eddy;
        let (ring_v, ring_a) = match self.ring {
            Some(ring) => (
                w,
                (-force - ring.stiffness * y - ring.damping * w) / ring.mass_kg,
            ),
            None => (0.0, 0.0),
        };
        [
            driven / self.inductance_h,
            v,
            force / (self.mass_kg + self.added_kg),
            ring_v,
            ring_a,
            eddy / 1e-4,
        ]
    }

    fn step(&self, volts: f64, state: State) -> State {
        let along =
            |slope: State, h: f64| -> State { std::array::from_fn(|n| state[n] + h * slope[n]) };
        let a = self.slope(volts, state);
        let b = self.slope(volts, along(a, 0.5 * STEP_S));
        let c = self.slope(volts, along(b, 0.5 * STEP_S));
        let d = self.slope(volts, along(c, STEP_S));
        std::array::from_fn(|n| state[n] + STEP_S / 6.0 * (a[n] + 2.0 * b[n] + 2.0 * c[n] + d[n]))
    }

    /// Voltage and current of a chirp as telemetry has them: means of 5 ticks, with
    /// noise, in whole milliamperes.
    pub(crate) fn played(&self, chirp: &ChirpSettings, random: &mut fastrand::Rng) -> Series {
        let mut generator = Chirp::new(chirp).expect("a chirp");
        let mut state = [0.0; 6];
        let (mut volts, mut amperes) = (Vec::new(), Vec::new());
        let (mut volts_sum, mut amperes_sum) = (0.0, 0.0);
        for tick in 0..BEFORE + chirp.duration_ticks + AFTER {
            let volt = if tick < BEFORE {
                0.0
            } else {
                f64::from(generator.tick())
            };
            for _ in 0..STEPS {
                let before = state[0];
                state = self.step(volt, state);
                amperes_sum += 0.5 * (before + state[0]) / f64::from(STEPS * TICKS);
            }
            volts_sum += volt / f64::from(TICKS);
            if tick % TICKS == TICKS - 1 {
                volts.push(volts_sum);
                amperes.push(self.measured(amperes_sum, random));
                (volts_sum, amperes_sum) = (0.0, 0.0);
            }
        }
        let series = Series::new(5e-5 * f64::from(TICKS), &volts, &amperes).expect("a series");
        series.held(Hold {
            tick_s: 5e-5,
            current: Current::Mean,
        })
    }

    fn measured(&self, amperes: f64, random: &mut fastrand::Rng) -> f64 {
        // Twelve numbers from 0 to 1 have variance 1 together.
        let normal = (0..12).map(|_| random.f64()).sum::<f64>() - 6.0;
        let flowing = if self.is_open { 0.0 } else { amperes };
        let sensed = self.sign * flowing.clamp(-self.clips_at_a, self.clips_at_a);
        // A converter that is at its end shows no noise either.
        let noise = if flowing.abs() > self.clips_at_a {
            0.0
        } else {
            normal * self.noise_a
        };
        ((sensed + noise) * 1e3).round() * 1e-3
    }
}

/// The band of a chirp.
pub(crate) fn band(chirp: &ChirpSettings) -> Band {
    Band::of_chirp(f64::from(chirp.from_hz), f64::from(chirp.to_hz))
}
