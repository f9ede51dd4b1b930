//! The pulses of the bridge against an independent computation: the same circuit in steps of 5 ns, from the rules of
//! the switches alone, without edges that anybody has located.

use crepitus_model::control::current_path::{PathCorrection, PathNumbers, earlier_half_a};
use crepitus_plant::effects::motor::current_path::{
    CurrentPath, CurrentPathSettings, HALF_S, Half, SAMPLES_S,
};
use crepitus_plant::effects::motor::winding::WindingSettings;

const SUPPLY_V: f64 = 24.0;
const DIODE_V: f64 = 0.8;
const STEPS: u32 = 10_000;
const STEP_S: f64 = 5e-9;
const TICK_S: f64 = 2.0 * HALF_S;

const WINDING: WindingSettings = WindingSettings {
    resistance_ohm: 1.23,
    inductance_h: 0.34e-3,
    constant: 0.0389 * 86.0,
};

/// The board, as the module's table has it.
const BOARD: CurrentPathSettings = CurrentPathSettings {
    dead_time_s: 0.4e-6,
    lag_s: 0.5e-6,
    excursion_a: 0.3,
    settling_s: [9.6e-6, 9.8e-6],
};

fn way() -> CurrentPath {
    CurrentPath::new(BOARD, WINDING, SUPPLY_V).unwrap()
}

/// The circuit in small steps.
#[derive(Default)]
struct Circuit {
    current_a: f64,
    lagged_a: f64,
    was_high: [Option<bool>; 2],
    /// Rest of edges up and down of either half, A.
    thrown_a: [[f64; 2]; 2],
}

/// The nearest duty whose edges are between two steps.
fn on_the_grid(duty: f64) -> f64 {
    (2_500.0 * duty).round() / 2_500.0
}

/// Record of a tick.
#[derive(Default)]
struct Tick {
    mean_v: f64,
    mean_a: f64,
    middle_a: f64,
    sampled_a: [f64; 2],
}

impl Circuit {
    /// Voltages of both halves with a current of this sign; zero is none.
    fn volts(flows: f64, is_high: [bool; 2], is_dead: [bool; 2]) -> [f64; 2] {
        [0, 1].map(|half| {
            let leaves = if half == 0 { flows } else { -flows };
            match (is_dead[half], is_high[half]) {
                (true, _) if leaves > 0.0 => -DIODE_V,
                (true, _) => SUPPLY_V + DIODE_V,
                (false, true) => SUPPLY_V,
                (false, false) => 0.0,
            }
        })
    }

    fn tick(&mut self, duty: f64, emf_v: f64) -> Tick {
        let decay: Vec<f64> = BOARD
            .settling_s
            .iter()
            .map(|settling_s| (-STEP_S * (BOARD.excursion_a / 0.012_5).ln() / settling_s).exp())
            .collect();
        let mut tick = Tick::default();
        let mut samples = SAMPLES_S.iter().peekable();
        for n in 0..STEPS {
            // The middle of the step: whatever the edges are, none is at it.
            let at_s = (f64::from(n) + 0.5) * STEP_S;
            let [mut is_high, mut is_dead] = [[false; 2]; 2];
            for half in [0, 1] {
                let sign = if half == 0 { 1.0 } else { -1.0 };
                let falls_s = HALF_S / 2.0 * (1.0 + sign * duty);
                let rises_s = TICK_S - falls_s;
                is_high[half] = at_s < falls_s || at_s >= rises_s;
                let since_s = if at_s >= rises_s {
                    at_s - rises_s
                } else {
                    at_s - falls_s
                };
                is_dead[half] = (0.0..BOARD.dead_time_s).contains(&since_s);
            }
            let driven = |flows: f64| {
                let [a, b] = Self::volts(flows, is_high, is_dead);
                (a - b - emf_v, [a, b])
            };
            let none_flows = self.current_a == 0.0 && is_dead.contains(&true);
            let flow = if none_flows {
                [1.0, -1.0]
                    .into_iter()
                    .find(|flows| driven(*flows).0 * flows > 0.0)
            } else {
                Some(self.current_a)
            };
            let before_a = self.current_a;
            if let Some(flow) = flow {
                let (over_v, [a, b]) = driven(flow);
                let slope =
                    (over_v - WINDING.resistance_ohm * self.current_a) / WINDING.inductance_h;
                self.current_a += STEP_S * slope;
                if is_dead.contains(&true) && before_a * self.current_a < 0.0 {
                    self.current_a = 0.0;
                }
                tick.mean_v += (a - b) * STEP_S / TICK_S;
                for (half, volts) in [a, b].into_iter().enumerate() {
                    let is_up = volts > SUPPLY_V / 2.0;
                    if self.was_high[half].is_some_and(|was| was != is_up) {
                        self.thrown_a[half][usize::from(!is_up)] += BOARD.excursion_a;
                    }
                    self.was_high[half] = Some(is_up);
                }
            } else {
                tick.mean_v += emf_v * STEP_S / TICK_S;
            }
            let share = 1.0 - (-STEP_S / BOARD.lag_s).exp();
            self.lagged_a += share * (f64::midpoint(before_a, self.current_a) - self.lagged_a);
            for thrown in &mut self.thrown_a {
                thrown[0] *= decay[0];
                thrown[1] *= decay[1];
            }
            tick.mean_a += f64::midpoint(before_a, self.current_a) / f64::from(STEPS);
            if n == STEPS / 2 - 1 {
                tick.middle_a = self.current_a;
            }
            let from_middle_s = f64::from(n + 1) * STEP_S - HALF_S;
            if samples
                .next_if(|sample| from_middle_s >= **sample)
                .is_some()
            {
                let thrown = self.thrown_a.map(|[up, down]| up - down);
                tick.sampled_a[0] += (self.lagged_a + thrown[0]) / 4.0;
                tick.sampled_a[1] += (self.lagged_a - thrown[1]) / 4.0;
            }
        }
        tick
    }
}

