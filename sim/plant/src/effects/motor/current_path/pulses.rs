//! The current through half a tick, from edge to edge.
//!
//! All of it is seen from the half that switches first: a positive current leaves that half and enters the other.

use super::HALF_S;
use super::fading::FIRST_SAMPLE_S;
use crate::effects::motor::winding::WindingSettings;
use crepitus_model::control::current_path::DIODE_V;

/// Bits of the halves in a level: the one that switches first, and the other.
pub(super) const FIRST: u8 = 1;
pub(super) const OTHER: u8 = 2;
const BOTH: u8 = FIRST | OTHER;

/// Pieces of half a tick at most: five between its edges and the ends of their dead times, and one more after a zero of
/// the current in each of up to three in which a half is open.
const MOST_PIECES: usize = 8;

/// Half a tick of a bridge.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfTick {
    /// From the middle of the PWM to its bottom, so that the halves go up.
    pub(super) is_second: bool,
    /// Distance of both edges from the middle of the half tick, s.
    pub(super) apart_s: f64,
    /// Back-EMF, V.
    pub(super) emf_v: f64,
    /// The current as it begins, A.
    pub(super) start_a: f64,
}

impl HalfTick {
    /// The halves that are high before their edges.
    #[inline]
    pub(super) fn was(&self) -> u8 {
        if self.is_second { 0 } else { BOTH }
    }

    /// The halves that are high after their edges.
    #[inline]
    pub(super) fn is(&self) -> u8 {
        BOTH ^ self.was()
    }
}

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

/// A way through half a tick: its pieces, and their sums.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pieces: [Piece; MOST_PIECES],
    count: usize,
    now_s: f64,
    /// Charge, A·s.
    pub(super) charge_as: f64,
    /// The current at the end, A.
    pub(super) end_a: f64,
}

/// A way of five pieces between edges and ends of dead times, in all of which the current flows as it began.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlainWay {
    pub(super) slopes_a_per_s: [f64; 5],
    /// The dead time of the earlier edge ends after the later edge.
    pub(super) is_overlapping: bool,
    /// The halves have the level before their edges until the end of their dead times.
    pub(super) is_held: [bool; 2],
    pub(super) last: Piece,
    /// Charge, A·s.
    pub(super) charge_as: f64,
    /// The current at the end, A.
    pub(super) end_a: f64,
}

/// Voltages at the winding.
#[derive(Clone, Copy, Debug)]
struct Volts {
    /// In the dead time of either half, with a current that leaves the first half, and with one that enters it.
    dead: [f64; 2],
    /// Between the dead times of both.
    between: f64,
}

/// A winding on a bridge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pulses {
    winding: WindingSettings,
    dead_s: f64,
    /// Voltages in the first and in the second half of a tick.
    volts: [Volts; 2],
    /// Voltage of two diodes and the supply, V.
    open_v: f64,
    /// Distance of edges at most if their dead times end before the first sample, s.
    most_apart_s: f64,
}

impl Pulses {
    pub(super) fn new(winding: WindingSettings, supply_v: f64, dead_s: f64) -> Self {
        let (low_v, above_v) = (DIODE_V, supply_v + DIODE_V);
        Self {
            winding,
            dead_s,
            volts: [
                Volts {
                    dead: [-above_v, low_v],
                    between: -supply_v,
                },
                Volts {
                    dead: [-low_v, above_v],
                    between: supply_v,
                },
            ],
            open_v: above_v + DIODE_V,
            most_apart_s: FIRST_SAMPLE_S - HALF_S / 2.0 - dead_s,
        }
    }

    /// Mean voltage at the winding over half a tick, V, of what it does.
    #[inline]
    pub(super) fn mean_v(&self, half: &HalfTick, mean_a: f64, end_a: f64) -> f64 {
        let WindingSettings {
            resistance_ohm,
            inductance_h,
            ..
        } = self.winding;
        half.emf_v + resistance_ohm * mean_a + inductance_h / HALF_S * (end_a - half.start_a)
    }

