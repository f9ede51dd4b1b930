//! Measurements of the program in a row.

use super::outcome::{Outcome, Verdict};
use super::person::{Person, interrupted};
use super::rows::{Check, Row};
use crate::failure::Failure;
use crate::following::disarming;
use crate::interrupt;
use crate::line::{Line, failure};
use crepitus_client::connection::device_text;
use crepitus_client::{Client, Error, Event, Transport};
use crepitus_protocol::counters::{CommsCounter, DriveCounter};
use crepitus_protocol::host::Status;
use crepitus_protocol::measured::MOTOR_C;
use crepitus_protocol::parameters::id;
use crepitus_protocol::telemetry::{NO_CURRENT, Sample, SampleFlags};
use crepitus_protocol::{Fault, TICKS_PER_S};
use std::time::Duration;

/// Time for an action.
const ACTION: Duration = Duration::from_secs(20);

/// Time for which samples are looked at.
const LISTEN: Duration = Duration::from_secs(1);

/// Time from another fault to the one that is expected.
const GRACE: Duration = Duration::from_secs(1);

/// Poll interval.
const POLL: Duration = Duration::from_millis(20);

/// Counts that an encoder has to turn, and to come back to: 36 µrad of the joint each.
const TURNED_COUNTS: i64 = 2_000;
const BACK_COUNTS: i64 = 1_000;

/// Mean current at rest, A: 1.65 V ± 5 mV.
const REST_MA: f64 = 8.0;

/// Deviation of the supply: 3 %.
const SUPPLY_SHARE: f64 = 0.03;

/// Temperatures of a room, °C, and rise by a finger.
const ROOM_C: std::ops::RangeInclusive<i16> = 10..=40;
const RISE_C: i16 = 1;

/// Frames that may be discarded: one in a thousand.
const DISCARDED: u32 = 1_000;

/// Time without a renewal of the lease: 0.25 s, and some.
const SILENCE: Duration = Duration::from_millis(400);

/// Faults of lines and gates.
const LINE_FAULTS: [Fault; 7] = [
    Fault::EnableStuckOn,
    Fault::EnableStuckOff,
    Fault::CommsLineOff,
    Fault::CommsEnableStuckOn,
    Fault::CommsEnableStuckOff,
    Fault::DriveGateStuck,
    Fault::CommsGateStuck,
];

/// The sensor's current at rest, mA, before the first arming: from then on the drive subtracts it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rest(Option<f64>);

impl Rest {
    /// Measures it, unless that has been done; NaN without a measured current.
    fn measure(&mut self, client: &mut Client<Line>) -> Result<f64, Failure> {
        if let Some(ma) = self.0 {
            return Ok(ma);
        }
        let samples = listen(client, LISTEN)?;
        let currents = samples
            .iter()
            .filter(|sample| sample.current_ma != NO_CURRENT)
            .map(|sample| f64::from(sample.current_ma));
        let (count, sum) = currents.fold((0.0, 0.0), |(count, sum), ma| (count + 1.0, sum + ma));
        Ok(*self.0.insert(sum / count))
    }
}

/// Measures what a row has to be measured.
pub(super) fn measured(
    client: &mut Client<Line>,
    person: &Person,
    row: &'static Row,
    rest: &mut Rest,
) -> Result<Outcome, Failure> {
    match row.check {
        Check::ByHand => Ok(Outcome::new(row, Verdict::ByHand, "", "")),
        Check::Comms => Ok(comms(client, row)),
        Check::Drive => drive(client, row),
        Check::Samples => samples(client, row),
        Check::Encoder => encoder(client, person, row),
        Check::Lines => {
            rest.measure(client)?;
            lines(client, row)
        }
        Check::Offset => offset(client, row, rest),
        Check::Supply => supply(client, row),
        Check::Heat => heat(client, person, row),
        Check::Break => {
            let expected = [Fault::Overcurrent];
            let way_out =
                "the break line does not reach TIM1: its wire, its 4.7 kΩ, the comparator";
            let what = "pull the break line low";
            provoked(client, person, row, what, &expected, way_out)
        }
        Check::Stop => {
            let expected = [Fault::SupplyLow, Fault::SpeedMismatch];
            let way_out = "the stop does not cut the bridge's supply: its first contact is bridged or in the wrong wire";
            let what = "press the stop";
            provoked(client, person, row, what, &expected, way_out)
        }
        Check::Polarity => polarity(client, row),
        Check::Watchdog => {
            let expected = [Fault::DriveWatchdog];
            let way_out = "the watchdog does not run: does the probe freeze it (DBGMCU_APB1_FZ), are the option bytes right?";
            let what = "halt the drive with the probe";
            provoked(client, person, row, what, &expected, way_out)
        }
        Check::Lease => lease(client, row),
        Check::Limits => {
            client.zero().map_err(failure)?;
            let expected = [Fault::OutsideRange];
            let way_out = "the joint did not get beyond its range: a stop of the brace is within it, or the zero is wrong";
            let what = "bend the hinge to its stop";
            provoked(client, person, row, what, &expected, way_out)
        }
    }
}

