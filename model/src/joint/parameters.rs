//! Parameters of the imaginary object.

use crate::parameters::settings;

settings! {
    /// The parameters of the stick-slip object, in SI units. Defaults are the
    /// paper's.
    pub struct Parameters, group "crepitus" {
        render {
            id: 0 always,
            choice: ["off", "on"],
            default: 1,
            meaning: "whether the joint grates; `off` is a healthy joint",
        },
        restart {
            id: 5 always,
            choice: ["elastic", "from-kinetic"],
            default: 0,
            meaning: "torque with which a stick begins: 2Tk − Ts, or Tk",
        },
    } {
        inertia_kg_m2 {
            id: 1 always,
            symbol: "J",
            unit: "kg·m²",
            range: 1e-12..=1e3,
            default: 0.01,
            meaning: "inertia of the imaginary object; with the stiffness it sets the pitch √(kr/J)/2π",
        },
        stiffness_nm_per_rad {
            id: 2 always,
            symbol: "kr",
            unit: "N·m/rad",
            range: 1e-6..=1e9,
            default: 400.0,
            meaning: "stiffness of the spring that holds the imaginary object",
        },
        damping_nms_per_rad {
            symbol: "c",
            unit: "N·m·s/rad",
            range: 0.0..=1e6,
            default: 0.0,
            meaning: "viscous damping of the imaginary object; 0 in the paper and under `frozen`",
        },
        kinetic_torque_nm {
            id: 3 always,
            symbol: "Tk",
            unit: "N·m",
            range: 0.0..=1e6,
            default: 0.2,
            meaning: "friction torque while the shaft slips over the object; the mean torque at constant speed",
        },
        static_torque_nm {
            id: 4 always,
            symbol: "Ts",
            unit: "N·m",
            range: 0.0..=1e6,
            default: 0.4,
            meaning: "torque at which a stick breaks; nothing larger is ever shown",
        },
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
