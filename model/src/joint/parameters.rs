//! Parameters of the imaginary object.

use crate::parameters::settings;

settings! {
    /// The parameters of the stick-slip object, in SI units. Defaults are the
    /// paper's.
    pub struct Parameters, group "crepitus" {
        render (0 always) ["off", "on"], 1, "whether the joint grates; `off` is a healthy joint";
        restart (5 always) ["elastic", "from-kinetic"], 0, "torque with which a stick begins: 2Tk − Ts, or Tk";
    } {
        inertia_kg_m2 (1 always) "J" "kg·m²", 1e-12..=1e3, 0.01,
            "inertia of the imaginary object; with the stiffness it sets the pitch √(kr/J)/2π";
        stiffness_nm_per_rad (2 always) "kr" "N·m/rad", 1e-6..=1e9, 400.0,
            "stiffness of the spring that holds the imaginary object";
        damping_nms_per_rad "c" "N·m·s/rad", 0.0..=1e6, 0.0,
            "viscous damping of the imaginary object; 0 in the paper and under `frozen`";
        kinetic_torque_nm (3 always) "Tk" "N·m", 0.0..=1e6, 0.2,
            "friction torque while the shaft slips over the object; the mean torque at constant speed";
        static_torque_nm (4 always) "Ts" "N·m", 0.0..=1e6, 0.4,
            "torque at which a stick breaks; nothing larger is ever shown";
    }
}

impl Parameters {
    /// Natural frequency ωn = √(kr/J), rad/s.
    pub fn natural_rad_s(&self) -> f64 {
        libm::sqrt(self.stiffness_nm_per_rad / self.inertia_kg_m2)
    }

    /// √(J·kr), N·m·s/rad: the torque that corresponds to one rad/s.
    pub fn impedance_nms_per_rad(&self) -> f64 {
        libm::sqrt(self.inertia_kg_m2 * self.stiffness_nm_per_rad)
    }

    /// Torque with which an elastic stick begins after a slip: 2Tk − Ts, N·m.
    pub fn restart_torque_nm(&self) -> f64 {
        2.0 * self.kinetic_torque_nm - self.static_torque_nm
    }
}
