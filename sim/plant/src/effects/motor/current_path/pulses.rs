//! The current through half a tick, from edge to edge.
//!
//! All of it is seen from the half that switches first: a positive current leaves that half and enters the other.

use super::HALF_S;
use crate::effects::motor::winding::WindingSettings;
use crepitus_model::control::current_path::DIODE_V;

/// Bits of the halves in a level: the one that switches first, and the other.
pub(super) const FIRST: u8 = 1;
pub(super) const OTHER: u8 = 2;

/// Pieces of half a tick at most: five between its edges and the ends of their dead times, and one more after a zero of
/// the current in each of up to three in which a half is open.
const MOST_PIECES: usize = 8;

/// A stretch with a constant voltage.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Piece {
    pub(super) from_s: f64,
    pub(super) current_a: f64,
    pub(super) slope_a_per_s: f64,
    /// The halves that are high.
    pub(super) highs: u8,
}

impl Piece {
    /// The current, A.
    #[inline]
    pub(super) fn current_a(&self, at_s: f64) -> f64 {
        self.current_a + self.slope_a_per_s * (at_s - self.from_s)
    }
}

/// Half a tick of a bridge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Duty {
    /// From the middle of the PWM to its bottom, so that the halves go up.
    pub(super) is_second: bool,
    /// Distance of both edges from the middle of the half tick, s.
    pub(super) apart_s: f64,
    /// Back-EMF, V.
    pub(super) emf_v: f64,
}

/// The last half tick of a winding on a bridge.
#[derive(Clone, Debug)]
pub(super) struct Pulses {
    winding: WindingSettings,
    supply_v: f64,
    dead_s: f64,
    pieces: [Piece; MOST_PIECES],
    count: usize,
    /// Five pieces between edges and ends of dead times, in all of which the current flows as it began.
    pub(super) is_plain: bool,
    /// The later edge is within the dead time of the earlier.
    pub(super) is_overlapping: bool,
    /// Mean of the voltage at the winding, V.
    pub(super) mean_v: f64,
    /// Mean of the current, A.
    pub(super) mean_a: f64,
    /// The current at the end, A.
    pub(super) end_a: f64,
}

/// The place on a way through half a tick.
#[derive(Clone, Copy, Debug)]
struct Place {
    now_s: f64,
    current_a: f64,
    emf_v: f64,
    volt_seconds: f64,
    /// Twice the charge so far, A·s.
    charges_as: f64,
}

/// A dead time, with what it is in either sense of the current: one that leaves the first half, and one that enters it.
#[derive(Clone, Copy, Debug)]
struct Dead {
    /// Voltage at the winding, V.
    volts: [f64; 2],
    highs: [u8; 2],
    /// The halves whose switches are open.
    open: u8,
}

impl Pulses {
    pub(super) fn new(winding: WindingSettings, supply_v: f64, dead_s: f64) -> Self {
        Self {
            winding,
            supply_v,
            dead_s,
            pieces: [Piece::default(); MOST_PIECES],
            count: 1,
            is_plain: false,
            is_overlapping: false,
            mean_v: 0.0,
            mean_a: 0.0,
            end_a: 0.0,
        }
    }

    /// The pieces, from the beginning: at least one.
    pub(super) fn pieces(&self) -> &[Piece] {
        &self.pieces[..self.count]
    }

    /// The pieces of a half tick that is plain.
    pub(super) fn five(&self) -> [&Piece; 5] {
        let [a, b, c, d, e, ..] = &self.pieces;
        [a, b, c, d, e]
    }

    /// The first piece.
    pub(super) fn first(&self) -> &Piece {
        &self.pieces[0]
    }

    /// The last piece.
    pub(super) fn last(&self) -> &Piece {
        &self.pieces[self.count - 1]
    }

    /// Half a tick in which nothing switches.
    pub(super) fn float(&mut self, current_a: f64) {
        self.pieces[0] = Piece {
            current_a,
            ..Piece::default()
        };
        self.count = 1;
        self.is_plain = false;
        (self.mean_a, self.end_a) = (current_a, current_a);
    }

