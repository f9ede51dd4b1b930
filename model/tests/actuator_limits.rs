//! Promises of the limits of the vibration actuator, for any torque.

use crepitus_model::parameters::Tabled;
use crepitus_model::render::effects::vibration_actuator::{
    HEATING_S, VibrationActuator, VibrationActuatorSettings,
};
use crepitus_model::render::effects::{DeviceEffect, Timing};
use crepitus_model::render::position::Sensing;
use proptest::prelude::*;

const TICK_S: f64 = 5e-5;
const TIMING: Timing = Timing {
    step_s: TICK_S,
    delay_ticks: 1,
    sensing: Sensing::IDEAL,
};

fn law(settings: &VibrationActuatorSettings) -> VibrationActuator<f32> {
    DeviceEffect::new(VibrationActuator::coefficients(settings, &TIMING).expect("in range"))
}

/// Settings anywhere within their ranges.
fn settings() -> impl Strategy<Value = VibrationActuatorSettings> {
    prop::array::uniform11(0.0..=1.0_f64)
        .prop_map(|shares| {
            let mut settings = VibrationActuatorSettings::defaults();
            let table = VibrationActuatorSettings::TABLE.iter();
            for ((spec, value), share) in table.zip(settings.values_mut()).zip(shares) {
                *value = spec.min + share * (spec.max - spec.min);
            }
            settings
        })
        .prop_filter("no such coil", |settings| settings.check().is_ok())
}

/// Torque over time, with what is meanest to a resonance among it.
#[derive(Clone, Copy, Debug)]
enum Torque {
    Noise,
    Square { hertz: f64 },
    Sine { hertz: f64 },
}

fn torque() -> impl Strategy<Value = Torque> {
    prop_oneof![
        Just(Torque::Noise),
        (5.0..1000.0).prop_map(|hertz| Torque::Square { hertz }),
        (5.0..1000.0).prop_map(|hertz| Torque::Sine { hertz }),
    ]
}

