//! Declaration of parameters, once each, with `settings!`: scene files, the
//! command line, the device's wire and the documents read these tables.

use core::cmp::Ordering;

/// One numeric parameter.
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
    /// Description.
    pub meaning: &'static str,
}

/// A parameter of a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Number of the parameter on the wire and in flash. Numbers are given once and need not
    /// be contiguous.
    pub id: u8,
    /// The effect or the part that it belongs to, as in scene files.
    pub group: &'static str,
    /// Number or choice.
    pub kind: Kind,
    /// Condition under which it may change.
    pub when: When,
}

/// The type of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number in a range.
    Number(&'static ParameterSpec),
    /// One of some names; its value is the place of the name.
    Choice(&'static Choice),
}

/// A parameter that is one of some names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Name.
    pub key: &'static str,
    /// The names of the options, in the order of their values.
    pub names: &'static [&'static str],
    /// Place of the default.
    pub default: u8,
    /// Description.
    pub meaning: &'static str,
}

/// Condition under which a parameter may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum When {
    /// Always; active values move there within the slew limit.
    Always,
    /// Only while disarmed.
    Disarmed,
}

impl Parameter {
    /// Name within its group; a number's has its unit.
    pub const fn key(&self) -> &'static str {
        match self.kind {
            Kind::Number(spec) => spec.key,
            Kind::Choice(choice) => choice.key,
        }
    }

    /// The default.
    pub const fn default(&self) -> f64 {
        match self.kind {
            Kind::Number(spec) => spec.default,
            Kind::Choice(choice) => choice.default as f64,
        }
    }

    /// Description.
    pub const fn meaning(&self) -> &'static str {
        match self.kind {
            Kind::Number(spec) => spec.meaning,
            Kind::Choice(choice) => choice.meaning,
        }
    }

    /// Returns whether this value is allowed; NaN never is.
    pub fn allows(&self, value: f64) -> bool {
        match self.kind {
            Kind::Number(spec) => spec.allows(value),
            Kind::Choice(choice) => (0_u8..)
                .zip(choice.names)
                .any(|(place, _)| f64::from(place).partial_cmp(&value) == Some(Ordering::Equal)),
        }
    }
}

impl ParameterSpec {
    /// Returns whether this value is allowed; NaN never is.
    pub fn allows(&self, value: f64) -> bool {
        value >= self.min && value <= self.max
    }
}

/// A number outside its range, or NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfRange {
    /// The parameter, with its range.
    pub parameter: &'static ParameterSpec,
    /// The rejected value.
    pub value: f64,
}

/// Settings that are the numbers of one table, and choices; `settings!` makes
/// them.
pub trait Tabled<const N: usize>: Copy {
    /// One entry a number: key with unit, range, default, meaning.
    const TABLE: &'static [ParameterSpec; N];

    /// The wire's number of each, where a device has it.
    const IDS: [Option<u8>; N];

    /// The numbers in the order of the table.
    fn values(&self) -> [f64; N];

    /// The numbers, to be changed, in the order of the table.
    fn values_mut(&mut self) -> [&mut f64; N];

    /// Settings from numbers in the order of the table, with choices at their defaults;
    /// not checked.
    fn of(values: [f64; N]) -> Self;

    /// The choices among the settings.
    const CHOICES: &'static [Choice];

    /// The wire's number of each.
    const CHOICE_IDS: &'static [u8];

    /// The place of the option that is chosen, of each choice.
    fn chosen(&self) -> impl Iterator<Item = u8>;

    /// Chooses an option of the choice at `index`; ignores what there is not.
    fn choose(&mut self, index: usize, option: u8);

    /// The table's defaults.
    fn defaults() -> Self {
        Self::of(Self::TABLE.map(|parameter| parameter.default))
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`OutOfRange`] for the first number that is outside, or NaN.
    fn validate(&self) -> Result<(), OutOfRange> {
        for (parameter, value) in Self::TABLE.iter().zip(self.values()) {
            if !parameter.allows(value) {
                return Err(OutOfRange { parameter, value });
            }
        }
        Ok(())
    }
}

