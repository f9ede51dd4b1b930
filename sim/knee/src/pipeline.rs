//! The drive's torque without the drive.
//!
//! ```text
//! values ──> Preparation ── plan, once the one before has settled
//!                                    ↓
//! count ───> Exchange ─────> Rendering (velocity, joint, symptoms, limits) ──> torque
//! ```
//!
//! The parts are those of a [`Drive`](crepitus_device::Drive), in its order: `sample_encoder`,
//! `render_torque`, `idle`. Left out is `command_motor`: arming, the fade at the ends of the range, the
//! current loop. A plan takes effect between two ticks, not between two blocks of telemetry.

use crepitus_device::drive::commits::Taken;
use crepitus_device::drive::exchange::{Exchange, Rendered, Turn};
use crepitus_device::drive::prepare::{Preparation, Start};
use crepitus_device::drive::rendering::Rendering;
use crepitus_model::Frozen;
use crepitus_model::solver::locate::ExactEvents;
use crepitus_protocol::parameters::id;
use crepitus_protocol::{Revision, ValueError, Values};

/// Every commit: nobody asks for its number.
const COMMIT: Taken = (Revision::NONE, 0);

/// Values of a healthy knee: a device at its defaults that renders nothing.
pub fn healthy() -> Values {
    let mut values = Values::default();
    values.set(id::CREPITUS, 0.0);
    values
}

/// The parts of a drive that render.
#[derive(Debug)]
pub struct Pipeline {
    preparation: Preparation,
    rendering: Rendering,
    exchange: Exchange,
    /// Commit that waits until the one before has settled.
    pending: Option<Values>,
    next_tick: u32,
    /// The count of the angle's zero.
    zero: i32,
    is_armed: bool,
}

impl Pipeline {
    /// A device at its defaults on a shaft at rest at this count, which is its zero.
    ///
    /// # Errors
    /// [`ValueError`] if the default values are invalid: a bug in their table, which a test excludes.
    pub fn new(counter: u32) -> Result<Self, ValueError> {
        let (preparation, start) = Preparation::new()?;
        let Start {
            reader, prepared, ..
        } = start;
        let exchange = Exchange::new(0);
        // The joint of the defaults is on its way.
        exchange.set_settling(true);
        Ok(Self {
            preparation,
            rendering: Rendering::new(&reader, counter, &prepared.rendering),
            exchange,
            pending: None,
            next_tick: 0,
            zero: counter.cast_signed(),
            is_armed: false,
        })
    }

    /// Applies values before the next tick, or as soon as those of before have settled; the torque moves
    /// there with the slew limit. Of several that wait the last one counts.
    ///
    /// # Errors
    /// [`ValueError`] if the values are invalid, or need a disarmed device: then nothing changes.
    pub fn commit(&mut self, values: &Values) -> Result<(), ValueError> {
        // Tried on a copy: what is prepared counts as active from there on.
        let mut trial = self.preparation.clone();
        trial.prepare(COMMIT, values, self.is_armed)?;
        self.pending = Some(*values);
        self.apply_pending();
        Ok(())
    }

    fn apply_pending(&mut self) {
        if self.exchange.is_busy() {
            return;
        }
        let Some(values) = self.pending.take() else {
            return;
        };
        // Values that need a disarmed device are dropped if it was armed meanwhile.
        if let Ok(prepared) = self.preparation.prepare(COMMIT, &values, self.is_armed) {
            let plan = Some(&prepared.rendering);
            self.rendering.take_over(plan, &self.exchange);
            // There is no other half to apply.
            self.exchange.command_took_plan();
        }
    }

    /// One tick of 50 µs, with the encoder's counter as it begins.
    pub fn tick(&mut self, counter: u32, is_armed: bool) -> Rendered {
        self.is_armed = is_armed;
        self.exchange.announce(Turn {
            tick: self.next_tick,
            ends_block: false,
            is_armed,
            zero: self.zero,
        });
        self.next_tick = self.next_tick.wrapping_add(1);
        self.exchange.sample(counter);
        self.rendering.tick(&self.exchange);
        self.apply_pending();
        self.exchange.rendered().unwrap_or_default()
    }

    /// Returns whether a commit waits or is on its way.
    pub fn is_settling(&self) -> bool {
        self.pending.is_some() || self.exchange.is_busy()
    }

