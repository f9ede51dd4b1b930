//! Post-mortem records, as text and as JSON.

use crepitus_client::Crash;
use crepitus_protocol::LimitReason;
use crepitus_protocol::crash::{End, Head, REGISTERS, Tick};
use crepitus_protocol::telemetry::{NO_CURRENT, SampleFlags};
use serde_json::{Map, Value, json};
use std::fmt::Write as _;

/// Words of the stack in a line.
const STACK_LINE: usize = 8;

/// The record of a controller, for people.
pub(crate) fn text(name: &str, crash: Option<&Crash>) -> String {
    let Some(Crash { head, ticks }) = crash else {
        return format!("{name}   no crash since power-on\n");
    };
    let mut text = format!("{name}   start {} ended: {}\n", head.start, end(head));
    let registers = || head.registers.iter().zip(REGISTERS);
    if registers().any(|(word, _)| *word != 0) {
        for (word, (register, meaning)) in registers() {
            let _ = writeln!(text, "  {register:<6} {word:#010x}  {meaning}");
        }
        text.push_str("  stack, from SP up\n");
        for line in head.stack.chunks(STACK_LINE) {
            text.push_str("   ");
            for word in line {
                let _ = write!(text, " {word:08x}");
            }
            text.push('\n');
        }
    }
    if !ticks.is_empty() {
        let _ = writeln!(text, "  its last {} ticks, 50 us each", ticks.len());
        text.push_str("          tick     count  model N·m        N·m     mA  flags\n");
        for tick in ticks {
            let _ = writeln!(text, "{}", line(tick).trim_end());
        }
    }
    text
}

fn end(head: &Head) -> String {
    let name = head.end.name();
    match head.end {
        End::Panic => format!(
            "{name} in {}, line {}",
            head.file().unwrap_or("an unknown file"),
            head.detail
        ),
        End::Fault => format!("{name} at {:#010x}", head.detail),
        End::Unhandled => format!("{name}, number {}", head.detail),
        End::Watchdog => name.to_owned(),
    }
}

fn line(tick: &Tick) -> String {
    let sample = &tick.sample;
    let current = if sample.current_ma == NO_CURRENT {
        "-".to_owned()
    } else {
        sample.current_ma.to_string()
    };
    format!(
        "    {:>10} {:>9} {:>10.4} {:>10.4} {current:>6}  {}",
        tick.number,
        sample.count,
        sample.model_torque_nm,
        sample.torque_nm,
        flags(sample.flags)
    )
}

fn flags(flags: SampleFlags) -> String {
    let named = [
        (SampleFlags::ENERGISED, "energised"),
        (SampleFlags::SETTLING, "settling"),
        (SampleFlags::LOST, "lost"),
        (SampleFlags::LATE, "late"),
        (SampleFlags::BREAK, "break"),
        (SampleFlags::STICK, "stick"),
        (SampleFlags::CHIRP, "chirp"),
    ];
    let mut names: Vec<_> = named
        .into_iter()
        .filter(|(bit, _)| flags.has(*bit))
        .map(|(_, name)| name.to_owned())
        .collect();
    if flags.limit() != LimitReason::None {
        names.push(format!("limit {}", flags.limit().name()));
    }
    names.join(" ")
}

/// The record of a controller as JSON; null without one.
pub(crate) fn json(crash: Option<&Crash>) -> Value {
    let Some(Crash { head, ticks }) = crash else {
        return Value::Null;
    };
    let registers: Map<_, _> = (REGISTERS.into_iter().zip(head.registers))
        .map(|((name, _), word)| (name.to_owned(), json!(word)))
        .collect();
    let ticks: Vec<_> = ticks.iter().map(tick_json).collect();
    json!({
        "start": head.start,
        "end": head.end.name(),
        "detail": head.detail,
        "file": head.file(),
        "registers": registers,
        "stack": head.stack,
        "ticks": ticks,
    })
}

fn tick_json(tick: &Tick) -> Value {
    let sample = &tick.sample;
    json!({
        "tick": tick.number,
        "count": sample.count,
        "model_torque_nm": sample.model_torque_nm,
        "torque_nm": sample.torque_nm,
        "current_ma": (sample.current_ma != NO_CURRENT).then_some(sample.current_ma),
        "flags": sample.flags.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::crash::place;
    use crepitus_protocol::telemetry::Sample;

    fn tick(number: u32, current_ma: i16, flags: u16) -> Tick {
        Tick {
            number,
            sample: Sample {
                count: -12,
                model_torque_nm: -0.25,
                torque_nm: 0.5,
                current_ma,
                flags: SampleFlags(flags),
            },
        }
    }

    #[test]
    fn a_fault_is_shown_with_registers_stack_and_ticks() {
        let mut head = Head::new(7, End::Fault, 0x0800_1234);
        head.registers[0] = 0x0800_1234;
        head.registers[4] = 1 << 16;
        head.stack[9] = 0xdead_beef;
        let energised = SampleFlags::ENERGISED | SampleFlags::LATE;
        let ticks = vec![tick(99, NO_CURRENT, 0), tick(100, -250, energised)];
        let crash = Crash { head, ticks };
        assert_eq!(
            text("drive", Some(&crash)),
            "\
drive   start 7 ended: processor fault at 0x08001234
  PC     0x08001234  instruction that failed
  LR     0x00000000  return address of its function
  SP     0x00000000  stack pointer
  xPSR   0x00000000  flags, number of the exception in the lowest 9 bits
  CFSR   0x00010000  kind of the fault
  HFSR   0x00000000  why it became a HardFault
  MMFAR  0x00000000  address of a memory fault, if CFSR says that it is valid
  BFAR   0x00000000  address of a bus fault, if CFSR says that it is valid
  stack, from SP up
    00000000 00000000 00000000 00000000 00000000 00000000 00000000 00000000
    00000000 deadbeef 00000000 00000000 00000000 00000000 00000000 00000000
  its last 2 ticks, 50 us each
          tick     count  model N·m        N·m     mA  flags
            99       -12    -0.2500     0.5000      -
           100       -12    -0.2500     0.5000   -250  energised late
"
        );
        let json = json(Some(&crash));
        assert_eq!(json["registers"]["PC"], 0x0800_1234);
        assert_eq!(json["ticks"][0]["current_ma"], Value::Null);
        assert_eq!(json["ticks"][1]["current_ma"], -250);
    }

    #[test]
    fn what_could_not_be_kept_is_left_out() {
        let mut head = Head::new(7, End::Panic, 12);
        head.place = place("device/src/drive.rs");
        let crash = |head| Crash {
            head,
            ticks: Vec::new(),
        };
        assert_eq!(
            text("comms", Some(&crash(head))),
            "comms   start 7 ended: panic in device/src/drive.rs, line 12\n"
        );
        let head = Head::new(8, End::Watchdog, 0);
        assert_eq!(
            text("comms", Some(&crash(head))),
            "comms   start 8 ended: reset by the watchdog\n"
        );
        assert_eq!(text("comms", None), "comms   no crash since power-on\n");
        assert_eq!(json(None), Value::Null);
    }
}
