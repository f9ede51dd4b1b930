use super::*;

fn way(lag_us: f64, dead_us: f64) -> CurrentPath {
    let settings = CurrentPathSettings {
        dead_time_s: 1e-6 * dead_us,
        lag_s: 1e-6 * lag_us,
        excursion_a: 0.3,
        settling_s: [9.6e-6, 9.8e-6],
    };
    let winding = WindingSettings {
        resistance_ohm: 1.23,
        inductance_h: 0.34e-3,
        constant: 0.0389 * 86.0,
    };
    CurrentPath::new(settings, winding, 24.0).expect("a path that is not ideal")
}

/// By what sums of bends and edges are off what is left from piece to piece, and the number of half ticks by either way.
fn compared(way: &mut CurrentPath, worst_a: &mut f64, counts: &mut [u32; 2]) {
    let (from_s, left) = way.sampled;
    let (_, exact) = way.left_at(from_s);
    let mut off = |is: f64, was: f64| *worst_a = worst_a.max((is - was).abs());
    off(left.lag_a, exact.lag_a);
    let numbers = left.excursions.iter().zip(&exact.excursions);
    for (is, was) in numbers.flat_map(|(is, was)| is.iter().zip(was)) {
        off(*is, *was);
    }
    counts[usize::from(way.pulses.is_plain && from_s == FIRST_SAMPLE_S)] += 1;
}

/// A bridge at every duty, that turns round, floats, and stands, with currents that reach zero within a dead time.
#[test]
fn sums_of_bends_and_edges_are_what_is_left_from_piece_to_piece() {
    for (lag_us, dead_us) in [(0.5, 0.4), (0.0, 0.4), (2.0, 1.0), (0.01, 0.1), (0.5, 0.0)] {
        let mut way = way(lag_us, dead_us);
        let (mut worst_a, mut counts) = (0.0, [0; 2]);
        let mut current_a = 0.1;
        for n in 0..20_000 {
            let phase = f64::from(n);
            let duty = 1.05 * (0.01 * phase).sin() * (0.003 * phase).cos();
            let wanted_a = 0.4 * (0.17 * phase).sin();
            let emf_v = 24.0 * duty - 1.23 * wanted_a;
            if n % 501 == 0 {
                way.float(wanted_a);
                compared(&mut way, &mut worst_a, &mut counts);
            }
            for is_second in [false, true] {
                (_, current_a) = way.half(is_second, duty, current_a, emf_v);
                compared(&mut way, &mut worst_a, &mut counts);
                let exact_a = [Half::A, Half::B].map(|half| {
                    let at = |at_s: &f64| way.shown_a(half, HALF_S + at_s);
                    SAMPLES_S.iter().map(at).sum::<f64>() / 4.0 - way.sampled_a(half)
                });
                worst_a = exact_a
                    .iter()
                    .fold(worst_a, |worst, off| worst.max(off.abs()));
            }
            current_a = wanted_a;
        }
        println!(
            "lag {lag_us} µs, dead time {dead_us} µs: off by at most {worst_a:e}, {counts:?} half ticks"
        );
        assert!(worst_a < 4e-15, "{worst_a:e}");
        assert!(
            counts[0] > 1_000 && (dead_us == 0.0 || counts[1] > 10_000),
            "{counts:?}"
        );
    }
}
