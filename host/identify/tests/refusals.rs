//! Refusal of what is no linear actuator on a vice, with the reason that it has.

mod support;

use crepitus_identify::actuator::{Actuator, MassEvidence, Refusal, Series, Weighed, identify};
use crepitus_model::control::chirp::ChirpSettings;
use crepitus_model::render::effects::vibration_actuator::VibrationActuatorSettings;
use support::{CHIRP, MASS, NOMINAL, Ring, Simulated, band};

fn played(truth: &Simulated) -> Series {
    truth.played(&CHIRP, &mut fastrand::Rng::with_seed(1))
}

fn identified(truth: &Simulated) -> Result<Actuator, Refusal> {
    identify(&played(truth), band(&CHIRP), &MassEvidence::Weighed(MASS))
}

/// The refusal and its text.
fn refused(truth: &Simulated) -> (Refusal, String) {
    let refusal = identified(truth).expect_err("refused");
    let text = refusal.to_string();
    eprintln!("{text}");
    (refusal, text)
}

#[test]
fn a_mass_at_its_stops() {
    // Of what a free mass would do, ±0.32 mm, some is left out.
    for (stroke_m, sag_m) in [(0.30e-3, 0.0), (0.2e-3, 0.0), (0.45e-3, 0.2e-3)] {
        let (refusal, text) = refused(&Simulated {
            stroke_m,
            sag_m,
            ..NOMINAL
        });
        assert!(matches!(refusal, Refusal::Nonlinear { .. }), "{text}");
        assert!(text.contains("stops (a linear one would swing by ±0."));
    }
    // The mass does not come to its stops.
    let free = Simulated {
        stroke_m: 0.4e-3,
        ..NOMINAL
    };
    assert!(identified(&free).is_ok());
}

#[test]
fn a_ring_that_moves() {
    for (mass_kg, stiffness, damping) in [
        (0.25, 4e3, 0.0),
        (0.25, 4e3, 5.0),
        (0.25, 4e3, 20.0),
        (0.25, 4e3, 60.0),
        (0.5, 4e5, 20.0),
        (2.0, 4e5, 20.0),
    ] {
        let ring = Ring {
            mass_kg,
            stiffness,
            damping,
        };
        let (refusal, text) = refused(&Simulated {
            ring: Some(ring),
            ..NOMINAL
        });
        assert!(
            matches!(refusal, Refusal::SecondResonance { .. }),
            "{ring:?}: {text}"
        );
    }
}

#[test]
fn a_ring_so_soft_that_the_current_cannot_tell_shows_against_an_added_mass() {
    let loose = Simulated {
        ring: Some(Ring {
            mass_kg: 0.25,
            stiffness: 400.0,
            damping: 5.0,
        }),
        ..NOMINAL
    };
    // The limit of one chirp, as the book says: mass and ring swing against each other.
    let found = identified(&loose).unwrap();
    assert!(found.resonance_hz.value > 38.0 && !found.mass_is_checked);
    let with = played(&Simulated {
        added_kg: 0.03,
        ..loose
    });
    let added = Weighed {
        mass_kg: 0.03,
        share: 0.01,
    };
    let evidence = MassEvidence::Both(MASS, &with, added);
    let refusal = identify(&played(&loose), band(&CHIRP), &evidence).unwrap_err();
    assert!(matches!(refusal, Refusal::WrongMass { .. }), "{refusal}");
}

#[test]
fn a_broken_coil_and_crossed_wires() {
    let (refusal, _) = refused(&Simulated {
        is_open: true,
        ..NOMINAL
    });
    assert!(matches!(refusal, Refusal::CoilOpen { .. }));
    let (refusal, _) = refused(&Simulated {
        sign: -1.0,
        ..NOMINAL
    });
    assert!(matches!(refusal, Refusal::Reversed { .. }));
}

#[test]
fn a_clipped_current() {
    for clips_at_a in [0.2, 0.15, 0.1, 0.05] {
        let (refusal, text) = refused(&Simulated {
            clips_at_a,
            ..NOMINAL
        });
        let Refusal::Clipped { amperes, .. } = refusal else {
            panic!("{clips_at_a}: {text}");
        };
        assert!((amperes / clips_at_a - 1.0).abs() < 0.02);
    }
}