impl Torque {
    #[expect(clippy::cast_possible_truncation, reason = "an input")]
    fn at(self, n: u32, most: f64) -> f32 {
        let share = match self {
            Self::Noise => f64::from(n.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 23) - 1.0,
            Self::Square { hertz } => (f64::from(n) * TICK_S * hertz * std::f64::consts::TAU)
                .sin()
                .signum(),
            Self::Sine { hertz } => (f64::from(n) * TICK_S * hertz * std::f64::consts::TAU).sin(),
        };
        (most * share) as f32
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// |V| ≤ supply, amplitude and heat at most their limits and what a tick adds.
    #[test]
    fn no_torque_drives_it_beyond_a_limit(
        settings in settings(),
        torque in torque(),
        most_nm in prop::sample::select(vec![1e-3, 0.4, 6.0, 1e6]),
        seed in any::<u32>(),
    ) {
        let mut law = law(&settings);
        let omega = settings.resonance_rad_s();
        let force_per_v = settings.force_constant_n_per_a / settings.resistance_ohm;
        // The most that a tick adds to the velocity over ω₀, as a share of the excursion.
        let most_push = force_per_v * settings.supply_v / (settings.moving_mass_g * 1e-3);
        let most_amplitude = 1.0 + 3.0 * most_push * TICK_S / omega / settings.usable_stroke_m();
        let most_current = settings.supply_v / settings.resistance_ohm
            + force_per_v * settings.usable_stroke_m() * most_amplitude * omega;
        let share = most_current / settings.continuous_current_a;
        // The mass rings down once the voltage is gone.
        let ringing_s = 1.0 / (2.0 * settings.damping_ratio * omega);
        let most_heat = 1.0 + share * share * (TICK_S + ringing_s) / HEATING_S;
        for n in 0..20_000_u32 {
            let volts = law.tick(torque.at(n.wrapping_add(seed), most_nm), true);
            prop_assert!(f64::from(volts.abs()) <= settings.supply_v * (1.0 + 1e-6));
            let amplitude = f64::from(law.amplitude());
            prop_assert!(amplitude <= most_amplitude * (1.0 + 1e-4), "{amplitude} {most_amplitude}");
            prop_assert!(f64::from(law.heat()) <= most_heat * (1.0 + 1e-4));
        }
    }

    /// The mirrored torque gives the mirrored voltage, bit for bit.
    #[test]
    fn a_mirrored_torque_gives_the_mirrored_voltage(
        settings in settings(), torque in torque(), seed in any::<u32>()
    ) {
        let (mut one, mut other) = (law(&settings), law(&settings));
        for n in 0..5_000_u32 {
            let nm = torque.at(n.wrapping_add(seed), 1.0);
            prop_assert_eq!(one.tick(nm, true), -other.tick(-nm, true));
        }
    }

    /// Below its limits it is linear: twice the torque, twice the voltage.
    #[test]
    fn below_its_limits_it_is_linear(torque in torque(), seed in any::<u32>()) {
        let settings = VibrationActuatorSettings::defaults();
        let (mut one, mut two) = (law(&settings), law(&settings));
        for n in 0..5_000_u32 {
            let nm = torque.at(n.wrapping_add(seed), 0.02);
            prop_assert_eq!(2.0 * one.tick(nm, true), two.tick(2.0 * nm, true));
            prop_assert!(one.amplitude() < 0.4 && one.heat() < 0.4);
        }
    }
}

/// Hours at the most that it lets through: the coil stays within what may last.
#[test]
fn a_torque_that_never_ends_leaves_the_coil_within_its_limit() {
    let settings = VibrationActuatorSettings {
        gain: 2.0,
        continuous_current_a: 0.5,
        ..VibrationActuatorSettings::default()
    };
    let mut law = law(&settings);
    let (mut squares, mut ticks) = (0.0, 0.0);
    for n in 0..1_200_000_u32 {
        let volts = law.tick(Torque::Square { hertz: 150.0 }.at(n, 3.0), true);
        // Far above the resonance the current is V/R.
        if n > 800_000 {
            squares += f64::from(volts / 1.8) * f64::from(volts / 1.8);
            ticks += 1.0;
        }
    }
    let rms_a = f64::sqrt(squares / ticks);
    assert!((0.4..=0.5).contains(&rms_a), "{rms_a}");
}

/// The mass and the coil again, by other equations: Newton's law in steps of a hundredth
/// of a tick, the heat by its differential equation.
struct Coil {
    settings: VibrationActuatorSettings,
    x_m: f64,
    v_m_s: f64,
    heat: f64,
}

impl Coil {
    fn run(&mut self, volts: f64) {
        const STEPS: u32 = 100;
        let s = &self.settings;
        let step_s = TICK_S / f64::from(STEPS);
        let mass_kg = s.moving_mass_g * 1e-3;
        let omega = s.resonance_rad_s();
        let force_n = s.force_constant_n_per_a * volts / s.resistance_ohm;
        for _ in 0..STEPS {
            let pull_n = mass_kg * omega * (2.0 * s.damping_ratio * self.v_m_s + omega * self.x_m);
            self.v_m_s += (force_n - pull_n) / mass_kg * step_s;
            self.x_m += self.v_m_s * step_s;
            let amperes = (volts - s.force_constant_n_per_a * self.v_m_s) / s.resistance_ohm;
            let share = amperes / s.continuous_current_a;
            self.heat += (share * share - self.heat) / HEATING_S * step_s;
        }
    }

