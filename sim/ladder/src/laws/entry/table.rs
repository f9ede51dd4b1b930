//! The laws, by family.

use super::{Entry, Kind};
use crepitus_model::Convention;

const fn entry(name: &'static str, title: &'static str, file: &'static str, kind: Kind) -> Entry {
    Entry {
        name,
        title,
        file,
        kind,
    }
}

/// Every law, by family: ours and Karnopp's, which have the object in them; functions of velocity;
/// of displacement and of sets; bristles.
pub const ENTRIES: &[Entry] = &[
    entry(
        "frozen",
        "stick-slip joint of Ishikawa, Okamoto et al., slips of a closed form",
        "mounted",
        Kind::Ours(Convention::Frozen),
    ),
    entry(
        "paper",
        "stick-slip joint of Ishikawa, Okamoto et al., slips matched by velocity",
        "mounted",
        Kind::Ours(Convention::Paper),
    ),
    entry(
        "physical",
        "stick-slip joint of Ishikawa, Okamoto et al., the object's inertia felt",
        "mounted",
        Kind::Ours(Convention::Physical),
    ),
    entry(
        "karnopp",
        "band of zero velocity, with the joint's object, Karnopp 1985",
        "karnopp",
        Kind::Karnopp,
    ),
    entry(
        "tanh",
        "Coulomb, regularised by tanh",
        "coulomb",
        Kind::Tanh,
    ),
    entry(
        "tanh-object",
        "Coulomb, regularised by tanh, on an object",
        "coulomb",
        Kind::TanhObject,
    ),
    entry(
        "band",
        "Coulomb, regularised by a velocity band",
        "coulomb",
        Kind::Band,
    ),
    entry(
        "band-object",
        "Coulomb, regularised by a velocity band, on an object",
        "coulomb",
        Kind::BandObject,
    ),
    entry(
        "hayward-armstrong",
        "adhesion point that follows travel, Hayward and Armstrong 2000",
        "hayward_armstrong",
        Kind::HaywardArmstrong,
    ),
    entry(
        "kikuuwe",
        "set-valued Coulomb on a spring, implicit, Kikuuwe et al. 2006",
        "kikuuwe",
        Kind::Kikuuwe,
    ),
    entry(
        "kikuuwe-object",
        "set-valued Coulomb on a spring, implicit, Kikuuwe et al. 2006, on an object",
        "kikuuwe",
        Kind::KikuuweObject,
    ),
    entry("dahl", "bristles, Dahl 1968", "dahl", Kind::Dahl),
    entry(
        "bliman-sorine",
        "two of Dahl's elements, Bliman and Sorine 1995",
        "bliman_sorine",
        Kind::BlimanSorine,
    ),
    entry(
        "lugre",
        "LuGre, Canudas de Wit et al. 1995, explicit Euler",
        "lugre",
        Kind::LuGre,
    ),
    entry(
        "lugre-object",
        "LuGre, Canudas de Wit et al. 1995, explicit Euler, on an object",
        "lugre",
        Kind::LuGreObject,
    ),
    entry(
        "lugre-exponential",
        "LuGre, Canudas de Wit et al. 1995, exponential step",
        "lugre",
        Kind::LuGreExponential,
    ),
    entry(
        "lugre-exponential-object",
        "LuGre, Canudas de Wit et al. 1995, exponential step, on an object",
        "lugre",
        Kind::LuGreExponentialObject,
    ),
    entry(
        "elasto-plastic",
        "elasto-plastic bristle, Dupont et al. 2002",
        "elasto_plastic",
        Kind::ElastoPlastic,
    ),
    entry(
        "elasto-plastic-object",
        "elasto-plastic bristle, Dupont et al. 2002, on an object",
        "elasto_plastic",
        Kind::ElastoPlasticObject,
    ),
    entry(
        "maxwell-slip-4",
        "generalised Maxwell-slip, Lampaert et al. 2003, 4 elements",
        "maxwell_slip",
        Kind::MaxwellSlip4,
    ),
    entry(
        "maxwell-slip-4-object",
        "generalised Maxwell-slip, Lampaert et al. 2003, 4 elements, on an object",
        "maxwell_slip",
        Kind::MaxwellSlip4Object,
    ),
    entry(
        "maxwell-slip-10",
        "generalised Maxwell-slip, Lampaert et al. 2003, 10 elements",
        "maxwell_slip",
        Kind::MaxwellSlip10,
    ),
    entry(
        "maxwell-slip-10-object",
        "generalised Maxwell-slip, Lampaert et al. 2003, 10 elements, on an object",
        "maxwell_slip",
        Kind::MaxwellSlip10Object,
    ),
];
