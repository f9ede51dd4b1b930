//! The bridge's pulses and the two current amplifiers, as they are: dead time, lag, and what an edge of the bridge
//! does to an amplifier.
//!
//! Half a tick of the centre-aligned PWM is gone through from edge to edge. Between two edges the winding sees a
//! constant voltage, so its current is a line (to 10⁻⁴ of the ripple, by the midpoint rule):
//!
//! ```text
//! L·di/dt = vA − vB − E − R·i
//! v of a half: U or 0, as its reference says; while both of its switches are open −Ud if the current leaves it,
//!              U + Ud if it enters; a current that reaches zero there stays, unless E or the other half drives it on
//! ```
//!
//! What the winding gets in the mean goes to the plant, whose current is that without ripple. Pulses begin at it; by
//! what a sample is off their mean, it is off the plant's current. They run after it by half of a dead time.
//!
//! **Lag.** Amplifier and filter are one lag λ, whose answer to a line is exact:
//! y = i − λ·i′ + (y₀ − i₀ + λ·i′)·e^(−t/λ). The last term grows by λ·Δi′ at each bend of the current.
//!
//! **Edges.** A half that goes up throws the output of its own amplifier up by D, one that goes down, down; both
//! die away as e^(−t/τ). τ is that with which a disturbance is 0.5 % of half the range (1.65 V, 2.5 A) after the time
//! to settle: τ = t/ln(D/12.5 mA). The amplifier of half B is turned round, so the same disturbance is a current of
//! the other sign.
//!
//! **At the samples** it is enough to have the sum of what bends and edges have left there: usually of four at known
//! places, by tables of λ and τ and a series between (`fading.rs`); else, and at other times, from piece to piece.
//!
//! | number | value | source |
//! |---|---|---|
//! | dead time of the timer | 0.3 µs | `firmware/board/src/bridge.rs` |
//! | of the driver, taken to add | 0.1 µs | DRV8323RH without SPI (M); TI writes that its own follows that of the inputs (E2E 1194540), for other parts that the longer counts |
//! | lag | 0.5 µs | 400 kHz of the INA240 (SBOS662C) are 0.40 µs; 100 Ω and 1 nF are 0.10 µs |
//! | time to settle | 9.6 and 9.8 µs to 0.5 % | TI on INA240 and TIDA-00913 (E2E 796955); the longer is taken for falling edges, which are those before the samples (M) |
//! | D | 0.2 V, 0.30 A | an upper bound: what TI shows of an amplifier without PWM rejection (E2E 1633090); with it 50 mV |
//!
//! Not measured on hardware.

mod fading;
mod pulses;

use crate::effects::motor::winding::WindingSettings;
use fading::{FIRST_SAMPLE_S, Fading, Rests};
use pulses::{FIRST, HalfTick, OTHER, Piece, PlainWay, Pulses, Way};

/// Half a period of the PWM, s.
pub const HALF_S: f64 = 25e-6;

/// Ends of the four samplings of a current, from the middle of the tick, s: a converter holds what is there at the end
/// of 3 of its clocks of 21 MHz, every 15 of them, with the middle of all samplings in that of the tick.
pub const SAMPLES_S: [f64; 4] = [-1.0e-6, -0.285_714e-6, 0.428_571e-6, 1.142_857e-6];

/// Share of half of the range to which an amplifier settles, A: 0.5 % of 1.65 V, at 0.66 V/A.
const SETTLED_A: f64 = 0.012_5;

/// The middle of the samplings, s.
const SAMPLED_S: f64 = (SAMPLES_S[0] + SAMPLES_S[1] + SAMPLES_S[2] + SAMPLES_S[3]) / 4.0;

/// The numbers of the way of a current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentPathSettings {
    /// Dead time, of timer and driver, s.
    pub dead_time_s: f64,
    /// Lag of amplifier and filter, s.
    pub lag_s: f64,
    /// Excursion of an amplifier after an edge of its half, A.
    pub excursion_a: f64,
    /// Time until it has settled after an edge upwards, and downwards, s.
    pub settling_s: [f64; 2],
}

impl CurrentPathSettings {
    /// Returns whether there is anything to compute.
    pub fn is_ideal(&self) -> bool {
        self.dead_time_s <= 0.0 && self.lag_s <= 0.0 && self.excursion_a <= 0.0
    }

