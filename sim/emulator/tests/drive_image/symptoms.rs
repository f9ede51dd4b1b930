//! Cost of symptoms on the target, each by itself and together, on a shaft that is
//! moved so that everything happens to them.

use crate::actuator;
use crate::book::on_record;
use crate::budget::TICK_CYCLES;
use crate::host::{Flash, Host, image, is_long, judged, scene_of};
use crate::tasks::RENDER;
use crepitus_emulator::Time;
use crepitus_emulator::cycles::Cycles;
use crepitus_emulator::mcu::{Step, Watch};
use crepitus_model::render::effects;
use crepitus_protocol::host::{Answer, Operation};
use crepitus_protocol::telemetry::{BLOCK_SAMPLES, SampleFlags};
use crepitus_protocol::{Revision, Values, parameters};
use crepitus_scene::Scene;
use crepitus_scene::values::values;
use std::fmt::Write as _;
use std::ops::Range;

/// The shaft rests until it is armed, then it turns to 12° and back, again and again: its
/// velocity is a triangle.
const REST_S: f64 = 0.3;
const PERIOD_S: f64 = 0.16;
const FASTEST_RAD_S: f64 = 5.2;
pub(crate) const PERIOD_TICKS: u64 = 3_200;

/// Periods of the motion.
const PERIODS: u32 = 60;

const SCENE: &str = r#"
[solver]
kind = "exact-events"
step_s = 5e-5
precision = "f32"
[effects.crepitus]
preset = "coarse"
[effects.encoder]
[effects.motor]
[effects.drivetrain]
[effects.bone-shaping]
"#;

/// The scene with these effects, besides crepitus and bone shaping.
pub(crate) fn moving(effects: &str) -> Scene {
    let mut text = String::from(
        "version = 1\ntitle = \"Everything happens\"\nduration_s = 10.0\n\
         [motion]\nkind = \"velocity-knots\"\n",
    );
    let mut knot = |t_s: f64, omega_rad_s: f64| {
        let _ = writeln!(
            text,
            "[[motion.knots]]\nt_s = {t_s}\nomega_rad_s = {omega_rad_s}"
        );
    };
    knot(0.0, 0.0);
    knot(REST_S, 0.0);
    for period in 0..PERIODS {
        let begin_s = REST_S + f64::from(period) * PERIOD_S;
        knot(begin_s + 0.25 * PERIOD_S, FASTEST_RAD_S);
        knot(begin_s + 0.75 * PERIOD_S, -FASTEST_RAD_S);
        knot(begin_s + PERIOD_S, 0.0);
    }
    scene_of(&[&text, SCENE, effects].concat())
}

/// A symptom whose settings make everything happen to it in one period.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) symptom: &'static str,
    settings: &'static str,
    /// Phases that it has to go through.
    pub(crate) phases: &'static [&'static str],
    /// The most that it may add to a run of `render_torque`, cycles with 0 wait states: what
    /// was reached, where 300 were asked for.
    most_cycles: u64,
}

/// The symptoms in the order of the table, and then what has two forms in the other.
pub(crate) const CASES: [Case; 10] = [
    Case {
        name: "range-limit",
        symptom: "range-limit",
        settings: "extension_limit_deg = 3.0\nflexion_limit_deg = 9.0\ntorque_nm = 1.0\n",
        phases: &["in-the-wall", "at-its-cap"],
        most_cycles: 400,
    },
    Case {
        name: "lead-pipe",
        symptom: "lead-pipe",
        settings: "torque_nm = 0.5\nelastic_nm_per_rad = 1.0\n",
        phases: &["sliding"],
        most_cycles: 240,
    },
    Case {
        name: "cogwheel, in angle",
        symptom: "cogwheel",
        settings: "mode = \"space\"\npitch_deg = 3.0\ntorque_nm = 0.6\nelastic_nm_per_rad = 1.0\n",
        phases: &["high"],
        most_cycles: 600,
    },
    Case {
        name: "catch",
        symptom: "spasticity",
        settings: "threshold_deg = 6.0\nvelocity_shift_s = 0.01\nrearm_deg = 2.0\n",
        phases: &["caught"],
        most_cycles: 600,
    },
    Case {
        name: "clasp-knife",
        symptom: "clasp-knife",
        settings: "onset_deg = 4.0\nrelease_deg = 8.0\nrearm_deg = 2.0\n",
        phases: &["building", "fallen"],
        most_cycles: 630,
    },
    Case {
        name: "clonus",
        symptom: "clonus",
        settings: "hold_deg = 5.0\nhysteresis_deg = 1.0\ndelay_s = 0.01\nfrequency_hz = 10.0\n",
        phases: &["beating"],
        most_cycles: 510,
    },
    Case {
        name: "texture",
        symptom: "texture",
        settings: "patch_deg = 6.0\npatch_share = 0.5\n",
        phases: &["sliding"],
        most_cycles: 725,
    },
    Case {
        name: "cogwheel, in time",
        symptom: "cogwheel",
        settings: "frequency_hz = 12.0\ntorque_nm = 0.6\n",
        phases: &["high"],
        most_cycles: 580,
    },
    Case {
        name: "reflex",
        symptom: "spasticity",
        settings: "form = \"reflex\"\nthreshold_deg = 6.0\ngain_nm_per_rad = 4.0\nvelocity_shift_s = 0.1\ntorque_nm = 1.0\n",
        phases: &["reflex", "reflex-at-its-largest"],
        most_cycles: 520,
    },
    Case {
        name: "clasp-knife, by torque",
        symptom: "clasp-knife",
        settings: "trigger = \"torque\"\nrelease_torque_nm = 0.9\nonset_deg = 4.0\nrelease_deg = 8.0\nrearm_deg = 2.0\n",
        phases: &["building", "fallen"],
        most_cycles: 660,
    },
];

