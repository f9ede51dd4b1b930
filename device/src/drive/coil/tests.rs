use super::*;
use crepitus_model::render::effects::vibration_actuator::VibrationActuatorSettings;
use std::format;

const SETTINGS: fn() -> VibrationActuatorSettings = VibrationActuatorSettings::default;

/// A coil of R and L in a driver, sampled in the middle of a tick, as the drive sees it.
struct Rig {
    coil: Coil,
    supply_v: f32,
    resistance_ohm: f32,
    inductance_h: f32,
    current_a: f32,
    /// Voltage at the coil now, V; `None`: open.
    volts: Option<f32>,
    ticks: u32,
}

impl Rig {
    fn new(settings: &VibrationActuatorSettings) -> Self {
        Self {
            coil: Coil::new(Some(CoilPlan::new(settings))),
            supply_v: settings.supply_v as f32,
            resistance_ohm: settings.resistance_ohm as f32,
            inductance_h: 2e-4,
            current_a: 0.0,
            volts: None,
            ticks: 0,
        }
    }

    /// Half a tick of the coil, exactly.
    fn half(&mut self) {
        let Some(volts) = self.volts else {
            self.current_a = 0.0;
            return;
        };
        let end_a = volts / self.resistance_ohm;
        let kept = (-2.5e-5 * self.resistance_ohm / self.inductance_h).exp();
        self.current_a = end_a + kept * (self.current_a - end_a);
    }

    /// A tick with a command, whose sensor shows `shows` of the current.
    fn tick(&mut self, coil_v: f32, shows: impl Fn(f32) -> Option<f32>) -> CoilOutput {
        self.ticks += 1;
        self.half();
        let measured = self
            .coil
            .is_driven()
            .then(|| shows(self.current_a))
            .flatten();
        let output = self.coil.tick(coil_v, true, measured, false);
        self.half();
        self.volts = match output {
            CoilOutput::Driven(duty) => Some(duty * self.supply_v),
            CoilOutput::Asleep => None,
        };
        output
    }

    /// Ticks of a command until a fault, and the fault.
    fn until(
        &mut self,
        command: impl Fn(u32) -> f32,
        shows: impl Fn(f32) -> Option<f32>,
    ) -> Option<(u32, CoilFault)> {
        let begin = self.ticks;
        (0..200_000).find_map(|n| {
            self.tick(command(n), &shows);
            self.coil.fault().map(|fault| (self.ticks - begin, fault))
        })
    }
}

fn single(n: u32) -> f32 {
    f32::from(u16::try_from(n).unwrap())
}

/// Clicks of a few milliseconds, some 30 a second, as of crepitus.
fn clicks(n: u32) -> f32 {
    let t = single(n % 640) * 5e-5;
    2.5 * (-400.0 * t).exp() * (1_500.0 * t).sin()
}

fn sine(hz: f32, most_v: f32) -> impl Fn(u32) -> f32 {
    // All of them have whole periods in 4,000 ticks, 0.2 s.
    move |n| most_v * (core::f32::consts::TAU * hz * 5e-5 * single(n % 4_000)).sin()
}

#[test]
fn a_whole_coil_is_none_of_all() {
    for inductance_h in [1e-5, 2e-4, 1e-3] {
        for share in [0.8, 1.0, 1.4] {
            let mut rig = Rig::new(&SETTINGS());
            rig.inductance_h = inductance_h;
            rig.resistance_ohm *= share;
            let context = format!("{inductance_h} H, {share}");
            assert_eq!(rig.until(clicks, Some), None, "{context}");
            for hz in [15.0, 60.0, 250.0, 500.0] {
                let begin = rig.ticks;
                for n in 0..20_000 {
                    rig.tick(sine(hz, 1.5)(n), Some);
                }
                assert_eq!(rig.coil.fault(), None, "{context}, {hz} Hz");
                assert_eq!(rig.ticks - begin, 20_000);
            }
        }
    }
}