    /// Time constants of the excursions, s.
    fn decay_s(&self) -> [f64; 2] {
        let times = (self.excursion_a / SETTLED_A).ln().max(1.0);
        self.settling_s.map(|settling_s| settling_s / times)
    }
}

/// The halves of the bridge: the sensor's amplifier is at A, the monitor's at B.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    /// Drives towards growing angle while its upper switch is closed.
    A,
    /// Drives against it.
    B,
}

/// Rests of bends and edges at a time, seen from the half that switches first.
#[derive(Clone, Copy, Debug, Default)]
struct Left {
    /// The current shown above i − λ·i′, A.
    lag_a: f64,
    /// Rest of the excursions upwards and downwards of either half.
    excursions: [[f64; 2]; 2],
}

impl Left {
    /// Halves that switch between these levels.
    fn switch(&mut self, was: u8, is: u8) {
        for (half, excursions) in [FIRST, OTHER].into_iter().zip(&mut self.excursions) {
            if (was ^ is) & half != 0 {
                excursions[usize::from(is & half == 0)] += 1.0;
            }
        }
    }

    /// Multiplies by what is left of the lag, and of excursions upwards and downwards.
    #[inline]
    fn times(&self, lag: f64, [left_up, left_down]: [f64; 2]) -> Self {
        let [[up, down], [other_up, other_down]] = self.excursions;
        Self {
            lag_a: lag * self.lag_a,
            excursions: [
                [left_up * up, left_down * down],
                [left_up * other_up, left_down * other_down],
            ],
        }
    }
}

/// Levels as the other half sees them.
fn swapped(highs: u8) -> u8 {
    (highs & FIRST) << 1 | highs >> 1
}

/// The way of a motor's current.
#[derive(Clone, Debug)]
pub struct CurrentPath {
    settings: CurrentPathSettings,
    pulses: Pulses,
    lag: Fading,
    /// Excursions upwards, and downwards.
    decays: [Fading; 2],
    /// Distance of edges from the middle of half a tick, s, and rests of the lag with it.
    known_rests: (f64, Rests),
    /// Halves that are high, seen from A; none while the bridge floats.
    highs: Option<u8>,
    last_half: LastHalf,
}

/// The last half tick, seen from the half that switches first.
#[derive(Clone, Debug)]
struct LastHalf {
    /// That half is B.
    is_turned: bool,
    /// None if the bridge floats.
    half: Option<HalfTick>,
    start_a: f64,
    /// Levels before it.
    before: Option<u8>,
    /// The current with its lag as it began, A, and what was left of excursions.
    begun: (f64, [[f64; 2]; 2]),
    /// The last piece.
    piece: Piece,
    /// A time in it at the first sample or later, s, and what was left then.
    sampled: (f64, Left),
    mean_a: f64,
    end_a: f64,
}

impl LastHalf {
    /// Sign of a current that leaves the half that switches first.
    #[inline]
    fn sign(&self) -> f64 {
        if self.is_turned { -1.0 } else { 1.0 }
    }
}

impl CurrentPath {
    /// The way for a winding on a bridge with this supply; none where everything is ideal.
    pub fn new(
        settings: CurrentPathSettings,
        winding: WindingSettings,
        supply_v: f64,
    ) -> Option<Self> {
        if settings.is_ideal() {
            return None;
        }
        let dead_s = settings.dead_time_s;
        let lag = Fading::new(settings.lag_s, dead_s);
        let decay = |decay_s| Fading::new(decay_s, dead_s);
        Some(Self {
            settings,
            pulses: Pulses::new(winding, supply_v, dead_s),
            known_rests: (0.0, lag.rests(0.0)),
            lag,
            decays: settings.decay_s().map(decay),
            highs: None,
            last_half: LastHalf {
                is_turned: false,
                half: None,
                start_a: 0.0,
                before: None,
                begun: (0.0, [[0.0; 2]; 2]),
                piece: Piece::default(),
                sampled: (FIRST_SAMPLE_S, Left::default()),
                mean_a: 0.0,
                end_a: 0.0,
            },
        })
    }

    /// Half a tick of a bridge that floats: its current is seen late, nothing switches.
    pub fn float(&mut self, current_a: f64) {
        self.highs = None;
        self.begin(false);
        self.last_half.half = None;
        self.last_half.start_a = current_a;
        self.fade_by_pieces();
    }