fn comms(client: &Client<Line>, row: &'static Row) -> Outcome {
    Outcome::good(row, device_text::identity(&client.handshake().comms))
}

fn drive(client: &mut Client<Line>, row: &'static Row) -> Result<Outcome, Failure> {
    let status = client.status().map_err(failure)?;
    let handshake = client.identify().map_err(failure)?;
    let Some(drive) = handshake.drive.filter(|_| status.drive_present) else {
        let remedy =
            "check its power, and the wires from PC6 of each controller to PC7 of the other";
        return Ok(Outcome::bad(row, "the drive is silent", remedy));
    };
    Ok(match handshake.mismatch() {
        Some(mismatch) => Outcome::bad(
            row,
            mismatch.to_string(),
            "flash both with the same version",
        ),
        None => Outcome::good(row, device_text::identity(&drive)),
    })
}

/// Collects the samples of this time.
fn listen(client: &mut Client<Line>, time: Duration) -> Result<Vec<Sample>, Failure> {
    client.subscribe().map_err(failure)?;
    let end = client.now() + time;
    let mut samples = Vec::new();
    while client.now() < end {
        if interrupt::requested() {
            return Err(interrupted());
        }
        if let Some(Event::Block(arrival)) = client.pump(POLL).map_err(failure)? {
            samples.extend(arrival.block.samples.iter().copied());
        }
    }
    client.unsubscribe().map_err(failure)?;
    Ok(samples)
}

fn samples(client: &mut Client<Line>, row: &'static Row) -> Result<Outcome, Failure> {
    let before = frames(client)?;
    let samples = listen(client, LISTEN)?;
    let after = frames(client)?;
    let late = samples.iter().filter(|it| it.flags.has(SampleFlags::LATE));
    let late = late.count();
    let [received, discarded] = [0, 1].map(|place| after[place].wrapping_sub(before[place]));
    let found = format!(
        "{} samples in a second, {late} late, {discarded} of {received} frames discarded",
        samples.len()
    );
    let least = usize::try_from(TICKS_PER_S * 9 / 10).unwrap_or_default();
    Ok(if discarded > received / DISCARDED {
        let remedy = "keep the link under 30 cm, twisted with ground, 33 Ω at each sender";
        Outcome::bad(row, found, remedy)
    } else if samples.len() < least || late > 0 {
        Outcome::bad(row, found, "run `crepitus doctor`")
    } else {
        Outcome::good(row, found)
    })
}

/// Frames received over the link, and those of them that were discarded.
fn frames(client: &mut Client<Line>) -> Result<[u32; 2], Failure> {
    let counters = client.counters().map_err(failure)?;
    let drive = |counter: DriveCounter| counters.drive.get(counter.index()).copied().unwrap_or(0);
    let comms = |counter: CommsCounter| counters.comms.get(counter.index()).copied().unwrap_or(0);
    Ok([
        drive(DriveCounter::Frames).wrapping_add(comms(CommsCounter::FromDrive)),
        drive(DriveCounter::Discarded).wrapping_add(comms(CommsCounter::FromDriveDiscarded)),
    ])
}

fn encoder(
    client: &mut Client<Line>,
    person: &Person,
    row: &'static Row,
) -> Result<Outcome, Failure> {
    client.subscribe().map_err(failure)?;
    person.act("turn the encoder there and back");
    let end = client.now() + ACTION;
    let (mut first, mut furthest, mut last) = (None, 0_i64, 0_i64);
    while client.now() < end {
        if interrupt::requested() {
            return Err(interrupted());
        }
        let Some(Event::Block(arrival)) = client.pump(POLL).map_err(failure)? else {
            continue;
        };
        for sample in &arrival.block.samples {
            let first = *first.get_or_insert(sample.count);
            last = i64::from(sample.count.wrapping_sub(first));
            if last.abs() > furthest.abs() {
                furthest = last;
            }
        }
        if furthest.abs() >= TURNED_COUNTS && last.abs() <= BACK_COUNTS {
            break;
        }
    }
    client.unsubscribe().map_err(failure)?;
    let found = format!("{furthest} counts there, {last} at the end");
    Ok(if furthest.abs() < TURNED_COUNTS {
        Outcome::bad(
            row,
            found,
            "the count stays: the encoder's plug, its supply, the RS-422 receiver",
        )
    } else if last.abs() > BACK_COUNTS {
        Outcome::bad(
            row,
            found,
            "the count does not come back: one of A and B is missing, or edges are lost",
        )
    } else {
        Outcome::good(row, found)
    })
}