    /// The stick-slip joint, if there is one.
    pub fn joint(&self) -> Option<&Frozen<f32, ExactEvents>> {
        self.rendering.joint()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_model::StickSlip;
    use crepitus_model::render::effects::EffectSettings;
    use crepitus_protocol::parameters::find;
    use crepitus_protocol::{DeviceSettings, LimitReason};
    use std::vec::Vec;

    /// Values of a healthy knee with some of another.
    fn with(changes: &[(&str, f64)]) -> Values {
        let mut values = healthy();
        for (name, value) in changes {
            values.set(find(name).unwrap().0, *value);
        }
        values
    }

    /// Values of a knee with crepitus that breaks at this torque.
    fn with_static(static_nm: f64) -> Values {
        let changes = [
            ("crepitus.render", 1.0),
            ("crepitus.static_torque_nm", static_nm),
        ];
        with(&changes)
    }

    /// A device with these values that has settled, unarmed, at count 0.
    fn settled(values: &Values) -> Pipeline {
        let mut pipeline = Pipeline::new(0).unwrap();
        pipeline.commit(values).unwrap();
        let has_settled = (0..2_000).any(|_| {
            pipeline.tick(0, false);
            !pipeline.is_settling()
        });
        assert!(has_settled);
        pipeline
    }

    /// A shaft that turns by two counts a tick, 1.43 rad/s, from a tick on: torques to the bit.
    fn turned(pipeline: &mut Pipeline, from: u32, ticks: u32) -> Vec<[u32; 2]> {
        (from..from + ticks)
            .map(|tick| {
                let rendered = pipeline.tick(2 * tick, true);
                [rendered.torque_nm, rendered.model_torque_nm].map(f32::to_bits)
            })
            .collect()
    }

    #[test]
    fn a_healthy_knee_renders_nothing() {
        let settings = DeviceSettings::of(&healthy()).unwrap();
        assert_eq!(settings.crepitus, None);
        assert_eq!(settings.effects, EffectSettings::default());
        let mut pipeline = settled(&healthy());
        assert!(pipeline.joint().is_none());
        let torques = turned(&mut pipeline, 0, 20_000);
        assert!(torques.iter().all(|torque| *torque == [0; 2]));
    }

    #[test]
    fn torque_is_only_there_while_armed_and_grows_with_the_slew_limit() {
        let rigid = with(&[("lead-pipe.render", 1.0), ("lead-pipe.torque_nm", 3.0)]);
        let mut pipeline = settled(&rigid);
        for tick in 0..4_000_u32 {
            let rendered = pipeline.tick(2 * tick, false);
            assert_eq!(rendered.torque_nm, 0.0);
            assert_eq!(rendered.flags.limit(), LimitReason::NotArmed);
        }
        let mut before_nm = 0.0;
        for tick in 4_000..8_000_u32 {
            let rendered = pipeline.tick(2 * tick, true);
            // 100 N·m/s.
            assert!(rendered.torque_nm - before_nm < 5.1e-3, "{rendered:?}");
            before_nm = rendered.torque_nm;
        }
        assert!((before_nm - 3.0).abs() < 1e-3, "{before_nm}");
    }

    #[test]
    fn a_refused_commit_changes_no_bit() {
        let joint = with_static(0.4);
        let (mut one, mut other) = (settled(&joint), settled(&joint));
        turned(&mut one, 0, 500);
        turned(&mut other, 0, 500);
        let of_another = |id, value| {
            let mut values = joint;
            values.set(id, value);
            values
        };
        let id = id::STATIC_TORQUE;
        let refused = one.commit(&of_another(id, f64::NAN));
        assert_eq!(refused, Err(ValueError::OutOfRange { id }));
        let refused = one.commit(&of_another(id, 0.1));
        assert_eq!(refused, Err(ValueError::KineticAboveStatic));
        let id = id::LINES;
        let refused = one.commit(&of_another(id, 1_000.0));
        assert_eq!(refused, Err(ValueError::NeedsDisarmed { id }));
        assert!(!one.is_settling());
        let torques = turned(&mut one, 500, 2_000);
        assert_eq!(torques, turned(&mut other, 500, 2_000));
        assert!(torques.iter().any(|torque| torque[0] != 0));
    }

    #[test]
    fn of_commits_that_wait_the_last_one_counts() {
        let mut pipeline = settled(&healthy());
        turned(&mut pipeline, 0, 1_000);
        for static_nm in [0.5, 0.6, 0.7] {
            pipeline.commit(&with_static(static_nm)).unwrap();
        }
        let mut tick = 1_000;
        while pipeline.is_settling() {
            turned(&mut pipeline, tick, 1);
            tick += 1;
            assert!(tick < 5_000);
        }
        let joint = pipeline.joint().unwrap();
        assert_eq!(joint.coefficients().static_nm, 0.7);
    }

    /// A joint that begins shows no more than the slew limit lets it.
    #[test]
    fn a_joint_begins_without_a_jolt_and_is_gone_after_its_ramp() {
        let mut pipeline = settled(&healthy());
        turned(&mut pipeline, 0, 4_000);
        pipeline.commit(&with_static(0.4)).unwrap();
        for (n, tick) in (1_u16..=80).zip(4_000..) {
            let rendered = pipeline.tick(2 * tick, true);
            let most_nm = 5e-3 * f32::from(n) + 1e-5;
            assert!(rendered.torque_nm.abs() <= most_nm, "{n}: {rendered:?}");
        }
        turned(&mut pipeline, 4_080, 4_000);
        pipeline.commit(&healthy()).unwrap();
        turned(&mut pipeline, 8_080, 100);
        assert!(pipeline.joint().is_none() && !pipeline.is_settling());
    }

    #[test]
    fn a_commit_that_waits_is_dropped_where_it_needs_a_disarmed_device() {
        let (mut one, mut other) = (settled(&healthy()), settled(&healthy()));
        let joint = with_static(0.4);
        let mut lines = joint;
        lines.set(id::LINES, 1_000.0);
        one.commit(&joint).unwrap();
        other.commit(&joint).unwrap();
        // It waits for the joint, disarmed still.
        one.commit(&lines).unwrap();
        let torques = turned(&mut one, 0, 8_000);
        assert_eq!(torques, turned(&mut other, 0, 8_000));
        assert!(torques.iter().any(|torque| torque[0] != 0));
    }

    #[test]
    fn the_zero_is_the_count_at_which_it_begins() {
        let limited = with(&[("range-limit.render", 1.0)]);
        let torques = |begin: u32| -> Vec<u32> {
            let mut pipeline = Pipeline::new(begin).unwrap();
            pipeline.commit(&limited).unwrap();
            for _ in 0..2_000 {
                pipeline.tick(begin, false);
            }
            // To 163°, beyond the end of the range.
            let rendered = (0..20_000).map(|n| pipeline.tick(begin + 4 * n, true));
            rendered.map(|tick| tick.torque_nm.to_bits()).collect()
        };
        let expected = torques(0);
        assert!(expected.iter().any(|torque| *torque != 0));
        assert_eq!(torques(100_000), expected);
    }
}