    /// The first or the second half of a tick, from the bottom of the PWM to the middle or back, with a duty from −1
    /// to 1, from this current on. Returns the mean voltage at the winding, V, and the current at the end, A.
    pub fn half(&mut self, is_second: bool, duty: f64, start_a: f64, emf_v: f64) -> (f64, f64) {
        let duty = duty.clamp(-1.0, 1.0);
        self.begin((duty > 0.0) != is_second);
        let sign = self.last_half.sign();
        let half = HalfTick {
            is_second,
            apart_s: HALF_S / 2.0 * duty.abs(),
            emf_v: sign * emf_v,
            start_a: sign * start_a,
        };
        self.last_half.half = Some(half);
        self.last_half.start_a = half.start_a;
        let is_usual = self.highs.is_none_or(|highs| highs == half.was());
        match self.pulses.plain_way(&half) {
            Some(way) if is_usual => self.fade(&half, &way),
            _ => self.fade_by_pieces(),
        }
        let LastHalf { mean_a, end_a, .. } = self.last_half;
        let mean_v = self.pulses.mean_v(&half, mean_a, end_a);
        (sign * mean_v, sign * end_a)
    }

    /// Begins half a tick with what the last one has left, seen from the half that switches first now.
    #[inline]
    fn begin(&mut self, is_turned: bool) {
        let last = &self.last_half;
        let (from_s, left) = &last.sampled;
        let [up, down] = &self.decays;
        let left = if *from_s == FIRST_SAMPLE_S {
            left.times(self.lag.to_end, [up.to_end, down.to_end])
        } else {
            self.faded(left, HALF_S - from_s)
        };
        let behind_a = self.settings.lag_s * last.piece.slope_a_per_s;
        let shown_a = last.end_a - behind_a + left.lag_a;
        let [first, other] = left.excursions;
        let last = &mut self.last_half;
        last.begun = if is_turned == last.is_turned {
            (shown_a, [first, other])
        } else {
            last.is_turned = is_turned;
            (-shown_a, [other, first])
        };
    }

    /// Fades what is left through a plain way.
    #[inline]
    fn fade(&mut self, half: &HalfTick, way: &PlainWay) {
        if self.known_rests.0 != half.apart_s {
            self.known_rests = (half.apart_s, self.lag.rests(half.apart_s));
        }
        let Rests { earlier, later } = self.known_rests.1;
        let inner = if way.is_overlapping {
            [later[0], earlier[1]]
        } else {
            [earlier[1], later[0]]
        };
        let [zeroth, first, second, third, fourth] = way.slopes_a_per_s;
        let bends = (first - zeroth) * earlier[0]
            + (second - first) * inner[0]
            + (third - second) * inner[1]
            + (fourth - third) * later[1];
        let last = &mut self.last_half;
        let lag_s = self.settings.lag_s;
        let (shown_a, [of_first, of_other]) = last.begun;
        let begun_a = shown_a - half.start_a + lag_s * zeroth;
        let [up, down] = &self.decays;
        let decay = if half.is_second { up } else { down };
        let Rests { earlier, later } = decay.rests(half.apart_s);
        // Upwards in the second half of a tick, downwards in the first.
        let thrown = |[was_up, was_down]: [f64; 2], rest: f64| {
            let left = [was_up * up.to_first, was_down * down.to_first];
            if half.is_second {
                [left[0] + rest, left[1]]
            } else {
                [left[0], left[1] + rest]
            }
        };
        let of_first = thrown(of_first, earlier[usize::from(way.is_held[0])]);
        let of_other = thrown(of_other, later[usize::from(way.is_held[1])]);
        let left = Left {
            lag_a: begun_a * self.lag.to_first + lag_s * bends,
            excursions: [of_first, of_other],
        };
        last.before = self.highs;
        last.sampled = (FIRST_SAMPLE_S, left);
        last.piece = way.last;
        last.mean_a = way.charge_as / HALF_S;
        last.end_a = way.end_a;
        self.highs = Some(half.is());
    }

    /// Fades what is left from piece to piece.
    #[cold]
    fn fade_by_pieces(&mut self) {
        let is_turned = self.last_half.is_turned;
        let turned = |highs| if is_turned { swapped(highs) } else { highs };
        self.last_half.before = self.highs.map(turned);
        let way = self.way();
        let piece = way.pieces().last().copied().unwrap_or_default();
        let from_s = piece.from_s.max(FIRST_SAMPLE_S);
        let (_, left) = self.left_at(&way, from_s);
        let last = &mut self.last_half;
        last.sampled = (from_s, left);
        last.piece = piece;
        last.mean_a = way.charge_as / HALF_S;
        last.end_a = way.end_a;
        self.highs = last.half.map(|_| turned(piece.highs));
    }