/// Wherever it is driven, a coil of nine tenths of the set resistance draws no more than its
/// sensor can tell from a short.
#[test]
fn a_whole_coil_is_no_short_at_the_largest_voltage() {
    for (supply_v, resistance_ohm) in [(5.0, 1.8), (12.0, 1.8), (5.0, 1.2), (5.0, 4.0)] {
        let settings = VibrationActuatorSettings {
            supply_v,
            resistance_ohm,
            ..SETTINGS()
        };
        for share in [0.91, 1.0] {
            let mut rig = Rig::new(&settings);
            rig.inductance_h = 1e-5;
            rig.resistance_ohm *= share;
            let context = format!("{supply_v} V, {resistance_ohm} Ω, {share}");
            let bangs = |n: u32| {
                if (n / 100).is_multiple_of(2) {
                    20.0
                } else {
                    -20.0
                }
            };
            let mut most_a = 0.0_f32;
            for n in 0..2_000 {
                rig.tick(bangs(n), Some);
                most_a = most_a.max(rig.current_a.abs());
            }
            let fault = rig.coil.fault().filter(|fault| *fault != CoilFault::Hot);
            assert_eq!(fault, None, "{context}");
            let expected_a = (0.91 * supply_v / resistance_ohm).min(2.4);
            assert!(f64::from(most_a) > expected_a, "{context}: {most_a} A");
        }
        let mut rig = Rig::new(&settings);
        rig.resistance_ohm = 0.2;
        let (ticks, fault) = rig.until(|_| 20.0, Some).expect("a fault");
        assert_eq!(fault, CoilFault::Short);
        assert!(
            ticks < 20,
            "{supply_v} V, {resistance_ohm} Ω: {ticks} ticks"
        );
    }
}

/// One whose back-EMF is above the supply, as of a long stroke with a strong magnet.
#[test]
fn an_actuator_with_a_large_back_emf_is_driven_and_compared() {
    let settings = VibrationActuatorSettings {
        force_constant_n_per_a: 3.9,
        resistance_ohm: 2.5,
        stroke_mm: 6.3,
        moving_mass_g: 155.0,
        resonance_hz: 35.0,
        damping_ratio: 0.2,
        ..SETTINGS()
    };
    let mut rig = Rig::new(&settings);
    let output = rig.tick(20.0, Some);
    assert!(
        matches!(output, CoilOutput::Driven(duty) if duty > 0.9),
        "{output:?}"
    );
    // A sine of the largest voltage is above what is compared: an open coil is found.
    let found = rig.until(sine(35.0, 20.0), |_| Some(0.0));
    assert_eq!(found.map(|(_, fault)| fault), Some(CoilFault::Open));
}

/// The command begins without heat when it is switched on again, and so does the check of a coil
/// that has cooled meanwhile.
#[test]
fn a_coil_that_is_not_used_cools() {
    let settings = SETTINGS();
    let continuous_v = settings.continuous_current_a as f32 * settings.resistance_ohm as f32;
    let loud = |n: u32| {
        if (n / 20).is_multiple_of(2) {
            continuous_v
        } else {
            -continuous_v
        }
    };
    let louder = |n: u32| 1.4 * loud(n);
    let mut rig = Rig::new(&settings);
    rig.inductance_h = 1e-5;
    for n in 0..600_000 {
        rig.tick(loud(n), Some);
    }
    assert_eq!(rig.coil.fault(), None);
    for pause_s in [0, 100] {
        let plan = rig.coil.plan;
        let mut again = Rig {
            coil: rig.coil,
            inductance_h: 1e-5,
            ..Rig::new(&settings)
        };
        again.coil.change(None);
        for _ in 0..=pause_s * 20_000 {
            again.tick(0.0, Some);
        }
        assert_eq!(again.coil.is_in_use(), pause_s == 0);
        again.coil.change(plan);
        again.tick(0.0, Some);
        for n in 0..100_000 {
            again.tick(louder(n), Some);
        }
        let fault = (pause_s == 0).then_some(CoilFault::Hot);
        assert_eq!(again.coil.fault(), fault, "after {pause_s} s");
    }
}

