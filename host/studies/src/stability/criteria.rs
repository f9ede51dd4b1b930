//! The criteria: what each asks for in words, and its check.

use super::criterion::{BOUND_SLACK, Basis, Criterion, Evidence, Limits};
use super::input::Input;
use super::observation::{ActuatorPart, Hash, Observation, Tally};
use super::parameter_changes::SLEW_NM_PER_S;
use super::text::{Plain, Time};
use super::verdict::{Failure, Verdict};
use crate::event_errors::EventErrors;
use crate::matching::{Matching, match_events};
use crate::true_events::TimedEvent;
use crepitus_model::{EventKind, Real};
use crepitus_plant::Extremes;

mod symptoms;

pub(super) use symptoms::{
    first_word, net_returned, springs_return, symptom_events, symptom_torques, word_count, words,
};

/// Factor of the cycle rate beyond which it is another motion.
const ANOTHER_MOTION: f64 = 2.0;

/// Events that are counted: their name and their number.
pub(super) type Counted = (&'static str, fn(&Tally) -> u64);
pub(super) const EVENTS: Counted = ("events", Tally::events);
pub(super) const BREAKS: Counted = ("breaks", |tally| tally.breaks);
pub(super) const REVERSES: Counted = ("reverses", |tally| tally.reverses);

/// Measured quantity of the vibration actuator: its name, its unit and its value.
pub(super) type Measure = (&'static str, &'static str, fn(&ActuatorPart) -> f64);
pub(super) const ACCELERATION: Measure = ("the shell's acceleration", "m/s² rms", |p| {
    p.rms(p.acceleration_squares)
});
pub(super) const EXCURSION: Measure = ("the mass's excursion", "mm", |p| 1e3 * p.excursion_m);
pub(super) const VOLTAGE: Measure = ("the coil's voltage", "V", |p| p.volts);
pub(super) const VOLTAGE_STEP: Measure = ("a step of the coil's voltage", "V", |p| p.volts_a_tick);
pub(super) const CURRENT: Measure = ("the coil's current", "A rms", |p| p.rms(p.current_squares));
pub(super) const SHAFT_SPEED: Measure = ("the shaft's speed", "rad/s", |p| p.shaft_rad_s);
/// Largest gain of the loop from the actuator to the encoder and back.
pub(super) const LOOP_GAIN: Measure = ("the loop gain", "at gain 1", |p| p.loop_gain);
/// Beyond its reciprocal the loop oscillates.
pub(super) const LOOP_IN_PHASE: Measure =
    ("the loop gain in phase", "at gain 1", |p| p.loop_in_phase);

/// A measured number is at most a limit.
fn number(
    text: String,
    limits: impl Into<Limits>,
    unit: &'static str,
    measured: impl Fn(&Observation) -> f64 + 'static,
) -> Criterion {
    let limits = limits.into();
    Criterion::new(text, move |e| {
        Verdict::of(measured(e.seen), limits.of(e), unit)
    })
}

/// A limit that ends the text: in a unit, or as a share of what the text names.
fn most(
    text: &str,
    limits: impl Into<Limits>,
    unit: &'static str,
    measured: impl Fn(&Observation) -> f64 + 'static,
) -> Criterion {
    let limits = limits.into();
    let of_it = if unit.is_empty() { " of it" } else { "" };
    let text = format!("{text} {}{of_it}", limits.in_unit(unit));
    number(text, limits, unit, measured)
}

/// A number whose distance from its limit says nothing as long as it keeps it.
fn met_or(measured: f64, limit: f64, unit: &'static str) -> Verdict {
    if measured <= limit {
        Verdict::MET
    } else {
        Verdict::of(measured, limit, unit)
    }
}

fn met_if(is_met: bool, otherwise: &'static str) -> Verdict {
    if is_met {
        Verdict::MET
    } else {
        Verdict::broken(otherwise)
    }
}

/// Other events than the expected ones.
fn other_events(found: u64, expected: u64) -> Verdict {
    if found == expected {
        Verdict::broken("other events in the same number")
    } else {
        Verdict::fails(Failure::OtherEvents { found, expected }, None)
    }
}

fn between(found: u64, least: u64, most: u64) -> Verdict {
    match found {
        found if found < least => other_events(found, least),
        found if found > most => other_events(found, most),
        _ => Verdict::MET,
    }
}

/// `3`, or `3 to 5`.
fn span(least: u64, most: u64) -> String {
    if least == most {
        most.to_string()
    } else {
        format!("{least} to {most}")
    }
}

fn whole(count: usize) -> u64 {
    u64::try_from(count).unwrap_or(u64::MAX)
}

/// The nearest count; negative and NaN give 0.
fn nearest(count: f64) -> u64 {
    (count + 0.5).whole()
}

/// The common bounds, and nothing else.
pub(super) fn survives() -> Criterion {
    // In every slip the torque is at its limit.
    Criterion::new("finite, |T| ≤ Ts", |e| {
        met_or(e.seen.peak, 1.0 + BOUND_SLACK, "")
    })
}

/// The true events and their partners.
fn partners(e: &Evidence<'_>) -> (Vec<TimedEvent>, Matching) {
    let truth: Vec<TimedEvent> = e.truth.iter().map(|t| t.event).collect();
    let matching = match_events(&truth, &e.seen.events, e.seen.step_s, e.seen.duration_s());
    (truth, matching)
}

/// The true events in their order, each within a tolerance.
pub(super) fn events(within_s: impl Into<Limits>) -> Criterion {
    let limits = within_s.into();
    let within = limits.in_unit("s");
    let text = format!("same events as the reference, each within {within}");
    Criterion::new(text, move |e| {
        let (truth, matching) = partners(e);
        let found = e.seen.tally.events();
        let kept_all = whole(e.seen.events.len()) == found;
        if matching.unmatched > 0 || !kept_all {
            return other_events(found, whole(truth.len()));
        }
        let worst_s = match matching.pairs.as_slice() {
            [] => 0.0,
            _ => EventErrors::new(&truth, &e.seen.events, &matching).max_s,
        };
        Verdict::of(worst_s, limits.of(e), "s")
    })
    .on(Basis::Truth)
}

/// The torque just after each event is the true one.
pub(super) fn event_torques(within_nm: impl Into<Limits>) -> Criterion {
    let limits = within_nm.into();
    let within = limits.in_unit("N·m");
    let text = format!("torque after each event that of the reference within {within}");
    Criterion::new(text, move |e| {
        let pairs = partners(e).1.pairs.into_iter();
        let errors_nm = pairs.filter_map(|(i, j)| {
            let torque_nm = e.seen.torques_after_nm.get(j)?;
            Some((torque_nm - e.truth.get(i)?.torque_after_nm).abs())
        });
        Verdict::of(errors_nm.fold(0.0, f64::max), limits.of(e), "N·m")
    })
    .on(Basis::Truth)
}

/// Number of events.
pub(super) fn count((name, of): Counted, least: u64, most: u64) -> Criterion {
    Criterion::new(format!("{} {name}", span(least, most)), move |e| {
        between(of(&e.seen.tally), least, most)
    })
}

/// Exactly this number of events.
pub(super) fn exactly(what: Counted, number: u64) -> Criterion {
    count(what, number, number)
}

pub(super) fn events_per_step(most: u32) -> Criterion {
    Criterion::new(format!("at most {most} events in a step"), move |e| {
        met_if(e.seen.tally.most_in_step <= most, "chatter within a step")
    })
    .on(Basis::Steps)
}

/// Rate over the whole run.
pub(super) fn events_per_second(most: f64) -> Criterion {
    let text = format!("at most {} events per second", Plain(most));
    Criterion::new(text, move |e| {
        let (found, duration_s) = (e.seen.tally.events(), e.seen.duration_s());
        if f64::from_whole(found) / duration_s > most {
            let expected = nearest(most * duration_s);
            return Verdict::fails(Failure::OtherEvents { found, expected }, None);
        }
        Verdict::MET
    })
}

/// The frequency of breaks is that of the closed form, Hz.
pub(super) fn cycle_rate(hz: f64, within: impl Into<Limits>) -> Criterion {
    let limits = within.into();
    let within = limits.in_unit("");
    let text = format!("{hz:.6} cycles per second within {within} of it");
    Criterion::new(text, move |e| {
        let (tally, expected) = (&e.seen.tally, hz * e.seen.duration_s());
        // A count of few cycles is too coarse.
        let share = tally.cycles.count() / (expected - 1.0).max(1.0);
        match tally.cycles.mean() {
            Some(mean_s) if share * ANOTHER_MOTION >= 1.0 && share <= ANOTHER_MOTION => {
                Verdict::of((1.0 / (mean_s * hz) - 1.0).abs(), limits.of(e), "")
            }
            _ => {
                let (found, expected) = (tally.events(), nearest(2.0 * expected));
                Verdict::fails(Failure::OtherEvents { found, expected }, None)
            }
        }
    })
}

/// Standard deviation of the time from break to break, relative to its mean.
pub(super) fn interval_variation(most: f64) -> Criterion {
    let number = Plain(most);
    let text = format!("standard deviation from break to break at most {number} of its mean");
    Criterion::new(text, move |e| match e.seen.tally.cycles.variation() {
        Some(variation) => Verdict::of(variation, most, ""),
        None => Verdict::broken("no cycles"),
    })
}

/// Every slip lasts this long.
pub(super) fn slip_time(slip_s: f64, within: impl Into<Limits>) -> Criterion {
    let limits = within.into();
    let (slip_ms, within) = (slip_s * 1e3, limits.in_unit(""));
    let text = format!("every slip lasts {slip_ms:.6} ms within {within} of it");
    Criterion::new(text, move |e| {
        let tally = &e.seen.tally;
        if tally.sticks == 0 {
            return Verdict::broken("no slip ends");
        }
        let off_s = (tally.slips.high - slip_s).max(slip_s - tally.slips.low);
        Verdict::of(off_s / slip_s, limits.of(e), "")
    })
}

pub(super) fn silent_after(time_s: f64) -> Criterion {
    Criterion::new(format!("no event after {}", Time(time_s)), move |e| {
        met_or(e.seen.tally.last_s.unwrap_or(0.0), time_s, "s")
    })
}

/// From a time on the torque stays in a band, but for a tolerance.
pub(super) fn torque(from_s: f64, low_nm: f64, high_nm: f64, slack_nm: f64) -> Criterion {
    let [low, high, slack] = [low_nm, high_nm, slack_nm].map(Plain);
    let from = if from_s > 0.0 {
        format!(" from {} on", Time(from_s))
    } else {
        String::new()
    };
    let text = format!("torque in [{low}, {high}] ± {slack} N·m{from}");
    late_torque(text, from_s, slack_nm, move |range| {
        (range.high - high_nm).max(low_nm - range.low).max(0.0)
    })
}

/// From a time on the torque moves by so much at most, from its lowest to its highest.
pub(super) fn torque_quiet(from_s: f64, most_nm: f64) -> Criterion {
    let (most, from) = (Plain(most_nm), Time(from_s));
    let text = format!("torque moves by at most {most} N·m from {from} on");
    late_torque(text, from_s, most_nm, |range| range.width())
}

fn late_torque(
    text: String,
    from_s: f64,
    most_nm: f64,
    measured: impl Fn(Extremes<f64>) -> f64 + 'static,
) -> Criterion {
    Criterion::new(text, move |e| {
        let range = e.seen.late_torque;
        // What was not looked at is not right.
        if range.is_empty() {
            return Verdict::broken("there is no torque from then on");
        }
        Verdict::of(measured(range), most_nm, "N·m")
    })
    .since(from_s)
}

pub(super) fn torque_stays(from_s: f64) -> Criterion {
    let text = format!("torque the same to the bit from {} on", Time(from_s));
    Criterion::new(text, move |e| {
        // The step that ends at `from_s` may still change it.
        let last = e.seen.last_change;
        let changed_s = f64::from_whole(last.saturating_sub(1)) * e.seen.step_s;
        if last > 0 && changed_s >= from_s {
            return Verdict::fails(Failure::Broken("the torque changes"), Some(changed_s));
        }
        Verdict::MET
    })
}

pub(super) fn torque_returns(within_nm: impl Into<Limits>) -> Criterion {
    let text = "the last torque is the first within";
    most(text, within_nm, "N·m", |seen| {
        (seen.last_torque_nm - seen.first_torque_nm).abs()
    })
}

/// |∮ T dφ| over the run.
pub(super) fn loop_area(most_j: impl Into<Limits>) -> Criterion {
    most("work over whole cycles at most", most_j, "J", |seen| {
        seen.work_j.abs()
    })
}

pub(super) fn no_break_at_rest() -> Criterion {
    Criterion::new("no break while the shaft is at rest", |e| {
        met_if(
            e.seen.tally.breaks_at_rest == 0,
            "breaks while the shaft is at rest",
        )
    })
}

/// In a slip the torque changes its sign only when the relative velocity does.
pub(super) fn slips_with_shaft(within_rad_s: impl Into<Limits>) -> Criterion {
    let text = "in a slip the shaft leads the object, or lags by at most";
    most(text, within_rad_s, "rad/s", |seen| seen.lag_rad_s)
}

/// The torque is that of another input with the sign changed, bit for bit.
pub(super) fn mirror_of(input: Input) -> Criterion {
    compared("−T", input, |twin| twin.mirrored_bits)
}

/// The torque is that of another input, bit for bit.
pub(super) fn same_as(input: Input) -> Criterion {
    compared("T", input, |twin| twin.torque_bits)
}

fn compared(what: &str, input: Input, bits: fn(&Observation) -> Hash) -> Criterion {
    let text = format!("{what} of \"{input}\", bit for bit");
    let mut criterion = Criterion::new(text, move |e| {
        same_bits(e.twin.map(bits) == Some(e.seen.torque_bits))
    });
    criterion.twin = Some(input);
    criterion
}

fn same_bits(are: bool) -> Verdict {
    met_if(are, "other torque bits")
}

/// The hash of all torque bits.
pub(super) fn torque_bits(hash: u64) -> Criterion {
    let text = format!("torque bits with hash {hash:#018x}");
    let same = Criterion::new(text, move |e| same_bits(e.seen.torque_bits.0 == hash));
    let mut criterion = same.on(Basis::Steps);
    criterion.bits = Some(hash);
    criterion
}

/// The hand's largest swing in the last half second over that in the first.
pub(super) fn swing_ratio(theory: f64, within: f64) -> Criterion {
    let text = format!(
        "largest swing of the last half second {theory:.4} of that of the first, within {} of it",
        Plain(within)
    );
    Criterion::new(text, move |e| match e.seen.swing_rad {
        Some((first, last)) => Verdict::of((last / first / theory - 1.0).abs(), within, ""),
        None => Verdict::broken("no hand"),
    })
}

/// Number of steps that end with a velocity below the smallest normal number.
pub(super) fn subnormals(most: u64) -> Criterion {
    let text = format!("at most {most} steps end with a subnormal velocity");
    let limit = f64::from_whole(most);
    number(text, limit, "steps", |seen| {
        f64::from_whole(seen.subnormals)
    })
    .on(Basis::Steps)
}

pub(super) fn torque_step(most_nm: f64) -> Criterion {
    let most = Plain(most_nm);
    let text = format!("torque moves by at most {most} N·m from one step to the next");
    number(text, most_nm, "N·m", |seen| seen.largest_step_nm).on(Basis::Steps)
}

/// Relative: rounding only.
pub(super) fn energy_rise(limits: impl Into<Limits>) -> Criterion {
    let text = "no adjustment raises the stored energy by more than";
    most(text, limits, "", |seen| seen.energy_rise)
}

/// Share of the slew limit by which the torque exceeds it, apart from the shaft's travel.
pub(super) fn slew(beyond: impl Into<Limits>) -> Criterion {
    let limits = beyond.into();
    let (slew, beyond) = (Plain(SLEW_NM_PER_S), limits.in_unit(""));
    let text =
        format!("between events no torque faster than {slew} N·m/s by more than {beyond} of it");
    Criterion::new(text, move |e| {
        Verdict::of(e.seen.slew, 1.0 + limits.of(e), "")
    })
}

/// The first event after a time is a break, and on time.
pub(super) fn first_break_after(from_s: f64, at_s: f64, within_s: impl Into<Limits>) -> Criterion {
    let limits = within_s.into();
    let (from, at, within) = (Time(from_s), Time(at_s), limits.in_unit("s"));
    let text = format!("the first event after {from} is a break at {at} within {within}");
    Criterion::new(text, move |e| {
        let mut events = e.seen.events.iter();
        match events.find(|event| event.time_s > from_s) {
            Some(first) if first.kind == EventKind::Break => {
                Verdict::of((first.time_s - at_s).abs(), limits.of(e), "s")
            }
            _ => Verdict::broken("no break, or not first"),
        }
    })
}

/// Relative: rounding only.
pub(super) fn slip_energy(limits: impl Into<Limits>) -> Criterion {
    let text = "no slip ends with more energy in the spring than at its break, by more than";
    most(text, limits, "", |seen| seen.slip_energy)
}

pub(super) fn guard_ticks(least: u64, most: u64) -> Criterion {
    let ticks = span(least, most);
    let text = format!("the turn-back guard switches the torque off for {ticks} ticks");
    Criterion::new(text, move |e| {
        met_if(
            (least..=most).contains(&e.seen.guard_ticks),
            "torque off for another number of ticks",
        )
    })
}

/// Energy that the hand gets back over any time, beyond that of sampling, as a share of the bound.
pub(super) fn returned(most: f64) -> Criterion {
    let text = format!("the hand gets back at most {most:.4} Ts²/2kr + (½ + d) kr h ∫Ω² dt");
    number(text, most, "", |seen| seen.returned)
}

/// Range of a quantity of the vibration actuator, over the whole run or from a time on; too little
/// of what should be there is another motion.
pub(super) fn actuator(
    (name, unit, of): Measure,
    from_s: Option<f64>,
    least: f64,
    most: f64,
) -> Criterion {
    let from = from_s.map_or_else(String::new, |from_s| format!("from {} on ", Time(from_s)));
    let range = if least > 0.0 {
        format!("{} to", Plain(least))
    } else {
        "at most".to_owned()
    };
    let text = format!("{from}{name} is {range} {} {unit}", Plain(most));
    Criterion::new(text, move |e| {
        let part = match from_s {
            Some(_) => &e.seen.actuator.late,
            None => &e.seen.actuator.whole,
        };
        let found = of(part);
        if part.ticks == 0.0 || found < least {
            return Verdict::broken("the actuator does less than it should");
        }
        Verdict::of(found, most, unit)
    })
    .since(from_s)
}

/// Every attempt is refused.
pub(super) fn refused() -> Criterion {
    let text = "all refused with a reason, none panics";
    Criterion::new(text, |e| match e.seen.accepted.first() {
        Some(what) => Verdict::broken(what),
        None => Verdict::MET,
    })
}

#[cfg(test)]
mod tests;
