//! The rows of the bring-up: what to do, what to see, and what the program measures. The page
//! `docs/generated/bring-up.md` is made from them.

/// Measurements of the program in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Check {
    /// Nothing: a person sees it.
    ByHand,
    /// Comms answers.
    Comms,
    /// The drive answers, with the schema of comms.
    Drive,
    /// Telemetry is complete.
    Samples,
    /// The count follows, and comes back.
    Encoder,
    /// Both lines and gates do what they should.
    Lines,
    /// The current sensors rest at zero.
    Offset,
    /// Supply of the bridge.
    Supply,
    /// Temperature of the motor.
    Heat,
    /// The break line.
    Break,
    /// The hand-held stop.
    Stop,
    /// Motor and encoder turn the same way.
    Polarity,
    /// The drive's watchdog.
    Watchdog,
    /// The lease.
    Lease,
    /// The range of motion.
    Limits,
}

impl Check {
    /// Description of what is measured.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::ByHand => "",
            Self::Comms => "its hello",
            Self::Drive => "hello and schema",
            Self::Samples => "samples, late ticks, frames",
            Self::Encoder => "count",
            Self::Lines => "both lines and gates, by arming",
            Self::Offset => "current at rest, both offsets",
            Self::Supply => "supply",
            Self::Heat => "temperature",
            Self::Break => "`overcurrent`",
            Self::Stop => "supply, and the fault",
            Self::Polarity => "the push at arming",
            Self::Watchdog => "`drive-watchdog`",
            Self::Lease => "`lease-expired`",
            Self::Limits => "`outside-range`",
        }
    }

    /// Returns whether somebody does something while the program measures.
    pub(super) fn needs_hands(self) -> bool {
        matches!(
            self,
            Self::Encoder | Self::Heat | Self::Break | Self::Stop | Self::Watchdog | Self::Limits
        )
    }
}

/// A row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Number, as other pages cite it.
    pub(super) number: &'static str,
    /// Name for `--rows`.
    pub(super) name: &'static str,
    /// Instruction to the builder.
    pub(super) does: &'static str,
    /// Expected sight.
    pub(super) sees: &'static str,
    /// Measurement of the program.
    pub(super) check: Check,
}

macro_rules! rows {
    ($($number:literal $name:literal $check:ident: $does:literal => $sees:literal;)*) => {
        /// All rows, in their order.
        pub(super) const ROWS: &[Row] = &[$(Row {
            number: $number,
            name: $name,
            does: $does,
            sees: $sees,
            check: Check::$check,
        }),*];
    };
}

