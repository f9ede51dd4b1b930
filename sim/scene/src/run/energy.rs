//! The energy of one run, term by term.

use crepitus_model::Parameters;
use crepitus_model::joint::oscillator::Oscillator;

/// Terms of the balance, J. See `tally` for their definitions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Energy {
    inertia_kg_m2: f64,
    stiffness_nm_per_rad: f64,
    kinetic_start_j: f64,
    pub(super) work_in_j: f64,
    pub(super) convention_j: f64,
    pub(super) friction_j: f64,
    pub(super) viscous_j: f64,
    pub(super) spring_change_j: f64,
    pub(super) kinetic_change_j: f64,
}

impl Energy {
    /// Terms at the start of a run: θ = 0, θ̇ = Ω.
    pub(super) fn new(parameters: &Parameters, omega_rad_s: f64) -> Self {
        let inertia_kg_m2 = parameters.inertia_kg_m2;
        Self {
            inertia_kg_m2,
            stiffness_nm_per_rad: parameters.stiffness_nm_per_rad,
            kinetic_start_j: 0.5 * inertia_kg_m2 * omega_rad_s * omega_rad_s,
            work_in_j: 0.0,
            convention_j: 0.0,
            friction_j: 0.0,
            viscous_j: 0.0,
            spring_change_j: 0.0,
            kinetic_change_j: 0.0,
        }
    }

    /// Accounting the jump of the object's state at the end of a frozen slip.
    pub(super) fn reset(&mut self, theta: f64, theta_dot: f64, new_theta: f64, new_theta_dot: f64) {
        self.convention_j += 0.5
            * (self.stiffness_nm_per_rad * (new_theta - theta) * (new_theta + theta)
                + self.inertia_kg_m2 * (new_theta_dot - theta_dot) * (new_theta_dot + theta_dot));
    }

    /// Accounting the work of a torque that was shown while the object stood still.
    pub(super) fn held(&mut self, work_j: f64) {
        self.work_in_j += work_j;
        self.convention_j -= work_j;
    }

    /// Takes stock at the end of a run.
    pub(super) fn finish(&mut self, theta: f64, theta_dot: f64) {
        self.spring_change_j = 0.5 * self.stiffness_nm_per_rad * theta * theta;
        self.kinetic_change_j =
            0.5 * self.inertia_kg_m2 * theta_dot * theta_dot - self.kinetic_start_j;
    }

    /// Residual, J.
    pub(super) fn residual_j(&self) -> f64 {
        self.work_in_j + self.convention_j
            - self.spring_change_j
            - self.kinetic_change_j
            - self.friction_j
            - self.viscous_j
    }

    /// The residual as a share of the energy that went through.
    pub(super) fn relative_residual(&self) -> f64 {
        let through = self.work_in_j.abs()
            + self.convention_j.abs()
            + self.friction_j.abs()
            + self.viscous_j.abs()
            + self.kinetic_start_j;
        if through > 0.0 {
            self.residual_j() / through
        } else {
            0.0
        }
    }
}