#[test]
fn a_current_of_few_milliamperes() {
    let weak = ChirpSettings {
        amplitude_v: 0.01,
        ..CHIRP
    };
    let found = |noise_a: f64| {
        let truth = Simulated { noise_a, ..NOMINAL };
        let series = truth.played(&weak, &mut fastrand::Rng::with_seed(1));
        identify(&series, band(&weak), &MassEvidence::Weighed(MASS))
    };
    // The plateau of this current is one milliampere of the record, not the end of the sensor.
    let refusal = found(0.0).unwrap_err();
    eprintln!("{refusal}");
    assert!(matches!(refusal, Refusal::Weak { .. }), "{refusal}");
    assert!(refusal.to_string().contains("raise the amplitude"));
    // Noise makes the steps even; too much of it, and the advice is the same.
    let found_hz = found(0.3e-3).unwrap().resonance_hz.value;
    assert!((found_hz / 35.0 - 1.0).abs() < 0.05, "{found_hz}");
    let refusal = found(2e-3).unwrap_err();
    eprintln!("{refusal}");
    assert!(refusal.to_string().contains("higher amplitude"));
}

#[test]
fn friction_and_a_dead_time() {
    for (friction_n, dead_v) in [(0.1, 0.0), (0.05, 0.0), (0.0, 0.02), (0.0, 0.1)] {
        let (refusal, text) = refused(&Simulated {
            friction_n,
            dead_v,
            ..NOMINAL
        });
        assert!(matches!(refusal, Refusal::Nonlinear { .. }), "{text}");
    }
    // What is let through does no harm.
    for (friction_n, dead_v, offset_v) in [(0.003, 0.0, 0.0), (0.0, 0.005, 0.0), (0.0, 0.0, 0.05)] {
        let found = identified(&Simulated {
            friction_n,
            dead_v,
            offset_v,
            ..NOMINAL
        });
        let found = found.unwrap();
        for (estimate, truth) in [
            (found.resistance_ohm, 1.8),
            (found.resonance_hz, 35.0),
            (found.force_constant_n_per_a, 1.1),
            (found.damping_ratio, NOMINAL.whole_damping_ratio()),
        ] {
            assert!((estimate.value / truth - 1.0).abs() < 0.03, "{estimate:?}");
        }
    }
}

#[test]
fn a_mass_that_does_not_move_or_resonates_elsewhere() {
    for stuck in [
        Simulated {
            force_constant: 1e-3,
            ..NOMINAL
        },
        Simulated {
            friction_n: 0.5,
            ..NOMINAL
        },
    ] {
        let (refusal, _) = refused(&stuck);
        assert!(matches!(refusal, Refusal::NoResonance { .. }));
    }
    for resonance_hz in [9.0, 240.0, 400.0] {
        let (refusal, _) = refused(&Simulated {
            resonance_hz,
            ..NOMINAL
        });
        let Refusal::AtEdge {
            resonance_hz: found_hz,
            ..
        } = refusal
        else {
            panic!("{refusal}");
        };
        assert!((found_hz / resonance_hz - 1.0).abs() < 0.02);
    }
}

#[test]
fn a_coil_with_eddy_currents() {
    let eddy = Simulated {
        eddy_ohm: 0.4,
        ..NOMINAL
    };
    let (refusal, text) = refused(&eddy);
    assert!(matches!(refusal, Refusal::NotAnInductance { .. }), "{text}");
    // With a lower end of the band, as the text says, the rest is found.
    let low = ChirpSettings {
        to_hz: 120.0,
        ..CHIRP
    };
    let series = eddy.played(&low, &mut fastrand::Rng::with_seed(1));
    let found = identify(&series, band(&low), &MassEvidence::Weighed(MASS)).unwrap();
    assert!((found.resonance_hz.value / 35.0 - 1.0).abs() < 0.01);
    assert!((found.force_constant_n_per_a.value / 1.1 - 1.0).abs() < 0.03);
}

#[test]
fn a_flexure_that_gives_power() {
    let (refusal, text) = refused(&Simulated {
        damping_ratio: -0.015,
        ..NOMINAL
    });
    assert!(matches!(refusal, Refusal::Negative { .. }), "{text}");
}

#[test]
fn noise_that_leaves_nothing_certain() {
    let (refusal, _) = refused(&Simulated {
        noise_a: 0.03,
        ..NOMINAL
    });
    assert!(matches!(refusal, Refusal::Uncertain { .. }));
    let (refusal, _) = refused(&Simulated {
        noise_a: 1.0,
        ..NOMINAL
    });
    assert!(matches!(refusal, Refusal::NoResonance { .. }));
}