rows! {
    "1" "logic" ByHand: "both boards alone, no bridge, 5 V" => "3.3 V at VDDA of each";
    "2" "option-bytes" ByHand: "option bytes of both, with the maker's programmer: brown-out level 3 (2.7 V), watchdog started by software \
        (`WDG_SW`: a hardware one would bite while flash is erased), read-out protection level 0 or 1"
        => "a sagging supply causes a reset, `brown-out`";
    "3" "comms-image" ByHand: "`cd firmware/comms && cargo run --release`"
        => "log: `comms: start … after power` or `after reset`, then `disarmed, fault 0, revision 1`";
    "4" "comms" Comms: "USB to the host; `crepitus devices`, `crepitus info`"
        => "one device `Crepitus`, reset `reset`; the drive unknown";
    "5" "drive-image" ByHand: "`cd firmware/drive && cargo run --release`, probe on the drive"
        => "log: `drive: start … after …`, then `disarmed, fault 0, revision 0`";
    "6" "drive" Drive: "link and its ground; `crepitus info`" => "the drive answers, with the same schema; its log: `revision 1`";
    "7" "samples" Samples: "`crepitus stream`, or `crepitus doctor`" => "20 000 samples/s, none lost, no tick late";
    "8" "link-cut" ByHand: "pull the link's wire from PC7 of the drive"
        => "`crepitus info`: frames discarded at most, no reset; without the other wire `drive-silent`";
    "9" "encoder" Encoder: "turn the encoder by hand, by a tenth of a turn of the joint or more, and back"
        => "the count follows and comes back; 2048 a turn";
    "10" "encoder-cut" ByHand: "unplug the encoder and turn" => "the count stays: *not* detected without torque";
    "11" "gates" ByHand: "scope on PA8, PB13, PA9, PB14, gates connected, bridge not"
        => "all low, at reset, at start, while flashing";
    "12" "lines" Lines: "`crepitus arm --zero --for 5s` with the bridge unpowered, and 24 V at the supply's divider alone; both read-backs"
        => "the lines rise, fall, rise; `overcurrent` if the break is not wired, else `speed-mismatch`";
    "13" "read-back" ByHand: "cut one read-back, arm" => "`enable-stuck-off` or `comms-enable-stuck-off`; tied high `…-stuck-on` at once";
    "14" "pwm" ByHand: "scope during 12"
        => "20 kHz, centre-aligned, both halves at ½; dead time 0.3 µs; all low within 50 µs of the end";
    "15" "offset" Offset: "bench supply for the bridge, 24 V, limit 0.3 A, no motor"
        => "no current; 1.65 V ± 5 mV at PC0 and PC1; the break line high";
    "16" "supply" Supply: "`crepitus info`: supply; turn it down while armed" => "as a meter, ±3 %; `supply-low` at 18 V";
    "16b" "heat" Heat: "`crepitus info`: motor; warm its sensor with a finger" => "as a thermometer, ±4 °C; it rises";
    "17" "break" Break: "dummy load (10 Ω, 50 W, instead of the motor), armed: pull the break line low"
        => "all low within 1 µs; `overcurrent`";
    "18" "trip" ByHand: "dummy load, limit 3 A: raise a current from a second supply through both shunts until it trips"
        => "1.95 A ± 5 %, either way, also in the telemetry. Through one, armed: `current-disagreement` from 0.2 A on";
    "19" "stop" Stop: "press the stop while armed, and measure both its contacts" => "the bridge's supply falls; `speed-mismatch` or `supply-low`";
    "20" "polarity" Polarity: "motor, free gear; `crepitus arm --zero`"
        => "a short tick, armed, polarity proven. `encoder-polarity`: swap the motor's wires behind the shunts; `overcurrent`, \
            `current-mismatch`: the inputs of both amplifiers; `current-disagreement`: those of one";
    "21" "direction" ByHand: "`crepitus stream`, bend the hinge"
        => "the angle grows; else swap A and B *and* the motor's wires. Armed with `crepitus.render` off: only the gear's friction";
    "22" "grating" ByHand: "preset `coarse`, turn by hand" => "grating, 32 Hz at 1 rad/s; `crepitus record` and `report`";
    "23" "watchdog" Watchdog: "halt the drive with the probe while armed"
        => "its watchdog resets it in 14 to 38 ms, comms disables its line within 7 ms; `drive-watchdog`";
    "24" "lease" Lease: "pull USB while armed; the program renews no lease instead" => "no torque after 0.25 s: `lease-expired`";
    "25" "clamp" ByHand: "clamp: drive the output with a cordless drill, stop pressed, beyond 420 deg/s" => "the supply stays below 30 V";
    "26" "torque" ByHand: "[`crepitus calibrate`](../hardware.md#a-new-brace-calibrate) with a weight; torque on a lever arm with a scale, 0.5 to 4.5 N·m"
        => "3.33 N·m/A within 10 %; on the scale less the losses";
    "27" "limits" Limits: "stops of the brace, by hand, disarmed; then `crepitus zero` with the hinge straight, arm, bend to either stop"
        => "grating fades 5° before the end, none from there on, `outside-range` before or at the stop";
    "28" "people" ByHand: "a weight of a leg (4.3 kg at 0.25 m), then a hand, then a brace on nobody, then a person who holds the stop" => "";
}

/// Markdown without its marks, for a terminal.
pub(super) fn plain(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, link)) = rest.split_once('[') {
        let Some((words, (_, after))) = link
            .split_once("](")
            .and_then(|(words, target)| Some((words, target.split_once(')')?)))
        else {
            break;
        };
        plain += before;
        plain += words;
        rest = after;
    }
    plain += rest;
    plain.replace(['`', '*'], "")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::fmt::Write;
    use std::path::Path;

    const HEAD: &str = "\
# The bring-up, row by row

The rows of `crepitus bring-up`, in their order. The last column is what the program measures; the rest a person sees. Not measured \
on hardware: written from data sheets, and tried on a simulated board. Made and checked by

```text
CREPITUS_BLESS=1 cargo test -p crepitus --bin crepitus bring_up
```

| # | `--rows` | do | expect | measured |
|---|---|---|---|---|
";

    #[test]
    fn the_page_is_made_from_the_rows() {
        let mut page = HEAD.to_owned();
        for row in ROWS {
            // Writing to a String cannot fail.
            let _ = writeln!(
                page,
                "| {} | {} | {} | {} | {} |",
                row.number,
                row.name,
                row.does,
                row.sees,
                row.check.name()
            );
        }
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/generated/bring-up.md");
        if std::env::var_os("CREPITUS_BLESS").is_some_and(|value| value != "0") {
            std::fs::write(&path, &page).unwrap();
        }
        assert_eq!(std::fs::read_to_string(&path).unwrap_or_default(), page);
    }

    #[test]
    fn names_are_unique_and_marks_are_removed() {
        let names: BTreeSet<_> = ROWS.iter().map(|row| row.name).collect();
        assert_eq!(names.len(), ROWS.len());
        assert_eq!(plain("a `b` [c](d#e) *f*"), "a b c f");
    }
}
