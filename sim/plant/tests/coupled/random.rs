//! Plants, motions and commands of all kinds.

use crate::support::{Build, Rig, TICK_S, knot};
use crepitus_plant::Motion;
use crepitus_plant::effects::motor::bridge::Bridge;
use crepitus_plant::motion::Strokes;
use proptest::prelude::*;
use std::f64::consts::TAU;

/// A plant, its motion, and the torque of its device.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) build: Build,
    pub(crate) moves: Moves,
    pub(crate) asks: Asks,
}

impl Case {
    /// The plant; with a sign of −1 its mirror image.
    pub(crate) fn rig(&self, sign: f64) -> Rig {
        self.build.on(self.moves.motion(sign))
    }

    /// The plant on a bridge.
    pub(crate) fn rig_on_bridge(&self, sign: f64) -> Rig<Bridge> {
        self.build.on_bridge(self.moves.motion(sign))
    }
}

/// A motion that can be mirrored.
#[derive(Clone, Debug)]
pub(crate) enum Moves {
    Steadily(f64),
    /// Amplitude, frequency, phase.
    AsSine(f64, f64, f64),
    /// Reach, peak speed, pause.
    InStrokes(f64, f64, f64),
    /// Time since the last knot, and the velocity on both sides of it.
    Through(Vec<(f64, f64, f64)>),
}

impl Moves {
    fn motion(&self, sign: f64) -> Motion {
        match self {
            Self::Steadily(omega) => Motion::constant(sign * omega),
            Self::AsSine(amplitude, hertz, phase) => Motion::sine(sign * amplitude, *hertz, *phase),
            Self::InStrokes(reach, speed, pause_s) => Motion::Strokes(Strokes {
                from_rad: 0.0,
                to_rad: sign * reach,
                peak_speed_rad_s: *speed,
                pause_s: *pause_s,
            }),
            Self::Through(knots) => {
                let mut time_s = 0.0;
                let knots: Vec<_> = knots
                    .iter()
                    .enumerate()
                    .map(|(i, (after_s, left, right))| {
                        time_s += if i == 0 { 0.0 } else { *after_s };
                        knot(time_s, sign * left, sign * right)
                    })
                    .collect();
                Motion::velocity_knots(&knots)
            }
        }
    }
}

/// A torque that vibrates and jumps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asks {
    vibrates_nm: f64,
    hertz: f64,
    jumps_nm: f64,
    every: u32,
}

impl Asks {
    pub(crate) fn torque_nm(&self, tick: u32) -> f64 {
        let jumps = if (tick / self.every).is_multiple_of(2) {
            self.jumps_nm
        } else {
            -0.3 * self.jumps_nm
        };
        let angle = TAU * self.hertz * TICK_S * f64::from(tick);
        self.vibrates_nm * angle.sin() + jumps
    }
}

/// Evenly between two powers of ten.
fn decades(low: f64, high: f64) -> BoxedStrategy<f64> {
    (low.log10()..high.log10())
        .prop_map(|x| 10_f64.powf(x))
        .boxed()
}

/// Zero, or evenly between two powers of ten.
fn none_or(low: f64, high: f64) -> BoxedStrategy<f64> {
    prop_oneof![1 => Just(0.0), 3 => decades(low, high)].boxed()
}

fn moves() -> impl Strategy<Value = Moves> {
    let knot = (decades(1e-4, 0.1), -8.0..8.0_f64, -8.0..8.0_f64, 0..4_u8);
    prop_oneof![
        prop_oneof![Just(0.0), -7.0..7.0_f64].prop_map(Moves::Steadily),
        (decades(1e-4, 0.6), decades(0.2, 30.0), 0.0..360.0_f64).prop_map(|(a, f, p)| {
            // At most 8 rad/s.
            Moves::AsSine(a.min(8.0 / (TAU * f)), f, p)
        }),
        (decades(1e-3, 1.5), decades(0.02, 7.0), none_or(1e-3, 0.1))
            .prop_map(|(a, b, c)| Moves::InStrokes(a, b, c)),
        prop::collection::vec(knot, 1..12).prop_map(|knots| {
            let knots = knots.into_iter().map(|(after_s, left, right, kind)| {
                // Half of the knots are kinks, some stand still.
                let right = if kind < 2 { left } else { right };
                // Most are at ticks.
                let after_s = if kind == 3 {
                    after_s
                } else {
                    (after_s / TICK_S).ceil() / 20_000.0
                };
                if kind == 1 {
                    (after_s, 0.0, 0.0)
                } else {
                    (after_s, left, right)
                }
            });
            Moves::Through(knots.collect())
        }),
    ]
}

