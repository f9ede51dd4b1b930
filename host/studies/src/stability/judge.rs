//! Checks a criterion against observations.

use super::criterion::{ActuatorMeasure, BALANCE, BOUND_SLACK, Counted, Criterion};
use super::observation::{ActuatorPart, Observation};
use super::subject::{Rung, Subject};
use super::verdict::{Failure, Margin, Verdict};
use crate::event_errors::EventErrors;
use crate::matching::match_events;
use crate::symptoms::event::{SymptomEvent, matched};
use crate::true_events::{TimedEvent, TrueEvent};
use crepitus_model::solver::Solver;
use crepitus_model::{EventKind, Real};
use crepitus_scene::scene::Precision;

/// Factor of the cycle rate beyond which it is another motion.
const ANOTHER_MOTION: f64 = 2.0;

/// A criterion without a number that is met.
const MET: Finding = Finding::Number(Margin::NONE);

/// Failure of a criterion whose torque was not observed: what was not looked at is not right.
const NO_TORQUE: Failure = Failure::Broken("there is no torque from then on");

/// Observations for a criterion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Evidence<'a> {
    pub(super) subject: Subject,
    pub(super) seen: &'a Observation,
    /// The true events, if the input has some.
    pub(super) truth: &'a [TrueEvent],
    /// Observation of the second input of a comparison.
    pub(super) twin: Option<&'a Observation>,
}

/// Result of a criterion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Finding {
    /// Met or missed, by its number.
    Number(Margin),
    /// The motion is not the joint's.
    Failed(Failure, Option<f64>),
}

impl Finding {
    /// Converts to a verdict.
    pub(super) fn verdict(self, flagged: bool) -> Verdict {
        match self {
            Self::Number(margin) if margin.measured <= margin.limit => Verdict::Holds(margin),
            Self::Number(margin) => Verdict::Degrades { margin, flagged },
            Self::Failed(what, at_s) => Verdict::Fails {
                what,
                at_s,
                flagged,
            },
        }
    }
}

/// Checks a measure of the vibration actuator; too little of what should be there is
/// another motion.
fn actuator(what: ActuatorMeasure, part: &ActuatorPart, least: f64, most: f64) -> Finding {
    let rms = |squares: f64| (squares / part.ticks.max(1.0)).sqrt();
    let found = match what {
        ActuatorMeasure::AccelerationRms => rms(part.acceleration_squares),
        ActuatorMeasure::Excursion => 1e3 * part.excursion_m,
        ActuatorMeasure::Voltage => part.volts,
        ActuatorMeasure::VoltageStep => part.volts_a_tick,
        ActuatorMeasure::CurrentRms => rms(part.current_squares),
        ActuatorMeasure::ShaftSpeed => part.shaft_rad_s,
        ActuatorMeasure::LoopGain => part.loop_gain,
        ActuatorMeasure::LoopInPhase => part.loop_in_phase,
    };
    if part.ticks == 0.0 || found < least {
        return Finding::Failed(
            Failure::Broken("the actuator does less than it should"),
            None,
        );
    }
    number(found, most, what.words().1)
}

/// Checks the common bounds.
pub(super) fn common(evidence: &Evidence<'_>) -> Option<Finding> {
    let seen = evidence.seen;
    if seen.overflow_s.is_some() {
        return Some(Finding::Failed(Failure::Overflow, seen.overflow_s));
    }
    if seen.above_s.is_some() {
        return Some(Finding::Failed(Failure::AboveTheLimit, seen.above_s));
    }
    let limit = BALANCE.of(evidence.subject.precision);
    let missing = seen
        .imbalance
        .filter(|_| evidence.subject.solver == Rung::Ladder(Solver::ExactEvents))?;
    (missing.is_nan() || missing > limit).then_some(number(missing, limit, ""))
}

