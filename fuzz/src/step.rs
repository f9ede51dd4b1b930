//! A raw joint of any rung, with any valid settings, on a shaft of any finite
//! motion up to 1e6 rad/s. After every step:
//!
//! - at most `EVENTS_PER_STEP` events, in the order of time, within the step,
//!   each in the phase that the one before has led to;
//! - |T| ≤ Ts, in events too, and a finite state;
//! - under the mirrored motion the mirrored joint, to the bit; of one without friction, Ts = 0, the
//!   torque alone, as at rest it is at both its limits at once and breaks in the positive sense.
//!
//! The first law alone holds for explicit methods beyond their limit of
//! stability, and where else `rung.rs` says that a method has no more.

use crate::bytes::Bytes;
use crate::laws::{self, Events};
use crate::rung::Rung;
use crate::shaft::Shaft;
use crepitus_model::solver::{JointVisitor, with_joint};
use crepitus_model::{EVENTS_PER_STEP, Real, ShaftStep, StickSlip};

/// The fastest shaft, rad/s.
const FASTEST_RAD_S: f64 = 1e6;

/// The most steps of one input.
const MOST_STEPS: usize = 1024;

/// Checks the laws.
///
/// # Panics
/// If one is broken.
pub fn body(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let rung = Rung::of(&mut bytes);
    let mut shaft = Shaft::default();
    let mut steps = Vec::new();
    while !bytes.is_empty() && steps.len() < MOST_STEPS {
        let next = shaft.next(&mut bytes, rung.step_s);
        steps.extend(next.iter().map(|s| bounded(s, rung.step_s)));
    }
    if rung.double {
        mirrored::<f64>(&rung, &steps);
    } else {
        mirrored::<f32>(&rung, &steps);
    }
}

/// Clamps a step to what a shaft of finite speed can do.
fn bounded(step: &ShaftStep<f64>, step_s: f64) -> ShaftStep<f64> {
    let finite = |x: f64| if x.is_finite() { x } else { 0.0 };
    let speed = |x| finite(x).clamp(-FASTEST_RAD_S, FASTEST_RAD_S);
    let reach = FASTEST_RAD_S * step_s;
    ShaftStep {
        delta_phi_rad: finite(step.delta_phi_rad).clamp(-reach, reach),
        omega_start_rad_s: speed(step.omega_start_rad_s),
        omega_end_rad_s: speed(step.omega_end_rad_s),
    }
}

fn mirrored<F: Real>(rung: &Rung, steps: &[ShaftStep<f64>]) {
    let run = |sign| {
        let walk = Walk { rung, steps, sign };
        with_joint::<F, _>(&rung.settings, rung.solver, rung.step_s, F::ZERO, walk)
            .expect("a valid rung")
    };
    let has_friction = rung.settings.parameters.static_torque_nm > 0.0;
    for (n, (a, b)) in run(1.0).iter().zip(&run(-1.0)).enumerate() {
        assert_eq!(a.1, b.1, "torque of the mirrored motion, step {n}");
        assert!(
            !has_friction || a.0 == -b.0,
            "phase of the mirrored motion, step {n}"
        );
    }
}

/// Walks a joint through the steps, or through their mirror image.
struct Walk<'a> {
    rung: &'a Rung,
    steps: &'a [ShaftStep<f64>],
    sign: f64,
}

impl<F: Real> JointVisitor<F> for Walk<'_> {
    /// The phase after each step and the bits of |T|, signed.
    type Output = Vec<(i8, u64)>;

    fn visit<J: StickSlip<F>>(self, mut joint: J) -> Self::Output {
        let lawful = self.rung.is_lawful();
        let mut shown = Vec::new();
        for step in self.steps {
            let step = ShaftStep {
                delta_phi_rad: F::from_f64(self.sign * step.delta_phi_rad),
                omega_start_rad_s: F::from_f64(self.sign * step.omega_start_rad_s),
                omega_end_rad_s: F::from_f64(self.sign * step.omega_end_rad_s),
            };
            let mut events = Events::from(joint.phase());
            joint.step(&step, |event| events.see(&event));
            events.end(&joint, EVENTS_PER_STEP);
            if lawful {
                events.within(joint.coefficients().static_nm);
                laws::torque(&joint);
                laws::state(&joint);
                let towards = F::from_f64(self.sign) * joint.torque_nm();
                shown.push((joint.phase().sign(), (towards + F::ZERO).to_f64().to_bits()));
            }
        }
        shown
    }
}