    /// Half a tick from this current on, with these halves high before it.
    pub(super) fn run(&mut self, duty: &Duty, start_a: f64, before: Option<u8>) {
        let (high_v, diode_v) = (self.supply_v, DIODE_V);
        let (was, is) = if duty.is_second {
            (0, FIRST | OTHER)
        } else {
            (FIRST | OTHER, 0)
        };
        let (was_v, is_v) = if duty.is_second {
            (0.0, high_v)
        } else {
            (high_v, 0.0)
        };
        let [low_v, above_v] = [-diode_v, high_v + diode_v];
        // A current that leaves the first half enters the other.
        let first = Dead {
            volts: [low_v - was_v, above_v - was_v],
            highs: [was & OTHER, was & OTHER | FIRST],
            open: FIRST,
        };
        let other = Dead {
            volts: [is_v - above_v, is_v - low_v],
            highs: [is & FIRST | OTHER, is & FIRST],
            open: OTHER,
        };
        let earlier_s = HALF_S / 2.0 - duty.apart_s;
        let later_s = HALF_S / 2.0 + duty.apart_s;
        let closes_s = (earlier_s + self.dead_s).min(HALF_S);
        let end_s = (later_s + self.dead_s).min(HALF_S);
        let mut place = Place {
            now_s: 0.0,
            current_a: start_a,
            emf_v: duty.emf_v,
            volt_seconds: 0.0,
            charges_as: 0.0,
        };
        self.count = 0;
        self.is_plain = true;
        self.is_overlapping = closes_s > later_s;
        self.pass(&mut place, 0.0, was, earlier_s);
        if self.is_overlapping {
            let both = Dead {
                volts: [low_v - above_v, above_v - low_v],
                highs: [OTHER, FIRST],
                open: FIRST | OTHER,
            };
            self.pass_dead(&mut place, &first, before, later_s);
            self.pass_dead(&mut place, &both, before, closes_s);
        } else {
            self.pass_dead(&mut place, &first, before, closes_s);
            self.pass(&mut place, is_v - was_v, is & FIRST | was & OTHER, later_s);
        }
        self.pass_dead(&mut place, &other, before, end_s);
        self.pass(&mut place, 0.0, is, HALF_S);
        self.is_plain &= self.count == 5;
        self.mean_v = place.volt_seconds / HALF_S;
        self.mean_a = 0.5 * place.charges_as / HALF_S;
        self.end_a = place.current_a;
    }

    /// Slope of the current over a time at this voltage, A/s, by the midpoint rule.
    #[inline]
    fn slope_a_per_s(&self, place: &Place, volts: f64, length_s: f64) -> f64 {
        let ohm = self.winding.resistance_ohm;
        (volts - place.emf_v - ohm * place.current_a)
            / (self.winding.inductance_h + 0.5 * ohm * length_s)
    }

    /// Goes on with both halves driven.
    #[inline]
    fn pass(&mut self, place: &mut Place, volts: f64, highs: u8, until_s: f64) {
        let length_s = until_s - place.now_s;
        if length_s > 0.0 {
            let slope = self.slope_a_per_s(place, volts, length_s);
            let end_a = place.current_a + slope * length_s;
            self.push(place, slope, highs);
            place.go(until_s, length_s, volts, end_a);
        }
    }

    /// Goes on through a dead time: the current chooses the level, and one that reaches zero stays there, unless back-EMF
    /// or the other half drives it on.
    #[inline]
    fn pass_dead(&mut self, place: &mut Place, dead: &Dead, before: Option<u8>, until_s: f64) {
        // To a zero and on from there: what drives the current on does so until the end.
        for _ in 0..2 {
            let length_s = until_s - place.now_s;
            // A zero that is at the end itself is none.
            if length_s < 1e-15 {
                return;
            }
            let enters = if place.current_a == 0.0 {
                self.is_plain = false;
                let leaves = dead.volts[0] > place.emf_v;
                if !leaves && dead.volts[1] >= place.emf_v {
                    let last = self.pieces().last().map(|piece| piece.highs);
                    let held = last.or(before).unwrap_or(0);
                    let highs = held & dead.open | dead.highs[0] & !dead.open;
                    self.push(place, 0.0, highs);
                    place.go(until_s, length_s, place.emf_v, 0.0);
                    return;
                }
                !leaves
            } else {
                place.current_a < 0.0
            };
            let way = usize::from(enters);
            let (volts, highs) = (dead.volts[way], dead.highs[way]);
            let slope = self.slope_a_per_s(place, volts, length_s);
            let end_a = place.current_a + slope * length_s;
            self.push(place, slope, highs);
            if place.current_a * end_a >= 0.0 {
                place.go(until_s, length_s, volts, end_a);
                return;
            }
            self.is_plain = false;
            let length_s = -place.current_a / slope;
            place.go(place.now_s + length_s, length_s, volts, 0.0);
        }
    }

    #[inline]
    fn push(&mut self, place: &Place, slope_a_per_s: f64, highs: u8) {
        if let Some(piece) = self.pieces.get_mut(self.count) {
            *piece = Piece {
                from_s: place.now_s,
                current_a: place.current_a,
                slope_a_per_s,
                highs,
            };
            self.count += 1;
        }
    }
}

impl Place {
    #[inline]
    fn go(&mut self, to_s: f64, length_s: f64, volts: f64, end_a: f64) {
        self.volt_seconds += volts * length_s;
        self.charges_as += length_s * (self.current_a + end_a);
        self.now_s = to_s;
        self.current_a = end_a;
    }
}
