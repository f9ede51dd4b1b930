//! Motions and limits that meet where no step ends.

use super::symptom_energy::springs;
use super::symptom_tools::{DEVICE, SYMPTOM, armed, lasting, renders_symptoms, times, wander};
use super::tools::{CASE, TICK_S, is_frozen, scene};
use crate::stability::case::Case;
use crate::stability::criteria::{
    EVENTS, exactly, first_word, springs_return, symptom_events, symptom_torques, torque,
};
use crate::stability::criterion::{Criterion, Limits};
use crate::stability::input::{Input, SymptomRun};
use crate::stability::subject::Rung;
use crepitus_model::Convention;
use crepitus_model::render::effects::symptom::Word;
use crepitus_scene::scene::Precision;

/// Events and torque of the reference at the ends of steps that a bare solver splits: within f64, and f32 whose play
/// keeps no place within a step.
fn as_solved() -> [Criterion; 2] {
    [
        symptom_events(Limits(1e-8, 2e-5)),
        symptom_torques(Limits(1e-4, 2e-2)),
    ]
}

/// A motion with an effect, which the reference solves, too.
fn solved(
    what: &'static str,
    [motion, effect]: [&str; 2],
    column: &'static str,
    duration_s: f64,
) -> Input {
    let text = [motion, effect].concat();
    Input::new(scene(what, &text, column, true), duration_s, TICK_S)
}

/// A hand that is torn along within a step, and let go within another.
const TORN: &str = "[motion]\nkind = \"velocity-knots\"\nfrom_deg = 40.0\nknots = [\n\
                    { t_s = 0.0, omega_rad_s = 0.001 },\n\
                    { t_s = 0.10003, omega_left_rad_s = 0.001, omega_right_rad_s = 0.35 },\n\
                    { t_s = 0.1009, omega_rad_s = 0.35 },\n\
                    { t_s = 0.20001, omega_left_rad_s = 0.35, omega_right_rad_s = 0.001 }]\n";

const STROKES: &str = "[motion]\nkind = \"strokes\"\nfrom_deg = 15.0\nto_deg = 100.0\npeak_speed_deg_s = 163.7\n\
                       pause_s = 0.12345\n";

const MOVING: &str = "[motion]\nkind = \"velocity-knots\"\nfrom_deg = 80.0\nknots = [\n\
                      { t_s = 0.0, omega_rad_s = 2.0 },\n\
                      { t_s = 0.21003, omega_rad_s = 1.0 },\n\
                      { t_s = 0.4, omega_rad_s = -1.0 }]\n";

