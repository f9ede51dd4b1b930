//! Lost motion.

use crate::support::{Build, Complex, Harmonic, Rig, TICK_S, knot, size};
use crepitus_plant::Motion;
use crepitus_plant::motion::Strokes;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A rotor that stops at once where nothing drives it: its friction eats
/// v²·J/2F, some nanoradians, of its way.
fn dragged(gap_deg: f64) -> Build {
    Build::of(&[
        (
            "drivetrain",
            &[
                ("inertia_kg_m2", 1e-6),
                ("friction_nm", 1.0),
                ("load_loss", 0.0),
            ],
        ),
        ("backlash", &[("gap_deg", gap_deg)]),
    ])
}

/// A rotor that nothing stops.
fn coasting(gap_deg: f64) -> Build {
    Build::of(&[
        ("drivetrain", &[("friction_nm", 0.0), ("load_loss", 0.0)]),
        ("backlash", &[("gap_deg", gap_deg)]),
    ])
}

const INERTIA: f64 = 0.051;

fn close(found: f64, known: f64) -> bool {
    (found - known).abs() < 1e-12 * known.abs()
}

#[test]
fn leg_and_rotor_differ_by_the_gap_on_the_way_there_and_back() {
    for gap_deg in [0.01_f64, 1.0, 5.0] {
        let half = gap_deg.to_radians() / 2.0;
        let reach = 4.0 * half;
        let motion = Motion::Strokes(Strokes {
            from_rad: 0.0,
            to_rad: reach,
            peak_speed_rad_s: reach,
            pause_s: 0.1,
        });
        let mut rig = dragged(gap_deg).on(motion);
        let mut worst = 0.0_f64;
        for _ in 0..4 * 40_000 {
            let before = rig.leg().angle_rad;
            rig.tick(0.0);
            let (leg, rotor) = (rig.leg().angle_rad, rig.shaft().angle_rad);
            // Once the gap is crossed: on the way up behind, and in front on
            // the way down, by half the gap.
            if leg > before && leg > 2.0 * half {
                worst = worst.max((leg - rotor - half).abs());
            } else if leg < before && leg < reach - 2.0 * half {
                worst = worst.max((rotor - leg - half).abs());
            }
        }
        println!("gap {gap_deg}°: hysteresis off {worst:.1e} rad");
        assert!(worst < 1e-13);
        assert!(rig.relative_residual().abs() < 1e-9);
    }
}

/// First harmonic of a play of width β driven by A·sin (Slotine and Li,
/// Applied Nonlinear Control, 5.2, with slope 1).
fn describing(beta: f64, amplitude: f64) -> Complex {
    let x: f64 = beta / amplitude - 1.0;
    (
        (FRAC_PI_2 - x.asin() - x * (1.0 - x * x).sqrt()) / PI,
        2.0 * beta / (PI * amplitude) * (beta / (2.0 * amplitude) - 1.0),
    )
}

#[test]
fn the_first_harmonic_is_that_of_a_play() {
    let beta = 1.0_f64.to_radians();
    for ratio in [0.55, 0.75, 1.0, 2.0, 5.0, 20.0] {
        let amplitude = ratio * beta;
        let mut rig = dragged(1.0).on(Motion::sine(amplitude, 1.0, 0.0));
        let mut harmonic = Harmonic::default();
        for n in 1..=40_000_u32 {
            rig.tick(0.0);
            if n > 20_000 {
                let angle = TAU * f64::from(n) * TICK_S;
                harmonic.add(angle, rig.shaft().angle_rad / amplitude);
            }
        }
        let (found, known) = (harmonic.response(), describing(beta, amplitude));
        let off = size((found.0 - known.0, found.1 - known.1));
        println!(
            "A/β = {ratio}: gain {:.6}, phase {:.4}°; off {off:.1e}",
            size(found),
            found.1.atan2(found.0).to_degrees()
        );
        // What the rotor coasts after a turn, J·v²/2F, is the rest.
        assert!(off < 1e-7);
    }
}

