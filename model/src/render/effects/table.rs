//! Everything that follows from a line in the table of effects.

/// Generates what follows from the table. Symptoms act before what is added to them.
macro_rules! effects {
    (
        symptoms { $($symptom:ident: $s_law:ident, $s_settings:ident;)* }
        additions { $($addition:ident: $a_law:ident, $a_settings:ident;)* }
    ) => {
        effects! { @all
            $($symptom: $s_law, $s_settings;)*
            $($addition: $a_law, $a_settings;)*
        }
        effects! { @switched
            { $($symptom: $s_law;)* }
            { $($addition: $a_law;)* }
        }

        /// The symptoms, in the order of the table.
        pub const SYMPTOMS: &[(EffectSpec, ClinicWords)] = &[$((
            <$symptom::$s_law<f64> as Law>::SPEC,
            <$symptom::$s_law<f64> as Law>::WORDS,
        )),*];

        /// A bit for each symptom.
        const SYMPTOM_BITS: u32 = $(bit::<$symptom::$s_law<f64>>())|*;

        impl<F: Real> Effects<F> {
            /// Goes on in ticks of another length, see [`Law::retime`]: the symptoms alone, what
            /// is added to them knows whole ticks only.
            pub fn retime(&mut self, settings: &EffectSettings, timing: &Timing, ratio: f64) {
                $(if let (Some(law), Some(settings)) = (&mut self.$symptom, &settings.$symptom) {
                    law.retime(settings, timing, ratio);
                })*
                self.scale = Scale::new(&timing.sensing, timing.step_s);
            }

            /// Adds what the symptoms have on a joint that rests at a place.
            pub fn add_resting(&self, place: &Position<F>, shown: &mut Shown<F>) {
                $(if let Some(law) = &self.$symptom {
                    shown.added.$symptom = law.resting_nm(place);
                    shown.torque_nm += shown.added.$symptom;
                })*
            }

            /// Returns whether all that are on are symptoms of which none gives energy: a tick is
            /// then that of each alone.
            pub fn is_passive(&self) -> bool {
                let is_active = $(self.$symptom.as_ref().is_some_and(Law::is_active))||*;
                self.on & !SYMPTOM_BITS == 0 && !is_active
            }

            /// Follows the joint with the symptom at a place of the table: the torque that it
            /// adds, N·m. For one that is passive; without a travel to be followed it is held.
            #[inline(always)]
            pub fn follow(
                &mut self,
                place: usize,
                travel: Option<&Travel<F>>,
                added: &mut Added<F>,
                observe: &mut impl Observe<F>,
            ) -> F {
                let mut besides = Besides::NOTHING;
                $(if place == const { bit::<$symptom::$s_law<f64>>().trailing_zeros() as usize } {
                    if let Some(law) = &mut self.$symptom {
                        added.$symptom = law_nm(law, travel, &mut besides, observe);
                    }
                    return added.$symptom;
                })*
                F::ZERO
            }

            /// Phases of the symptoms that are on.
            pub fn phases(&self) -> Phases {
                let mut shown = Shown::<F>::nothing();
                $(if let Some(law) = &self.$symptom {
                    note(Some(law), F::ZERO, &mut shown);
                })*
                shown.phases
            }

            /// Ends a part of a tick that began as `before`: what knows whole ticks only is as it
            /// was then. The tank takes a part for a tick.
            pub fn forget_part(&mut self, before: &Self) {
                $(if let (Some(law), Some(before)) = (&mut self.$symptom, &before.$symptom) {
                    law.forget_part(before);
                })*
                $(self.$addition = before.$addition;)*
            }
        }

        impl EffectSettings {
            /// Checks each symptom by itself.
            fn check_symptoms(&self) -> Result<(), SettingsError> {
                $(if let Some(settings) = &self.$symptom {
                    <$symptom::$s_law<f64> as Law>::check(settings)?;
                })*
                Ok(())
            }

            /// Returns whether a symptom that is on gives energy: a tank pays for it.
            ///
            /// # Errors
            /// As [`Self::laws`].
            pub fn gives_energy(&self, timing: &Timing) -> Result<bool, SettingsError> {
                let laws = self.laws::<f64>(timing)?;
                Ok($(laws.$symptom.as_ref().is_some_and(Law::is_active))||*)
            }

            /// Bounds of the demand of each symptom that is on.
            fn bounds(&self) -> impl Iterator<Item = Bounds> {
                let all = [$(self.$symptom.as_ref().map(<$symptom::$s_law<f64> as Law>::bounds)),*];
                all.into_iter().flatten()
            }
        }
    };
    (@all $($effect:ident: $law:ident, $settings:ident;)*) => {
        /// The effects, in the order in which they act.
        pub const SPECS: &[EffectSpec] = &[$(<$effect::$law<f64> as DeviceEffect<f64>>::SPEC),*];

        /// Flags of the effects, true for those that render a disorder.
        pub const IS_SYMPTOM: &[bool] =
            &[$(<$effect::$law<f64> as DeviceEffect<f64>>::IS_SYMPTOM),*];

        /// The device's parameters of each.
        pub const DEVICE: &[&[Parameter]] = &[$($effect::$settings::DEVICE),*];

        /// Parameters of the effects; one that is off is absent.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct EffectSettings {
            $(#[doc = concat!("`", stringify!($effect), "`.")] pub $effect: Option<$effect::$settings>,)*
        }

        /// Contribution of each effect, N·m or V.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct Added<F> {
            $(#[doc = concat!("Of `", stringify!($effect), "`.")] pub $effect: F,)*
        }

        /// The laws alone, around a bare solver. A tick steps through those that are on.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Effects<F: Real> {
            /// A bit for each that was on when it was made, at its place in the table.
            on: u32,
            $(#[doc = concat!("`", stringify!($effect), "`.")] pub $effect: Option<$effect::$law<F>>,)*
            /// Tank from which symptoms that are no springs are paid.
            pub tank: Tank<F>,
            /// Scale of angles and times.
            pub scale: Scale<F>,
        }

        /// Other laws, where they are other ones.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct EffectChanges<F: Real> {
            $($effect: Option<Option<<$effect::$law<F> as DeviceEffect<F>>::Coefficients>>,)*
            scale: Scale<F>,
        }

        impl EffectSettings {
            /// Settings from a device's parameters.
            pub fn read(source: &impl Source) -> Self {
                Self {
                    $($effect: source
                        .is_on(const { switch($effect::$settings::DEVICE) })
                        .then(|| source.read()),)*
                }
            }

            /// Settings from what is given for each effect that is on.
            pub fn given<'a>(given: impl Fn(&str) -> Option<Chosen<'a>>) -> Self {
                Self {
                    $($effect: given(<$effect::$law<f64> as DeviceEffect<f64>>::SPEC.name).map(filled),)*
                }
            }

            /// Returns the settings of the effect at a place of the table, alone.
            #[must_use]
            pub fn only(&self, place: usize) -> Self {
                let mut here = (0..).map(|other| other == place);
                Self {
                    $($effect: {
                        let is_here = here.next() == Some(true);
                        self.$effect.filter(|_| is_here)
                    },)*
                }
            }

            /// Returns whether what the effect at a place of the table adds is torque of the motor.
            pub fn acts_on_joint(&self, place: usize) -> bool {
                let acts = [$(self.$effect.as_ref().is_some_and(|settings| {
                    <$effect::$law<f64> as DeviceEffect<f64>>::target_of(settings) == Target::Joint
                })),*];
                acts.get(place).is_some_and(|acts| *acts)
            }

            /// The laws.
            ///
            /// # Errors
            /// [`SettingsError`] if a setting or the tick is out of range.
            pub fn laws<F: Real>(&self, timing: &Timing) -> Result<Effects<F>, SettingsError> {
                let made = self.changes_from_none::<F>(timing)?;
                let bits = [$((self.$effect.is_some(), const { bit::<$effect::$law<f64>>() })),*];
                let are_on = bits.into_iter().filter(|(is_on, _)| *is_on);
                Ok(Effects {
                    on: are_on.fold(0, |on, (_, bit)| on | bit),
                    $($effect: made.$effect.flatten().map(<$effect::$law<F> as DeviceEffect<F>>::new),)*
                    tank: tank(timing),
                    scale: made.scale,
                })
            }

            /// Differences from no effect at all.
            ///
            /// # Errors
            /// As [`Self::laws`].
            pub fn changes_from_none<F: Real>(
                &self,
                timing: &Timing,
            ) -> Result<EffectChanges<F>, SettingsError> {
                self.changes(timing, (&Self::default(), timing))
            }

            /// Differences from `now`, or from how the joint is seen `now`.
            ///
            /// # Errors
            /// As [`Self::laws`].
            pub fn changes<F: Real>(
                &self,
                timing: &Timing,
                now: (&Self, &Timing),
            ) -> Result<EffectChanges<F>, SettingsError> {
                let (settings, seen) = now;
                let same = timing == seen;
                Ok(EffectChanges {
                    $($effect: match &self.$effect {
                        unchanged if same && *unchanged == settings.$effect => None,
                        Some(settings) => Some(Some(
                            <$effect::$law<F> as DeviceEffect<F>>::coefficients(settings, timing)?,
                        )),
                        None => Some(None),
                    },)*
                    scale: Scale::new(&timing.sensing, timing.step_s),
                })
            }
        }

        impl<F: Real> Added<F> {
            /// No contribution.
            pub const NONE: Self = Self { $($effect: F::ZERO,)* };

            /// Converts to f64.
            pub fn to_f64(&self) -> Added<f64> {
                Added { $($effect: self.$effect.to_f64(),)* }
            }

            /// Sum of the contributions of effects that render a disorder, N·m.
            pub fn symptoms_nm(&self) -> F {
                [$((<$effect::$law<F> as DeviceEffect<F>>::IS_SYMPTOM, self.$effect)),*]
                    .into_iter()
                    .filter(|(is_symptom, _)| *is_symptom)
                    .fold(F::ZERO, |sum, (_, nm)| sum + nm)
            }

            /// Contributions in the order of the table.
            #[inline]
            pub fn each(&self) -> [F; SPECS.len()] {
                [$(self.$effect),*]
            }

            /// Contribution of the effect at a place of the table.
            pub fn get(&self, place: usize) -> Option<F> {
                self.each().get(place).copied()
            }
        }

        impl<F: Real> Addition<F> for Effects<F> {
            fn rest(&mut self, place: &Position<F>) {
                $(if let Some(law) = &mut self.$effect {
                    DeviceEffect::rest(law, place);
                })*
            }

            // Always: what it tells the laws then stays in registers.
            #[inline(always)]
            fn tick(
                &mut self,
                seen: &ShaftEstimate<F>,
                input: &Checked<F>,
                shown: &mut Shown<F>,
                observe: &mut impl Observe<F>,
            ) {
                if self.on == 0 {
                    return;
                }
                let has_symptoms = self.on & SYMPTOM_BITS != 0;
                let paid_share = self.tank.open(input.travel_rad().unwrap_or(F::ZERO));
                let travel = has_symptoms
                    .then(|| Travel::plausible(input, &seen.place, &self.scale))
                    .flatten();
                let tick = Tick::of(seen, input, travel.as_ref(), paid_share);
                let mut left = self.on;
                while left != 0 {
                    self.act(left.trailing_zeros(), &tick, shown, observe);
                    left &= left.wrapping_sub(1);
                }
                if has_symptoms {
                    self.tank.close(shown.active_nm);
                }
            }
        }

        impl<F: Real> Effects<F> {
            /// Adds what the effect at a place of the table does: one jump, whatever the table's
            /// length.
            #[inline(always)]
            fn act<O: Observe<F>>(
                &mut self,
                place: u32,
                tick: &Tick<'_, F>,
                shown: &mut Shown<F>,
                observe: &mut O,
            ) {
                $(if place == const { bit::<$effect::$law<f64>>().trailing_zeros() } {
                    if let Some(law) = &mut self.$effect {
                        let added = law.added(tick, shown, observe);
                        give(law.target(), added, shown);
                        shown.added.$effect = added;
                        note(Some(law), added, shown);
                    }
                    return;
                })*
            }
        }

        impl EffectSettings {
            /// Runs `visitor` with the law of the effect at this place of the table, of
            /// one that is off at its defaults; `None` beyond the last.
            ///
            /// # Errors
            /// As [`Self::laws`].
            pub fn with_law<F: Real, V: LawVisitor<F>>(
                &self,
                place: usize,
                timing: &Timing,
                visitor: V,
            ) -> Result<Option<V::Output>, SettingsError> {
                let mut left = place;
                $(
                    if left == 0 {
                        let settings = self.$effect.unwrap_or_else(Tabled::defaults);
                        let made = <$effect::$law<F> as DeviceEffect<F>>::coefficients(&settings, timing)?;
                        let law = <$effect::$law<F> as DeviceEffect<F>>::new(made);
                        return Ok(Some(visitor.visit::<$effect::$law<F>>(law)));
                    }
                    left = left.wrapping_sub(1);
                )*
                let _ = left;
                Ok(None)
            }
        }
    };
    (@switched
        { $($symptom:ident: $s_law:ident;)* }
        { $($addition:ident: $a_law:ident;)* }
    ) => {
        /// The effects of a device that runs. In the order of its fields: what every tick
        /// needs first, within reach of a load, the memory of symptoms last.
        #[derive(Clone, Debug)]
        #[repr(C)]
        pub struct SwitchedEffects<F: Real> {
            /// A bit for each symptom, at its place in the table: all that are on have one.
            on: u32,
            tank: Tank<F>,
            $($addition: <$addition::$a_law<F> as DeviceEffect<F>>::Switched,)*
            scale: Scale<F>,
            $($symptom: <$symptom::$s_law<F> as DeviceEffect<F>>::Switched,)*
        }

        impl<F: Real> SwitchedEffects<F> {
            /// Returns the effects with none of them on.
            pub fn new(slew_nm: F, timing: &Timing) -> Self {
                Self {
                    on: 0,
                    tank: tank(timing),
                    $($addition: Switched::new(slew_nm),)*
                    scale: Scale::new(&timing.sensing, timing.step_s),
                    $($symptom: Switched::new(slew_nm),)*
                }
            }

            /// Applies these laws and this slew limit from the next tick on.
            pub fn change(&mut self, changes: &EffectChanges<F>, slew_nm: F) {
                $(self.$symptom.change(&changes.$symptom, slew_nm);)*
                $(self.$addition.change(&changes.$addition, slew_nm);)*
                self.scale = changes.scale;
                self.look();
            }

            /// Sees which symptoms are on.
            fn look(&mut self) {
                self.on = 0;
                $(if self.$symptom.law().is_some() {
                    self.on |= const { bit::<$symptom::$s_law<f64>>() };
                })*
            }

            /// Adds the symptoms, where any is on.
            #[inline]
            fn add_symptoms(
                &mut self,
                seen: &ShaftEstimate<F>,
                input: &Checked<F>,
                paid_share: F,
                shown: &mut Shown<F>,
                observe: &mut impl Observe<F>,
            ) {
                // The input's check has seen to it that its numbers are a joint's.
                let travel = Travel::of(input, &seen.place, &self.scale);
                // The address of `self`, if it were known, would be in every access to what lies
                // beyond the reach of a load, and most of it does.
                let this = core::hint::black_box(self);
                let mut besides = Besides::NOTHING;
                let on = this.on;
                let followed = travel.as_ref().filter(|_| seen.is_driven);
                $(if on & const { bit::<$symptom::$s_law<f64>>() } != 0 {
                    let nm = match followed {
                        Some(travel) => {
                            this.$symptom.follow(travel, paid_share, &mut besides, observe)
                        }
                        None => {
                            let tick = Tick::of(seen, input, None, paid_share);
                            this.$symptom.unseen(&tick, &mut besides)
                        }
                    };
                    shown.torque_nm += nm;
                    shown.added.$symptom = nm;
                    note(this.$symptom.law(), nm, shown);
                })*
                besides.add_to(paid_share, shown);
                // Only then may one have gone.
                if shown.settling || !seen.is_driven {
                    this.look();
                }
            }
        }

        impl<F: Real> Addition<F> for SwitchedEffects<F> {
            fn rest(&mut self, place: &Position<F>) {
                $(self.$symptom.rest(place);)*
                $(self.$addition.rest(place);)*
                self.look();
            }

            #[inline]
            fn tick(
                &mut self,
                seen: &ShaftEstimate<F>,
                input: &Checked<F>,
                shown: &mut Shown<F>,
                observe: &mut impl Observe<F>,
            ) {
                let paid_share = self.tank.open(input.travel_rad().unwrap_or(F::ZERO));
                if self.on != 0 {
                    self.add_symptoms(seen, input, paid_share, shown, observe);
                }
                self.tank.close(shown.active_nm);
                let tick = Tick::of(seen, input, None, paid_share);
                $(
                    let added = self.$addition.tick(&tick, shown, observe);
                    shown.added.$addition = added;
                    note(self.$addition.law(), added, shown);
                )*
            }
        }
    };
}
