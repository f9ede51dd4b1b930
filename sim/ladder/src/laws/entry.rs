//! Every law by name, and the visitor that runs it.

use super::FrictionLaw;
use super::bliman_sorine::BlimanSorine;
use super::coulomb::{Band, Tanh};
use super::dahl::Dahl;
use super::elasto_plastic::ElastoPlastic;
use super::hayward_armstrong::HaywardArmstrong;
use super::karnopp::Karnopp;
use super::kikuuwe::Kikuuwe;
use super::lugre::{LuGre, LuGreExponential};
use super::maxwell_slip::MaxwellSlip;
use super::mounted::{Direct, Joint, Mounted, check};
use super::object::OnObject;
use crepitus_model::solver::{JointVisitor, Solver, with_joint};
use crepitus_model::{Convention, Parameters, Real, Restart, Settings, SettingsError, StickSlip};

pub use table::ENTRIES;

/// A law, as it is run and named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Name on the command line and in tables.
    pub name: &'static str,
    /// Description in a few words, with authors and year.
    pub title: &'static str,
    /// Its file in this folder, without the ending.
    pub file: &'static str,
    kind: Kind,
}

/// A law and what it rubs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Ours(Convention),
    Karnopp,
    Tanh,
    TanhObject,
    Band,
    BandObject,
    HaywardArmstrong,
    Kikuuwe,
    KikuuweObject,
    Dahl,
    BlimanSorine,
    LuGre,
    LuGreObject,
    LuGreExponential,
    LuGreExponentialObject,
    ElastoPlastic,
    ElastoPlasticObject,
    MaxwellSlip4,
    MaxwellSlip4Object,
    MaxwellSlip10,
    MaxwellSlip10Object,
}

/// Work that is generic over the law.
pub trait LawVisitor<F: Real> {
    /// Result of the visit.
    type Output;

    /// Called with the law, at rest.
    fn visit<M: Mounted<F>>(self, law: M) -> Self::Output;
}

impl Entry {
    /// True where an object is between the law and ground, so that it can grate.
    pub fn is_on_object(&self) -> bool {
        !matches!(
            self.kind,
            Kind::Tanh
                | Kind::Band
                | Kind::HaywardArmstrong
                | Kind::Kikuuwe
                | Kind::Dahl
                | Kind::BlimanSorine
                | Kind::LuGre
                | Kind::LuGreExponential
                | Kind::ElastoPlastic
                | Kind::MaxwellSlip4
                | Kind::MaxwellSlip10
        )
    }

    /// True for the joint of the product, which is a [rung](crate::subject::Subject::Rung) too.
    pub fn is_ours(&self) -> bool {
        matches!(self.kind, Kind::Ours(_))
    }

    /// Builds the law for this joint in steps of `step_s` and hands it to a visitor. The shaft
    /// moves with `omega_rad_s` at the start, and an object moves with it.
    ///
    /// # Errors
    /// [`SettingsError`] if the joint or the step is invalid for the law.
    pub fn with<F: Real, V: LawVisitor<F>>(
        &self,
        joint: &Parameters,
        step_s: f64,
        omega_rad_s: F,
        visitor: V,
    ) -> Result<V::Output, SettingsError> {
        check(joint, step_s)?;
        let on = Place {
            joint,
            step_s,
            omega_rad_s,
            visitor,
        };
        Ok(match self.kind {
            Kind::Ours(convention) => {
                let settings = Settings {
                    parameters: *joint,
                    convention,
                    restart: Restart::default(),
                };
                let ours = Ours {
                    settings,
                    omega_rad_s,
                    visitor: on.visitor,
                };
                return with_joint(
                    &settings.validate()?,
                    Solver::ExactEvents,
                    step_s,
                    omega_rad_s,
                    ours,
                );
            }
            Kind::Karnopp => on
                .visitor
                .visit(Karnopp::fitted(joint, step_s, omega_rad_s)?),
            Kind::Tanh => on.ground::<Tanh<F>>(),
            Kind::TanhObject => on.object::<Tanh<F>>(),
            Kind::Band => on.ground::<Band<F>>(),
            Kind::BandObject => on.object::<Band<F>>(),
            Kind::HaywardArmstrong => on.ground::<HaywardArmstrong<F>>(),
            Kind::Kikuuwe => on.ground::<Kikuuwe<F>>(),
            Kind::KikuuweObject => on.object::<Kikuuwe<F>>(),
            Kind::Dahl => on.ground::<Dahl<F>>(),
            Kind::BlimanSorine => on.ground::<BlimanSorine<F>>(),
            Kind::LuGre => on.ground::<LuGre<F>>(),
            Kind::LuGreObject => on.object::<LuGre<F>>(),
            Kind::LuGreExponential => on.ground::<LuGreExponential<F>>(),
            Kind::LuGreExponentialObject => on.object::<LuGreExponential<F>>(),
            Kind::ElastoPlastic => on.ground::<ElastoPlastic<F>>(),
            Kind::ElastoPlasticObject => on.object::<ElastoPlastic<F>>(),
            Kind::MaxwellSlip4 => on.ground::<MaxwellSlip<F, 4>>(),
            Kind::MaxwellSlip4Object => on.object::<MaxwellSlip<F, 4>>(),
            Kind::MaxwellSlip10 => on.ground::<MaxwellSlip<F, 10>>(),
            Kind::MaxwellSlip10Object => on.object::<MaxwellSlip<F, 10>>(),
        })
    }
}

/// Builds a law where it is to be.
struct Place<'a, F, V> {
    joint: &'a Parameters,
    step_s: f64,
    omega_rad_s: F,
    visitor: V,
}

impl<F: Real, V: LawVisitor<F>> Place<'_, F, V> {
    fn ground<L: FrictionLaw<F>>(self) -> V::Output {
        let law = Direct::<L>::fitted(self.joint, self.step_s);
        self.visitor.visit(law)
    }

    fn object<L: FrictionLaw<F>>(self) -> V::Output {
        let law = OnObject::<F, L>::fitted(self.joint, self.step_s, self.omega_rad_s);
        self.visitor.visit(law)
    }
}

/// Visits our joint.
struct Ours<F, V> {
    settings: Settings,
    omega_rad_s: F,
    visitor: V,
}

impl<F: Real, V: LawVisitor<F>> JointVisitor<F> for Ours<F, V> {
    type Output = V::Output;

    fn visit<J: StickSlip<F>>(self, joint: J) -> V::Output {
        let joint = Joint::new(joint, self.settings, self.omega_rad_s);
        self.visitor.visit(joint)
    }
}

mod table;
#[cfg(test)]
mod tests;