/// Checks `criterion` against the evidence.
pub(super) fn judge(criterion: &Criterion, evidence: &Evidence<'_>) -> Finding {
    let Evidence { subject, seen, .. } = *evidence;
    let tally = &seen.tally;
    let precision = subject.precision;
    match criterion {
        // In every slip the torque is at its limit.
        Criterion::Survives => met_or(seen.peak, 1.0 + BOUND_SLACK, ""),
        Criterion::Events { within_s } => events(evidence, within_s.of(precision)),
        Criterion::EventTorques { within_nm } => event_torques(evidence, within_nm.of(precision)),
        Criterion::Count { what, least, most } => {
            let found = match what {
                Counted::Events => tally.events(),
                Counted::Breaks => tally.breaks,
                Counted::Reverses => tally.reverses,
            };
            if (*least..=*most).contains(&found) {
                MET
            } else {
                let expected = if found < *least { *least } else { *most };
                Finding::Failed(Failure::OtherEvents { found, expected }, None)
            }
        }
        Criterion::EventsPerStep { most } => match tally.most_in_step {
            found if found > *most => {
                Finding::Failed(Failure::Broken("chatter within a step"), None)
            }
            _ => MET,
        },
        Criterion::EventsPerSecond { most } => {
            let duration_s = seen.duration_s();
            let rate = f64::from_whole(tally.events()) / duration_s;
            if rate > *most {
                let failure = Failure::OtherEvents {
                    found: tally.events(),
                    expected: nearest(most * duration_s),
                };
                return Finding::Failed(failure, None);
            }
            MET
        }
        Criterion::CycleRate { hz, within } => cycle_rate(seen, *hz, within.of(precision)),
        Criterion::IntervalVariation { most } => match tally.cycles.variation() {
            Some(variation) => number(variation, *most, ""),
            None => Finding::Failed(Failure::Broken("no cycles"), None),
        },
        Criterion::SlipTime { slip_s, within } => {
            if tally.sticks == 0 {
                return Finding::Failed(Failure::Broken("no slip ends"), None);
            }
            let off_s = (tally.slips.high - slip_s).max(slip_s - tally.slips.low);
            number(off_s / slip_s, within.of(precision), "")
        }
        Criterion::SilentAfter { time_s } => met_or(tally.last_s.unwrap_or(0.0), *time_s, "s"),
        Criterion::TorqueWithin { .. }
        | Criterion::TorqueStays { .. }
        | Criterion::TorqueReturns { .. }
        | Criterion::LoopArea { .. } => torques(criterion, seen, precision),
        Criterion::NoBreakAtRest => {
            if tally.breaks_at_rest > 0 {
                Finding::Failed(Failure::Broken("breaks while the shaft is at rest"), None)
            } else {
                MET
            }
        }
        Criterion::SlipsWithShaft { within_rad_s } => {
            number(seen.lag_rad_s, within_rad_s.of(precision), "rad/s")
        }
        Criterion::MirrorOf(_) => {
            same(evidence.twin.map(|twin| twin.mirrored_bits) == Some(seen.torque_bits))
        }
        Criterion::SameAs(_) => {
            same(evidence.twin.map(|twin| twin.torque_bits) == Some(seen.torque_bits))
        }
        Criterion::TorqueBits(hash) => same(seen.torque_bits.0 == *hash),
        Criterion::SwingRatio { theory, within } => match seen.swing_rad {
            Some((first, last)) => number((last / first / theory - 1.0).abs(), *within, ""),
            None => Finding::Failed(Failure::Broken("no hand"), None),
        },
        Criterion::Subnormals { most } => number(
            f64::from_whole(seen.subnormals),
            f64::from_whole(*most),
            "steps",
        ),
        Criterion::Refused => match seen.accepted.first() {
            Some(what) => Finding::Failed(Failure::Broken(what), None),
            None => MET,
        },
        _ => of_a_device(criterion, seen, precision),
    }
}

/// Checks a criterion of a joint in a device.
fn of_a_device(criterion: &Criterion, seen: &Observation, precision: Precision) -> Finding {
    match criterion {
        Criterion::TorqueStep { most_nm } => number(seen.largest_step_nm, *most_nm, "N·m"),
        Criterion::EnergyRise { most } => number(seen.energy_rise, most.of(precision), ""),
        Criterion::Slew { beyond } => number(seen.slew, 1.0 + beyond.of(precision), ""),
        Criterion::FirstBreakAfter {
            from_s,
            at_s,
            within_s,
        } => match seen.events.iter().find(|event| event.time_s > *from_s) {
            Some(first) if first.kind == EventKind::Break => {
                number((first.time_s - at_s).abs(), within_s.of(precision), "s")
            }
            _ => Finding::Failed(Failure::Broken("no break, or not first"), None),
        },
        Criterion::SlipEnergy { most } => number(seen.slip_energy, most.of(precision), ""),
        Criterion::GuardTicks { least, most } => {
            let found = seen.guard_ticks;
            if (*least..=*most).contains(&found) {
                MET
            } else {
                let failure = Failure::Broken("torque off for another number of ticks");
                Finding::Failed(failure, None)
            }
        }
        Criterion::Returned { most } => number(seen.returned, *most, ""),
        _ => of_symptoms(criterion, seen, precision),
    }
}