/// A case: speed of the joint, and the current that is aimed at.
fn cases() -> impl Iterator<Item = (f64, f64)> {
    [0.0, 0.1, 1.0, -1.0, 3.0, -3.0, 5.0, -5.0]
        .into_iter()
        .flat_map(|omega| {
            [-0.9, -0.3, -0.15, -0.05, 0.02, 0.1, 0.25, 0.6].map(|ampere| (omega, ampere))
        })
}

#[test]
fn the_pulses_are_those_of_a_circuit_in_steps_of_five_nanoseconds() {
    for (omega, wanted_a) in cases() {
        let emf_v = WINDING.constant * omega;
        let duty = on_the_grid((WINDING.resistance_ohm * wanted_a + emf_v) / SUPPLY_V);
        let (mut circuit, mut way) = (Circuit::default(), way());
        (circuit.current_a, circuit.lagged_a) = (wanted_a, wanted_a);
        let mut current_a = wanted_a;
        for n in 0..60 {
            let fine = circuit.tick(duty, emf_v);
            let (first_v, middle_a) = way.half(false, duty, current_a, emf_v);
            let sampled_a = [Half::A, Half::B].map(|half| way.sampled_a(half));
            let (second_v, end_a) = way.half(true, duty, middle_a, emf_v);
            current_a = end_a;
            if n == 0 {
                // The circuit's amplifiers had no edge before.
                continue;
            }
            let case = format!("{omega} rad/s, {wanted_a} A, tick {n}");
            let mean_v = f64::midpoint(first_v, second_v);
            assert!(
                (mean_v - fine.mean_v).abs() < 0.012,
                "{case}: {mean_v} V, {}",
                fine.mean_v
            );
            assert!(
                (middle_a - fine.middle_a).abs() < 2.5e-3,
                "{case}: {middle_a} A"
            );
            for half in [0, 1] {
                let off_a = sampled_a[half] - fine.sampled_a[half];
                assert!(off_a.abs() < 2.5e-3, "{case}: half {half} off by {off_a} A");
            }
        }
    }
}

/// Steady states, by fine steps: what the loop would take for the current, and what the current is.
fn steady(omega: f64, wanted_a: f64) -> (f64, Tick) {
    let emf_v = WINDING.constant * omega;
    let duty = on_the_grid((WINDING.resistance_ohm * wanted_a + emf_v) / SUPPLY_V);
    let mut circuit = Circuit {
        current_a: wanted_a,
        lagged_a: wanted_a,
        ..Circuit::default()
    };
    for _ in 0..60 {
        circuit.tick(duty, emf_v);
    }
    (duty, circuit.tick(duty, emf_v))
}

/// The loss of voltage, by the law that the loop feeds forward, is that of the fine steps, beyond the ramp of a few
/// milliamperes.
#[test]
fn the_law_of_the_dead_time_is_that_of_the_circuit() {
    let numbers = PathNumbers {
        inductance_h: WINDING.inductance_h,
        supply_v: SUPPLY_V,
        dead_time_s: BOARD.dead_time_s,
        lag_s: 0.0,
    };
    let mut compared = 0;
    for (omega, wanted_a) in cases() {
        let (duty, tick) = steady(omega, wanted_a);
        let ripple_a =
            SUPPLY_V * TICK_S / (4.0 * WINDING.inductance_h) * duty.abs() * (1.0 - duty.abs());
        let to_the_ramp = (tick.mean_a.abs() - ripple_a).abs();
        if to_the_ramp < 0.03 || tick.mean_a.abs() < 0.03 {
            continue;
        }
        let mut law = PathCorrection::<f64>::new(&numbers, TICK_S, 0.27).unwrap();
        let fed = (0..200)
            .map(|_| law.feed_v(tick.mean_a, tick.mean_v))
            .last()
            .unwrap();
        let lost = duty * SUPPLY_V - tick.mean_v;
        assert!(
            (fed - lost).abs() < 0.02,
            "{omega} rad/s, {wanted_a} A: {lost} V lost, {fed} V fed"
        );
        compared += 1;
    }
    assert!(compared > 20, "{compared}");
}

/// By the earlier half and without the lag the current is the mean of the tick to a few milliamperes; by half A it is off
/// by ten times as much.
#[test]
fn the_earlier_half_without_its_lag_shows_the_mean_current() {
    let mut worst = [0.0_f64; 2];
    for (omega, wanted_a) in cases() {
        let (duty, tick) = steady(omega, wanted_a);
        let [a, b] = tick.sampled_a;
        let lost = (duty * SUPPLY_V - tick.mean_v).abs() / 0.41;
        let lag_s = 0.43e-6 + 0.2e-6 * lost.min(1.0);
        let late_a = lag_s * duty * SUPPLY_V / WINDING.inductance_h;
        let after = earlier_half_a(a, b, duty) - late_a - tick.mean_a;
        worst[0] = worst[0].max((a - tick.mean_a).abs());
        worst[1] = worst[1].max(after.abs());
    }
    println!(
        "off by at most {:.1} mA by half A, {:.1} mA corrected",
        1e3 * worst[0],
        1e3 * worst[1]
    );
    assert!(worst[0] > 0.04, "{worst:?}");
    assert!(worst[1] < 0.008, "{worst:?}");
}
