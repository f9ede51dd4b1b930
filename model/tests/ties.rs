//! Parameters that put an event exactly on a limit, where rounding decides
//! unless the code prevents it: Tk = 0 ends every slip at −Ts, Ts = Tk breaks
//! every stick where it begins.

use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{Convention, EventKind, Parameters, Real, Settings, ShaftStep, StickSlip};

const TICK_S: f64 = 5e-5;

/// Breaks, sticks, reverses in 2 s at a constant speed.
struct Count(f64);

impl<F: Real> JointVisitor<F> for Count {
    type Output = [u32; 3];

    fn visit<J: StickSlip<F>>(self, mut joint: J) -> [u32; 3] {
        let omega = F::from_f64(self.0);
        let step = ShaftStep {
            delta_phi_rad: F::from_f64(self.0 * TICK_S),
            omega_start_rad_s: omega,
            omega_end_rad_s: omega,
        };
        let mut counts = [0; 3];
        for _ in 0..40_000 {
            joint.step(&step, |event| {
                counts[match event.kind {
                    EventKind::Break => 0,
                    EventKind::Stick => 1,
                    EventKind::Reverse => 2,
                }] += 1;
            });
        }
        counts
    }
}

fn count<F: Real>(parameters: Parameters, convention: Convention, omega: f64) -> [u32; 3] {
    let settings = Settings {
        parameters,
        convention,
        ..Settings::default()
    };
    let valid = settings.validate().unwrap();
    let start = F::from_f64(omega);
    with_joint::<F, _>(&valid, Solver::ExactEvents, TICK_S, start, Count(omega)).unwrap()
}

/// Speeds that correspond to a twentieth up to a hundred times Ts.
const SPEEDS_RAD_S: [f64; 9] = [0.01, 0.05, 0.2, 0.97, -1.0, 3.1, 6.0, -12.0, 20.0];

#[test]
fn without_kinetic_friction_every_slip_ends_in_a_stick_at_the_limit() {
    for p in [
        Parameters::default(),
        Parameters {
            inertia_kg_m2: 8e-4,
            stiffness_nm_per_rad: 320.0,
            static_torque_nm: 0.14,
            ..Parameters::default()
        },
    ] {
        let p = Parameters {
            kinetic_torque_nm: 0.0,
            ..p
        };
        for convention in Convention::ALL {
            for omega in SPEEDS_RAD_S {
                let lambda = p.static_torque_nm / (omega.abs() * p.impedance_nms_per_rad());
                let cycle_s =
                    (std::f64::consts::TAU + 2.0 * (lambda - lambda.atan())) / p.natural_rad_s();
                let first_s = p.static_torque_nm / (p.stiffness_nm_per_rad * omega.abs());
                let expected = ((2.0 - first_s) / cycle_s).floor() + 1.0;
                for counts in [
                    count::<f32>(p, convention, omega),
                    count::<f64>(p, convention, omega),
                ] {
                    let [breaks, sticks, reverses] = counts;
                    assert_eq!(reverses, 0, "{convention:?} {omega}: {counts:?}");
                    assert!(
                        (f64::from(breaks) - expected).abs() < 0.5,
                        "{convention:?} {omega}: {counts:?}"
                    );
                    assert!(sticks == breaks || sticks + 1 == breaks);
                }
            }
        }
    }
}

#[test]
fn with_equal_torques_one_break_and_then_nothing() {
    let p = Parameters {
        kinetic_torque_nm: 0.3,
        static_torque_nm: 0.3,
        ..Parameters::default()
    };
    for convention in Convention::ALL {
        for omega in SPEEDS_RAD_S {
            assert_eq!(
                count::<f32>(p, convention, omega),
                [1, 0, 0],
                "{convention:?} {omega}"
            );
            assert_eq!(
                count::<f64>(p, convention, omega),
                [1, 0, 0],
                "{convention:?} {omega}"
            );
        }
    }
}

/// The phase after a movement of a second and a rest of another.
struct Stop;

impl<F: Real> JointVisitor<F> for Stop {
    type Output = i8;

    fn visit<J: StickSlip<F>>(self, mut joint: J) -> i8 {
        for n in 0..40_000 {
            let omega = if n < 20_000 { 1.0 } else { 0.0 };
            let omega = F::from_f64(omega);
            let step = ShaftStep {
                delta_phi_rad: omega * F::from_f64(TICK_S),
                omega_start_rad_s: omega,
                omega_end_rad_s: omega,
            };
            joint.step(&step, |_| {});
        }
        joint.phase().sign()
    }
}

#[test]
fn with_equal_torques_a_hand_that_stops_comes_to_rest() {
    for convention in Convention::ALL {
        let mut settings = Settings {
            convention,
            ..Settings::default()
        };
        settings.parameters.kinetic_torque_nm = settings.parameters.static_torque_nm;
        let valid = settings.validate().unwrap();
        let single = with_joint::<f32, _>(&valid, Solver::ExactEvents, TICK_S, 1.0, Stop);
        let double = with_joint::<f64, _>(&valid, Solver::ExactEvents, TICK_S, 1.0, Stop);
        let phases = (single.unwrap(), double.unwrap());
        assert_eq!(phases, (0, 0), "{convention:?}");
    }
}