/// Values of a device's parameters, by id.
pub trait Source {
    /// Returns whether a choice is not the first of its names: `off` is the first.
    fn is_on(&self, id: u8) -> bool;

    /// Settings, as far as a device has them; the rest at its defaults.
    fn read<const N: usize, T: Tabled<N>>(&self) -> T;
}

/// Numbers and choices of an effect, in the order of its tables.
#[derive(Clone, Copy, Debug, Default)]
pub struct Chosen<'a> {
    /// Numbers.
    pub numbers: &'a [f64],
    /// Places of the options that are chosen.
    pub options: &'a [u8],
}

/// Settings from what is given; the rest at its defaults.
pub fn filled<const N: usize, T: Tabled<N>>(given: Chosen<'_>) -> T {
    let mut settings = T::defaults();
    for (value, number) in settings.values_mut().into_iter().zip(given.numbers) {
        *value = *number;
    }
    for (index, option) in given.options.iter().enumerate() {
        settings.choose(index, *option);
    }
    settings
}

/// The id of the choice with which an effect's parameters begin.
#[expect(clippy::panic, reason = "at compile time: it ends the build")]
pub(crate) const fn switch(device: &[Parameter]) -> u8 {
    match device {
        [
            Parameter {
                id,
                kind: Kind::Choice(_),
                ..
            },
            ..,
        ] => *id,
        _ => panic!("an effect's parameters begin with a choice, off or on"),
    }
}

