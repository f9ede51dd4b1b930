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
//! y = i − λ·i′ + (y₀ − i₀ + λ·i′)·e^(−t/λ).
//!
//! **Edges.** A half that goes up throws the output of its own amplifier up by D, one that goes down, down; both
//! die away as e^(−t/τ). τ is that with which a disturbance is 0.5 % of half the range (1.65 V, 2.5 A) after the time
//! to settle: τ = t/ln(D/12.5 mA). The amplifier of half B is turned round, so the same disturbance is a current of
//! the other sign.
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

use crate::effects::motor::winding::WindingSettings;
use crepitus_model::control::current_path::DIODE_V;

/// Half a period of the PWM, s.
pub const HALF_S: f64 = 25e-6;

/// Ends of the four samplings of a current, from the middle of the tick, s: a converter holds what is there at the end
/// of 3 of its clocks of 21 MHz, every 15 of them, with the middle of all samplings in that of the tick.
pub const SAMPLES_S: [f64; 4] = [-1.0e-6, -0.285_714e-6, 0.428_571e-6, 1.142_857e-6];

/// Share of half of the range to which an amplifier settles, A: 0.5 % of 1.65 V, at 0.66 V/A.
const SETTLED_A: f64 = 0.012_5;

/// Pieces of half a tick at most: two edges, their dead times, and a zero of the current in each.
const MOST_PIECES: usize = 24;

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

/// A stretch with a constant voltage.
#[derive(Clone, Copy, Debug)]
struct Piece {
    from_s: f64,
    current_a: f64,
    slope_a_per_s: f64,
    /// The current with its lag as the piece begins, A.
    lagged_a: f64,
    /// Rest of the excursions upwards and downwards of either half.
    excursions: [[f64; 2]; 2],
}

/// The way of a motor's current.
#[derive(Clone, Debug)]
pub struct CurrentPath {
    settings: CurrentPathSettings,
    winding: WindingSettings,
    supply_v: f64,
    decay_s: [f64; 2],
    /// Level of either half: true for high.
    levels: [Option<bool>; 2],
    lagged_a: f64,
    excursions: [[f64; 2]; 2],
    /// The pieces of the last half tick.
    pieces: Vec<Piece>,
    /// The current at its end, A.
    end_a: f64,
}

impl CurrentPath {
    /// The way for a winding on a bridge with this supply; none where everything is ideal.
    pub fn new(
        settings: CurrentPathSettings,
        winding: WindingSettings,
        supply_v: f64,
    ) -> Option<Self> {
        (!settings.is_ideal()).then(|| Self {
            settings,
            winding,
            supply_v,
            decay_s: settings.decay_s(),
            levels: [None; 2],
            lagged_a: 0.0,
            excursions: [[0.0; 2]; 2],
            pieces: Vec::with_capacity(MOST_PIECES),
            end_a: 0.0,
        })
    }

    /// Half a tick of a bridge that floats: its current is seen late, nothing switches.
    pub fn float(&mut self, current_a: f64) {
        self.levels = [None; 2];
        self.pieces.clear();
        self.push(0.0, current_a, 0.0);
        self.end(HALF_S);
        self.end_a = current_a;
    }

    /// The first or the second half of a tick, from the bottom of the PWM to the middle or back, with a duty from −1
    /// to 1, from this current on. Returns the mean voltage at the winding, V, and the current at the end, A.
    pub fn half(&mut self, is_second: bool, duty: f64, start_a: f64, emf_v: f64) -> (f64, f64) {
        let duty = duty.clamp(-1.0, 1.0);
        let quarter_s = HALF_S / 2.0;
        let signs = if is_second { [-1.0, 1.0] } else { [1.0, -1.0] };
        let edges_s = signs.map(|sign: f64| quarter_s * (1.0 + sign * duty));
        let dead_s = self.settings.dead_time_s;
        let mut marks_s = [
            edges_s[0],
            edges_s[0] + dead_s,
            edges_s[1],
            edges_s[1] + dead_s,
            HALF_S,
        ];
        marks_s.sort_by(f64::total_cmp);
        self.pieces.clear();
        let (mut now_s, mut current_a, mut volt_seconds) = (0.0, start_a, 0.0);
        for _ in 0..MOST_PIECES {
            if now_s >= HALF_S {
                break;
            }
            let next = marks_s.iter().copied().find(|mark| *mark > now_s);
            let until_s = next.unwrap_or(HALF_S).min(HALF_S);
            // As a half goes up in the second half of a tick and down in the first.
            let reference = edges_s.map(|edge_s| (now_s >= edge_s) == is_second);
            let is_dead = edges_s.map(|edge_s| now_s >= edge_s && now_s < edge_s + dead_s);
            let way = self.way(current_a, emf_v, reference, is_dead);
            let length_s = until_s - now_s;
            let (volts, end_a, length_s) = match way {
                None => (emf_v, 0.0, length_s),
                Some(volts) => {
                    let a =
                        self.winding.resistance_ohm * length_s / (2.0 * self.winding.inductance_h);
                    let b = (volts[0] - volts[1] - emf_v) * length_s / self.winding.inductance_h;
                    let end_a = (current_a * (1.0 - a) + b) / (1.0 + a);
                    let volts = volts[0] - volts[1];
                    if is_dead.contains(&true) && current_a * end_a < 0.0 {
                        (volts, 0.0, length_s * current_a / (current_a - end_a))
                    } else {
                        (volts, end_a, length_s)
                    }
                }
            };
            self.edges(way, reference, is_dead);
            let slope = if length_s > 0.0 {
                (end_a - current_a) / length_s
            } else {
                0.0
            };
            self.push(now_s, current_a, slope);
            self.end(now_s + length_s);
            volt_seconds += volts * length_s;
            // A zero that is at the mark itself is not looked for again.
            now_s = if until_s - (now_s + length_s) < 1e-15 {
                until_s
            } else {
                now_s + length_s
            };
            current_a = end_a;
        }
        self.end_a = current_a;
        (volt_seconds / HALF_S, current_a)
    }

