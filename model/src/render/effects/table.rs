//! Everything that follows from a line in the table of effects.

/// Generates what follows from the table.
macro_rules! effects {
    ($($effect:ident: $law:ident, $settings:ident;)*) => {
        /// The effects, in the order in which they act.
        pub const SPECS: &[EffectSpec] = &[$(<$effect::$law<f64> as DeviceEffect<f64>>::SPEC),*];

        /// The device's parameters of each.
        pub const DEVICE: &[&[Parameter]] = &[$($effect::$settings::DEVICE),*];

        /// Parameters of the effects; one that is off is absent.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct EffectSettings {
            $(#[doc = concat!("`", stringify!($effect), "`.")] pub $effect: Option<$effect::$settings>,)*
        }

        /// The torque of each, N·m.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct Added<F> {
            $(#[doc = concat!("Of `", stringify!($effect), "`.")] pub $effect: F,)*
        }

        /// The laws alone, around a bare solver.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Effects<F> {
            $(#[doc = concat!("`", stringify!($effect), "`.")] pub $effect: Option<$effect::$law<F>>,)*
        }

        /// The effects of a device that runs.
        #[derive(Clone, Debug)]
        pub struct SwitchedEffects<F: Real> {
            $($effect: <$effect::$law<F> as DeviceEffect<F>>::Switched,)*
        }

        /// Other laws, where they are other ones.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct EffectChanges<F> {
            $($effect: Option<Option<$effect::$law<F>>>,)*
        }

        impl EffectSettings {
            /// From a device's parameters.
            pub fn read(source: &impl Source) -> Self {
                Self {
                    $($effect: source
                        .is_on(const { switch($effect::$settings::DEVICE) })
                        .then(|| source.read()),)*
                }
            }

            /// From the numbers of each effect that is on, in the order of its
            /// table.
            pub fn given<'a>(numbers: impl Fn(&str) -> Option<&'a [f64]>) -> Self {
                Self {
                    $($effect: numbers(<$effect::$law<f64> as DeviceEffect<f64>>::SPEC.name).map(filled),)*
                }
            }

            /// The laws.
            ///
            /// # Errors
            /// [`SettingsError`] if a setting or the tick is out of range.
            pub fn laws<F: Real>(&self, timing: &Timing) -> Result<Effects<F>, SettingsError> {
                Ok(Effects {
                    $($effect: match &self.$effect {
                        Some(settings) => Some($effect::$law::new(settings, timing)?),
                        None => None,
                    },)*
                })
            }

            /// The laws that differ from those of `now`.
            ///
            /// # Errors
            /// As [`Self::laws`].
            pub fn changes<F: Real>(
                &self,
                now: &Self,
                timing: &Timing,
            ) -> Result<EffectChanges<F>, SettingsError> {
                let laws = self.laws(timing)?;
                Ok(EffectChanges {
                    $($effect: (self.$effect != now.$effect).then_some(laws.$effect),)*
                })
            }
        }

        impl<F: Real> Added<F> {
            /// Nothing.
            pub const NONE: Self = Self { $($effect: F::ZERO,)* };

            /// The same in f64.
            pub fn to_f64(&self) -> Added<f64> {
                Added { $($effect: self.$effect.to_f64(),)* }
            }

            /// Of those that render a disorder, N·m.
            pub fn symptoms_nm(&self) -> F {
                [$((<$effect::$law<F> as DeviceEffect<F>>::IS_SYMPTOM, self.$effect)),*]
                    .into_iter()
                    .filter(|(is_symptom, _)| *is_symptom)
                    .fold(F::ZERO, |sum, (_, nm)| sum + nm)
            }

            /// Of all, N·m.
            pub fn all_nm(&self) -> F {
                [$(self.$effect),*].into_iter().fold(F::ZERO, |sum, nm| sum + nm)
            }

            /// Of the effect at a place of the table.
            pub fn get(&self, place: usize) -> Option<F> {
                [$(self.$effect),*].get(place).copied()
            }
        }

        impl<F: Real> SwitchedEffects<F> {
            /// Without any.
            pub fn new(slew_nm: F) -> Self {
                Self { $($effect: Switched::new(slew_nm),)* }
            }

            /// From the next tick on, these laws, and this slew limit.
            pub fn change(&mut self, changes: EffectChanges<F>, slew_nm: F) {
                $(self.$effect.change(changes.$effect, slew_nm);)*
            }
        }

        impl<F: Real> From<Effects<F>> for EffectChanges<F> {
            fn from(laws: Effects<F>) -> Self {
                Self { $($effect: Some(laws.$effect),)* }
            }
        }

        impl<F: Real> Addition<F> for Effects<F> {
            #[inline]
            fn tick(&mut self, seen: &Seen<F>, input: &Checked<F>, shown: &mut Shown<F>) {
                $(if let Some(law) = &mut self.$effect {
                    let added_nm = law.added_nm(seen, input, shown);
                    shown.torque_nm += added_nm;
                    shown.added.$effect = added_nm;
                    note(Some(law), added_nm, shown);
                })*
            }
        }

        impl<F: Real> Addition<F> for SwitchedEffects<F> {
            #[inline]
            fn tick(&mut self, seen: &Seen<F>, input: &Checked<F>, shown: &mut Shown<F>) {
                $(
                    let added_nm = self.$effect.tick(seen, input, shown);
                    shown.added.$effect = added_nm;
                    note(self.$effect.law(), added_nm, shown);
                )*
            }
        }

        /// Runs `visitor` with the law of the effect at this place, at its
        /// defaults; `None` beyond the last.
        ///
        /// # Errors
        /// As [`EffectSettings::laws`].
        pub fn with_law<F: Real, V: LawVisitor<F>>(
            place: usize,
            timing: &Timing,
            visitor: V,
        ) -> Result<Option<V::Output>, SettingsError> {
            let mut left = place;
            $(
                if left == 0 {
                    let law = $effect::$law::new(&$effect::$settings::defaults(), timing)?;
                    return Ok(Some(visitor.visit::<$effect::$law<F>>(law)));
                }
                left = left.wrapping_sub(1);
            )*
            let _ = left;
            Ok(None)
        }
    };
}
