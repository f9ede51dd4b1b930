//! Fits: the contact of each joint, to which all laws are fitted.

use crate::laws::LawStudy;
use crepitus_ladder::laws::Contact;
use crepitus_ladder::laws::contact::Body;
use crepitus_pages::table::{Table, show};
use crepitus_scene::preset::joints;

/// A contact of a joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fit {
    joint: &'static str,
    between: &'static str,
    contact: Contact,
    body: Option<Body>,
}

/// Two contacts a joint: to ground, and to the joint's object.
pub(crate) fn fits(study: &LawStudy) -> Vec<Fit> {
    let studied = joints()
        .iter()
        .filter(|joint| study.joints.contains(&joint.name));
    let both = studied.flat_map(|joint| {
        let (contact, body) = Contact::on_object(&joint.parameters);
        let ground = Fit {
            joint: joint.name,
            between: "shaft and ground",
            contact: Contact::direct(&joint.parameters),
            body: None,
        };
        let object = Fit {
            between: "shaft and object",
            contact,
            body: Some(body),
            ..ground
        };
        [ground, object]
    });
    both.collect()
}

/// A row a contact.
pub(crate) fn table(fits: &[Fit]) -> Table<'_, Fit> {
    let body = |fit: &Fit, of: fn(&Body) -> f64| fit.body.as_ref().map_or(f64::NAN, of);
    Table::of(fits)
        .column("joint", |fit| fit.joint)
        .headed("joint")
        .column("between", |fit| fit.between)
        .headed("contact of")
        .column("static_torque_nm", |fit| fit.contact.static_torque_nm)
        .headed("Ts, N·m")
        .rounded(show::fixed::<2>)
        .column("kinetic_torque_nm", |fit| fit.contact.kinetic_torque_nm)
        .headed("Tk, N·m")
        .rounded(show::fixed::<2>)
        .column("stiffness_nm_per_rad", |fit| {
            fit.contact.stiffness_nm_per_rad
        })
        .headed("σ0, N·m/rad")
        .rounded(show::fixed::<0>)
        .column("damping_nms_per_rad", |fit| fit.contact.damping_nms_per_rad)
        .headed("σ1, N·m·s/rad")
        .rounded(show::scientific)
        .column("stribeck_rad_s", |fit| fit.contact.stribeck_rad_s)
        .headed("vs, rad/s")
        .rounded(show::scientific)
        .column("object_inertia_kg_m2", move |fit| {
            body(fit, |body| body.inertia_kg_m2)
        })
        .headed("J, kg·m²")
        .rounded(show::scientific)
        .column("object_stiffness_nm_per_rad", move |fit| {
            body(fit, |body| body.stiffness_nm_per_rad)
        })
        .headed("k, N·m/rad")
        .rounded(show::fixed::<0>)
}

/// The rule of the fit.
pub(crate) const RULE: &str = "Every law is fitted to the same joint: its static and kinetic torque Ts and Tk, and its \
     presliding stiffness. A law between shaft and ground has the joint's spring as its bristles (σ0). A law on an object \
     has a contact that is much stiffer than the object's spring (k), with which it is in series, so that its natural \
     frequency is that of the joint; J is the object's inertia. σ1 is the damping of the bristles, vs the velocity of \
     the Stribeck curve. The conventions frozen, paper and physical are the joint itself, and have none of these.";