/// c·∫v² dt over `dt_s` of free motion from (x, v), J, by Gauss's five-point
/// rule on half-radian panels.
pub(super) fn viscous_loss(
    parameters: &Parameters,
    oscillator: &Oscillator<f64>,
    before: (f64, f64),
    dt_s: f64,
) -> f64 {
    /// Up to so many they are as quick as two exponentials, and keep the digits in which
    /// those cancel.
    const FEW_PANELS: f64 = 64.0;
    /// Number of panels beyond which the loss is taken from the stored energy, which it equals.
    const MOST_PANELS: f64 = 1e6;
    const NODES: [(f64, f64); 5] = [
        (0.0, 0.568_888_888_888_888_9),
        (-0.538_469_310_105_683, 0.478_628_670_499_366_47),
        (0.538_469_310_105_683, 0.478_628_670_499_366_47),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
        (0.906_179_845_938_664, 0.236_926_885_056_189_08),
    ];
    // Faster than the swing where the object is overdamped.
    let rate = parameters
        .natural_rad_s()
        .max(parameters.damping_nms_per_rad / parameters.inertia_kg_m2);
    let panels = (2.0 * rate * dt_s).ceil().max(1.0);
    if panels > FEW_PANELS
        && let Some(loss_j) = overdamped_loss(parameters, before, dt_s)
    {
        return loss_j;
    }
    if panels > MOST_PANELS {
        let (x, v) = oscillator.transition(dt_s).apply(before.0, before.1);
        return energy(parameters, before) - energy(parameters, (x, v));
    }
    let half_s = dt_s / panels / 2.0;
    let (mut sum, mut panel, mut state) = (0.0, 0.0, before);
    let whole_panel = oscillator.transition(2.0 * half_s);
    let nodes = NODES.map(|(at, weight)| (oscillator.transition(half_s * (1.0 + at)), weight));
    let start = energy(parameters, before);
    while panel < panels {
        for (transition, weight) in &nodes {
            let (_, v) = transition.apply(state.0, state.1);
            sum += weight * v * v;
        }
        state = whole_panel.apply(state.0, state.1);
        panel += 1.0;
        // What is left cannot change the sum any more.
        if energy(parameters, state) <= 1e-18 * start {
            break;
        }
    }
    parameters.damping_nms_per_rad * half_s * sum
}

/// The loss above critical damping, where v = −λ·A·e^(−λ·t) − Λ·B·e^(−Λ·t): in closed form.
/// `None` where the two are too close for that.
fn overdamped_loss(p: &Parameters, (x, v): (f64, f64), dt_s: f64) -> Option<f64> {
    let decay = 0.5 * p.damping_nms_per_rad / p.inertia_kg_m2;
    let natural = p.natural_rad_s();
    let root = ((decay - natural) * (decay + natural)).sqrt();
    if root.is_nan() || root < 0.5 * decay {
        return None;
    }
    let fast = decay + root;
    let slow = natural * natural / fast;
    // Velocities of the two parts.
    let slow_v = -slow * (v + fast * x) / (fast - slow);
    let fast_v = fast * (v + slow * x) / (fast - slow);
    let integral = |rate: f64| -(-rate * dt_s).exp_m1() / rate;
    let squares = slow_v * slow_v * integral(2.0 * slow) + fast_v * fast_v * integral(2.0 * fast);
    let both = 2.0 * slow_v * fast_v * integral(slow + fast);
    Some(p.damping_nms_per_rad * (squares + both))
}

/// Stored energy of free motion, J.
fn energy(p: &Parameters, (x, v): (f64, f64)) -> f64 {
    0.5 * (p.stiffness_nm_per_rad * x * x + p.inertia_kg_m2 * v * v)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares one long stretch with the short ones that it is made of, each by quadrature.
    #[test]
    fn above_critical_damping_the_loss_is_that_of_many_short_stretches() {
        for ratio in [1.05, 1.2, 1.5, 10.0, 300.0] {
            let mut p = Parameters::default();
            p.damping_nms_per_rad = 2.0 * ratio * p.impedance_nms_per_rad();
            let oscillator = Oscillator::of(&p);
            let fast = p.damping_nms_per_rad / p.inertia_kg_m2;
            for before in [(1e-3, 0.7), (1e-3, 0.0), (-1e-3, 0.7), (0.0, 1.0)] {
                let (parts, dt_s) = (2_000, 400.0 / fast);
                let part_s = dt_s / f64::from(parts);
                let short = oscillator.transition(part_s);
                let (mut sum_j, mut state) = (0.0, before);
                for _ in 0..parts {
                    sum_j += viscous_loss(&p, &oscillator, state, part_s);
                    state = short.apply(state.0, state.1);
                }
                let whole_j = viscous_loss(&p, &oscillator, before, dt_s);
                let error = (whole_j - sum_j).abs() / sum_j;
                assert!(error < 1e-11, "ζ = {ratio}, {before:?}: {error}");
            }
        }
    }
}
