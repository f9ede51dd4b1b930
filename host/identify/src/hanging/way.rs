//! Mean currents over the path of the joint.

/// Width of a mean, rad: one degree.
const WIDTH_RAD: f64 = std::f64::consts::PI / 180.0;

/// Mean current over one degree of the path, in one sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    /// Encoder's angle at the middle, rad.
    pub angle_rad: f64,
    /// Current, A; positive drives towards growing angle.
    pub current_a: f64,
    /// Sense of the motion, +1 or −1.
    pub sense: f64,
}

/// Averages the current over whole degrees of a path in one sense. `samples` are angle, rad, and
/// current, A, in the order of time. A reversal within it counts against it. Degrees that are not
/// passed whole are left out.
pub fn means(samples: &[(f64, f64)], sense: f64) -> Vec<Mean> {
    let mut means = Vec::new();
    let Some(&(first, _)) = samples.first() else {
        return means;
    };
    let (mut place, mut way, mut sum) = (0.0, 0.0, 0.0);
    let mut begun = false;
    for pair in samples.windows(2) {
        let [(from, i), (to, j)] = [pair[0], pair[1]];
        let at = ((0.5 * (from + to) - first) * sense / WIDTH_RAD).floor();
        if !begun {
            (place, begun) = (at, true);
        } else if at > place {
            if way >= 0.9 * WIDTH_RAD {
                means.push(Mean {
                    angle_rad: first + sense * (place + 0.5) * WIDTH_RAD,
                    current_a: sum / way,
                    sense,
                });
            }
            (place, way, sum) = (at, 0.0, 0.0);
        }
        // What goes back behind the present degree is an error of the energy of a count.
        let step = (to - from) * sense;
        way += step;
        sum += 0.5 * (i + j) * step;
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_still_does_not_count() {
        let degree = WIDTH_RAD;
        // To 0.5°, a stop with another current, on to 3.2°.
        let mut samples: Vec<_> = (0..=50)
            .map(|n| (f64::from(n) * 0.01 * degree, 1.0))
            .collect();
        samples.extend([(0.5 * degree, 9.0); 1000]);
        samples.extend((50..=320).map(|n| (f64::from(n) * 0.01 * degree, 1.0)));
        let means = means(&samples, 1.0);
        assert_eq!(means.len(), 3);
        for mean in means {
            assert!((mean.current_a - 1.0).abs() < 1e-9, "{mean:?}");
        }
    }

    #[test]
    fn a_way_back_is_one_of_falling_angles() {
        let samples = (0..=1000).map(|n| {
            let angle = 1.0 - f64::from(n) * 1e-3;
            (angle, angle)
        });
        let means = means(&samples.collect::<Vec<_>>(), -1.0);
        assert_eq!(means.len(), 57);
        for mean in means {
            assert!((mean.current_a - mean.angle_rad).abs() < 5e-4, "{mean:?}");
            assert!(mean.sense < 0.0);
        }
    }
}
