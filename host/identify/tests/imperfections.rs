//! Coverage of the 95 % intervals on braces that have what the estimator's model leaves out, one family of
//! imperfections at a time.
//!
//! `CREPITUS_LONG=1 cargo test -p crepitus-identify --test imperfections -- --nocapture` draws three braces of each
//! family (`CREPITUS_FAMILY=teeth` of these alone); without the variable it is one of each.

mod compared;
mod imperfect;

use compared::{Compared, PAGE, compared};
use crepitus_identify::brace::{
    Brace, Measured, Quantity, Refusal, TORQUE_DEVIATION, Weight, identify,
};
use imperfect::{Friction, Imperfect};

/// A family of braces.
struct Family {
    name: &'static str,
    /// Words in which the first of them, without torque, is named.
    named: &'static [&'static str],
    /// Turns a perfect brace into one of the family.
    of: fn(Imperfect, &mut fastrand::Rng) -> Imperfect,
}

const FAMILIES: [Family; 11] = [
    Family {
        name: "none",
        named: &[],
        of: |it, _| it,
    },
    Family {
        name: "bristles of 5e4",
        named: &[],
        of: |it, _| Imperfect {
            friction: Friction::Microslip(5e4),
            ..it
        },
    },
    Family {
        name: "bristles of 2e4",
        named: &[],
        of: |it, _| Imperfect {
            friction: Friction::Microslip(2e4),
            ..it
        },
    },
    Family {
        name: "bristles of 8e3",
        named: &[],
        of: |it, _| Imperfect {
            friction: Friction::Microslip(8e3),
            ..it
        },
    },
    Family {
        name: "Stribeck",
        named: &["misfit of Coulomb's friction"],
        of: |it, random| {
            let share = 0.1 + 0.4 * random.f64();
            Imperfect {
                friction: Friction::Stribeck(share, 0.05 + 0.25 * random.f64()),
                ..it
            }
        },
    },
    Family {
        name: "friction by angle",
        named: &["it changes with the angle by"],
        of: |it, random| {
            let periods = f64::from(random.u32(1..=4));
            let phase = std::f64::consts::TAU * random.f64();
            Imperfect {
                friction: Friction::ByAngle(0.1, periods, phase),
                ..it
            }
        },
    },
    Family {
        name: "teeth of 8e3",
        named: &[],
        of: |it, _| Imperfect {
            teeth_nm: 8e3,
            ..it
        },
    },
    Family {
        name: "teeth of 3e3",
        named: &[],
        of: |it, _| Imperfect {
            teeth_nm: 3e3,
            ..it
        },
    },
    Family {
        name: "teeth of 1e3",
        named: &[],
        of: |it, _| Imperfect {
            teeth_nm: 1e3,
            ..it
        },
    },
    Family {
        name: "encoder scale",
        named: &["misfit of the whole model"],
        of: |it, random| Imperfect {
            encoder_scale: if random.bool() {
                86.0 / 84.0
            } else {
                84.0 / 86.0
            },
            ..it
        },
    },
    Family {
        name: "no cuffs",
        named: &["misfit of the whole model"],
        of: |it, _| Imperfect { cuffs: None, ..it },
    },
];

fn truth(it: &Imperfect, quantity: Quantity) -> f64 {
    match quantity {
        // Over the swing, if it changes with the angle.
        Quantity::Friction => it.mean_friction_nm(),
        Quantity::LoadLoss => it.load_loss,
        Quantity::Viscous => it.viscous_nms,
        Quantity::RotorInertia => it.rotor_kg_m2,
        Quantity::BraceInertia => it.brace_kg_m2,
        Quantity::Backlash => it.gap_rad.to_degrees(),
        // Of cuffs and links in series, as the motor sees them.
        Quantity::CuffStiffness => it
            .cuffs
            .map_or(f64::INFINITY, |cuffs| it.in_series(cuffs).0),
        Quantity::CuffDamping => it
            .cuffs
            .map_or(f64::INFINITY, |cuffs| it.in_series(cuffs).1),
        Quantity::TorqueConstant => 3.3 / 86.0,
    }
}

/// Results of a family's braces.
#[derive(Default)]
struct Outcome {
    values: Vec<Compared>,
    refused: usize,
    named: usize,
    notes: Vec<String>,
}

fn identified(
    it: &Imperfect,
    is_armed: bool,
    random: &mut fastrand::Rng,
) -> Result<Brace, Refusal> {
    let mut recordings = vec![it.recorded(random)];
    if is_armed {
        recordings.push(it.armed().recorded(random));
    }
    let mut normal = || (0..12).map(|_| random.f64()).sum::<f64>() - 6.0;
    let mut measured = |value: f64, deviation: f64| Measured {
        value: value * (1.0 + deviation * normal()),
        deviation,
    };
    let weight = Weight {
        moment_nm: measured(it.moment_nm, 0.005),
        inertia_kg_m2: measured(it.weight_kg_m2, 0.01),
    };
    identify(&recordings, &weight, TORQUE_DEVIATION, &mut |_| true)
}