    /// Voltages of the two halves, V; `None` where no current flows.
    fn way(
        &self,
        current_a: f64,
        emf_v: f64,
        reference: [bool; 2],
        is_dead: [bool; 2],
    ) -> Option<[f64; 2]> {
        // A current that leaves half A enters half B.
        let level = |half: usize, leaves: bool| match (is_dead[half], leaves) {
            (true, true) => -DIODE_V,
            (true, false) => self.supply_v + DIODE_V,
            (false, _) if reference[half] => self.supply_v,
            (false, _) => 0.0,
        };
        let levels = |flows: f64| [level(0, flows > 0.0), level(1, flows < 0.0)];
        if current_a != 0.0 || is_dead == [false; 2] {
            return Some(levels(current_a));
        }
        [1.0, -1.0].into_iter().find_map(|flows| {
            let [a, b] = levels(flows);
            ((a - b - emf_v) * flows > 0.0).then_some([a, b])
        })
    }

    /// Edges of the halves as a piece begins.
    fn edges(&mut self, way: Option<[f64; 2]>, reference: [bool; 2], is_dead: [bool; 2]) {
        for half in [0, 1] {
            let level = match way {
                Some(volts) => Some(volts[half] > self.supply_v / 2.0),
                None if is_dead[half] => self.levels[half],
                None => Some(reference[half]),
            };
            if let (Some(was), Some(is)) = (self.levels[half], level)
                && was != is
            {
                self.excursions[half][usize::from(!is)] += 1.0;
            }
            self.levels[half] = level;
        }
    }

    fn push(&mut self, from_s: f64, current_a: f64, slope_a_per_s: f64) {
        self.pieces.push(Piece {
            from_s,
            current_a,
            slope_a_per_s,
            lagged_a: self.lagged_a,
            excursions: self.excursions,
        });
    }

    /// Goes to the end of the last piece.
    fn end(&mut self, at_s: f64) {
        if let Some(piece) = self.pieces.last() {
            self.lagged_a = self.lagged_a(piece, at_s);
            self.excursions = self.excursions(piece, at_s);
        }
    }

    fn lagged_a(&self, piece: &Piece, at_s: f64) -> f64 {
        let length_s = at_s - piece.from_s;
        let current_a = piece.current_a + piece.slope_a_per_s * length_s;
        if self.settings.lag_s <= 0.0 {
            return current_a;
        }
        let behind_a = self.settings.lag_s * piece.slope_a_per_s;
        let from_a = piece.lagged_a - piece.current_a + behind_a;
        current_a - behind_a + from_a * (-length_s / self.settings.lag_s).exp()
    }

    fn excursions(&self, piece: &Piece, at_s: f64) -> [[f64; 2]; 2] {
        let left = self
            .decay_s
            .map(|decay_s| (-(at_s - piece.from_s) / decay_s).exp());
        piece
            .excursions
            .map(|[up, down]| [up * left[0], down * left[1]])
    }

    /// The current as the amplifier at a half shows it `at_s` after the last half tick began, A. Shortly beyond its
    /// end, too: nothing switches there.
    pub fn shown_a(&self, half: Half, at_s: f64) -> f64 {
        let piece = self.pieces.iter().rev().find(|piece| piece.from_s <= at_s);
        let Some(piece) = piece.or(self.pieces.first()) else {
            return self.lagged_a;
        };
        let [up, down] = self.excursions(piece, at_s)[half as usize];
        let thrown_a = self.settings.excursion_a * (up - down);
        let lagged_a = self.lagged_a(piece, at_s);
        match half {
            Half::A => lagged_a + thrown_a,
            Half::B => lagged_a - thrown_a,
        }
    }

    /// Mean of the current over the last half tick, A.
    pub fn mean_a(&self) -> f64 {
        let ends_s = self.pieces.iter().skip(1).map(|piece| piece.from_s);
        let pieces = self.pieces.iter().zip(ends_s.chain([HALF_S]));
        let charges = pieces.map(|(piece, end_s)| {
            let length_s = end_s - piece.from_s;
            length_s * (piece.current_a + 0.5 * piece.slope_a_per_s * length_s)
        });
        charges.sum::<f64>() / HALF_S
    }

    /// The current at the end of the last half tick without its ripple, A: that of the plant, which the pulses of a
    /// dead time run after by half of it.
    pub fn even_a(&self) -> f64 {
        let start_a = self
            .pieces
            .first()
            .map_or(self.end_a, |piece| piece.current_a);
        self.mean_a() + 0.5 * (self.end_a - start_a)
    }

    /// The mean of the samples of a tick around the end of the last half tick, A.
    pub fn sampled_a(&self, half: Half) -> f64 {
        let sum: f64 = SAMPLES_S
            .iter()
            .map(|at_s| self.shown_a(half, HALF_S + at_s))
            .sum();
        sum / 4.0
    }
}
