//! Continuity of the torque while parameters change: every tick.
//!
//! Between two ticks without an event the model's torque moves with the spring
//! and, while it settles, with the slew limit; what compensation adds moves
//! with the slew limit, and the bone rings no faster than it can.

use crate::rendering;
use crate::support::{Heard, random_values};
use crate::support::{Host, set};
use crepitus_device::comms::sample_checks::Bounds;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::parameters::{self, id};
use crepitus_protocol::telemetry::{BLOCK_TICKS, Block, Sample, SampleFlags};
use crepitus_protocol::{DeviceSettings, LimitReason, Revision, TICK_S, Values};
use fastrand::Rng;
use std::collections::BTreeMap;

fn value(values: &Values, name: &str) -> f64 {
    let (id, _) = parameters::find(name).expect("a parameter");
    values.get(id).expect("a value")
}

fn is_on(values: &Values, name: &str) -> bool {
    value(values, name) != 0.0
}

/// Values that may be rendered from a commit on.
struct Change {
    from: Values,
    to: Values,
}

impl Change {
    fn torques(values: &Values) -> [f64; 2] {
        if is_on(values, "crepitus.render") {
            ["crepitus.kinetic_torque_nm", "crepitus.static_torque_nm"]
                .map(|name| value(values, name))
        } else {
            [0.0; 2]
        }
    }

    /// Ticks of the ramp.
    fn ticks(&self) -> f64 {
        let ([tk0, ts0], [tk1, ts1]) = (Self::torques(&self.from), Self::torques(&self.to));
        let stiffness = |values| value(values, "crepitus.stiffness_nm_per_rad");
        // A joint that begins or ends has the stiffness of the one that is.
        let softer = if ts0 > 0.0 && ts1 > 0.0 {
            ts0.max(ts1) * (stiffness(&self.from) / stiffness(&self.to)).ln()
        } else {
            0.0
        };
        let largest = (tk1 - tk0).abs().max((ts1 - ts0).abs()).max(softer);
        (largest / self.slew_nm()).ceil().max(1.0)
    }

    fn slew_nm(&self) -> f64 {
        value(&self.to, "limits.slew_nm_per_s") * TICK_S
    }

    /// Ts of the tick that is so many after the change.
    fn static_nm(&self, ticks: f64) -> f64 {
        let ([_, ts0], [_, ts1]) = (Self::torques(&self.from), Self::torques(&self.to));
        ts0 + (ts1 - ts0) * (ticks / self.ticks()).min(1.0)
    }

    /// No drive settles for longer than comms believes one.
    fn settles(&self, blocks: u32) {
        let [from, to] = [&self.from, &self.to]
            .map(|values| Bounds::of(&DeviceSettings::of(values).expect("committed")));
        let has_settled = from.or(to).has_settled(blocks);
        assert!(!has_settled, "it settles still after {blocks} blocks");
    }

    /// |T| ≤ Ts, wherever Ts is on its way.
    fn bound(&self, tick: f64, sample: &Sample) {
        let most = self.static_nm(tick);
        let model = f64::from(sample.model_torque_nm.abs());
        assert!(
            model <= most * (1.0 + 1e-4) + 1e-4,
            "{model} N·m of {most}, {tick} ticks after the change"
        );
    }

    /// Torque that a tick may add by itself, N·m.
    fn spring_nm(&self, before: &Sample, after: &Sample) -> f64 {
        let stiffness = ["crepitus.stiffness_nm_per_rad"]
            .map(|name| value(&self.from, name).max(value(&self.to, name)))[0];
        let counts = f64::from(after.count.wrapping_sub(before.count).abs());
        stiffness * counts * EncoderSettings::default().rad_per_count()
    }

    fn ringing_nm(&self) -> f64 {
        let rings = |values| is_on(values, "bone-shaping.render");
        if !rings(&self.from) && !rings(&self.to) {
            return 0.0;
        }
        let fastest = |name| value(&self.from, name).max(value(&self.to, name));
        // ω·g·ΔT·h, of two jumps at once; and one that was exchanged fades.
        let jump_nm = 2.0 * fastest("crepitus.static_torque_nm");
        let rate = std::f64::consts::TAU * fastest("bone-shaping.frequency_hz");
        2.0 * rate * fastest("bone-shaping.gain") * jump_nm * TICK_S + self.slew_nm()
    }
}

/// The worst that was met.
#[derive(Debug, Default)]
struct Worst {
    /// Movement of the model beside spring and events, as a share of what the slew limit allows.
    slew: f64,
    ticks: u64,
    settling: u64,
    events: u64,
    in_slip: u32,
}

/// Blocks in their order, with the values that were in force before and in
/// each.
struct Watch {
    values: BTreeMap<u32, Values>,
    worst: Worst,
}

impl Watch {
    fn look(&mut self, blocks: &[Block]) {
        let mut begun = (Revision::NONE, 0);
        let mut before: Option<Sample> = None;
        for block in blocks {
            if begun.0 != block.revision {
                begun = (block.revision, block.first_tick);
                if before.is_some_and(|s| s.flags.phase_sign() != 0) {
                    self.worst.in_slip += 1;
                }
            }
            let to = self.values[&block.revision.0];
            let from = self
                .values
                .range(..block.revision.0)
                .next_back()
                .map_or(to, |(_, values)| *values);
            let change = Change { from, to };
            if (block.samples.iter()).any(|sample| sample.flags.has(SampleFlags::SETTLING)) {
                let ticks = block.first_tick - begun.1;
                change.settles(u32::try_from(ticks / u64::from(BLOCK_TICKS)).expect("short"));
            }
            for (i, sample) in (0_u32..).zip(&block.samples) {
                let tick = block.first_tick - begun.1 + u64::from(i) + 1;
                let tick = f64::from(u32::try_from(tick).expect("short"));
                change.bound(tick, sample);
                if let Some(before) = &before {
                    self.step(&change, before, sample);
                }
                before = Some(*sample);
            }
        }
    }