/// Checks a criterion of symptoms besides crepitus.
fn of_symptoms(criterion: &Criterion, seen: &Observation, precision: Precision) -> Finding {
    let of = &seen.symptoms;
    match criterion {
        Criterion::SymptomEvents { within_s } => match &of.truth {
            Some(truth) => symptom_events(seen, truth, within_s.of(precision)),
            None => Finding::Failed(Failure::Broken("no reference"), None),
        },
        Criterion::SymptomTorques { within_nm } => match of.torque_error_nm {
            Some(error_nm) => number(error_nm, within_nm.of(precision), "N·m"),
            None => Finding::Failed(Failure::Broken("no reference"), None),
        },
        Criterion::Words(words) => {
            let found = of.events.iter().map(|event| event.word);
            if found.eq(words.iter().copied()) {
                MET
            } else {
                other_words(of.events.len(), words.len())
            }
        }
        Criterion::FirstWord {
            word,
            at_s,
            within_s,
        } => match of.events.iter().find(|event| event.word == *word) {
            Some(first) => number((first.time_s - at_s).abs(), within_s.of(precision), "s"),
            None => Finding::Failed(Failure::Broken("it does not happen"), None),
        },
        Criterion::WordCount { word, least, most } => {
            let own = of.events.iter().filter(|event| event.word == *word);
            let found = u64::try_from(own.count()).unwrap_or(u64::MAX);
            if (*least..=*most).contains(&found) {
                MET
            } else {
                let expected = if found < *least { *least } else { *most };
                Finding::Failed(Failure::OtherEvents { found, expected }, None)
            }
        }
        Criterion::TorqueQuiet { most_nm, .. } => {
            let range = seen.late_torque;
            if range.is_empty() {
                return Finding::Failed(NO_TORQUE, None);
            }
            number(range.width(), *most_nm, "N·m")
        }
        Criterion::SpringsReturn { most } => number(of.returned, *most, ""),
        Criterion::NetReturned { most_j } => number(of.net_returned_j, *most_j, "J"),
        Criterion::Actuator {
            what,
            from_s,
            least,
            most,
        } => {
            let part = match from_s {
                Some(_) => &seen.actuator.late,
                None => &seen.actuator.whole,
            };
            actuator(*what, part, *least, *most)
        }
        _ => Finding::Failed(Failure::Broken("no criterion of symptoms"), None),
    }
}

/// Checks the events of a symptom and their times.
fn symptom_events(seen: &Observation, truth: &[SymptomEvent], within_s: f64) -> Finding {
    let found = &seen.symptoms.events;
    let matching = matched(truth, found, seen.step_s, seen.duration_s());
    if matching.unmatched > 0 {
        return other_words(found.len(), truth.len());
    }
    let errors_s = matching.pairs.iter().filter_map(|&(i, j)| {
        let (truth, found) = (truth.get(i)?, found.get(j)?);
        Some((found.time_s - truth.time_s).abs())
    });
    number(errors_s.fold(0.0, f64::max), within_s, "s")
}

/// Other events than expected.
fn other_words(found: usize, expected: usize) -> Finding {
    let count = |n: usize| u64::try_from(n).unwrap_or(u64::MAX);
    let failure = if found == expected {
        Failure::Broken("other events in the same number")
    } else {
        Failure::OtherEvents {
            found: count(found),
            expected: count(expected),
        }
    };
    Finding::Failed(failure, None)
}