    /// √(x² + (ẋ/ω₀)²) as a share of what may be.
    fn amplitude(&self) -> f64 {
        let rate_m = self.v_m_s / self.settings.resonance_rad_s();
        self.x_m.hypot(rate_m) / self.settings.usable_stroke_m()
    }
}

/// Limits and observer against the equations of the module and a coil of other code. The
/// command without limits is that of a law that gets a ten-thousandth of the torque.
#[test]
fn limits_take_what_the_module_says_of_a_coil_of_other_code() {
    const SMALL: f64 = 1e-4;
    /// Share of a limit from which on it reduces the command.
    const BEGINS_AT: f64 = 0.8;
    let warm = VibrationActuatorSettings {
        gain: 2.0,
        continuous_current_a: 0.4,
        ..VibrationActuatorSettings::default()
    };
    let short = VibrationActuatorSettings {
        stroke_mm: 0.8,
        damping_ratio: 0.1,
        moving_mass_g: 80.0,
        ..VibrationActuatorSettings::default()
    };
    let (mut hot, mut far, mut high, mut whole) = (0, 0, 0, 0);
    for (settings, torque, most_nm, ticks) in [
        (warm, Torque::Square { hertz: 120.0 }, 2.0, 200_000_u32),
        (short, Torque::Sine { hertz: 35.0 }, 0.3, 20_000),
        (short, Torque::Noise, 2.0, 20_000),
    ] {
        let coefficients = VibrationActuator::<f64>::coefficients(&settings, &TIMING).unwrap();
        let (mut law, mut free): (VibrationActuator<f64>, VibrationActuator<f64>) = (
            DeviceEffect::new(coefficients),
            DeviceEffect::new(coefficients),
        );
        let mut coil = Coil {
            settings,
            x_m: 0.0,
            v_m_s: 0.0,
            heat: 0.0,
        };
        for n in 0..ticks {
            let nm = f64::from(torque.at(n, most_nm));
            let wanted_v = free.tick(SMALL * nm, true) / SMALL;
            let cool = ((1.0 - law.heat()) / (1.0 - BEGINS_AT)).clamp(0.0, 1.0);
            let swing = law.amplitude() * law.amplitude();
            let room = ((1.0 - swing) / (1.0 - BEGINS_AT * BEGINS_AT)).clamp(0.0, 1.0);
            let drives_out = wanted_v * coil.v_m_s > 0.0;
            let left_v = cool
                * if drives_out {
                    room * wanted_v
                } else {
                    wanted_v
                };
            let expected_v = left_v.clamp(-settings.supply_v, settings.supply_v);
            let volts = law.tick(nm, true);
            // At a turn of the mass its direction is a matter of rounding.
            if coil.v_m_s.abs() > 1e-4 {
                assert!(
                    (volts - expected_v).abs() < 1e-6,
                    "{n}: {volts} {expected_v}"
                );
                let phase = law.phase();
                let is_high = left_v.abs() > settings.supply_v;
                let expected = match (is_high, drives_out && room < 1.0, cool < 1.0) {
                    (true, ..) => (&mut high, 2),
                    (_, true, _) => (&mut far, 3),
                    (.., true) => (&mut hot, 4),
                    _ => (&mut whole, 1),
                };
                *expected.0 += 1;
                assert_eq!(phase, expected.1, "{n}");
            }
            coil.run(volts);
            assert!(
                (law.amplitude() - coil.amplitude()).abs() < 2e-3,
                "{n}: {} {}",
                law.amplitude(),
                coil.amplitude()
            );
            assert!(
                (law.heat() - coil.heat).abs() < 1e-3 * coil.heat + 1e-6,
                "{n}: {} {}",
                law.heat(),
                coil.heat
            );
        }
    }
    assert!(
        hot > 1000 && far > 1000 && high > 1000 && whole > 1000,
        "{hot} {far} {high} {whole}"
    );
}

/// Without torque the mass and the filters start over; the coil cools as it would.
#[test]
fn a_coil_that_is_not_driven_cools() {
    let mut law = law(&VibrationActuatorSettings {
        continuous_current_a: 0.2,
        gain: 2.0,
        ..VibrationActuatorSettings::default()
    });
    for n in 0..100_000_u32 {
        law.tick(Torque::Square { hertz: 150.0 }.at(n, 3.0), true);
    }
    let warm = law.heat();
    assert!(warm > 0.5, "{warm}");
    // A time constant, 10 s.
    for _ in 0..200_000 {
        assert_eq!(law.tick(0.0, false), 0.0);
    }
    let left = f64::from(law.heat() / warm);
    assert!((left - f64::exp(-1.0)).abs() < 0.01, "{left}");
    assert_eq!(law.amplitude(), 0.0);
}
