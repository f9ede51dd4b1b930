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
//! places, by one exponential for each of λ and τ (`fading.rs`); else from piece to piece.
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
use pulses::{Duty, FIRST, OTHER, Piece, Pulses};

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

/// What is left of bends and edges at a time, seen from the half that switches first.
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
    lag: Fading,
    /// Excursions upwards, and downwards.
    decays: [Fading; 2],
    /// Distance of edges from the middle of half a tick, s, and rests of the lag with it.
    known_rests: (f64, Rests),
    /// Halves that are high, seen from A; none while the bridge floats.
    highs: Option<u8>,
    /// The last half tick.
    pulses: Pulses,
    /// Half B switched first in it.
    is_turned: bool,
    /// What was left as it began.
    begun: Left,
    /// A time near the first sample, s, after which there is neither bend nor edge, and what was left then.
    sampled: (f64, Left),
    /// What was left at its end.
    ended: Left,
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
            lag,
            decays: settings.decay_s().map(decay),
            known_rests: (0.0, lag.rests(0.0)),
            highs: None,
            pulses: Pulses::new(winding, supply_v, dead_s),
            is_turned: false,
            begun: Left::default(),
            sampled: (FIRST_SAMPLE_S, Left::default()),
            ended: Left::default(),
        })
    }

    /// Half a tick of a bridge that floats: its current is seen late, nothing switches.
    pub fn float(&mut self, current_a: f64) {
        let shown_a = self.turn(false);
        self.pulses.float(current_a);
        self.begin(shown_a);
        self.highs = None;
        self.fade_by_pieces();
    }

    /// The first or the second half of a tick, from the bottom of the PWM to the middle or back, with a duty from −1
    /// to 1, from this current on. Returns the mean voltage at the winding, V, and the current at the end, A.
    pub fn half(&mut self, is_second: bool, duty: f64, start_a: f64, emf_v: f64) -> (f64, f64) {
        let duty = duty.clamp(-1.0, 1.0);
        let is_turned = (duty > 0.0) != is_second;
        let shown_a = self.turn(is_turned);
        let sign = self.sign();
        let half = Duty {
            is_second,
            apart_s: HALF_S / 2.0 * duty.abs(),
            emf_v: sign * emf_v,
        };
        let turned = |highs| if is_turned { swapped(highs) } else { highs };
        let before = self.highs.map(turned);
        self.pulses.run(&half, sign * start_a, before);
        self.begin(shown_a);
        let (first, last) = (self.pulses.first().highs, self.pulses.last());
        let (highs, last_s) = (last.highs, last.from_s);
        self.highs = Some(turned(highs));
        let before = before.unwrap_or(first);
        if self.pulses.is_plain && last_s <= FIRST_SAMPLE_S && before == first {
            self.fade(&half);
        } else {
            self.begun.switch(before, first);
            self.fade_by_pieces();
        }
        (sign * self.pulses.mean_v, sign * self.pulses.end_a)
    }

    /// Sign of a current that leaves the half that switches first.
    fn sign(&self) -> f64 {
        if self.is_turned { -1.0 } else { 1.0 }
    }

    /// Turns to the half that switches first, with what the end of the last half tick has left. Returns the current with
    /// its lag, A.
    fn turn(&mut self, is_turned: bool) -> f64 {
        let behind_a = self.settings.lag_s * self.pulses.last().slope_a_per_s;
        let shown_a = self.pulses.end_a - behind_a + self.ended.lag_a;
        let [first, other] = self.ended.excursions;
        if is_turned == self.is_turned {
            self.begun.excursions = [first, other];
            return shown_a;
        }
        self.is_turned = is_turned;
        self.begun.excursions = [other, first];
        -shown_a
    }

    /// Begins with the current that was shown, A.
    fn begin(&mut self, shown_a: f64) {
        let first = self.pulses.first();
        let behind_a = self.settings.lag_s * first.slope_a_per_s;
        self.begun.lag_a = shown_a - first.current_a + behind_a;
    }

    /// Fades what is left through five pieces, in which either half has one edge.
    fn fade(&mut self, half: &Duty) {
        if self.known_rests.0 != half.apart_s {
            self.known_rests = (half.apart_s, self.lag.rests(half.apart_s));
        }
        let Rests { earlier, later } = self.known_rests.1;
        let [up, down] = &self.decays;
        let [a, b, c, d, e] = self.pulses.five();
        let slopes = [a, b, c, d, e].map(|piece| piece.slope_a_per_s);
        let inner = if self.pulses.is_overlapping {
            [later[0], earlier[1]]
        } else {
            [earlier[1], later[0]]
        };
        let bends = (slopes[1] - slopes[0]) * earlier[0]
            + (slopes[2] - slopes[1]) * inner[0]
            + (slopes[3] - slopes[2]) * inner[1]
            + (slopes[4] - slopes[3]) * later[1];
        let mut left = self
            .begun
            .times(self.lag.to_first, [up.to_first, down.to_first]);
        left.lag_a += self.settings.lag_s * bends;
        let way = usize::from(!half.is_second);
        let Rests { earlier, later } = self.decays[way].rests(half.apart_s);
        // A diode holds the level for a dead time, or takes that which follows.
        let is_held = [
            (a.highs ^ b.highs) & FIRST == 0,
            (d.highs ^ e.highs) & OTHER != 0,
        ];
        left.excursions[0][way] += earlier[usize::from(is_held[0])];
        left.excursions[1][way] += later[usize::from(is_held[1])];
        self.ended = left.times(self.lag.to_end, [up.to_end, down.to_end]);
        self.sampled = (FIRST_SAMPLE_S, left);
    }

    /// Fades what is left from piece to piece.
    fn fade_by_pieces(&mut self) {
        let from_s = self.pulses.last().from_s.max(FIRST_SAMPLE_S);
        let (_, left) = self.left_at(from_s);
        self.ended = self.faded(&left, HALF_S - from_s);
        self.sampled = (from_s, left);
    }

    fn faded(&self, left: &Left, length_s: f64) -> Left {
        let [up, down] = &self.decays;
        left.times(
            self.lag.left(length_s),
            [up.left(length_s), down.left(length_s)],
        )
    }

    /// The piece at a time, and what is left then.
    fn left_at(&self, at_s: f64) -> (&Piece, Left) {
        let (mut piece, mut left) = (self.pulses.first(), self.begun);
        let others = self.pulses.pieces().iter().skip(1);
        for next in others.take_while(|next| next.from_s <= at_s) {
            left = self.faded(&left, next.from_s - piece.from_s);
            left.lag_a += self.settings.lag_s * (next.slope_a_per_s - piece.slope_a_per_s);
            left.switch(piece.highs, next.highs);
            piece = next;
        }
        (piece, self.faded(&left, at_s - piece.from_s))
    }

    /// The current as the amplifier at a half shows it `at_s` after the last half tick began, A. Shortly beyond its
    /// end, too: nothing switches there.
    pub fn shown_a(&self, half: Half, at_s: f64) -> f64 {
        let (from_s, left) = &self.sampled;
        let (piece, left) = if at_s >= *from_s {
            (self.pulses.last(), self.faded(left, at_s - from_s))
        } else {
            self.left_at(at_s)
        };
        self.shows_a(half, piece, at_s, &left)
    }

    /// The current as the amplifier at a half shows it, A.
    fn shows_a(&self, half: Half, piece: &Piece, at_s: f64, left: &Left) -> f64 {
        let behind_a = self.settings.lag_s * piece.slope_a_per_s;
        let lagged_a = self.sign() * (piece.current_a(at_s) - behind_a + left.lag_a);
        let is_other = (half == Half::B) != self.is_turned;
        let [up, down] = left.excursions[usize::from(is_other)];
        let thrown_a = self.settings.excursion_a * (up - down);
        match half {
            Half::A => lagged_a + thrown_a,
            Half::B => lagged_a - thrown_a,
        }
    }

    /// Mean of the current over the last half tick, A.
    pub fn mean_a(&self) -> f64 {
        self.sign() * self.pulses.mean_a
    }

    /// The current at the end of the last half tick without its ripple, A: that of the plant, which the pulses of a
    /// dead time run after by half of it.
    pub fn even_a(&self) -> f64 {
        let gained_a = self.pulses.end_a - self.pulses.first().current_a;
        self.sign() * (self.pulses.mean_a + 0.5 * gained_a)
    }

    /// The mean of the samples of a tick around the end of the last half tick, A.
    pub fn sampled_a(&self, half: Half) -> f64 {
        let (from_s, left) = &self.sampled;
        if *from_s > FIRST_SAMPLE_S {
            let shown_a = SAMPLES_S.map(|at_s| self.shown_a(half, HALF_S + at_s));
            return shown_a.iter().sum::<f64>() / 4.0;
        }
        let [up, down] = &self.decays;
        let left = left.times(self.lag.sampled, [up.sampled, down.sampled]);
        self.shows_a(half, self.pulses.last(), HALF_S + SAMPLED_S, &left)
    }
}

#[cfg(test)]
mod tests;
