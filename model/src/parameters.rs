//! The parameters of the imaginary object: the one table that scene files,
//! the command line, the device's wire and the documents read; and what all
//! such tables have in common, [`Tabled`].

use crate::settings::SettingsError;

/// What is known about one parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterSpec {
    /// Name in scene files and on the command line; the unit is part of it.
    pub key: &'static str,
    /// Symbol in equations.
    pub symbol: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Smallest value allowed.
    pub min: f64,
    /// Largest value allowed.
    pub max: f64,
    /// The paper's value.
    pub default: f64,
    /// What it means.
    pub meaning: &'static str,
}

/// Settings that are the numbers of one table.
pub trait Tabled<const N: usize>: Copy {
    /// One entry a number: key with unit, range, default, meaning.
    const TABLE: &'static [ParameterSpec; N];

    /// The numbers in the order of the table.
    fn values(&self) -> [f64; N];

    /// From numbers in the order of the table; not checked.
    fn of(values: [f64; N]) -> Self;

    /// The table's defaults.
    fn defaults() -> Self {
        Self::of(Self::TABLE.map(|parameter| parameter.default))
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`SettingsError::OutOfRange`] for the first number that is outside, or
    /// no number at all.
    fn validate(&self) -> Result<(), SettingsError> {
        for (parameter, value) in Self::TABLE.iter().zip(self.values()) {
            // Written so that NaN fails.
            if !(value >= parameter.min && value <= parameter.max) {
                return Err(SettingsError::OutOfRange { parameter, value });
            }
        }
        Ok(())
    }
}

/// The parameters of the stick-slip object, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// J, kg·m².
    pub inertia_kg_m2: f64,
    /// kr, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// c, N·m·s/rad.
    pub damping_nms_per_rad: f64,
    /// Tk, N·m.
    pub kinetic_torque_nm: f64,
    /// Ts, N·m.
    pub static_torque_nm: f64,
}

/// Inertia J.
pub const INERTIA: ParameterSpec = ParameterSpec {
    key: "inertia_kg_m2",
    symbol: "J",
    unit: "kg·m²",
    min: 1e-12,
    max: 1e3,
    default: 0.01,
    meaning: "inertia of the imaginary object; with the stiffness it sets the pitch √(kr/J)/2π",
};
/// Stiffness kr.
pub const STIFFNESS: ParameterSpec = ParameterSpec {
    key: "stiffness_nm_per_rad",
    symbol: "kr",
    unit: "N·m/rad",
    min: 1e-6,
    max: 1e9,
    default: 400.0,
    meaning: "stiffness of the spring that holds the imaginary object",
};
/// Damping c.
pub const DAMPING: ParameterSpec = ParameterSpec {
    key: "damping_nms_per_rad",
    symbol: "c",
    unit: "N·m·s/rad",
    min: 0.0,
    max: 1e6,
    default: 0.0,
    meaning: "viscous damping of the imaginary object; 0 in the paper and under `frozen`",
};
/// Kinetic friction torque Tk.
pub const KINETIC_TORQUE: ParameterSpec = ParameterSpec {
    key: "kinetic_torque_nm",
    symbol: "Tk",
    unit: "N·m",
    min: 0.0,
    max: 1e6,
    default: 0.2,
    meaning: "friction torque while the shaft slips over the object; the mean torque at constant speed",
};
/// Static friction torque Ts.
pub const STATIC_TORQUE: ParameterSpec = ParameterSpec {
    key: "static_torque_nm",
    symbol: "Ts",
    unit: "N·m",
    min: 0.0,
    max: 1e6,
    default: 0.4,
    meaning: "torque at which a stick breaks; nothing larger is ever shown",
};

/// All parameters, in the order of [`Parameters::values`].
pub const PARAMETERS: [ParameterSpec; 5] =
    [INERTIA, STIFFNESS, DAMPING, KINETIC_TORQUE, STATIC_TORQUE];

impl Parameters {
    /// The values in the order of [`PARAMETERS`].
    pub fn values(&self) -> [f64; 5] {
        [
            self.inertia_kg_m2,
            self.stiffness_nm_per_rad,
            self.damping_nms_per_rad,
            self.kinetic_torque_nm,
            self.static_torque_nm,
        ]
    }

    /// The values, to be changed in the order of [`PARAMETERS`].
    pub fn values_mut(&mut self) -> [&mut f64; 5] {
        [
            &mut self.inertia_kg_m2,
            &mut self.stiffness_nm_per_rad,
            &mut self.damping_nms_per_rad,
            &mut self.kinetic_torque_nm,
            &mut self.static_torque_nm,
        ]
    }

    /// Natural frequency ωn = √(kr/J), rad/s.
    pub fn natural_rad_s(&self) -> f64 {
        libm::sqrt(self.stiffness_nm_per_rad / self.inertia_kg_m2)
    }

    /// √(J·kr), N·m·s/rad: the torque that one rad/s of speed is worth.
    pub fn impedance_nms_per_rad(&self) -> f64 {
        libm::sqrt(self.inertia_kg_m2 * self.stiffness_nm_per_rad)
    }

    /// Torque with which an elastic stick begins after a slip: 2Tk − Ts, N·m.
    pub fn restart_torque_nm(&self) -> f64 {
        2.0 * self.kinetic_torque_nm - self.static_torque_nm
    }
}

impl Default for Parameters {
    /// The paper's parameters.
    fn default() -> Self {
        Self {
            inertia_kg_m2: INERTIA.default,
            stiffness_nm_per_rad: STIFFNESS.default,
            damping_nms_per_rad: DAMPING.default,
            kinetic_torque_nm: KINETIC_TORQUE.default,
            static_torque_nm: STATIC_TORQUE.default,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// What holds for the table of any settings.
    pub(crate) fn is_its_table_and_is_held_to_it<const N: usize, T: Tabled<N>>() {
        let defaults = T::defaults().values();
        assert_eq!(T::defaults().validate(), Ok(()));
        // Each number is its own: none is lost or changes place.
        let numbers = core::array::from_fn(|i| 1.0 + f64::from(u8::try_from(i).unwrap()));
        assert_eq!(T::of(numbers).values(), numbers);
        for (i, spec) in T::TABLE.iter().enumerate() {
            assert_eq!(defaults[i], spec.default);
            assert!(T::TABLE.iter().filter(|s| s.key == spec.key).count() == 1);
            let with = |value| {
                let mut values = defaults;
                values[i] = value;
                T::of(values).validate()
            };
            let beyond = |edge: f64| edge.abs() * 0.01 + 1e-9;
            for good in [spec.min, spec.max] {
                assert_eq!(with(good), Ok(()), "{} = {good}", spec.key);
            }
            for bad in [
                f64::NAN,
                f64::INFINITY,
                f64::NEG_INFINITY,
                spec.min - beyond(spec.min),
                spec.max + beyond(spec.max),
            ] {
                let refused = with(bad);
                assert!(
                    matches!(refused, Err(SettingsError::OutOfRange { parameter, .. }) if parameter == spec),
                    "{} = {bad}: {refused:?}",
                    spec.key
                );
            }
        }
    }
}
