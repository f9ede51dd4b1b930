//! Pieces that are repeated for ever: a recorded cycle.

use crate::piece::{Curve, Piece};

/// One cycle, from 0 to its period.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    pieces: Vec<Piece>,
    period_s: f64,
}

impl Cycle {
    /// Pieces that follow each other without gaps from 0 on; the period is where the last one
    /// ends. Without any the shaft rests at 0.
    pub(super) fn new(pieces: Vec<Piece>) -> Self {
        let period_s = pieces.last().map_or(f64::INFINITY, |last| last.end_s);
        Self { pieces, period_s }
    }

    /// Duration of a cycle, s.
    pub fn period_s(&self) -> f64 {
        self.period_s
    }

    pub(super) fn pieces_mut(&mut self) -> &mut [Piece] {
        &mut self.pieces
    }

    /// The piece in which `time_s` lies. Every boundary is computed in one way, so a piece ends
    /// where the next begins, to the bit, also from cycle to cycle.
    pub(super) fn piece(&self, time_s: f64) -> Piece {
        let mut cycle = (time_s / self.period_s).floor().max(0.0);
        // The quotient may round across a boundary; the boundary decides.
        if time_s < cycle * self.period_s {
            cycle -= 1.0;
        } else if time_s >= (cycle + 1.0) * self.period_s {
            cycle += 1.0;
        }
        let begin_s = cycle * self.period_s;
        let after = (self.pieces).partition_point(|piece| begin_s + piece.start_s <= time_s);
        let Some(piece) = self.pieces.get(after.saturating_sub(1)) else {
            return Piece {
                start_s: 0.0,
                end_s: f64::INFINITY,
                jump: false,
                curve: Curve::Polynomial([0.0; 6]),
            };
        };
        let end_s = match self.pieces.get(after.max(1)) {
            Some(next) => begin_s + next.start_s,
            None => (cycle + 1.0) * self.period_s,
        };
        Piece {
            start_s: begin_s + piece.start_s,
            end_s,
            ..*piece
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walking_from_piece_to_piece_comes_to_every_time() {
        for period_s in [1.0, 0.1, 1.0 / 3.0, 0.806_67, 2.37e-3] {
            let piece = |from: f64, to: f64| Piece {
                start_s: from * period_s,
                end_s: to * period_s,
                jump: false,
                curve: Curve::Polynomial([from, 0.0, 0.0, 0.0, 0.0, 0.0]),
            };
            let cycle = Cycle::new(vec![piece(0.0, 0.3), piece(0.3, 0.9), piece(0.9, 1.0)]);
            assert_eq!(cycle.period_s(), period_s);
            let mut last = cycle.piece(0.0);
            for count in 1..30_000 {
                let next = cycle.piece(last.end_s);
                assert_eq!(next.start_s, last.end_s, "{period_s}, {count}");
                assert!(next.end_s > next.start_s);
                let angle = [0.0, 0.3, 0.9][count % 3];
                assert_eq!(next.at(next.start_s).phi_rad, angle, "{period_s}, {count}");
                last = next;
            }
        }
        assert_eq!(Cycle::new(Vec::new()).piece(3.0).end_s, f64::INFINITY);
    }
}
