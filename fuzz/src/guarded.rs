//! A guarded joint of any rung, with any valid settings under which a raw one
//! has laws, whatever the sensor delivers: any bit pattern, or nothing. After
//! every tick:
//!
//! - a finite state, |T| ≤ Ts, and no more events than the catching-up allows;
//! - while samples are missing the torque never grows or changes sign,
//!   and the joint stays as it is;
//! - every sample is taken, refused or lost, and counted as that.

use crate::bytes::Bytes;
use crate::laws::{self, Events};
use crate::rung::Rung;
use crate::shaft::Shaft;
use crepitus_model::render::input_check::{CATCH_UP_TICKS, InputLimits};
use crepitus_model::solver::{JointVisitor, with_joint};
use crepitus_model::{EVENTS_PER_STEP, Guarded, Real, Sample, ShaftStep, StickSlip};

/// The most ticks of one input.
const MOST_TICKS: usize = 1024;

/// The most events of one tick.
pub(crate) const MOST_EVENTS: usize = EVENTS_PER_STEP * (CATCH_UP_TICKS as usize + 1);

/// Checks the laws.
///
/// # Panics
/// If one is broken.
pub fn body(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let rung = Rung::of(&mut bytes);
    if !rung.is_lawful() {
        return;
    }
    let mut shaft = Shaft::default();
    let mut samples = Vec::new();
    while !bytes.is_empty() && samples.len() < MOST_TICKS {
        samples.extend(next_samples(&mut bytes, &mut shaft, rung.step_s));
    }
    if rung.double {
        run::<f64>(&rung, &samples);
    } else {
        run::<f32>(&rung, &samples);
    }
}

/// The next samples: steps of the shaft, or `None` where they are lost.
pub(crate) fn next_samples(
    bytes: &mut Bytes<'_>,
    shaft: &mut Shaft,
    step_s: f64,
) -> Vec<Option<ShaftStep<f64>>> {
    match bytes.byte() {
        // Single losses, and longer ones.
        lost @ 0xc0.. => vec![None; usize::from(lost & 0x3f) + 1],
        _ => shaft.next(bytes, step_s).into_iter().map(Some).collect(),
    }
}

/// Returns `step` as the joint's input.
pub(crate) fn sample<F: Real>(step: Option<&ShaftStep<f64>>) -> Sample<F> {
    step.map_or(Sample::Lost, |s| {
        Sample::Taken(ShaftStep {
            delta_phi_rad: F::from_f64(s.delta_phi_rad),
            omega_start_rad_s: F::from_f64(s.omega_start_rad_s),
            omega_end_rad_s: F::from_f64(s.omega_end_rad_s),
        })
    })
}

fn run<F: Real>(rung: &Rung, samples: &[Option<ShaftStep<f64>>]) {
    let ticks = Ticks {
        samples,
        step_s: rung.step_s,
    };
    with_joint::<F, _>(&rung.settings, rung.solver, rung.step_s, F::ZERO, ticks)
        .expect("a valid rung");
}

struct Ticks<'a> {
    samples: &'a [Option<ShaftStep<f64>>],
    step_s: f64,
}

impl<F: Real> JointVisitor<F> for Ticks<'_> {
    type Output = ();

    fn visit<J: StickSlip<F>>(self, joint: J) {
        let mut joint = Guarded::new(joint, InputLimits::device(self.step_s), F::ZERO);
        for step in self.samples {
            let sample = sample(step.as_ref());
            let (counters, shown) = (joint.counters(), joint.torque_nm());
            let phase = joint.joint().phase();
            let theta = joint.joint().theta_rad();
            let mut events = Events::from(phase);
            joint.tick(&sample, |event| events.see(&event));

            laws::torque(joint.joint());
            laws::state(joint.joint());
            events.within(joint.joint().coefficients().static_nm);
            let torque = joint.torque_nm();
            assert!(
                torque.abs() <= joint.joint().coefficients().static_nm,
                "{torque:?} N·m shown"
            );
            let now = joint.counters();
            let refused = now.refused - counters.refused;
            let lost = now.lost - counters.lost;
            assert_eq!(lost, u32::from(step.is_none()), "lost");
            assert_eq!(refused + lost, u32::from(joint.is_holding()), "held");
            if joint.is_holding() {
                events.end(joint.joint(), 0);
                assert_eq!(joint.joint().theta_rad(), theta, "a joint without a shaft");
                assert!(
                    torque.abs() <= shown.abs() && torque * shown >= F::ZERO,
                    "a held torque grows from {shown:?} to {torque:?}"
                );
            } else if now.restarts == counters.restarts {
                events.end(joint.joint(), MOST_EVENTS);
            }
        }
    }
}