/// Declares settings: the one place where a parameter's name, symbol, unit,
/// range, default and meaning stand, its number on the wire, and when it may
/// change (`always`, or only `disarmed`).
///
/// ```text
/// settings! {
///     /// Why there are such settings.
///     pub struct NameSettings, group "name" {
///         render (7 always) ["off", "on"], 0, "whether …";
///     } chosen {
///         form (9 always) ["round", "square"], 0, "its form";
///     } {
///         gain (8 always) "g" "1", 0.0..=10.0, 1.0, "gain of …";
///     }
/// }
/// ```
///
/// A choice has names and the place of its default; a number has symbol, unit, range and
/// default. The device's own choices come first; they are not fields of the struct. Those
/// that are `chosen` are: the place of an option. A number without an id is one that no
/// device has. Made are the struct with its fields, [`Tabled`] and
/// [`Default`], and `DEVICE`: what a device has of it, to be listed in
/// `crepitus_protocol::parameters`.
macro_rules! settings {
    (
        $(#[$meta:meta])*
        pub struct $name:ident, group $group:literal {
            $($choice:ident ($choice_id:literal $choice_when:ident)
                $names:expr, $choice_default:literal, $choice_meaning:literal;)*
        } $(chosen {
            $($pick:ident ($pick_id:literal $pick_when:ident)
                $pick_names:expr, $pick_default:literal, $pick_meaning:literal;)*
        })? {
            $($field:ident $(($id:literal $when:ident))?
                $symbol:literal $unit:literal, $min:literal..=$max:literal, $default:literal, $meaning:literal;)*
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name {
            $($(#[doc = concat!("Place of the option: ", $pick_meaning, ".")] pub $pick: u8,)*)?
            $(#[doc = concat!($symbol, ", ", $unit, ": ", $meaning, ".")] pub $field: f64,)*
        }

        #[allow(non_upper_case_globals, reason = "named as the fields that they describe")]
        impl $name {
            $(const $field: $crate::parameters::ParameterSpec = $crate::parameters::ParameterSpec {
                key: stringify!($field),
                symbol: $symbol,
                unit: $unit,
                min: $min,
                max: $max,
                default: $default,
                meaning: $meaning,
            };)*

            $($(const $pick: $crate::parameters::Choice = $crate::parameters::Choice {
                key: stringify!($pick),
                names: &$pick_names,
                default: $pick_default,
                meaning: $pick_meaning,
            };)*)?

            /// The device's parameters of this group.
            pub const DEVICE: &'static [$crate::parameters::Parameter] = &[
                $($crate::parameters::Parameter {
                    id: $choice_id,
                    group: $group,
                    kind: $crate::parameters::Kind::Choice(&$crate::parameters::Choice {
                        key: stringify!($choice),
                        names: &$names,
                        default: $choice_default,
                        meaning: $choice_meaning,
                    }),
                    when: $crate::parameters::settings!(@when $choice_when),
                },)*
                $($($crate::parameters::Parameter {
                    id: $pick_id,
                    group: $group,
                    kind: $crate::parameters::Kind::Choice(&Self::$pick),
                    when: $crate::parameters::settings!(@when $pick_when),
                },)*)?
                $($($crate::parameters::Parameter {
                    id: $id,
                    group: $group,
                    kind: $crate::parameters::Kind::Number(&Self::$field),
                    when: $crate::parameters::settings!(@when $when),
                },)?)*
            ];
        }

        impl $crate::parameters::Tabled<{ [$(stringify!($field)),*].len() }> for $name {
            const TABLE: &'static [$crate::parameters::ParameterSpec; [$(stringify!($field)),*].len()] =
                &[$(Self::$field),*];

            const IDS: [Option<u8>; [$(stringify!($field)),*].len()] =
                [$($crate::parameters::settings!(@id $($id)?)),*];

            fn values(&self) -> [f64; [$(stringify!($field)),*].len()] {
                [$(self.$field),*]
            }

            fn values_mut(&mut self) -> [&mut f64; [$(stringify!($field)),*].len()] {
                [$(&mut self.$field),*]
            }

            fn of([$($field),*]: [f64; [$(stringify!($field)),*].len()]) -> Self {
                Self { $($($pick: Self::$pick.default,)*)? $($field),* }
            }

            const CHOICES: &'static [$crate::parameters::Choice] = &[$($(Self::$pick),*)?];

            const CHOICE_IDS: &'static [u8] = &[$($($pick_id),*)?];

            fn chosen(&self) -> impl Iterator<Item = u8> {
                let chosen: [u8; Self::CHOICE_IDS.len()] = [$($(self.$pick),*)?];
                chosen.into_iter()
            }

            fn choose(&mut self, index: usize, option: u8) {
                let chosen: [&mut u8; Self::CHOICE_IDS.len()] = [$($(&mut self.$pick),*)?];
                if let Some(chosen) = chosen.into_iter().nth(index) {
                    *chosen = option;
                }
            }
        }

        impl Default for $name {
            fn default() -> Self {
                $crate::parameters::Tabled::defaults()
            }
        }
    };
    (@when always) => { $crate::parameters::When::Always };
    (@when disarmed) => { $crate::parameters::When::Disarmed };
    (@id) => { None };
    (@id $id:literal) => { Some($id) };
}

pub(crate) use settings;

/// Returns whether two names are the same, at compile time.
pub const fn same(a: &str, b: &str) -> bool {
    let (mut a, mut b) = (a.as_bytes(), b.as_bytes());
    while let ([x, more_a @ ..], [y, more_b @ ..]) = (a, b) {
        if *x != *y {
            return false;
        }
        (a, b) = (more_a, more_b);
    }
    a.is_empty() && b.is_empty()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Asserts what holds for the table of any settings.
    pub(crate) fn is_its_table_and_is_held_to_it<const N: usize, T: Tabled<N>>() {
        let defaults = T::defaults().values();
        assert_eq!(T::defaults().validate(), Ok(()));
        // Each number is its own: none is lost or changes place.
        let numbers = core::array::from_fn(|i| 1.0 + f64::from(u8::try_from(i).unwrap()));
        assert_eq!(T::of(numbers).values(), numbers);
        assert_eq!(T::of(numbers).values_mut().map(|x| *x), numbers);
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
                    matches!(refused, Err(OutOfRange { parameter, .. }) if parameter == spec),
                    "{} = {bad}: {refused:?}",
                    spec.key
                );
            }
        }
    }
}