    fn step(&mut self, change: &Change, before: &Sample, after: &Sample) {
        self.worst.ticks += 1;
        let has = |flag| before.flags.has(flag) || after.flags.has(flag);
        self.worst.settling += u64::from(has(SampleFlags::SETTLING));
        let is_event = after.flags.has(SampleFlags::BREAK | SampleFlags::STICK);
        let guard = |s: &Sample| s.flags.limit() == LimitReason::TurnedBack;
        if is_event {
            self.worst.events += 1;
            return;
        }
        let spring_nm = change.spring_nm(before, after);
        let step = |of: fn(&Sample) -> f32| f64::from((of(after) - of(before)).abs());
        let slew_nm = change.slew_nm();
        let model = (step(|s| s.model_torque_nm) - spring_nm - 1e-5).max(0.0);
        self.worst.slew = self.worst.slew.max(model / slew_nm);
        assert!(
            model <= slew_nm * 1.01,
            "the model moved by {model} N·m: {before:?} {after:?}"
        );
        // The guard lets go at once, and takes hold again with an event.
        if guard(before) != guard(after) {
            return;
        }
        // The joint's own, and what compensation adds.
        let shown = (step(|s| s.torque_nm) - spring_nm - change.ringing_nm() - 1e-5).max(0.0);
        assert!(
            shown <= 2.0 * slew_nm * 1.01,
            "the torque moved by {shown} N·m: {before:?} {after:?}"
        );
    }
}

/// Changes at random ticks; what was shown meanwhile.
fn watch(seed: u64, changes: usize, mut next: impl FnMut(&mut Rng, &Values) -> Values) -> Worst {
    let mut host = rendering();
    let mut rng = Rng::with_seed(seed);
    let (revision, values) = host.parameters();
    let mut watch = Watch {
        values: BTreeMap::from([(revision.0, values)]),
        worst: Worst::default(),
    };
    host.run(100);
    host.stream = Some(Vec::new());
    for _ in 0..changes {
        let (base, values) = host.parameters();
        let values = next(&mut rng, &values);
        match host.ask(Operation::Commit { base, values }) {
            Ok(Answer::Committed { revision }) => watch.values.insert(revision.0, values),
            other => panic!("{other:?}"),
        };
        // Long enough to settle, and to slip.
        host.run(rng.u64(600..3_000));
    }
    let status = host.status();
    assert_eq!((status.drive_fault, status.comms_fault), (0, 0));
    watch.look(&blocks(&mut host));
    assert_eq!(host.accounting.expect("a subscription").dropped, 0);
    watch.worst
}

fn blocks(host: &mut Host) -> Vec<Block> {
    let stream = host.stream.take().expect("a stream");
    stream
        .into_iter()
        .filter_map(|heard| match heard {
            Heard::Block(block) => Some(*block),
            Heard::Reply(_) => None,
        })
        .collect()
}

fn report(name: &str, worst: &Worst) {
    println!(
        "{name}: {} ticks, {} of them settling, {} with events; {} commits in a slip; \
         beside spring and events the model moved by at most {:.3} of the slew limit",
        worst.ticks, worst.settling, worst.events, worst.in_slip, worst.slew
    );
}

#[test]
fn joints_change_under_torque_within_the_slew_limit() {
    let worst = watch(11, 120, |rng, values| {
        let mut values = random_values::allowed(rng, values);
        for name in ["friction-compensation.render", "bone-shaping.render"] {
            set(&mut values, name, 0.0);
        }
        values.set(id::CREPITUS, 1.0);
        values
    });
    report("joints", &worst);
    assert!(worst.in_slip > 20 && worst.settling > 1_000 && worst.events > 300);
}

#[test]
fn the_joint_comes_and_goes_under_torque() {
    let worst = watch(12, 80, |_, values| {
        let mut values = *values;
        values.set(id::CREPITUS, 1.0 - value(&values, "crepitus.render"));
        values
    });
    report("crepitus on and off", &worst);
    assert!(worst.settling > 1_000);
}

#[test]
fn compensation_and_bone_come_and_go_under_torque() {
    let worst = watch(13, 120, |rng, values| {
        let mut values = *values;
        let name = ["friction-compensation.render", "bone-shaping.render"][rng.usize(0..2)];
        let other = 1.0 - value(&values, name);
        set(&mut values, name, other);
        set(&mut values, "friction-compensation.share", 0.9 * rng.f64());
        set(&mut values, "bone-shaping.gain", 2.0 * rng.f64());
        values
    });
    report("compensation and bone", &worst);
}

#[test]
fn everything_changes_under_torque() {
    let worst = watch(14, 150, random_values::allowed);
    report("everything", &worst);
}

/// The limit is lowered together with the joint's torque, while much of it is
/// shown.
#[test]
fn a_lowered_limit_does_not_jolt() {
    let worst = watch(15, 60, |_, values| {
        let mut values = *values;
        let high = value(&values, "limits.torque_nm") < 3.0;
        let numbers = if high {
            [2.0, 1.8, 4.5]
        } else {
            [0.2, 0.15, 0.3]
        };
        for (name, number) in [
            "crepitus.static_torque_nm",
            "crepitus.kinetic_torque_nm",
            "limits.torque_nm",
        ]
        .into_iter()
        .zip(numbers)
        {
            set(&mut values, name, number);
        }
        values
    });
    report("limits", &worst);
}