/// Those that are paid from the tank.
const GIVE_ENERGY: [&str; 2] = ["clonus", "reflex"];

/// Number of different symptoms in `CASES`: the first ones.
pub(crate) const SYMPTOMS: usize = effects::SYMPTOMS.len();

#[test]
fn every_symptom_has_a_case() {
    let of_table = effects::SYMPTOMS.iter().map(|(spec, _)| spec.name);
    let first = CASES[..SYMPTOMS].iter().map(|case| case.symptom);
    assert!(
        first.eq(of_table),
        "the first cases are the symptoms of the table, in its order"
    );
    for case in &CASES[SYMPTOMS..] {
        assert!(
            CASES[..SYMPTOMS]
                .iter()
                .any(|other| other.symptom == case.symptom)
        );
    }
}

/// Crepitus, bone shaping, and these.
pub(crate) fn values_of(cases: &[&Case]) -> Values {
    let effects = cases
        .iter()
        .map(|case| format!("[effects.{}]\n{}", case.symptom, case.settings));
    let effects: String = effects.collect();
    values(&moving(&effects)).expect("values")
}

/// The drive, armed on the moving shaft, without a symptom.
pub(crate) fn armed(registers: &[u32], flash: Flash) -> Option<Host> {
    let mut host = Host::timed(&image()?, &moving(""), registers, flash);
    host.arm();
    host.run_until_torque();
    Some(host)
}

/// Commits these, and runs until they are in force and have settled.
pub(crate) fn commit(host: &mut Host, values: Values) -> Revision {
    let Ok(Answer::Parameters { revision: base, .. }) = host.ask(Operation::Parameters) else {
        panic!("no parameters");
    };
    let revision = match host.ask(Operation::Commit { base, values }) {
        Ok(Answer::Committed { revision, .. }) => revision,
        other => panic!("not committed: {other:?}"),
    };
    for _ in 0..100 {
        host.run(20);
        let settled = host.blocks.last().is_some_and(|block| {
            block.revision == revision
                && block
                    .samples
                    .iter()
                    .all(|s| !s.flags.has(SampleFlags::SETTLING))
        });
        if settled {
            return revision;
        }
    }
    panic!("does not settle");
}

/// The most expensive pairs; with `CREPITUS_LONG` set all are measured.
const PAIRS: [(usize, usize); 3] = [(0, 6), (3, 6), (4, 6)];

/// Commits under all symptoms, each at another phase to the tasks.
const COMMITS: usize = 4;

/// The cycles of `render_torque`, run by run. The emulated time's own ticks begin
/// anywhere in those of the drive.
#[derive(Default)]
struct Renderings {
    cycles: Vec<u64>,
    last: Option<Time>,
}

impl Watch for Renderings {
    fn step(&mut self, step: &Step) {
        if step.exception != RENDER {
            return;
        }
        let is_next = |last| step.at - last > Time::from_us(25);
        if self.last.is_none_or(is_next) {
            self.cycles.push(0);
        }
        self.last = Some(step.at);
        if let Some(cycles) = self.cycles.last_mut() {
            *cycles += u64::from(step.cycles);
        }
    }
}