    /// The last half tick in pieces.
    fn way(&self) -> Way {
        let LastHalf {
            half,
            start_a,
            before,
            ..
        } = &self.last_half;
        match half {
            Some(half) => self.pulses.way(half, *before),
            None => Way::floating(*start_a),
        }
    }

    #[inline]
    fn faded(&self, left: &Left, length_s: f64) -> Left {
        let [up, down] = &self.decays;
        left.times(
            self.lag.left(length_s),
            [up.left(length_s), down.left(length_s)],
        )
    }

    /// The piece at a time, and what is left then.
    fn left_at(&self, way: &Way, at_s: f64) -> (Piece, Left) {
        let lag_s = self.settings.lag_s;
        let LastHalf { begun, before, .. } = &self.last_half;
        let (shown_a, excursions) = *begun;
        let mut pieces = way.pieces().iter();
        let mut piece = pieces.next().copied().unwrap_or_default();
        let mut left = Left {
            lag_a: shown_a - piece.current_a + lag_s * piece.slope_a_per_s,
            excursions,
        };
        left.switch(before.unwrap_or(piece.highs), piece.highs);
        for next in pieces.take_while(|next| next.from_s <= at_s) {
            left = self.faded(&left, next.from_s - piece.from_s);
            left.lag_a += lag_s * (next.slope_a_per_s - piece.slope_a_per_s);
            left.switch(piece.highs, next.highs);
            piece = *next;
        }
        (piece, self.faded(&left, at_s - piece.from_s))
    }

    /// The current as the amplifier at a half shows it `at_s` after the last half tick began, A. Shortly beyond its
    /// end, too: nothing switches there.
    pub fn shown_a(&self, half: Half, at_s: f64) -> f64 {
        let (from_s, left) = &self.last_half.sampled;
        let (piece, left) = if at_s >= *from_s {
            (self.last_half.piece, self.faded(left, at_s - from_s))
        } else {
            self.left_at(&self.way(), at_s)
        };
        self.shows_a(&piece, at_s, &left)[half as usize]
    }

    /// The current as the amplifiers at both halves show it, A.
    #[inline]
    fn shows_a(&self, piece: &Piece, at_s: f64, left: &Left) -> [f64; 2] {
        let behind_a = self.settings.lag_s * piece.slope_a_per_s;
        let lagged_a = self.last_half.sign() * (piece.current_a(at_s) - behind_a + left.lag_a);
        let thrown_a = |[up, down]: [f64; 2]| self.settings.excursion_a * (up - down);
        let [first, other] = left.excursions;
        let [a, b] = if self.last_half.is_turned {
            [other, first]
        } else {
            [first, other]
        };
        [lagged_a + thrown_a(a), lagged_a - thrown_a(b)]
    }

    /// Mean of the current over the last half tick, A.
    pub fn mean_a(&self) -> f64 {
        self.last_half.sign() * self.last_half.mean_a
    }

    /// The current at the end of the last half tick without its ripple, A: that of the plant, which the pulses of a
    /// dead time run after by half of it.
    #[inline]
    pub fn even_a(&self) -> f64 {
        let last = &self.last_half;
        last.sign() * (last.mean_a + 0.5 * (last.end_a - last.start_a))
    }

    /// The mean of the samples of a tick around the end of the last half tick by the amplifiers of both halves, A.
    #[inline]
    pub fn samples_a(&self) -> [f64; 2] {
        let (from_s, left) = &self.last_half.sampled;
        if *from_s > FIRST_SAMPLE_S {
            return [Half::A, Half::B].map(|half| {
                let shown_a = SAMPLES_S.map(|at_s| self.shown_a(half, HALF_S + at_s));
                shown_a.iter().sum::<f64>() / 4.0
            });
        }
        let [up, down] = &self.decays;
        let left = left.times(self.lag.sampled, [up.sampled, down.sampled]);
        self.shows_a(&self.last_half.piece, HALF_S + SAMPLED_S, &left)
    }

    /// The mean of the samples of a tick around the end of the last half tick, A.
    pub fn sampled_a(&self, half: Half) -> f64 {
        self.samples_a()[half as usize]
    }
}

#[cfg(test)]
mod tests;