/// Checks a criterion of the torque over time.
fn torques(criterion: &Criterion, seen: &Observation, precision: Precision) -> Finding {
    match criterion {
        Criterion::TorqueWithin {
            low_nm,
            high_nm,
            slack_nm,
            ..
        } => {
            let range = seen.late_torque;
            if range.is_empty() {
                return Finding::Failed(NO_TORQUE, None);
            }
            let outside = (range.high - high_nm).max(low_nm - range.low).max(0.0);
            number(outside, *slack_nm, "N·m")
        }
        Criterion::TorqueStays { from_s } => {
            // The step that ends at `from_s` may still change it.
            let changed_s = f64::from_whole(seen.last_change.saturating_sub(1)) * seen.step_s;
            if seen.last_change > 0 && changed_s >= *from_s {
                Finding::Failed(Failure::Broken("the torque changes"), Some(changed_s))
            } else {
                MET
            }
        }
        Criterion::TorqueReturns { within_nm } => number(
            (seen.last_torque_nm - seen.first_torque_nm).abs(),
            within_nm.of(precision),
            "N·m",
        ),
        Criterion::LoopArea { most_j } => number(seen.work_j.abs(), most_j.of(precision), "J"),
        _ => Finding::Failed(Failure::Broken("no criterion of the torque"), None),
    }
}

/// A result of a criterion that does not fit into a verdict.
pub(super) fn remark(criterion: &Criterion, seen: &Observation) -> String {
    match criterion {
        Criterion::TorqueBits(hash) if seen.torque_bits.0 != *hash => {
            format!("; found {:#018x}", seen.torque_bits.0)
        }
        _ => String::new(),
    }
}

/// A number whose distance from its limit says nothing as long as it keeps it.
fn met_or(measured: f64, limit: f64, unit: &'static str) -> Finding {
    if measured <= limit {
        MET
    } else {
        number(measured, limit, unit)
    }
}

/// Compares a number with its limit.
fn number(measured: f64, limit: f64, unit: &'static str) -> Finding {
    Finding::Number(Margin {
        measured,
        limit,
        unit,
    })
}

fn same(are: bool) -> Finding {
    if are {
        MET
    } else {
        Finding::Failed(Failure::Broken("other torque bits"), None)
    }
}

/// Checks the events and their times.
fn events(evidence: &Evidence<'_>, within_s: f64) -> Finding {
    let Evidence { seen, truth, .. } = evidence;
    let true_events: Vec<TimedEvent> = truth.iter().map(|t| t.event).collect();
    let end_s = seen.duration_s();
    let matching = match_events(&true_events, &seen.events, seen.step_s, end_s);
    let found = seen.tally.events();
    let kept_all = u64::try_from(seen.events.len()) == Ok(found);
    if matching.unmatched > 0 || !kept_all {
        let expected = u64::try_from(truth.len()).unwrap_or(u64::MAX);
        let failure = if found == expected {
            Failure::Broken("other events in the same number")
        } else {
            Failure::OtherEvents { found, expected }
        };
        return Finding::Failed(failure, None);
    }
    if matching.pairs.is_empty() {
        return number(0.0, within_s, "s");
    }
    let errors = EventErrors::new(&true_events, &seen.events, &matching);
    number(errors.max_s, within_s, "s")
}

/// Checks the torque after matched events.
fn event_torques(evidence: &Evidence<'_>, within_nm: f64) -> Finding {
    let Evidence { seen, truth, .. } = evidence;
    let true_events: Vec<TimedEvent> = truth.iter().map(|t| t.event).collect();
    let matching = match_events(&true_events, &seen.events, seen.step_s, seen.duration_s());
    let worst = matching
        .pairs
        .iter()
        .filter_map(|&(i, j)| {
            let torque = seen.torques_after_nm.get(j)?;
            Some((torque - truth.get(i)?.torque_after_nm).abs())
        })
        .fold(0.0, f64::max);
    number(worst, within_nm, "N·m")
}

fn cycle_rate(seen: &Observation, hz: f64, within: f64) -> Finding {
    let expected = hz * seen.duration_s();
    let other = Finding::Failed(
        Failure::OtherEvents {
            found: seen.tally.events(),
            expected: nearest(2.0 * expected),
        },
        None,
    );
    // A count of few cycles is too coarse.
    let share = seen.tally.cycles.count() / (expected - 1.0).max(1.0);
    match seen.tally.cycles.mean() {
        Some(mean_s) if share * ANOTHER_MOTION >= 1.0 && share <= ANOTHER_MOTION => {
            number((1.0 / (mean_s * hz) - 1.0).abs(), within, "")
        }
        _ => other,
    }
}

/// The nearest count; negative and NaN give 0.
fn nearest(count: f64) -> u64 {
    (count + 0.5).whole()
}

#[cfg(test)]
mod symptom_tests;
#[cfg(test)]
mod tests;
