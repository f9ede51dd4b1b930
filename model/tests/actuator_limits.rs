//! What the limits of the vibration actuator promise, for any torque.

use crepitus_model::parameters::Tabled;
use crepitus_model::render::effects::vibration_actuator::{
    HEATING_S, VibrationActuator, VibrationActuatorSettings,
};
use crepitus_model::render::effects::{DeviceEffect, Timing};
use crepitus_model::render::position::Sight;
use proptest::prelude::*;

const TICK_S: f64 = 5e-5;
const TIMING: Timing = Timing {
    step_s: TICK_S,
    delay_ticks: 1,
    sight: Sight::IDEAL,
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
