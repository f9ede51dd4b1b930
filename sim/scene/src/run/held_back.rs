//! Accounts of torque that does not reach the motor: of what the energy tank holds back of
//! clonus and of a reflex, and of what is beyond a device's largest torque.

use crepitus_model::control::device_limits::LimitSettings;
use crepitus_model::render::effects::FELT_SHARE;
use crepitus_model::render::effects::symptom::Word;

/// The name of the column of the share that the tank holds back: a scene whose symptoms can give
/// energy has it.
pub const HELD_BACK_COLUMN: &str = "tank_held_back";

/// Torque at its largest in a beat or a reflex, N·m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ended {
    /// Kind of its event: held back, or so much that it was not felt.
    pub(super) word: Word,
    pub(super) asked_nm: f64,
    pub(super) paid_nm: f64,
}

/// A beat or a reflex under way, with its largest torques so far, N·m.
#[derive(Clone, Copy, Debug)]
struct Push {
    effect: &'static str,
    asked_nm: f64,
    paid_nm: f64,
}

/// Totals of what the tank held back.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct TankTotals {
    /// Symptoms that were held back.
    pub(super) effects: Vec<&'static str>,
    /// End of the first tick with less than was asked for, s.
    pub(super) first_s: Option<f64>,
    /// Time with less than was asked for, s.
    pub(super) held_back_s: f64,
    /// The largest share held back.
    pub(super) most_share: f64,
    /// Beats and reflexes that ended.
    pub(super) pushes: u64,
    /// Those of them that were held back, and felt.
    pub(super) weak: u64,
    /// Those of them that were not felt.
    pub(super) unfelt: u64,
}

/// Follows what the tank pays, tick by tick.
#[derive(Clone, Debug, Default)]
pub(super) struct TankAccounting {
    totals: TankTotals,
    pushes: Vec<Push>,
}

impl TankAccounting {
    /// Accounts for a tick of one symptom, which ends at `end_s` and lasts `step_s`. Returns the
    /// beat or the reflex that is over, if a part of it was held back.
    pub(super) fn paid(
        &mut self,
        effect: &'static str,
        (asked_nm, paid_nm): (f64, f64),
        (end_s, step_s): (f64, f64),
    ) -> Option<Ended> {
        let place = self.pushes.iter().position(|p| p.effect == effect);
        if asked_nm == 0.0 {
            return place.and_then(|place| self.end(place));
        }
        let place = place.unwrap_or_else(|| {
            self.pushes.push(Push {
                effect,
                asked_nm: 0.0,
                paid_nm: 0.0,
            });
            self.pushes.len() - 1
        });
        let push = &mut self.pushes[place];
        if asked_nm.abs() > push.asked_nm.abs() {
            push.asked_nm = asked_nm;
        }
        if paid_nm.abs() > push.paid_nm.abs() {
            push.paid_nm = paid_nm;
        }
        let share = 1.0 - paid_nm / asked_nm;
        if share > 0.0 {
            let totals = &mut self.totals;
            totals.first_s.get_or_insert(end_s);
            totals.held_back_s += step_s;
            totals.most_share = totals.most_share.max(share);
            if !totals.effects.contains(&effect) {
                totals.effects.push(effect);
            }
        }
        None
    }

    /// Returns whether a beat or a reflex is under way.
    pub(super) fn is_paying(&self) -> bool {
        !self.pushes.is_empty()
    }

    fn end(&mut self, place: usize) -> Option<Ended> {
        let Push {
            asked_nm, paid_nm, ..
        } = self.pushes.swap_remove(place);
        self.totals.pushes += 1;
        if paid_nm.abs() >= asked_nm.abs() {
            return None;
        }
        let is_felt = paid_nm.abs() >= FELT_SHARE * asked_nm.abs();
        let (word, count) = if is_felt {
            (Word::Weak, &mut self.totals.weak)
        } else {
            (Word::Unfelt, &mut self.totals.unfelt)
        };
        *count += 1;
        Some(Ended {
            word,
            asked_nm,
            paid_nm,
        })
    }

    /// The totals so far.
    pub(super) fn totals(&self) -> TankTotals {
        self.totals.clone()
    }
}

/// Torque beyond the largest that a device shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Beyond {
    /// The largest torque that a device shows, N·m.
    pub(super) limit_nm: f64,
    /// End of the first tick beyond, s.
    pub(super) first_s: Option<f64>,
    /// Time beyond, s.
    pub(super) lasted_s: f64,
    /// The torque that was furthest beyond, N·m.
    pub(super) most_nm: f64,
}

impl Beyond {
    /// Nothing so far; the limit is that of a device at its defaults.
    pub(super) fn new() -> Self {
        Self {
            limit_nm: LimitSettings::default().torque_nm,
            first_s: None,
            lasted_s: 0.0,
            most_nm: 0.0,
        }
    }

    /// Accounts for a tick that ends at `end_s` with this torque asked for.
    #[inline]
    pub(super) fn note(&mut self, asked_nm: f64, (end_s, step_s): (f64, f64)) {
        if asked_nm.abs() > self.limit_nm {
            self.first_s.get_or_insert(end_s);
            self.lasted_s += step_s;
            if asked_nm.abs() > self.most_nm.abs() {
                self.most_nm = asked_nm;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_beat_counts_as_felt_from_half_of_its_height_on() {
        let mut accounting = TankAccounting::default();
        let mut beat = |share: f64| {
            let ticks = [0.5, -1.5, -0.5].map(|nm| (nm, share * nm));
            for paid in ticks {
                assert_eq!(accounting.paid("clonus", paid, (1.0, 0.1)), None);
            }
            accounting.paid("clonus", (0.0, 0.0), (1.0, 0.1))
        };
        let ended = |word, paid_nm| {
            Some(Ended {
                word,
                asked_nm: -1.5,
                paid_nm,
            })
        };
        assert_eq!(beat(1.0), None);
        assert_eq!(beat(0.5), ended(Word::Weak, -0.75));
        assert_eq!(beat(0.4375), ended(Word::Unfelt, -0.656_25));
        assert_eq!(beat(0.0), ended(Word::Unfelt, 0.0));
        let totals = accounting.totals();
        assert_eq!((totals.pushes, totals.weak, totals.unfelt), (4, 1, 2));
        assert_eq!((totals.first_s, totals.most_share), (Some(1.0), 1.0));
        assert!((totals.held_back_s - 0.9).abs() < 1e-12);
        assert_eq!(totals.effects, ["clonus"]);
    }

    #[test]
    fn two_symptoms_are_held_back_each_for_itself() {
        let mut accounting = TankAccounting::default();
        accounting.paid("clonus", (1.0, 0.25), (1.0, 0.1));
        accounting.paid("spasticity", (2.0, 2.0), (1.0, 0.1));
        let of = |accounting: &mut TankAccounting, effect| {
            accounting.paid(effect, (0.0, 0.0), (2.0, 0.1))
        };
        assert_eq!(of(&mut accounting, "spasticity"), None);
        let ended = of(&mut accounting, "clonus").expect("held back");
        assert_eq!((ended.word, ended.paid_nm), (Word::Unfelt, 0.25));
        assert_eq!(of(&mut accounting, "clonus"), None, "it has ended once");
    }
}
