//! Illinois' rule: where a function falls through zero.

/// Time at which `value` falls through zero, to below 1e-13 s; it is computed there last.
pub(crate) fn falls_at(
    (mut left_s, mut right_s): (f64, f64),
    (mut left, mut right): (f64, f64),
    mut value: impl FnMut(f64) -> f64,
) -> f64 {
    const CLOSE_S: f64 = 1e-13;
    let mut last_s = right_s;
    loop {
        let time_s = (left_s * right - right_s * left) / (right - left);
        let at = value(time_s);
        if (time_s - last_s).abs() <= CLOSE_S || at == 0.0 {
            return time_s;
        }
        let was_left = last_s == left_s;
        last_s = time_s;
        if at > 0.0 {
            (left_s, left) = (time_s, at);
            if was_left {
                right /= 2.0;
            }
        } else {
            (right_s, right) = (time_s, at);
            if !was_left {
                left /= 2.0;
            }
        }
    }
}
