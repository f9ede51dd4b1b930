//! The joint as the device renders it, with any samples and with other valid
//! settings committed at any tick. After every tick:
//!
//! - the output is finite and at most the active Ts, and so are the
//!   joint's own torque and its events; its state is finite;
//! - where the hand has reversed inside a slip, the output is zero;
//! - a change of parameters alone, seen in ticks without a shaft, never raises
//!   the energy stored in the object, moves no torque faster than the slew
//!   limit, and raises no stick's but with the Ts that limits it.

use crate::bytes::Bytes;
use crate::guarded::{MOST_EVENTS, next_samples, sample};
use crate::laws::{self, Events};
use crate::rung;
use crate::shaft::Shaft;
use crepitus_model::control::encoder::EncoderSettings;
use crepitus_model::joint::shaft::Linear;
use crepitus_model::render::Limit;
use crepitus_model::render::input_check::InputLimits;
use crepitus_model::solver::locate::{EndOfStep, ExactBreak, ExactEvents, Interpolated, Locate};
use crepitus_model::{
    Convention, Frozen, Phase, Real, Renderer, ShaftStep, StepCoefficients, StickSlip,
};

const SLEW_NM_PER_S: f64 = 100.0;

/// The most ticks of one input.
const MOST_TICKS: usize = 2048;

/// The longest tick: a device has a control loop, not a calendar.
const LONGEST_TICK_S: f64 = 0.1;

/// Checks the laws.
///
/// # Panics
/// If one is broken.
pub fn body(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    match bytes.byte() % 5 {
        0 => run::<f64, ExactEvents>(bytes),
        1 => run::<f32, EndOfStep>(bytes),
        2 => run::<f32, ExactBreak>(bytes),
        3 => run::<f32, Interpolated>(bytes),
        _ => run::<f32, ExactEvents>(bytes),
    }
}

fn run<F: Real, L: Locate<F, Shape = Linear>>(mut bytes: Bytes<'_>) {
    let step_s = bytes.between(1e-6, LONGEST_TICK_S);
    let coefficients = |bytes: &mut Bytes<'_>| {
        let settings = rung::settings(bytes, Convention::Frozen);
        StepCoefficients::<F>::new(&settings, step_s).expect("a valid step")
    };
    let count_rad = F::from_f64(EncoderSettings::default().rad_per_count());
    let limits = InputLimits::device(step_s);
    let first = coefficients(&mut bytes);
    let mut renderer = Renderer::<F, L>::of(first, limits, count_rad, F::ZERO);
    let mut guard = Guard::new(count_rad.to_f64());
    let mut shaft = Shaft::default();
    let mut ticks = 0;
    while !bytes.is_empty() && ticks < MOST_TICKS {
        if bytes.byte().is_multiple_of(8) {
            let next = coefficients(&mut bytes);
            renderer.commit(next, SLEW_NM_PER_S);
        }
        for step in next_samples(&mut bytes, &mut shaft, step_s) {
            tick(&mut renderer, &mut guard, step.as_ref());
            ticks += 1;
        }
    }
}

/// One tick.
fn tick<F: Real, L: Locate<F, Shape = Linear>>(
    renderer: &mut Renderer<F, L>,
    guard: &mut Guard,
    step: Option<&ShaftStep<f64>>,
) {
    let before = Stored::of(renderer.joint());
    let counters = renderer.counters();
    let mut events = Events::from(renderer.joint().phase());
    let shown = renderer.render(&sample(step), |event| events.see(&event));

    let joint = renderer.joint();
    let limit = joint.coefficients().static_nm;
    laws::torque(joint);
    laws::state(joint);
    assert!(shown.torque_nm.abs() <= limit, "{shown:?}, Ts {limit:?}");
    assert_eq!(shown.model_torque_nm, joint.torque_nm());
    // A sample that was refused is as good as lost.
    let is_seen = shown.limit != Limit::Holding;
    let turned_rad = step.filter(|_| is_seen);
    let turned_rad = turned_rad.map(|step| F::from_f64(step.delta_phi_rad).to_f64());
    let has_turned = guard.has_turned(turned_rad, joint.phase(), joint.slip_number());
    assert!(!has_turned || shown.torque_nm == F::ZERO, "{shown:?}");
    events.within(limit);
    if renderer.counters().restarts == counters.restarts {
        events.end(joint, MOST_EVENTS);
    }
    if step.is_none() {
        before.check(joint);
    }
}