    /// Slope of a current over a time at this voltage beyond back-EMF, A/s, by the midpoint rule.
    #[inline]
    fn slope_a_per_s(&self, volts: f64, current_a: f64, length_s: f64) -> f64 {
        let ohm = self.winding.resistance_ohm;
        (volts - ohm * current_a) / (self.winding.inductance_h + 0.5 * ohm * length_s)
    }

    /// A way through half a tick, if it is plain and all its edges are over at the first sample: [`Self::way`] without
    /// what then cannot be.
    #[inline]
    pub(super) fn plain_way(&self, half: &HalfTick) -> Option<PlainWay> {
        let HalfTick {
            is_second,
            apart_s,
            emf_v,
            start_a,
        } = *half;
        if apart_s > self.most_apart_s {
            return None;
        }
        let volts = &self.volts[usize::from(is_second)];
        let dead_v = |leaves: bool| if leaves { volts.dead[0] } else { volts.dead[1] } - emf_v;
        let before_s = HALF_S / 2.0 - apart_s;
        let after_s = before_s - self.dead_s;
        let between_s = 2.0 * apart_s - self.dead_s;
        let is_overlapping = between_s < 0.0;
        let zeroth = self.slope_a_per_s(-emf_v, start_a, before_s);
        let first_a = start_a + zeroth * before_s;
        let leaves = first_a > 0.0;
        let (dead_s, inner_s, inner_v) = if is_overlapping {
            let open_v = if leaves { -self.open_v } else { self.open_v };
            (2.0 * apart_s, -between_s, open_v)
        } else {
            (self.dead_s, between_s, volts.between)
        };
        let first = self.slope_a_per_s(dead_v(leaves), first_a, dead_s);
        let second_a = first_a + first * dead_s;
        let second = self.slope_a_per_s(inner_v - emf_v, second_a, inner_s);
        let third_a = second_a + second * inner_s;
        let enters_other = third_a > 0.0;
        let third = self.slope_a_per_s(dead_v(enters_other), third_a, dead_s);
        let fourth_a = third_a + third * dead_s;
        let fourth = self.slope_a_per_s(-emf_v, fourth_a, after_s);
        let end_a = fourth_a + fourth * after_s;
        let flows = first_a * second_a > 0.0
            && third_a * fourth_a > 0.0
            && (!is_overlapping || second_a * third_a > 0.0);
        let charge_as = before_s * (start_a + first_a)
            + dead_s * (first_a + second_a + third_a + fourth_a)
            + inner_s * (second_a + third_a)
            + after_s * (fourth_a + end_a);
        flows.then_some(PlainWay {
            slopes_a_per_s: [zeroth, first, second, third, fourth],
            is_overlapping,
            is_held: [leaves == is_second, enters_other != is_second],
            last: Piece {
                from_s: HALF_S / 2.0 + apart_s + self.dead_s,
                current_a: fourth_a,
                slope_a_per_s: fourth,
                highs: half.is(),
            },
            charge_as: 0.5 * charge_as,
            end_a,
        })
    }

