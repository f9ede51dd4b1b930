//! Arming's polarity test, as the samples of a recording show it.

use crate::row::Row;
use crepitus_protocol::LimitReason;

/// Half the current of the push, A: none other flows while there is no torque.
const HALF_PUSH_A: f32 = 0.6;

/// The current changes sense within this time, s; what is shorter is none.
const CHANGE_S: f64 = 2e-3;

/// Finds the pushes: current of the motor before torque is on.
#[derive(Clone, Copy, Debug, Default)]
pub struct ArmingPushes {
    /// Times of the first and the last row of a push, s.
    under_way: Option<(f64, f64)>,
}

impl ArmingPushes {
    /// Takes a row; returns from when to when, s, a push was that ended there.
    pub fn row(&mut self, row: &Row) -> Option<(f64, f64)> {
        let now_s = row.time_s;
        let is_armed = row.flags.limit() != LimitReason::NotArmed;
        let flows = row.current_a.is_some_and(|a| a.abs() > HALF_PUSH_A);
        if flows && !is_armed {
            let (from_s, _) = self.under_way.unwrap_or((now_s, now_s));
            self.under_way = Some((from_s, now_s));
            return None;
        }
        let (from_s, to_s) = self.under_way?;
        if !is_armed && now_s - to_s < CHANGE_S {
            return None;
        }
        self.under_way = None;
        (to_s - from_s > CHANGE_S).then_some((from_s, to_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crepitus_protocol::telemetry::SampleFlags;

    #[test]
    fn a_push_is_current_before_torque_and_a_spike_is_none() {
        // Ticks in the order of arming: + − − + − + + −, forty each.
        let senses = [1.0, -1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0];
        let current_a = |tick: u32| match tick {
            // What is left as torque ends.
            50..60 => 1.0,
            100..420 => 1.2 * senses[(tick as usize - 100) / 40],
            // Of the model.
            420.. => 2.0,
            _ => 0.0,
        };
        let mut pushes = ArmingPushes::default();
        let found: Vec<_> = (0..1000_u32)
            .filter_map(|tick| {
                let reason = if tick < 420 {
                    LimitReason::NotArmed
                } else {
                    LimitReason::None
                };
                pushes.row(&Row {
                    time_s: f64::from(tick) * 5e-5,
                    current_a: (tick % 7 != 3).then(|| current_a(tick)),
                    flags: SampleFlags::default().with_limit(reason),
                    ..Row::default()
                })
            })
            .collect();
        assert_eq!(found.len(), 1);
        let (from_s, to_s) = found[0];
        assert!(
            (from_s - 5e-3).abs() < 1e-4 && (to_s - 21e-3).abs() < 1e-4,
            "{from_s} {to_s}"
        );
    }
}
