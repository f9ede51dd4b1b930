//! The contact that every law is fitted to.
//!
//! Rule of the fit, the same for each law:
//!
//! 1. the static and the kinetic torque of the joint, Ts and Tk;
//! 2. its presliding stiffness kr, dT/dφ from rest;
//! 3. on an object, the contact is 99 times as stiff as the object's spring. In series both are as
//!    stiff as the joint's spring, and the inertia grows with the spring, so that the natural
//!    frequency is that of the joint. The contact's own frequency is ten times that;
//! 4. the Stribeck velocity is vs = 0.3·(Ts − Tk)/√(J·kr), three tenths of the swing of the
//!    object's velocity in a slip;
//! 5. on an object, the damping of the contact is the critical one, 2·√(σ0·J).
//!
//! **Reasons.** A law on an object grates only where vs is between two velocities. One is that with
//! which the contact is loaded in stick, Ω·k/(k + σ0) = Ω/100: if it is above vs, the torque has
//! fallen to Tk before the break, and nothing drops. The other is the swing: if vs is not below it,
//! the torque stays near Ts in the slip. With 19 for 99 and vs of a hundredth of the swing, no
//! law with a Stribeck curve grated on the joint of the paper from 0.1 rad/s on. With the numbers
//! above all do from 0.05 to 2 rad/s, half the swing to twenty times the swing.
//!
//! The damping ends the contact's own vibration, which each slip starts with an amplitude of up to
//! Ts. With a tenth of the critical one it lasts until the next break, and the elasto-plastic and the
//! Maxwell-slip laws break two or three times in a cycle of 0.1 rad/s, and once in two cycles at
//! 1 rad/s. With 0.7 of it the law of Kikuuwe slides at 2 rad/s. The damping is limited where the
//! contact moves quickly: see `damping.rs`.
//!
//! The frequency of the grating is then a result of the study.

use crepitus_model::Parameters;

/// Stiffness of the contact beside that of the object's spring.
const CONTACT_PER_SPRING: f64 = 99.0;

/// The Stribeck velocity beside (Ts − Tk)/√(J·kr).
const STRIBECK_SHARE: f64 = 0.3;

/// A contact of two bodies, as friction laws describe it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Torque at which it breaks away, Ts, N·m.
    pub static_torque_nm: f64,
    /// Torque of steady sliding, Tk, N·m; at most Ts.
    pub kinetic_torque_nm: f64,
    /// Presliding stiffness dT/dφ from rest, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Damping of the presliding motion, N·m·s/rad; 0 where the shaft's motion is prescribed.
    pub damping_nms_per_rad: f64,
    /// Velocity over which the torque falls from Ts to Tk, rad/s.
    pub stribeck_rad_s: f64,
}

/// The spring and the inertia between a contact and ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Inertia, kg·m².
    pub inertia_kg_m2: f64,
    /// Stiffness of its spring, N·m/rad.
    pub stiffness_nm_per_rad: f64,
    /// Damping of its spring, N·m·s/rad.
    pub damping_nms_per_rad: f64,
}

impl Contact {
    /// The contact between the shaft and ground: its presliding is the joint's spring.
    pub fn direct(joint: &Parameters) -> Self {
        let swing_rad_s = (joint.static_torque_nm - joint.kinetic_torque_nm).max(0.0)
            / joint.impedance_nms_per_rad();
        Self {
            static_torque_nm: joint.static_torque_nm,
            kinetic_torque_nm: joint.kinetic_torque_nm,
            stiffness_nm_per_rad: joint.stiffness_nm_per_rad,
            damping_nms_per_rad: 0.0,
            stribeck_rad_s: STRIBECK_SHARE * swing_rad_s,
        }
    }

    /// The contact between the shaft and the joint's object, and that object.
    pub fn on_object(joint: &Parameters) -> (Self, Body) {
        let share = (CONTACT_PER_SPRING + 1.0) / CONTACT_PER_SPRING;
        let body = Body {
            inertia_kg_m2: joint.inertia_kg_m2 * share,
            stiffness_nm_per_rad: joint.stiffness_nm_per_rad * share,
            damping_nms_per_rad: joint.damping_nms_per_rad,
        };
        let stiffness_nm_per_rad = CONTACT_PER_SPRING * body.stiffness_nm_per_rad;
        let critical = 2.0 * crepitus_model::Real::sqrt(stiffness_nm_per_rad * body.inertia_kg_m2);
        let contact = Self {
            stiffness_nm_per_rad,
            damping_nms_per_rad: critical,
            ..Self::direct(joint)
        };
        (contact, body)
    }

    /// Swing of the object's velocity in a slip, (Ts − Tk)/√(J·kr), rad/s.
    pub(super) fn swing_rad_s(&self) -> f64 {
        self.stribeck_rad_s / STRIBECK_SHARE
    }

    /// Torque of steady sliding at a velocity, N·m: the Stribeck curve
    /// Tk + (Ts − Tk)·exp(−(v/vs)²), without a sign.
    pub fn sliding_nm(&self, omega_rad_s: f64) -> f64 {
        let ratio = omega_rad_s / self.stribeck_rad_s;
        let drop_nm = self.static_torque_nm - self.kinetic_torque_nm;
        if drop_nm > 0.0 {
            self.kinetic_torque_nm + drop_nm * crepitus_model::Real::exp(-(ratio * ratio))
        } else {
            self.kinetic_torque_nm
        }
    }
}
