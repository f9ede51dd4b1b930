//! A motor's winding between its terminals and the joint.
//!
//! ```text
//! L·di/dt = v − R·i − Kt·N·Ω,   torque on the joint = Kt·N·i
//! ```
//!
//! The winding's 0.28 ms are short against a tick, so the equation is solved exactly for
//! a constant voltage and the shaft's mean velocity w over a step: current and
//! mean torque come out affine in w, so the coupling with the mechanics is
//! implicit, and what the terminals take in is exactly what the copper, the
//! field and the shaft get.

use crate::chain::Push;
use crate::energy_balance::{Account, EnergyBalance};

/// Constants of a winding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindingSettings {
    /// Resistance R, Ω.
    pub resistance_ohm: f64,
    /// Inductance L, H.
    pub inductance_h: f64,
    /// Kt·N, N·m of the joint for one ampere, and V for one rad/s of it.
    pub constant: f64,
}

/// Current and energy of a winding.
#[derive(Clone, Copy, Debug)]
pub struct Winding {
    settings: WindingSettings,
    /// Half of L/R, s.
    half_tau_s: f64,
    transient: Transient,
    current_a: f64,
    /// Mean torque over the last step; positive opposes growing angle.
    torque_nm: f64,
    absorbed_j: f64,
    supplied_j: f64,
    copper_j: f64,
}

/// The winding under a held voltage over one length of time.
#[derive(Clone, Copy, Debug)]
struct Transient {
    length_s: f64,
    /// Share of a difference from the final current that is left at the end.
    left: f64,
    /// Mean of that share over the time.
    mean: f64,
    /// Mean share of the way to the final current.
    forced: f64,
    /// Mean torque that opposes a velocity, N·m·s.
    slope_nms: f64,
    /// Share of the square of a difference that is gone at the end.
    spent: f64,
}

/// The current over a step: `final_a` plus the decaying rest of `from_a`.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    /// Final value, A.
    pub final_a: f64,
    /// Difference from the final value at the start, A.
    pub from_a: f64,
}

impl Course {
    /// The current where `left` is left of the way, A; see
    /// [`Winding::left_after`].
    #[inline]
    pub fn current_a(&self, left: f64) -> f64 {
        self.final_a + left * self.from_a
    }
}

impl Winding {
    /// A winding that carries a current, and is mostly stepped by `usual_s`.
    pub fn new(settings: WindingSettings, current_a: f64, usual_s: f64) -> Self {
        let mut winding = Self {
            settings,
            half_tau_s: 0.5 * (settings.inductance_h / settings.resistance_ohm),
            transient: Transient {
                length_s: 0.0,
                left: 1.0,
                mean: 1.0,
                forced: 0.0,
                slope_nms: 0.0,
                spent: 0.0,
            },
            current_a,
            torque_nm: 0.0,
            absorbed_j: 0.0,
            supplied_j: 0.0,
            copper_j: 0.0,
        };
        winding.hold_for(usual_s);
        winding
    }

    /// Constants.
    pub fn settings(&self) -> &WindingSettings {
        &self.settings
    }

    /// Makes this the length of the transient, s.
    #[inline]
    fn hold_for(&mut self, length_s: f64) {
        if length_s != self.transient.length_s {
            self.transient = self.transient(length_s);
        }
    }

    #[cold]
    fn transient(&self, length_s: f64) -> Transient {
        let WindingSettings {
            resistance_ohm,
            inductance_h,
            constant,
        } = self.settings;
        let x = resistance_ohm * length_s / inductance_h;
        let left = (-x).exp();
        let mean = -(-x).exp_m1() / x;
        let forced = 1.0 - mean;
        Transient {
            length_s,
            left,
            mean,
            forced,
            slope_nms: constant * constant * forced / resistance_ohm,
            spent: 1.0 - left * left,
        }
    }

    /// L/R, s.
    pub fn time_constant_s(&self) -> f64 {
        self.settings.inductance_h / self.settings.resistance_ohm
    }

    /// Share of a difference from the final current that is left after a time.
    pub fn left_after(&self, length_s: f64) -> f64 {
        (-self.settings.resistance_ohm * length_s / self.settings.inductance_h).exp()
    }

    /// The torque on the joint over a step with this voltage at the terminals.
    #[inline]
    pub fn fold(&mut self, voltage_v: f64, length_s: f64) -> Push {
        let WindingSettings {
            resistance_ohm,
            constant,
            ..
        } = self.settings;
        self.hold_for(length_s);
        let t = &self.transient;
        let amperes = t.mean * self.current_a + t.forced * voltage_v / resistance_ohm;
        Push {
            torque_nm: constant * amperes,
            slope_nms: t.slope_nms,
            held_by_nm: None,
        }
    }

    /// The current over a step with this voltage at the terminals, in which
    /// the shaft turns with `mean_rad_s`.
    #[inline]
    pub fn course(&self, voltage_v: f64, mean_rad_s: f64) -> Course {
        let emf_v = self.settings.constant * mean_rad_s;
        let final_a = (voltage_v - emf_v) / self.settings.resistance_ohm;
        Course {
            final_a,
            from_a: self.current_a - final_a,
        }
    }

    /// Makes the step with this course. Returns the mean current, A.
    #[inline]
    pub fn settle(
        &mut self,
        voltage_v: f64,
        length_s: f64,
        mean_rad_s: f64,
        course: &Course,
    ) -> f64 {
        let WindingSettings {
            resistance_ohm,
            constant,
            ..
        } = self.settings;
        self.hold_for(length_s);
        let t = &self.transient;
        let Course { final_a, from_a } = *course;
        let mean_a = final_a + t.mean * from_a;
        // ∫i² dt of an exponential.
        let square = length_s * final_a * (final_a + 2.0 * t.mean * from_a)
            + self.half_tau_s * from_a * from_a * t.spent;
        self.copper_j += resistance_ohm * square;
        self.supplied_j += voltage_v * mean_a * length_s;
        self.torque_nm = -constant * mean_a;
        self.absorbed_j += self.torque_nm * mean_rad_s * length_s;
        self.current_a = course.current_a(t.left);
        mean_a
    }

    /// The current is cut off. Returns the energy that its field had, J.
    pub fn cut_off(&mut self) -> f64 {
        let field_j = self.field_j();
        self.current_a = 0.0;
        field_j
    }

    /// A step without current.
    pub fn idle(&mut self) {
        self.torque_nm = 0.0;
    }

    /// The current, A.
    #[inline]
    pub fn current_a(&self) -> f64 {
        self.current_a
    }

    /// Torque of the winding now, N·m: positive in the direction of growing angle.
    #[inline]
    pub fn load_nm(&self) -> f64 {
        self.settings.constant * self.current_a
    }

    /// Mean torque over the last step, N·m; positive opposes growing angle.
    pub fn torque_nm(&self) -> f64 {
        self.torque_nm
    }

    /// Work that its torque has taken out of the mechanics so far, J.
    pub fn absorbed_j(&self) -> f64 {
        self.absorbed_j
    }

    /// Work that has come in at the terminals so far, J.
    pub fn supplied_j(&self) -> f64 {
        self.supplied_j
    }

    fn field_j(&self) -> f64 {
        0.5 * self.settings.inductance_h * self.current_a * self.current_a
    }

    /// Adds its stored and dissipated energy to the balance.
    pub fn energy(&self, effect: &'static str, balance: &mut EnergyBalance) {
        balance.add(effect, "copper", Account::Lost, self.copper_j);
        balance.add(effect, "field", Account::Stored, self.field_j());
    }
}