/// The fault of a status, if there is one.
fn fault(status: &Status) -> Option<Fault> {
    let code = [status.drive_fault, status.comms_fault]
        .into_iter()
        .find(|code| *code != 0)?;
    Fault::find(code).map(|spec| spec.fault)
}

fn named(fault: Fault) -> &'static str {
    Fault::find(fault.code()).map_or("an unknown fault", |spec| spec.name)
}

/// Clears the faults that a row has caused.
fn cleared(client: &mut Client<Line>) -> Result<(), Failure> {
    /// Tries while the cause goes away: 2 s.
    const TRIES: usize = 100;
    for _ in 0..TRIES {
        let status = client.status().map_err(failure)?;
        if fault(&status).is_none() {
            return Ok(());
        }
        let _ = client.clear_fault();
        let _ = client.pump(POLL);
    }
    Ok(())
}

/// Arms, with the zero here; returns the status, and whether it is armed.
fn armed(client: &mut Client<Line>) -> Result<(bool, Status), Failure> {
    cleared(client)?;
    client.zero().map_err(failure)?;
    let is_armed = match client.arm() {
        Ok(()) => true,
        Err(Error::Refused(_)) => {
            // The drive's fault comes with its next block.
            client.pump(POLL).map_err(failure)?;
            false
        }
        Err(error) => return Err(failure(error)),
    };
    Ok((is_armed, client.status().map_err(failure)?))
}

fn lines(client: &mut Client<Line>, row: &'static Row) -> Result<Outcome, Failure> {
    let (is_armed, status) = disarming(client, armed)?;
    cleared(client)?;
    let remedy = "the read-back of that line, its resistor, the gate's enable and its wire";
    Ok(match fault(&status) {
        Some(found) if LINE_FAULTS.contains(&found) => Outcome::bad(row, named(found), remedy),
        Some(found) => Outcome::good(
            row,
            format!("no fault of a line or a gate, but {}", named(found)),
        ),
        None if is_armed => Outcome::good(row, "lines and gates are proven, armed"),
        None => Outcome::new(row, Verdict::Unknown, "not armed", "run `crepitus doctor`"),
    })
}

fn offset(
    client: &mut Client<Line>,
    row: &'static Row,
    rest: &mut Rest,
) -> Result<Outcome, Failure> {
    let mean_ma = rest.measure(client)?;
    let remedy =
        "REF1 of both amplifiers to 3.3 V, REF2 to ground; the same VDDA; no load at half A or B";
    if mean_ma.is_nan() {
        let remedy = "the converters do not run: restart the drive";
        return Ok(Outcome::bad(row, "no current is measured", remedy));
    }
    let (_, status) = disarming(client, armed)?;
    cleared(client)?;
    let found = format!("{mean_ma:.1} mA at rest");
    Ok(if fault(&status) == Some(Fault::CurrentOffset) {
        Outcome::bad(row, format!("{found}; current-offset"), remedy)
    } else if mean_ma.abs() > REST_MA {
        Outcome::bad(row, found, remedy)
    } else {
        Outcome::good(row, format!("{found}; neither offset is beyond 0.1 A"))
    })
}

fn supply(client: &mut Client<Line>, row: &'static Row) -> Result<Outcome, Failure> {
    let status = client.status().map_err(failure)?;
    let (_, values) = client.parameters().map_err(failure)?;
    let expected_v = values.get(id::SUPPLY).unwrap_or_default();
    let supply_v = f64::from(status.measured.supply_cv) / 100.0;
    let found = format!("{supply_v:.2} V, expected {expected_v:.1} V");
    Ok(
        if (supply_v - expected_v).abs() > SUPPLY_SHARE * expected_v {
            Outcome::bad(
                row,
                found,
                "measure the supply; if it is right, the divider 150 kΩ, 10 kΩ at PC3; motor.supply_v",
            )
        } else {
            Outcome::good(row, found)
        },
    )
}