fn asks() -> impl Strategy<Value = Asks> {
    (
        none_or(1e-3, 3.0),
        decades(1.0, 200.0),
        none_or(1e-3, 2.0),
        1..2000_u32,
    )
        .prop_map(|(vibrates_nm, hertz, jumps_nm, every)| Asks {
            vibrates_nm,
            hertz,
            jumps_nm,
            every,
        })
}

/// Numbers of an effect by name.
type Numbers = Vec<(&'static str, f64)>;

fn numbers<const N: usize>(
    named: [(&'static str, BoxedStrategy<f64>); N],
) -> impl Strategy<Value = Numbers> {
    let keys = named.each_ref().map(|(key, _)| *key);
    let values = named.map(|(_, value)| value);
    values.prop_map(move |values| keys.into_iter().zip(values).collect())
}

fn motor() -> impl Strategy<Value = Numbers> {
    numbers([
        ("bandwidth_hz", decades(100.0, 2000.0)),
        ("resistance_ohm", decades(0.3, 3.0)),
        ("inductance_h", decades(1e-4, 1e-3)),
        ("supply_v", decades(5.0, 40.0)),
    ])
}

fn drivetrain() -> impl Strategy<Value = Numbers> {
    numbers([
        ("inertia_kg_m2", decades(2e-3, 0.5)),
        ("friction_nm", none_or(0.01, 3.0)),
        ("load_loss", none_or(0.01, 0.6)),
    ])
}

fn cuff() -> impl Strategy<Value = Numbers> {
    numbers([
        ("stiffness_nm_per_rad", decades(20.0, 2000.0)),
        ("damping_nms_per_rad", none_or(0.01, 5.0)),
        ("brace_inertia_kg_m2", decades(1e-3, 0.1)),
    ])
}

fn limb() -> impl Strategy<Value = Numbers> {
    numbers([
        ("body_mass_kg", decades(30.0, 120.0)),
        ("height_m", decades(1.2, 2.1)),
        ("damping_nms_per_rad", none_or(0.01, 1.0)),
    ])
}

fn limb_stretch() -> impl Strategy<Value = Numbers> {
    numbers([
        ("pull_n", none_or(0.1, 100.0)),
        ("straight_radius_m", decades(0.02, 0.1)),
        ("bent_radius_m", decades(0.02, 0.1)),
    ])
}

fn hand() -> impl Strategy<Value = Numbers> {
    numbers([
        ("mass_kg", decades(0.1, 5.0)),
        ("damping_ns_per_m", none_or(0.1, 50.0)),
        ("stiffness_n_per_m", none_or(10.0, 1000.0)),
        ("lever_m", decades(0.1, 0.5)),
    ])
}

/// Any selection of effects, and their numbers.
fn build(with_limb: bool) -> impl Strategy<Value = Build> {
    let gap = numbers([("gap_deg", decades(1e-3, 5.0))]);
    let choices = (0..4_usize, any::<bool>());
    let some = prop::array::uniform8(any::<bool>());
    (
        some,
        motor(),
        drivetrain(),
        gap,
        cuff(),
        (limb(), limb_stretch()),
        choices,
        hand(),
    )
        .prop_map(
            move |(
                some,
                motor,
                drivetrain,
                gap,
                cuff,
                (limb, stretch),
                (posture, passive),
                hand,
            )| {
                let has_limb = some[4] && with_limb;
                let mut build = Build::of(&[]);
                for (there, effect, numbers) in [
                    (some[0], "motor", motor),
                    (some[1] || some[2], "drivetrain", drivetrain),
                    (some[2], "backlash", gap),
                    (some[3], "cuff", cuff),
                    (has_limb, "limb", limb),
                    (has_limb && some[7], "limb-stretch", stretch),
                    (some[5], "hand", hand),
                ] {
                    if there {
                        build = build.with(effect, &numbers);
                    }
                }
                if !has_limb {
                    return build;
                }
                let posture = ["sitting", "standing", "prone", "supine"][posture];
                let passive = if passive { "riener-edrich" } else { "none" };
                build = build
                    .choosing("limb", "posture", posture)
                    .choosing("limb", "passive", passive);
                if some[6] && !some[5] {
                    build = build.released();
                }
                build
            },
        )
}

/// Any case, with a leg or without.
pub(crate) fn case(with_limb: bool) -> impl Strategy<Value = Case> {
    (build(with_limb), moves(), asks()).prop_map(|(build, moves, asks)| Case { build, moves, asks })
}