#[test]
fn the_duty_is_the_share_of_the_supply_within_what_the_converter_allows() {
    let mut coil = Coil::new(Some(CoilPlan::new(&SETTINGS())));
    for (coil_v, duty) in [
        (0.0, 0.0),
        (1.25, 0.25),
        (-2.5, -0.5),
        (5.0, 0.92),
        (-9.0, -0.92),
    ] {
        let output = coil.tick(coil_v, true, Some(0.0), false);
        assert_eq!(output, CoilOutput::Driven(duty), "{coil_v}");
    }
    for bad in [f32::NAN, f32::INFINITY] {
        assert_eq!(coil.tick(bad, true, Some(0.0), false), CoilOutput::Asleep);
    }
    assert_eq!(coil.tick(1.0, false, Some(0.0), false), CoilOutput::Asleep);
    assert!(!coil.is_driven());
    assert_eq!(coil.fault(), None);
}

#[test]
fn the_driver_is_believed_at_once_while_it_is_driven() {
    let mut coil = Coil::new(Some(CoilPlan::new(&SETTINGS())));
    // Not before: its supply may have come up just now.
    assert!(matches!(
        coil.tick(1.0, true, None, true),
        CoilOutput::Driven(_)
    ));
    for current in [Some(0.1), None] {
        let mut coil = coil;
        assert_eq!(coil.tick(1.0, true, current, true), CoilOutput::Asleep);
        assert_eq!(coil.fault(), Some(CoilFault::Driver));
    }
}

#[test]
fn each_fault_is_found_in_its_time_and_stays() {
    type Break = fn(&mut Rig);
    type Shows = fn(f32) -> Option<f32>;
    let whole: Break = |_| {};
    let cases: [(CoilFault, u32, Break, Shows); 7] = [
        (CoilFault::CurrentMissing, 3, whole, |_| None),
        (CoilFault::CurrentMissing, 3, whole, |_| Some(f32::NAN)),
        (CoilFault::Short, 7, |rig| rig.resistance_ohm *= 0.2, Some),
        (CoilFault::Short, 5, whole, |_| Some(-3.3)),
        (CoilFault::Open, 880, whole, |_| Some(0.003)),
        (CoilFault::CurrentMismatch, 880, whole, |a| Some(-a)),
        (CoilFault::CurrentMismatch, 880, whole, |_| Some(0.4)),
    ];
    for (expected, within, breaks, shows) in cases {
        let mut rig = Rig::new(&SETTINGS());
        for n in 0..6_400 {
            rig.tick(sine(60.0, 2.0)(n), Some);
        }
        breaks(&mut rig);
        // At its peak for a short, which shows as it is driven.
        let offset = if expected == CoilFault::Short { 80 } else { 0 };
        let (ticks, fault) = rig.until(|n| sine(60.0, 2.0)(n + offset), shows).unwrap();
        assert_eq!(fault, expected);
        assert!(ticks <= within, "{fault:?} after {ticks}");
        assert_eq!(rig.tick(1.0, Some), CoilOutput::Asleep);
        for _ in 0..1_000 {
            assert_eq!(rig.tick(1.0, Some), CoilOutput::Asleep);
        }
        assert_eq!(rig.coil.fault(), Some(expected));
        rig.coil.clear();
        assert!(matches!(rig.tick(1.0, Some), CoilOutput::Driven(_)));
    }
}

#[test]
fn what_is_quiet_shows_nothing() {
    let mut rig = Rig::new(&SETTINGS());
    assert_eq!(rig.until(sine(60.0, 0.1), |_| Some(0.0)), None);
}

