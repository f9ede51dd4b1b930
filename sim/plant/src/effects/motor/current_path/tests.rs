use super::*;

fn path(lag_us: f64, dead_us: f64) -> CurrentPath {
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
fn compared(path: &CurrentPath, worst: &mut f64, counts: &mut [u32; 2]) {
    let LastHalf {
        sampled,
        piece,
        mean_a,
        end_a,
        half,
        ..
    } = &path.last_half;
    let way = path.way();
    let (from_s, left) = sampled;
    let (last, exact) = path.left_at(&way, *from_s);
    assert_eq!(piece.highs, last.highs);
    let mut off = |is: f64, was: f64| *worst = worst.max((is - was).abs());
    off(1e6 * piece.from_s, 1e6 * last.from_s);
    off(piece.current_a, last.current_a);
    off(1e-6 * piece.slope_a_per_s, 1e-6 * last.slope_a_per_s);
    off(*mean_a, way.charge_as / HALF_S);
    off(*end_a, way.end_a);
    off(left.lag_a, exact.lag_a);
    let numbers = left.excursions.iter().zip(&exact.excursions);
    for (is, was) in numbers.flat_map(|(is, was)| is.iter().zip(was)) {
        off(*is, *was);
    }
    let is_plain = half.is_some_and(|half| path.pulses.plain_way(&half).is_some());
    counts[usize::from(is_plain)] += 1;
}

/// A bridge at every duty, that turns round, floats, and stands, with currents that reach zero within a dead time.
#[test]
fn sums_of_bends_and_edges_are_what_is_left_from_piece_to_piece() {
    for (lag_us, dead_us) in [(0.5, 0.4), (0.0, 0.4), (2.0, 1.0), (0.01, 0.1), (0.5, 0.0)] {
        let mut path = path(lag_us, dead_us);
        let (mut worst_a, mut counts) = (0.0, [0; 2]);
        let mut current_a = 0.1;
        for n in 0..20_000 {
            let phase = f64::from(n);
            let duty = 1.05 * (0.01 * phase).sin() * (0.003 * phase).cos();
            let wanted_a = 0.4 * (0.17 * phase).sin();
            let emf_v = 24.0 * duty - 1.23 * wanted_a;
            if n % 501 == 0 {
                path.float(wanted_a);
                compared(&path, &mut worst_a, &mut counts);
            }
            for is_second in [false, true] {
                (_, current_a) = path.half(is_second, duty, current_a, emf_v);
                compared(&path, &mut worst_a, &mut counts);
                let exact_a = [Half::A, Half::B].map(|half| {
                    let at = |at_s: &f64| path.shown_a(half, HALF_S + at_s);
                    SAMPLES_S.iter().map(at).sum::<f64>() / 4.0 - path.sampled_a(half)
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
        assert!(counts[0] > 1_000 && counts[1] > 20_000, "{counts:?}");
    }
}