fn family(family: &Family, braces: u64, is_armed: bool) -> Outcome {
    const SEED: u64 = 7_000;
    let mut outcome = Outcome::default();
    for number in 0..braces {
        let mut random = fastrand::Rng::with_seed(SEED + number);
        let it = (family.of)(Imperfect::drawn(&mut random), &mut random);
        match identified(&it, is_armed, &mut random) {
            Err(refusal) => {
                println!("{}, {number}: {refusal}", family.name);
                outcome.refused += 1;
                outcome.notes.push(refusal.to_string());
            }
            Ok(brace) => {
                let title = format!("{}, {number}", family.name);
                outcome
                    .values
                    .extend(compared(&title, &brace, |quantity| truth(&it, quantity)));
                brace
                    .notes
                    .iter()
                    .for_each(|note| println!("  note: {note}"));
                outcome.named +=
                    usize::from(brace.notes.iter().any(|note| note.contains("misfit")));
                outcome.notes.extend(brace.notes.iter().cloned());
            }
        }
    }
    outcome
}

/// Released without torque, and with, each in a thread.
fn both(one: &Family, braces: u64) -> [Outcome; 2] {
    std::thread::scope(|scope| {
        [false, true]
            .map(|is_armed| scope.spawn(move || family(one, braces, is_armed)))
            .map(|thread| thread.join().expect("a family"))
    })
}

fn inside(outcomes: &[Outcome]) -> (usize, usize) {
    let values = outcomes.iter().flat_map(|outcome| &outcome.values);
    let holds = values.clone().filter(|value| value.holds()).count();
    (holds, values.count())
}

/// In the long mode; the page has its numbers.
#[test]
fn intervals_cover_what_the_model_leaves_out() {
    const BRACES: u64 = 3;
    if std::env::var_os("CREPITUS_LONG").is_none() {
        return;
    }
    let only = std::env::var("CREPITUS_FAMILY").ok();
    let head = [
        "| | inside, of those visible: without torque | with | refused, of 6 | named, of 6 |",
        "|---|---|---|---|---|",
    ];
    let mut rows = Vec::new();
    let (mut held, mut visible) = (0, 0);
    let wanted = |one: &&Family| {
        only.as_ref()
            .is_none_or(|only| one.name.contains(only.as_str()))
    };
    for one in FAMILIES.iter().filter(wanted) {
        let outcomes = both(one, BRACES);
        let [disarmed, armed] = outcomes
            .each_ref()
            .map(|outcome| inside(std::slice::from_ref(outcome)));
        let sum = |of: fn(&Outcome) -> usize| outcomes.iter().map(of).sum::<usize>();
        rows.push(format!(
            "| {} | {} of {} | {} of {} | {} | {} |",
            one.name,
            disarmed.0,
            disarmed.1,
            armed.0,
            armed.1,
            sum(|outcome| outcome.refused),
            sum(|outcome| outcome.named)
        ));
        println!("{}", rows[rows.len() - 1]);
        let (holds, all) = inside(&outcomes);
        assert!(
            100 * holds >= 85 * all || sum(|outcome| outcome.named) > 3,
            "{}: {holds} of {all}",
            one.name
        );
        (held, visible) = (held + holds, visible + all);
    }
    assert!(100 * held >= 93 * visible, "{held} of {visible}");
    let head = head.map(str::to_owned);
    let names = FAMILIES.each_ref().map(|family| family.name);
    PAGE.hold_rows("imperfections", &head, &rows, &names);
}

/// Families that stand for an imperfection in the short mode.
const SHORT: [&str; 7] = [
    "none",
    "no cuffs",
    "teeth of 1e3",
    "friction by angle",
    "bristles of 8e3",
    "encoder scale",
    "Stribeck",
];

/// One brace of each of these families, released without torque.
#[test]
fn an_imperfection_is_within_the_intervals_or_named() {
    let of_name = |name: &&str| FAMILIES.iter().find(|one| one.name == *name);
    let families: Vec<&Family> = SHORT.iter().filter_map(of_name).collect();
    assert_eq!(families.len(), SHORT.len());
    let outcomes: Vec<(&Family, Outcome)> = std::thread::scope(|scope| {
        let halves = families.chunks(families.len().div_ceil(2));
        let threads: Vec<_> = halves
            .map(|half| {
                let each = |one: &&'static Family| (*one, family(one, 1, false));
                scope.spawn(move || half.iter().map(each).collect::<Vec<_>>())
            })
            .collect();
        let found = threads.into_iter();
        found
            .flat_map(|thread| thread.join().expect("families"))
            .collect()
    });
    for (one, outcome) in outcomes {
        let notes = outcome.notes.join("\n");
        let (holds, all) = inside(std::slice::from_ref(&outcome));
        println!("{}: {holds} of {all}\n{notes}", one.name);
        assert!(
            all >= 3 && (holds == all || notes.contains("misfit of")),
            "{}: {holds} of {all}\n{notes}",
            one.name
        );
        for words in one.named {
            assert!(notes.contains(words), "{}: {words}\n{notes}", one.name);
        }
        // None that is not there.
        assert!(
            !one.named.is_empty() || !notes.contains("misfit of"),
            "{}: {notes}",
            one.name
        );
    }
}
