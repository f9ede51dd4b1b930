//! Bins as bytes, for the page.
//!
//! ```text
//! header   version u8 ‖ kind u8 ‖ bins u16 ‖ number u32 ‖ unix ms f64 ‖ begin s f64 ‖ bin s f64 ‖ missing u32 ‖ masks u32
//! bin      torque, model, speed, angle, hand: low f32 ‖ high f32 each ‖ states u32 ‖ breaks u16 ‖ marks u16
//! sample   torque f32: instead of bins, for pages that play it as sound
//! ```
//!
//! All little endian; N·m, rad/s, rad; NaN without a value. `hand` is where a hand wants the leg.
//! `number` counts the frames of the live view, which the page answers; in a trace it is the request's.

use crate::live::Bin;
use axum::body::Bytes;
use crepitus_plant::Extremes;

/// Version of the layout.
const VERSION: u8 = 2;

/// Bytes of the header.
pub(crate) const HEADER: usize = 40;

/// Bytes of a bin.
pub(crate) const BIN: usize = 48;

/// Kind of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Kind {
    /// The newest bins; none to keep the connection alive.
    Live = 1,
    /// Bins of a recording.
    Trace = 2,
    /// Samples of the live view.
    Samples = 3,
}

/// Data that a page must not see.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Masks {
    /// Torques.
    pub(crate) torque: bool,
    /// States of effects, and breaks.
    pub(crate) states: bool,
}

/// A frame's header.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Header {
    pub(crate) kind: Kind,
    pub(crate) number: u32,
    /// Time at which the newest sample had arrived.
    pub(crate) unix_ms: f64,
    /// Start of the first bin.
    pub(crate) begin_s: f64,
    /// Length of a bin.
    pub(crate) bin_s: f64,
    /// Samples missing since the frame before.
    pub(crate) missing: u64,
    pub(crate) masks: Masks,
}

/// The frame of these bins; what does not fit is left out.
pub(crate) fn frame(header: &Header, bins: &[Bin]) -> Bytes {
    let (count, mut out) = begun(header, bins.len(), BIN);
    for bin in bins.iter().take(count) {
        append(&mut out, bin, header.masks);
    }
    Bytes::from(out)
}

/// The frame of these torques; what does not fit is left out.
pub(crate) fn samples(header: &Header, torques_nm: &[f32]) -> Bytes {
    let (count, mut out) = begun(header, torques_nm.len(), size_of::<f32>());
    let torques_nm = torques_nm.iter().take(count);
    out.extend(torques_nm.flat_map(|nm| nm.to_le_bytes()));
    Bytes::from(out)
}

/// The header of a frame of so many parts, with room for them, and the number of those that fit.
fn begun(header: &Header, parts: usize, bytes: usize) -> (usize, Vec<u8>) {
    let count = u16::try_from(parts).unwrap_or(u16::MAX);
    let masks = header.masks;
    let mut out = Vec::with_capacity(HEADER + parts * bytes);
    out.extend([VERSION, header.kind as u8]);
    out.extend(count.to_le_bytes());
    out.extend(header.number.to_le_bytes());
    for number in [header.unix_ms, header.begin_s, header.bin_s] {
        out.extend(number.to_le_bytes());
    }
    let missing = u32::try_from(header.missing).unwrap_or(u32::MAX);
    out.extend(missing.to_le_bytes());
    let bits = u32::from(masks.torque) | u32::from(masks.states) << 1;
    out.extend(bits.to_le_bytes());
    (usize::from(count), out)
}

fn append(out: &mut Vec<u8>, bin: &Bin, masks: Masks) {
    let hidden = |shown: Extremes<f32>| {
        if masks.torque {
            Extremes::default()
        } else {
            shown
        }
    };
    for shown in [
        hidden(bin.torque_nm),
        hidden(bin.model_nm),
        bin.speed_rad_s,
        bin.angle_rad,
        bin.hand_rad,
    ] {
        let ends = if shown.is_empty() {
            [f32::NAN; 2]
        } else {
            [shown.low, shown.high]
        };
        out.extend(ends.into_iter().flat_map(f32::to_le_bytes));
    }
    let (states, breaks, marks) = if masks.states {
        // Sticking and slipping would tell crepitus from the others. A patient in pain says so, blind or not.
        (0, 0, bin.marks.without_phase())
    } else {
        (bin.states, bin.breaks, bin.marks)
    };
    out.extend(states.to_le_bytes());
    out.extend(breaks.to_le_bytes());
    out.extend(marks.0.to_le_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::Envelope;
    use crepitus_recording::Row;

    fn header(masks: Masks) -> Header {
        Header {
            kind: Kind::Live,
            number: 7,
            unix_ms: 1.5,
            begin_s: 2.5,
            bin_s: 0.005,
            missing: 3,
            masks,
        }
    }

    fn a_bin() -> Bin {
        let mut envelope = Envelope::new(1);
        envelope.take(&Row {
            torque_nm: 1.0,
            model_torque_nm: 2.0,
            omega_rad_s: 3.0,
            angle_rad: 4.0,
            ..Row::default()
        });
        envelope.hold(4.5);
        Bin {
            states: 5,
            breaks: 6,
            ..envelope.finish().1[0]
        }
    }

    #[test]
    fn a_frame_is_its_header_and_its_bins() {
        let bytes = frame(&header(Masks::default()), &[a_bin(), a_bin()]);
        assert_eq!(bytes.len(), HEADER + 2 * BIN);
        assert_eq!(bytes[..8], [2, 1, 2, 0, 7, 0, 0, 0]);
        let float = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        let values: Vec<_> = (0..10).map(|n| float(HEADER + 4 * n)).collect();
        let expected = [1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.5, 4.5];
        assert_eq!(values, expected);
        // The object sticks: mark 1.
        let rest = [5, 0, 0, 0, 6, 0, 1, 0];
        assert_eq!(bytes[HEADER + 40..HEADER + BIN], rest);
    }

    #[test]
    fn a_frame_of_samples_is_its_header_and_its_torques() {
        let header = Header {
            kind: Kind::Samples,
            ..header(Masks::default())
        };
        let bytes = samples(&header, &[0.5, -2.0]);
        assert_eq!(bytes[..8], [VERSION, 3, 2, 0, 7, 0, 0, 0]);
        assert_eq!(bytes[HEADER..], [0, 0, 0, 63, 0, 0, 0, 192]);
        let many = samples(&header, &vec![0.0; 70_000]);
        assert_eq!(many.len(), HEADER + 4 * usize::from(u16::MAX));
    }

    #[test]
    fn what_is_masked_is_not_in_the_bytes() {
        // Each alone: the one must not stand for the other.
        for (torque, states) in [(true, false), (false, true), (true, true)] {
            let bytes = frame(&header(Masks { torque, states }), &[a_bin()]);
            let float = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
            let torques: Vec<_> = (0..4).map(|n| float(HEADER + 4 * n)).collect();
            if torque {
                assert!(torques.iter().all(|torque| torque.is_nan()));
            } else {
                assert_eq!(torques, [1.0, 1.0, 2.0, 2.0]);
            }
            assert_eq!(float(HEADER + 16), 3.0);
            let rest = if states {
                [0; 8]
            } else {
                [5, 0, 0, 0, 6, 0, 1, 0]
            };
            assert_eq!(bytes[HEADER + 40..], rest);
            assert_eq!(bytes[36], u8::from(torque) | u8::from(states) << 1);
        }
    }
}