fn heat(client: &mut Client<Line>, person: &Person, row: &'static Row) -> Result<Outcome, Failure> {
    let first = client.status().map_err(failure)?.measured.motor_c;
    let (coldest, hottest) = MOTOR_C;
    let remedy = "the sensor at PA2: its supply, its wire, MCP9700 and no MCP9701";
    if !(coldest..hottest).contains(&f32::from(first)) || !ROOM_C.contains(&first) {
        return Ok(Outcome::bad(row, format!("{first} °C"), remedy));
    }
    person.act("warm the motor's sensor with a finger");
    let end = client.now() + ACTION;
    let mut warmest = first;
    while client.now() < end && warmest < first + RISE_C {
        if interrupt::requested() {
            return Err(interrupted());
        }
        client.pump(POLL).map_err(failure)?;
        warmest = warmest.max(client.status().map_err(failure)?.measured.motor_c);
    }
    let found = format!("{first} °C, then {warmest} °C");
    Ok(if warmest >= first + RISE_C {
        Outcome::good(row, found)
    } else {
        Outcome::bad(row, found, remedy)
    })
}

/// Arms, lets a person do something, and waits for the fault that has to follow.
fn provoked(
    client: &mut Client<Line>,
    person: &Person,
    row: &'static Row,
    what: &str,
    expected: &[Fault],
    remedy: &'static str,
) -> Result<Outcome, Failure> {
    let outcome = disarming(client, |client| {
        let (is_armed, status) = armed(client)?;
        if !is_armed {
            let why = fault(&status).map_or("refused", named);
            let found = format!("it does not arm: {why}");
            return Ok(Outcome::new(
                row,
                Verdict::Unknown,
                found,
                "repair that first",
            ));
        }
        person.act(what);
        let end = client.now() + ACTION;
        let mut other = None;
        while client.now() < end {
            if interrupt::requested() {
                return Err(interrupted());
            }
            client.pump(POLL).map_err(failure)?;
            let status = client.status().map_err(failure)?;
            if fault_codes(&status).iter().any(|it| expected.contains(it)) {
                return Ok(Outcome::good(row, fault_names(&status)));
            }
            // A drive that starts again says why only then.
            if let Some(found) = fault(&status) {
                let first = *other.get_or_insert(client.now());
                if client.now() >= first + GRACE {
                    let found = format!("{} instead", named(found));
                    return Ok(Outcome::bad(row, found, remedy));
                }
            }
        }
        Ok(Outcome::bad(row, "nothing happened", remedy))
    })?;
    person.end();
    cleared(client)?;
    Ok(outcome)
}

fn fault_codes(status: &Status) -> Vec<Fault> {
    let codes = [status.drive_fault, status.comms_fault];
    let specs = codes.into_iter().filter_map(Fault::find);
    specs.map(|spec| spec.fault).collect()
}

fn fault_names(status: &Status) -> String {
    let names = fault_codes(status).into_iter().map(named);
    names.collect::<Vec<_>>().join(", ")
}

fn polarity(client: &mut Client<Line>, row: &'static Row) -> Result<Outcome, Failure> {
    let (is_armed, status) = disarming(client, armed)?;
    cleared(client)?;
    Ok(match fault(&status) {
        Some(found) => {
            let remedy = match found {
                Fault::EncoderPolarity => "swap the motor's wires behind the shunts",
                Fault::Overcurrent | Fault::CurrentMismatch => "swap the inputs of both amplifiers",
                Fault::CurrentDisagreement => "swap the inputs of one amplifier",
                _ => "see its page: Why there may be no torque",
            };
            Outcome::bad(row, named(found), remedy)
        }
        None if is_armed && status.polarity_proven => Outcome::good(row, "proven by the push"),
        None if is_armed => Outcome::new(
            row,
            Verdict::Unknown,
            "armed, but the push moved nothing",
            "let go of the gear's output, away from its stops",
        ),
        None => Outcome::bad(row, "it does not arm", "run `crepitus doctor`"),
    })
}

fn lease(client: &mut Client<Line>, row: &'static Row) -> Result<Outcome, Failure> {
    let status = disarming(client, |client| {
        let (is_armed, status) = armed(client)?;
        if !is_armed {
            return Ok(status);
        }
        // Without a pump nothing is renewed.
        client.transport_mut().wait(SILENCE);
        client.status().map_err(failure)
    })?;
    cleared(client)?;
    Ok(match fault(&status) {
        Some(Fault::LeaseExpired) => Outcome::good(row, "lease-expired"),
        Some(found) => Outcome::bad(
            row,
            named(found),
            "see its page: Why there may be no torque",
        ),
        None => Outcome::bad(
            row,
            "no fault 0.4 s after the last renewal",
            "another program holds the lease: end it",
        ),
    })
}
