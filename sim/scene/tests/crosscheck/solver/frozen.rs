//! A frozen slip: its length is fixed where it begins.
//!
//! ```text
//! ωn·t = 2·(π − atan2(Ts − Tk, max(0, s·Ω(t₀))·√(J·kr)))
//! ```
//! Then the object sticks at s·(2Tk − Ts)/kr, or with `from-kinetic` at
//! s·Tk/kr. With Ts = Tk it would stick at the very limit that it breaks at
//! once: a touch, no event.

use super::stick::{Leaving, leaving};
use super::{AT_LIMIT, Certain, Phase, Solver};
use crate::circle::atan2;
use crate::double_double::Dd;
use crate::event::Cause;
use crepitus_model::Restart;

impl Solver<'_> {
    /// A whole slip, from its beginning.
    pub(super) fn frozen_slip(&mut self, sense: f64) {
        let joint = self.joint;
        let drop = joint.static_nm - joint.kinetic_nm;
        // `v` is the shaft's velocity at the break.
        let lead = self.v * sense;
        let lead = if lead > Dd::ZERO { lead } else { Dd::ZERO };
        let impedance = (joint.inertia * joint.stiffness).sqrt();
        let natural = joint.object.stiffness_per_s2.sqrt();
        let lag = atan2(drop, lead * impedance);
        let end_s = self.time_s + (Dd::PI - lag).scaled(2.0) / natural;
        if end_s > self.end_s {
            self.time_s = self.end_s;
            return;
        }
        self.time_s = end_s;
        self.find_piece();
        let shown = match joint.restart {
            Restart::Elastic => joint.kinetic_nm - drop,
            Restart::FromKinetic => joint.kinetic_nm,
        };
        let required = shown * sense;
        self.theta = required / joint.stiffness;
        let length_s = self.reach_s();
        if length_s <= Dd::ZERO {
            self.time_s = self.end_s;
            return;
        }
        let shaft = self.shaft(length_s);
        let omega = shaft.omega.value(Dd::ZERO);
        if drop == Dd::ZERO {
            let margin = shaft.turned.times(Dd::new(-sense));
            if matches!(leaving(&margin, AT_LIMIT), Leaving::Below) {
                self.history.touches_s.push(self.time_s.to_f64());
                self.v = omega;
                return;
            }
        }
        let excess = Some((required.abs() - joint.static_nm).to_f64());
        let certain = Certain {
            half_width_s: 0.0,
            excess,
        };
        self.report_stick(Cause::Elapsed, sense, omega, required, certain);
        self.phase = Phase::Stick { fresh: true };
        self.round_state();
    }

    /// The piece that the time has come to.
    fn find_piece(&mut self) {
        let time_s = self.time_s.to_f64();
        let mut piece = self.problem.motion.piece(time_s);
        if Dd::new(piece.start_s) > self.time_s && piece.start_s > 0.0 {
            // The nearest f64 lies just beyond the boundary.
            piece = self.problem.motion.piece(time_s.next_down());
        } else if Dd::new(piece.end_s) <= self.time_s {
            piece = self.problem.motion.piece(piece.end_s);
        }
        self.piece = piece;
    }
}