    /// A way through half a tick, with these halves high before it.
    pub(super) fn way(&self, half: &HalfTick, before: Option<u8>) -> Way {
        let (was, is) = (half.was(), half.is());
        let volts = &self.volts[usize::from(half.is_second)];
        // A current that leaves the first half enters the other.
        let first = Dead {
            volts: volts.dead,
            highs: [was & OTHER, was & OTHER | FIRST],
            open: FIRST,
        };
        let other = Dead {
            volts: volts.dead,
            highs: [is & FIRST | OTHER, is & FIRST],
            open: OTHER,
        };
        let both = Dead {
            volts: [-self.open_v, self.open_v],
            highs: [OTHER, FIRST],
            open: BOTH,
        };
        let earlier_s = HALF_S / 2.0 - half.apart_s;
        let later_s = HALF_S / 2.0 + half.apart_s;
        let closes_s = (earlier_s + self.dead_s).min(HALF_S);
        let end_s = (later_s + self.dead_s).min(HALF_S);
        let emf_v = half.emf_v;
        let mut way = Way::from(half.start_a);
        way.pass(self, -emf_v, was, earlier_s);
        if closes_s > later_s {
            way.pass_dead(self, &first, (emf_v, before), later_s);
            way.pass_dead(self, &both, (emf_v, before), closes_s);
        } else {
            way.pass_dead(self, &first, (emf_v, before), closes_s);
            way.pass(
                self,
                volts.between - emf_v,
                is & FIRST | was & OTHER,
                later_s,
            );
        }
        way.pass_dead(self, &other, (emf_v, before), end_s);
        way.pass(self, -emf_v, is, HALF_S);
        way
    }
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

impl Way {
    /// A way that begins with this current, A.
    fn from(start_a: f64) -> Self {
        Self {
            pieces: [Piece::default(); MOST_PIECES],
            count: 0,
            now_s: 0.0,
            charge_as: 0.0,
            end_a: start_a,
        }
    }

    /// Half a tick of a bridge that floats: this current flows on.
    pub(super) fn floating(current_a: f64) -> Self {
        let mut way = Self::from(current_a);
        way.push(0.0, 0);
        way.go(HALF_S, HALF_S, current_a);
        way
    }

    /// The pieces.
    pub(super) fn pieces(&self) -> &[Piece] {
        &self.pieces[..self.count]
    }

    /// Goes on with both halves driven, at this voltage beyond back-EMF.
    fn pass(&mut self, pulses: &Pulses, volts: f64, highs: u8, until_s: f64) {
        let length_s = until_s - self.now_s;
        if length_s > 0.0 {
            let slope = pulses.slope_a_per_s(volts, self.end_a, length_s);
            self.push(slope, highs);
            self.go(until_s, length_s, self.end_a + slope * length_s);
        }
    }

    /// Goes on through a dead time: the current chooses the level, and one that reaches zero stays there, unless back-EMF
    /// or the other half drives it on.
    fn pass_dead(
        &mut self,
        pulses: &Pulses,
        dead: &Dead,
        (emf_v, before): (f64, Option<u8>),
        until_s: f64,
    ) {
        // To a zero and on from there: what drives the current on does so until the end.
        for _ in 0..2 {
            let length_s = until_s - self.now_s;
            // A zero that is at the end itself is none.
            if length_s < 1e-15 {
                return;
            }
            let current_a = self.end_a;
            let leaves = if current_a == 0.0 {
                let leaves = dead.volts[0] > emf_v;
                if !leaves && dead.volts[1] >= emf_v {
                    let last = self.pieces().last().map(|piece| piece.highs);
                    let held = last.or(before).unwrap_or(0);
                    self.push(0.0, held & dead.open | dead.highs[0] & !dead.open);
                    self.go(until_s, length_s, 0.0);
                    return;
                }
                leaves
            } else {
                current_a > 0.0
            };
            let way = usize::from(!leaves);
            let slope = pulses.slope_a_per_s(dead.volts[way] - emf_v, current_a, length_s);
            let end_a = current_a + slope * length_s;
            self.push(slope, dead.highs[way]);
            if current_a * end_a >= 0.0 {
                self.go(until_s, length_s, end_a);
                return;
            }
            let length_s = -current_a / slope;
            self.go(self.now_s + length_s, length_s, 0.0);
        }
    }

    fn push(&mut self, slope_a_per_s: f64, highs: u8) {
        if let Some(piece) = self.pieces.get_mut(self.count) {
            *piece = Piece {
                from_s: self.now_s,
                current_a: self.end_a,
                slope_a_per_s,
                highs,
            };
            self.count += 1;
        }
    }

    fn go(&mut self, to_s: f64, length_s: f64, end_a: f64) {
        self.charge_as += 0.5 * length_s * (self.end_a + end_a);
        self.now_s = to_s;
        self.end_a = end_a;
    }
}
