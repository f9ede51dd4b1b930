//! The regularised laws against their closed forms.

use super::*;
use crepitus_model::Parameters;

fn contact() -> Contact {
    Contact::direct(&Parameters::default())
}

/// Ts = Tk = 0.2 N·m, v = 1e-4 rad/s.
fn flat() -> CoulombParameters {
    CoulombParameters {
        contact: Contact {
            static_torque_nm: 0.2,
            ..contact()
        },
        width_rad_s: 1e-4,
    }
}

/// The torque at a velocity at the end of a step that began with another.
fn at<F: Real, L: FrictionLaw<F>>(law: &mut L, omega: f64) -> f64 {
    law.step(&ShaftStep {
        delta_phi_rad: F::from_f64(0.7),
        omega_start_rad_s: F::from_f64(-3.0),
        omega_end_rad_s: F::from_f64(omega),
    })
    .to_f64()
}

fn fitted<F: Real, L: FrictionLaw<F>>() -> L {
    L::new(&L::fitted(&contact()), 5e-5)
}

/// Velocities over seven decades.
fn velocities() -> impl Iterator<Item = f64> {
    (0..3000).map(|n| 1e-7 * Real::exp(f64::from(n) * 0.0055))
}

/// tanh by its definition: accurate above 1e-3, the series below.
fn known_tanh(x: f64) -> f64 {
    if x < 1e-3 {
        return x - x * x * x / 3.0;
    }
    x.tanh()
}

fn worst<F: Real, L: FrictionLaw<F>>(shape: impl Fn(f64) -> f64) -> f64 {
    let mut law = fitted::<F, L>();
    velocities()
        .map(|omega| {
            // The velocity as the precision has it.
            let omega = F::from_f64(omega).to_f64();
            let known = contact().sliding_nm(omega) * shape(omega / 3e-3);
            (at::<F, L>(&mut law, omega) / known - 1.0).abs()
        })
        .fold(0.0, f64::max)
}

#[test]
fn constant_velocity_gives_the_stribeck_curve() {
    let band = |x: f64| x.min(1.0);
    let double = [
        worst::<f64, Tanh<f64>>(known_tanh),
        worst::<f64, Band<f64>>(band),
    ];
    let single = [
        worst::<f32, Tanh<f32>>(known_tanh),
        worst::<f32, Band<f32>>(band),
    ];
    std::println!("relative: f64 {double:?}, f32 {single:?}");
    assert!(double.iter().all(|off| *off < 1e-12), "{double:?}");
    assert!(single.iter().all(|off| *off < 8e-7), "{single:?}");
}

fn is_odd<F: Real, L: FrictionLaw<F>>() {
    let mut law = fitted::<F, L>();
    for omega in velocities() {
        let (there, back) = (at(&mut law, omega), at(&mut law, -omega));
        assert!(there > 0.0);
        assert_eq!(there.to_bits(), (-back).to_bits(), "{omega}");
    }
    assert_eq!(at(&mut law, 0.0), 0.0);
    assert_eq!(at(&mut law, -0.0), 0.0);
}

#[test]
fn torque_is_odd_to_the_bit() {
    is_odd::<f64, Tanh<f64>>();
    is_odd::<f64, Band<f64>>();
    is_odd::<f32, Tanh<f32>>();
    is_odd::<f32, Band<f32>>();
}

#[test]
fn slope_at_rest_is_the_static_torque_over_the_width() {
    // Ts/v, with v = 3 mrad/s.
    for torque in [
        at::<f64, _>(&mut fitted::<f64, Tanh<f64>>(), 1e-9),
        at::<f64, _>(&mut fitted::<f64, Band<f64>>(), 1e-9),
    ] {
        assert!((torque * 3e-3 / 0.4e-9 - 1.0).abs() < 1e-9, "{torque}");
    }
    for torque in [
        at::<f32, _>(&mut fitted::<f32, Tanh<f32>>(), 1e-9),
        at::<f32, _>(&mut fitted::<f32, Band<f32>>(), 1e-9),
    ] {
        assert!((torque * 3e-3 / 0.4e-9 - 1.0).abs() < 3e-7, "{torque}");
    }
}

#[test]
fn peak_is_near_the_static_torque_and_never_above() {
    let peak = |torque: &mut dyn FnMut(f64) -> f64| velocities().map(torque).fold(0.0, f64::max);
    let (mut tanh, mut band) = (fitted::<f64, Tanh<f64>>(), fitted::<f64, Band<f64>>());
    let tanh_peak = peak(&mut |omega| at(&mut tanh, omega)) / 0.4;
    let band_peak = peak(&mut |omega| at(&mut band, omega)) / 0.4;
    assert!((tanh_peak - 0.957).abs() < 1e-3, "{tanh_peak}");
    assert!((band_peak - 0.995).abs() < 1e-3, "{band_peak}");
    assert!((at(&mut tanh, 1.0) - 0.2).abs() < 1e-16);
    assert!((at(&mut band, 1.0) - 0.2).abs() < 1e-16);
}

/// Velocity at which an inertia of 0.01 kg·m² settles under a load.
fn creep<F: Real, L: FrictionLaw<F, Parameters = CoulombParameters>>(load: f64) -> f64 {
    // h·Ts/(v·J) = 0.2.
    let step_s = 1e-6;
    let mut law = L::new(&flat(), step_s);
    let mut omega = 0.0;
    for _ in 0..400 {
        omega += step_s / 0.01 * (load - at(&mut law, omega));
    }
    omega
}

#[test]
fn a_load_creeps_with_the_closed_form() {
    for share in [-0.9_f64, 0.1, 0.5, 0.9] {
        let load = share * 0.2;
        // v·artanh(L/Tk) and v·L/Tk.
        let tanh = 1e-4 * 0.5 * ((1.0 + share) / (1.0 - share)).ln();
        let band = 1e-4 * share;
        let off = |creep: f64, known: f64| (creep / known - 1.0).abs();
        assert!(off(creep::<f64, Tanh<f64>>(load), tanh) < 1e-6, "{share}");
        assert!(off(creep::<f64, Band<f64>>(load), band) < 1e-6, "{share}");
        assert!(off(creep::<f32, Tanh<f32>>(load), tanh) < 5e-6, "{share}");
        assert!(off(creep::<f32, Band<f32>>(load), band) < 5e-6, "{share}");
    }
}

#[test]
fn a_contact_without_a_drop_has_a_width() {
    let contact = Contact {
        static_torque_nm: 0.2,
        stribeck_rad_s: 0.0,
        ..contact()
    };
    let mut law = Tanh::<f32>::new(&Tanh::<f32>::fitted(&contact), 5e-5);
    assert_eq!(at::<f32, _>(&mut law, 0.0), 0.0);
    let half = at::<f32, _>(&mut law, 0.5 * NARROWEST_RAD_S) / 0.2;
    assert!((half - 0.5_f64.tanh()).abs() < 1e-6, "{half}");
}

#[test]
fn changed_parameters_are_those_of_a_new_law() {
    let mut law = fitted::<f64, Band<f64>>();
    law.change(&flat(), 1e-5);
    assert_eq!(
        at(&mut law, 5e-5),
        at(&mut Band::<f64>::new(&flat(), 1e-5), 5e-5)
    );
    assert!((at(&mut law, 5e-5) - 0.1).abs() < 1e-15);
}
