//! Imperfections that a brace of rigid parts with Coulomb friction leaves out.

/// Velocity over which Stribeck's friction falls, rad/s.
const STRIBECK_RAD_S: f64 = 0.15;

/// Terms of a friction that varies with the angle.
pub const BY_ANGLE: usize = 4;

/// Imperfections that a brace of rigid parts with Coulomb friction leaves out; all zero without them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Imperfections {
    /// Compliance of the friction before it slips, rad/(N·m): microslip (Prandtl's element).
    pub presliding_rad_per_nm: f64,
    /// Compliance of teeth and links, rad/(N·m).
    pub teeth_rad_per_nm: f64,
    /// Friction at rest beyond that of a fast motion, as a share: 1 + s·exp(−(Ω/0.15 rad/s)²) (Stribeck).
    pub stribeck: f64,
    /// Friction by angle, shares: of the Legendre polynomials P₁ to P₄ of the angle from the hang over the range.
    pub by_angle: [f64; BY_ANGLE],
    /// Half the range of those, rad; 1 where it is not above zero.
    pub range_rad: f64,
}

impl Imperfections {
    /// Returns friction over Coulomb's at an angle from the hang, rad, and a velocity, rad/s.
    #[inline]
    pub(super) fn friction_share(&self, from_hang_rad: f64, omega_rad_s: f64) -> f64 {
        if self.stribeck == 0.0 && self.by_angle == [0.0; BY_ANGLE] {
            return 1.0;
        }
        let range_rad = if self.range_rad > 0.0 {
            self.range_rad
        } else {
            1.0
        };
        let x = (from_hang_rad / range_rad).clamp(-1.0, 1.0);
        let square = x * x;
        let legendre = [
            x,
            1.5 * square - 0.5,
            (2.5 * square - 1.5) * x,
            (4.375 * square - 3.75) * square + 0.375,
        ];
        let by_angle: f64 = legendre.iter().zip(self.by_angle).map(|(p, a)| p * a).sum();
        let slow = if self.stribeck == 0.0 {
            0.0
        } else {
            self.stribeck * (-(omega_rad_s / STRIBECK_RAD_S).powi(2)).exp()
        };
        (1.0 + by_angle + slow).max(0.0)
    }
}