/// Counts that a shaft may turn back in a slip without ending the torque, and what rounding makes
/// of them.
const MOST_BACK_COUNTS: f64 = 2.0 + 1e-3;

/// Independent turn-back guard: how far the shaft has turned back within a slip.
struct Guard {
    most_rad: f64,
    behind_rad: f64,
    slip: Option<u32>,
}

impl Guard {
    fn new(count_rad: f64) -> Self {
        Self {
            most_rad: MOST_BACK_COUNTS * count_rad,
            behind_rad: 0.0,
            slip: None,
        }
    }

    /// Returns whether the torque must be zero. Starts again with each slip and after a lost sample.
    fn has_turned(&mut self, turned_rad: Option<f64>, phase: Phase, slip_number: u32) -> bool {
        let before = self.slip.take();
        let (Phase::Slip(sense), Some(turned_rad)) = (phase, turned_rad) else {
            return false;
        };
        self.slip = Some(slip_number);
        self.behind_rad = if before == self.slip {
            (self.behind_rad - sense.of_signed(turned_rad)).max(0.0)
        } else {
            0.0
        };
        self.behind_rad > self.most_rad
    }
}

/// Energy that an object stores, and its torque.
#[derive(Debug)]
struct Stored {
    energy_j: f64,
    torque_nm: f64,
    /// The static torque, N·m, and the energy of its spring, J: what rounding
    /// is measured against.
    static_nm: f64,
    static_j: f64,
}

impl Stored {
    fn of<F: Real, L: Locate<F, Shape = Linear>>(joint: &Frozen<F, L>) -> Self {
        let a = joint.coefficients();
        let theta = joint.theta_rad().to_f64();
        let spring_j = 0.5 * a.stiffness.to_f64() * theta * theta;
        let motion_j = match joint.phase() {
            // The hand moves it, and none of that ever comes back.
            Phase::Stick => 0.0,
            Phase::Slip(_) => 0.5 * a.inertia.to_f64() * joint.theta_dot_rad_s().to_f64().powi(2),
        };
        let static_nm = a.static_nm.to_f64();
        Self {
            energy_j: spring_j + motion_j,
            torque_nm: joint.torque_nm().to_f64(),
            static_nm,
            static_j: static_nm * static_nm / a.stiffness.to_f64(),
        }
    }

    /// The laws of an adjustment, `joint` being what it has become.
    fn check<F: Real, L: Locate<F, Shape = Linear>>(&self, joint: &Frozen<F, L>) {
        let after = Self::of(joint);
        let eps = F::EPSILON.to_f64();
        let scale_j = self.energy_j + self.static_j.max(after.static_j);
        assert!(
            after.energy_j <= self.energy_j + 64.0 * eps * scale_j,
            "an adjustment stores energy: {self:?} {after:?}"
        );
        let slew_nm = SLEW_NM_PER_S * joint.coefficients().step_s.to_f64();
        #[expect(clippy::cast_precision_loss, reason = "a small number")]
        let rounding_nm = self.static_nm.max(after.static_nm) * eps * (MOST_TICKS + 8) as f64;
        let most_nm = slew_nm * (1.0 + 1.1e-6) + rounding_nm;
        let moved_nm = (after.torque_nm - self.torque_nm).abs();
        assert!(
            moved_nm <= most_nm,
            "{moved_nm} N·m in a tick: {self:?} {after:?}"
        );
        // In a slip the torque is ±Tk, which may be set higher; and a stick that
        // was left beyond its limit in a crowded step shows ±Ts.
        if joint.phase() == Phase::Stick && self.torque_nm.abs() < self.static_nm {
            assert!(
                after.torque_nm.abs() <= self.torque_nm.abs() + rounding_nm,
                "an adjustment raises a stick's torque: {self:?} {after:?}"
            );
        }
    }
}