/// Tick of the emulated time.
fn tick_of(at: Time) -> u64 {
    at.units() / Time::from_us(50).units()
}

/// Cycles that a symptom or the actuator adds to each tick of a period.
pub(crate) fn added(with: &mut Host, without: &mut Host) -> Vec<u64> {
    // Both hosts at the same ticks of the same joint on the same shaft.
    let [there, here] = [&*with, &*without].map(|host| tick_of(host.board.mcu().now()));
    without.run(there - here);
    let [with, without] = [with, without].map(|host| {
        let mut renderings = Renderings::default();
        host.watch(PERIOD_TICKS, &mut renderings);
        renderings.cycles
    });
    assert_eq!(with.len(), without.len());
    assert!(with.len() as u64 >= PERIOD_TICKS);
    let added = with
        .iter()
        .zip(&without)
        .map(|(with, without)| with.saturating_sub(*without));
    added.collect()
}

#[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
pub(crate) fn mean(cycles: &[u64]) -> f64 {
    cycles.iter().sum::<u64>() as f64 / cycles.len() as f64
}

/// The first tick of the last block.
fn last_tick(host: &Host) -> u64 {
    host.blocks.last().map_or(0, |block| block.first_tick)
}

/// Breaks of the joint between two ticks: there are some.
fn breaks(host: &Host, ticks: &Range<u64>) -> Vec<u64> {
    let first = host
        .blocks
        .iter()
        .flat_map(|block| (block.first_tick..).zip(block.samples));
    let breaks =
        first.filter(|(tick, sample)| ticks.contains(tick) && sample.flags.has(SampleFlags::BREAK));
    let breaks: Vec<u64> = breaks.map(|(tick, _)| tick).collect();
    assert!(!breaks.is_empty());
    breaks
}

#[test]
fn a_symptom_adds_no_more_than_its_cycles() {
    let flash = Flash::ZeroWaitStates;
    let (Some(mut with), Some(mut without)) = (armed(&[], flash), armed(&[], flash)) else {
        return;
    };
    // Those that give energy come last: the tank, which fills up for seconds after them,
    // costs every tick until it is full.
    let (giving, other): (Vec<&Case>, Vec<&Case>) = CASES
        .iter()
        .partition(|case| GIVE_ENERGY.contains(&case.name));
    let mut beyond = Vec::new();
    for case in other.into_iter().chain(giving) {
        commit(&mut with, values_of(&[case]));
        let begin = tick_of(with.board.mcu().now());
        let added = added(&mut with, &mut without);
        let both = begin..last_tick(&with).min(last_tick(&without));
        assert_eq!(breaks(&with, &both), breaks(&without, &both));
        let worst = added.iter().max().expect("ticks");
        let what = format!("`render_torque`, more with {}", case.name);
        on_record(&what, flash, Some(mean(&added)), *worst);
        if *worst > case.most_cycles {
            beyond.push(format!("{}: {worst}", case.name));
        }
    }
    assert!(beyond.is_empty(), "{beyond:?}");
}

/// The worst tick of a period.
pub(crate) fn worst(host: &mut Host) -> u64 {
    let mut cycles = Cycles::default();
    host.watch(PERIOD_TICKS, &mut cycles);
    cycles.worst_busy_cycles()
}

#[test]
fn a_tick_with_any_two_symptoms_ends_within_it() {
    let Some(mut host) = armed(&[], Flash::ZeroWaitStates) else {
        return;
    };
    let every =
        (0..SYMPTOMS).flat_map(|first| (first + 1..SYMPTOMS).map(move |next| (first, next)));
    let pairs: Vec<(usize, usize)> = if is_long() {
        every.collect()
    } else {
        PAIRS.to_vec()
    };
    for (first, second) in pairs {
        let (first, second) = (&CASES[first], &CASES[second]);
        commit(&mut host, values_of(&[first, second]));
        let worst = worst(&mut host);
        let what = format!(
            "a tick with crepitus, a ringing bone, {} and {}",
            first.name, second.name
        );
        on_record(&what, Flash::ZeroWaitStates, None, worst);
        assert!(worst <= TICK_CYCLES, "{worst}");
    }
}