#[test]
fn recordings_of_something_else() {
    let whole = played(&NOMINAL);
    let cut = |from: usize, to: usize| {
        let (volts, amperes) = (&whole.volts()[from..to], &whole.amperes()[from..to]);
        let part = Series::new(whole.step_s(), volts, amperes).unwrap();
        identify(&part, band(&CHIRP), &MassEvidence::Weighed(MASS)).expect_err("refused")
    };
    let rows = whole.volts().len();
    let begins = cut(5000, rows);
    assert!(matches!(
        begins,
        Refusal::NotAtRest {
            place: "begins",
            ..
        }
    ));
    let ends = cut(0, rows - 5000);
    assert!(matches!(ends, Refusal::NotAtRest { place: "ends", .. }));
    let silent = cut(rows - 2200, rows);
    assert!(matches!(silent, Refusal::NoVoltage { .. }), "{silent}");
    // Another band than was played.
    let narrow = ChirpSettings {
        to_hz: 100.0,
        ..CHIRP
    };
    let series = NOMINAL.played(&narrow, &mut fastrand::Rng::with_seed(1));
    let refusal = identify(&series, band(&CHIRP), &MassEvidence::Weighed(MASS)).unwrap_err();
    let Refusal::LittleExcitation { hz, .. } = refusal else {
        panic!("{refusal}");
    };
    assert!((90.0..120.0).contains(&hz), "{hz}");
}

#[test]
fn masses_that_do_not_fit() {
    let without = played(&NOMINAL);
    let both = |truth: &Simulated, added_kg: f64, weighed_kg: f64| {
        let with = played(truth);
        let [weighed, added] = [weighed_kg, added_kg].map(|mass_kg| Weighed {
            mass_kg,
            share: 0.01,
        });
        let evidence = MassEvidence::Both(weighed, &with, added);
        identify(&without, band(&CHIRP), &evidence)
    };
    let heavier = |added_kg| Simulated {
        added_kg,
        ..NOMINAL
    };
    let found = both(&heavier(0.03), 0.03, 0.06).unwrap();
    assert!(
        found.mass_is_checked
            && found
                .notes(&VibrationActuatorSettings::default())
                .is_empty()
    );
    // Weighed with its wrapping; the wrong weight in the hand.
    let wrong = both(&heavier(0.03), 0.03, 0.07).unwrap_err();
    assert!(matches!(wrong, Refusal::WrongMass { .. }), "{wrong}");
    let wrong = both(&heavier(0.03), 0.02, 0.06).unwrap_err();
    assert!(matches!(wrong, Refusal::WrongMass { .. }), "{wrong}");
    // Next to nothing; another flexure; a warm coil.
    let small = both(&heavier(0.002), 0.002, 0.06).unwrap_err();
    assert!(matches!(small, Refusal::AddedMassSmall { .. }), "{small}");
    let softer = Simulated {
        resonance_hz: 32.0,
        ..heavier(0.03)
    };
    let loose = both(&softer, 0.03, 0.06).unwrap_err();
    assert!(matches!(loose, Refusal::AddedMassLoose { .. }), "{loose}");
    let warm = Simulated {
        resistance_ohm: 2.0,
        ..heavier(0.03)
    };
    let warm = both(&warm, 0.03, 0.06).unwrap_err();
    assert!(matches!(warm, Refusal::Warm { .. }), "{warm}");
    // One chirp cannot tell, and says so.
    let guessed = Weighed {
        mass_kg: 0.08,
        share: 0.01,
    };
    let found = identify(&without, band(&CHIRP), &MassEvidence::Weighed(guessed)).unwrap();
    let notes = found.notes(&VibrationActuatorSettings::default());
    assert!(notes[0].contains("nothing in the current tells a wrong mass"));
}

#[test]
fn values_that_the_device_would_reject() {
    let heavy = Weighed {
        mass_kg: 0.4,
        share: 0.01,
    };
    let series = played(&NOMINAL);
    let found = identify(&series, band(&CHIRP), &MassEvidence::Weighed(heavy)).unwrap();
    let refusal = found
        .settings(&VibrationActuatorSettings::default())
        .unwrap_err();
    assert!(matches!(refusal, Refusal::Settings(_)));
    assert!(refusal.to_string().contains("moving_mass_g"), "{refusal}");
    // The right mass gives settings that the stage takes.
    let found = identified(&NOMINAL).unwrap();
    let settings = found
        .settings(&VibrationActuatorSettings::default())
        .unwrap();
    assert!((settings.damping_ratio - NOMINAL.whole_damping_ratio()).abs() < 2e-3);
    assert_eq!(settings.stroke_mm, 1.6);
}