/// When the joint stops the rotor continues through the gap, unless it was
/// pressing.
#[test]
fn a_rotor_goes_on_where_the_joint_stops() {
    let half = 0.5_f64.to_radians();
    for sense in [1.0, -1.0] {
        let stop = Motion::velocity_knots(&[
            knot(0.0, sense * 0.2, sense * 0.2),
            knot(0.1, sense * 0.4, 0.0),
        ]);
        let mut rig = coasting(1.0).on(stop);
        rig.ticks(2000, 0.0);
        assert_eq!(rig.get("gap_rad"), -sense * half, "dragged along");
        let felt = rig.plant.felt_nms();
        let mut ticks = 0;
        while rig.get("gap_rad") != sense * half {
            assert!(close(rig.shaft().omega_rad_s, sense * 0.4), "it coasts");
            rig.tick(0.0);
            ticks += 1;
            assert!(ticks < 10_000, "it crosses the gap");
        }
        let crossing = 2.0 * half / 0.4 / TICK_S;
        assert!((f64::from(ticks) - crossing).abs() <= 1.0);
        // All of its momentum and energy stay at the far side.
        let impulse = rig.plant.felt_nms() - felt;
        assert!((impulse / (-sense * INERTIA * 0.4) - 1.0).abs() < 1e-12);
        let lost = rig.joule("backlash", "impacts");
        println!("stopped joint: impact {lost:.9} J, impulse {impulse:.9} N·m·s");
        assert!((lost / (0.5 * INERTIA * 0.16) - 1.0).abs() < 1e-12);
        assert!(rig.relative_residual().abs() < 1e-12);
        rig.ticks(100, 0.0);
        assert_eq!(rig.shaft().omega_rad_s, 0.0);
        assert_eq!(rig.get("gap_rad"), sense * half);
    }
}

/// A joint that is jerked away from the rotor leaves it alone, one that is
/// jerked into it takes it along.
#[test]
fn teeth_push_but_do_not_pull() {
    for sense in [1.0, -1.0] {
        let jerk = |to: f64| {
            let motion = Motion::velocity_knots(&[
                knot(0.0, sense * 0.2, sense * 0.2),
                knot(0.01, sense * 0.4, sense * to),
            ]);
            let mut rig = coasting(1.0).on(motion);
            rig.ticks(201, 0.0);
            assert!(rig.relative_residual().abs() < 1e-12);
            (
                rig.shaft().omega_rad_s * sense,
                rig.plant.felt_nms() * sense,
            )
        };
        // The rotor has 0.4 rad/s then, pushed by a joint that was speeding up.
        for (to, omega) in [(0.3, 0.4), (-1.0, 0.4), (1.0, 1.0)] {
            let found = jerk(to);
            println!("joint from 0.4 to {to} rad/s: rotor {:.6}", found.0);
            assert!(close(found.0, omega));
            assert!(close(found.1, INERTIA * (omega - 0.2)));
        }
    }
}

/// A joint that gives way: arm without spring or damper.
fn with_free_joint(mass_kg: f64) -> Build {
    coasting(1.0).with(
        "hand",
        &[
            ("mass_kg", mass_kg),
            ("lever_m", 1.0),
            ("stiffness_n_per_m", 0.0),
            ("damping_ns_per_m", 0.0),
        ],
    )
}

fn cross(rig: &mut Rig, torque_nm: f64, ticks: u32) -> f64 {
    rig.ticks(ticks, torque_nm);
    let omega = rig.shaft().omega_rad_s;
    let known = -torque_nm * f64::from(ticks) * TICK_S / INERTIA;
    assert!((omega / known - 1.0).abs() < 1e-12);
    while rig.get("gap_rad").abs() < 0.5_f64.to_radians() {
        assert!(close(rig.shaft().omega_rad_s, omega), "it coasts");
        assert_eq!(rig.leg().omega_rad_s, 0.0);
        rig.tick(0.0);
    }
    omega
}

#[test]
fn an_impact_keeps_momentum_and_costs_the_energy_of_a_plastic_one() {
    for mass_kg in [0.01, 0.051, 0.5, 50.0] {
        for torque in [1.0, -1.0] {
            let mut rig = with_free_joint(mass_kg).at_rest();
            let before = cross(&mut rig, torque, 40);
            let after = rig.leg().omega_rad_s;
            assert!(close(after, rig.shaft().omega_rad_s), "they go on as one");
            let known = INERTIA / (INERTIA + mass_kg) * before;
            assert!((after / known - 1.0).abs() < 1e-12);
            let reduced = INERTIA * mass_kg / (INERTIA + mass_kg);
            let lost = rig.joule("backlash", "impacts");
            assert!((lost / (0.5 * reduced * before * before) - 1.0).abs() < 1e-12);
            // The hand carries the arm's share of the momentum's change.
            assert!((rig.plant.felt_nms() + mass_kg * after).abs() < 1e-12);
            assert!(rig.relative_residual().abs() < 1e-12);
            let last = rig.leg();
            rig.ticks(100, 0.0);
            assert!(close(rig.leg().omega_rad_s, last.omega_rad_s));
        }
    }
}
