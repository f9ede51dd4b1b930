//! `crepitus-knee` renders what the drive renders: the same counts through its pipeline, while every preset is
//! committed in turn to a device that moves.

mod support;

use crepitus_device::drive::exchange::Rendered;
use crepitus_knee::Pipeline;
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::{LimitReason, Revision, State, Values};
use crepitus_scene::values::with_preset;
use crepitus_scene::{Preset, Scene, preset};
use crepitus_virtual_device::Start;
use std::collections::BTreeMap;
use support::{Heard, Host, scene};

/// Strokes over the whole range, as fast as a quick stretch, on a shaft that nothing bends: before it is armed no
/// count changes.
const STROKES: &str = r#"
version = 1
title = "Quick strokes"
duration_s = 60.0
[motion]
kind = "strokes"
from_deg = -3.0
to_deg = 123.0
peak_speed_deg_s = 250.0
pause_s = 0.1
[solver]
kind = "exact-events"
step_s = 5e-5
precision = "f32"
[effects.encoder]
[effects.motor]
[effects.drivetrain]
"#;

/// Ticks of a stroke there and back, with its pauses.
const CYCLE_TICKS: u32 = 42_000;

/// Ticks in which a device takes its parameters and settles.
const SETTLING_TICKS: u32 = 2_000;

/// A device, and the pipeline that follows it.
struct Followed {
    host: Host,
    pipeline: Pipeline,
    revision: Revision,
    /// Torque that the pipeline has rendered, by tick, until the telemetry of the drive arrives.
    ours: BTreeMap<u64, Rendered>,
    compared: u64,
}

impl Followed {
    /// A device that rests, disarmed, with its zero set.
    fn new() -> Self {
        let straight = Scene {
            begins_straight: true,
            ..scene(STROKES)
        };
        let mut host = Host::new(&straight, &Start::default());
        host.run(SETTLING_TICKS.into());
        assert_eq!(host.ask(Operation::Zero), Ok(Answer::Done));
        // No preset may heat the motor until it disarms.
        host.set("limits.torque_nm", 2.0);
        host.run(SETTLING_TICKS.into());
        host.subscribe();
        host.stream = Some(Vec::new());
        host.renew_every = Some(1_000);
        let drive = host.device.board().drive();
        assert_eq!(drive.rendered().map(|rendered| rendered.count), Some(0));
        let mut pipeline = Pipeline::new(0).expect("the defaults are valid");
        let values = drive.values().expect("settled");
        pipeline.commit(values).expect("accepted by the drive");
        for _ in 0..SETTLING_TICKS {
            pipeline.tick(0, false);
        }
        assert!(!pipeline.is_settling());
        Self {
            revision: drive.revision(),
            host,
            pipeline,
            ours: BTreeMap::new(),
            compared: 0,
        }
    }

    /// One tick of both.
    fn tick(&mut self) {
        self.host.tick();
        let drive = self.host.device.board().drive();
        if drive.revision() != self.revision {
            // `render_torque` has applied it after the tick before, as a block ended.
            self.revision = drive.revision();
            let values = drive.values().expect("just applied");
            self.pipeline.commit(values).expect("accepted by the drive");
        }
        let theirs = drive.rendered().expect("it runs");
        let is_armed = theirs.flags.limit() != LimitReason::NotArmed;
        let ours = self.pipeline.tick(theirs.count.cast_unsigned(), is_armed);
        let tick = theirs.tick;
        assert_eq!(Rendered { tick, ..ours }, theirs);
        self.ours.insert(drive.next_tick() - 1, ours);
    }

    fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// Arms the device.
    fn arm(&mut self) {
        let arm = self.host.request(Operation::Arm);
        self.host.say(&arm);
        self.run(4_000);
        assert_eq!(self.state(), State::Armed);
    }

    fn state(&self) -> State {
        self.host.device.board().drive().state()
    }

    /// Commits values.
    fn commit(&mut self, change: impl FnOnce(&Values) -> Values) {
        let comms = self.host.device.board().comms();
        let (base, values) = (comms.revision(), change(comms.values()));
        let commit = self.host.request(Operation::Commit { base, values });
        self.host.say(&commit);
    }

    /// Compares what has arrived of the telemetry. Returns the largest torque of the model, N·m.
    fn compare(&mut self) -> f32 {
        let mut largest_nm = 0.0_f32;
        let stream = self.host.stream.as_mut().expect("blocks are wanted");
        for heard in stream.drain(..) {
            let Heard::Block(block) = heard else {
                continue;
            };
            for (tick, sample, phases) in block.ticks() {
                // Of before the pipeline followed.
                let Some(ours) = self.ours.remove(&tick) else {
                    continue;
                };
                let [ours_nm, theirs_nm] = [ours.model_torque_nm, sample.model_torque_nm];
                assert_eq!(ours_nm.to_bits(), theirs_nm.to_bits(), "tick {tick}");
                assert_eq!(ours.phases, phases, "tick {tick}");
                largest_nm = largest_nm.max(theirs_nm.abs());
                self.compared += 1;
            }
        }
        largest_nm
    }
}

#[test]
fn the_pipeline_renders_what_the_drive_does_with_every_preset() {
    let mut followed = Followed::new();
    followed.arm();
    let mut silent = Vec::new();
    for preset in preset::shipped() {
        followed.commit(|values| with_preset(values, preset, false));
        // The knee before is compared to its end.
        followed.run(SETTLING_TICKS);
        followed.compare();
        followed.run(CYCLE_TICKS);
        if followed.compare() == 0.0 {
            silent.push(preset.name.as_str());
        }
    }
    followed.commit(|values| with_preset(values, &Preset::default(), false));
    followed.run(SETTLING_TICKS);
    followed.compare();
    assert_eq!(followed.state(), State::Armed);
    // In an empty end-feel somebody says that it hurts.
    assert_eq!(silent, ["end-feel-empty"]);
    println!("{} ticks are the same to the bit", followed.compared);
}