/// The cases of this theme.
pub(super) const CASES: &[Case] = &[
    Case {
        id: "H89",
        name: "jump-off-grid",
        title: "The velocity jumps within a step",
        hard: "A step that draws a line over the jump moves the joint in another way than the hand did: ten events in the place \
               of three, and a reflex that begins half a step late. The step is split where the motion breaks.",
        source: "docs/model.md, Inside a step; the events of the reference",
        of: |subject| subject.convention == Convention::Paper || renders_symptoms(subject),
        trials: |subject| {
            let torn = |what, effect, column| solved(what, [TORN, effect], column, 0.5);
            if subject.convention == Convention::Paper {
                let joint = torn(
                    "the paper's joint, torn along at 0.10003 s and let go at 0.20001 s",
                    "[effects.crepitus]\nconvention = \"paper\"\n",
                    "torque_nm",
                );
                return vec![joint.meets([exactly(EVENTS, 3)])];
            }
            let reflex = torn(
                "a reflex, torn along at 0.10003 s and let go at 0.20001 s",
                "[effects.spasticity]\nform = \"reflex\"\nthreshold_deg = 40.0\ngain_nm_per_rad = 0.5\n",
                "spasticity_nm",
            );
            let texture = torn(
                "a texture, torn along at 0.10003 s and let go at 0.20001 s",
                "[effects.texture]\nirregularity = 0.0\npitch_deg = 0.5\npeak_nm = 0.6\n",
                "texture_nm",
            );
            vec![reflex.meets(as_solved()), texture.meets(as_solved())]
        },
        ..CASE
    },
    Case {
        id: "H90",
        name: "two-limits",
        title: "A play that meets its limit in the tick in which it is released",
        hard: "The torque rises along σ, bends at the envelope, and reaches the torque of the release, all within 50 µs. A release \
               that is found on the straight line between the tick's ends is 15 µs late and 1.6 mN·m off.",
        source: "docs/symptoms.md, clasp-knife; the release of the reference, 0.173 959 245 s",
        trials: |_| {
            let motion = "[motion]\nkind = \"velocity-knots\"\nfrom_deg = 59.027348\nknots = [\n\
                          { t_s = 0.0, omega_rad_s = 0.0 },\n\
                          { t_s = 0.25, omega_rad_s = 0.966673 },\n\
                          { t_s = 0.35, omega_rad_s = 0.0 }]\n";
            let effect = "[effects.clasp-knife]\nrelease_deg = 54.482214\nslope_nm_per_rad = 4.796518\n\
                          residual_share = 0.151571\nrelease_torque_nm = 3.510394\nmuscles = \"extensors\"\n\
                          trigger = \"torque\"\n";
            let what = "a clasp-knife released by torque, armed beyond its onset";
            let [events, torques] = as_solved();
            let release = first_word(Word::Release, 0.173_959_245_15, Limits(1e-8, 2e-5));
            let input = solved(what, [motion, effect], "clasp_knife_nm", 0.4);
            vec![input.meets([events, torques, release])]
        },
        ..SYMPTOM
    },
    Case {
        id: "H91",
        name: "clock-in-a-pause",
        title: "Teeth in time while the hand pauses, and muscles whose clock runs on",
        hard: "The clock of the teeth, of a fallen limit and of a beat goes on while the hand rests, and the rest begins and ends \
               within a step. A clock that is counted in whole steps moves each of these, one that stops with the hand loses them.",
        source: "docs/symptoms.md, cogwheel, clasp-knife, clonus; the events of the reference",
        trials: |_| {
            let stroked = |what, effect, column| solved(what, [STROKES, effect], column, 3.0);
            let teeth = stroked(
                "strokes with pauses of 0.12345 s, teeth of 7.3 Hz in time",
                "[effects.cogwheel]\nmode = \"time\"\nfrequency_hz = 7.3\n",
                "cogwheel_nm",
            );
            let knife = stroked(
                "strokes with pauses of 0.12345 s, a clasp-knife that falls in 0.3 s",
                "[effects.clasp-knife]\ncollapse_s = 0.3\nresidual_share = 0.0\n",
                "clasp_knife_nm",
            );
            let armed_again = stroked(
                "strokes with pauses of 0.12345 s that only come to where it is armed again",
                "[effects.clasp-knife]\nrearm_deg = 15.0\n",
                "clasp_knife_nm",
            );
            let clonus = stroked(
                "strokes with pauses of 0.12345 s, clonus of 5.1 Hz",
                "[effects.clonus]\nhold_deg = 60.0\nfrequency_hz = 5.1\namplitude_nm = 0.02\n",
                "clonus_nm",
            );
            let again = [(Word::Rearm, 1), (Word::Onset, 2), (Word::Release, 2)];
            vec![
                teeth.meets(as_solved()),
                knife.meets(as_solved()),
                armed_again.meets(again.map(|(word, count)| times(word, count))),
                clonus.meets(as_solved()),
            ]
        },
        ..SYMPTOM
    },
    Case {
        id: "H92",
        name: "armed-beyond",
        title: "Armed on a moving joint beyond the threshold, at an edge, in a wall",
        hard: "Before the start nothing was asked for, and the first step begins beyond the threshold: an input that jumps at t = 0, \
               a play that must begin without torque, an event at 0 that is neither lost nor told twice.",
        source: "docs/symptoms.md; the events of the reference",
        trials: |subject| {
            // On an edge the place of a joint in f32 is rounded to either side.
            let teeth = match subject.precision {
                Precision::F64 => (
                    "teeth in space of 20°, on an edge",
                    "[effects.cogwheel]\nmode = \"space\"\npitch_deg = 20.0\n",
                    "cogwheel_nm",
                ),
                Precision::F32 => (
                    "teeth in space of 19°",
                    "[effects.cogwheel]\nmode = \"space\"\npitch_deg = 19.0\n",
                    "cogwheel_nm",
                ),
            };
            [
                teeth,
                (
                    "a reflex",
                    "[effects.spasticity]\nform = \"reflex\"\ngain_nm_per_rad = 0.5\n",
                    "spasticity_nm",
                ),
                (
                    "a catch",
                    "[effects.spasticity]\nform = \"catch\"\n",
                    "spasticity_nm",
                ),
                ("a clasp-knife", "[effects.clasp-knife]\n", "clasp_knife_nm"),
                (
                    "an end of the range",
                    "[effects.range-limit]\nflexion_limit_deg = 75.0\n",
                    "range_limit_nm",
                ),
                (
                    "rigidity, pulled to 20°",
                    "[effects.lead-pipe]\nelastic_nm_per_rad = 2.0\nneutral_deg = 20.0\n",
                    "lead_pipe_nm",
                ),
            ]
            .map(|(what, effect, column)| {
                solved(what, [MOVING, effect], column, 0.5).meets(as_solved())
            })
            .into()
        },
        ..SYMPTOM
    },
    Case {
        id: "H93",
        name: "longer-than-a-pitch",
        title: "A step in which the joint passes more than one asperity",
        hard: "At 400 deg/s a step of 2 ms passes two asperities of 0.4°. The snaps within it cannot be told apart, and a run says so; \
               the torque must stay between base and peak, and the joint must not fall behind.",
        source: "docs/symptoms.md, texture",
        trials: |_| {
            let text = "[motion]\nkind = \"sine\"\nfrom_deg = 60.0\namplitude_deg = 40.0\nfrequency_hz = 1.6\n\
                        [effects.texture]\nbase_nm = 0.3\npeak_nm = 0.6\npitch_deg = 0.4\nwidth_share = 0.5\n";
            let what = "a texture of 0.4° at up to 402 deg/s in steps of 2 ms";
            let input = Input::new(scene(what, text, "texture_nm", false), 2.0, 2e-3);
            vec![input.meets([torque(0.0, -0.6, 0.6, 1e-6)])]
        },
        ..DEVICE
    },
    Case {
        id: "H94",
        name: "delay-varies",
        title: "Random hands on a play whose torque is late by another number of ticks each time",
        hard: "A late torque gives energy: the same torque late by two ticks on the way in and by none on the way out more than any \
               constant delay. What returns stays within the spring's energy and that of sampling at the longest delay.",
        source: "docs/symptoms.md, The play: E ≤ T₀²/2σ + (½ + d)·σ·h·∫Ω² dt, d the most",
        trials: |_| {
            let mut trials = Vec::new();
            for given in springs() {
                for seed in 1..=2 {
                    let run = SymptomRun {
                        delay_ticks: 2,
                        delay_varies: true,
                        ..armed(&given, wander(60.0, 200.0, seed))
                    };
                    trials.push(lasting(run, 4.0).meets([springs_return(1.0)]));
                }
            }
            trials
        },
        ..DEVICE
    },
    Case {
        id: "H95",
        name: "tremble-in-the-gap",
        title: "A leg that trembles across the gear's gap",
        hard: "At 9 Hz the rotor crosses a gap of 1° with every swing and meets its other side: eighteen impacts a second, each plastic, \
               at a moment within a step. Energy that an impact makes, or a rotor that is left beyond the side that it met, drives the leg.",
        source: "docs/effects.md, How it is stepped; what an impact takes is in the balance",
        of: |subject| is_frozen(subject) && subject.solver != Rung::Reference,
        trials: |_| {
            let text = "[motion]\nkind = \"sine\"\namplitude_deg = 1.5\nfrequency_hz = 9.0\n\
                        [effects.crepitus]\npreset = \"coarse\"\n[effects.encoder]\n[effects.motor]\n[effects.drivetrain]\n\
                        [effects.backlash]\n[effects.cuff]\n";
            let what = "crepitus behind encoder, motor, gear with a gap of 1° and cuff, on a leg that trembles by 1.5° at 9 Hz";
            let input = Input::new(scene(what, text, "torque_nm", false), 2.0, TICK_S);
            vec![input.meets([torque(0.0, -0.4, 0.4, 4e-6)])]
        },
        ..CASE
    },
];
