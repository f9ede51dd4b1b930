//! Places and heights of asperities, the step to a neighbour, and the limits beside two of them.

use super::{PARTS, Texture, TextureCoefficients};
use crate::real::Real;
use crate::render::effects::play::Limits;
use crate::render::position::Position;

/// An asperity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Asperity<F> {
    pub(super) place: Position<F>,
    height_nm: F,
    /// Beside a patch there is none: nothing to snap over.
    pub(super) is_there: bool,
}

/// The asperities below and above the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pair<F> {
    pub(super) last: Asperity<F>,
    pub(super) next: Asperity<F>,
}

/// Distances of a place from both asperities; negative beyond one that was passed by the
/// encoder's noise or in a long travel.
#[derive(Clone, Copy)]
pub(super) struct Beside<F> {
    pub(super) from_last_rad: F,
    pub(super) to_next_rad: F,
}

impl<F: Real> TextureCoefficients<F> {
    /// The asperity of a number, and the one above; it has this place in its patch.
    pub(super) fn pair(&self, number: i32, place: i32) -> Pair<F> {
        Pair {
            last: self.asperity(number, place),
            next: self.asperity(number.wrapping_add(1), self.after(place)),
        }
    }

    /// The place of an asperity among those of a patch and the gap after it.
    pub(super) fn place(&self, number: i32) -> i32 {
        // A division only where there are patches.
        match self.patch {
            1 => 0,
            patch => number.checked_rem_euclid(patch).unwrap_or(0),
        }
    }

    #[inline]
    fn after(&self, place: i32) -> i32 {
        let next = place.wrapping_add(1);
        if next < self.patch { next } else { 0 }
    }

    #[inline]
    fn before(&self, place: i32) -> i32 {
        let place = if place > 0 { place } else { self.patch };
        place.wrapping_sub(1)
    }

    #[inline]
    fn asperity(&self, number: i32, place: i32) -> Asperity<F> {
        #[expect(clippy::cast_sign_loss, reason = "a hash is of the bits")]
        let first = (number as u32).wrapping_mul(2);
        let shift = F::HALF - share(first ^ self.key);
        let height = share::<F>(first.wrapping_add(1) ^ self.key);
        let parts = i64::from(number).wrapping_mul(self.pitch);
        #[expect(
            clippy::cast_possible_truncation,
            reason = "counts wrap as the encoder's do"
        )]
        let count = (parts >> PARTS) as i32;
        let rest = (parts & ((1 << PARTS) - 1)) as i32;
        let is_there = place < self.there;
        Asperity {
            place: Position {
                count,
                rest_rad: F::from_count(rest) * self.rad_per_part
                    - self.pitch_rad * (self.irregularity * shift),
            },
            height_nm: if is_there {
                self.height_nm * (F::ONE - self.irregularity * height)
            } else {
                F::ZERO
            },
            is_there,
        }
    }
}

/// The top 24 bits of a hash, as a share of one.
fn share<F: Real>(key: u32) -> F {
    let mut x = key;
    x ^= x >> 16;
    x = x.wrapping_mul(0x7FEB_352D);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846C_A68B);
    x ^= x >> 16;
    #[expect(clippy::cast_possible_wrap, reason = "24 bits")]
    let top = (x >> 8) as i32;
    F::from_count(top) * F::from_f64(1.0 / 16_777_216.0)
}

impl<F: Real> Pair<F> {
    #[inline]
    pub(super) fn beside(&self, place: &Position<F>, rad_per_count: F) -> Beside<F> {
        Beside {
            from_last_rad: place.beyond(&self.last.place, rad_per_count),
            to_next_rad: self.next.place.beyond(place, rad_per_count),
        }
    }

    /// The limits there.
    #[inline]
    pub(super) fn limits(&self, with: &TextureCoefficients<F>, beside: &Beside<F>) -> Limits<F> {
        let flank = |rad: F| (F::ONE - rad.at_least(F::ZERO) * with.per_width).at_least(F::ZERO);
        Limits {
            lower_nm: -(with.base_nm + self.last.height_nm * flank(beside.from_last_rad)),
            upper_nm: with.base_nm + self.next.height_nm * flank(beside.to_next_rad),
        }
    }

    /// The limits at a place on the next asperity, or on the last.
    #[inline]
    pub(super) fn limits_at(
        &self,
        with: &TextureCoefficients<F>,
        is_next: bool,
        place: &Position<F>,
    ) -> Limits<F> {
        let beside = self.beside(place, with.scale.rad_per_count);
        self.limits(
            with,
            &if is_next {
                Beside {
                    to_next_rad: F::ZERO,
                    ..beside
                }
            } else {
                Beside {
                    from_last_rad: F::ZERO,
                    ..beside
                }
            },
        )
    }
}

impl<F: Real> Texture<F> {
    /// Moves the pair by one asperity.
    #[inline]
    pub(super) fn step(&mut self, upwards: bool) {
        let Pair { last, next } = self.pair;
        if upwards {
            self.number = self.number.wrapping_add(1);
            self.place = self.with.after(self.place);
            let above = self
                .with
                .asperity(self.number.wrapping_add(1), self.with.after(self.place));
            self.pair = Pair {
                last: next,
                next: above,
            };
        } else {
            self.number = self.number.wrapping_sub(1);
            self.place = self.with.before(self.place);
            let below = self.with.asperity(self.number, self.place);
            self.pair = Pair {
                last: below,
                next: last,
            };
        }
    }
}