#[test]
fn a_tick_with_all_symptoms_ends_within_it() {
    for flash in judged(Flash::BOTH) {
        let Some(mut host) = armed(&[], flash) else {
            return;
        };
        let cases: Vec<&Case> = CASES.iter().take(SYMPTOMS).collect();
        let mut values = values_of(&cases);
        commit(&mut host, values);
        host.blocks.clear();
        let worst_tick = worst(&mut host);
        on_record("a tick with all symptoms", flash, None, worst_tick);
        assert!(worst_tick <= TICK_CYCLES, "{worst_tick}");
        let (id, _) = parameters::find("lead-pipe.torque_nm").expect("a parameter");
        let mut worst_commit = 0;
        for n in 0..COMMITS {
            values.set(id, [0.6, 0.5][n % 2]);
            worst_commit = worst_commit.max(worst_while_committing(&mut host, values));
            host.run(437);
        }
        let what = format!("a tick with all symptoms, while one of {COMMITS} commits arrives");
        on_record(&what, flash, None, worst_commit);
        assert!(worst_commit <= TICK_CYCLES, "{worst_commit}");
        let samples = host.blocks.iter().flat_map(|block| block.samples);
        let late = samples
            .filter(|sample| sample.flags.has(SampleFlags::LATE))
            .count();
        assert_eq!(late, 0);
    }
}

/// A million ticks with `CREPITUS_LONG` set.
#[test]
fn no_sample_is_late_with_all_symptoms_and_commits() {
    let cases: Vec<&Case> = CASES.iter().take(SYMPTOMS).collect();
    if let Some(mut host) = armed(&[], Flash::Modelled) {
        late_samples("all symptoms", &mut host, values_of(&cases));
    }
}

/// As with all symptoms.
#[test]
fn no_sample_is_late_with_ringing_actuator_and_commits() {
    if let Some(mut host) = actuator::with_actuator(&[], Flash::Modelled) {
        let name = "crepitus, a ringing bone and the actuator";
        late_samples(name, &mut host, actuator::on());
    }
}

/// Everything that a drive can do at once: no combination is too much, so a commit refuses none for its cycles.
#[test]
fn no_sample_is_late_with_everything_at_once_and_commits() {
    let Some(mut host) = actuator::with_actuator(&[], Flash::Modelled) else {
        return;
    };
    let cases: Vec<&Case> = CASES.iter().take(SYMPTOMS).collect();
    let symptoms = values_of(&cases);
    let mut values = actuator::on();
    for parameter in &parameters::PARAMETERS {
        if cases.iter().any(|case| case.symptom == parameter.group) {
            values.set(parameter.id, symptoms.get(parameter.id).expect("a value"));
        }
    }
    values.set(parameters::id::COMPENSATION, 1.0);
    late_samples("everything", &mut host, values);
}

/// One commit after another, each at another phase to the tasks and to the joint: no sample is late, none lost.
fn late_samples(name: &str, host: &mut Host, mut values: Values) {
    let ticks = if is_long() { 1_000_000 } else { 10_000 };
    let (id, _) = parameters::find("crepitus.static_torque_nm").expect("a parameter");
    let usual = values.get(id).expect("a value");
    let (mut samples, mut commits, mut next_tick) = (0, 0, None);
    host.blocks.clear();
    while samples < ticks {
        values.set(id, usual - [0.02, 0.0][commits % 2]);
        commit(host, values);
        commits += 1;
        host.run(437);
        for block in host.blocks.drain(..) {
            let expected = next_tick.unwrap_or(block.first_tick);
            assert_eq!(block.first_tick, expected, "a block is missing: {name}");
            next_tick = Some(block.first_tick + BLOCK_SAMPLES as u64);
            for (tick, sample) in (block.first_tick..).zip(&block.samples) {
                let flags = SampleFlags::LATE | SampleFlags::LOST;
                assert!(!sample.flags.has(flags), "{name}: tick {tick}");
            }
            samples += BLOCK_SAMPLES;
        }
    }
    println!("{name}: {samples} samples and {commits} commits, none late");
}

/// The worst tick while a commit arrives and takes effect.
fn worst_while_committing(host: &mut Host, values: Values) -> u64 {
    let Ok(Answer::Parameters { revision: base, .. }) = host.ask(Operation::Parameters) else {
        panic!("no parameters");
    };
    host.request(Operation::Commit { base, values });
    let mut cycles = Cycles::default();
    // The idle loop has an eighth of a tick to prepare it.
    host.watch(1200, &mut cycles);
    let now = host.blocks.last().expect("a block").revision;
    assert_ne!(now, base, "not applied");
    cycles.worst_busy_cycles()
}