#[test]
fn a_coil_that_takes_more_than_the_command_believes_gets_hot() {
    let settings = VibrationActuatorSettings {
        continuous_current_a: 0.5,
        ..SETTINGS()
    };
    let mut rig = Rig::new(&settings);
    // 0.56 A rms are 1.25 times the heat: for ever. 0.7 A are twice.
    assert_eq!(rig.until(sine(50.0, 1.8 * 0.78), Some), None);
    let (ticks, fault) = rig.until(sine(50.0, 1.8), Some).unwrap();
    assert_eq!(fault, CoilFault::Hot);
    assert!(ticks < 120_000, "{ticks}");
    // The coil is as warm when the fault is cleared at once, and cools while it sleeps.
    rig.coil.clear();
    assert!(rig.until(sine(50.0, 1.8), Some).unwrap().0 < 200);
    for _ in 0..100_000 {
        rig.coil.tick(0.0, false, None, false);
    }
    rig.coil.clear();
    assert!(rig.until(sine(50.0, 1.8), Some).unwrap().0 > 20_000);
}

#[test]
fn a_plan_is_exchanged_when_the_command_is_silent_or_nothing_is_driven() {
    let mut coil = Coil::new(None);
    assert!(!coil.is_in_use());
    let five = CoilPlan::new(&SETTINGS());
    coil.change(Some(five));
    assert!(coil.is_in_use());
    assert_eq!(coil.tick(0.0, true, None, false), CoilOutput::Driven(0.0));
    let ten = CoilPlan::new(&VibrationActuatorSettings {
        supply_v: 10.0,
        ..SETTINGS()
    });
    coil.change(Some(ten));
    assert_eq!(
        coil.tick(1.0, true, Some(0.0), false),
        CoilOutput::Driven(0.2)
    );
    assert_eq!(
        coil.tick(0.0, true, Some(0.0), false),
        CoilOutput::Driven(0.0)
    );
    assert_eq!(
        coil.tick(1.0, true, Some(0.0), false),
        CoilOutput::Driven(0.1)
    );
    coil.change(None);
    assert_eq!(
        coil.tick(1.0, true, Some(0.0), false),
        CoilOutput::Driven(0.1)
    );
    assert_eq!(coil.tick(1.0, false, Some(0.0), false), CoilOutput::Asleep);
    assert!(!coil.is_in_use());
    // One that is the same exchanges nothing.
    let mut coil = Coil::new(Some(five));
    coil.change(Some(five));
    assert!(!coil.has_next);
}

#[test]
fn a_chirp_is_bounded_by_supply_and_stroke() {
    let most = |settings: &VibrationActuatorSettings| {
        let coil = Coil::new(Some(CoilPlan::new(settings)));
        let bears = |mv: u16| coil.check_chirp(f32::from(mv) / 1000.0).is_ok();
        let most_mv = (1..=12_000).rev().find(|mv| bears(*mv)).unwrap();
        assert!((1..most_mv).all(bears));
        f64::from(most_mv) / 1000.0
    };
    // Twice 1.6 mm at the resonance: k·2ζ·R/Bl times that.
    let stiffness = 0.06 * (core::f64::consts::TAU * 35.0).powi(2);
    let by_stroke = 3.2e-3 * stiffness * 0.26 * 1.8 / 1.1;
    assert!((most(&SETTINGS()) - by_stroke).abs() < 2e-3);
    let stiff = VibrationActuatorSettings {
        resonance_hz: 120.0,
        ..SETTINGS()
    };
    // What the sensor can tell, with the back-EMF of the whole stroke.
    let emf_v = 1.1 * core::f64::consts::TAU * 120.0 * 1.6e-3;
    assert!((most(&stiff) - (3.1 / 1.1 * 1.8 - emf_v)).abs() < 2e-3);
    let weak = VibrationActuatorSettings {
        resistance_ohm: 4.0,
        ..stiff
    };
    let by_supply = f64::from(LARGEST_COIL_DUTY) * 5.0;
    assert!((most(&weak) - by_supply).abs() < 2e-3);
    assert_eq!(
        Coil::new(None).check_chirp(0.1),
        Err(DriveRefusal::NoActuator)
    );
}
